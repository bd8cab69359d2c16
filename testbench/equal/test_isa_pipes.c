/* Contract 2 for every pipe of pairs.def: wide lanes give the bits of the scalar datapath on every instruction set,
 * in all kernels, in both ways of underflow, transformed or not. test_isa.c goes deeper into ray-triangle.
 *
 * Pairs come from the classes of accuracy, made small so that products underflow, and as any bits at all. */
#include "rtl_model/pipes/wide.h"
#include "testbench/support/pair_cases.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { PAIRS = 1200, PRIMARIES = 37, SECONDARIES = 21, SMALL = 3, BITS = 4, KINDS = 5 };

static const hp_pair all_pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};
enum { ALL_PAIRS = sizeof all_pairs / sizeof *all_pairs };

/* What a check is about: printed when it fails. */
typedef struct setting {
    const char *isa;
    hp_pair pair;
    bool flush, separation;
    const float *matrix;
} setting;

static float primaries[PAIRS * HP_OBJECT_WORDS_MAX], secondaries[PAIRS * HP_OBJECT_WORDS_MAX];
static unsigned primary_words, secondary_words;

static void make_small(hpt_random *random, float *words, unsigned n) {
    float factor = ldexpf(1, -(int)(hpt_random_bits(random) & 127));
    for (unsigned w = 0; w < n; w++) words[w] *= factor;
}

static void make_bits(hpt_random *random, float *words, unsigned n) {
    for (unsigned w = 0; w < n; w++) {
        uint32_t bits = (uint32_t)(hpt_random_bits(random) >> 32);
        memcpy(words + w, &bits, sizeof bits);
    }
}

static void draw(hp_pair pair) {
    static const hpt_class classes[] = {HPT_RANDOM, HPT_DEGENERATE, HPT_OFFSET, HPT_RANDOM, HPT_RANDOM};
    hpt_random random = hpt_random_seed(31);
    primary_words = hp_object_words(hp_pair_primary(pair));
    secondary_words = hp_object_words(hp_pair_secondary(pair));
    for (unsigned i = 0; i < PAIRS; i++) {
        float *p = primaries + i * primary_words, *s = secondaries + i * secondary_words;
        hpt_draw_pair(&random, pair, classes[i % KINDS], i, p, s);
        if (i % KINDS == SMALL) make_small(&random, p, primary_words), make_small(&random, s, secondary_words);
        if (i % (4 * KINDS) == BITS) make_bits(&random, p, primary_words);
        if (i % (4 * KINDS) == KINDS + BITS) make_bits(&random, s, secondary_words);
        if (i % KINDS == BITS && i % 3 == 0) p[i % primary_words] = NAN;
        if (i % KINDS == BITS && i % 3 == 1) s[i % secondary_words] = i & 1 ? INFINITY : -INFINITY;
    }
}

static hp_result scalar(const setting *in, const float *primary, const float *secondary, bool separation) {
    hp_subnormals subnormals = in->flush ? HP_FLUSH : HP_GRADUAL;
    float moved[HP_OBJECT_WORDS_MAX];
    if (in->matrix) {
        hp_transform_object(hp_pair_secondary(in->pair), subnormals, in->matrix, secondary, moved);
        secondary = moved;
    }
    return hp_pipe_test(in->pair, subnormals, separation, primary, secondary, 0);
}

static void fail_at(const setting *in, unsigned i, const char *what) {
    fail_msg("%s on %s, %s%s%s: %s of pair %u", hp_pair_name(in->pair), in->isa, in->flush ? "flush" : "gradual",
             in->separation ? ", separation" : "", in->matrix ? ", moved" : "", what, i);
}

