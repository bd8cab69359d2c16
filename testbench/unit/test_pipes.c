/* The ray-triangle pipe: what it costs in hardware, and its decision at every border; flushing seen from outside. */
#include "rtl_model/pipes/quad.h"
#include <fenv.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- cost
 * -------------------------------------------------------------------------------------------------------------- */

/* The operator table of design: add/sub 11, multiply 6, divide 27, square root 27, compare 3, multiplexer 0. */
static const hp_config table = {.operator_clocks = {11, 11, 6, 27, 27, 3, 0}};

static void test_operators_of_the_paper(void **state) {
    (void)state;
    hp_pipe_cost c = hp_pipe_cost_of(HP_PAIR_RAY_TRIANGLE, false, &table);
    assert_int_equal(c.multipliers, 27);
    assert_int_equal(c.dividers, 1);
    assert_int_equal(c.square_roots, 0);
    assert_int_equal(c.adders, 12);
    assert_int_equal(c.subtractors, 15);
    assert_int_equal(c.comparators, 8);
    assert_int_equal(c.ands, 2);
    assert_int_equal(c.ors, 1);
    assert_int_equal(c.selects, 2 + 5); /* sorting u and v; index, T, CP */
    assert_int_equal(c.inputs, 9);
    assert_int_equal(c.outputs, 6);
    assert_int_equal(c.levels, 10);
    assert_int_equal(c.interval, 1);
}

static void test_clocks(void **state) {
    (void)state;
    hp_pipe_cost c = hp_pipe_cost_of(HP_PAIR_RAY_TRIANGLE, false, &table);
    assert_int_equal(c.clocks_T, 83);
    assert_int_equal(c.clocks_F, 83 + 3);
    assert_int_equal(c.clocks_CP, 100);
    assert_int_equal(c.clocks, 100);
}

/* Each operator's latency weighs in as often as it stands on the longest path: sub mul sub mul add add div mul add
 * select. */
static void test_clocks_follow_the_table(void **state) {
    (void)state;
    static const unsigned on_path[HP_OP_TIMED] = {
        [HP_OP_ADD] = 3, [HP_OP_SUB] = 2, [HP_OP_MUL] = 3, [HP_OP_DIV] = 1, [HP_OP_SELECT] = 1, [HP_OP_SQRT] = 0};
    for (unsigned op = 0; op < HP_OP_TIMED; op++) {
        if (op == HP_OP_COMPARE) continue;
        hp_config slower = table;
        slower.operator_clocks[op] += 1;
        assert_int_equal(hp_pipe_cost_of(HP_PAIR_RAY_TRIANGLE, false, &slower).clocks, 100 + on_path[op]);
    }
    hp_config slow_compare = table;
    slow_compare.operator_clocks[HP_OP_COMPARE] = 50; /* u, v at 56, the smaller, its sign, and the multiplexers */
    assert_int_equal(hp_pipe_cost_of(HP_PAIR_RAY_TRIANGLE, false, &slow_compare).clocks, 56 + 50 + 50);
}

/* ---- decision
 * ---------------------------------------------------------------------------------------------------------- */

typedef struct decision {
    const char *name;
    float ray[6], triangle[9];
    uint32_t F;
    float T;
} decision;

#define FRONT                                                                                                        \
    { 0, 0, 0, 0, 4, 0, 4, 0, 0 } /* det < 0 for a ray up z */
#define BACK                                                                                                         \
    { 0, 0, 0, 4, 0, 0, 0, 4, 0 }
#define Z (-0.0f)

