/* The scalar datapaths under one way of underflow. No include guard; scalar.c includes it once for each, with
 * HP_MEANING and HP_SCALAR_FLUSH set. */
#include "rtl_model/number/scalar.h"

#include "rtl_model/pipes/every.pipe.h"
#include "rtl_model/transformer/transformer.pipe.h"

HP_INLINE void HP_NAMED(load_words)(const float *in, unsigned n, num *out) {
    for (unsigned i = 0; i < n; i++) out[i] = HP_NAMED(load)(in[i]);
}

HP_INLINE hp_result HP_NAMED(result_of)(answer a) {
    if (!a.any) return (hp_result){.index = HP_NO_INDEX, .T = INFINITY, .stencil = 1};
    return (hp_result){.F = a.F,
                       .index = a.index,
                       .T = hp_one_nan(a.T),
                       .CP = {hp_one_nan(a.CP.x), hp_one_nan(a.CP.y), hp_one_nan(a.CP.z)},
                       .stencil = 1};
}

HP_APART hp_result HP_NAMED(pipe_test)(hp_pair pair, bool separation, const float *primary, const float *secondary,
                                       uint32_t index) {
    num p[HP_OBJECT_WORDS_MAX], s[HP_OBJECT_WORDS_MAX], prepared[HP_PREPARED_MAX];
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words)                                                  \
    case HP_PAIR_##NAME:                                                                                             \
        HP_NAMED(load_words)(primary, HP_##PRIMARY##_WORDS, p);                                                      \
        HP_NAMED(load_words)(secondary, HP_##SECONDARY##_WORDS, s);                                                  \
        HP_NAMED(name##_prepare)(s, prepared);                                                                       \
        return HP_NAMED(result_of)(separation                                                                        \
                                       ? HP_NAMED(name##_test)(p, prepared, index, true, constant(-INFINITY))        \
                                       : HP_NAMED(name##_test)(p, prepared, index, false, constant(-INFINITY)));
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return HP_NAMED(result_of)(miss());
}

HP_APART void HP_NAMED(transform)(hp_object object, const float *matrix, const float *in, float *out) {
    num m[12], s[HP_OBJECT_WORDS_MAX] = {0}, moved[HP_OBJECT_WORDS_MAX];
    unsigned words = hp_object_words(object);
    HP_NAMED(load_words)(matrix, 12, m);
    HP_NAMED(load_words)(in, words, s);
    memcpy(moved, s, words * sizeof *s);
#define HP_MOVED(NAME)                                                                                               \
    if (object == HP_##NAME) HP_NAMED(transform_##NAME)(m, s, moved);
#include "rtl_model/transformer/transformer.def"
#undef HP_MOVED
    for (unsigned i = 0; i < words; i++) out[i] = hp_one_nan(moved[i]);
}
