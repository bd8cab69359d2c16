/* Drawings of a pair: what hides what, where surfaces cross, and that T is drawn in its direction. */
#include "host/cli/contact.h"
#include "host/output/wireframe.h"
#include "testbench/support/pair_cases.h"

#include <hitpipe/pipe.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const float ball[] = {1, 2, 3, 2}, box[] = {0, 0, 0, 2, 2, 2}, rod[] = {0, 0, -2, 0, 0, 2, 1},
                   tile[] = {0, 0, 1, 4, 0, 1, 0, 4, 1}, floor_[] = {0, 0, 1, -1},
                   turned[] = {0, 0, 0, 1, 2, 3, 0, 1, 0, -1, 0, 0, 0, 0, 1}, beam[] = {0, 0, 0, 0, 0, 1};

/* Lines, and where the figure on them ends. */
static const struct {
    hp_object object;
    const float *words;
    hp_vector at, toward;
    double end;
} ends[] = {
    {HP_SPHERE, ball, {1, 2, 0}, {0, 0, 1}, 5},
    {HP_SPHERE, ball, {1, 2, 9}, {0, 0, 1}, -4},
    {HP_SPHERE, ball, {3.1, 2, 3}, {0, 0, 1}, -INFINITY},
    {HP_AABB, box, {1, 1, 0}, {0, 0, 1}, 2},
    {HP_AABB, box, {1, -1, 1}, {0.6, 0.8, 0}, 5.0 / 3},
    {HP_AABB, box, {1, 2.1, 0}, {0, 0, 1}, -INFINITY},
    {HP_OBB, turned, {0, 0, 0}, {1, 0, 0}, 2}, /* its second axis lies along -x */
    {HP_OBB, turned, {0, 0, 0}, {0, 1, 0}, 1},
    {HP_OBB, turned, {0, 1.1, 0}, {1, 0, 0}, -INFINITY},
    {HP_CYLINDER, rod, {0, 0, 0}, {0, 0, 1}, 2},
    {HP_CYLINDER, rod, {0, 0, 0}, {0, 0.6, 0.8}, 5.0 / 3}, /* through the side */
    {HP_CYLINDER, rod, {0, 0, 1}, {0, 0.6, 0.8}, 1.25},    /* through the cap */
    {HP_CYLINDER, rod, {1.1, 0, 0}, {0, 0, 1}, -INFINITY},
    {HP_CYLINDER, rod, {-5, 0, 2.1}, {1, 0, 0}, -INFINITY},
    {HP_TRIANGLE, tile, {1, 1, 0}, {0, 0, 1}, 1},
    {HP_TRIANGLE, tile, {1, 1, 3}, {0, 0, 1}, -2},
    {HP_TRIANGLE, tile, {2.1, 2, 0}, {0, 0, 1}, -INFINITY},
    {HP_PLANE, floor_, {1.9, -1.9, -2}, {0, 0, 1}, 1}, /* a square of side 4 about 0, 0, -1 */
    {HP_PLANE, floor_, {2.1, 0, -2}, {0, 0, 1}, -INFINITY},
    {HP_RAY, beam, {0, 0, 0}, {0, 0, 1}, -INFINITY},
};

static void figures_end_where_they_do(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        hp_figure figure = {ends[i].object, ends[i].words, {0, 0, 5}, 2};
        double end = hp_figure_end(&figure, ends[i].at, ends[i].toward);
        bool same = isfinite(ends[i].end) ? fabs(end - ends[i].end) < 1e-12 : end == ends[i].end;
        if (!same) fail_msg("line %zu: %g, not %g", i, end, ends[i].end);
    }
}

/* Length on the page of the strokes of an ink and pen. */
static double drawn(const hp_drawing *drawing, hp_ink ink, hp_pen pen) {
    double sum = 0;
    for (size_t i = 0; i < drawing->stroke_count; i++) {
        const hp_stroke *stroke = &drawing->strokes[i];
        if (stroke->ink != ink || stroke->pen != pen) continue;
        for (size_t k = 1; k < stroke->count + (stroke->closed ? 1 : 0); k++) {
            const double *a = drawing->points[stroke->first + k - 1];
            const double *b = drawing->points[stroke->first + k % stroke->count];
            sum += hypot(b[0] - a[0], b[1] - a[1]);
        }
    }
    return sum;
}

