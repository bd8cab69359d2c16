/* The oracle of all pairs: against answers worked out by hand, against itself under transformations that change no
 * answer, and its certificate against searches that are wrong. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "testbench/reference/judge.h"
#include "testbench/reference/search.h"
#include "testbench/reference/signed_distance.h"
#include "testbench/support/pair_cases.h"

#define WORDS(...) ((const float[HP_OBJECT_WORDS_MAX]){__VA_ARGS__})
#define ROOT2 1.41421356237309504880
#define ROOT3 1.73205080756887729353

static const hp_pair pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};
enum { PAIRS = sizeof pairs / sizeof *pairs };

/* ---- by hand ---- */

typedef struct known {
    hp_object a, b;
    const float *p, *s;
    double signed_distance;
} known;

#define CUBE(x, y, z) WORDS(x, y, z, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1)
/* turned by 45 degrees about z, about y; axes of binary32 are a frame but for 1e-8 */
#define R 0.70710678118654752440F
#define CUBE_Z(x, y, z) WORDS(x, y, z, 1, 1, 1, R, R, 0, -R, R, 0, 0, 0, 1)
#define CUBE_X(x, y, z) WORDS(x, y, z, 1, 1, 1, 1, 0, 0, 0, R, R, 0, -R, R)
#define TALL(x, y, z, r) WORDS(x, y, (z)-1, x, y, (z) + 1, r)
#define LONG(x, y, z, r) WORDS((x)-1, y, z, (x) + 1, y, z, r)
#define FACE WORDS(0, 0, 0, 4, 0, 0, 0, 3, 0)

