#include "results.h"
#include "rtl_model/update/update.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

enum {
    LANES_STEP = 16,         /* primaries of a thread begin at a multiple of this */
    SMALL_WORK = 512 * 1024, /* tests below which a second thread costs more than it saves */
    THREADS_MAX = 64,
    PORTION = 8 * HP_BLOCK, /* secondaries a thread takes at a time */
    TILE = 64               /* secondaries at a time where they lie in the lanes */
};

/* Without the distance of a miss, no miss is nearer than another. */
static bool looks_for_nearest(const hp_query *query) {
    return query->nearest && query->separation;
}

static hp_result miss(void) {
    return (hp_result){.F = 0, .index = HP_NO_INDEX, .T = INFINITY, .CP = {0, 0, 0}, .stencil = 1};
}

/* ---- closest and any: the wide pipes keep the winner, the scalar pipe answers for it ---- */

/* What a thread tests: primaries [from, to) against portions of the query's secondaries. `next` is the first
 * secondary that no thread has taken yet: a thread that starts late, or whose processor is lent to somebody else,
 * takes fewer. */
typedef struct slice {
    const hp_results_job *job;
    const hp_query *query;
    unsigned from, to;
    atomic_uint_fast64_t *next, all; /* `all` stands in for `next` where a thread has all secondaries to itself */
    hp_best *best;
    pthread_t thread;
    bool started;
} slice;

/* Takes the next portion: *first and *count. False when there is none. Within a thread, portions ascend. */
static bool take_portion(slice *work, uint32_t *first, uint32_t *count) {
    uint64_t from = atomic_fetch_add(work->next, PORTION), all = work->query->count;
    if (from >= all) return false;
    *first = (uint32_t)from;
    *count = (uint32_t)(all - from < PORTION ? all - from : PORTION);
    return true;
}

static const float *secondary_block(const slice *work, uint32_t k) {
    return hp_ddr_object(work->job->ddr, work->query->secondary, (uint64_t)work->query->first + k);
}

/* What mode closest has kept for a primary so far. */
static hp_result kept_of(const hp_query *query, const hp_best *best, unsigned i) {
    bool found = best->index[i] != HP_NO_INDEX;
    return (hp_result){.F = looks_for_nearest(query) ? best->F[i] : found, .T = found ? best->T[i] : INFINITY};
}

typedef void pairs_function(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,
                            const float *matrix, bool flush, const hp_pairs_out *out);

static pairs_function *pairs_kernel(const hp_results_job *job, const hp_query *query) {
    bool shows = hp_query_records_tests(query) || looks_for_nearest(query);
    return query->separation && shows ? job->pipe->distances : job->pipe->pairs;
}

typedef void keeping_function(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,
                              uint32_t index, bool flush, hp_best *best);

static keeping_function *keeping_kernel(const hp_results_job *job, const hp_query *query) {
    if (query->mode == HP_MODE_ANY) return job->pipe->any;
    return looks_for_nearest(query) ? job->pipe->nearest : job->pipe->closest;
}

/* A primary alone would leave most lanes empty: here the lanes are secondaries. Returns whether it looks for more. */
static bool test_one(const slice *work, uint32_t first, uint32_t count) {
    const hp_query *query = work->query;
    uint32_t F[TILE];
    float T[TILE], CP[3][TILE];
    hp_pairs_out out = {F, T, {CP[0], CP[1], CP[2]}};
    uint32_t end = first + count;
    for (uint32_t k = first, n; k < end; k += n) {
        n = end - k < TILE ? end - k : TILE;
        pairs_kernel(work->job, query)(hp_query_primary(query, work->from), 0, secondary_block(work, k), n,
                                       query->moved ? query->matrix : NULL, work->job->config->subnormals == HP_FLUSH,
                                       &out);
        for (uint32_t i = 0; i < n; i++) {
            hp_result found = {.F = F[i], .T = T[i]}, kept = kept_of(query, work->best, work->from);
            if (!hp_closer(query, &found, &kept)) continue;
            work->best->T[work->from] = T[i];
            work->best->index[work->from] = k + i;
            work->best->F[work->from] = F[i];
            if (query->mode == HP_MODE_ANY) return false;
        }
    }
    return true;
}