static const decision decisions[] = {
    {"inside, one side", {1, 1, -2, 0, 0, 1}, FRONT, 1, 2},
    {"inside, other side", {1, 1, -2, 0, 0, 1}, BACK, 1, 2},
    {"inside, from above", {1, 1, 2, 0, 0, -4}, FRONT, 1, 0.5f},
    {"inside, from above, other side", {1, 1, 2, 0, 0, -4}, BACK, 1, 0.5f},
    {"behind", {1, 1, 2, 0, 0, 1}, FRONT, 0, 0},
    {"behind, other side", {1, 1, 2, 0, 0, 1}, BACK, 0, 0},
    {"u negative", {1, -1, -2, 0, 0, 1}, FRONT, 0, 0},
    {"v negative", {-1, 1, -2, 0, 0, 1}, FRONT, 0, 0},
    {"u + v past det", {3, 3, -2, 0, 0, 1}, FRONT, 0, 0},
    {"u and v negative", {-1, -1, -2, 0, 0, 1}, FRONT, 0, 0},
    {"u negative, other side", {-1, 1, -2, 0, 0, 1}, BACK, 0, 0},
    {"v negative, other side", {1, -1, -2, 0, 0, 1}, BACK, 0, 0},
    {"u + v past det, other side", {3, 3, -2, 0, 0, 1}, BACK, 0, 0},
    {"vertex v0", {0, 0, -2, 0, 0, 1}, FRONT, 1, 2},
    {"vertex v1", {0, 4, -2, 0, 0, 1}, FRONT, 1, 2},
    {"vertex v2", {4, 0, -2, 0, 0, 1}, FRONT, 1, 2},
    {"edge v0 v1", {0, 2, -2, 0, 0, 1}, FRONT, 1, 2},
    {"edge v0 v2", {2, 0, -2, 0, 0, 1}, FRONT, 1, 2},
    {"edge v1 v2", {2, 2, -2, 0, 0, 1}, FRONT, 1, 2},
    {"edge v1 v2, other side", {2, 2, -2, 0, 0, 1}, BACK, 1, 2},
    {"beside vertex v1", {0, 0x1.000002p2f, -2, 0, 0, 1}, FRONT, 0, 0},
    {"beside edge v1 v2", {2, 0x1.000004p1f, -2, 0, 0, 1}, BACK, 0, 0},
    {"beside edge v0 v1", {-0x1p-100f, 2, -2, 0, 0, 1}, FRONT, 0, 0},
    {"starts inside the triangle", {1, 1, 0, 0, 0, 1}, FRONT, 1, 0},
    {"starts inside, other side", {1, 1, 0, 0, 0, 1}, BACK, 1, 0},
    {"starts at -0", {1, 1, Z, 0, 0, 1}, FRONT, 1, 0},
    {"starts at -0, other side", {1, 1, Z, 0, 0, -1}, BACK, 1, 0},
    {"starts on an edge", {2, 2, 0, 0, 0, -1}, FRONT, 1, 0},
    {"starts on a vertex", {4, 0, Z, 0, 0, 1}, BACK, 1, 0},
    {"just behind", {1, 1, 0x1p-100f, 0, 0, 1}, FRONT, 0, 0},
    {"signed zeros in the direction", {1, 1, -2, Z, Z, 1}, FRONT, 1, 2},
    {"signed zeros in the triangle", {1, 1, -2, 0, 0, 1}, {Z, Z, Z, Z, 4, Z, 4, Z, Z}, 1, 2},
    {"vertex with signed zeros", {Z, Z, -2, Z, Z, 1}, {0, Z, 0, Z, 4, 0, 4, 0, Z}, 1, 2},
    {"in the plane, through", {-1, 1, 0, 1, 0, 0}, FRONT, 0, 0},
    {"in the plane, from inside", {1, 1, 0, 1, 0, 0}, FRONT, 0, 0},
    {"in the plane, from v0", {0, 0, 0, 1, 0, 0}, FRONT, 0, 0},
    {"parallel above", {1, 1, 1, 1, 0, 0}, FRONT, 0, 0},
    {"direction zero, off", {1, 1, 1, 0, 0, 0}, FRONT, 0, 0},
    {"direction zero, on", {1, 1, 0, 0, 0, 0}, FRONT, 0, 0},
    {"a line for a triangle", {1, 1, -2, 0, 0, 1}, {0, 0, 0, 1, 1, 0, 2, 2, 0}, 0, 0},
    {"a point for a triangle", {1, 1, -2, 0, 0, 1}, {1, 1, 0, 1, 1, 0, 1, 1, 0}, 0, 0},
    {"a point, from it", {1, 1, 0, 0, 0, 1}, {1, 1, 0, 1, 1, 0, 1, 1, 0}, 0, 0},
    {"det overflows", {1, 1, -2, 0, 0, 0x1p127f}, {0, 0, 0, 0, 0x1p70f, 0, 0x1p70f, 0, 0}, 0, 0},
    {"det overflows, t does not", {1, 1, -2, 0, 0, 0x1p127f}, FRONT, 0, 0},
    {"origin too far", {1, 1, -0x1.8p127f, 0, 0, 1}, {0, 0, 0x1.8p127f, 0, 4, 0, 4, 0, 0}, 0, 0},
    {"T overflows", {1, 1, -0x1p100f, 0, 0, 0x1p-60f}, FRONT, 0, 0},
    {"T just fits", {1, 1, -0x1p100f, 0, 0, 0x1p-27f}, FRONT, 1, 0x1p127f},
    {"far but fits", {1, 1, -0x1p100f, 0, 0, 0x1p100f}, FRONT, 1, 1},
};

static bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static void assert_miss(hp_result r) {
    assert_int_equal(r.F, 0);
    assert_int_equal(r.index, HP_NO_INDEX);
    assert_true(same_bits(r.T, INFINITY));
    for (unsigned axis = 0; axis < 3; axis++) assert_true(same_bits(r.CP[axis], 0));
    assert_int_equal(r.stencil, 1);
}

static void test_decisions(void **state) {
    (void)state;
    for (unsigned i = 0; i < sizeof decisions / sizeof *decisions; i++) {
        const decision *d = &decisions[i];
        for (hp_subnormals s = HP_GRADUAL; s <= HP_FLUSH; s++) {
            hp_result r = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, s, false, d->ray, d->triangle, 41);
            if (r.F != d->F || (r.F && !same_bits(r.T, d->T))) fail_msg("%s: F %u, T %a", d->name, r.F, (double)r.T);
            if (!r.F) {
                assert_miss(r);
                continue;
            }
            assert_int_equal(r.index, 41);
            for (unsigned axis = 0; axis < 3; axis++)
                assert_true(r.CP[axis] == d->ray[axis] + d->T * d->ray[3 + axis]);
        }
    }
}

/* A hit, with one word an infinity or a NaN: a miss, wherever it stands. Two of them likewise. */
static void test_no_hit_with_nan_or_infinity(void **state) {
    (void)state;
    static const float bad[] = {NAN, -NAN, INFINITY, -INFINITY};
    static const decision hits[] = {{"", {1, 1, -2, 0, 0, 1}, FRONT, 1, 2},
                                    {"", {1, 1, -2, 0.125f, 0.25f, 1}, {0.5f, 0, 0.25f, 0, 4, 0, 4, 0, 0.125f}, 1, 2},
                                    {"", {0, 0, 0, 0, 0, 1}, FRONT, 1, 0},
                                    {"", {2, 2, -2, 0, 0, 1}, BACK, 1, 2}};
    for (unsigned h = 0; h < sizeof hits / sizeof *hits; h++)
        for (unsigned first = 0; first < 15; first++)
            for (unsigned second = first; second < 15; second++)
                for (unsigned k = 0; k < 16; k++) {
                    float words[15];
                    memcpy(words, hits[h].ray, sizeof hits[h].ray);
                    memcpy(words + 6, hits[h].triangle, sizeof hits[h].triangle);
                    assert_int_equal(hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, words, words + 6, 0).F, 1);
                    words[first] = bad[k % 4];
                    words[second] = bad[first == second ? k % 4 : k / 4];
                    assert_miss(hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, words, words + 6, 0));
                    assert_miss(hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_FLUSH, false, words, words + 6, 0));
                }
}

/* ---- underflow, environment, precision
 * ---------------------------------------------------------------------------------- */

/* A subnormal origin is a place of its own under gradual underflow, and zero when flushed. */
static void test_subnormal_words(void **state) {
    (void)state;
    static const float ray[6] = {1, 1, -0x1p-127f, 0, 0, 0x1p-10f}, triangle[9] = FRONT;
    hp_result gradual = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, ray, triangle, 0);
    hp_result flush = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_FLUSH, false, ray, triangle, 0);
    assert_int_equal(gradual.F, 1);
    assert_true(same_bits(gradual.T, 0x1p-117f));
    assert_int_equal(flush.F, 1);
    assert_true(same_bits(flush.T, 0));
}

