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

/* Moves the primary along -out until it is in the secondary by `depth`, and takes the common point. */
static hp_status touch(const contact_asking *asking, double size, hp_contact *contact) {
    double distance = apart(asking, &contact->answer), depth = 1e-3 * size;
    hp_vector by = hp_vector_along((hp_vector){0}, -distance - depth, contact->out);
    hp_result touching;
    hp_status status = ask(asking, &by, 1, &touching);
    if (status != HP_OK || !touching.F) return status;
    if (asking->object != HP_RAY && fabs((double)touching.T - depth) > 0.1 * depth) return HP_OK;
    contact->on_secondary = (hp_vector){touching.CP[0], touching.CP[1], touching.CP[2]};
    contact->on_primary = hp_vector_along(contact->on_secondary, distance, contact->out);
    contact->found = true;
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
    bool ray_hit = contact->answer.F && asking.object == HP_RAY;
    for (double step = 3e-3 * size; status == HP_OK && !ray_hit && !contact->found && step > 2e-4 * size; step /= 3) {
        hp_vector slope = {0};
        status = gradient(&asking, step, &slope);
        contact->out = hp_vector_unit(slope);
        if (status == HP_OK && fabs(hp_vector_dot(slope, slope) - 1) < 0.02) status = touch(&asking, size, contact);
    }
    return status;
}