static void a_line_goes_behind_what_hides_it(void **state) {
    (void)state;
    hp_figure cover = {HP_AABB, box, {0, 0, 0}, 0};
    hp_drawing drawing = hp_drawing_begin(0, 90); /* from above: z hides */
    drawing.cover = &cover;
    const hp_vector under[] = {{-1, 1, -1}, {4, 1, -1}}, over[] = {{-1, 1, 3}, {4, 1, 3}};
    const hp_vector through[] = {{-1, 1, 0}, {3, 1, 4}}; /* leaves by the top at x 1 */
    hp_drawing_line(&drawing, HP_INK_PRIMARY, HP_PEN_FRONT, under, 2, false);
    assert_true(fabs(drawn(&drawing, HP_INK_PRIMARY, HP_PEN_FRONT) - 3) < 1e-6);
    assert_true(fabs(drawn(&drawing, HP_INK_PRIMARY, HP_PEN_BACK) - 2) < 1e-6);
    hp_drawing_line(&drawing, HP_INK_SECONDARY, HP_PEN_FRONT, over, 2, false);
    assert_true(fabs(drawn(&drawing, HP_INK_SECONDARY, HP_PEN_FRONT) - 5) < 1e-6);
    hp_drawing_line(&drawing, HP_INK_MEASURE, HP_PEN_FRONT, through, 2, false);
    assert_true(fabs(drawn(&drawing, HP_INK_MEASURE, HP_PEN_BACK) - 1) < 1e-6);
    /* of a ghost the hidden part is left out, and a line that nothing hides stays closed */
    hp_drawing_line(&drawing, HP_INK_GHOST, HP_PEN_FRONT, under, 2, false);
    assert_true(fabs(drawn(&drawing, HP_INK_GHOST, HP_PEN_FRONT) - 3) < 1e-6);
    assert_true(drawn(&drawing, HP_INK_GHOST, HP_PEN_BACK) == 0);
    const hp_vector apart[] = {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}};
    hp_drawing_line(&drawing, HP_INK_MEETING, HP_PEN_FRONT, apart, 3, true);
    assert_true(drawing.strokes[drawing.stroke_count - 1].closed);
    assert_false(drawing.failed);
    hp_drawing_free(&drawing);
}

static void surfaces_cross_where_they_do(void **state) {
    (void)state;
    const float away[] = {9, 0, 0, 1}, higher[] = {0, 0, -0.25f, 1.25f}, lower[] = {0, 0, -1.75f, 1.25f};
    hp_figure plane = {HP_PLANE, floor_, {0, 0, 0}, 2}, sphere = {HP_SPHERE, away, {0, 0, 0}, 0};
    hp_drawing drawing = hp_drawing_begin(30, 90);
    hp_wireframe(&drawing, HP_INK_SECONDARY, &plane);
    hp_drawing_meeting(&drawing, &sphere, &plane);
    assert_true(drawn(&drawing, HP_INK_MEETING, HP_PEN_FRONT) == 0);
    sphere.words = higher; /* it meets the plane in a circle of radius 1 below its widest: hidden from above */
    hp_drawing_meeting(&drawing, &sphere, &plane);
    assert_true(drawn(&drawing, HP_INK_MEETING, HP_PEN_FRONT) == 0);
    sphere.words = lower; /* the same above its widest */
    hp_drawing_meeting(&drawing, &sphere, &plane);
    assert_true(fabs(drawn(&drawing, HP_INK_MEETING, HP_PEN_FRONT) - 2 * acos(-1)) < 0.02);
    for (size_t i = 0; i < drawing.stroke_count; i++)
        for (size_t k = 0; drawing.strokes[i].ink == HP_INK_MEETING && k < drawing.strokes[i].count; k++) {
            const double *at = drawing.points[drawing.strokes[i].first + k];
            assert_true(fabs(hypot(at[0], at[1]) - 1) < 1e-3);
        }
    assert_false(drawing.failed);
    hp_drawing_free(&drawing);
}

