/* Hashing the results of a pipe. */
#include "testbench/support/hash.h"
#include "rtl_model/pipes/wide.h"
#include "testbench/support/random.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <string.h>

enum { CHUNK = 4096 };

typedef struct chunk {
    float rays[CHUNK][6], triangles[CHUNK][9];
    uint32_t F[CHUNK];
    float T[CHUNK], CP[3][CHUNK];
} chunk;

/* Evenly in [-size, size) from one of the three 21-bit parts of 64 random bits. */
static float part(uint64_t random, unsigned which, float size) {
    return ((float)(random >> (21 * which) & 0x1FFFFF) * 0x1p-20f - 1) * size;
}

static void draw_point(hpt_random *random, float size, float *point) {
    uint64_t r = hpt_random_bits(random);
    for (unsigned axis = 0; axis < 3; axis++) point[axis] = part(r, axis, size);
}

static void draw_whole_point(hpt_random *random, float *point) {
    uint64_t r = hpt_random_bits(random);
    for (unsigned axis = 0; axis < 3; axis++) point[axis] = (float)((r >> (20 * axis)) % 7) - 3;
}

/* Aims the ray at v0 + b1 e1 + b2 e2. */
static void aim(float b1, float b2, float ray[6], const float triangle[9]) {
    for (unsigned axis = 0; axis < 3; axis++) {
        float v0 = triangle[axis], e1 = triangle[3 + axis] - v0, e2 = triangle[6 + axis] - v0;
        ray[3 + axis] = v0 + b1 * e1 + b2 * e2 - ray[axis];
    }
}

/* Somewhere near or on the triangle. */
static void near(hpt_random *random, float ray[6], float triangle[9]) {
    for (unsigned vertex = 0; vertex < 3; vertex++) draw_point(random, 1, triangle + 3 * vertex);
    draw_point(random, 2, ray);
    uint64_t r = hpt_random_bits(random);
    aim(0.4f + part(r, 0, 0.7f), 0.4f + part(r, 1, 0.7f), ray, triangle);
}

/* Through an edge or a vertex, in whole numbers. */
static void edge(hpt_random *random, float ray[6], float triangle[9]) {
    for (unsigned vertex = 0; vertex < 3; vertex++) draw_whole_point(random, triangle + 3 * vertex);
    draw_whole_point(random, ray);
    uint64_t r = hpt_random_bits(random);
    float along = (float)(r % 3) / 2;
    unsigned side = (unsigned)(r >> 32) % 3;
    aim(side == 0 ? 0 : along, side == 0 ? along : side == 1 ? 0 : 1 - along, ray, triangle);
}

/* As `near` or `edge`, each of the points and the direction made so small that products underflow. */
static void small(hpt_random *random, float ray[6], float triangle[9]) {
    uint64_t r = hpt_random_bits(random);
    ((r & 1) ? near : edge)(random, ray, triangle);
    float place = ldexpf(1, -(int)(r >> 8 & 127)), direction = ldexpf(1, 64 - (int)(r >> 16 & 127));
    for (unsigned w = 0; w < 9; w++) triangle[w] *= place;
    for (unsigned w = 0; w < 3; w++) ray[w] *= place, ray[3 + w] *= direction;
}

/* Any bits at all. */
static void bits(hpt_random *random, float ray[6], float triangle[9]) {
    float words[16];
    for (unsigned w = 0; w < 16; w += 2) {
        uint64_t r = hpt_random_bits(random);
        memcpy(words + w, &r, sizeof r);
    }
    memcpy(ray, words, 6 * sizeof(float));
    memcpy(triangle, words + 6, 9 * sizeof(float));
}

static void (*const kinds[])(hpt_random *random, float ray[6], float triangle[9]) = {near, edge,  near, small,
                                                                                     edge, small, near, bits};

static void draw(hpt_random *random, unsigned n, chunk *c) {
    for (unsigned i = 0; i < n; i++) kinds[i % (sizeof kinds / sizeof *kinds)](random, c->rays[i], c->triangles[i]);
}

static void test_scalar(hp_subnormals subnormals, unsigned n, chunk *c) {
    for (unsigned i = 0; i < n; i++) {
        hp_result r = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, subnormals, false, c->rays[i], c->triangles[i], 0);
        c->F[i] = r.F;
        c->T[i] = r.T;
        for (unsigned axis = 0; axis < 3; axis++) c->CP[axis][i] = r.CP[axis];
    }
}

static void test_wide(const hp_wide_pipe *pipe, hp_subnormals subnormals, unsigned n, chunk *c) {
    hp_pairs_out out = {c->F, c->T, {c->CP[0], c->CP[1], c->CP[2]}};
    pipe->pairs(c->rays[0], 1, c->triangles[0], n, NULL, subnormals == HP_FLUSH, &out);
}

static uint64_t mix(uint64_t hash, const void *word) {
    uint32_t bits_of_word;
    memcpy(&bits_of_word, word, sizeof bits_of_word);
    return (hash ^ bits_of_word) * 0x100000001B3u;
}

uint64_t hpt_hash_ray_triangle(const char *isa, hp_subnormals subnormals, uint64_t seed, uint64_t count,
                               uint64_t *hits) {
    const hp_wide_pipe *pipe = hp_wide_pipe_of(isa, HP_PAIR_RAY_TRIANGLE);
    bool scalar = strcmp(isa, "scalar") == 0;
    if (!pipe && !scalar) return 0;
    hpt_random random = hpt_random_seed(seed);
    uint64_t hash = 0xCBF29CE484222325u;
    chunk c;
    *hits = 0;
    for (uint64_t done = 0; done < count; done += CHUNK) {
        unsigned n = count - done < CHUNK ? (unsigned)(count - done) : CHUNK;
        draw(&random, n, &c);
        if (scalar)
            test_scalar(subnormals, n, &c);
        else
            test_wide(pipe, subnormals, n, &c);
        for (unsigned i = 0; i < n; i++) {
            *hits += c.F[i];
            hash = mix(mix(mix(mix(mix(hash, &c.F[i]), &c.T[i]), &c.CP[0][i]), &c.CP[1][i]), &c.CP[2][i]);
        }
    }
    return hash;
}
