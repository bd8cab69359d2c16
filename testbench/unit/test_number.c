/* The operators of the scalar number systems, one by one: against arithmetic in double, which holds a product of
 * binary32 numbers exactly, and with NaN, zeros and the borders of flushing. The operator graph: sharing, counting,
 * timing. */
#include "rtl_model/number/environment.h"
#include "rtl_model/number/graph.h"
#include "testbench/support/random.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { DRAWS = 300000 };

/* The operators of a number system as plain functions; the names of the vocabulary are macros from here on. */
typedef struct operators {
    float (*enter)(float), (*plus)(float, float), (*minus)(float, float), (*times)(float, float),
        (*over)(float, float);
    float (*root)(float), (*smaller)(float, float), (*greater)(float, float), (*negative)(float), (*magnitude)(float);
    bool (*is_less)(float, float), (*is_at_most)(float, float);
} operators;

#define HP_MEANING gradual
#define HP_SCALAR_FLUSH 0
#include "rtl_model/number/scalar.h"
#define HP_OPERATORS                                                                                                 \
    { HP_NAMED(load), add, sub, mul, div, sqrt, min, max, neg, abs, less, at_most }
static const operators gradual = HP_OPERATORS;
#undef HP_MEANING
#undef HP_SCALAR_FLUSH

#define HP_MEANING flush
#define HP_SCALAR_FLUSH 1
#include "rtl_model/number/scalar.h"
static const operators flush = HP_OPERATORS;

static bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

/* x, but zero of its sign when below 2^-126. */
static float flushed(float x) {
    return fabsf(x) < 0x1p-126f ? copysignf(0, x) : x;
}

/* A number of any exponent, often near another's reciprocal times 2^-126, so that products land on the border. */
static float draw(hpt_random *random) {
    uint64_t r = hpt_random_bits(random);
    uint32_t bits_of = (uint32_t)(r >> 32);
    float x;
    memcpy(&x, &bits_of, sizeof x);
    return x;
}

/* ---- flushing
 * ------------------------------------------------------------------------------------------------------- */

/* What types.h says about a product, in double: it is exact there, and a tie at 24 bits goes to 2^-126, which is
 * even. */
static float flushed_product(float a, float b) {
    double exact = (double)a * b;
    return fabs(exact) < 0x1p-126 - 0x1p-151 ? copysignf(0, a * b) : a * b;
}

static float flushed_quotient(float a, float b) {
    bool tiny = isfinite(b) && b != 0 && fabs((double)a) < fabs((double)b) * (0x1p-126 - 0x1p-151);
    return tiny ? copysignf(0, a / b) : a / b;
}

static void check_flushing(float a, float b) {
    a = flushed(a), b = flushed(b);
    assert_true(same_bits(flush.enter(a), a));
    assert_true(same_bits(flush.plus(a, b), flushed(a + b)));
    assert_true(same_bits(flush.minus(a, b), flushed(a - b)));
    assert_true(same_bits(flush.times(a, b), flushed_product(a, b)));
    assert_true(same_bits(flush.over(a, b), flushed_quotient(a, b)));
}

static void test_flushing_of_random_numbers(void **state) {
    (void)state;
    hpt_random random = hpt_random_seed(3);
    for (unsigned i = 0; i < DRAWS; i++) {
        float a = draw(&random), b = draw(&random);
        check_flushing(a, b);
        check_flushing(a, 0x1p-126f / a); /* a product next to the border */
        check_flushing(a, a * 0x1p126f);  /* a quotient next to it */
        check_flushing(a, nextafterf(a * 0x1p126f, (float)(i % 3)));
    }
}

static void test_flushing_at_the_border(void **state) {
    (void)state;
    /* (1 - 2^-24) (1 + 2^-24 ...): exact products below 2^-126 that round, at 24 bits, to it or not */
    static const float low = 0x1.fffffep-1f;
    assert_true(flush.times(0x1p-63f, 0x1p-63f) == 0x1p-126f);
    assert_true(flush.times(low, 0x1p-126f) == 0);           /* 2^-126 - 2^-150, 24 bits */
    assert_true(gradual.times(low, 0x1p-126f) == 0x1p-126f); /* though it rounds up to a multiple of 2^-149 */
    assert_true(flush.times(0x1.000002p-63f, 0x1.fffffcp-64f) == 0x1p-126f); /* 2^-126 (1 - 2^-46) */
    assert_true(flush.times(-0x1.000002p-63f, 0x1.fffffcp-64f) == -0x1p-126f);
    assert_true(flush.times(0x1.000004p-63f, 0x1.fffff6p-64f) == 0); /* 2^-126 (1 - 2^-24 - ...) */
    assert_true(same_bits(flush.times(-0x1p-63f, 0x1.fffffep-64f), -0.0f));
    assert_true(flush.plus(0x1.8p-126f, -0x1p-126f) == 0 && gradual.plus(0x1.8p-126f, -0x1p-126f) == 0x1p-127f);
    assert_true(same_bits(flush.minus(0x1p-126f, 0x1.8p-126f), -0.0f));
    assert_true(same_bits(flush.enter(-0x1.fffffcp-127f), -0.0f) && flush.enter(0x1p-126f) == 0x1p-126f);
    assert_true(same_bits(flush.over(-0x1p-126f, 2), -0.0f) && flush.over(0x1p-125f, 2) == 0x1p-126f);
    assert_true(flush.root(0x1p-126f) == 0x1p-63f);
}

