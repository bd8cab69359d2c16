/* The exact oracle against answers worked out by hand, and against binary128 where that cannot be wrong. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "rtl_model/pipes/quad.h"
#include "testbench/reference/exact_ray_triangle.h"
#include "testbench/reference/judge.h"
#include "testbench/support/ray_triangle_cases.h"

/* The triangle (0,0,0), (4,0,0), (0,3,0), and as seen from its other side. */
static const float triangle[9] = {0, 0, 0, 4, 0, 0, 0, 3, 0}, turned[9] = {0, 0, 0, 0, 3, 0, 4, 0, 0};

#define RAY(...) ((const float[6]){__VA_ARGS__})

/* The triangle both ways round, with one answer. */
static bool hits(const float ray[6]) {
    hpt_crossing front = hpt_exact_ray_triangle(ray, triangle), back = hpt_exact_ray_triangle(ray, turned);
    assert_int_equal(front.F, back.F);
    assert_int_equal(front.crosses, back.crosses);
    assert_true(front.T == back.T);
    return front.F;
}

static void inside_edges_and_vertices_hit(void **state) {
    (void)state;
    static const float at[][2] = {{1, 1}, {2, 0}, {0, 1.5F}, {2, 1.5F}, {0, 0}, {4, 0}, {0, 3}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        for (int side = -1; side <= 1; side += 2) {
            const float *ray = RAY(at[i][0], at[i][1], (float)(8 * side), 0, 0, (float)(-2 * side));
            assert_true(hits(ray));
            assert_true(hpt_exact_ray_triangle(ray, triangle).T == 4);
            assert_true(hpt_exact_ray_triangle(ray, triangle).CP[0] == (double)at[i][0]);
            assert_true(hpt_exact_ray_triangle(ray, triangle).CP[2] == 0);
        }
}

static void outside_by_the_last_bit_misses(void **state) {
    (void)state;
    const float tiny = 0x1p-149F;
    assert_false(hits(RAY(1, -tiny, 8, 0, 0, -2)));
    assert_false(hits(RAY(-tiny, 1, 8, 0, 0, -2)));
    assert_false(hits(RAY(nextafterf(2, 3), 1.5F, 8, 0, 0, -2)));
    assert_true(hits(RAY(nextafterf(2, 1), 1.5F, 8, 0, 0, -2)));
    assert_false(hits(RAY(nextafterf(4, 5), 0, 8, 0, 0, -2)));
}

static void start_on_the_triangle_hits(void **state) {
    (void)state;
    assert_true(hits(RAY(1, 1, 0, 0, 0, 1)));
    assert_true(hits(RAY(0, 0, 0, 0, 0, -1)));
    assert_true(hits(RAY(2, 0, -0.0F, 5, 5, -1)));
    assert_true(hpt_exact_ray_triangle(RAY(2, 0, 0, 5, 5, -1), triangle).T == 0);
    assert_false(hits(RAY(1, 1, 0x1p-149F, 0, 0, 1)));
    assert_true(hits(RAY(1, 1, -0x1p-149F, 0, 0, 1)));
}

static void behind_misses(void **state) {
    (void)state;
    assert_false(hits(RAY(1, 1, 8, 0, 0, 2)));
    assert_true(hpt_exact_ray_triangle(RAY(1, 1, 8, 0, 0, 2), triangle).T == -4);
}

static void parallel_and_degenerate_miss(void **state) {
    (void)state;
    static const float line[9] = {0, 0, 0, 1, 1, 1, 3, 3, 3}, point[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    assert_false(hits(RAY(-1, 1, 0, 1, 0, 0)));
    assert_false(hits(RAY(-1, 1, 1, 1, 0, 0)));
    assert_false(hits(RAY(1, 1, 0, 0, 0, 0)));
    assert_false(hpt_exact_ray_triangle(RAY(0, 0, 2, 1, 1, -1), line).F);
    assert_false(hpt_exact_ray_triangle(RAY(0, 0, 2, 1, 1, -1), point).crosses);
}

static void extremes_lose_nothing(void **state) {
    (void)state;
    const float big = 0x1p126F, tiny = 0x1p-149F;
    const float large[9] = {0, 0, 0, big, 0, 0, 0, big, 0}, small[9] = {0, 0, 0, 4 * tiny, 0, 0, 0, 4 * tiny, 0};
    hpt_crossing far = hpt_exact_ray_triangle(RAY(big, 0, big, 0, 0, -tiny), large);
    assert_true(far.F && far.T == 0x1p275);
    assert_true(hpt_exact_ray_triangle(RAY(2 * tiny, 2 * tiny, big, 0, 0, -big), small).F);
    assert_false(hpt_exact_ray_triangle(RAY(2 * tiny, 3 * tiny, big, 0, 0, -big), small).F);
}

static void near(double value, double expected) {
    assert_true(fabs(value - expected) <= 1e-14 * fabs(expected));
}

/* The margin of a hit is the way to the nearest edge or to the origin's plane; of a miss the distance. */
static void margins_are_distances(void **state) {
    (void)state;
    near(hpt_margin_ray_triangle(RAY(1, 0.25F, 8, 0, 0, -2), triangle), 0.25);      /* edge y = 0 */
    near(hpt_margin_ray_triangle(RAY(0.5F, 1, 8, 0, 0, -2), triangle), 0.5);        /* edge x = 0 */
    near(hpt_margin_ray_triangle(RAY(2, 1, 8, 0, 0, -2), triangle), 0.4);           /* 3x + 4y = 12 */
    near(hpt_margin_ray_triangle(RAY(1, 1, 0.125F, 0, 0, -2), triangle), 0.125);    /* t = 0 */
    near(hpt_margin_ray_triangle(RAY(1, -0.5F, 8, 0, 0, -2), triangle), -0.5);      /* off an edge */
    near(hpt_margin_ray_triangle(RAY(-3, -4, 8, 0, 0, -2), triangle), -5);          /* off a vertex */
    near(hpt_margin_ray_triangle(RAY(1, 1, 8, 0, 0, 2), triangle), -8);             /* starts above the face */
    near(hpt_margin_ray_triangle(RAY(1, -3, 4, 0, 0, 2), triangle), -5);            /* starts off an edge */
    near(hpt_margin_ray_triangle(RAY(-9, 1, 2, 1, 0, 0), triangle), -2);            /* parallel */
    near(hpt_margin_ray_triangle(RAY(7, 4, 0, 0, 0, 0), triangle), -5);             /* a point off a vertex */
    assert_true(hpt_margin_ray_triangle(RAY(-9, 1, 0, 1, 0, 0), triangle) == 0);    /* in the plane, through it */
    assert_true(hpt_margin_ray_triangle(RAY(2, 1.5F, 8, 0, 0, -2), triangle) == 0); /* through an edge */
    assert_true(hpt_margin_ray_triangle(RAY(1, 1, 0, 0, 0, -2), triangle) == 0);    /* t = 0 */
}

static void scales_are_as_designed(void **state) {
    (void)state;
    static const float right[9] = {3, 0, 0, 0, 3, 0, 0, 0, 3}; /* centroid (1,1,1), radius sqrt(6) */
    hpt_ray_triangle_scale scale = hpt_scale_ray_triangle(RAY(1, 1, -7, 0, 0, 2), right);
    near(scale.L, sqrt(6));
    near(scale.C, 7);
    near(scale.direction, 2);
    near(scale.cosine, 1 / sqrt(3));
    near(hpt_scale_ray_triangle(RAY(4, 5, -7, 0, 0, 2), right).L, sqrt(6) + 5);
    near(hpt_scale_ray_triangle(RAY(1, 1, 3, 0, 0, 2), right).L, sqrt(6) + 2); /* closest approach: the origin */
    near(hpt_band(&scale), 7 * 0x1p-21);
    hpt_crossing exact = hpt_exact_ray_triangle(RAY(1, 1, -7, 0, 0, 2), right);
    near(exact.T, 4);
    near(hpt_T_error(&exact, &scale, 4.5F), 0.5 * 2 / sqrt(3) / 7);
    near(hpt_CP_error(&exact, &scale, (const float[3]){1, 4, 5}), 5 / sqrt(3) / 7);
}

static void judge_tells_right_from_wrong(void **state) {
    (void)state;
    const float *beside = RAY(1, -1, 8, 0, 0, -2), *touching = RAY(1, -1e-9F, 8, 0, 0, -2);
    hp_result hit = {.F = 1, .T = 4}, miss = {.T = INFINITY};
    assert_true(hpt_judge_result(HP_PAIR_RAY_TRIANGLE, beside, triangle, &miss).right);
    hpt_verdict wrong = hpt_judge_result(HP_PAIR_RAY_TRIANGLE, beside, triangle, &hit);
    assert_true(!wrong.right && !wrong.within && wrong.margin > 1);
    wrong = hpt_judge_result(HP_PAIR_RAY_TRIANGLE, touching, triangle, &hit);
    assert_true(!wrong.right && wrong.within && wrong.measured);
    hpt_verdict off = hpt_judge_result(HP_PAIR_RAY_TRIANGLE, RAY(1, 1, 8, 0, 0, -2), triangle,
                                       &(hp_result){.F = 1, .T = 5, .CP = {1, 1, 0}});
    assert_true(off.right && off.measured);
    near(off.T_error, 0.25);
    assert_true(off.CP_error == 0);
}

/* The pipe's own text in binary128, whose error of 2^-113 is far below what decides pairs drawn in binary32. */
static void binary128_agrees(void **state) {
    (void)state;
    static hpt_ray_triangle_maker *const makers[] = {hpt_random_pair, hpt_grazing_pair, hpt_slanting_pair,
                                                     hpt_offset_pair, hpt_sliver_pair};
    for (unsigned m = 0; m < sizeof makers / sizeof *makers; m++) {
        hpt_random random = hpt_random_seed(m);
        for (unsigned i = 0; i < 1000; i++) {
            float ray[6], v[9];
            makers[m](&random, i, ray, v);
            hpt_crossing exact = hpt_exact_ray_triangle(ray, v);
            hp_quad_result quad = hp_quad_pipe_test(HP_PAIR_RAY_TRIANGLE, false, ray, v);
            assert_int_equal(exact.F, quad.F);
            if (quad.F) assert_true(fabs(exact.T - (double)quad.T) <= 0x1p-50 * exact.T);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inside_edges_and_vertices_hit), cmocka_unit_test(outside_by_the_last_bit_misses),
        cmocka_unit_test(start_on_the_triangle_hits),    cmocka_unit_test(behind_misses),
        cmocka_unit_test(parallel_and_degenerate_miss),  cmocka_unit_test(extremes_lose_nothing),
        cmocka_unit_test(margins_are_distances),         cmocka_unit_test(scales_are_as_designed),
        cmocka_unit_test(judge_tells_right_from_wrong),  cmocka_unit_test(binary128_agrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