static void test_blocks(const slice *work, uint32_t first, uint32_t count) {
    const hp_query *query = work->query;
    const hp_wide_pipe *pipe = work->job->pipe;
    bool flush = work->job->config->subnormals == HP_FLUSH;
    _Alignas(64) float prepared[HP_BLOCK * HP_PREPARED_MAX];
    uint32_t end = first + count;
    for (uint32_t k = first, n; k < end; k += n) {
        n = end - k < HP_BLOCK ? end - k : HP_BLOCK;
        pipe->prepare(secondary_block(work, k), n, query->moved ? query->matrix : NULL, flush, prepared);
        keeping_kernel(work->job, query)(&query->lanes, work->from, work->to, prepared, n, k, flush, work->best);
    }
}

static void *test_slice(void *context) {
    slice *work = context;
    uint32_t first, count;
    while (take_portion(work, &first, &count)) {
        if (work->to - work->from > 1)
            test_blocks(work, first, count);
        else if (!test_one(work, first, count))
            break;
    }
    return NULL;
}

/* The part of a thread. closest: all primaries, and portions of secondaries, so that each is prepared once; any: a
 * range of primaries and all secondaries, so that none is tested further than to its first hit. */
static slice slice_of(const hp_results_job *job, const hp_query *query, unsigned i, unsigned threads) {
    slice s = {.job = job, .query = query, .to = query->active};
    if (query->mode != HP_MODE_ANY) return s;
    unsigned steps = (query->active + LANES_STEP - 1) / LANES_STEP, to = (i + 1) * steps / threads * LANES_STEP;
    s.from = i * steps / threads * LANES_STEP;
    s.to = to < query->active ? to : query->active;
    return s;
}

/* The closer of what two threads found, of equals the one of lower index. */
static void merge(const hp_query *query, hp_best *best, const hp_best *other) {
    for (unsigned i = 0; i < query->active; i++) {
        hp_result mine = kept_of(query, best, i), theirs = kept_of(query, other, i);
        bool closer = hp_closer(query, &theirs, &mine);
        bool equal = !closer && !hp_closer(query, &mine, &theirs) && other->index[i] < best->index[i];
        if (!closer && !equal) continue;
        best->T[i] = other->T[i];
        best->index[i] = other->index[i];
        best->F[i] = other->F[i];
    }
}

static unsigned threads_for(const hp_results_job *job, const hp_query *query) {
    unsigned most = query->mode == HP_MODE_ANY ? (query->active + LANES_STEP - 1) / LANES_STEP : THREADS_MAX;
    unsigned threads = (uint64_t)query->count * query->active < SMALL_WORK ? 1 : job->threads;
    return threads < most ? threads : most;
}

/* The caller's thread takes the first part. A thread that cannot be had does not matter: its part is done here. */
static void test_all(const hp_results_job *job, const hp_query *query, hp_best *best) {
    hp_best bests[THREADS_MAX];
    slice slices[THREADS_MAX];
    unsigned threads = threads_for(job, query);
    atomic_uint_fast64_t next = 0;
    bool apart = query->mode == HP_MODE_ANY; /* primaries apart: one hp_best serves all */
    for (unsigned i = 0; i < threads; i++) {
        if (i == 0 || !apart) hp_best_begin(&bests[i], query->pair, looks_for_nearest(query));
        slices[i] = slice_of(job, query, i, threads);
        slices[i].best = &bests[apart ? 0 : i];
        slices[i].next = apart ? &slices[i].all : &next;
    }
    for (unsigned i = 1; i < threads; i++)
        slices[i].started = pthread_create(&slices[i].thread, NULL, test_slice, &slices[i]) == 0;
    for (unsigned i = 0; i < threads; i++)
        if (!slices[i].started) test_slice(&slices[i]);
    for (unsigned i = 1; i < threads; i++)
        if (slices[i].started) pthread_join(slices[i].thread, NULL);
    *best = bests[0];
    for (unsigned i = 1; i < threads && !apart; i++) merge(query, best, &bests[i]);
}

