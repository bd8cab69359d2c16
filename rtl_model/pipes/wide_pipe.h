/* The pipe HP_PIPE in wide lanes under one way of underflow. No include guard; wide.c includes it once for each that
 * the instruction set needs code for, with HP_MEANING and HP_WIDE_FLUSH set. */
#include "rtl_model/number/wide.h"

#include "rtl_model/transformer/transformer.pipe.h"

/* The n words at `from` in every lane. */
HP_INLINE void HP_NAMED(broadcast)(const float *from, unsigned n, num *out) {
    foreach (w, n) out[w] = constant(from[w]);
}

/* n objects from array of structures into lanes and back, by squares of four objects and four words; the last square
 * of an object reaches back so as not to reach over its end. Lanes past n repeat object 0. */
HP_INLINE void HP_NAMED(gather)(const float *objects, size_t step, unsigned words, size_t n, num *out) {
    float lane[HP_PREPARED_MAX][HP_CHUNK];
    for (size_t i = 0; i < HP_CHUNK; i += 4) {
        const float *object[4];
        foreach (k, 4) object[k] = objects + (i + k < n ? i + k : 0) * step;
        foreach (group, (words + 3) / 4) {
            unsigned w = 4 * group + 4 <= words ? 4 * group : words - 4;
            square rows = square_load(object[0] + w, object[1] + w, object[2] + w, object[3] + w);
            square_store(square_turn(rows), &lane[w][i], &lane[w + 1][i], &lane[w + 2][i], &lane[w + 3][i]);
        }
    }
    foreach (w, words) out[w] = HP_NAMED(load)(lane[w]);
}

HP_INLINE void HP_NAMED(scatter)(const num *in, unsigned words, size_t n, float *objects) {
    float lane[HP_PREPARED_MAX][HP_CHUNK], spare[HP_PREPARED_MAX];
    foreach (w, words) HP_NAMED(store)(lane[w], in[w]);
    for (size_t i = 0; i < n; i += 4) {
        float *object[4];
        foreach (k, 4) object[k] = i + k < n ? objects + (i + k) * words : spare;
        foreach (group, (words + 3) / 4) {
            unsigned w = 4 * group + 4 <= words ? 4 * group : words - 4;
            square rows = square_load(&lane[w][i], &lane[w + 1][i], &lane[w + 2][i], &lane[w + 3][i]);
            square_store(square_turn(rows), object[0] + w, object[1] + w, object[2] + w, object[3] + w);
        }
    }
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
        for (size_t i = 0; i < HP_CHUNK; i++) T[i] = hp_one_nan(T[i]);
        for (unsigned axis = 0; axis < 3; axis++)
            for (size_t i = 0; i < HP_CHUNK; i++) CP[axis][i] = hp_one_nan(CP[axis][i]);
    }
    memcpy(out->F + at, F, n * sizeof *F);
    memcpy(out->T + at, T, n * sizeof *T);
    for (unsigned axis = 0; axis < 3; axis++) memcpy(out->CP[axis] + at, CP[axis], n * sizeof(float));
}

/* The transformer of this pipe's secondaries. */
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    HP_INLINE void HP_NAMED(name##_transform)(const num m[12], const num *in, num *out) {                            \
        HP_NAMED(transform_##SECONDARY)(m, in, out);                                                                 \
    }
#include <hitpipe/pairs.def>
#undef HP_PAIR

#include "rtl_model/pipes/parts.h"
#include HP_PIPE_FILE

#include "rtl_model/pipes/kernels.h"
