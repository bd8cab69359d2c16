#include "host/cli/contact.h"

#include <string.h>

void hp_shape_move(hp_object object, const float *words, hp_vector by, float *moved) {
    const double xyz[3] = {by.x, by.y, by.z};
    unsigned n = hp_object_words(object), places = 1; /* leading points of the words */
    if (object == HP_TRIANGLE) places = 3;
    if (object == HP_AABB || object == HP_CYLINDER) places = 2;
    memcpy(moved, words, n * sizeof *moved);
    for (unsigned i = 0; i < 3 * places; i++) moved[i] = (float)((double)words[i] + xyz[i % 3]);
}

/* The secondary is on the board already. */
typedef struct contact_asking {
    hp_device *device;
    hp_query_def query;
    hp_object object;
    const float *primary;
} contact_asking;

/* Answers for the primary moved by each of n vectors, at most 6. */
static hp_status ask(const contact_asking *asking, const hp_vector *by, size_t n, hp_result *answers) {
    float words[6 * HP_OBJECT_WORDS_MAX];
    for (size_t i = 0; i < n; i++)
        hp_shape_move(asking->object, asking->primary, by[i], words + i * hp_object_words(asking->object));
    return hp_query(asking->device, &asking->query, words, n, answers);
}

/* Distance; within each other negative. A ray that hits has none. */
static double apart(const contact_asking *asking, const hp_result *answer) {
    if (!answer->F) return (double)answer->T;
    return asking->object == HP_RAY ? 0 : -(double)answer->T;
}

/* The gradient of the distance over steps of both signs; it has length 1 where there is one direction. */
static hp_status gradient(const contact_asking *asking, double step, hp_vector *gradient) {
    const hp_vector by[6] = {{step, 0, 0}, {-step, 0, 0}, {0, step, 0}, {0, -step, 0}, {0, 0, step}, {0, 0, -step}};
    hp_result answers[6];
    hp_status status = ask(asking, by, 6, answers);
    if (status != HP_OK) return status;
    double slope[3];
    for (int i = 0; i < 3; i++)
        slope[i] = (apart(asking, &answers[2 * i]) - apart(asking, &answers[2 * i + 1])) / (2 * step);
    *gradient = hp_vector_of(slope);
    return HP_OK;
}

static void meet_at(hp_contact *contact, hp_vector on_secondary, double distance) {
    contact->on_secondary = on_secondary;
    contact->on_primary = hp_vector_along(on_secondary, distance, contact->out);
    contact->found = true;
}

/* A ray that is moved past a triangle's corner need not hit: the corner furthest on the ray's side is the point if
 * the ray is that far from it. */
static void touch_corner(const contact_asking *asking, const float *triangle, double size, hp_contact *contact) {
    const float *ray = asking->primary;
    hp_vector origin = {ray[0], ray[1], ray[2]}, along = hp_vector_unit((hp_vector){ray[3], ray[4], ray[5]});
    double distance = apart(asking, &contact->answer);
    for (int i = 0; i < 3; i++) {
        hp_vector corner = {triangle[3 * i], triangle[3 * i + 1], triangle[3 * i + 2]};
        hp_vector foot = hp_vector_along(corner, distance, contact->out), off = hp_vector_sub(foot, origin);
        double behind = fmax(0, hp_vector_dot(off, along));
        hp_vector miss = hp_vector_along(off, -behind, along);
        if (sqrt(hp_vector_dot(miss, miss)) < 1e-2 * fmin(size, distance)) meet_at(contact, corner, distance);
    }
}

/* Moves the primary along -out until it is in the secondary by `depth`, and takes the common point. */
static hp_status touch(const contact_asking *asking, double size, hp_contact *contact) {
    double distance = apart(asking, &contact->answer), depth = 1e-3 * size;
    hp_vector by = hp_vector_along((hp_vector){0}, -distance - depth, contact->out);
    hp_result touching;
    hp_status status = ask(asking, &by, 1, &touching);
    if (status != HP_OK || !touching.F) return status;
    /* less deep is right too: a corner past a corner is soon out again another way */
    if (asking->object != HP_RAY && (double)touching.T > 1.1 * depth) return HP_OK;
    meet_at(contact, (hp_vector){touching.CP[0], touching.CP[1], touching.CP[2]}, distance);
    return HP_OK;
}

hp_status hp_contact_find(hp_device *device, hp_pair pair, const float *primary, const float *secondary, double size,
                          hp_contact *contact) {
    contact_asking asking = {device, hp_default_query_def(), hp_pair_primary(pair), primary};
    asking.query.pair = pair;
    asking.query.nearest = true;
    *contact = (hp_contact){.found = false};
    hp_status status = hp_upload(device, hp_pair_secondary(pair), secondary, 1);
    if (status == HP_OK) status = ask(&asking, &(hp_vector){0, 0, 0}, 1, &contact->answer);
    if (status != HP_OK) return status;
    bool ray_hit = contact->answer.F && asking.object == HP_RAY;
    for (double step = 3e-3 * size; status == HP_OK && !ray_hit && !contact->found && step > 2e-4 * size; step /= 3) {
        hp_vector slope = {0};
        status = gradient(&asking, step, &slope);
        contact->out = hp_vector_unit(slope);
        bool one_way = status == HP_OK && fabs(hp_vector_dot(slope, slope) - 1) < 0.02;
        if (one_way) status = touch(&asking, size, contact);
        if (one_way && !contact->found && pair == HP_PAIR_RAY_TRIANGLE)
            touch_corner(&asking, secondary, size, contact);
    }
    /* moved, a tiny object may be none any more: a cylinder's caps become one point */
    return status == HP_ERROR_INPUT ? HP_OK : status;
}
