/* What must hold of every pipe whatever the right answer is: symmetry, common rigid motion, continuity through
 * contact, exact scaling by powers of two, and closest as a fold over all. */
#include "testbench/support/pair_cases.h"
#include <hitpipe/hitpipe.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { PAIRS = 3000, STEPS = 40, PRIMARIES = 30, SECONDARIES = 25 };

static const hp_pair all_pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};
enum { ALL_PAIRS = sizeof all_pairs / sizeof *all_pairs };

/* A pair, and what its pipe says with the distance of a miss. */
typedef struct trial {
    hp_pair pair;
    hp_object types[2];
    float words[2][HP_OBJECT_WORDS_MAX];
} trial;

static hp_result ask(const trial *t) {
    return hp_pipe_test(t->pair, HP_GRADUAL, true, t->words[0], t->words[1], 0);
}

static bool is_ray_pair(const trial *t) {
    return t->types[0] == HP_RAY;
}

static trial draw(hpt_random *random, hp_pair pair, hpt_class class, unsigned i) {
    trial t = {.pair = pair, .types = {hp_pair_primary(pair), hp_pair_secondary(pair)}};
    hpt_draw_pair(random, pair, class, i, t.words[0], t.words[1]);
    return t;
}

/* ---- words of objects ---- */

/* What becomes of a word when things are moved. */
typedef enum kind { COORDINATE, DIRECTION, SIZE, OFFSET } kind;

static kind kind_of(hp_object type, unsigned w) {
    switch (type) {
    case HP_RAY:
        return w < 3 ? COORDINATE : DIRECTION;
    case HP_SPHERE:
        return w < 3 ? COORDINATE : SIZE;
    case HP_OBB:
        return w < 3 ? COORDINATE : w < 6 ? SIZE : DIRECTION;
    case HP_CYLINDER:
        return w < 6 ? COORDINATE : SIZE;
    case HP_PLANE:
        return w < 3 ? DIRECTION : OFFSET;
    case HP_TRIANGLE:
    case HP_AABB:
        return COORDINATE;
    }
    return COORDINATE;
}

/* A length no smaller than the scale that errors are measured in, up to a factor of a few. */
static double scale_of(const trial *t) {
    double scale = 0;
    for (unsigned k = 0; k < 2; k++)
        for (unsigned w = 0; w < hp_object_words(t->types[k]); w++)
            if (kind_of(t->types[k], w) != DIRECTION) scale = fmax(scale, fabs(t->words[k][w]));
    return scale;
}

static void move(trial *t, const double turn[9], const double by[3]) {
    for (unsigned k = 0; k < 2; k++)
        for (unsigned w = 0; w < hp_object_words(t->types[k]);) {
            kind of = kind_of(t->types[k], w);
            float *at = t->words[k] + w, old[3];
            if (of == SIZE || of == OFFSET) {
                if (of == OFFSET) *at += (float)(at[-3] * by[0] + at[-2] * by[1] + at[-1] * by[2]);
                w++;
                continue;
            }
            memcpy(old, at, sizeof old);
            for (unsigned row = 0; row < 3; row++)
                at[row] = (float)(turn[3 * row] * old[0] + turn[3 * row + 1] * old[1] + turn[3 * row + 2] * old[2] +
                                  (of == COORDINATE ? by[row] : 0));
            w += 3;
        }
}

static double uniform(hpt_random *random) {
    return hpt_random_between(random, -1, 1);
}

/* A rotation from a quaternion. */
static void draw_turn(hpt_random *random, double turn[9]) {
    double a = uniform(random), b = uniform(random), c = uniform(random), d = uniform(random) + 1.5;
    double n = a * a + b * b + c * c + d * d;
    const double rows[9] = {
        a * a + b * b - c * c - d * d, 2 * (b * c - a * d),           2 * (b * d + a * c),
        2 * (b * c + a * d),           a * a - b * b + c * c - d * d, 2 * (c * d - a * b),
        2 * (b * d - a * c),           2 * (c * d + a * b),           a * a - b * b - c * c + d * d};
    for (unsigned i = 0; i < 9; i++) turn[i] = rows[i] / n;
}

/* Negative inside, positive outside; of rays 0 for a hit. */
static double signed_distance(const trial *t, const hp_result *r) {
    return r->F ? is_ray_pair(t) ? 0 : -(double)r->T : r->T;
}

static void fail_at(const trial *t, unsigned i, const char *what, const hp_result *a, const hp_result *b) {
    fail_msg("%s, pair %u: %s: F %u T %.9g, F %u T %.9g", hp_pair_name(t->pair), i, what, a->F, a->T, b->F, b->T);
}

