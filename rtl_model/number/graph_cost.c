/* Counting and timing an operator graph. */
#include "rtl_model/number/graph.h"
#include <stdlib.h>
#include <string.h>

static bool is_operator(const hp_graph_node *node, hp_operator operator) {
    return node->kind == HP_NODE_OPERATOR && node->operator== operator;
}

/* Whether each gate is only the inner part of wider gates of its kind: all its users are. To be freed. */
static bool *find_melted(const hp_graph *graph) {
    bool *melted = calloc(graph->nodes + 1, 2 * sizeof *melted), *widened = melted + graph->nodes;
    if (!melted) return NULL;
    for (unsigned i = graph->nodes; i-- > 0;) {
        const hp_graph_node *user = &graph->node[i];
        for (unsigned k = 0; k < user->operands; k++) {
            unsigned used = user->operand[k];
            bool wider = is_operator(&graph->node[used], HP_OP_AND) || is_operator(&graph->node[used], HP_OP_OR);
            if (wider && is_operator(user, graph->node[used].operator))
                melted[used] = true;
            else
                widened[used] = true;
        }
    }
    for (unsigned i = 0; i < graph->nodes; i++) melted[i] = melted[i] && !widened[i];
    return melted;
}

/* Whether node n, a min or max, has an earlier counterpart on the same two numbers. */
static bool shares_comparator(const hp_graph *graph, unsigned n) {
    const hp_graph_node *node = &graph->node[n];
    hp_operator counterpart = node->operator== HP_OP_MIN ? HP_OP_MAX : HP_OP_MIN;
    for (unsigned i = n; i-- > 0;)
        if (is_operator(&graph->node[i], counterpart) &&
            memcmp(graph->node[i].operand, node->operand, 2 * sizeof(unsigned)) == 0)
            return true;
    return false;
}

static void count(const hp_graph *graph, unsigned n, bool melted, hp_pipe_cost *cost) {
    switch (graph->node[n].operator) {
    case HP_OP_ADD:
        cost->adders++;
        break;
    case HP_OP_SUB:
        cost->subtractors++;
        break;
    case HP_OP_MUL:
        cost->multipliers++;
        break;
    case HP_OP_DIV:
        cost->dividers++;
        break;
    case HP_OP_SQRT:
        cost->square_roots++;
        break;
    case HP_OP_COMPARE:
        cost->comparators++;
        break;
    case HP_OP_MIN:
    case HP_OP_MAX:
        cost->selects++;
        if (!shares_comparator(graph, n)) cost->comparators++;
        break;
    case HP_OP_SELECT:
        cost->selects++;
        break;
    case HP_OP_AND:
        cost->ands += !melted;
        break;
    case HP_OP_OR:
        cost->ors += !melted;
        break;
    case HP_OP_NOT:
    case HP_OP_NEG:
    case HP_OP_ABS:
    case HP_OP_COUNT:
        break;
    }
}

/* Clocks of one operator. */
static unsigned latency(hp_operator operator, const hp_config * config) {
    if (operator<HP_OP_TIMED) return (unsigned)config->operator_clocks[operator];
    bool compares = operator== HP_OP_MIN || operator== HP_OP_MAX;
    return compares ? (unsigned)config->operator_clocks[HP_OP_COMPARE] : 0;
}

/* Levels of one operator: gates and wires take none. */
static unsigned level(hp_operator operator) {
    return operator<HP_OP_TIMED || operator== HP_OP_MIN || operator== HP_OP_MAX;
}

/* The longest path to each node; in levels without a config, else in clocks. Leaving loop l takes its clocks. */
static unsigned *longest(const hp_graph *graph, const hp_config *config) {
    unsigned *depth = calloc(graph->nodes + 1, sizeof *depth);
    if (!depth || graph->failed) {
        free(depth);
        return NULL;
    }
    for (unsigned i = 0; i < graph->nodes; i++) {
        const hp_graph_node *node = &graph->node[i];
        for (unsigned k = 0; k < node->operands; k++) {
            const hp_graph_node *from = &graph->node[node->operand[k]];
            bool leaves = config && from->loop && from->loop != node->loop;
            unsigned there = depth[node->operand[k]] + (leaves ? graph->loop_clocks[from->loop] : 0);
            if (there > depth[i]) depth[i] = there;
        }
        if (node->kind == HP_NODE_OPERATOR)
            depth[i] += config ? latency(node->operator, config) : level(node->operator);
    }
    return depth;
}

unsigned *hp_graph_levels(const hp_graph *graph) {
    return longest(graph, NULL);
}

unsigned *hp_graph_clocks(const hp_graph *graph, const hp_config *config) {
    return longest(graph, config);
}

static unsigned most(const unsigned *of, unsigned n) {
    unsigned best = 0;
    for (unsigned i = 0; i < n; i++)
        if (of[i] > best) best = of[i];
    return best;
}

hp_pipe_cost hp_graph_cost(const hp_graph *graph, const hp_config *config) {
    hp_pipe_cost cost = {0};
    bool *melted = find_melted(graph);
    unsigned *levels = hp_graph_levels(graph), *clocks = hp_graph_clocks(graph, config);
    if (melted && levels && clocks) {
        for (unsigned i = 0; i < graph->nodes; i++)
            if (graph->node[i].kind == HP_NODE_OPERATOR && !graph->node[i].folded) count(graph, i, melted[i], &cost);
        cost.levels = most(levels, graph->nodes);
        cost.clocks = most(clocks, graph->nodes);
        cost.interval = graph->interval;
    }
    free(melted);
    free(levels);
    free(clocks);
    return cost;
}
