/* The transformer: what it costs and what it computes. */
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void test_cost(void **state) {
    (void)state;
    static const hp_config table = {.operator_clocks = {11, 11, 6, 27, 27, 3, 0}};
    hp_pipe_cost c = hp_transformer_cost_of(HP_TRIANGLE, &table);
    assert_int_equal(c.multipliers, 27);
    assert_int_equal(c.adders, 27);
    assert_int_equal(c.subtractors + c.dividers + c.comparators + c.selects, 0);
    assert_int_equal(c.levels, 3);
    assert_int_equal(c.clocks, 6 + 11 + 11);
    assert_int_equal(c.inputs, 9);
    assert_int_equal(c.outputs, 9);
    assert_int_equal(c.interval, 1);
}

static const float triangle[9] = {1, 2, 3, -4, 5, 6, 7, -8, 9};

static void test_identity_and_move(void **state) {
    (void)state;
    static const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    static const float turn[12] = {0, -1, 0, 10, 1, 0,
                                   0, 20, 0, 0,  2, 30}; /* x' = 10 - y, y' = 20 + x, z' = 30 + 2 z */
    static const float turned[9] = {8, 21, 36, 5, 16, 42, 18, 27, 48};
    float out[9];
    for (hp_subnormals s = HP_GRADUAL; s <= HP_FLUSH; s++) {
        hp_transform_object(HP_TRIANGLE, s, identity, triangle, out);
        for (unsigned w = 0; w < 9; w++) assert_true(out[w] == triangle[w]);
        hp_transform_object(HP_TRIANGLE, s, turn, triangle, out);
        for (unsigned w = 0; w < 9; w++) assert_true(out[w] == turned[w]);
    }
}

/* (m0 x + m1 y) + (m2 z + t), each operation rounded: another order gives other bits here. */
static void test_order_of_the_sum(void **state) {
    (void)state;
    static const float matrix[12] = {1, 1, 1, 1, 0, 1, 0, 0, 0, 0, 1, 0};
    float out[9];
    static const float other[9] = {1, 0x1p24f, 0.5f};
    hp_transform_object(HP_TRIANGLE, HP_GRADUAL, matrix, other, out);
    assert_true(out[0] == 0x1p24f + 2); /* 2^24 + 1.5 rounds up; from left to right it would stay 2^24 */
}

static void test_flush_and_nan(void **state) {
    (void)state;
    static const float halve[12] = {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0};
    static const float small[9] = {0x1p-126f, -0x1p-126f, 0x1p-125f, 0x1p-130f, NAN, -NAN, INFINITY, 0, 1};
    float gradual[9], flush[9];
    hp_transform_object(HP_TRIANGLE, HP_GRADUAL, halve, small, gradual);
    hp_transform_object(HP_TRIANGLE, HP_FLUSH, halve, small, flush);
    assert_true(gradual[0] == 0x1p-127f && flush[0] == 0);
    assert_true(gradual[1] == -0x1p-127f && flush[1] == 0);
    assert_true(gradual[2] == 0x1p-126f && flush[2] == 0x1p-126f);
    assert_true(gradual[6] == INFINITY && flush[6] == INFINITY);
    for (unsigned w = 3; w < 9; w++) {
        uint32_t bits;
        if (w == 6) continue;
        memcpy(&bits, &gradual[w], sizeof bits);
        assert_int_equal(bits, 0x7FC00000); /* 0 * inf and 0 * NaN: the one NaN there is */
        memcpy(&bits, &flush[w], sizeof bits);
        assert_int_equal(bits, 0x7FC00000);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cost),
        cmocka_unit_test(test_identity_and_move),
        cmocka_unit_test(test_order_of_the_sum),
        cmocka_unit_test(test_flush_and_nan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
