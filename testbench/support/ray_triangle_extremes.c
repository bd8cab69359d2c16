/* Rays and triangles with words that are no usual number: infinities, NaN, subnormals, and sizes near either end. */
#include "ray_triangle_cases.h"

#include <math.h>
#include <string.h>

/* Quiet and signalling NaN of both signs, with and without payload, and both infinities. */
static const uint32_t nonfinite[] = {0x7FC00000, 0xFFC00000, 0x7FC12345, 0xFFFFFFFF,
                                     0x7F800001, 0xFFBFFFFF, 0x7F800000, 0xFF800000};
enum { NONFINITE = sizeof nonfinite / sizeof *nonfinite, WORDS = 15 };

static float *word_of(float ray[6], float triangle[9], unsigned i) {
    return i < 6 ? ray + i : triangle + (i - 6);
}

/* Writes bits, not a value: a signalling NaN stays one. */
static void put(float ray[6], float triangle[9], unsigned i, uint32_t bits) {
    memcpy(word_of(ray, triangle, i), &bits, sizeof bits);
}

/* Turns the direction from the origin to a point of the triangle about its middle. */
static void aim_inside(hpt_random *random, float ray[6], const float triangle[9]) {
    double u = hpt_random_between(random, 0.125, 0.375), v = hpt_random_between(random, 0.125, 0.375);
    for (int i = 0; i < 3; i++) {
        double point = (1 - u - v) * triangle[i] + u * triangle[3 + i] + v * triangle[6 + i];
        ray[3 + i] = hpt_to_float(point - ray[i]);
    }
}

/* A ray that hits, words about 2^least to 2^most. */
static void draw_hit(hpt_random *random, int least, int most, float ray[6], float triangle[9]) {
    double size = ldexp(1, least + (int)hpt_random_below(random, (uint64_t)(most - least + 1)));
    for (int i = 0; i < 9; i++) triangle[i] = hpt_to_float(size * hpt_random_between(random, -1, 1));
    for (int i = 0; i < 3; i++) ray[i] = hpt_to_float(size * hpt_random_between(random, -1, 1));
    aim_inside(random, ray, triangle);
}

void hpt_nonfinite_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw_hit(random, 0, 0, ray, triangle);
    put(ray, triangle, i % WORDS, nonfinite[i / WORDS % NONFINITE]);
}

void hpt_two_nonfinite_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw_hit(random, 0, 0, ray, triangle);
    unsigned first = i % WORDS, second = (first + 1 + i / WORDS % (WORDS - 1)) % WORDS;
    put(ray, triangle, first, nonfinite[NONFINITE - 1 - hpt_random_below(random, 2)]);
    put(ray, triangle, second, nonfinite[hpt_random_below(random, NONFINITE)]);
}

static float draw_subnormal(hpt_random *random) {
    double magnitude = (double)(1 + hpt_random_below(random, 0x7FFFFF));
    return (float)ldexp(hpt_random_below(random, 2) ? magnitude : -magnitude, -149);
}

void hpt_subnormal_word_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw_hit(random, 0, 0, ray, triangle);
    *word_of(ray, triangle, i % WORDS) = draw_subnormal(random);
    if (i % 2) aim_inside(random, ray, triangle);
}

void hpt_tiny_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    for (unsigned k = 0; k < WORDS; k++)
        *word_of(ray, triangle, k) = hpt_random_below(random, 4) ? draw_subnormal(random) : 0;
    double stretch = ldexp(1, 230 + (int)(i % 20));
    for (unsigned k = 0; k < 3; k++)
        ray[3 + k] =
            hpt_to_float(stretch * ((double)triangle[k] + triangle[3 + k] + triangle[6 + k] - 3 * (double)ray[k]));
}

void hpt_underflow_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw_hit(random, -75, -30, ray, triangle);
    double stretch = ldexp(1, (int)(i % 60));
    for (int k = 3; k < 6; k++) ray[k] = hpt_to_float(stretch * ray[k]);
}

void hpt_overflow_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    (void)i;
    draw_hit(random, 30, 126, ray, triangle);
}

void hpt_long_direction_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw_hit(random, 0, 20, ray, triangle);
    double stretch = ldexp(1, 76 + (int)(i % 30));
    for (int k = 3; k < 6; k++) ray[k] = hpt_to_float(stretch * ray[k]);
}

void hpt_far_hit_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw_hit(random, 30, 40, ray, triangle);
    double shrink = ldexp(1, -(100 + (int)(i % 32)));
    for (int k = 3; k < 6; k++) ray[k] = hpt_to_float(shrink * ray[k]);
}
