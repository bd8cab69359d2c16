/* Hashing the results of a pipe. */
#include "testbench/support/hash.h"
#include "rtl_model/pipes/wide.h"
#include "testbench/support/plain_objects.h"
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
    for (unsigned vertex = 0; vertex < 3; vertex++) hpt_draw_point(random, 1, triangle + 3 * vertex);
    hpt_draw_point(random, 2, ray);
    uint64_t r = hpt_random_bits(random);
    aim(0.4f + hpt_part(r, 0, 0.7f), 0.4f + hpt_part(r, 1, 0.7f), ray, triangle);
}

/* Through an edge or a vertex, in whole numbers. */
static void edge(hpt_random *random, float ray[6], float triangle[9]) {
    for (unsigned vertex = 0; vertex < 3; vertex++) hpt_draw_whole_point(random, triangle + 3 * vertex);
    hpt_draw_whole_point(random, ray);
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
            hpt_draw_plain_object(random, types[k], i & 1, words[k]);
        for (unsigned w = 0; w < n && i % 4 == 2; w++)
            if (hpt_is_length(types[k], w)) words[k][w] *= size;
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
