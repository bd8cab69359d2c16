/* Makes the golden vectors: make_vectors [DIRECTORY [PAIR...]], default vectors/ and all pairs. The same bytes on
 * every machine.
 *
 * Expected bits come from the scalar datapath, which is their definition. What they say is held against the exact
 * oracle before a file is written: a group that must be right fails the run on the first flag that is wrong outside
 * the band. */
#include <errno.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "host/import/vectors.h"
#include "testbench/reference/exact_ray_triangle.h"
#include "testbench/reference/judge.h"
#include "testbench/support/pair_cases.h"
#include "testbench/support/pair_extremes.h"
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
    union {
        hpt_ray_triangle_maker *ray_triangle;
        hpt_pair_maker *pair; /* in pair_sets */
    } make;
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
        {"subnormal word",                                                                                           \
         "each word in turn subnormal: where a board flushes or keeps its operands shows",                           \
         {hpt_subnormal_word_pair},                                                                                  \
         240,                                                                                                        \
         MEASURED},                                                                                                  \
            {"all subnormal",                                                                                        \
             "nothing but the direction is normal: differences of subnormals, products that vanish",                 \
             {hpt_tiny_pair},                                                                                        \
             140,                                                                                                    \
             MEASURED},                                                                                              \
            {"underflow",                                                                                            \
             "normal words whose products go below 2^-126: rounding there, and flushing of results",                 \
             {hpt_underflow_pair},                                                                                   \
             240,                                                                                                    \
             MEASURED},                                                                                              \
    }

/* Of ray-triangle, without the distance of a miss. */
static const set ray_triangle_sets[] = {
    {"random",
     HP_NUMERICS_ANY,
     {{"anywhere", "the everyday case: hits, misses and triangles behind the ray", {hpt_random_pair}, 500, RIGHT}}},
    {"edges-and-vertices",
     HP_NUMERICS_ANY,
     {{"vertices", "the set is closed: a ray through a vertex hits; exact in binary32", {hpt_vertex_pair}, 90, RIGHT},
      {"edges",
       "u = 0, v = 0 and u + v = det are hits, for either sign of det; exact in binary32",
       {hpt_edge_pair},
       120,
       RIGHT},
      {"start on the triangle",
       "t = 0 is a hit inside, on edges and on vertices; exact in binary32",
       {hpt_start_pair},
       90,
       RIGHT},
      {"behind", "t < 0 is a miss whatever u and v say; exact in binary32", {hpt_behind_pair}, 63, RIGHT},
      {"one bit off",
       "a wrong rounding or a comparison that is not closed shows beside the edge",
       {hpt_one_bit_off_pair},
       180,
       RIGHT}}},
    {"grazing",
     HP_NUMERICS_ANY,
     {{"close to touching", "the flag is decided by the last bits of u, v and t", {hpt_grazing_pair}, 400, RIGHT},
      {"slanting",
       "det is small beside its terms: cancellation in the cross products and in t",
       {hpt_slanting_pair},
       200,
       MEASURED}}},
    {"far-from-origin",
     HP_NUMERICS_ANY,
     {{"1e3 to 1e4 away",
       "coordinates lose bits before the pipe sees them; differences must lose no more",
       {hpt_offset_pair},
       250,
       RIGHT},
      {"1e5 to 1e6 away", "triangles of a few units in the last place", {hpt_far_offset_pair}, 150, RIGHT}}},
    {"slivers",
     HP_NUMERICS_ANY,
     {{"needles and caps",
       "1e3 to 1e5 times as long as wide: u and v are small differences",
       {hpt_sliver_pair},
       300,
       MEASURED}}},
    {"subnormals-gradual", HP_NUMERICS_GRADUAL, SUBNORMALS},
    {"subnormals-flush", HP_NUMERICS_FLUSH, SUBNORMALS},
    {"nan-and-infinity",
     HP_NUMERICS_ANY,
     {{"one word",
       "quiet and signalling NaN and infinity of both signs in each word: never a hit",
       {hpt_nonfinite_pair},
       480,
       MISSES},
      {"two words",
       "an infinity and a second odd word: none may cancel the other into a hit",
       {hpt_two_nonfinite_pair},
       420,
       MISSES}}},
    {"signed-zeros",
     HP_NUMERICS_ANY,
     {{"zeros of either sign",
       "-0 is 0: no comparison, no division and no output may tell them apart by mistake",
       {hpt_signed_zero_pair},
       256,
       RIGHT}}},
    {"det-zero",
     HP_NUMERICS_ANY,
     {{"parallel", "a ray parallel to the plane or in it misses", {hpt_parallel_pair}, 120, RIGHT},
      {"no area", "vertices on a line or equal: missed, also by a ray straight at them", {hpt_flat_pair}, 120, RIGHT},
      {"no direction", "a zero direction misses, also from a point of the triangle", {hpt_still_pair}, 60, RIGHT}}},
    {"overflow",
     HP_NUMERICS_ANY,
     {{"large words",
       "products and sums past the largest number: a miss, never a NaN or a false hit",
       {hpt_overflow_pair},
       200,
       MEASURED},
      {"long directions",
       "det overflows and t does not: t / inf = 0 must not look like a hit at the origin",
       {hpt_long_direction_pair},
       180,
       MEASURED},
      {"far hits",
       "short directions: T near the largest number is a hit, past it a miss",
       {hpt_far_hit_pair},
       200,
       MEASURED}}},
};