static void test_gradual_is_the_language(void **state) {
    (void)state;
    hpt_random random = hpt_random_seed(4);
    for (unsigned i = 0; i < DRAWS; i++) {
        float a = draw(&random), b = draw(&random);
        assert_true(same_bits(gradual.plus(a, b), a + b) && same_bits(gradual.minus(a, b), a - b));
        assert_true(same_bits(gradual.times(a, b), a * b) && same_bits(gradual.over(a, b), a / b));
        assert_true(same_bits(gradual.enter(a), a) && same_bits(gradual.root(fabsf(a)), __builtin_sqrtf(fabsf(a))));
    }
}

/* ---- comparisons, NaN, zeros
 * ---------------------------------------------------------------------------------------- */

static void test_comparisons_min_max(void **state) {
    (void)state;
    const operators *systems[] = {&gradual, &flush};
    for (unsigned i = 0; i < 2; i++) {
        const operators *o = systems[i];
        assert_true(o->is_less(1, 2) && !o->is_less(2, 1) && !o->is_less(1, 1) && o->is_at_most(1, 1));
        assert_true(!o->is_less(-0.0f, 0) && o->is_at_most(0, -0.0f) && o->is_less(1, INFINITY));
        assert_false(o->is_less(NAN, 1) || o->is_less(1, NAN) || o->is_at_most(NAN, 1) || o->is_at_most(1, NAN));
        assert_true(o->smaller(1, 2) == 1 && o->smaller(2, 1) == 1 && o->greater(1, 2) == 2 && o->greater(2, 1) == 2);
        /* one comparator a < b: when it says no, min is b and max is a */
        assert_true(same_bits(o->smaller(0.0f, -0.0f), -0.0f) && same_bits(o->smaller(-0.0f, 0.0f), 0.0f));
        assert_true(same_bits(o->greater(0.0f, -0.0f), 0.0f) && same_bits(o->greater(-0.0f, 0.0f), -0.0f));
        assert_true(o->smaller(NAN, 1) == 1 && isnan(o->smaller(1, NAN)));
        assert_true(isnan(o->greater(NAN, 1)) && o->greater(1, NAN) == 1);
        assert_true(same_bits(o->negative(0), -0.0f) && same_bits(o->magnitude(-0.0f), 0) && o->magnitude(-3) == 3);
    }
}

/* ---- operator graph
 * -------------------------------------------------------------------------------------------------- */

static unsigned operator_on(hp_graph *g, hp_operator operator, unsigned variant, unsigned a, unsigned b) {
    return hp_graph_operator(g, operator, variant, 2, (unsigned[]){a, b});
}

static const hp_config table = {.operator_clocks = {11, 11, 6, 27, 27, 3, 1}};

static unsigned entry(unsigned *of, unsigned n) {
    assert_non_null(of);
    unsigned value = of[n];
    free(of);
    return value;
}

static unsigned clocks_to(const hp_graph *g, unsigned n) {
    return entry(hp_graph_clocks(g, &table), n);
}

static unsigned levels_to(const hp_graph *g, unsigned n) {
    return entry(hp_graph_levels(g), n);
}

static void test_graph_shares_equal_operators(void **state) {
    (void)state;
    hp_graph g;
    hp_graph_begin(&g);
    unsigned a = hp_graph_input(&g), b = hp_graph_input(&g);
    assert_int_not_equal(a, b);
    assert_int_equal(hp_graph_constant(&g, 1), hp_graph_constant(&g, 1));
    assert_int_not_equal(hp_graph_constant(&g, 0), hp_graph_constant(&g, -0.0f));
    unsigned product = operator_on(&g, HP_OP_MUL, 0, a, b);
    assert_int_equal(product, operator_on(&g, HP_OP_MUL, 0, a, b));
    assert_int_not_equal(product, operator_on(&g, HP_OP_MUL, 0, b, a));
    assert_int_not_equal(product, operator_on(&g, HP_OP_ADD, 0, a, b));
    assert_int_not_equal(operator_on(&g, HP_OP_COMPARE, 0, a, b), operator_on(&g, HP_OP_COMPARE, 1, a, b));
    hp_graph_free(&g);
}

