/* The pipes in binary128. */
#define HP_CALLED /* names.h: nothing here has to melt into its caller */
#include "rtl_model/pipes/quad.h"
#include "rtl_model/number/environment.h"
#include "rtl_model/pipes/wide.h"
#include <math.h>

#define HP_MEANING quad
#include "rtl_model/number/quad.h"

#include "rtl_model/pipes/every.pipe.h"

static void load_words(const float *in, unsigned n, num *out) {
    for (unsigned i = 0; i < n; i++) out[i] = in[i];
}

HP_APART answer run(hp_pair pair, bool separation, const float *primary, const float *secondary) {
    num p[HP_OBJECT_WORDS_MAX], s[HP_OBJECT_WORDS_MAX], prepared[HP_PREPARED_MAX];
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    case HP_PAIR_##NAME:                                                                                             \
        load_words(primary, HP_##PRIMARY##_WORDS, p);                                                                \
        load_words(secondary, HP_##SECONDARY##_WORDS, s);                                                            \
        quad_##name##_prepare(s, prepared);                                                                          \
        return quad_##name##_test(p, prepared, 0, separation, constant(-INFINITY));
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return miss();
}

hp_quad_result hp_quad_pipe_test(hp_pair pair, bool separation, const float *primary, const float *secondary) {
    hp_environment before = hp_environment_enter(false);
    answer a = run(pair, separation, primary, secondary);
    hp_environment_leave(before);
    return a.any ? (hp_quad_result){a.F, a.T, {a.CP.x, a.CP.y, a.CP.z}} : (hp_quad_result){.T = (hp_quad)INFINITY};
}
