/* The update engine: what it keeps, and which stencil-T buffer it reads and writes. */
#include "rtl_model/update/update.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { PRIMARIES = 6 };

static hp_query query; /* an update engine reads its query as long as that is carried out */

static hp_update begin(hp_pair pair, hp_mode mode, bool nearest) {
    query = (hp_query){.pair = pair, .mode = mode, .active = PRIMARIES, .nearest = nearest};
    hp_update update = {0};
    hp_update_begin(&update, &query);
    return update;
}

static hp_result hit(float T, uint32_t index) {
    return (hp_result){1, index, T, {T, 0, 0}, 1};
}

static const hp_result miss = {0, HP_NO_INDEX, INFINITY, {0, 0, 0}, 1};

/* An entry is read from the buffer that was written last, and written to the other, whatever the outcome. */
static void buffers_take_turns(void **state) {
    (void)state;
    hp_update update = begin(HP_PAIR_RAY_TRIANGLE, HP_MODE_CLOSEST, false);
    const hp_result results[] = {hit(5, 0), miss, hit(7, 2), hit(3, 3)};
    const float kept[] = {5, 5, 5, 3};
    for (unsigned i = 0; i < 4; i++) {
        assert_int_equal(hp_update_take(&update, 2, 1, 1, i, &results[i]), 0);
        assert_int_equal(update.reads, i & 1);
        assert_true(update.T_read == (i ? kept[i - 1] : INFINITY) && update.T_written == kept[i]);
        assert_true(update.stencil_T[1 - (i & 1)][2].T == kept[i]);
        assert_int_equal(update.kept, i == 0 || i == 3);
    }
    assert_int_equal(hp_update_record(&update, 2).index, 3);
    assert_int_equal(hp_update_record(&update, 1).F, 0);
}

static void of_equal_T_the_first_is_kept(void **state) {
    (void)state;
    hp_update update = begin(HP_PAIR_RAY_TRIANGLE, HP_MODE_CLOSEST, false);
    const hp_result results[] = {hit(-0.0f, 4), hit(0, 5)};
    for (unsigned i = 0; i < 2; i++) hp_update_take(&update, 0, 1, 1, 4 + i, &results[i]);
    assert_int_equal(hp_update_record(&update, 0).index, 4);
}

/* any: the first hit stops its primary, and later ones change nothing. */
static void a_hit_stops_its_primary(void **state) {
    (void)state;
    hp_update update = begin(HP_PAIR_RAY_TRIANGLE, HP_MODE_ANY, false);
    const hp_result first[] = {miss, hit(5, 0), miss}, later[] = {hit(9, 1), hit(1, 1), miss};
    assert_int_equal(hp_update_take(&update, 0, 3, 7, 0, first), 2);
    assert_int_equal(hp_update_take(&update, 0, 3, 7, 1, later), 1);
    hp_result record = hp_update_record(&update, 1);
    assert_true(record.T == 5 && record.index == 0 && record.stencil == 0);
    assert_int_equal(hp_update_record(&update, 2).stencil, 1);
}

/* A lane whose primary was stopped holds what was there before, or nothing: the waveform shows another. */
static void the_lane_shown_was_a_test(void **state) {
    (void)state;
    hp_update update = begin(HP_PAIR_RAY_TRIANGLE, HP_MODE_ANY, false);
    const hp_result results[] = {hit(99, 9), hit(98, 8), hit(5, 0), miss};
    hp_update_take(&update, 1, 4, 4 | 8, 0, results);
    assert_int_equal(update.address, 3);
    assert_true(update.T_in == 5 && update.T_read == INFINITY && update.T_written == 5);
    hp_update_take(&update, 2, 4, 8, 1, results);
    assert_int_equal(update.address, 5);
    assert_int_equal(hp_update_record(&update, 1).F, 0);
}

static hp_result distance(float T) {
    return (hp_result){0, HP_NO_INDEX, T, {0, 0, 0}, 1};
}

/* What is kept of a sequence of results for one primary: the place of the result. */
static unsigned kept_of(hp_pair pair, bool nearest, const hp_result *results, unsigned n) {
    hp_update update = begin(pair, HP_MODE_CLOSEST, nearest);
    for (unsigned i = 0; i < n; i++) hp_update_take(&update, 0, 1, 1, i, &results[i]);
    hp_result record = hp_update_record(&update, 0);
    if (record.index != HP_NO_INDEX) {
        assert_int_equal(record.F, results[record.index].F);
        assert_true(record.T == results[record.index].T);
    }
    return record.index;
}

/* Ray pairs keep the smallest T, the others the deepest; with nearest any hit comes before any miss. */
static void each_pair_keeps_what_it_should(void **state) {
    (void)state;
    const hp_result hits[] = {distance(1), hit(2, 1), hit(0, 2), hit(5, 3), hit(5, 4), distance(0.5f)};
    const hp_result misses[] = {distance(3), distance(1), distance(1), distance(INFINITY)};
    const hp_result none[] = {distance(INFINITY)};
    assert_int_equal(kept_of(HP_PAIR_RAY_SPHERE, false, hits, 6), 2);
    assert_int_equal(kept_of(HP_PAIR_RAY_SPHERE, true, hits, 6), 2);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, false, hits, 6), 3);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, true, hits, 6), 3);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, false, hits, 1), HP_NO_INDEX);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, true, hits, 1), 0);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, false, misses, 4), HP_NO_INDEX);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, true, misses, 4), 1);
    assert_int_equal(kept_of(HP_PAIR_RAY_SPHERE, true, misses, 4), 1);
    assert_int_equal(kept_of(HP_PAIR_SPHERE_SPHERE, true, none, 1), HP_NO_INDEX);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(buffers_take_turns), cmocka_unit_test(of_equal_T_the_first_is_kept),
        cmocka_unit_test(a_hit_stops_its_primary), cmocka_unit_test(each_pair_keeps_what_it_should),
        cmocka_unit_test(the_lane_shown_was_a_test)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
