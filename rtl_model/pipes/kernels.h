/* The loops around the pipes in wide lanes, once for all pipes. No include guard; wide.c includes it once for each
 * way of underflow that the instruction set needs code for, with HP_MEANING and HP_WIDE_FLUSH set.
 *
 * Lanes are primaries in `closest` and `any`: a chunk of primaries stays in registers (or the first-level cache)
 * while the prepared secondaries stream by, each word broadcast. Lanes are pairs in `pairs`, and secondaries in
 * `prepare`. The loops take the pipe as functions, which inlining resolves. */
#include "rtl_model/number/wide.h"

#include "rtl_model/pipes/every.pipe.h"
#include "rtl_model/transformer/transformer.pipe.h"

/* A pipe to the loops below. */
typedef struct HP_NAMED(pipe) {
    void (*transform)(const num m[12], const num *in, num *out);
    void (*prepare)(const num *secondary, num *prepared);
    answer (*test)(const num *primary, const num *prepared, bits index);
    unsigned primary_words, secondary_words, prepared_words;
} HP_NAMED(pipe);

/* The n words at `from` in every lane. */
HP_INLINE void HP_NAMED(broadcast)(const float *from, unsigned n, num *out) {
    HP_UNROLL for (unsigned w = 0; w < n; w++) out[w] = constant(from[w]);
}

/* n objects from array of structures into lanes and back; lanes past n repeat object 0. */
HP_INLINE void HP_NAMED(gather)(const float *objects, size_t step, unsigned words, size_t n, num *out) {
    float lane[HP_PREPARED_MAX][HP_CHUNK];
    for (size_t i = 0; i < HP_CHUNK; i++) {
        const float *object = objects + (i < n ? i : 0) * step;
        HP_UNROLL for (unsigned w = 0; w < words; w++) lane[w][i] = object[w];
    }
    HP_UNROLL for (unsigned w = 0; w < words; w++) out[w] = HP_NAMED(load)(lane[w]);
}

HP_INLINE void HP_NAMED(scatter)(const num *in, unsigned words, size_t n, float *objects) {
    float lane[HP_PREPARED_MAX][HP_CHUNK];
    HP_UNROLL for (unsigned w = 0; w < words; w++) HP_NAMED(store)(lane[w], in[w]);
    for (size_t i = 0; i < n; i++) HP_UNROLL for (unsigned w = 0; w < words; w++) objects[i * words + w] = lane[w][i];
}

/* The matrix in every lane; false when the transformer is bypassed. */
HP_INLINE bool HP_NAMED(load_matrix)(const float *matrix, num m[12]) {
    if (!matrix) return false;
    float lane[HP_CHUNK];
    for (unsigned w = 0; w < 12; w++) {
        for (unsigned i = 0; i < HP_CHUNK; i++) lane[i] = matrix[w];
        m[w] = HP_NAMED(load)(lane);
    }
    return true;
}

/* Transforms, where there is a matrix, and prepares a chunk of secondaries. */
HP_INLINE void HP_NAMED(prepare_lanes)(HP_NAMED(pipe) pipe, bool moves, const num *m, const num *secondary,
                                       num *prepared) {
    num moved[HP_OBJECT_WORDS_MAX];
    if (moves) {
        pipe.transform(m, secondary, moved);
        pipe.prepare(moved, prepared);
    } else {
        pipe.prepare(secondary, prepared);
    }
}

HP_INLINE void HP_NAMED(prepare)(HP_NAMED(pipe) pipe, const float *secondaries, size_t n, const float *matrix,
                                 float *prepared) {
    num m[12], secondary[HP_OBJECT_WORDS_MAX], ready[HP_PREPARED_MAX];
    bool moves = HP_NAMED(load_matrix)(matrix, m);
    for (size_t i = 0; i < n; i += HP_CHUNK) {
        size_t lanes = n - i < HP_CHUNK ? n - i : HP_CHUNK;
        HP_NAMED(gather)
        (secondaries + i * pipe.secondary_words, pipe.secondary_words, pipe.secondary_words, lanes, secondary);
        HP_NAMED(prepare_lanes)(pipe, moves, m, secondary, ready);
        HP_NAMED(scatter)(ready, pipe.prepared_words, lanes, prepared + i * pipe.prepared_words);
    }
}

