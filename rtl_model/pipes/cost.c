/* What pipes and transformer cost: their texts carried out on the operator graph. */
#include "rtl_model/pipes/wide.h"
#include <assert.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <string.h>

#define HP_MEANING graph
#include "rtl_model/number/graph_numbers.h"

#include "rtl_model/pipes/every.pipe.h"
#include "rtl_model/transformer/transformer.pipe.h"

static void take_inputs(hp_graph *g, unsigned n, num *in) {
    for (unsigned i = 0; i < n; i++) in[i] = (num){.graph = g, .node = hp_graph_input(g)};
}

/* Clocks until the number is there that an output multiplexer passes on in a hit. */
static unsigned clocks_before_select(num output, const hp_config *config) {
    unsigned passed = output.graph->node[output.node].operand[1];
    return hp_graph_clocks(output.graph, passed, config);
}

static void time_outputs(answer a, const hp_config *config, hp_pipe_cost *cost) {
    unsigned x = clocks_before_select(a.CP.x, config), y = clocks_before_select(a.CP.y, config),
             z = clocks_before_select(a.CP.z, config), xy = x > y ? x : y;
    cost->clocks_F = hp_graph_clocks(a.F.graph, a.F.node, config);
    cost->clocks_T = clocks_before_select(a.T, config);
    cost->clocks_CP = xy > z ? xy : z;
}

hp_pipe_cost hp_pipe_cost_of(hp_pair pair, const hp_config *config) {
    hp_graph g = {0};
    num primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX], prepared[HP_PREPARED_MAX], index;
    answer a = miss();
    take_inputs(&g, hp_object_words(hp_pair_primary(pair)), primary);
    take_inputs(&g, hp_object_words(hp_pair_secondary(pair)), secondary);
    take_inputs(&g, 1, &index);
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    case HP_PAIR_##NAME:                                                                                             \
        graph_##name##_prepare(secondary, prepared);                                                                 \
        a = graph_##name##_test(primary, prepared, index);                                                           \
        break;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    hp_pipe_cost cost = hp_graph_cost(&g, config);
    if (a.any) time_outputs(a, config, &cost);
    cost.inputs = hp_object_words(hp_pair_secondary(pair));
    cost.outputs = 6; /* F, index, T, CP xyz */
    cost.interval = 1;
    return cost;
}

hp_pipe_cost hp_transformer_cost_of(hp_object object, const hp_config *config) {
    hp_graph g = {0};
    num matrix[12], secondary[HP_OBJECT_WORDS_MAX], moved[HP_OBJECT_WORDS_MAX];
    take_inputs(&g, 12, matrix);
    take_inputs(&g, hp_object_words(object), secondary);
#define HP_MOVED(NAME)                                                                                               \
    if (object == HP_##NAME) graph_transform_##NAME(matrix, secondary, moved);
#include "rtl_model/transformer/transformer.def"
#undef HP_MOVED
    hp_pipe_cost cost = hp_graph_cost(&g, config);
    cost.inputs = cost.outputs = hp_object_words(object);
    cost.interval = 1;
    return cost;
}
