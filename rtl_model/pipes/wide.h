/* The pipes as wide lanes: one source (wide.c) compiled once per pipe and instruction set, chosen at run time.
 *
 * Same bits as hp_pipe_test, always. Only the quick engine and the benches call these; primaries lie in structure-of-
 * arrays, as in the block RAM of the primary register file, and one prepared secondary at a time meets all of them.
 */
#ifndef HITPIPE_PIPES_WIDE_H
#define HITPIPE_PIPES_WIDE_H

#include <hitpipe/types.h>
#include <math.h>

enum {
    HP_BLOCK = 512,      /* secondaries prepared at a time: their prepared words stay in the first-level cache */
    HP_PREPARED_MAX = 32 /* most prepared words of a secondary */
};

/* A packet of primaries: word w of primary i is word[w][i]. Entries from `count` up to the next multiple of 16 must
 * be zero: they are computed and ignored. */
typedef struct hp_lanes {
    _Alignas(64) float word[HP_OBJECT_WORDS_MAX][HP_PACKET_PRIMARIES];
} hp_lanes;

/* What a packet has found so far; hp_best_begin is how it begins. T of a primary that has found nothing means
 * nothing.
 */
typedef struct hp_best {
    _Alignas(64) float T[HP_PACKET_PRIMARIES];
    _Alignas(64) uint32_t index[HP_PACKET_PRIMARIES];
    _Alignas(64) uint32_t F[HP_PACKET_PRIMARIES]; /* `nearest` only: what was found is a hit */
} hp_best;

static inline void hp_best_begin(hp_best *best, hp_pair pair, bool nearest) {
    float worst = hp_pair_keeps_deepest(pair) && !nearest ? -INFINITY : INFINITY;
    for (unsigned i = 0; i < HP_PACKET_PRIMARIES; i++) {
        best->T[i] = worst;
        best->index[i] = HP_NO_INDEX;
        best->F[i] = 0;
    }
}

/* F and T of n pairs, structure-of-arrays out. */
typedef struct hp_pairs_out {
    uint32_t *F;
    float *T;
    float *CP[3];
} hp_pairs_out;

typedef struct hp_wide_pipe {
    /* Prepares n <= HP_BLOCK secondaries (objects in DDR word order, `words` floats each) for the two below:
     * `prepared` floats each, 64-byte aligned. With matrix != NULL they pass through the transformer first. */
    void (*prepare)(const float *secondaries, size_t n, const float *matrix, bool flush, float *prepared);
    /* Mode closest: tests primaries [from, to) (from a multiple of 16) against n prepared secondaries, numbered from
     * `index`, keeping in *best the smallest T (ray pairs) or the largest (the others), of equal ones the first. */
    void (*closest)(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,
                    uint32_t index, bool flush, hp_best *best);
    /* Mode any: as closest, but keeps the hit of lowest index; a primary with best->index set is not tested again
     * where that saves work. */
    void (*any)(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n, uint32_t index,
                bool flush, hp_best *best);
    /* Mode closest with the option nearest: as closest, but a miss with the smallest distance is kept where there is
     * no hit. */
    void (*nearest)(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,
                    uint32_t index, bool flush, hp_best *best);
    /* Modes all and zip: pair i is primary (i * primary_step) with secondary i; primary_step 0 or 1. Whole objects in
     * word order in, one after another. Any n. */
    void (*pairs)(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,
                  const float *matrix, bool flush, const hp_pairs_out *out);
    /* The same with the distance of a miss in T. */
    void (*distances)(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,
                      const float *matrix, bool flush, const hp_pairs_out *out);
} hp_wide_pipe;

/* The wide pipe of a pair on an instruction set of hp_isa_name, or NULL when there is none. */
const hp_wide_pipe *hp_wide_pipe_of(const char *isa, hp_pair pair);

#endif
