/* One wide pipe on one instruction set. Compiled once for each two: HP_WIDE_ISA names the instruction set and
 * HP_WIDE_ISA_name is 1; HP_PIPE names the pipe and HP_PIPE_FILE is its text. */
#include "rtl_model/pipes/wide.h"
#include "rtl_model/number/environment.h"
#include "rtl_model/number/one_nan.h"
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
#define foreach(w, n) HP_EACH (w, 0, n)
#define HP_CHUNK (HP_VECTORS * HP_LANES)

/* Words of each pipe's objects: ray_triangle_primary_words is 6. */
enum {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    name##_primary_words = HP_##PRIMARY##_WORDS, name##_secondary_words = HP_##SECONDARY##_WORDS,                    \
    name##_prepared_words = words, name##_keeps_deepest = HP_##PRIMARY != HP_RAY,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};

#include "rtl_model/pipes/square.h"

/* What one chunk of primaries keeps of n prepared secondaries. */
typedef void hp_chunk_kernel(const float *primary, const float *prepared, size_t n, uint32_t index, float *best_T,
                             uint32_t *best_index, uint32_t *best_F);

#define HP_MEANING gradual
#define HP_WIDE_FLUSH 0
#include "rtl_model/pipes/wide_pipe.h"

/* The kernel for one way of underflow: the same code where MXCSR flushes, else a second set. */
#if HP_FLUSH_IN_HARDWARE
#define HP_KERNEL(kernel, flush) HP_PASTE(gradual, kernel)
#else
#define HP_KERNEL(kernel, flush) (flush ? HP_PASTE(flush, kernel) : HP_PASTE(gradual, kernel))
#undef HP_MEANING
#undef HP_WIDE_FLUSH
#define HP_MEANING flush
#define HP_WIDE_FLUSH 1
#include "rtl_model/pipes/wide_pipe.h"
#endif

/* Runs a kernel under the environment that `flush` asks for. */
#define HP_IN_ENVIRONMENT(kernel, ...)                                                                               \
    {                                                                                                                \
        hp_environment before = hp_environment_enter(HP_FLUSH_IN_HARDWARE && flush);                                 \
        HP_KERNEL(HP_PASTE(HP_PIPE, kernel), flush)(__VA_ARGS__);                                                    \
        hp_environment_leave(before);                                                                                \
    }

static void prepare(const float *secondaries, size_t n, const float *matrix, bool flush, float *prepared)
    HP_IN_ENVIRONMENT(prepares, secondaries, n, matrix, prepared)

#define HP_KEEPING(kept)                                                                                             \
    static void kept(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,             \
                     uint32_t index, bool flush, hp_best *best)                                                      \
        HP_IN_ENVIRONMENT(kept, lanes, from, to, prepared, n, index, best)
        HP_KEEPING(closest) HP_KEEPING(any) HP_KEEPING(nearest)

#define HP_PAIRING(kernel)                                                                                           \
    static void kernel(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,            \
                       const float *matrix, bool flush, const hp_pairs_out *out)                                     \
        HP_IN_ENVIRONMENT(kernel, primaries, primary_step, secondaries, n, matrix, out)
            HP_PAIRING(pairs) HP_PAIRING(distances)

#define HP_TABLE HP_PASTE(HP_PASTE(hp_wide, HP_WIDE_ISA), HP_PIPE)
                extern const hp_wide_pipe HP_TABLE;
const hp_wide_pipe HP_TABLE = {prepare, closest, any, nearest, pairs, distances};