static void random_pair(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    hpt_draw_pair(random, pair, HPT_RANDOM, i, primary, secondary);
}
static void grazing_pair(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    hpt_draw_pair(random, pair, HPT_GRAZING, i, primary, secondary);
}
static void degenerate_pair(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    hpt_draw_pair(random, pair, HPT_DEGENERATE, i, primary, secondary);
}
static void offset_pair(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    hpt_draw_pair(random, pair, HPT_OFFSET, i, primary, secondary);
}

#define SMALL                                                                                                        \
    {                                                                                                                \
        {                                                                                                            \
            "small", "products underflow, words are subnormal: rounding and flushing there",                         \
                {.pair = hpt_small_pair}, 60, MEASURED                                                               \
        }                                                                                                            \
    }

/* Of every other pair, with the distance of a miss. */
static const set pair_sets[] = {
    {"random",
     HP_NUMERICS_ANY,
     {{"anywhere", "the everyday case: hits, shallow and deep, and misses", {.pair = random_pair}, 100, RIGHT}}},
    {"touching",
     HP_NUMERICS_ANY,
     {{"whole numbers",
       "sets are closed: faces, edges, vertices and surfaces that touch exactly are hits",
       {.pair = hpt_whole_pair},
       150,
       RIGHT}}},
    {"grazing",
     HP_NUMERICS_ANY,
     {{"close to touching", "the flag is decided by the last bits", {.pair = grazing_pair}, 100, RIGHT}}},
    {"far-from-origin",
     HP_NUMERICS_ANY,
     {{"1e3 to 1e4 away",
       "coordinates lose bits before the pipe sees them; differences must lose no more",
       {.pair = offset_pair},
       60,
       RIGHT}}},
    {"degenerate",
     HP_NUMERICS_ANY,
     {{"thin and parallel",
       "slivers, rods, plates, parallel axes and faces, sizes 1e-3 to 1e4 mixed",
       {.pair = degenerate_pair},
       120,
       MEASURED},
      {"flat",
       "no area, no radius, no extent: legal, and the segment, point or slab that they are",
       {.pair = hpt_flat_objects},
       100,
       RIGHT}}},
    {"subnormals-gradual", HP_NUMERICS_GRADUAL, SMALL},
    {"subnormals-flush", HP_NUMERICS_FLUSH, SMALL},
    {"refused-by-the-host",
     HP_NUMERICS_ANY,
     {{"NaN and infinity", "in each word: never a hit, never a distance", {.pair = hpt_nonfinite_word}, 120, MISSES},
      {"illegal objects",
       "no direction, no axis, a negative size, min > max: never a hit, never a distance",
       {.pair = hpt_illegal_object},
       24,
       MISSES}}},
};

