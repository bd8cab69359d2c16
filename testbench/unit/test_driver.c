/* The driver over a link with faults: every call completes with the bits of a link without, or ends in an error that
 * names the cause; no record is lost, none comes twice. Each test runs against the simulated board and against a
 * board that was built from docs/protocol.md alone. */
#include "driver/device.h"
#include "testbench/support/faulty_transport.h"
#include "testbench/support/random.h"
#include "testbench/support/stranger.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { RAYS = 30, TRIANGLES = 20, PACKET = 8, BUFFERS = 3, LANES = 3, RECORDS = 7 };

/* What happens to which packets. */
typedef struct plan {
    fault_kind kind;
    unsigned argument;
    bool in;
    unsigned from, to; /* numbers of the packets it happens to: from <= number < to */
    unsigned rate;     /* or to one in so many, in both directions, at random; 0: not */
    hpt_random random;
    unsigned seen[2];
    unsigned faults;
    unsigned queries_ahead, queries_under_way; /* most QUERY packets sent before the RESULT of the first */
} plan;

static void watch_window(plan *now, bool in, const uint8_t *bytes) {
    if (!in && bytes[HP_AT_HEADER_opcode] == HP_OPCODE_QUERY) now->queries_under_way++;
    if (in && bytes[HP_AT_HEADER_opcode] == HP_OPCODE_RESULT && bytes[HP_AT_HEADER_flags] & HP_FLAG_LAST)
        now->queries_under_way--;
    if (now->queries_under_way > now->queries_ahead) now->queries_ahead = now->queries_under_way;
}

static fault choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    plan *now = context;
    (void)n;
    watch_window(now, in, bytes);
    now->seen[in] = number + 1;
    if (now->rate && (unsigned)hpt_random_below(&now->random, now->rate) == 0) {
        now->faults++;
        return (fault){(fault_kind)(1 + (unsigned)hpt_random_below(&now->random, FAULT_DISCONNECT - 1)),
                       (unsigned)hpt_random_below(&now->random, 200)};
    }
    if (in != now->in || number < now->from || number >= now->to) return (fault){FAULT_NONE, 0};
    now->faults++;
    return (fault){now->kind, now->argument};
}

typedef struct bench {
    bool stranger;
    bool secondary_outer;
    unsigned records; /* most in a RESULT */
    unsigned buffers;
    plan plan;
    hp_transport *board;
    hp_device *device;
    hp_message message;
    float rays[RAYS][6], triangles[TRIANGLES][9];
    hp_result truth[RAYS][TRIANGLES];
} bench;

/* ---- set-up ---- */

static hp_status open_board(bench *b, hp_transport **board) {
    if (b->stranger)
        return stranger_open(&(stranger_def){PACKET, b->buffers, LANES, b->records, b->secondary_outer}, board);
    hp_board_def def = {.isa = "plain", .threads = 1};
    hp_config_preset(&def.config, "ideal");
    def.config.packet_primaries = PACKET;
    def.config.packet_buffers = b->buffers;
    def.config.lanes = LANES;
    def.config.packet_results = b->records;
    def.config.loop_order = b->secondary_outer;
    return hp_transport_model(&def, board);
}

static hp_device_def patient(unsigned retries) {
    hp_device_def def = hp_default_device_def();
    def.retries = retries;
    return def;
}

static hp_status connect_with(bench *b, const hp_device_def *def) {
    hp_transport *link;
    assert_int_equal(open_board(b, &b->board), HP_OK);
    assert_int_equal(faulty_transport(b->board, choose, &b->plan, &link), HP_OK);
    b->plan.seen[0] = b->plan.seen[1] = b->plan.faults = 0;
    return hp_open_transport(def, link, &b->device, &b->message);
}

static hp_status connect(bench *b) {
    hp_device_def def = patient(3);
    return connect_with(b, &def);
}

static void disconnect(bench *b) {
    hp_close(b->device);
    b->device = NULL;
}

static hp_status upload(bench *b) {
    return hp_upload(b->device, HP_TRIANGLE, b->triangles[0], TRIANGLES);
}

static void connect_and_upload(bench *b) {
    b->plan = (plan){0};
    assert_int_equal(connect(b), HP_OK);
    assert_int_equal(upload(b), HP_OK);
}

