/* Makes the golden vectors: make_vectors [DIRECTORY], default vectors/. The same bytes on every machine.
 *
 * Expected bits come from the scalar datapath, which is their definition. What they say is held against the exact
 * oracle before a file is written: a group that must be right fails the run on the first flag that is wrong outside
 * the band. */
#include <errno.h>
#include <hitpipe/pipe.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host/import/vectors.h"
#include "testbench/reference/exact_ray_triangle.h"
#include "testbench/reference/judge.h"
#include "testbench/support/ray_triangle_cases.h"

enum { GENERATOR_VERSION = 1, SEED = 1 };

/* What the oracle has to say about a group. */
typedef enum claim {
    RIGHT,    /* every flag is right or within the band */
    MEASURED, /* beyond what binary32 promises: what went wrong is counted and written down */
    MISSES    /* not for the oracle: all answers are misses, by rule */
} claim;

typedef struct group {
    const char *name, *why;
    hpt_ray_triangle_maker *make;
    unsigned count;
    claim claim;
} group;

typedef struct set {
    const char *name;
    hp_numerics numerics;
    group groups[6];
} set;

#define SUBNORMALS                                                                                                   \
    {                                                                                                                \
        {"subnormal word", "each word in turn subnormal: where a board flushes or keeps its operands shows",         \
         hpt_subnormal_word_pair, 240, MEASURED},                                                                    \
            {"all subnormal",                                                                                        \
             "nothing but the direction is normal: differences of subnormals, products that vanish", hpt_tiny_pair,  \
             140, MEASURED},                                                                                         \
            {"underflow", "normal words whose products go below 2^-126: rounding there, and flushing of results",    \
             hpt_underflow_pair, 240, MEASURED},                                                                     \
    }

static const set sets[] = {
    {"random",
     HP_NUMERICS_ANY,
     {{"anywhere", "the everyday case: hits, misses and triangles behind the ray", hpt_random_pair, 500, RIGHT}}},
    {"edges-and-vertices",
     HP_NUMERICS_ANY,
     {{"vertices", "the set is closed: a ray through a vertex hits; exact in binary32", hpt_vertex_pair, 90, RIGHT},
      {"edges", "u = 0, v = 0 and u + v = det are hits, for either sign of det; exact in binary32", hpt_edge_pair,
       120, RIGHT},
      {"start on the triangle", "t = 0 is a hit inside, on edges and on vertices; exact in binary32", hpt_start_pair,
       90, RIGHT},
      {"behind", "t < 0 is a miss whatever u and v say; exact in binary32", hpt_behind_pair, 63, RIGHT},
      {"one bit off", "a wrong rounding or a comparison that is not closed shows beside the edge",
       hpt_one_bit_off_pair, 180, RIGHT}}},
    {"grazing",
     HP_NUMERICS_ANY,
     {{"close to touching", "the flag is decided by the last bits of u, v and t", hpt_grazing_pair, 400, RIGHT},
      {"slanting", "det is small beside its terms: cancellation in the cross products and in t", hpt_slanting_pair,
       200, MEASURED}}},
    {"far-from-origin",
     HP_NUMERICS_ANY,
     {{"1e3 to 1e4 away", "coordinates lose bits before the pipe sees them; differences must lose no more",
       hpt_offset_pair, 250, RIGHT},
      {"1e5 to 1e6 away", "triangles of a few units in the last place", hpt_far_offset_pair, 150, RIGHT}}},
    {"slivers",
     HP_NUMERICS_ANY,
     {{"needles and caps", "1e3 to 1e5 times as long as wide: u and v are small differences", hpt_sliver_pair, 300,
       MEASURED}}},
    {"subnormals-gradual", HP_NUMERICS_GRADUAL, SUBNORMALS},
    {"subnormals-flush", HP_NUMERICS_FLUSH, SUBNORMALS},
    {"nan-and-infinity",
     HP_NUMERICS_ANY,
     {{"one word", "quiet and signalling NaN and infinity of both signs in each word: never a hit",
       hpt_nonfinite_pair, 480, MISSES},
      {"two words", "an infinity and a second odd word: none may cancel the other into a hit", hpt_two_nonfinite_pair,
       420, MISSES}}},
    {"signed-zeros",
     HP_NUMERICS_ANY,
     {{"zeros of either sign", "-0 is 0: no comparison, no division and no output may tell them apart by mistake",
       hpt_signed_zero_pair, 256, RIGHT}}},
    {"det-zero",
     HP_NUMERICS_ANY,
     {{"parallel", "a ray parallel to the plane or in it misses", hpt_parallel_pair, 120, RIGHT},
      {"no area", "vertices on a line or equal: missed, also by a ray straight at them", hpt_flat_pair, 120, RIGHT},
      {"no direction", "a zero direction misses, also from a point of the triangle", hpt_still_pair, 60, RIGHT}}},
    {"overflow",
     HP_NUMERICS_ANY,
     {{"large words", "products and sums past the largest number: a miss, never a NaN or a false hit",
       hpt_overflow_pair, 200, MEASURED},
      {"long directions", "det overflows and t does not: t / inf = 0 must not look like a hit at the origin",
       hpt_long_direction_pair, 180, MEASURED},
      {"far hits", "short directions: T near the largest number is a hit, past it a miss", hpt_far_hit_pair, 200,
       MEASURED}}},
};

/* One record: words and what both kinds of board make of them. */
typedef struct record {
    float ray[6], triangle[9];
    hp_result answer;
} record;

/* The answer's first six words are a vector's. */
_Static_assert(offsetof(hp_result, stencil) == 4 * HP_VECTOR_ANSWER_WORDS, "F, index, T, CP come first");