static void test_graph_counts(void **state) {
    (void)state;
    hp_graph g;
    hp_graph_begin(&g);
    unsigned a = hp_graph_input(&g), b = hp_graph_input(&g), zero = hp_graph_constant(&g, 0);
    unsigned smaller = operator_on(&g, HP_OP_MIN, 0, a, b), greater = operator_on(&g, HP_OP_MAX, 0, a, b);
    unsigned f1 = operator_on(&g, HP_OP_COMPARE, 1, zero, smaller),
             f2 = operator_on(&g, HP_OP_COMPARE, 1, greater, zero);
    unsigned f3 = operator_on(&g, HP_OP_COMPARE, 0, a, zero);
    unsigned pair = operator_on(&g, HP_OP_AND, 0, f1, f2); /* melts into the next */
    operator_on(&g, HP_OP_AND, 0, pair, f3);
    hp_pipe_cost cost = hp_graph_cost(&g, &table);
    assert_int_equal(cost.comparators, 1 + 3);
    assert_int_equal(cost.selects, 2);
    assert_int_equal(cost.ands, 1);
    assert_int_equal(cost.levels, 2);
    assert_int_equal(cost.clocks, 3 + 3);
    operator_on(&g, HP_OP_OR, 0, pair, f3); /* now the inner AND is needed on its own */
    operator_on(&g, HP_OP_MIN, 0, b, a);    /* and this is another comparator */
    cost = hp_graph_cost(&g, &table);
    assert_int_equal(cost.ands, 2);
    assert_int_equal(cost.ors, 1);
    assert_int_equal(cost.comparators, 2 + 3);
    hp_graph_free(&g);
}

static void test_graph_times_the_longest_path(void **state) {
    (void)state;
    hp_graph g;
    hp_graph_begin(&g);
    unsigned a = hp_graph_input(&g), b = hp_graph_input(&g);
    unsigned sum = operator_on(&g, HP_OP_ADD, 0, a, b), product = operator_on(&g, HP_OP_MUL, 0, a, b);
    unsigned quotient = operator_on(&g, HP_OP_DIV, 0, product, sum);
    unsigned root = hp_graph_operator(&g, HP_OP_SQRT, 0, 1, &quotient);
    unsigned size = hp_graph_operator(&g, HP_OP_ABS, 0, 1, &root),
             minus = hp_graph_operator(&g, HP_OP_NEG, 0, 1, &size);
    assert_int_equal(clocks_to(&g, product), 6);
    assert_int_equal(clocks_to(&g, quotient), 11 + 27);
    assert_int_equal(levels_to(&g, quotient), 2);
    assert_int_equal(clocks_to(&g, minus), 11 + 27 + 27);
    assert_int_equal(levels_to(&g, minus), 3);
    assert_int_equal(hp_graph_cost(&g, &table).square_roots, 1);
    hp_graph_free(&g);
}

/* x = x + a, four times over, each time with a product of its own; then a root outside. */
static void test_graph_folds_loops(void **state) {
    (void)state;
    hp_graph g;
    hp_graph_begin(&g);
    unsigned a = hp_graph_input(&g), sum = hp_graph_input(&g), same = 0, last = 0;
    for (unsigned i = hp_graph_repeat(&g, 4); hp_graph_repeating(&g, i, 4); i++) {
        same = operator_on(&g, HP_OP_SUB, 0, a, a); /* does not change from step to step: one node */
        unsigned product = operator_on(&g, HP_OP_MUL, 0, sum, a);
        for (unsigned k = hp_graph_repeat(&g, 3); hp_graph_repeating(&g, k, 3); k++)
            sum = operator_on(&g, HP_OP_ADD, 0, sum, product);
        last = sum;
    }
    unsigned root = hp_graph_operator(&g, HP_OP_SQRT, 0, 1, &last);
    hp_pipe_cost cost = hp_graph_cost(&g, &table);
    assert_int_equal(cost.subtractors, 1);
    assert_int_equal(cost.multipliers, 1);
    assert_int_equal(cost.adders, 1);
    assert_int_equal(cost.square_roots, 1);
    assert_int_equal(cost.interval, 4 * 3);
    assert_int_equal(levels_to(&g, root), 4 * (1 + 3) + 1);
    assert_int_equal(clocks_to(&g, last), 4 * (6 + 3 * 11));
    assert_int_equal(clocks_to(&g, root), 4 * (6 + 3 * 11) + (4 * 3 - 1) + 27);
    assert_int_equal(clocks_to(&g, same), 11);
    assert_int_equal(hp_graph_repeat(&g, 5), 0);
    while (hp_graph_repeating(&g, 5, 5)) fail();
    assert_int_equal(hp_graph_cost(&g, &table).interval, 12);
    hp_graph_free(&g);
}

/* ---- environment
 * ------------------------------------------------------------------------------------------------------ */

static void test_environment_is_restored(void **state) {
    (void)state;
    hp_environment outer = hp_environment_enter(true);
    volatile float least = 0x1p-126f;
    bool flushes = least / 2 == 0;
    hp_environment inner = hp_environment_enter(false);
    assert_true(least / 2 == 0x1p-127f);
    hp_environment_leave(inner);
    assert_true((least / 2 == 0) == flushes);
    hp_environment_leave(outer);
    assert_true(least / 2 == 0x1p-127f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flushing_of_random_numbers),   cmocka_unit_test(test_flushing_at_the_border),
        cmocka_unit_test(test_gradual_is_the_language),      cmocka_unit_test(test_comparisons_min_max),
        cmocka_unit_test(test_graph_shares_equal_operators), cmocka_unit_test(test_graph_counts),
        cmocka_unit_test(test_graph_times_the_longest_path), cmocka_unit_test(test_graph_folds_loops),
        cmocka_unit_test(test_environment_is_restored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