/* ---- properties ---- */

static void swapped_pairs_answer_the_same(hp_pair pair) {
    hpt_random random = hpt_random_seed(41);
    for (unsigned i = 0; i < PAIRS; i++) {
        trial t = draw(&random, pair, (hpt_class)(i % HPT_CLASSES), i), back = t;
        if (t.types[0] != t.types[1]) return;
        memcpy(back.words[0], t.words[1], sizeof t.words[0]);
        memcpy(back.words[1], t.words[0], sizeof t.words[1]);
        hp_result a = ask(&t), b = ask(&back);
        if (a.F != b.F || memcmp(&a.T, &b.T, sizeof a.T) != 0) fail_at(&t, i, "swapped", &a, &b);
    }
}

/* An aabb cannot turn, so its pair only moves. */
static void common_motion_changes_little(hp_pair pair) {
    static const double still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    hpt_random random = hpt_random_seed(42);
    unsigned compared = 0;
    for (unsigned i = 0; i < PAIRS; i++) {
        trial t = draw(&random, pair, HPT_RANDOM, i), moved = t;
        double turn[9], by[3] = {uniform(&random), uniform(&random), uniform(&random)};
        draw_turn(&random, turn);
        move(&moved, t.types[1] == HP_AABB ? still : turn, by);
        hp_result a = ask(&t), b = ask(&moved);
        double tolerance = 8e-6 * fmax(scale_of(&t), scale_of(&moved));
        double before = signed_distance(&t, &a), after = signed_distance(&moved, &b);
        if (fabs(before - after) > tolerance) fail_at(&t, i, "moved", &a, &b);
        compared += a.F == b.F;
    }
    assert_true(compared > PAIRS * 98 / 100);
}

/* The primary passes through the secondary along a line: from step to step the signed distance changes by no more
 * than the step. */
static void contact_is_passed_continuously(hp_pair pair) {
    hpt_random random = hpt_random_seed(43);
    unsigned contacts = 0;
    for (unsigned i = 0; i < PAIRS / STEPS * 4; i++) {
        trial start = draw(&random, pair, HPT_RANDOM, i);
        double direction[3] = {uniform(&random), uniform(&random), uniform(&random)};
        double length = hypot(hypot(direction[0], direction[1]), direction[2]), step = 3.0 / STEPS, last = 0;
        hp_result previous = {0};
        for (unsigned k = 0; k < STEPS && length > 0.1; k++) {
            trial t = start;
            double along = (k - STEPS / 2.0) * step / length;
            double by[3] = {along * direction[0], along * direction[1], along * direction[2]};
            hpt_move_object(t.types[0], t.words[0], by);
            hp_result r = ask(&t);
            double now = signed_distance(&t, &r);
            if (k && fabs(now - last) > step + 8e-6 * scale_of(&t)) fail_at(&t, i, "a jump", &previous, &r);
            contacts += k && r.F != previous.F;
            last = now;
            previous = r;
        }
    }
    assert_true(contacts > PAIRS / STEPS);
}

static void scale(trial *t, int lengths, int directions) {
    for (unsigned k = 0; k < 2; k++)
        for (unsigned w = 0; w < hp_object_words(t->types[k]); w++) {
            bool direction = kind_of(t->types[k], w) == DIRECTION;
            if (!direction) t->words[k][w] = ldexpf(t->words[k][w], lengths);
            if (direction && t->types[k] == HP_RAY) t->words[k][w] = ldexpf(t->words[k][w], directions);
        }
}

static void powers_of_two_scale_exactly(hp_pair pair) {
    hpt_random random = hpt_random_seed(44);
    for (unsigned i = 0; i < PAIRS; i++) {
        trial t = draw(&random, pair, i % 3 ? HPT_RANDOM : HPT_OFFSET, i), scaled = t;
        int lengths = (int)hpt_random_below(&random, 9) - 4, directions = (int)hpt_random_below(&random, 9) - 4;
        scale(&scaled, lengths, directions);
        hp_result a = ask(&t), b = ask(&scaled);
        int by = a.F && is_ray_pair(&t) ? lengths - directions : lengths;
        bool same = a.F == b.F && ldexpf(a.T, by) == b.T;
        for (unsigned axis = 0; axis < 3; axis++) same = same && ldexpf(a.CP[axis], lengths) == b.CP[axis];
        if (!same) fail_at(&t, i, "scaled", &a, &b);
    }
}

/* ---- closest is a fold over all, through driver and board ---- */

