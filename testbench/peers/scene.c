#include "testbench/peers/scene.h"
#include "testbench/support/pair_cases.h"

#include <hitpipe/pipe.h>
#include <math.h>
#include <string.h>

enum { SEED = 2007, HALVINGS = 12, SAMPLE = 8 };

static void middle_of(hp_object type, const float *words, double middle[3]) {
    for (unsigned k = 0; k < 3; k++) {
        double v0 = words[k], v1 = words[3 + k], v2 = words[6 + k];
        bool two = type == HP_AABB || type == HP_CYLINDER;
        middle[k] = type == HP_TRIANGLE ? (v0 + v1 + v2) / 3 : two ? (v0 + v1) / 2 : v0;
    }
}

static void draw_place(hpt_random *random, double cube, double place[3]) {
    for (unsigned k = 0; k < 3; k++) place[k] = cube * hpt_random_between(random, -1, 1);
}

/* Five away from a place in the cube; a direction of any length. */
static void draw_ray(hpt_random *random, double cube, float ray[6]) {
    double place[3], square = 0;
    float sphere[HP_SPHERE_WORDS];
    hpt_draw_objects(random, HP_RAY, HP_SPHERE, HPT_RANDOM, 0, ray, sphere);
    for (unsigned k = 3; k < 6; k++) square += (double)ray[k] * (double)ray[k];
    draw_place(random, cube, place);
    for (unsigned k = 0; k < 3; k++) ray[k] = hpt_to_float(place[k] - 5 / sqrt(square) * (double)ray[3 + k]);
}

static void draw_object(hpt_random *random, hp_object type, double cube, float *words) {
    if (type == HP_RAY) {
        draw_ray(random, cube, words);
        return;
    }
    float sphere[HP_OBJECT_WORDS_MAX];
    double place[3], middle[3];
    hpt_draw_objects(random, type, HP_SPHERE, HPT_RANDOM, 1, words, sphere);
    draw_place(random, cube, place);
    if (type == HP_PLANE) {
        words[3] = hpt_to_float(place[0]);
        return;
    }
    middle_of(type, words, middle);
    for (unsigned k = 0; k < 3; k++) place[k] -= middle[k];
    hpt_move_object(type, words, place);
}

static void draw_scene(scene *s, double cube) {
    hpt_random random = hpt_random_seed(SEED + s->pair);
    hp_object a = hp_pair_primary(s->pair), b = hp_pair_secondary(s->pair);
    for (unsigned i = 0; i < SCENE_PRIMARIES; i++)
        draw_object(&random, a, cube, s->primaries + i * hp_object_words(a));
    for (unsigned i = 0; i < SCENE_SECONDARIES; i++)
        draw_object(&random, b, cube, s->secondaries + i * hp_object_words(b));
}

/* Every `step`-th secondary against all primaries. */
static size_t count_hits(const scene *s, unsigned step) {
    unsigned a = hp_object_words(hp_pair_primary(s->pair)), b = hp_object_words(hp_pair_secondary(s->pair));
    size_t hits = 0;
    for (unsigned j = 0; j < SCENE_SECONDARIES; j += step)
        for (unsigned i = 0; i < SCENE_PRIMARIES; i++)
            hits += hp_pipe_test(s->pair, HP_GRADUAL, false, s->primaries + i * a, s->secondaries + j * b, j).F;
    return hits;
}

void scene_make(scene *s, hp_pair pair) {
    memset(s, 0, sizeof *s);
    s->pair = pair;
    double near = 0, far = 8; /* all hit, few hit */
    for (unsigned i = 0; i < HALVINGS; i++) {
        double cube = (near + far) / 2;
        draw_scene(s, cube);
        if (2 * SAMPLE * count_hits(s, SAMPLE) > (size_t)SCENE_PRIMARIES * SCENE_SECONDARIES)
            near = cube;
        else
            far = cube;
    }
    draw_scene(s, far);
    s->hits = count_hits(s, 1);
}
