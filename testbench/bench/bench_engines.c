/* What the whole path costs on top of its arithmetic: hp_query (driver, packets, board, quick engine, counters)
 * against the bare wide pipe on the same rays and triangles, two threads against one, and the clocked engine's clocks
 * a second.
 *
 * Rounds of all variants alternate, so that a change of the processor's clock meets all of them; medians and ratios.
 */
#include "rtl_model/pipes/wide.h"
#include <hitpipe/hitpipe.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { COLUMNS = 447, ROWS = 292, TRIANGLES = 2 * (COLUMNS - 1) * (ROWS - 1), RAYS = 256, ROUNDS = 9 };
enum { CLOCKED_TRIANGLES = 20000, CLOCKED_RAYS = 32 };

static float triangles[TRIANGLES][HP_TRIANGLE_WORDS], rays[RAYS][HP_RAY_WORDS];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void put_vertex(float *vertex, unsigned i, unsigned j) {
    float x = (float)j / COLUMNS, y = (float)i / ROWS;
    float v[3] = {x, y, 0.05f * sinf(20 * x) * cosf(17 * y) + 0.01f * sinf(150 * x * y)};
    memcpy(vertex, v, sizeof v);
}

static void make_scene(void) {
    float(*t)[HP_TRIANGLE_WORDS] = triangles;
    for (unsigned i = 0; i + 1 < ROWS; i++)
        for (unsigned j = 0; j + 1 < COLUMNS; j++, t += 2) {
            put_vertex(t[0], i, j), put_vertex(t[0] + 3, i, j + 1), put_vertex(t[0] + 6, i + 1, j);
            put_vertex(t[1], i, j + 1), put_vertex(t[1] + 3, i + 1, j + 1), put_vertex(t[1] + 6, i + 1, j);
        }
    for (unsigned i = 0; i < RAYS; i++) {
        float ray[HP_RAY_WORDS] = {0.5f, -0.2f, 0.6f, (float)(i % 16) / 20 - 0.4f, 0.5f + (float)(i / 16) / 20,
                                   -0.6f};
        memcpy(rays[i], ray, sizeof ray);
    }
}

/* ---- the bare datapath ---- */

static void test_bare(const hp_wide_pipe *pipe, bool flush) {
    hp_lanes lanes;
    hp_best best;
    _Alignas(64) float prepared[HP_BLOCK * HP_PREPARED_MAX];
    for (unsigned i = 0; i < RAYS; i++) {
        for (unsigned w = 0; w < HP_RAY_WORDS; w++) lanes.word[w][i] = rays[i][w];
        best.T[i] = INFINITY;
        best.index[i] = HP_NO_INDEX;
    }
    for (unsigned done = 0; done < TRIANGLES; done += HP_BLOCK) {
        unsigned n = TRIANGLES - done < HP_BLOCK ? TRIANGLES - done : HP_BLOCK;
        pipe->prepare(triangles[done], n, NULL, flush, prepared);
        pipe->closest(&lanes, 0, RAYS, prepared, n, done, flush, &best);
    }
}

/* ---- the whole path ---- */

static hp_device *open_device(const char *preset, bool clocked, unsigned threads, unsigned count) {
    hp_device_def def = hp_default_device_def();
    hp_device *device;
    hp_config_preset(&def.board, preset);
    def.clocked = clocked;
    def.threads = threads;
    if (hp_open(&def, &device) != HP_OK) abort();
    if (hp_upload(device, HP_TRIANGLE, triangles[0], count) != HP_OK) abort();
    return device;
}

static void query(hp_device *device, unsigned primaries) {
    static hp_result results[RAYS];
    hp_query_def def = hp_default_query_def();
    if (hp_query(device, &def, rays[0], primaries, results) != HP_OK) abort();
}

static uint64_t clocks_of(hp_device *device) {
    hp_counters counters;
    if (hp_read_counters(device, false, &counters) != HP_OK) abort();
    return counters.clocks_total;
}

/* ---- table ---- */

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *seconds) {
    qsort(seconds, ROUNDS, sizeof *seconds, by_value);
    return seconds[ROUNDS / 2];
}

static void print_row(const char *name, double *seconds, double bare) {
    double s = median(seconds), tests = (double)RAYS * TRIANGLES;
    printf("%-42s %9.2f ms %9.0f million tests/s %8.3f of bare\n", name, 1e3 * s, 1e-6 * tests / s, bare / s);
}