static void by_hand(void **state) {
    (void)state;
    const known all[] = {
        /* apart: vertex to vertex, edge to edge, face to face; touching; a little and wholly inside */
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE(3, 3, 3), ROOT3},
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE(3, -4, 0), sqrt(5)},
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE(0, 0, 7), 5},
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE(2, 0.5F, 0), 0},
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE(1.75F, 0.5F, 0), -0.25},
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE(0, 0, 0), -2},
        {HP_OBB, HP_OBB, CUBE(0, 0, 0), CUBE_Z(3, 0, 0), 2 - ROOT2},
        {HP_OBB, HP_OBB, CUBE_Z(0, 0, 0), CUBE_X(0, 0, 3), 2 - ROOT2},
        {HP_OBB, HP_OBB, CUBE_Z(0, 0, 0), CUBE_X(0, 0, 2.25F), 2.25 - 1 - ROOT2},
        {HP_TRIANGLE, HP_AABB, FACE, WORDS(1, 1, 2, 2, 2, 3), 2},
        {HP_TRIANGLE, HP_AABB, FACE, WORDS(-3, -5, 0, -3, -4, 9), 5},
        {HP_TRIANGLE, HP_AABB, FACE, WORDS(-1, -1, -2, 5, 5, 1), -1},
        {HP_TRIANGLE, HP_AABB, FACE, WORDS(1, 1, 0, 1, 1, 0), 0},
        {HP_TRIANGLE, HP_AABB, FACE, WORDS(2, 1.5F, -1, 3, 3, 1), 0},
        {HP_TRIANGLE, HP_OBB, FACE, CUBE_Z(1, -1 - (float)ROOT2, 0), 1},
        {HP_TRIANGLE, HP_OBB, FACE, CUBE_X(1, 1, 1), 1 - ROOT2},
        {HP_SPHERE, HP_SPHERE, WORDS(0, 0, 0, 1), WORDS(3, 4, 0, 2), 2},
        {HP_SPHERE, HP_SPHERE, WORDS(0, 0, 0, 1), WORDS(0, 0, 0, 2), -3},
        {HP_SPHERE, HP_SPHERE, WORDS(1, 2, 3, 0), WORDS(1, 2, 3, 0), 0},
        {HP_TRIANGLE, HP_SPHERE, FACE, WORDS(1, 1, 3, 1), 2},
        {HP_TRIANGLE, HP_SPHERE, FACE, WORDS(1, 1, -0.5F, 2), -1.5},
        {HP_TRIANGLE, HP_SPHERE, FACE, WORDS(7, -4, 0, 1), 4},
        {HP_TRIANGLE, HP_SPHERE, WORDS(1, 1, 1, 1, 1, 1, 1, 1, 1), WORDS(1, 1, 4, 1), 2},
        {HP_TRIANGLE, HP_CYLINDER, FACE, TALL(1, 1, 3, 0.5F), 2},
        {HP_TRIANGLE, HP_CYLINDER, FACE, TALL(1, -2, 0, 0.5F), 1.5},
        {HP_TRIANGLE, HP_CYLINDER, FACE, TALL(1, -2, 5, 1), sqrt(17)},
        {HP_TRIANGLE, HP_CYLINDER, FACE, TALL(1, 1, 0.75F, 8), -0.25},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 1), TALL(5, 0, 0.5F, 2), 2},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 1), TALL(6, 0, 6, 1), 4 * ROOT2},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 1), LONG(0, 3, 0, 0.5F), 1.5},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 1), LONG(0, 1.25F, 0, 0.5F), -0.25},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 1), TALL(0, 0, 1.5F, 0.25F), -0.5},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 0.5F), TALL(0, 0, 0.25F, 0.75F), -1.25},
        {HP_CYLINDER, HP_CYLINDER, TALL(0, 0, 0, 0.5F), TALL(0x1p-20F, 0, 0.25F, 0.75F), 0x1p-20 - 1.25},
        {HP_OBB, HP_CYLINDER, CUBE(0, 0, 0), TALL(5, 5, 0, 1), 4 * ROOT2 - 1},
        {HP_OBB, HP_CYLINDER, CUBE(0, 0, 0), TALL(1, 1, 0, 0.5F), -0.5},
        {HP_TRIANGLE, HP_CYLINDER, FACE, TALL(4, 0, 0, 0.5F), -0.5},
        {HP_OBB, HP_CYLINDER, CUBE(0, 0, 0), LONG(0, 1.5F, 0, 1), -0.5},
        {HP_OBB, HP_PLANE, CUBE(0, 0, 0), WORDS(0, 0, 1, 3), 2},
        {HP_OBB, HP_PLANE, CUBE(0, 0, 0), WORDS(0, 0, 1, -0.25F), -0.75},
        {HP_OBB, HP_PLANE, CUBE_Z(0, 0, 0), WORDS(1, 0, 0, 2), 2 - ROOT2},
        {HP_SPHERE, HP_OBB, WORDS(3, 3, 3, 1), CUBE(0, 0, 0), 2 * ROOT3 - 1},
        {HP_SPHERE, HP_OBB, WORDS(0.5F, 0, 0, 0.25F), CUBE(0, 0, 0), -0.75},
        {HP_SPHERE, HP_OBB, WORDS(0, 2, 0, 1), CUBE_Z(0, 0, 0), 1 - ROOT2},
        {HP_RAY, HP_SPHERE, WORDS(0, 3, 0, 1, 0, 0), WORDS(9, 0, 0, 1), 2},
        {HP_RAY, HP_SPHERE, WORDS(0, 3, 0, -1, 0, 0), WORDS(4, 0, 0, 1), 4},
        {HP_RAY, HP_SPHERE, WORDS(0, 0.75F, 0, 1, 0, 0), WORDS(9, 0, 0, 1), -0.25},
        {HP_RAY, HP_CYLINDER, WORDS(0, 0, 5, 2, 0, 0), TALL(9, 0, 0, 1), 4},
        {HP_RAY, HP_CYLINDER, WORDS(0, 0, 0.75F, 2, 0, 0), TALL(9, 0, 0, 1), -0.25},
        {HP_RAY, HP_TRIANGLE, WORDS(1, 1, 8, 0, 0, 1), FACE, 8},
        {HP_RAY, HP_TRIANGLE, WORDS(1, 0.5F, 8, 0, 0, -1), FACE, -0.5},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        hpt_truth truth = hpt_truth_between(all[i].a, all[i].b, all[i].p, all[i].s);
        if (fabs(truth.signed_distance - all[i].signed_distance) > 2e-7 || !truth.certified)
            fail_msg("answer %zu: %.9g, not %.9g", i, truth.signed_distance, all[i].signed_distance);
        if (all[i].signed_distance != 0) assert_int_equal(truth.F, all[i].signed_distance < 0);
    }
}

static void near(double a, double b) {
    if (!(fabs(a - b) <= 1e-15 * fabs(b))) fail_msg("%.17g is not %.17g", a, b);
}