/* Lets the fault happen to `count` packets of a direction from now on. */
static void plan_fault(bench *b, fault_kind kind, unsigned argument, bool in, unsigned skip, unsigned count) {
    b->plan.kind = kind;
    b->plan.argument = argument;
    b->plan.in = in;
    b->plan.from = b->plan.seen[in] + skip;
    b->plan.to = b->plan.from + count;
    b->plan.faults = 0;
}

static int make_bench(void **state, bool stranger) {
    bench *b = calloc(1, sizeof *b);
    hpt_random random = hpt_random_seed(7);
    if (!b) return -1;
    b->stranger = stranger;
    b->records = RECORDS;
    b->buffers = BUFFERS;
    for (unsigned i = 0; i < RAYS; i++)
        for (unsigned k = 0; k < 6; k++) b->rays[i][k] = (float)hpt_random_below(&random, 2001) / 1000 - 1;
    for (unsigned i = 0; i < TRIANGLES; i++)
        for (unsigned k = 0; k < 9; k++) b->triangles[i][k] = (float)hpt_random_below(&random, 4001) / 1000 - 2;
    for (unsigned i = 0; i < RAYS; i++)
        for (unsigned k = 0; k < TRIANGLES; k++)
            b->truth[i][k] = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, b->rays[i], b->triangles[k], k);
    *state = b;
    return 0;
}

static int with_model(void **state) {
    return make_bench(state, false);
}
static int with_stranger(void **state) {
    return make_bench(state, true);
}

static int tear_down(void **state) {
    bench *b = *state;
    disconnect(b);
    free(b);
    return 0;
}

/* ---- the truth ---- */

static hp_result truly_closest(const bench *b, unsigned ray) {
    hp_result best = {.index = HP_NO_INDEX, .T = INFINITY, .stencil = 1};
    for (unsigned k = 0; k < TRIANGLES; k++)
        if (b->truth[ray][k].F && (!best.F || b->truth[ray][k].T < best.T)) best = b->truth[ray][k];
    return best;
}

static void check_closest(const bench *b, const hp_result *results, unsigned first, unsigned end) {
    for (unsigned i = first; i < end; i++) {
        hp_result truth = truly_closest(b, i);
        assert_memory_equal(&results[i], &truth, sizeof truth);
    }
}

static hp_status ask_closest(bench *b, hp_result *results) {
    hp_query_def def = hp_default_query_def();
    memset(results, 0xEE, RAYS * sizeof *results);
    return hp_query(b->device, &def, b->rays[0], RAYS, results);
}

typedef struct tally {
    const bench *b;
    unsigned times[RAYS][TRIANGLES];
    unsigned last_primary, total;
} tally;

static bool count_records(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                          size_t count) {
    tally *seen = context;
    for (size_t i = 0; i < count; i++) {
        assert_true(primary[i] < RAYS && secondary[i] < TRIANGLES);
        assert_memory_equal(&records[i], &seen->b->truth[primary[i]][secondary[i]], sizeof *records);
        assert_true(primary[i] / PACKET >= seen->last_primary / PACKET); /* packet by packet */
        seen->last_primary = primary[i];
        seen->times[primary[i]][secondary[i]]++;
        seen->total++;
    }
    return true;
}

static hp_status ask_all(bench *b, tally *seen) {
    hp_query_def def = hp_default_query_def();
    def.mode = HP_MODE_ALL;
    def.separation = HP_SEPARATION_OFF;
    memset(seen, 0, sizeof *seen);
    seen->b = b;
    return hp_query_all(b->device, &def, b->rays[0], RAYS, count_records, seen);
}

static void check_each_once(const tally *seen) {
    assert_int_equal(seen->total, RAYS * TRIANGLES);
    for (unsigned i = 0; i < RAYS; i++)
        for (unsigned k = 0; k < TRIANGLES; k++) assert_int_equal(seen->times[i][k], 1);
}

static void check_usable(bench *b) {
    hp_result results[RAYS];
    b->plan = (plan){.seen = {b->plan.seen[0], b->plan.seen[1]}};
    assert_int_equal(ask_closest(b, results), HP_OK);
    check_closest(b, results, 0, RAYS);
}

/* ---- a link without faults ---- */

