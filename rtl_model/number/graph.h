/* The operator graph of a datapath: what hardware a pipe is, read off the same text that computes.
 *
 * A node is an operator, an input word or a constant. Equal operators on equal operands are one node. A graph is a
 * plain value of fixed capacity; more nodes than that is a programming error (assert). Any thread, on different
 * graphs. */
#ifndef HP_NUMBER_GRAPH_H
#define HP_NUMBER_GRAPH_H

#include <hitpipe/config.h>
#include <hitpipe/pipe.h>

enum { HP_GRAPH_NODES = 1024, HP_GRAPH_OUTPUTS = 16, HP_GRAPH_OPERANDS = 3 };

typedef struct hp_graph_node {
    enum { HP_NODE_INPUT, HP_NODE_CONSTANT, HP_NODE_OPERATOR } kind;
    hp_operator operator;                /* of an operator */
    unsigned variant;                    /* tells operators of a kind apart: comparator 0 is <, 1 is <= */
    float value;                         /* of a constant */
    unsigned operand[HP_GRAPH_OPERANDS]; /* of an operator: nodes before this one */
    unsigned operands;
} hp_graph_node;

typedef struct hp_graph {
    unsigned nodes;
    hp_graph_node node[HP_GRAPH_NODES];
} hp_graph;

/* Adds a node and returns its number; the one that is there already when it is an equal operator or constant. */
unsigned hp_graph_input(hp_graph *graph);
unsigned hp_graph_constant(hp_graph *graph, float value);
unsigned hp_graph_operator(hp_graph *graph, hp_operator operator, unsigned variant, unsigned operands,
                           const unsigned *operand);

/* Operators a chain of ANDs away count as one multi-input AND, likewise ORs; a min and a max of the same two numbers
 * as one comparator and two multiplexers. inputs, outputs, clocks_F, clocks_T, clocks_CP and interval are left 0: the
 * graph does not know them. */
hp_pipe_cost hp_graph_cost(const hp_graph *graph, const hp_config *config);

/* Operators, or clocks under config's operator table, on the longest path to node n, n included. */
unsigned hp_graph_levels(const hp_graph *graph, unsigned n);
unsigned hp_graph_clocks(const hp_graph *graph, unsigned n, const hp_config *config);

#endif