/* T = t / det at the border of flushing: 2^-126 - 2^-151 rounds to 2^-126, and stays; the next below is flushed. */
static void test_quotient_at_the_border(void **state) {
    (void)state;
    /* s.z = -z makes t = 16 z and det = 16 d: T = z / d */
    static const float triangle[9] = FRONT;
    float above[6] = {1, 1, -0x1.fffffep-26f, 0, 0, 0x1p101f}, below[6] = {1, 1, -0x1.fffffcp-26f, 0, 0, 0x1p101f};
    hp_result gradual = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, above, triangle, 0);
    assert_true(same_bits(gradual.T, 0x1p-126f)); /* 2^-126 - 2^-150 rounds up to a multiple of 2^-149 */
    hp_result flush = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_FLUSH, false, above, triangle, 0);
    assert_true(flush.F == 1 && same_bits(flush.T, 0)); /* it has 24 bits and is below 2^-126 */
    flush = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_FLUSH, false, below, triangle, 0);
    assert_true(flush.F == 1 && same_bits(flush.T, 0));
}

static void test_environment_of_the_caller_does_not_matter(void **state) {
    (void)state;
    static const float ray[6] = {0.1f, 0.7f, -3, 0.3f, 0.1f, 1}, triangle[9] = {0.3f, 0, 0, 0, 4, 0.1f, 4, 0, 0.7f};
    hp_result want = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, ray, triangle, 0);
    static const int modes[] = {FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO};
    assert_int_equal(want.F, 1);
    for (unsigned i = 0; i < 3; i++) {
        fesetround(modes[i]);
        hp_result got = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, ray, triangle, 0);
        int after = fegetround();
        fesetround(FE_TONEAREST);
        assert_int_equal(after, modes[i]);
        assert_memory_equal(&got, &want, sizeof want);
    }
}

/* binary128 and binary32 are the same text: close for a plain case, and equal on whole numbers. */
static void test_binary128(void **state) {
    (void)state;
    static const float ray[6] = {0.1f, 0.7f, -3, 0.3f, 0.1f, 1}, triangle[9] = {0.3f, 0, 0, 0, 4, 0.1f, 4, 0, 0.7f};
    hp_result single = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, ray, triangle, 0);
    hp_quad_result quad = hp_quad_pipe_test(HP_PAIR_RAY_TRIANGLE, false, ray, triangle);
    assert_true(quad.F);
    double error = (double)(quad.T - (hp_quad)single.T);
    assert_true(error != 0 && fabs(error) < 4e-7 * single.T);
    for (unsigned i = 0; i < sizeof decisions / sizeof *decisions; i++) {
        const decision *d = &decisions[i];
        if (strstr(d->name, "T overflows") || strstr(d->name, "det overflows") || strstr(d->name, "too far"))
            continue;
        quad = hp_quad_pipe_test(HP_PAIR_RAY_TRIANGLE, false, d->ray, d->triangle);
        assert_int_equal(quad.F, d->F);
        assert_true(d->F ? (float)quad.T == d->T : (double)quad.T == INFINITY);
    }
}

/* ---- instruction sets
 * ---------------------------------------------------------------------------------------------------- */

static void test_choosing_an_instruction_set(void **state) {
    (void)state;
    unsigned n = 0;
    unsetenv("HP_ISA");
    while (hp_isa_name(n)) n++;
    assert_true(n >= 1);
    assert_string_equal(hp_isa_name(n - 1), "plain");
    assert_string_equal(hp_isa_choose(NULL), hp_isa_name(0));
    assert_string_equal(hp_isa_choose("plain"), "plain");
    assert_null(hp_isa_choose("mmx"));
    setenv("HP_ISA", "plain", 1);
    assert_string_equal(hp_isa_choose(NULL), "plain");
    assert_string_equal(hp_isa_choose(hp_isa_name(0)), hp_isa_name(0));
    setenv("HP_ISA", "mmx", 1);
    assert_null(hp_isa_choose(NULL));
    unsetenv("HP_ISA");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_operators_of_the_paper),
        cmocka_unit_test(test_clocks),
        cmocka_unit_test(test_clocks_follow_the_table),
        cmocka_unit_test(test_decisions),
        cmocka_unit_test(test_no_hit_with_nan_or_infinity),
        cmocka_unit_test(test_subnormal_words),
        cmocka_unit_test(test_quotient_at_the_border),
        cmocka_unit_test(test_environment_of_the_caller_does_not_matter),
        cmocka_unit_test(test_binary128),
        cmocka_unit_test(test_choosing_an_instruction_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