static void modes_without_faults(void **state) {
    bench *b = *state;
    for (b->secondary_outer = false;; b->secondary_outer = true) {
        connect_and_upload(b);
        hp_result results[RAYS];
        assert_int_equal(ask_closest(b, results), HP_OK);
        check_closest(b, results, 0, RAYS);
        tally seen;
        assert_int_equal(ask_all(b, &seen), HP_OK);
        check_each_once(&seen);
        disconnect(b);
        if (b->secondary_outer) break;
    }
    b->secondary_outer = false;
}

static void any_and_zip(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    hp_query_def def = hp_default_query_def();
    connect_and_upload(b);
    def.mode = HP_MODE_ANY;
    assert_int_equal(hp_query(b->device, &def, b->rays[0], RAYS, results), HP_OK);
    for (unsigned i = 0; i < RAYS; i++) {
        unsigned k = 0;
        while (k < TRIANGLES && !b->truth[i][k].F) k++;
        assert_int_equal(results[i].index, k < TRIANGLES ? k : HP_NO_INDEX);
        assert_int_equal(results[i].stencil, k == TRIANGLES);
    }
    def.mode = HP_MODE_ZIP;
    def.separation = HP_SEPARATION_OFF;
    def.first = 3;
    assert_int_equal(hp_query(b->device, &def, b->rays[0], 15, results), HP_OK);
    for (unsigned i = 0; i < 15; i++) assert_memory_equal(&results[i], &b->truth[i][i + 3], sizeof *results);
    assert_int_equal(hp_query(b->device, &def, b->rays[0], 18, results), HP_ERROR_CAPACITY);
}

static void a_stencil_masks(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    hp_query_def def = hp_default_query_def();
    const uint32_t stencil = 0x25A500B3; /* one packet of 8 is masked as a whole */
    def.stencil = &stencil;
    connect_and_upload(b);
    memset(results, 0xEE, sizeof results);
    assert_int_equal(hp_query(b->device, &def, b->rays[0], RAYS, results), HP_OK);
    for (unsigned i = 0; i < RAYS; i++) {
        hp_result truth = {.index = HP_NO_INDEX, .T = INFINITY};
        if (stencil >> i & 1) truth = truly_closest(b, i);
        assert_memory_equal(&results[i], &truth, sizeof truth);
    }
    def.mode = HP_MODE_ALL;
    def.separation = HP_SEPARATION_OFF;
    tally seen = {.b = b};
    assert_int_equal(hp_query_all(b->device, &def, b->rays[0], RAYS, count_records, &seen), HP_OK);
    for (unsigned i = 0; i < RAYS; i++)
        for (unsigned k = 0; k < TRIANGLES; k++) assert_int_equal(seen.times[i][k], stencil >> i & 1);
}

static void several_packets_are_under_way(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    connect_and_upload(b);
    b->plan.queries_ahead = 0;
    assert_int_equal(ask_closest(b, results), HP_OK);
    assert_int_equal(b->plan.queries_ahead, BUFFERS);
    disconnect(b);
    hp_device_def one = patient(0);
    one.in_flight = 1;
    b->plan = (plan){0};
    assert_int_equal(connect_with(b, &one), HP_OK);
    assert_int_equal(upload(b), HP_OK);
    assert_int_equal(ask_closest(b, results), HP_OK);
    assert_int_equal(b->plan.queries_ahead, 1);
}

/* ---- one fault, everywhere ---- */