typedef struct fold {
    hp_pair pair;
    bool nearest;
    hp_result best[PRIMARIES];
} fold;

static bool comes_before(const fold *f, const hp_result *a, const hp_result *b) {
    if (a->F != b->F) return a->F;
    if (!a->F) return f->nearest && a->T < b->T;
    return hp_pair_keeps_deepest(f->pair) ? a->T > b->T : a->T < b->T;
}

static bool take(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                 size_t count) {
    fold *f = context;
    for (size_t i = 0; i < count; i++) {
        hp_result *best = &f->best[primary[i]], record = records[i];
        record.index = secondary[i];
        bool equal = !comes_before(f, &record, best) && !comes_before(f, best, &record) && record.F == best->F &&
                     record.index < best->index && best->index != HP_NO_INDEX;
        if (comes_before(f, &record, best) || equal) *best = record;
    }
    return true;
}

static void check_fold(hp_device *device, hp_pair pair, const float *primaries, bool nearest) {
    fold f = {.pair = pair, .nearest = nearest};
    hp_result closest[PRIMARIES];
    for (unsigned i = 0; i < PRIMARIES; i++)
        f.best[i] = (hp_result){.index = HP_NO_INDEX, .T = INFINITY, .stencil = 1};
    hp_query_def def = hp_default_query_def();
    def.pair = pair;
    def.mode = HP_MODE_ALL;
    assert_int_equal(hp_query_all(device, &def, primaries, PRIMARIES, take, &f), HP_OK);
    def.mode = HP_MODE_CLOSEST;
    def.nearest = nearest;
    assert_int_equal(hp_query(device, &def, primaries, PRIMARIES, closest), HP_OK);
    unsigned misses = 0, hits = 0;
    for (unsigned i = 0; i < PRIMARIES; i++) {
        if (memcmp(&closest[i], &f.best[i], sizeof f.best[i]) != 0)
            fail_msg("%s, primary %u: index %u T %.9g, of all %u T %.9g", hp_pair_name(pair), i, closest[i].index,
                     closest[i].T, f.best[i].index, f.best[i].T);
        hits += closest[i].F;
        misses += !closest[i].F && closest[i].index != HP_NO_INDEX;
    }
    assert_true(hits > 0);
    if (!nearest) assert_int_equal(misses, 0);
}

static void closest_is_a_fold_over_all(hp_pair pair) {
    float primaries[PRIMARIES * HP_OBJECT_WORDS_MAX], secondaries[SECONDARIES * HP_OBJECT_WORDS_MAX];
    hpt_random random = hpt_random_seed(45);
    hp_device_def def = hp_default_device_def();
    hp_device *device;
    def.board.loop_order = HP_PRIMARY_OUTER;
    def.board.lanes = 3;
    for (unsigned i = 0; i < PRIMARIES; i++) {
        trial t = draw(&random, pair, HPT_RANDOM, i);
        unsigned p = hp_object_words(t.types[0]), s = hp_object_words(t.types[1]);
        memcpy(primaries + i * p, t.words[0], p * sizeof(float));
        memcpy(secondaries + i % SECONDARIES * s, t.words[1], s * sizeof(float));
    }
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_upload(device, hp_pair_secondary(pair), secondaries, SECONDARIES), HP_OK);
    check_fold(device, pair, primaries, false);
    check_fold(device, pair, primaries, true);
    hp_close(device);
}

/* ---- every property of every pipe ---- */

static const struct {
    const char *name;
    void (*holds)(hp_pair pair);
} properties[] = {{"swapped, the same", swapped_pairs_answer_the_same},
                  {"common motion changes little", common_motion_changes_little},
                  {"contact is passed continuously", contact_is_passed_continuously},
                  {"powers of two scale exactly", powers_of_two_scale_exactly},
                  {"closest is a fold over all", closest_is_a_fold_over_all}};
enum { PROPERTIES = sizeof properties / sizeof *properties, TESTS = ALL_PAIRS * PROPERTIES };

static unsigned numbers[TESTS];

static void check(void **state) {
    unsigned number = *(const unsigned *)*state;
    properties[number % PROPERTIES].holds(all_pairs[number / PROPERTIES]);
}

int main(void) {
    static char names[TESTS][64];
    struct CMUnitTest tests[TESTS];
    for (unsigned i = 0; i < TESTS; i++) {
        numbers[i] = i;
        snprintf(names[i], sizeof names[i], "%s: %s", hp_pair_name(all_pairs[i / PROPERTIES]),
                 properties[i % PROPERTIES].name);
        tests[i] = (struct CMUnitTest){names[i], check, NULL, NULL, &numbers[i]};
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
