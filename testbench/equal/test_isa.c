/* Every instruction set computes the bits of the scalar datapath: pairs, closest, any, and the transformer in front
 * of them, in both ways of underflow, for every size of a remainder, on ordinary and on adversarial words. */
#include "rtl_model/pipes/wide.h"
#include "testbench/support/ray_triangle_cases.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { PAIRS = 6000, RAYS = HP_PACKET_PRIMARIES, TRIANGLES = 700, ROUNDS = 6 };

static const float specials[] = {
    0.0f,      -0.0f,      1.0f,        -1.0f,     0x1p-149f, -0x1p-149f, 0x1.fffffcp-127f,
    0x1p-126f, -0x1p-126f, 0x1.8p-126f, 0x1p-63f,  0x1p63f,   0x1p127f,   -0x1.fffffep127f,
    INFINITY,  -INFINITY,  NAN,         0x1p-100f, 3.0f,      -0x1p-75f};

/* Ray and triangle with every word special. */
static void special_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    (void)i;
    for (unsigned w = 0; w < 15; w++)
        *(w < 6 ? ray + w : triangle + w - 6) =
            specials[hpt_random_below(random, sizeof specials / sizeof *specials)];
}

/* Coordinates that are small whole numbers: many exact edge and vertex hits, zeros of det, equal T. */
static void whole_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    (void)i;
    for (unsigned w = 0; w < 15; w++)
        *(w < 6 ? ray + w : triangle + w - 6) = (float)hpt_random_below(random, 5) - 2.0f;
}

/* Any bits. */
static void bits_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    (void)i;
    for (unsigned w = 0; w < 15; w++) {
        uint32_t bits = (uint32_t)hpt_random_bits(random);
        memcpy(w < 6 ? ray + w : triangle + w - 6, &bits, sizeof bits);
    }
}

static hpt_ray_triangle_maker *const makers[] = {
    hpt_random_pair,
    hpt_grazing_pair,
    hpt_slanting_pair,
    hpt_sliver_pair,
    hpt_offset_pair,
    hpt_vertex_pair,
    hpt_edge_pair,
    hpt_start_pair,
    hpt_behind_pair,
    hpt_one_bit_off_pair,
    hpt_parallel_pair,
    hpt_flat_pair,
    hpt_still_pair,
    hpt_signed_zero_pair,
    hpt_nonfinite_pair,
    hpt_tiny_pair,
    hpt_two_nonfinite_pair,
    hpt_subnormal_word_pair,
    hpt_underflow_pair,
    hpt_overflow_pair,
    hpt_far_hit_pair,
    special_pair,
    whole_pair,
    bits_pair,
};

enum { MAKERS = sizeof makers / sizeof *makers };

static float rays[PAIRS][6], triangles[PAIRS][9];

static void draw_pairs(uint64_t seed) {
    hpt_random random = hpt_random_seed(seed);
    for (unsigned i = 0; i < PAIRS; i++) makers[i % MAKERS](&random, i / MAKERS, rays[i], triangles[i]);
}

static bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

/* A matrix that moves little, so that some rays still hit, with words that underflow. */
static void draw_matrix(hpt_random *random, float matrix[12]) {
    for (unsigned i = 0; i < 12; i++) {
        float nudge = (float)hpt_random_between(random, -1, 1);
        matrix[i] = (i % 5 == 0 ? 1.0f : 0.0f) + nudge * (i % 4 == 3 ? 0x1p-126f : 0x1p-20f);
    }
}

static hp_result scalar(const float *ray, const float *triangle, const float *matrix, bool flush, uint32_t index) {
    float moved[9];
    hp_subnormals subnormals = flush ? HP_FLUSH : HP_GRADUAL;
    if (matrix) hp_transform_object(HP_TRIANGLE, subnormals, matrix, triangle, moved);
    return hp_pipe_test(HP_PAIR_RAY_TRIANGLE, subnormals, false, ray, matrix ? moved : triangle, index);
}

/* Calls check(wide pipe, flush) for every instruction set and both ways of underflow. */
static void on_every_isa(void (*check)(const hp_wide_pipe *pipe, bool flush)) {
    unsigned isas = 0;
    for (const char *isa; (isa = hp_isa_name(isas)); isas++) {
        const hp_wide_pipe *pipe = hp_wide_pipe_of(isa, HP_PAIR_RAY_TRIANGLE);
        assert_non_null(pipe);
        check(pipe, false);
        check(pipe, true);
    }
    assert_true(isas >= 1);
}

/* ---- pairs
 * ----------------------------------------------------------------------------------------------------------- */

static uint32_t F[PAIRS];
static float T[PAIRS], X[PAIRS], Y[PAIRS], Z[PAIRS];
static const hp_pairs_out out = {F, T, {X, Y, Z}};

static void check_pairs(const hp_wide_pipe *pipe, bool flush, unsigned step, const float *matrix, unsigned first,
                        unsigned n) {
    F[n] = 12345;
    pipe->pairs(rays[first], step, triangles[first], n, matrix, flush, &out);
    assert_int_equal(F[n], 12345);
    for (unsigned i = 0; i < n; i++) {
        hp_result want = scalar(rays[first + i * step], triangles[first + i], matrix, flush, 0);
        assert_int_equal(F[i], want.F);
        assert_true(same_bits(T[i], want.T));
        assert_true(same_bits(X[i], want.CP[0]) && same_bits(Y[i], want.CP[1]) && same_bits(Z[i], want.CP[2]));
    }
}

