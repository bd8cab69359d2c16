/* Building an operator graph. */
#include "rtl_model/number/graph.h"
#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { BUCKETS = 4096, ROOM_FIRST = 1024 };

void hp_graph_begin(hp_graph *graph) {
    *graph = (hp_graph){.interval = 1};
    graph->bucket = calloc(BUCKETS, sizeof *graph->bucket);
    graph->failed = !graph->bucket;
}

void hp_graph_free(hp_graph *graph) {
    free(graph->node);
    free(graph->bucket);
    free(graph->loop_clocks);
}

/* ---- nodes ---- */

static bool make_room(hp_graph *graph) {
    if (graph->failed || graph->nodes < graph->room) return !graph->failed;
    unsigned room = graph->room ? 2 * graph->room : ROOM_FIRST;
    hp_graph_node *node = realloc(graph->node, room * sizeof *node);
    if (!node) {
        graph->failed = true;
        return false;
    }
    graph->node = node;
    graph->room = room;
    return true;
}

static unsigned hash(const hp_graph_node *node) {
    unsigned h = (unsigned)node->kind * 31 + (unsigned)node->operator* 7 + node->variant, value;
    memcpy(&value, &node->value, sizeof value);
    h = h * 0x9E3779B1u ^ value;
    for (unsigned i = 0; i < node->operands; i++) h = (h ^ node->operand[i]) * 0x85EBCA6Bu;
    return (h ^ h >> 15) % BUCKETS;
}

static bool equal(const hp_graph_node *a, const hp_graph_node *b) {
    return a->kind == b->kind &&
           a->operator== b->operator&& a->variant == b->variant &&
               memcmp(&a->value, &b->value, sizeof a->value) == 0 &&
           memcmp(a->operand, b->operand, sizeof a->operand) == 0;
}

static unsigned add_node(hp_graph *graph, hp_graph_node node) {
    if (!make_room(graph)) return 0;
    node.folded = graph->depth && graph->folded[graph->depth - 1];
    node.loop = graph->depth ? graph->loops : 0;
    if (node.kind != HP_NODE_INPUT) {
        unsigned *first = &graph->bucket[hash(&node)];
        node.next = *first;
        *first = graph->nodes + 1;
    }
    graph->node[graph->nodes] = node;
    return graph->nodes++;
}

static unsigned find_or_add(hp_graph *graph, hp_graph_node node) {
    if (graph->failed) return 0;
    for (unsigned at = graph->bucket[hash(&node)]; at; at = graph->node[at - 1].next)
        if (equal(&graph->node[at - 1], &node)) return at - 1;
    return add_node(graph, node);
}

unsigned hp_graph_input(hp_graph *graph) {
    return add_node(graph, (hp_graph_node){.kind = HP_NODE_INPUT});
}

unsigned hp_graph_constant(hp_graph *graph, float value) {
    return find_or_add(graph, (hp_graph_node){.kind = HP_NODE_CONSTANT, .value = value});
}

unsigned hp_graph_operator(hp_graph *graph, hp_operator operator, unsigned variant, unsigned operands,
                           const unsigned *operand) {
    hp_graph_node node = {.kind = HP_NODE_OPERATOR, .operator= operator, .variant = variant, .operands = operands};
    memcpy(node.operand, operand, operands * sizeof *operand);
    return find_or_add(graph, node);
}

/* ---- loops ---- */

static void note_loop(hp_graph *graph) {
    unsigned *clocks = realloc(graph->loop_clocks, (graph->loops + 2) * sizeof *clocks);
    graph->failed = graph->failed || !clocks;
    if (!clocks) return;
    graph->loop_clocks = clocks;
    clocks[++graph->loops] = 0;
}

unsigned hp_graph_repeat(hp_graph *graph, unsigned steps) {
    assert(graph->depth < HP_GRAPH_NESTING);
    if (graph->depth == 0) note_loop(graph);
    unsigned outer = graph->depth ? graph->steps[graph->depth - 1] : 1;
    graph->steps[graph->depth++] = outer * steps;
    if (outer * steps > graph->interval) graph->interval = outer * steps;
    if (!graph->failed && outer * steps - 1 > graph->loop_clocks[graph->loops])
        graph->loop_clocks[graph->loops] = outer * steps - 1;
    return 0;
}

bool hp_graph_repeating(hp_graph *graph, unsigned step, unsigned steps) {
    if (step >= steps) {
        graph->depth--;
        return false;
    }
    bool outer = graph->depth > 1 && graph->folded[graph->depth - 2];
    graph->folded[graph->depth - 1] = outer || step > 0;
    return true;
}
