/* The pipes seen from outside the board: their scalar reference and what they cost in hardware.
 *
 * Pure functions; any thread. The arithmetic itself stands once, in rtl_model/pipes/NAME.pipe.h. */
#ifndef HITPIPE_PIPE_H
#define HITPIPE_PIPE_H

#include <hitpipe/config.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One pair through the scalar binary32 datapath: the reference for every bit. With `separation`, T of a miss is the
 * distance between the two objects; without it +inf, and the work is not done. `primary` and `secondary` are objects
 * of the pair's types in the word order of objects.def; `index` goes into the result of a hit. Stencil is 1. The
 * result depends on the words and `subnormals` alone, whatever the caller's floating-point environment. */
hp_result hp_pipe_test(hp_pair pair, hp_subnormals subnormals, bool separation, const float *primary,
                       const float *secondary, uint32_t index);

/* What a pipe is made of, read off its operator graph. The body of a loop counts once: it is used once a step. */
typedef struct hp_pipe_cost {
    unsigned multipliers, dividers, square_roots, adders, subtractors;
    unsigned comparators; /* a min and a max of the same two numbers share one */
    unsigned ands;        /* multi-input */
    unsigned ors, selects;
    unsigned inputs;  /* secondary words */
    unsigned outputs; /* F, index, T, CP xyz */
    unsigned levels;  /* operators on the longest path, loops unrolled; gates and wires count 0, a multiplexer 1 */
    unsigned clocks;  /* latency under the operator table: when the last output leaves */
    unsigned clocks_F, clocks_T,
        clocks_CP;     /* when each leaves its last arithmetic operator, before the output multiplexer */
    unsigned interval; /* clocks between two tests in one lane: steps of the longest loop; 1 without loops */
} hp_pipe_cost;

/* Cost of a pipe under config's operator table, with or without the distance of a miss. levels is 0 when out of
 * memory. */
hp_pipe_cost hp_pipe_cost_of(hp_pair pair, bool separation, const hp_config *config);

/* Cost of the transformer's datapath for one secondary of this type (inputs, outputs in words). */
hp_pipe_cost hp_transformer_cost_of(hp_object object, const hp_config *config);

/* Moves one secondary by the 3x4 row-major matrix, through the transformer's scalar datapath. */
void hp_transform_object(hp_object object, hp_subnormals subnormals, const float matrix[12], const float *in,
                         float *out);

/* The instruction sets this build has wide lanes for and this processor can run, best first: "avx512", "avx2",
 * "sse2", "neon", "plain". NULL past the last. */
const char *hp_isa_name(unsigned i);

/* The one to use: `forced` if not NULL, else the environment's HP_ISA (empty: unset), else the best. NULL when that
 * one is not to be had. */
const char *hp_isa_choose(const char *forced);

#ifdef __cplusplus
}
#endif
#endif
