/* Hashing the results of a pipe. */
#include "testbench/support/hash.h"
#include "rtl_model/pipes/wide.h"
#include "testbench/support/random.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <string.h>

enum { CHUNK = 4096 };

/* Objects one after another, without gaps. */
typedef struct chunk {
    float primaries[CHUNK * HP_OBJECT_WORDS_MAX], secondaries[CHUNK * HP_OBJECT_WORDS_MAX];
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

/* ---- ray-triangle ---- */

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

/* ---- objects of any type ---- */

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
        draw_whole_point(random, point);
    else
        draw_point(random, 1, point);
}

/* 0 to 1; whole: 0, 1 or 2. */
static float draw_size(hpt_random *random, bool whole) {
    uint64_t r = hpt_random_bits(random);
    return whole ? (float)(r % 3) : (part(r, 0, 1) + 1) / 2;
}

static void draw_object(hpt_random *random, hp_object type, bool whole, float *words) {
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

/* Whether word w of an object is a length, not a part of a direction. */
static bool is_length(hp_object type, unsigned w) {
    if (type == HP_RAY) return w < 3;
    if (type == HP_OBB) return w < 6;
    return type == HP_PLANE ? w == 3 : true;
}

static void draw_bits(hpt_random *random, unsigned n, float *words) {
    for (unsigned w = 0; w < n; w++) {
        uint32_t r = (uint32_t)(hpt_random_bits(random) >> 32);
        memcpy(words + w, &r, sizeof r);
    }
}

/* Pair i: near each other; in whole numbers, so that they touch and coincide; so small that products underflow; any
 * bits at all. */
static void draw_any(hpt_random *random, uint64_t i, hp_pair pair, float *primary, float *secondary) {
    hp_object types[2] = {hp_pair_primary(pair), hp_pair_secondary(pair)};
    float *words[2] = {primary, secondary}, size = ldexpf(1, -(int)(hpt_random_bits(random) & 127));
    for (unsigned k = 0; k < 2; k++) {
        unsigned n = hp_object_words(types[k]);
        if (i % 8 == 7)
            draw_bits(random, n, words[k]);
        else
            draw_object(random, types[k], i & 1, words[k]);
        for (unsigned w = 0; w < n && i % 4 == 2; w++)
            if (is_length(types[k], w)) words[k][w] *= size;
    }
}

/* ---- hashing ---- */

static void draw(hpt_random *random, hp_pair pair, uint64_t first, unsigned n, chunk *c) {
    unsigned p = hp_object_words(hp_pair_primary(pair)), s = hp_object_words(hp_pair_secondary(pair));
    for (unsigned i = 0; i < n; i++) {
        float *primary = c->primaries + (size_t)i * p, *secondary = c->secondaries + (size_t)i * s;
        if (pair == HP_PAIR_RAY_TRIANGLE)
            kinds[i % (sizeof kinds / sizeof *kinds)](random, primary, secondary);
        else
            draw_any(random, first + i, pair, primary, secondary);
    }
}

static void test_scalar(const hpt_hashing *what, unsigned n, chunk *c) {
    unsigned p = hp_object_words(hp_pair_primary(what->pair)), s = hp_object_words(hp_pair_secondary(what->pair));
    for (unsigned i = 0; i < n; i++) {
        hp_result r = hp_pipe_test(what->pair, what->subnormals, what->separation, c->primaries + (size_t)i * p,
                                   c->secondaries + (size_t)i * s, 0);
        c->F[i] = r.F;
        c->T[i] = r.T;
        for (unsigned axis = 0; axis < 3; axis++) c->CP[axis][i] = r.CP[axis];
    }
}

static void test_wide(const hp_wide_pipe *pipe, const hpt_hashing *what, unsigned n, chunk *c) {
    hp_pairs_out out = {c->F, c->T, {c->CP[0], c->CP[1], c->CP[2]}};
    (what->separation ? pipe->distances : pipe->pairs)(c->primaries, 1, c->secondaries, n, NULL,
                                                       what->subnormals == HP_FLUSH, &out);
}

static uint64_t mix(uint64_t hash, const void *word) {
    uint32_t bits_of_word;
    memcpy(&bits_of_word, word, sizeof bits_of_word);
    return (hash ^ bits_of_word) * 0x100000001B3u;
}

uint64_t hpt_hash(const hpt_hashing *what, const char *isa, uint64_t *hits) {
    static _Thread_local chunk c;
    const hp_wide_pipe *pipe = hp_wide_pipe_of(isa, what->pair);
    bool scalar = strcmp(isa, "scalar") == 0;
    if (!pipe && !scalar) return 0;
    hpt_random random = hpt_random_seed(what->seed);
    uint64_t hash = 0xCBF29CE484222325u;
    *hits = 0;
    for (uint64_t done = 0; done < what->count; done += CHUNK) {
        unsigned n = what->count - done < CHUNK ? (unsigned)(what->count - done) : CHUNK;
        draw(&random, what->pair, done, n, &c);
        if (scalar)
            test_scalar(what, n, &c);
        else
            test_wide(pipe, what, n, &c);
        for (unsigned i = 0; i < n; i++) {
            *hits += c.F[i];
            hash = mix(mix(mix(mix(mix(hash, &c.F[i]), &c.T[i]), &c.CP[0][i]), &c.CP[1][i]), &c.CP[2][i]);
        }
    }
    return hash;
}
