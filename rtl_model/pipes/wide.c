/* The wide pipes of one instruction set. Compiled once for each: HP_WIDE_ISA names it, HP_WIDE_ISA_name is 1. */
#include "rtl_model/pipes/wide.h"
#include "rtl_model/number/environment.h"
#include <math.h>
#include <string.h>

#if HP_WIDE_ISA_avx512
#include "rtl_model/number/arch/avx512.h"
#elif HP_WIDE_ISA_avx2
#include "rtl_model/number/arch/avx2.h"
#elif HP_WIDE_ISA_sse2
#include "rtl_model/number/arch/sse2.h"
#elif HP_WIDE_ISA_neon
#include "rtl_model/number/arch/neon.h"
#elif HP_WIDE_ISA_plain
#include "rtl_model/number/arch/plain.h"
#endif

/* A loop over the words of an object, which must vanish so that the words live in registers. */
#ifdef __clang__
#define foreach(w, n) _Pragma("unroll") for (unsigned w = 0; w < (n); w++)
#else
#define foreach(w, n) _Pragma("GCC unroll 32") for (unsigned w = 0; w < (n); w++)
#endif
#define HP_CHUNK (HP_VECTORS * HP_LANES)

/* Words of each pipe's objects: ray_triangle_primary_words is 6. */
enum {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    name##_primary_words = HP_##PRIMARY##_WORDS, name##_secondary_words = HP_##SECONDARY##_WORDS,                    \
    name##_prepared_words = words,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};

#include "rtl_model/pipes/square.h"

#define HP_MEANING gradual
#define HP_WIDE_FLUSH 0
#include "rtl_model/pipes/wide_pipes.h"

/* The kernel for one way of underflow: the same code where MXCSR flushes, else a second set. */
#if HP_FLUSH_IN_HARDWARE
#define HP_KERNEL(kernel, flush) gradual_##kernel
#else
#define HP_KERNEL(kernel, flush) (flush ? flush_##kernel : gradual_##kernel)
#undef HP_MEANING
#undef HP_WIDE_FLUSH
#define HP_MEANING flush
#define HP_WIDE_FLUSH 1
#include "rtl_model/pipes/wide_pipes.h"
#endif

#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    static void name##_prepare(const float *secondaries, size_t n, const float *matrix, bool flush,                  \
                               float *prepared) {                                                                    \
        hp_environment before = hp_environment_enter(HP_FLUSH_IN_HARDWARE && flush);                                 \
        HP_KERNEL(name##_prepares, flush)(secondaries, n, matrix, prepared);                                         \
        hp_environment_leave(before);                                                                                \
    }                                                                                                                \
    static void name##_closest(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,   \
                               uint32_t index, bool flush, hp_best *best) {                                          \
        hp_environment before = hp_environment_enter(HP_FLUSH_IN_HARDWARE && flush);                                 \
        HP_KERNEL(name##_closest, flush)(lanes, from, to, prepared, n, index, best);                                 \
        hp_environment_leave(before);                                                                                \
    }                                                                                                                \
    static void name##_any(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,       \
                           uint32_t index, bool flush, hp_best *best) {                                              \
        hp_environment before = hp_environment_enter(HP_FLUSH_IN_HARDWARE && flush);                                 \
        HP_KERNEL(name##_any, flush)(lanes, from, to, prepared, n, index, best);                                     \
        hp_environment_leave(before);                                                                                \
    }                                                                                                                \
    static void name##_pairs(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,      \
                             const float *matrix, bool flush, const hp_pairs_out *out) {                             \
        hp_environment before = hp_environment_enter(HP_FLUSH_IN_HARDWARE && flush);                                 \
        HP_KERNEL(name##_pairs, flush)(primaries, primary_step, secondaries, n, matrix, out);                        \
        hp_environment_leave(before);                                                                                \
    }                                                                                                                \
    static const hp_wide_pipe name = {name##_prepare, name##_closest, name##_any, name##_pairs};
#include <hitpipe/pairs.def>
#undef HP_PAIR

const hp_wide_pipe *HP_PASTE(hp_wide, HP_WIDE_ISA)(hp_pair pair);

const hp_wide_pipe *HP_PASTE(hp_wide, HP_WIDE_ISA)(hp_pair pair) {
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    case HP_PAIR_##NAME:                                                                                             \
        return &name;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return NULL;
}