static bool same(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static void check_pairs(const setting *in) {
    static uint32_t F[PAIRS];
    static float T[PAIRS], CP[3][PAIRS];
    hp_pairs_out out = {F, T, {CP[0], CP[1], CP[2]}};
    const hp_wide_pipe *pipe = hp_wide_pipe_of(in->isa, in->pair);
    (in->separation ? pipe->distances : pipe->pairs)(primaries, 1, secondaries, PAIRS, in->matrix, in->flush, &out);
    for (unsigned i = 0; i < PAIRS; i++) {
        hp_result want = scalar(in, primaries + i * primary_words, secondaries + i * secondary_words, in->separation);
        if (F[i] != want.F) fail_at(in, i, "F");
        if (!same(T[i], want.T)) fail_at(in, i, "T");
        for (unsigned axis = 0; axis < 3; axis++)
            if (!same(CP[axis][i], want.CP[axis])) fail_at(in, i, "CP");
    }
}

/* ---- kernels that keep one result a primary ---- */

typedef enum keeping { CLOSEST, ANY, NEAREST } keeping;

/* Whether `found` takes the place of `kept`, as docs/protocol.md says it. */
static bool takes_over(const setting *in, keeping how, const hp_result *found, const hp_result *kept) {
    if (!found->F) return how == NEAREST && !kept->F && found->T < kept->T;
    if (!kept->F) return true;
    if (how == ANY) return false;
    return hp_pair_keeps_deepest(in->pair) ? found->T > kept->T : found->T < kept->T;
}

static void check_keeping(const setting *in, keeping how, unsigned from_secondary) {
    const hp_wide_pipe *pipe = hp_wide_pipe_of(in->isa, in->pair);
    static hp_lanes lanes;
    static hp_best best;
    static _Alignas(64) float prepared[SECONDARIES * HP_PREPARED_MAX];
    const float *of = secondaries + from_secondary * secondary_words;
    memset(&lanes, 0, sizeof lanes);
    for (unsigned i = 0; i < PRIMARIES; i++)
        for (unsigned w = 0; w < primary_words; w++) lanes.word[w][i] = primaries[i * primary_words + w];
    hp_best_begin(&best, in->pair, how == NEAREST);
    pipe->prepare(of, SECONDARIES, in->matrix, in->flush, prepared);
    (how == CLOSEST ? pipe->closest
     : how == ANY   ? pipe->any
                    : pipe->nearest)(&lanes, 0, PRIMARIES, prepared, SECONDARIES, 100, in->flush, &best);
    for (unsigned i = 0; i < PRIMARIES; i++) {
        hp_result kept = {.T = INFINITY, .index = HP_NO_INDEX};
        for (unsigned k = 0; k < SECONDARIES; k++) {
            hp_result found = scalar(in, primaries + i * primary_words, of + k * secondary_words, how == NEAREST);
            if (!takes_over(in, how, &found, &kept)) continue;
            kept = found;
            kept.index = 100 + k;
        }
        if (best.index[i] != kept.index) fail_at(in, i, "index kept");
        if (kept.index != HP_NO_INDEX && !same(best.T[i], kept.T)) fail_at(in, i, "T kept");
        if (how == NEAREST && best.F[i] != kept.F) fail_at(in, i, "F kept");
    }
}

/* ---- all together ---- */

static void check(const setting *in) {
    check_pairs(in);
    for (unsigned from = 0; from < 3 * SECONDARIES && !in->separation; from += SECONDARIES)
        for (keeping how = CLOSEST; how <= NEAREST; how++) check_keeping(in, how, from);
}

static void every_instruction_set_gives_the_scalar_bits(void **state) {
    const hp_pair pair = *(const hp_pair *)*state;
    static const float moves[12] = {0, -1, 0, 0.25f, 1, 0, 0, -0.125f, 0, 0, 1, 0.5f};
    draw(pair);
    for (unsigned i = 0; hp_isa_name(i); i++)
        for (unsigned way = 0; way < 8; way++) {
            setting in = {hp_isa_name(i), pair, way & 1, way & 2, way & 4 ? moves : NULL};
            check(&in);
        }
}

/* The pairs above must mean something: hits, misses, a distance, and a difference between the two ways of underflow.
 */
static void the_pairs_hit_and_underflow(void **state) {
    const hp_pair pair = *(const hp_pair *)*state;
    unsigned hits = 0, distances = 0, differ = 0;
    draw(pair);
    for (unsigned i = 0; i < PAIRS; i++) {
        setting gradual = {"scalar", pair, false, true, NULL}, flush = {"scalar", pair, true, true, NULL};
        const float *p = primaries + i * primary_words, *s = secondaries + i * secondary_words;
        hp_result a = scalar(&gradual, p, s, true), b = scalar(&flush, p, s, true);
        hits += a.F;
        distances += !a.F && a.T < INFINITY;
        differ += memcmp(&a, &b, sizeof a) != 0;
    }
    assert_in_range(hits, PAIRS / 8, PAIRS * 3 / 4);
    assert_in_range(distances, PAIRS / 8, PAIRS * 3 / 4);
    assert_true(differ > PAIRS / 400);
}

/* An illegal box so large that a coordinate of CP is infinity - infinity: processors make that NaN negative. */
static void a_position_that_is_no_number_is_the_one_nan(void **state) {
    (void)state;
    static const float box[15] = {-0x1.b06e34p-53f, -0x1.885bdap-5f,  -0x1.38f486p-90f, 0x1.a809d2p-94f,
                                  0x1.fc11fep-125f, 0x1.2af206p+96f,  -0x1.04a1ccp+91f, 0x1.0b2442p+51f,
                                  0x1.0cc4d2p+114f, -0x1.0da8ap+108f, 0x1.1dd174p-32f,  0x1.ffcb5p+13f,
                                  0x1.b6d36ep-59f,  0x1.a3d94cp+50f,  0x1.7e14f8p+26f};
    static const float plane[4] = {0x1.f4c8c4p-61f, -0x1.6d076p-39f, 0x1.0a9708p-58f, 0x1.a15fbp-77f};
    static const uint32_t one_nan = 0x7FC00000;
    hp_result r = hp_pipe_test(HP_PAIR_OBB_PLANE, HP_GRADUAL, false, box, plane, 0);
    assert_int_equal(r.F, 1);
    assert_memory_equal(&r.CP[1], &one_nan, sizeof one_nan);
    for (unsigned i = 0; hp_isa_name(i); i++) {
        uint32_t F;
        float T, CP[3];
        hp_pairs_out out = {&F, &T, {&CP[0], &CP[1], &CP[2]}};
        hp_wide_pipe_of(hp_isa_name(i), HP_PAIR_OBB_PLANE)->pairs(box, 1, plane, 1, NULL, false, &out);
        assert_int_equal(F, 1);
        assert_memory_equal(&CP[1], &one_nan, sizeof one_nan);
    }
}

int main(void) {
    static char names[2 * ALL_PAIRS][64];
    struct CMUnitTest tests[2 * ALL_PAIRS + 1] = {[2 * ALL_PAIRS] =
                                                      cmocka_unit_test(a_position_that_is_no_number_is_the_one_nan)};
    for (unsigned i = 0; i < ALL_PAIRS; i++) {
        strcpy(names[2 * i], hp_pair_name(all_pairs[i]));
        strcat(strcpy(names[2 * i + 1], hp_pair_name(all_pairs[i])), ": the pairs mean something");
        tests[2 * i] = (struct CMUnitTest){names[2 * i], every_instruction_set_gives_the_scalar_bits, NULL, NULL,
                                           (void *)&all_pairs[i]};
        tests[2 * i + 1] =
            (struct CMUnitTest){names[2 * i + 1], the_pairs_hit_and_underflow, NULL, NULL, (void *)&all_pairs[i]};
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
