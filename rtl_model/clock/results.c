#include "results.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

enum {
    LANES_STEP = 16,         /* primaries of a thread begin at a multiple of this */
    SMALL_WORK = 512 * 1024, /* tests below which a second thread costs more than it saves */
    TILE = 64                /* secondaries of `all` at a time */
};

static hp_result miss(void) {
    return (hp_result){.F = 0, .index = HP_NO_INDEX, .T = INFINITY, .CP = {0, 0, 0}, .stencil = 1};
}

/* ---- closest and any: the wide pipes keep the winner, the scalar pipe answers for it ---- */

typedef struct slice {
    const hp_results_job *job;
    const hp_query *query;
    hp_best *best;
    unsigned from, to; /* primaries */
    pthread_t thread;
} slice;

static void *test_slice(void *context) {
    const slice *work = context;
    const hp_query *query = work->query;
    const hp_wide_pipe *pipe = work->job->pipe;
    bool flush = work->job->config->subnormals == HP_FLUSH;
    _Alignas(64) float prepared[HP_BLOCK * HP_PREPARED_MAX];
    for (uint32_t done = 0, n; done < query->count; done += n) {
        n = query->count - done < HP_BLOCK ? query->count - done : HP_BLOCK;
        const float *block = hp_ddr_object(work->job->ddr, query->secondary, (uint64_t)query->first + done);
        pipe->prepare(block, n, query->moved ? query->matrix : NULL, flush, prepared);
        (query->mode == HP_MODE_ANY ? pipe->any : pipe->closest)(&query->lanes, work->from, work->to, prepared, n,
                                                                 done, flush, work->best);
    }
    return NULL;
}

/* Ranges of primaries, one a thread; the caller's thread takes the first. A thread that cannot be had does not
 * matter: its range is done here. */
static void test_all(const hp_results_job *job, const hp_query *query, hp_best *best) {
    slice slices[HP_PACKET_PRIMARIES / LANES_STEP];
    unsigned steps = (query->active + LANES_STEP - 1) / LANES_STEP;
    unsigned threads = (uint64_t)query->count * query->active < SMALL_WORK ? 1 : job->threads;
    if (threads > steps) threads = steps;
    for (unsigned i = 0; i < threads; i++) {
        unsigned to = (i + 1) * steps / threads * LANES_STEP;
        slices[i] = (slice){.job = job,
                            .query = query,
                            .best = best,
                            .from = i * steps / threads * LANES_STEP,
                            .to = to < query->active ? to : query->active};
    }
    bool started[HP_PACKET_PRIMARIES / LANES_STEP] = {false};
    for (unsigned i = 1; i < threads; i++)
        started[i] = pthread_create(&slices[i].thread, NULL, test_slice, &slices[i]) == 0;
    for (unsigned i = 0; i < threads; i++)
        if (!started[i]) test_slice(&slices[i]);
    for (unsigned i = 1; i < threads; i++)
        if (started[i]) pthread_join(slices[i].thread, NULL);
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
    return hp_pipe_test(query->pair, subnormals, hp_query_primary(query, primary), secondary, index);
}

void hp_results_find(const hp_results_job *job, hp_query *query, uint32_t *hit) {
    if (query->mode == HP_MODE_ZIP) {
        for (unsigned i = 0; i < query->active; i++)
            query->results[i] = test_pair(job, query, i, hp_query_secondary(query, i, 0));
        return;
    }
    hp_best best;
    for (unsigned i = 0; i < HP_PACKET_PRIMARIES; i++) {
        best.T[i] = INFINITY;
        best.index[i] = HP_NO_INDEX;
    }
    if (query->active) test_all(job, query, &best);
    for (unsigned i = 0; i < query->active; i++) {
        bool found = best.index[i] != HP_NO_INDEX;
        query->results[i] = found ? test_pair(job, query, i, query->first + best.index[i]) : miss();
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
    r->job->pipe->pairs(hp_query_primary(query, primary), 0,
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