/* ---- T in its direction ---- */

static hp_result ask(hp_pair pair, const float *primary, const float *secondary) {
    return hp_pipe_test(pair, HP_GRADUAL, true, primary, secondary, 0);
}

/* The primary moved by T, and a little less and a little more: in between a hit becomes a miss, or a miss a hit, and
 * T is what is left of it. */
static void moving_by_T_makes_them_touch(hp_pair pair, const float *primary, const float *secondary,
                                         const hp_contact *contact) {
    float moved[HP_OBJECT_WORDS_MAX];
    hp_object object = hp_pair_primary(pair);
    hp_vector by = hp_vector_sub(contact->on_secondary, contact->on_primary);
    double T = (double)contact->answer.T, length = sqrt(hp_vector_dot(by, by));
    assert_true(fabs(length - T) <= 1e-5 * T + 1e-6);
    hp_shape_move(object, primary, hp_vector_along((hp_vector){0}, 0.97, by), moved);
    hp_result before = ask(pair, moved, secondary);
    assert_true(before.F == contact->answer.F);
    assert_true(fabs((double)before.T - 0.03 * T) < 0.02 * T + 1e-4);
    hp_shape_move(object, primary, hp_vector_along((hp_vector){0}, 1.03, by), moved);
    hp_result after = ask(pair, moved, secondary);
    bool thin = pair == HP_PAIR_RAY_TRIANGLE; /* past its corner the ray may go by on the other side */
    if (T > 0.01 && !thin) assert_true(after.F != contact->answer.F);
    if (object != HP_RAY || !after.F) assert_true((double)after.T < 0.05 * T + 1e-4);
}

static void moving_the_primary_by_the_bar_makes_them_touch(void **state) {
    (void)state;
    static const hp_pair pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
    };
    hp_device_def def = hp_default_device_def();
    hp_device *device;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++) {
        hpt_random random = hpt_random_seed(8);
        int found = 0;
        for (unsigned i = 0; i < 60; i++) {
            float primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX];
            hp_contact contact;
            hpt_draw_pair(&random, pairs[p], HPT_RANDOM, i, primary, secondary);
            assert_int_equal(hp_contact_find(device, pairs[p], primary, secondary, 0.5, &contact), HP_OK);
            bool ray_hit = hp_pair_primary(pairs[p]) == HP_RAY && contact.answer.F;
            assert_false(ray_hit && contact.found);
            if (contact.found) moving_by_T_makes_them_touch(pairs[p], primary, secondary, &contact);
            found += ray_hit || contact.found;
        }
        if (found < 50) fail_msg("%s: a direction for %d of 60 alone", hp_pair_name(pairs[p]), found);
    }
    hp_close(device);
}

/* Moving it by the smallest step makes its ends one point, which is no cylinder. */
static void an_object_too_small_to_move_has_no_direction(void **state) {
    (void)state;
    static const float speck[] = {0, 0, 0, 0, 0, 1e-12f, 0}, rod_beside[] = {1, 0, -1, 1, 0, 1, 0.5f};
    hp_device_def def = hp_default_device_def();
    hp_device *device;
    hp_contact contact;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_contact_find(device, HP_PAIR_CYLINDER_CYLINDER, speck, rod_beside, 1, &contact), HP_OK);
    assert_false(contact.found);
    assert_true(contact.answer.F == 0 && fabs((double)contact.answer.T - 0.5) < 1e-6);
    hp_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_end_where_they_do),
        cmocka_unit_test(a_line_goes_behind_what_hides_it),
        cmocka_unit_test(surfaces_cross_where_they_do),
        cmocka_unit_test(moving_the_primary_by_the_bar_makes_them_touch),
        cmocka_unit_test(an_object_too_small_to_move_has_no_direction),
    };
    return cmocka_run_group_tests_name("drawing", tests, NULL, NULL);
}