/* What one chunk of primaries keeps of n prepared secondaries. `primary` points at the chunk's lanes of word 0, the
 * next word is HP_PACKET_PRIMARIES floats on. */
HP_INLINE void HP_NAMED(closest_chunk)(HP_NAMED(pipe) pipe, const float *primary, const float *prepared, size_t n,
                                       uint32_t index, float *best_T, uint32_t *best_index) {
    num p[HP_OBJECT_WORDS_MAX];
    HP_UNROLL for (unsigned w = 0; w < pipe.primary_words; w++) p[w] =
        HP_NAMED(load)(primary + w * HP_PACKET_PRIMARIES);
    for (size_t i = 0; i < n; i++) {
        num s[HP_PREPARED_MAX];
        HP_NAMED(broadcast)(prepared + i * pipe.prepared_words, pipe.prepared_words, s);
        answer a = pipe.test(p, s, constant_bits(index + (uint32_t)i));
        if (!a.any) continue;
        num T = HP_NAMED(reload)(best_T);
        flag closer = and(a.F, less(a.T, T));
        HP_NAMED(store)(best_T, select(closer, a.T, T));
        HP_NAMED(store_bits)(best_index, select_bits(closer, a.index, HP_NAMED(load_bits)(best_index)));
    }
}

/* Stops when every lane has a hit. */
HP_INLINE void HP_NAMED(any_chunk)(HP_NAMED(pipe) pipe, const float *primary, const float *prepared, size_t n,
                                   uint32_t index, float *best_T, uint32_t *best_index) {
    num p[HP_OBJECT_WORDS_MAX];
    HP_UNROLL for (unsigned w = 0; w < pipe.primary_words; w++) p[w] =
        HP_NAMED(load)(primary + w * HP_PACKET_PRIMARIES);
    bits none = constant_bits(HP_NO_INDEX);
    flag open = HP_NAMED(same_bits)(HP_NAMED(load_bits)(best_index), none);
    for (size_t i = 0; i < n && HP_NAMED(any)(open); i++) {
        num s[HP_PREPARED_MAX];
        HP_NAMED(broadcast)(prepared + i * pipe.prepared_words, pipe.prepared_words, s);
        answer a = pipe.test(p, s, constant_bits(index + (uint32_t)i));
        if (!a.any) continue;
        flag first = and(a.F, open);
        bits found = select_bits(first, a.index, HP_NAMED(load_bits)(best_index));
        HP_NAMED(store)(best_T, select(first, a.T, HP_NAMED(reload)(best_T)));
        HP_NAMED(store_bits)(best_index, found);
        open = HP_NAMED(same_bits)(found, none);
    }
}

typedef void HP_NAMED(chunk_kernel)(HP_NAMED(pipe) pipe, const float *primary, const float *prepared, size_t n,
                                    uint32_t index, float *best_T, uint32_t *best_index);

/* Primaries [from, to) chunk by chunk. A last chunk that is not full is worked on in a copy, with done and zero lanes
 * behind it: another thread may own the primaries from `to` on. */
HP_INLINE void HP_NAMED(each_chunk)(HP_NAMED(chunk_kernel) * kernel, HP_NAMED(pipe) pipe, const hp_lanes *lanes,
                                    unsigned from, unsigned to, const float *prepared, size_t n, uint32_t index,
                                    hp_best *best) {
    for (; from + HP_CHUNK <= to; from += HP_CHUNK)
        kernel(pipe, &lanes->word[0][from], prepared, n, index, &best->T[from], &best->index[from]);
    if (from >= to) return;
    hp_lanes rest;
    hp_best kept;
    size_t bytes = (to - from) * sizeof(float);
    for (unsigned w = 0; w < pipe.primary_words; w++) {
        memset(rest.word[w], 0, HP_CHUNK * sizeof(float));
        memcpy(rest.word[w], &lanes->word[w][from], bytes);
    }
    memset(kept.index, 0, HP_CHUNK * sizeof(uint32_t));
    memset(kept.T, 0, HP_CHUNK * sizeof(float));
    memcpy(kept.index, &best->index[from], bytes);
    memcpy(kept.T, &best->T[from], bytes);
    kernel(pipe, rest.word[0], prepared, n, index, kept.T, kept.index);
    memcpy(&best->index[from], kept.index, bytes);
    memcpy(&best->T[from], kept.T, bytes);
}