static void entries_by_hand(void **state) {
    (void)state;
    static const struct {
        hp_object solid;
        float ray[6], words[7];
        double t, cosine;
    } all[] = {
        {HP_SPHERE, {0, 0, 0, 2, 0, 0}, {8, 0, 0, 2}, 3, 1},
        {HP_SPHERE, {0, 3, 0, 1, 0, 0}, {9, 0, 0, 5}, 5, 0.8},
        {HP_SPHERE, {8, 1, 0, 2, 0, 0}, {8, 0, 0, 2}, 0, 1},
        {HP_CYLINDER, {0, 0, 0, 4, 0, 0}, {9, 0, -1, 9, 0, 1, 1}, 2, 1},
        {HP_CYLINDER, {0, 3, 0, 1, 0, 0}, {9, 0, -1, 9, 0, 1, 5}, 5, 0.8},
        {HP_CYLINDER, {9, 0, 8, 0, 0, -2}, {9, 0, -1, 9, 0, 1, 1}, 3.5, 1},
        {HP_CYLINDER, {5, 0, 5, 4, 0, -4}, {9, 0, -1, 9, 0, 1, 1}, 1, 1 / ROOT2},
        {HP_CYLINDER, {9, 0.5F, 0, 0, 0, -2}, {9, 0, -1, 9, 0, 1, 1}, 0, 1},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        hpt_truth truth = hpt_truth_between(HP_RAY, all[i].solid, all[i].ray, all[i].words);
        assert_true(truth.F && truth.crosses);
        near(truth.t, all[i].t);
        near(truth.cosine, all[i].cosine);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(truth.CP[k] - all[i].ray[k] - all[i].t * all[i].ray[3 + k]) < 1e-14);
    }
}

static void frames_are_nearest(void **state) {
    (void)state;
    hp_quad frame[3][3];
    hpt_nearest_frame(WORDS(0, 1, 0, 0, 0, -1, 1, 0, 0), frame);
    assert_true(frame[0][1] == 1 && frame[1][2] == -1 && frame[2][0] == 1 && frame[0][0] == 0);
    /* a shear by 2e leaves, as nearest, a turn by e: tan = 2e / 2 */
    float e = 0x1p-10F;
    hpt_nearest_frame(WORDS(1, 2 * e, 0, 0, 1, 0, 0, 0, 1), frame);
    assert_true(fabs((double)frame[0][1] / (double)frame[0][0] - e) < 1e-15);
    assert_true(fabs((double)frame[1][0] / (double)frame[1][1] + e) < 1e-15);
}

/* ---- what changes no answer ---- */

/* Coordinates in another order, and scaled. */
static void turn(hp_object object, const float *from, float scale, float *to) {
    unsigned vectors = object == HP_OBB ? 5 : hp_object_words(object) / 3;
    memcpy(to, from, sizeof(float) * hp_object_words(object));
    for (unsigned v = 0; v < vectors; v++)
        for (unsigned k = 0; k < 3; k++) {
            bool extents = object == HP_OBB && v == 1, axis = object == HP_OBB && v > 1;
            bool normal = object == HP_PLANE, direction = object == HP_RAY && v == 1;
            to[3 * v + (extents ? k : (k + 1) % 3)] = from[3 * v + k] * (axis || normal || direction ? 1 : scale);
        }
    if (object == HP_SPHERE || object == HP_PLANE) to[3] *= scale;
    if (object == HP_CYLINDER) to[6] *= scale;
}

static bool is_symmetric_body(hp_object object) {
    return object != HP_RAY && object != HP_PLANE;
}

