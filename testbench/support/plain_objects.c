#include "testbench/support/plain_objects.h"
#include <string.h>

float hpt_part(uint64_t random, unsigned which, float size) {
    return ((float)(random >> (21 * which) & 0x1FFFFF) * 0x1p-20f - 1) * size;
}

void hpt_draw_point(hpt_random *random, float size, float *point) {
    uint64_t r = hpt_random_bits(random);
    for (unsigned axis = 0; axis < 3; axis++) point[axis] = hpt_part(r, axis, size);
}

void hpt_draw_whole_point(hpt_random *random, float *point) {
    uint64_t r = hpt_random_bits(random);
    for (unsigned axis = 0; axis < 3; axis++) point[axis] = (float)((r >> (20 * axis)) % 7) - 3;
}

/* A frame from a quaternion of small whole numbers: its words are rounded once. `square`: along the axes. */
static void draw_axes(hpt_random *random, bool square, float axes[9]) {
    uint64_t r = hpt_random_bits(random);
    double q[4];
    for (unsigned i = 0; i < 4; i++) q[i] = (double)(r >> 10 * i & 1023) - 512;
    if (square) q[0] = 1, q[1] = (double)(r & 1), q[2] = q[3] = 0;
    double a = q[0], b = q[1], c = q[2], d = q[3], n = a * a + b * b + c * c + d * d;
    if (n == 0) a = n = 1;
    const double rows[9] = {
        a * a + b * b - c * c - d * d, 2 * (b * c - a * d),           2 * (b * d + a * c),
        2 * (b * c + a * d),           a * a - b * b + c * c - d * d, 2 * (c * d - a * b),
        2 * (b * d - a * c),           2 * (c * d + a * b),           a * a - b * b - c * c + d * d};
    for (unsigned i = 0; i < 9; i++) axes[i] = (float)(rows[i] / n);
}

static void draw_place(hpt_random *random, bool whole, float *point) {
    if (whole)
        hpt_draw_whole_point(random, point);
    else
        hpt_draw_point(random, 1, point);
}

/* 0 to 1; whole: 0, 1 or 2. */
static float draw_size(hpt_random *random, bool whole) {
    uint64_t r = hpt_random_bits(random);
    return whole ? (float)(r % 3) : (hpt_part(r, 0, 1) + 1) / 2;
}

void hpt_draw_plain_object(hpt_random *random, hp_object type, bool whole, float *words) {
    float axes[9];
    unsigned points = type == HP_TRIANGLE ? 3 : type == HP_RAY || type == HP_AABB || type == HP_CYLINDER ? 2 : 1;
    for (unsigned i = 0; i < points; i++) draw_place(random, whole, words + 3 * i);
    if (type == HP_SPHERE) words[3] = draw_size(random, whole);
    if (type == HP_CYLINDER) words[6] = draw_size(random, whole) / 2;
    for (unsigned i = 0; i < 3 && type == HP_AABB; i++) words[3 + i] = words[i] + draw_size(random, whole);
    for (unsigned i = 0; i < 3 && type == HP_OBB; i++) words[3 + i] = draw_size(random, whole);
    if (type == HP_OBB) draw_axes(random, whole, words + 6);
    if (type != HP_PLANE) return;
    words[3] = words[0];
    draw_axes(random, whole, axes);
    memcpy(words, axes, 3 * sizeof(float));
}

bool hpt_is_length(hp_object type, unsigned w) {
    if (type == HP_RAY) return w < 3;
    if (type == HP_OBB) return w < 6;
    return type == HP_PLANE ? w == 3 : true;
}
