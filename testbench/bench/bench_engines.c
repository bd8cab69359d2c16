/* What the board costs on top of its arithmetic: the quick engine (packets, timing, counters and all) against the
 * bare wide pipe on the same rays and triangles, two threads against one, and the clocked engine's clocks a second.
 *
 * Rounds of all variants alternate, so that a change of the processor's clock meets all of them; medians and ratios.
 */
#include "rtl_model/pipes/wide.h"
#include <hitpipe/board.h>
#include <hitpipe/packet.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { COLUMNS = 447, ROWS = 292, TRIANGLES = 2 * (COLUMNS - 1) * (ROWS - 1), RAYS = 256, ROUNDS = 7, PART = 14000 };
enum { CLOCKED_TRIANGLES = 20000, CLOCKED_RAYS = 32 };

static float triangles[TRIANGLES][HP_TRIANGLE_WORDS], rays[RAYS][HP_RAY_WORDS];
static uint8_t packet[HP_PAYLOAD_MAX + HP_HEADER_BYTES + HP_CRC_BYTES];

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
    static hp_lanes lanes;
    static hp_best best;
    _Alignas(64) static float prepared[HP_BLOCK * HP_PREPARED_MAX];
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

/* ---- boards ---- */

typedef struct bench_board {
    hp_board *board;
    uint32_t sequence;
} bench_board;

/* Sends the payload that stands in `packet`, and lets time pass until nothing is under way. Returns the clock. */
static uint64_t exchange(bench_board *b, hp_opcode opcode, uint32_t length) {
    hp_header header = {.version = HP_PROTOCOL_VERSION, .opcode = (uint8_t)opcode, .length = length};
    header.sequence = b->sequence++;
    hp_board_send(b->board, packet, hp_packet_seal(packet, &header));
    for (;;) {
        hp_board_event event = hp_board_step(b->board);
        if (event.kind == HP_BOARD_IDLE) return event.clock;
    }
}

static void upload(bench_board *b, unsigned count) {
    uint8_t *payload = packet + HP_HEADER_BYTES;
    for (unsigned first = 0; first < count; first += PART) {
        unsigned n = count - first < PART ? count - first : PART;
        memset(payload, 0, HP_UPLOAD_FIXED);
        hp_put32(payload + HP_AT_UPLOAD_object, HP_TRIANGLE);
        hp_put32(payload + HP_AT_UPLOAD_first, first);
        hp_put32(payload + HP_AT_UPLOAD_count, n);
        memcpy(payload + HP_UPLOAD_FIXED, triangles[first], n * sizeof triangles[0]);
        exchange(b, HP_OPCODE_UPLOAD, HP_UPLOAD_FIXED + n * (uint32_t)sizeof triangles[0]);
    }
}

static bench_board open_board(const char *preset, hp_engine_kind engine, unsigned threads, unsigned count) {
    hp_board_def def = {.engine = engine, .threads = threads};
    bench_board b = {0};
    hp_config_preset(&def.config, preset);
    if (hp_board_create(&def, &b.board) != HP_OK) abort();
    memset(packet + HP_HEADER_BYTES, 0, HP_HELLO_FIXED);
    hp_put16(packet + HP_HEADER_BYTES + HP_AT_HELLO_version_min, HP_PROTOCOL_VERSION);
    hp_put16(packet + HP_HEADER_BYTES + HP_AT_HELLO_version_max, HP_PROTOCOL_VERSION);
    exchange(&b, HP_OPCODE_HELLO, HP_HELLO_FIXED);
    upload(&b, count);
    return b;
}

static uint64_t query(bench_board *b, unsigned count, unsigned primaries) {
    uint8_t *payload = packet + HP_HEADER_BYTES;
    memset(payload, 0, HP_QUERY_FIXED);
    hp_put32(payload + HP_AT_QUERY_pair, HP_PAIR_RAY_TRIANGLE);
    hp_put32(payload + HP_AT_QUERY_mode, HP_MODE_CLOSEST);
    hp_put32(payload + HP_AT_QUERY_count, count);
    hp_put32(payload + HP_AT_QUERY_primaries, primaries);
    for (unsigned i = 0; i < primaries; i++) payload[HP_AT_QUERY_stencil + i / 8] |= (uint8_t)(1u << i % 8);
    memcpy(payload + HP_QUERY_FIXED, rays, primaries * sizeof rays[0]);
    return exchange(b, HP_OPCODE_QUERY, HP_QUERY_FIXED + primaries * (uint32_t)sizeof rays[0]);
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
    } rows[] = {{"quick, secondary-outer, 1 thread", "usb3", 1},
                {"quick, primary-outer, 1 thread", "wscg2007", 1},
                {"quick, secondary-outer, 2 threads", "usb3", 2}};
    enum { COUNT = sizeof rows / sizeof rows[0] };
    bench_board boards[COUNT];
    double bare[ROUNDS], seconds[COUNT][ROUNDS];
    const hp_wide_pipe *pipe = hp_wide_pipe_of(hp_isa_choose(NULL), HP_PAIR_RAY_TRIANGLE);
    for (unsigned i = 0; i < COUNT; i++)
        boards[i] = open_board(rows[i].preset, HP_ENGINE_QUICK, rows[i].threads, TRIANGLES);
    for (unsigned round = 0; round < ROUNDS; round++) {
        double start = now();
        test_bare(pipe, true);
        bare[round] = now() - start;
        for (unsigned i = 0; i < COUNT; i++) {
            start = now();
            query(&boards[i], TRIANGLES, RAYS);
            seconds[i][round] = now() - start;
        }
    }
    double base = median(bare);
    printf("%u rays, %u triangles, %s\n", RAYS, TRIANGLES, hp_isa_choose(NULL));
    print_row("bare datapath", bare, base);
    for (unsigned i = 0; i < COUNT; i++) {
        print_row(rows[i].name, seconds[i], base);
        hp_board_destroy(boards[i].board);
    }
}

static void bench_clocked(const char *preset) {
    double seconds[ROUNDS], clocks = 0;
    bench_board b = open_board(preset, HP_ENGINE_CLOCKED, 1, CLOCKED_TRIANGLES);
    for (unsigned round = 0; round < ROUNDS; round++) {
        uint64_t before = hp_board_counters(b.board).clocks_total;
        double start = now();
        query(&b, CLOCKED_TRIANGLES, CLOCKED_RAYS);
        seconds[round] = now() - start;
        clocks = (double)(hp_board_counters(b.board).clocks_total - before);
    }
    printf("clocked, %-33s %9.2f million board clocks/s\n", preset, 1e-6 * clocks / median(seconds));
    hp_board_destroy(b.board);
}

int main(void) {
    make_scene();
    bench_quick();
    bench_clocked("usb3");
    bench_clocked("wscg2007");
    return 0;
}