static void agrees_with_itself(void **state) {
    (void)state;
    for (unsigned n = 0; n < PAIRS; n++)
        for (int class = 0; class < HPT_CLASSES; class ++) {
            hpt_random random = hpt_random_seed((uint64_t)(100 * n) + (uint64_t) class);
            hp_object a = hp_pair_primary(pairs[n]), b = hp_pair_secondary(pairs[n]);
            for (unsigned i = 0; i < 60; i++) {
                float p[HP_OBJECT_WORDS_MAX], s[HP_OBJECT_WORDS_MAX], q[HP_OBJECT_WORDS_MAX], t[HP_OBJECT_WORDS_MAX];
                hpt_draw_pair(&random, pairs[n], (hpt_class) class, i, p, s);
                assert_null(hp_object_fault(a, p));
                assert_null(hp_object_fault(b, s));
                hpt_truth truth = hpt_truth_of(pairs[n], p, s);
                double slack = 4e-9 * (truth.L + truth.C);
                if (!truth.certified) continue;
                turn(a, p, 0.25F, q);
                turn(b, s, 0.25F, t);
                hpt_truth turned = hpt_truth_of(pairs[n], q, t);
                assert_true(fabs(4 * turned.signed_distance - truth.signed_distance) <= slack);
                assert_int_equal(turned.crosses, truth.crosses);
                if (truth.crosses) assert_true(fabs(4 * turned.t - truth.t) <= 1e-12 * fabs(truth.t));
                if (!is_symmetric_body(a) || !is_symmetric_body(b)) continue;
                hpt_truth swapped = hpt_truth_between(b, a, s, p);
                assert_true(fabs(swapped.signed_distance - truth.signed_distance) <= slack);
            }
        }
}

/* Moving the primary the way the oracle says takes it to touching, and a known way beyond. */
static void directions_lead_to_touching(void **state) {
    (void)state;
    for (unsigned n = 0; n < PAIRS; n++) {
        hpt_random random = hpt_random_seed(n);
        unsigned within = 0, outside = 0;
        for (unsigned i = 0; i < 100 && pairs[n] != HP_PAIR_RAY_TRIANGLE; i++) {
            float p[HP_OBJECT_WORDS_MAX], s[HP_OBJECT_WORDS_MAX];
            hpt_draw_pair(&random, pairs[n], HPT_GRAZING, i, p, s);
            hpt_truth truth = hpt_truth_of(pairs[n], p, s);
            assert_true(truth.certified);
            assert_true(fabs(truth.signed_distance) <= 3000 * truth.band);
            within += fabs(truth.signed_distance) <= truth.band;
            outside += fabs(truth.signed_distance) > 16 * truth.band;
        }
        assert_true(pairs[n] == HP_PAIR_RAY_TRIANGLE || (within > 5 && outside > 20));
    }
}

/* ---- the certificate ---- */

static hpt_body drawn(hpt_random *random, hp_object a, hp_object b, unsigned i) {
    float p[HP_OBJECT_WORDS_MAX], s[HP_OBJECT_WORDS_MAX];
    hpt_draw_objects(random, a, b, HPT_RANDOM, i, p, s);
    hpt_body first = hpt_body_of(a, p), second = hpt_body_of(b, s);
    return hpt_difference(&first, &second);
}

/* One thing in what a search found, made wrong. */
static void spoil(hpt_random *random, hpt_search *found) {
    unsigned corner = found->corners ? (unsigned)hpt_random_below(random, found->corners) : 0;
    unsigned face = found->faces ? (unsigned)hpt_random_below(random, found->faces) : 0;
    switch (hpt_random_below(random, 7)) {
    case 0:
        found->direction[hpt_random_below(random, 3)] *= -1;
        break;
    case 1:
        found->direction[hpt_random_below(random, 3)] += (hp_quad)1e-3;
        break;
    case 2:
        found->weight[hpt_random_below(random, found->members)] *= 1.5;
        break;
    case 3:
        found->member[hpt_random_below(random, found->members)].ends ^= 1;
        break;
    case 4:
        if (found->corners) found->corner[corner].ends ^= 1u + (unsigned)hpt_random_below(random, 7);
        break;
    case 5:
        if (found->faces) found->face[face][0] = corner;
        break;
    default:
        if (found->faces) memcpy(found->face[face], found->face[--found->faces], sizeof found->face[0]);
    }
}

/* Bounds of a spoilt search enclose the answer all the same; where they have grown apart, that shows. */
static void certificate_trusts_no_search(void **state) {
    (void)state;
    static const hp_object kinds[][2] = {{HP_OBB, HP_OBB}, {HP_TRIANGLE, HP_CYLINDER}, {HP_CYLINDER, HP_CYLINDER}};
    hpt_search *found = malloc(sizeof *found);
    hpt_random random = hpt_random_seed(5);
    unsigned wider = 0, inside = 0;
    assert_non_null(found);
    for (unsigned i = 0; i < 600; i++) {
        hpt_body body = drawn(&random, kinds[i % 3][0], kinds[i % 3][1], i);
        hpt_distance truth = hpt_signed_distance(&body);
        double scale = 0x1p-4;
        hpt_search_in_double(&body, scale, found);
        inside += found->faces > 0;
        for (int k = 0; k < 3; k++) spoil(&random, found);
        hpt_bounds bounds = hpt_certify(&body, scale, found);
        assert_true((double)bounds.lower / scale <= truth.value + truth.gap + 1e-15);
        assert_true((double)bounds.upper / scale >= truth.value - 1e-15);
        wider += (double)(bounds.upper - bounds.lower) / scale > 1e-9 * truth.size;
    }
    assert_true(inside > 200 && wider > 300);
    free(found);
}