/* The datapath's answer. False: the file is for any board, and boards differ. */
static bool answer(hp_numerics numerics, uint32_t index, record *r) {
    hp_result flush = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_FLUSH, false, r->ray, r->triangle, index);
    hp_result gradual = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, r->ray, r->triangle, index);
    r->answer = numerics == HP_NUMERICS_FLUSH ? flush : gradual;
    return numerics != HP_NUMERICS_ANY || memcmp(&flush, &gradual, sizeof flush) == 0;
}

/* Whether the group keeps its claim; says so if not. */
static bool claim_holds(const set *s, const group *g, size_t index, const record *r, hpt_tally *tally) {
    if (g->claim == MISSES) {
        tally->count++;
        if (r->answer.F == 0) return true;
        fprintf(stderr, "make_vectors: %s, %s, record %zu: a hit\n", s->name, g->name, index);
        return false;
    }
    hpt_verdict verdict = hpt_judge_ray_triangle(r->ray, r->triangle, &r->answer);
    hpt_tally_add(tally, &r->answer, &verdict);
    if (g->claim == MEASURED || verdict.right || verdict.within) return true;
    fprintf(stderr, "make_vectors: %s, %s, record %zu: F = %u is wrong, %.3g bands from touching\n", s->name, g->name,
            index, (unsigned)r->answer.F, verdict.margin);
    return false;
}

static hp_status add(hp_vectors *vectors, const record *r, hp_fault *fault) {
    uint32_t ray[6], triangle[9], words[HP_VECTOR_ANSWER_WORDS];
    memcpy(ray, r->ray, sizeof ray);
    memcpy(triangle, r->triangle, sizeof triangle);
    memcpy(words, &r->answer, sizeof words);
    return hp_vectors_add(vectors, ray, triangle, words, 0, fault);
}

static void describe(const group *g, const hpt_tally *tally, char *text, size_t room) {
    if (g->claim == MISSES)
        snprintf(text, room, "%u misses, by rule: the exact oracle takes finite words", tally->count);
    else
        snprintf(text, room,
                 "%u, %u hits; wrong flags %u within the band, %u outside; worst error of T %.2e, of CP %.2e",
                 tally->count, tally->hits, tally->within, tally->outside, tally->worst_T, tally->worst_CP);
}

/* Each group has a sequence of its own, so that a change of one leaves the others as they are: FNV-1a of its name. */
static hpt_random sequence_of(const char *name) {
    uint64_t seed = 0xCBF29CE484222325u ^ SEED;
    for (; *name; name++) seed = (seed ^ (uint64_t)*name) * 0x100000001B3u;
    return hpt_random_seed(seed);
}

static bool add_group(const set *s, const group *g, hp_vectors *vectors, hp_fault *fault) {
    char text[200];
    hpt_tally tally = {0};
    hpt_random random = sequence_of(g->name);
    if (hp_vectors_add_group(vectors, g->name, g->why, NULL, fault) != HP_OK) return false;
    for (unsigned i = 0; i < g->count; i++) {
        record r;
        g->make(&random, i, r.ray, r.triangle);
        if (!answer(s->numerics, (uint32_t)vectors->count, &r)) {
            hp_fault_set(fault, HP_ERROR_MISMATCH, "%s, %s, record %zu: gradual and flush differ", s->name, g->name,
                         vectors->count);
            return false;
        }
        if (!claim_holds(s, g, vectors->count, &r, &tally)) {
            hp_fault_set(fault, HP_ERROR_MISMATCH, "%s: no file written", s->name);
            return false;
        }
        if (add(vectors, &r, fault) != HP_OK) return false;
    }
    describe(g, &tally, text, sizeof text);
    vectors->groups[vectors->group_count - 1].checked = strdup(text);
    return true;
}

static bool write_file(const char *directory, const char *name, const hp_vectors *vectors, hp_fault *fault) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s/%s.hex", directory, hp_pair_name(vectors->pair), name);
    FILE *file = fopen(path, "w");
    if (!file) {
        hp_fault_set(fault, HP_ERROR_IO, "%s: %s", path, strerror(errno));
        return false;
    }
    bool done = hp_vectors_write(vectors, file, fault) == HP_OK;
    return fclose(file) == 0 && done;
}

static bool make_set(const set *s, const char *directory, hp_fault *fault) {
    char generator[80], oracle[80];
    snprintf(generator, sizeof generator, "make_vectors %d, seed %d with each group's name", GENERATOR_VERSION, SEED);
    snprintf(oracle, sizeof oracle, "exact_ray_triangle %d, rationals of GMP", HPT_EXACT_RAY_TRIANGLE_VERSION);
    hp_vectors vectors;
    if (hp_vectors_begin(&vectors, HP_PAIR_RAY_TRIANGLE, s->numerics, generator, oracle, fault) != HP_OK)
        return false;
    bool done = true;
    for (const group *g = s->groups; done && g->name; g++) done = add_group(s, g, &vectors, fault);
    done = done && write_file(directory, s->name, &vectors, fault);
    if (done)
        for (size_t i = 0; i < vectors.group_count; i++)
            printf("%s: %s: %s\n", s->name, vectors.groups[i].name, vectors.groups[i].checked);
    hp_vectors_free(&vectors);
    return done;
}

int main(int argc, char **argv) {
    const char *directory = argc > 1 ? argv[1] : "vectors";
    hp_fault fault = {0};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++)
        if (!make_set(&sets[i], directory, &fault)) {
            fprintf(stderr, "make_vectors: %s\n", fault.message);
            return EXIT_FAILURE;
        }
    return EXIT_SUCCESS;
}
