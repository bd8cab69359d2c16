/* Building, counting and timing an operator graph. */
#include "rtl_model/number/graph.h"
#include <assert.h>
#include <string.h>

static unsigned add_node(hp_graph *graph, const hp_graph_node *node) {
    assert(graph->nodes < HP_GRAPH_NODES);
    graph->node[graph->nodes] = *node;
    return graph->nodes++;
}

unsigned hp_graph_input(hp_graph *graph) {
    return add_node(graph, &(hp_graph_node){.kind = HP_NODE_INPUT});
}

unsigned hp_graph_constant(hp_graph *graph, float value) {
    for (unsigned i = 0; i < graph->nodes; i++) {
        const hp_graph_node *n = &graph->node[i];
        if (n->kind == HP_NODE_CONSTANT && memcmp(&n->value, &value, sizeof value) == 0) return i;
    }
    return add_node(graph, &(hp_graph_node){.kind = HP_NODE_CONSTANT, .value = value});
}

unsigned hp_graph_operator(hp_graph *graph, hp_operator operator, unsigned variant, unsigned operands,
                           const unsigned *operand) {
    for (unsigned i = 0; i < graph->nodes; i++) {
        const hp_graph_node *n = &graph->node[i];
        if (n->kind == HP_NODE_OPERATOR && n->operator== operator&& n->variant == variant &&
                                               memcmp(n->operand, operand, operands * sizeof *operand) == 0)
            return i;
    }
    hp_graph_node node = {.kind = HP_NODE_OPERATOR, .operator= operator, .variant = variant, .operands = operands};
    memcpy(node.operand, operand, operands * sizeof *operand);
    return add_node(graph, &node);
}

static bool is_operator(const hp_graph *graph, unsigned n, hp_operator operator) {
    return graph->node[n].kind == HP_NODE_OPERATOR && graph->node[n].operator== operator;
}

/* Whether gate n is only the inner part of wider gates of its kind: all its users are. */
static bool melts(const hp_graph *graph, unsigned n) {
    unsigned users = 0;
    for (unsigned i = n + 1; i < graph->nodes; i++)
        for (unsigned k = 0; k < graph->node[i].operands; k++)
            if (graph->node[i].operand[k] == n) {
                users++;
                if (!is_operator(graph, i, graph->node[n].operator)) return false;
            }
    return users > 0;
}

/* Whether node n, a min or max, has an earlier counterpart on the same two numbers. */
static bool shares_comparator(const hp_graph *graph, unsigned n) {
    const hp_graph_node *node = &graph->node[n];
    hp_operator counterpart = node->operator== HP_OP_MIN ? HP_OP_MAX : HP_OP_MIN;
    for (unsigned i = 0; i < n; i++)
        if (is_operator(graph, i, counterpart) &&
            memcmp(graph->node[i].operand, node->operand, 2 * sizeof(unsigned)) == 0)
            return true;
    return false;
}

static void count(const hp_graph *graph, unsigned n, hp_pipe_cost *cost) {
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
        cost->ands += !melts(graph, n);
        break;
    case HP_OP_OR:
        cost->ors += !melts(graph, n);
        break;
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

/* The longest path to node n; in levels without a config, else in clocks. */
static unsigned longest(const hp_graph *graph, unsigned n, const hp_config *config) {
    unsigned depth[HP_GRAPH_NODES];
    for (unsigned i = 0; i <= n; i++) {
        const hp_graph_node *node = &graph->node[i];
        depth[i] = 0;
        for (unsigned k = 0; k < node->operands; k++)
            if (depth[node->operand[k]] > depth[i]) depth[i] = depth[node->operand[k]];
        if (node->kind == HP_NODE_OPERATOR)
            depth[i] += config ? latency(node->operator, config) : level(node->operator);
    }
    return depth[n];
}

unsigned hp_graph_levels(const hp_graph *graph, unsigned n) {
    return longest(graph, n, NULL);
}

unsigned hp_graph_clocks(const hp_graph *graph, unsigned n, const hp_config *config) {
    return longest(graph, n, config);
}

hp_pipe_cost hp_graph_cost(const hp_graph *graph, const hp_config *config) {
    hp_pipe_cost cost = {0};
    for (unsigned i = 0; i < graph->nodes; i++) {
        if (graph->node[i].kind != HP_NODE_OPERATOR) continue;
        count(graph, i, &cost);
        unsigned levels = hp_graph_levels(graph, i), clocks = hp_graph_clocks(graph, i, config);
        if (levels > cost.levels) cost.levels = levels;
        if (clocks > cost.clocks) cost.clocks = clocks;
    }
    return cost;
}