/* A surface that leaves the origin outside, or goes round it in part, bounds nothing. */
static void surfaces_must_close(void **state) {
    (void)state;
    hpt_body cube = hpt_body_of(HP_OBB, CUBE(0.25F, 0, 0));
    hpt_search *found = malloc(sizeof *found);
    assert_non_null(found);
    hpt_search_in_double(&cube, 0.25, found);
    assert_true(found->faces >= 12);
    assert_true(fabs((double)hpt_certify(&cube, 0.25, found).upper + 0.75 / 4) < 1e-15);
    cube.point[0][0] += 1;
    assert_true(hpt_certify(&cube, 0.25, found).upper >= 0);
    cube.point[0][0] -= 1;
    found->faces--;
    assert_true(hpt_certify(&cube, 0.25, found).upper >= 0);
    cube.point[0][0] = 3; /* weights that do not add up to 1 make no nearer point */
    hpt_search_in_double(&cube, 0.25, found);
    for (unsigned i = 0; i < found->members; i++) found->weight[i] /= 2;
    assert_true(fabs((double)hpt_certify(&cube, 0.25, found).upper - 0.5) < 1e-15);
    free(found);
}

/* ---- the judge ---- */

static void judge_measures_volumes(void **state) {
    (void)state;
    const float *p = WORDS(0, 0, 0, 1), *s = WORDS(1.5F, 0, 0, 1);
    hpt_truth truth = hpt_truth_of(HP_PAIR_SPHERE_SPHERE, p, s);
    assert_true(truth.L == 3.5 && truth.C == 1.5);
    hpt_given given = {true, 0.25, {-2, 0, 0}};
    hpt_verdict verdict = hpt_judge(HP_PAIR_SPHERE_SPHERE, p, s, &truth, true, &given);
    assert_true(verdict.right && verdict.measured && !verdict.separated);
    near(verdict.T_error, 0.25 / 3.5);
    near(verdict.CP_error, 2.5 / 3.5);
    given = (hpt_given){.T = 0};
    verdict = hpt_judge(HP_PAIR_SPHERE_SPHERE, p, s, &truth, true, &given);
    assert_true(!verdict.right && !verdict.within && !verdict.measured && verdict.margin > 1e5);
    s = WORDS(5, 0, 0, 1);
    truth = hpt_truth_of(HP_PAIR_SPHERE_SPHERE, p, s);
    given.T = 4;
    verdict = hpt_judge(HP_PAIR_SPHERE_SPHERE, p, s, &truth, true, &given);
    assert_true(verdict.right && verdict.separated);
    near(verdict.separation_error, 1 / 7.0);
    given.T = NAN;
    assert_true(isinf(hpt_judge(HP_PAIR_SPHERE_SPHERE, p, s, &truth, true, &given).separation_error));
    assert_false(hpt_judge(HP_PAIR_SPHERE_SPHERE, p, s, &truth, false, &given).separated);
    s = WORDS(2.000001F, 0, 0, 1);
    truth = hpt_truth_of(HP_PAIR_SPHERE_SPHERE, p, s);
    verdict = hpt_judge(HP_PAIR_SPHERE_SPHERE, p, s, &truth, true, &(hpt_given){true, 0, {1, 0, 0}});
    assert_true(!verdict.right && verdict.within && verdict.measured && verdict.T_error < 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_hand),
        cmocka_unit_test(entries_by_hand),
        cmocka_unit_test(frames_are_nearest),
        cmocka_unit_test(agrees_with_itself),
        cmocka_unit_test(directions_lead_to_touching),
        cmocka_unit_test(certificate_trusts_no_search),
        cmocka_unit_test(surfaces_must_close),
        cmocka_unit_test(judge_measures_volumes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