/* One record: words and what a board makes of them. */
typedef struct record {
    float primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX];
    hp_result answer;
} record;

/* The file being made. */
typedef struct making {
    const set *set;
    hp_pair pair;
    hp_vectors vectors;
} making;

/* The answer's first six words are a vector's. */
_Static_assert(offsetof(hp_result, stencil) == 4 * HP_VECTOR_ANSWER_WORDS, "F, index, T, CP come first");

/* The datapath's answer. False: the file is for any board, and boards differ. */
static bool answer(const making *m, record *r) {
    uint32_t index = (uint32_t)m->vectors.count;
    bool separation = m->vectors.separation;
    hp_result flush = hp_pipe_test(m->pair, HP_FLUSH, separation, r->primary, r->secondary, index);
    hp_result gradual = hp_pipe_test(m->pair, HP_GRADUAL, separation, r->primary, r->secondary, index);
    r->answer = m->set->numerics == HP_NUMERICS_FLUSH ? flush : gradual;
    return m->set->numerics != HP_NUMERICS_ANY || memcmp(&flush, &gradual, sizeof flush) == 0;
}

static bool refuse(const making *m, const group *g, const char *what) {
    fprintf(stderr, "make_vectors: %s, %s, %s, record %zu: %s\n", hp_pair_name(m->pair), m->set->name, g->name,
            m->vectors.count, what);
    return false;
}

/* Whether the group keeps its claim; says so if not. */
static bool claim_holds(const making *m, const group *g, const record *r, hpt_tally *tally) {
    if (g->claim == MISSES) {
        tally->count++;
        return (r->answer.F == 0 && r->answer.T == INFINITY) || refuse(m, g, "a hit or a distance");
    }
    hpt_truth truth = hpt_truth_of(m->pair, r->primary, r->secondary);
    hpt_given given = {r->answer.F, r->answer.T, {r->answer.CP[0], r->answer.CP[1], r->answer.CP[2]}};
    hpt_verdict verdict = hpt_judge(m->pair, r->primary, r->secondary, &truth, m->vectors.separation, &given);
    hpt_tally_add(tally, &r->answer, &verdict);
    if (g->claim == MEASURED || verdict.right || verdict.within) return true;
    return refuse(m, g, r->answer.F ? "a wrong hit outside the band" : "a wrong miss outside the band");
}

static hp_status add(hp_vectors *vectors, const record *r, hp_fault *fault) {
    uint32_t primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX], words[HP_VECTOR_ANSWER_WORDS];
    memcpy(primary, r->primary, sizeof primary);
    memcpy(secondary, r->secondary, sizeof secondary);
    memcpy(words, &r->answer, sizeof words);
    return hp_vectors_add(vectors, primary, secondary, words, 0, fault);
}