HP_INLINE void HP_NAMED(write_pairs)(answer a, size_t n, size_t at, const hp_pairs_out *out) {
    uint32_t F[HP_CHUNK] = {0};
    float T[HP_CHUNK], CP[3][HP_CHUNK] = {{0}};
    for (size_t i = 0; i < HP_CHUNK; i++) T[i] = INFINITY;
    if (a.any) {
        HP_NAMED(store_bits)(F, select_bits(a.F, constant_bits(1), constant_bits(0)));
        HP_NAMED(store)(T, a.T);
        HP_NAMED(store)(CP[0], a.CP.x);
        HP_NAMED(store)(CP[1], a.CP.y);
        HP_NAMED(store)(CP[2], a.CP.z);
    }
    memcpy(out->F + at, F, n * sizeof *F);
    memcpy(out->T + at, T, n * sizeof *T);
    for (unsigned axis = 0; axis < 3; axis++) memcpy(out->CP[axis] + at, CP[axis], n * sizeof(float));
}

HP_INLINE void HP_NAMED(pairs)(HP_NAMED(pipe) pipe, const float *primaries, unsigned primary_step,
                               const float *secondaries, size_t n, const float *matrix, const hp_pairs_out *out) {
    num m[12], primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX], ready[HP_PREPARED_MAX];
    bool moves = HP_NAMED(load_matrix)(matrix, m);
    size_t step = primary_step * pipe.primary_words;
    HP_NAMED(gather)(primaries, 0, pipe.primary_words, 1, primary);
    for (size_t i = 0; i < n; i += HP_CHUNK) {
        size_t lanes = n - i < HP_CHUNK ? n - i : HP_CHUNK;
        if (step) HP_NAMED(gather)(primaries + i * step, step, pipe.primary_words, lanes, primary);
        HP_NAMED(gather)
        (secondaries + i * pipe.secondary_words, pipe.secondary_words, pipe.secondary_words, lanes, secondary);
        HP_NAMED(prepare_lanes)(pipe, moves, m, secondary, ready);
        HP_NAMED(write_pairs)(pipe.test(primary, ready, constant_bits(0)), lanes, i, out);
    }
}

/* The kernels of each pipe. */
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    static const HP_NAMED(pipe) HP_NAMED(name##_pipe) = {HP_NAMED(transform_##SECONDARY), HP_NAMED(name##_prepare),  \
                                                         HP_NAMED(name##_test),           HP_##PRIMARY##_WORDS,      \
                                                         HP_##SECONDARY##_WORDS,          words};                    \
    HP_APART void HP_NAMED(name##_prepares)(const float *secondaries, size_t n, const float *matrix,                 \
                                            float *prepared) {                                                       \
        HP_NAMED(prepare)(HP_NAMED(name##_pipe), secondaries, n, matrix, prepared);                                  \
    }                                                                                                                \
    HP_APART void HP_NAMED(name##_closest)(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, \
                                           size_t n, uint32_t index, hp_best *best) {                                \
        HP_NAMED(each_chunk)                                                                                         \
        (HP_NAMED(closest_chunk), HP_NAMED(name##_pipe), lanes, from, to, prepared, n, index, best);                 \
    }                                                                                                                \
    HP_APART void HP_NAMED(name##_any)(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared,     \
                                       size_t n, uint32_t index, hp_best *best) {                                    \
        HP_NAMED(each_chunk)(HP_NAMED(any_chunk), HP_NAMED(name##_pipe), lanes, from, to, prepared, n, index, best); \
    }                                                                                                                \
    HP_APART void HP_NAMED(name##_pairs)(const float *primaries, unsigned primary_step, const float *secondaries,    \
                                         size_t n, const float *matrix, const hp_pairs_out *out) {                   \
        HP_NAMED(pairs)(HP_NAMED(name##_pipe), primaries, primary_step, secondaries, n, matrix, out);                \
    }
#include <hitpipe/pairs.def>
#undef HP_PAIR
