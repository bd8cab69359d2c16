/* The operator graph of a datapath: what hardware a pipe is, read off the same text that computes.
 *
 * A node is an operator, an input word or a constant. Equal operators on equal operands are one node. The body of a
 * loop (REPEAT) is in the graph as often as it has steps, for the longest path, but its operators count once: it is
 * one piece of hardware, which one test uses for as many clocks. Any thread, on different graphs. */
#ifndef HP_NUMBER_GRAPH_H
#define HP_NUMBER_GRAPH_H

#include <hitpipe/config.h>
#include <hitpipe/pipe.h>

enum { HP_GRAPH_OPERANDS = 3, HP_GRAPH_NESTING = 4 };

typedef struct hp_graph_node {
    enum { HP_NODE_INPUT, HP_NODE_CONSTANT, HP_NODE_OPERATOR } kind;
    hp_operator operator;                /* of an operator */
    unsigned variant;                    /* tells operators of a kind apart: comparator 0 is <, 1 is <= */
    float value;                         /* of a constant */
    unsigned operand[HP_GRAPH_OPERANDS]; /* of an operator: nodes before this one */
    unsigned operands;
    bool folded;   /* a later step of a loop: hardware that is there already */
    unsigned loop; /* number of the outermost loop around it, from 1; 0: none */
    unsigned next; /* node with the same hash, 1 more than its number; 0: none */
} hp_graph_node;

typedef struct hp_graph {
    unsigned nodes, room;
    hp_graph_node *node;
    unsigned *bucket; /* first node of a hash, 1 more than its number */
    bool failed;      /* out of memory: the graph is worthless */
    unsigned depth;   /* loops around the text being read */
    unsigned loops, steps[HP_GRAPH_NESTING];
    bool folded[HP_GRAPH_NESTING];
    unsigned interval;     /* most steps of nested loops; 1 without loops */
    unsigned *loop_clocks; /* of loop n: steps less one */
} hp_graph;

/* An empty graph; free it with hp_graph_free. */
void hp_graph_begin(hp_graph *graph);
void hp_graph_free(hp_graph *graph);

/* Adds a node and returns its number; the one that is there already when it is an equal operator or constant. */
unsigned hp_graph_input(hp_graph *graph);
unsigned hp_graph_constant(hp_graph *graph, float value);
unsigned hp_graph_operator(hp_graph *graph, hp_operator operator, unsigned variant, unsigned operands,
                           const unsigned *operand);

/* for (unsigned i = hp_graph_repeat(g, n); hp_graph_repeating(g, i, n); i++): a loop of n steps. */
unsigned hp_graph_repeat(hp_graph *graph, unsigned steps);
bool hp_graph_repeating(hp_graph *graph, unsigned step, unsigned steps);

/* Clocks, under config's operator table, until the output of each node is there; clocks[nodes], to be freed. A loop
 * adds its steps less one to what passes through it, since its hardware begins one step a clock. NULL: no memory. */
unsigned *hp_graph_clocks(const hp_graph *graph, const hp_config *config);

/* The same in operators; gates and wires count 0. */
unsigned *hp_graph_levels(const hp_graph *graph);

/* Operators a chain of ANDs away count as one multi-input AND, likewise ORs; a min and a max of the same two numbers
 * as one comparator and two multiplexers. Levels, clocks and interval of the whole; what the graph does not know
 * (inputs, outputs, clocks of one output) is left 0. All 0 when out of memory. */
hp_pipe_cost hp_graph_cost(const hp_graph *graph, const hp_config *config);

#endif