static void bench_quick(void) {
    static const struct {
        const char *name, *preset;
        unsigned threads;
    } rows[] = {{"quick, secondary-outer, 1 thread", "usb3", 1}, {"quick, primary-outer, 1 thread", "wscg2007", 1}};
    enum { COUNT = sizeof rows / sizeof rows[0] };
    hp_device *device[COUNT];
    double bare[ROUNDS], seconds[COUNT][ROUNDS];
    const hp_wide_pipe *pipe = hp_wide_pipe_of(hp_isa_choose(NULL), HP_PAIR_RAY_TRIANGLE);
    for (unsigned i = 0; i < COUNT; i++) device[i] = open_device(rows[i].preset, false, rows[i].threads, TRIANGLES);
    for (unsigned round = 0; round < ROUNDS; round++) {
        double start = now();
        test_bare(pipe, true);
        bare[round] = now() - start;
        for (unsigned i = 0; i < COUNT; i++) {
            start = now();
            query(device[i], RAYS);
            seconds[i][round] = now() - start;
        }
    }
    double base = median(bare);
    printf("%u rays, %u triangles, %s, medians of %d rounds\n", RAYS, TRIANGLES, hp_isa_choose(NULL), ROUNDS);
    print_row("bare datapath", bare, base);
    for (unsigned i = 0; i < COUNT; i++) {
        print_row(rows[i].name, seconds[i], base);
        hp_close(device[i]);
    }
}

enum { PACKETS = 6 };

static void *test_packets(void *pipe) {
    for (unsigned k = 0; k < PACKETS; k++) test_bare(pipe, true);
    return NULL;
}

/* The bare datapath twice, on two threads that share nothing: what the machine has to give. */
static void test_bare_twice(const hp_wide_pipe *pipe) {
    pthread_t other;
    if (pthread_create(&other, NULL, test_packets, (void *)pipe) != 0) abort();
    test_packets((void *)pipe);
    pthread_join(other, NULL);
}

/* Packets one after another, since a processor that was idle takes a while to join in. Two processors may be one
 * core's two threads, or be lent to somebody else: so the same is asked of two threads that have nothing to do with
 * each other. */
static void bench_threads(void) {
    hp_device *device[2];
    const hp_wide_pipe *pipe = hp_wide_pipe_of(hp_isa_choose(NULL), HP_PAIR_RAY_TRIANGLE);
    double ours[ROUNDS], machine[ROUNDS];
    for (unsigned i = 0; i < 2; i++) device[i] = open_device("usb3", false, i + 1, TRIANGLES);
    for (unsigned round = 0; round < ROUNDS; round++) {
        double seconds[2], start;
        for (unsigned i = 0; i < 2; i++) {
            start = now();
            for (unsigned k = 0; k < PACKETS; k++) query(device[i], RAYS);
            seconds[i] = now() - start;
        }
        ours[round] = seconds[0] / seconds[1];
        start = now();
        test_packets((void *)pipe);
        seconds[0] = now() - start;
        start = now();
        test_bare_twice(pipe);
        machine[round] = 2 * seconds[0] / (now() - start);
    }
    double our_median = median(ours), machine_median = median(machine);
    printf("2 threads against 1: %.2f times (best %.2f); two bare datapaths side by side: %.2f (best %.2f)\n",
           our_median, ours[ROUNDS - 1], machine_median, machine[ROUNDS - 1]);
    for (unsigned i = 0; i < 2; i++) hp_close(device[i]);
}

static void bench_clocked(const char *preset) {
    double seconds[ROUNDS], clocks = 0;
    hp_device *device = open_device(preset, true, 1, CLOCKED_TRIANGLES);
    for (unsigned round = 0; round < ROUNDS; round++) {
        uint64_t before = clocks_of(device);
        double start = now();
        query(device, CLOCKED_RAYS);
        clocks = (double)(clocks_of(device) - before);
        seconds[round] = now() - start;
    }
    printf("clocked, %-33s %9.2f million board clocks/s\n", preset, 1e-6 * clocks / median(seconds));
    hp_close(device);
}

int main(void) {
    make_scene();
    bench_quick();
    bench_threads();
    bench_clocked("usb3");
    bench_clocked("wscg2007");
    return 0;
}
