/* Million pairs a second: each function of each library, and hitpipe's wide lanes, over the same scene on one core in
 * one run. Hitpipe runs twice: in mode closest, where a pair that cannot be the deepest is left as soon as that
 * shows, and in mode all, where every pair gets its F, T and CP.
 *
 * A round gives every contender one turn, so that a neighbour or a changing clock meets all of them; a turn goes on
 * through the scene until TURN seconds are over. Before that each has gone through it once, so that caches are warm.
 * Time is processor time. Medians over the rounds. */
#include "rtl_model/pipes/wide.h"
#include "testbench/peers/peers.h"
#include "testbench/peers/scene.h"

#include <hitpipe/pipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Secondaries are made in PORTIONS: some functions would take seconds for all. */
enum { ROUNDS_MAX = 99, ROWS_MAX = 32, PAIRS_MAX = 32, PORTIONS = 8, PORTION = SCENE_SECONDARIES / PORTIONS };
static const double TURN = 0.01;

typedef struct contender {
    const peer *peer; /* NULL: hitpipe in the mode of its row */
    void *primaries, *secondaries[PORTIONS];
    unsigned next; /* portion */
    size_t hits;
    double rate[ROUNDS_MAX]; /* pairs a second; sorted in the end */
    double median;
} contender;

typedef struct race {
    scene scene;
    hp_lanes lanes;
    hp_best best;
    const hp_wide_pipe *pipe;
    contender row[ROWS_MAX];
    unsigned n;
} race;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

enum { CLOSEST, ALL, HITPIPES }; /* rows of hitpipe; peers follow */

static void run_closest(race *r) {
    static _Alignas(64) float prepared[HP_BLOCK * HP_PREPARED_MAX];
    _Static_assert((int)SCENE_SECONDARIES <= (int)HP_BLOCK, "one block");
    r->pipe->prepare(r->scene.secondaries, SCENE_SECONDARIES, NULL, false, prepared);
    hp_best_begin(&r->best, r->scene.pair, false);
    r->pipe->closest(&r->lanes, 0, SCENE_PRIMARIES, prepared, SCENE_SECONDARIES, 0, false, &r->best);
}

static void run_all(race *r) {
    static uint32_t F[SCENE_SECONDARIES];
    static float T[SCENE_SECONDARIES], CP[3][SCENE_SECONDARIES];
    const hp_pairs_out out = {F, T, {CP[0], CP[1], CP[2]}};
    unsigned words = hp_object_words(hp_pair_primary(r->scene.pair));
    for (unsigned i = 0; i < SCENE_PRIMARIES; i++)
        r->pipe->pairs(r->scene.primaries + i * words, 0, r->scene.secondaries, SCENE_SECONDARIES, NULL, false, &out);
}

/* How many pairs, and how many of them hit. */
static size_t run_portion(race *r, contender *c, size_t *hits) {
    if (!c->peer) {
        c == &r->row[CLOSEST] ? run_closest(r) : run_all(r);
        return SCENE_PRIMARIES * SCENE_SECONDARIES;
    }
    *hits += c->peer->all(c->primaries, SCENE_PRIMARIES, c->secondaries[c->next], PORTION);
    c->next = (c->next + 1) % PORTIONS;
    return SCENE_PRIMARIES * PORTION;
}

static double take_turn(race *r, contender *c) {
    double begin = now(), seconds;
    size_t pairs = 0, hits = 0;
    do {
        pairs += run_portion(r, c, &hits);
        seconds = now() - begin;
    } while (seconds < TURN);
    return (double)pairs / seconds;
}