static void whole_session(bench *b, tally *seen, hp_result *results) {
    float turn[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_int_equal(connect(b), HP_OK);
    assert_int_equal(upload(b), HP_OK);
    assert_int_equal(hp_transform(b->device, turn), HP_OK);
    assert_int_equal(ask_closest(b, results), HP_OK);
    assert_int_equal(ask_all(b, seen), HP_OK);
    check_closest(b, results, 0, RAYS);
    check_each_once(seen);
}

static void one_fault(void **state, fault_kind kind, unsigned argument) {
    bench *b = *state;
    for (unsigned in = 0; in < 2; in++) {
        unsigned number = 0, faults;
        do {
            tally seen;
            hp_result results[RAYS];
            b->plan = (plan){.kind = kind, .argument = argument, .in = in, .from = number, .to = number + 1};
            whole_session(b, &seen, results);
            faults = b->plan.faults;
            disconnect(b);
            number++;
        } while (faults);
        assert_true(number > 10); /* it did happen to many packets */
    }
}

static void one_packet_dropped(void **state) {
    one_fault(state, FAULT_DROP, 0);
}
/* When a whole answer is gone, the next one looks like it but for its tag. */
static void one_answer_dropped(void **state) {
    bench *b = *state;
    b->records = PACKET;
    one_fault(state, FAULT_DROP, 0);
    b->records = RECORDS;
}
/* With one buffer, the only credit there is was in the answer that is gone. */
static void the_only_credit_dropped(void **state) {
    bench *b = *state;
    b->buffers = 1;
    one_fault(state, FAULT_DROP, 0);
    b->buffers = BUFFERS;
}
static void one_packet_doubled(void **state) {
    one_fault(state, FAULT_DUPLICATE, 0);
}
static void one_packet_swapped(void **state) {
    one_fault(state, FAULT_SWAP, 0);
}
static void one_packet_cut_to_a_byte(void **state) {
    one_fault(state, FAULT_TRUNCATE, 1u << 20);
}
static void one_packet_short_by_a_byte(void **state) {
    one_fault(state, FAULT_TRUNCATE, 1);
}
static void one_packet_with_a_bad_magic(void **state) {
    one_fault(state, FAULT_FLIP, 9);
}
static void one_packet_with_a_bad_tag(void **state) {
    one_fault(state, FAULT_FLIP, 8 * HP_AT_HEADER_tag);
}
static void one_packet_with_a_bad_payload(void **state) {
    one_fault(state, FAULT_FLIP, 8 * 40 + 3);
}
static void one_packet_delayed(void **state) {
    one_fault(state, FAULT_DELAY, 0);
}
static void one_packet_late(void **state) {
    one_fault(state, FAULT_DELAY, 1);
}

/* ---- faults that stay ---- */

static void stays(bench *b, fault_kind kind, unsigned argument, bool in, hp_status cause) {
    hp_result results[RAYS];
    connect_and_upload(b);
    plan_fault(b, kind, argument, in, 1, 1000000);
    assert_int_equal(ask_closest(b, results), cause);
    assert_non_null(strstr(hp_error_message(b->device), hp_status_text(cause)));
    assert_non_null(strstr(hp_error_message(b->device), "of 30 primaries answered"));
    check_usable(b);
    disconnect(b);
}

static void a_fault_that_stays_is_named(void **state) {
    bench *b = *state;
    stays(b, FAULT_DROP, 0, false, HP_ERROR_TIMEOUT);
    stays(b, FAULT_DROP, 0, true, HP_ERROR_TIMEOUT);
    stays(b, FAULT_FLIP, 9, false, HP_ERROR_MAGIC);
    stays(b, FAULT_FLIP, 9, true, HP_ERROR_MAGIC);
    stays(b, FAULT_FLIP, 8 * 45, false, HP_ERROR_CRC);
    stays(b, FAULT_FLIP, 8 * 45, true, HP_ERROR_CRC);
    stays(b, FAULT_TRUNCATE, 5, false, HP_ERROR_LENGTH);
    stays(b, FAULT_TRUNCATE, 5, true, HP_ERROR_LENGTH);
}

/* A board that says one thing for ever, in the midst of an answer, does not keep the driver from its timeout. */
static void a_babbling_board_is_not_waited_for(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    hp_device_def def = patient(1);
    def.timeout_ms = 20;
    b->plan = (plan){0};
    assert_int_equal(connect_with(b, &def), HP_OK);
    assert_int_equal(upload(b), HP_OK);
    plan_fault(b, FAULT_BABBLE, 10000000, true, 0, 1); /* some seconds of it */
    assert_int_equal(ask_closest(b, results), HP_ERROR_TIMEOUT);
}

typedef struct slow_taker {
    tally seen;
    unsigned naps;
} slow_taker;

static bool take_slowly(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                        size_t count) {
    slow_taker *taker = context;
    if (taker->naps++ < 3) nanosleep(&(struct timespec){.tv_nsec = 30000000}, NULL);
    return count_records(&taker->seen, primary, secondary, records, count);
}

/* What the caller's own functions take counts as nobody's silence. */
static void a_slow_taker_is_no_silent_board(void **state) {
    bench *b = *state;
    slow_taker taker = {.seen = {.b = b}};
    hp_query_def query = hp_default_query_def();
    hp_device_def def = patient(0);
    query.mode = HP_MODE_ALL;
    query.separation = HP_SEPARATION_OFF;
    def.timeout_ms = 10;
    b->plan = (plan){0};
    assert_int_equal(connect_with(b, &def), HP_OK);
    assert_int_equal(upload(b), HP_OK);
    assert_int_equal(hp_query_all(b->device, &query, b->rays[0], RAYS, take_slowly, &taker), HP_OK);
    check_each_once(&taker.seen);
}

/* The results of unanswered primaries are left alone, and the message counts the others. */
static void what_was_not_answered_is_not_written(void **state) {
    bench *b = *state;
    hp_result results[RAYS], untouched;
    unsigned answered = 0;
    char words[40];
    connect_and_upload(b);
    plan_fault(b, FAULT_DROP, 0, true, 3, 1000000); /* packets of 7 and 1 records answer 8 primaries */
    assert_int_equal(ask_closest(b, results), HP_ERROR_TIMEOUT);
    memset(&untouched, 0xEE, sizeof untouched);
    while (answered < RAYS && memcmp(&results[answered], &untouched, sizeof untouched) != 0) answered++;
    assert_int_equal(answered, 15);
    check_closest(b, results, 0, answered);
    for (unsigned i = answered; i < RAYS; i++) assert_memory_equal(&results[i], &untouched, sizeof untouched);
    snprintf(words, sizeof words, "8 of %d primaries answered", RAYS);
    assert_non_null(strstr(hp_error_message(b->device), words));
}

static void a_disconnected_board_is_named_and_stays_so(void **state) {
    bench *b = *state;
    for (unsigned in = 0; in < 2; in++) {
        hp_result results[RAYS];
        hp_counters counters;
        connect_and_upload(b);
        plan_fault(b, FAULT_DISCONNECT, 0, in, 2, 1);
        assert_int_equal(ask_closest(b, results), HP_ERROR_DISCONNECTED);
        assert_non_null(strstr(hp_error_message(b->device), "board disconnected"));
        assert_int_equal(ask_closest(b, results), HP_ERROR_DISCONNECTED);
        assert_int_equal(upload(b), HP_ERROR_DISCONNECTED);
        assert_int_equal(hp_read_counters(b->device, false, &counters), HP_ERROR_DISCONNECTED);
        disconnect(b);
    }
}

static void an_upload_that_fails_leaves_no_scene(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    connect_and_upload(b);
    plan_fault(b, FAULT_DROP, 0, true, 0, 1000000);
    assert_int_equal(upload(b), HP_ERROR_TIMEOUT);
    plan_fault(b, FAULT_NONE, 0, true, 0, 0);
    assert_int_equal(ask_closest(b, results), HP_ERROR_CAPACITY);
    assert_int_equal(upload(b), HP_OK);
    check_usable(b);
}

/* ---- what must not be done twice ---- */

static void counters_whose_answer_is_lost(void **state) {
    bench *b = *state;
    hp_counters counters;
    connect_and_upload(b);
    memset(&counters, 0xEE, sizeof counters);
    plan_fault(b, FAULT_DROP, 0, true, 0, 1);
    hp_status status = hp_read_counters(b->device, true, &counters);
    assert_int_equal(status, HP_ERROR_SEQUENCE);
    assert_non_null(strstr(hp_error_message(b->device), "carried out, but its answer was lost"));
    assert_int_equal(counters.clocks_total, 0xEEEEEEEEEEEEEEEEu);
    plan_fault(b, FAULT_DROP, 0, false, 0, 1); /* the question, not the answer: it may be asked again */
    assert_int_equal(hp_read_counters(b->device, true, &counters), HP_OK);
    plan_fault(b, FAULT_DROP, 0, true, 0, 1); /* nothing is cleared: neither is anything lost */
    assert_int_equal(hp_read_counters(b->device, false, &counters), HP_OK);
    assert_true(counters.clocks_total > 0 && counters.clocks_total < 1000000000);
}

/* After a call that gave up, the board may be ahead of what the driver heard. That must not look like an answer lost.
 */
static void counters_after_a_lost_call(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    hp_counters counters;
    connect_and_upload(b);
    plan_fault(b, FAULT_DROP, 0, true, 0, 1000000);
    assert_int_equal(ask_closest(b, results), HP_ERROR_TIMEOUT);
    plan_fault(b, FAULT_NONE, 0, true, 0, 0);
    assert_int_equal(hp_read_counters(b->device, true, &counters), HP_OK);
}

/* ---- a board that was switched off and on ---- */

static void a_board_reset_is_told_not_hidden(void **state) {
    bench *b = *state;
    hp_result results[RAYS];
    connect_and_upload(b);
    check_usable(b);
    stranger_reset(b->board);
    assert_int_equal(ask_closest(b, results), HP_ERROR_SEQUENCE);
    assert_non_null(strstr(hp_error_message(b->device), "reset"));
    assert_int_equal(ask_closest(b, results), HP_ERROR_CAPACITY);
    assert_int_equal(upload(b), HP_OK);
    check_usable(b);
}

static void a_board_reset_gets_its_matrix_again(void **state) {
    bench *b = *state;
    const float away[12] = {1, 0, 0, 1000, 0, 1, 0, 0, 0, 0, 1, 0};
    hp_result results[RAYS];
    connect_and_upload(b);
    assert_int_equal(hp_transform(b->device, away), HP_OK);
    stranger_reset(b->board);
    assert_int_equal(upload(b), HP_ERROR_SEQUENCE);
    assert_int_equal(upload(b), HP_OK);
    assert_int_equal(ask_closest(b, results), HP_OK);
    for (unsigned i = 0; i < RAYS; i++) assert_int_equal(results[i].F, 0);
}

/* ---- soak ---- */

static void soak(void **state) {
    bench *b = *state;
    hp_device_def def = patient(50);
    unsigned packets = 0, faults = 0;
    for (unsigned round = 0; round < 40; round++) {
        b->plan = (plan){.rate = 20, .random = hpt_random_seed(round)};
        b->secondary_outer = round & 1;
        tally seen;
        hp_result results[RAYS];
        assert_int_equal(connect_with(b, &def), HP_OK);
        assert_int_equal(upload(b), HP_OK);
        for (unsigned call = 0; call < 3; call++) {
            assert_int_equal(ask_closest(b, results), HP_OK);
            check_closest(b, results, 0, RAYS);
            assert_int_equal(ask_all(b, &seen), HP_OK);
            check_each_once(&seen);
        }
        packets += b->plan.seen[0] + b->plan.seen[1];
        faults += b->plan.faults;
        disconnect(b);
    }
    b->secondary_outer = false;
    assert_true(packets > 10000 && faults > 500);
}

#define EACH_TEST(name) cmocka_unit_test_teardown(name, end_test)

static int end_test(void **state) {
    disconnect(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        EACH_TEST(modes_without_faults),
        EACH_TEST(any_and_zip),
        EACH_TEST(a_stencil_masks),
        EACH_TEST(several_packets_are_under_way),
        EACH_TEST(one_packet_dropped),
        EACH_TEST(one_answer_dropped),
        EACH_TEST(the_only_credit_dropped),
        EACH_TEST(one_packet_doubled),
        EACH_TEST(one_packet_swapped),
        EACH_TEST(one_packet_cut_to_a_byte),
        EACH_TEST(one_packet_short_by_a_byte),
        EACH_TEST(one_packet_with_a_bad_magic),
        EACH_TEST(one_packet_with_a_bad_tag),
        EACH_TEST(one_packet_with_a_bad_payload),
        EACH_TEST(one_packet_delayed),
        EACH_TEST(one_packet_late),
        EACH_TEST(a_fault_that_stays_is_named),
        EACH_TEST(a_babbling_board_is_not_waited_for),
        EACH_TEST(a_slow_taker_is_no_silent_board),
        EACH_TEST(what_was_not_answered_is_not_written),
        EACH_TEST(a_disconnected_board_is_named_and_stays_so),
        EACH_TEST(an_upload_that_fails_leaves_no_scene),
        EACH_TEST(counters_whose_answer_is_lost),
        EACH_TEST(counters_after_a_lost_call),
        EACH_TEST(soak),
    };
    const struct CMUnitTest resets[] = {
        EACH_TEST(a_board_reset_is_told_not_hidden),
        EACH_TEST(a_board_reset_gets_its_matrix_again),
    };
    int failed = cmocka_run_group_tests_name("a board that is reset", resets, with_stranger, tear_down);
    failed += cmocka_run_group_tests_name("over a stranger's board", tests, with_stranger, tear_down);
    return failed + cmocka_run_group_tests_name("over the model", tests, with_model, tear_down);
}
