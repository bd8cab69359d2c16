/* What pipes and transformer cost: their texts carried out on the operator graph. */
#define HP_CALLED /* names.h: nothing here has to melt into its caller */
#include "rtl_model/pipes/wide.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HP_MEANING graph
#include "rtl_model/number/graph_numbers.h"

#include "rtl_model/pipes/every.pipe.h"
#include "rtl_model/transformer/transformer.pipe.h"

static void take_inputs(hp_graph *g, unsigned n, num *in) {
    for (unsigned i = 0; i < n; i++) in[i] = (num){.wired = true, .node = hp_graph_input(g)};
}

/* Clocks until the number is there that an output multiplexer passes on in a hit. */
static unsigned before_select(const hp_graph *g, const unsigned *clocks, num output) {
    return clocks[g->node[output.node].operand[1]];
}

static void time_outputs(const hp_graph *g, answer a, const hp_config *config, hp_pipe_cost *cost) {
    unsigned *clocks = hp_graph_clocks(g, config);
    if (!clocks) return;
    unsigned x = before_select(g, clocks, a.CP.x), y = before_select(g, clocks, a.CP.y),
             z = before_select(g, clocks, a.CP.z), xy = x > y ? x : y;
    cost->clocks_F = clocks[a.F.node];
    cost->clocks_T = before_select(g, clocks, a.T);
    cost->clocks_CP = xy > z ? xy : z;
    free(clocks);
}

static answer trace_pipe(hp_graph *g, hp_pair pair, bool separation) {
    num primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX], prepared[HP_PREPARED_MAX], index;
    graph_traced = g;
    take_inputs(g, hp_object_words(hp_pair_primary(pair)), primary);
    take_inputs(g, hp_object_words(hp_pair_secondary(pair)), secondary);
    take_inputs(g, 1, &index);
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    case HP_PAIR_##NAME:                                                                                             \
        graph_##name##_prepare(secondary, prepared);                                                                 \
        return separation ? graph_##name##_test(primary, prepared, index, true, constant(-INFINITY))                 \
                          : graph_##name##_test(primary, prepared, index, false, constant(-INFINITY));
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return miss();
}

hp_pipe_cost hp_pipe_cost_of(hp_pair pair, bool separation, const hp_config *config) {
    hp_graph g;
    hp_graph_begin(&g);
    answer a = trace_pipe(&g, pair, separation);
    hp_pipe_cost cost = hp_graph_cost(&g, config);
    if (a.any && !g.failed) time_outputs(&g, a, config, &cost);
    hp_graph_free(&g);
    cost.inputs = hp_object_words(hp_pair_secondary(pair));
    cost.outputs = 6; /* F, index, T, CP xyz */
    return cost;
}

hp_pipe_cost hp_transformer_cost_of(hp_object object, const hp_config *config) {
    hp_graph g;
    num matrix[12], secondary[HP_OBJECT_WORDS_MAX], moved[HP_OBJECT_WORDS_MAX];
    hp_graph_begin(&g);
    graph_traced = &g;
    take_inputs(&g, 12, matrix);
    take_inputs(&g, hp_object_words(object), secondary);
#define HP_MOVED(NAME)                                                                                               \
    if (object == HP_##NAME) graph_transform_##NAME(matrix, secondary, moved);
#include "rtl_model/transformer/transformer.def"
#undef HP_MOVED
    hp_pipe_cost cost = hp_graph_cost(&g, config);
    hp_graph_free(&g);
    cost.inputs = cost.outputs = hp_object_words(object);
    return cost;
}