/* The whole record of a pair, by the scalar pipe. */
static hp_result test_pair(const hp_results_job *job, const hp_query *query, unsigned primary, uint32_t index) {
    hp_subnormals subnormals = (hp_subnormals)job->config->subnormals;
    const float *secondary = hp_ddr_object(job->ddr, query->secondary, index);
    float moved[HP_OBJECT_WORDS_MAX];
    if (query->moved) {
        hp_transform_object(query->secondary, subnormals, query->matrix, secondary, moved);
        secondary = moved;
    }
    return hp_pipe_test(query->pair, subnormals, query->separation, hp_query_primary(query, primary), secondary,
                        index);
}

void hp_results_find(const hp_results_job *job, hp_query *query, uint32_t *hit) {
    if (query->mode == HP_MODE_ZIP) {
        for (unsigned i = 0; i < query->active; i++)
            query->results[i] = test_pair(job, query, i, hp_query_secondary(query, i, 0));
        return;
    }
    hp_best best;
    if (query->active) test_all(job, query, &best);
    for (unsigned i = 0; i < query->active; i++) {
        bool found = best.index[i] != HP_NO_INDEX;
        query->results[i] = found ? test_pair(job, query, i, query->first + best.index[i]) : miss();
        if (found) query->results[i].index = query->first + best.index[i];
        if (hit) hit[i] = best.index[i];
        if (hit && found) query->results[i].stencil = 0;
    }
}

/* ---- all: a record for each pair, those of a range ---- */

typedef struct range {
    const hp_results_job *job;
    const hp_query *query;
    uint64_t first, end;
    void (*take)(void *context, uint64_t number, const hp_result *record);
    void *context;
} range;

/* Records of one primary with n secondaries from k on. Record number of the first; the others `step` apart. */
static void take_primary(const range *r, unsigned primary, uint32_t k, uint32_t n, uint64_t number, unsigned step) {
    uint32_t F[TILE];
    float T[TILE], CP[3][TILE];
    const hp_query *query = r->query;
    hp_pairs_out out = {F, T, {CP[0], CP[1], CP[2]}};
    pairs_kernel(r->job, query)(hp_query_primary(query, primary), 0,
                                hp_ddr_object(r->job->ddr, query->secondary, (uint64_t)query->first + k), n,
                                query->moved ? query->matrix : NULL, r->job->config->subnormals == HP_FLUSH, &out);
    for (uint32_t i = 0; i < n; i++, number += step) {
        if (number < r->first || number >= r->end) continue;
        hp_result record = {F[i], F[i] ? query->first + k + i : HP_NO_INDEX, T[i], {CP[0][i], CP[1][i], CP[2][i]}, 1};
        r->take(r->context, number, &record);
    }
}

/* A group's records: for each secondary one of each of its primaries. */
static void take_group(const range *r, unsigned from, unsigned primaries, uint64_t base) {
    uint64_t begin = r->first > base ? (r->first - base) / primaries : 0;
    uint64_t end = (r->end - base + primaries - 1) / primaries;
    if (end > r->query->count) end = r->query->count;
    for (uint64_t k = begin; k < end; k += TILE) {
        uint32_t n = end - k < TILE ? (uint32_t)(end - k) : TILE;
        for (unsigned lane = 0; lane < primaries; lane++)
            take_primary(r, from + lane, (uint32_t)k, n, base + k * primaries + lane, primaries);
    }
}

void hp_results_range(const hp_results_job *job, const hp_query *query, uint64_t first, uint32_t count,
                      void (*take)(void *context, uint64_t number, const hp_result *record), void *context) {
    range r = {job, query, first, first + count, take, context};
    bool together = job->config->loop_order == HP_SECONDARY_OUTER;
    unsigned most = together ? query->active : (unsigned)job->config->lanes;
    for (unsigned from = 0; from < query->active; from += most) {
        unsigned primaries = query->active - from < most ? query->active - from : most;
        uint64_t base = (uint64_t)from * query->count, end = base + (uint64_t)primaries * query->count;
        if (base < r.end && end > first) take_group(&r, from, primaries, base);
    }
}