static void describe(const group *g, const hpt_tally *tally, char *text, size_t room) {
    if (g->claim == MISSES)
        snprintf(text, room, "%u misses, by rule: the oracle takes finite, legal objects", tally->count);
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

static void make(const making *m, const group *g, hpt_random *random, unsigned i, record *r) {
    if (m->pair == HP_PAIR_RAY_TRIANGLE)
        g->make.ray_triangle(random, i, r->primary, r->secondary);
    else
        g->make.pair(random, m->pair, i, r->primary, r->secondary);
}

/* Draws record i of a group until both kinds of board agree on it, where they must. */
static bool draw_record(const making *m, const group *g, hpt_random *random, unsigned i, record *r) {
    enum { DRAWS_MOST = 100 };
    for (unsigned draws = 0; draws < DRAWS_MOST; draws++) {
        make(m, g, random, i, r);
        if (answer(m, r)) return true;
        if (m->pair == HP_PAIR_RAY_TRIANGLE) break;
    }
    return refuse(m, g, "gradual and flush differ");
}

static bool add_group(making *m, const group *g, hp_fault *fault) {
    char text[200];
    hpt_tally tally = {0};
    hpt_random random = sequence_of(g->name);
    if (hp_vectors_add_group(&m->vectors, g->name, g->why, NULL, fault) != HP_OK) return false;
    for (unsigned i = 0; i < g->count; i++) {
        record r;
        if (!draw_record(m, g, &random, i, &r) || !claim_holds(m, g, &r, &tally)) {
            hp_fault_set(fault, HP_ERROR_MISMATCH, "%s, %s: no file written", hp_pair_name(m->pair), m->set->name);
            return false;
        }
        if (add(&m->vectors, &r, fault) != HP_OK) return false;
    }
    describe(g, &tally, text, sizeof text);
    m->vectors.groups[m->vectors.group_count - 1].checked = strdup(text);
    return true;
}

/* The file's directory is made where it is missing. */
static bool write_file(const char *directory, const char *name, const hp_vectors *vectors, hp_fault *fault) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", directory, hp_pair_name(vectors->pair));
    mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/%s/%s.hex", directory, hp_pair_name(vectors->pair), name);
    FILE *file = fopen(path, "w");
    if (!file) {
        hp_fault_set(fault, HP_ERROR_IO, "%s: %s", path, strerror(errno));
        return false;
    }
    bool done = hp_vectors_write(vectors, file, fault) == HP_OK;
    return fclose(file) == 0 && done;
}

static bool make_set(hp_pair pair, const set *s, const char *directory, hp_fault *fault) {
    char generator[80], oracle[80];
    making m = {.set = s, .pair = pair};
    snprintf(generator, sizeof generator, "make_vectors %d, seed %d with each group's name", GENERATOR_VERSION, SEED);
    if (pair == HP_PAIR_RAY_TRIANGLE)
        snprintf(oracle, sizeof oracle, "exact_ray_triangle %d, rationals of GMP", HPT_EXACT_RAY_TRIANGLE_VERSION);
    else
        snprintf(oracle, sizeof oracle, "truth %d, certified in binary128", HPT_TRUTH_VERSION);
    if (hp_vectors_begin(&m.vectors, pair, s->numerics, generator, oracle, fault) != HP_OK) return false;
    m.vectors.separation = pair != HP_PAIR_RAY_TRIANGLE;
    bool done = true;
    for (const group *g = s->groups; done && g->name; g++) done = add_group(&m, g, fault);
    done = done && write_file(directory, s->name, &m.vectors, fault);
    for (size_t i = 0; done && i < m.vectors.group_count; i++)
        printf("%s: %s: %s: %s\n", hp_pair_name(pair), s->name, m.vectors.groups[i].name,
               m.vectors.groups[i].checked);
    hp_vectors_free(&m.vectors);
    return done;
}

static bool make_sets(hp_pair pair, const set *sets, size_t n, const char *directory, hp_fault *fault) {
    for (size_t i = 0; i < n; i++)
        if (!make_set(pair, &sets[i], directory, fault)) return false;
    return true;
}

/* Whether the pair is one of those to be made: all, when none is named. */
static bool wanted(hp_pair pair, char **names) {
    bool any = *names == NULL;
    for (; *names; names++) any |= strcmp(*names, hp_pair_name(pair)) == 0;
    return any;
}

#define COUNT(array) (sizeof(array) / sizeof *(array))

int main(int argc, char **argv) {
    const char *directory = argc > 1 ? argv[1] : "vectors";
    hp_fault fault = {0};
    bool done = true;
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    if (done && wanted(HP_PAIR_##NAME, argv + (argc > 1 ? 2 : 1)))                                                   \
        done = HP_PAIR_##NAME == HP_PAIR_RAY_TRIANGLE                                                                \
                   ? make_sets(HP_PAIR_##NAME, ray_triangle_sets, COUNT(ray_triangle_sets), directory, &fault)       \
                   : make_sets(HP_PAIR_##NAME, pair_sets, COUNT(pair_sets), directory, &fault);
#include <hitpipe/pairs.def>
#undef HP_PAIR
    if (!done) fprintf(stderr, "make_vectors: %s\n", fault.message);
    return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