static void warm_up(race *r, contender *c) {
    for (unsigned i = 0; i < PORTIONS; i++) run_portion(r, c, &c->hits);
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void add_peer(const peer *p, void *context) {
    race *r = context;
    if (r->n == ROWS_MAX) abort();
    contender *c = &r->row[r->n++];
    *c = (contender){.peer = p, .primaries = p->make_primaries(r->scene.primaries, SCENE_PRIMARIES)};
    unsigned words = hp_object_words(hp_pair_secondary(r->scene.pair));
    for (size_t i = 0; i < PORTIONS; i++)
        c->secondaries[i] = p->make_secondaries(r->scene.secondaries + i * PORTION * words, PORTION);
}

static void free_objects(contender *c) {
    if (!c->peer) return;
    c->peer->free_primaries(c->primaries);
    for (unsigned i = 0; i < PORTIONS; i++) c->peer->free_secondaries(c->secondaries[i]);
}

static void load_lanes(race *r) {
    unsigned words = hp_object_words(hp_pair_primary(r->scene.pair));
    for (unsigned i = 0; i < SCENE_PRIMARIES; i++)
        for (unsigned w = 0; w < words; w++) r->lanes.word[w][i] = r->scene.primaries[i * words + w];
}

static void run_race(race *r, hp_pair pair, unsigned rounds) {
    r->n = 0;
    scene_make(&r->scene, pair);
    load_lanes(r);
    r->pipe = hp_wide_pipe_of(hp_isa_choose(NULL), pair);
    while (r->n < HITPIPES) r->row[r->n++] = (contender){.hits = r->scene.hits};
    peers_of(pair, add_peer, r);
    for (unsigned i = 0; i < r->n; i++) warm_up(r, &r->row[i]);
    for (unsigned round = 0; round < rounds; round++)
        for (unsigned i = 0; i < r->n; i++) r->row[i].rate[round] = take_turn(r, &r->row[i]);
    for (unsigned i = 0; i < r->n; i++) {
        contender *c = &r->row[i];
        qsort(c->rate, rounds, sizeof *c->rate, by_value);
        c->median = c->rate[rounds / 2];
        free_objects(c);
    }
}

static double percent_of_hits(size_t hits) {
    return 100.0 * (double)hits / (SCENE_PRIMARIES * SCENE_SECONDARIES);
}

static const contender *fastest_peer(const race *r) {
    const contender *best = NULL;
    for (unsigned i = HITPIPES; i < r->n; i++)
        if (!best || r->row[i].median > best->median) best = &r->row[i];
    return best;
}

static void print_summary(const race *races, unsigned n) {
    printf("| pair | hits %% | closest, million pairs/s | all, million pairs/s | fastest peer | million pairs/s | "
           "closest / peer | all / peer |\n|---|--:|--:|--:|---|--:|--:|--:|\n");
    for (const race *r = races; r < races + n; r++) {
        const contender *best = fastest_peer(r);
        double closest = r->row[CLOSEST].median, all = r->row[ALL].median;
        printf("| %s | %.0f | %.1f | %.1f |", hp_pair_name(r->scene.pair), percent_of_hits(r->scene.hits),
               1e-6 * closest, 1e-6 * all);
        if (best)
            printf(" %s, %s | %.2f | %.1f | %.1f |\n", best->peer->library, best->peer->function, 1e-6 * best->median,
                   closest / best->median, all / best->median);
        else
            printf(" none | | | |\n");
    }
}

static void print_rows(const race *races, unsigned n) {
    printf("\n| pair | library | function | answers | hits %% | million pairs/s | closest / peer |\n"
           "|---|---|---|---|--:|--:|--:|\n");
    for (const race *r = races; r < races + n; r++)
        for (unsigned i = HITPIPES; i < r->n; i++) {
            const contender *c = &r->row[i];
            const char *T = c->peer->depth ? (c->peer->distance ? "F, T, distance" : "F, T")
                                           : (c->peer->distance ? "F, distance" : "F");
            printf("| %s | %s | %s | %s%s%s | %.1f | %.2f | %.1f |\n", hp_pair_name(r->scene.pair), c->peer->library,
                   c->peer->function, T, *c->peer->answers ? "; " : "", c->peer->answers, percent_of_hits(c->hits),
                   1e-6 * c->median, r->row[CLOSEST].median / c->median);
        }
}

void peers_print_speed(const hp_pair *pairs, unsigned n, unsigned rounds) {
    race *races = aligned_alloc(64, PAIRS_MAX * sizeof *races);
    if (!races || n > PAIRS_MAX || rounds > ROUNDS_MAX) abort();
    for (unsigned i = 0; i < n; i++) run_race(&races[i], pairs[i], rounds);
    printf("hitpipe: %s, preparing included; %d primaries x %d secondaries, one core, medians of %u "
           "rounds\n\n",
           hp_isa_choose(NULL), SCENE_PRIMARIES, SCENE_SECONDARIES, rounds);
    print_summary(races, n);
    print_rows(races, n);
    free(races);
}