static void check_pairs_of_all_kinds(const hp_wide_pipe *pipe, bool flush) {
    hpt_random random = hpt_random_seed(7);
    float matrix[12];
    draw_matrix(&random, matrix);
    check_pairs(pipe, flush, 1, NULL, 0, PAIRS - 1);
    check_pairs(pipe, flush, 1, matrix, 0, PAIRS - 1);
    for (unsigned n = 0; n < 70; n++) check_pairs(pipe, flush, n % 2, n % 3 ? NULL : matrix, n * 31, n);
}

static void test_pairs(void **state) {
    (void)state;
    draw_pairs(1);
    on_every_isa(check_pairs_of_all_kinds);
}

/* ---- closest, any
 * ----------------------------------------------------------------------------------------------------- */

typedef struct packet {
    hp_lanes lanes;
    unsigned from, to;
    float T[RAYS];
    uint32_t index[RAYS];
} packet;

static packet wanted;

/* Rays for [0, to), then zeros to the next multiple of 16, then words that must not be looked at. */
static void fill_lanes(hpt_random *random, unsigned from, unsigned to, unsigned *ray_of) {
    for (unsigned i = 0; i < RAYS; i++) {
        ray_of[i] = (unsigned)hpt_random_below(random, PAIRS);
        for (unsigned w = 0; w < 6; w++)
            wanted.lanes.word[w][i] = i < to ? rays[ray_of[i]][w] : i < (to + 15) / 16 * 16 ? 0.0f : NAN;
    }
    wanted.from = from, wanted.to = to;
}

/* The answers by the scalar datapath, from the definition of the modes. */
static void fold(const unsigned *ray_of, unsigned first, unsigned n, const float *matrix, bool flush, bool any) {
    for (unsigned i = 0; i < RAYS; i++) {
        wanted.T[i] = INFINITY, wanted.index[i] = HP_NO_INDEX;
        if (i < wanted.from || i >= wanted.to) continue;
        for (unsigned k = 0; k < n; k++) {
            hp_result r = scalar(rays[ray_of[i]], triangles[first + k], matrix, flush, 1000 + k);
            if (!r.F || (any ? wanted.index[i] != HP_NO_INDEX : !(r.T < wanted.T[i]))) continue;
            wanted.T[i] = r.T, wanted.index[i] = r.index;
        }
    }
}

static void run_mode(const hp_wide_pipe *pipe, unsigned first, unsigned n, const float *matrix, bool flush, bool any,
                     hp_best *best) {
    static _Alignas(64) float prepared[HP_BLOCK * HP_PREPARED_MAX];
    for (unsigned done = 0; done < n;) {
        unsigned block = n - done < HP_BLOCK ? n - done : HP_BLOCK;
        pipe->prepare(triangles[first + done], block, matrix, flush, prepared);
        (any ? pipe->any : pipe->closest)(&wanted.lanes, wanted.from, wanted.to, prepared, block, 1000 + done, flush,
                                          best);
        done += block;
    }
}

static void check_mode(hpt_random *random, const hp_wide_pipe *pipe, bool flush, unsigned from, unsigned to,
                       unsigned n) {
    unsigned ray_of[RAYS], first = (unsigned)hpt_random_below(random, PAIRS - n);
    float matrix[12];
    draw_matrix(random, matrix);
    fill_lanes(random, from, to, ray_of);
    for (unsigned way = 0; way < 4; way++) {
        const float *moves = way & 1 ? matrix : NULL;
        bool any = way & 2;
        static hp_best best;
        hp_best_begin(&best, HP_PAIR_RAY_TRIANGLE, false);
        run_mode(pipe, first, n, moves, flush, any, &best);
        fold(ray_of, first, n, moves, flush, any);
        assert_memory_equal(best.T, wanted.T, sizeof wanted.T);
        assert_memory_equal(best.index, wanted.index, sizeof wanted.index);
    }
}

static void check_modes(const hp_wide_pipe *pipe, bool flush) {
    hpt_random random = hpt_random_seed(11);
    check_mode(&random, pipe, flush, 0, RAYS, TRIANGLES);
    check_mode(&random, pipe, flush, 0, 0, 5);
    for (unsigned to = 1; to <= 66; to++) check_mode(&random, pipe, flush, to > 20 ? 16 : 0, to, to % 7 * 3);
    for (unsigned round = 0; round < ROUNDS; round++) {
        unsigned from = 16 * (unsigned)hpt_random_below(&random, 12);
        check_mode(&random, pipe, flush, from, from + (unsigned)hpt_random_below(&random, RAYS - from + 1), 40);
    }
}

static void test_closest_and_any(void **state) {
    (void)state;
    draw_pairs(2);
    on_every_isa(check_modes);
}

/* The inputs above must mean something: hits, misses, and a difference between the two ways of underflow. */
static void test_inputs_hit_and_underflow(void **state) {
    (void)state;
    unsigned hits = 0, differ = 0;
    draw_pairs(1);
    for (unsigned i = 0; i < PAIRS; i++) {
        hp_result gradual = scalar(rays[i], triangles[i], NULL, false, 0);
        hp_result flush = scalar(rays[i], triangles[i], NULL, true, 0);
        hits += gradual.F;
        differ += memcmp(&gradual, &flush, sizeof flush) != 0;
    }
    assert_in_range(hits, PAIRS / 10, PAIRS / 2);
    assert_true(differ > PAIRS / 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs),
        cmocka_unit_test(test_closest_and_any),
        cmocka_unit_test(test_inputs_hit_and_underflow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
