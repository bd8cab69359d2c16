/* The closed forms of docs/timing.md, against both engines. What is expected is computed here, from the page alone.
 */
#include "testbench/support/board_host.h"
#include <hitpipe/pipe.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { TRIANGLES = 3000, RAYS = 100 };

static float triangles[TRIANGLES * HP_TRIANGLE_WORDS], rays[RAYS * HP_RAY_WORDS];

static int make_input(void **state) {
    (void)state;
    hpt_triangles(5, TRIANGLES, 1, triangles);
    hpt_rays(6, RAYS, rays);
    return 0;
}

/* Uploads n triangles, clears the counters, asks once. `log` ends with the counters of the query. */
static hpt_log ask(const hp_board_def *def, hp_mode mode, uint32_t n, uint32_t primaries) {
    hpt_script script = {0};
    hpt_query query = hpt_query_all(mode, n, primaries, rays);
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, n, triangles);
    hpt_counters(&script, true);
    hpt_ask(&script, &query);
    hpt_log log = hpt_play(def, &script, 1);
    assert_true(hpt_clocks_add_up(&log.counters));
    hpt_script_free(&script);
    return log;
}

static hp_counters count(const hp_board_def *def, hp_mode mode, uint32_t n, uint32_t primaries) {
    hpt_log log = ask(def, mode, n, primaries);
    hp_counters counters = log.counters;
    hpt_log_free(&log);
    return counters;
}

static unsigned latency_of(const hp_board_def *def) {
    return hp_pipe_cost_of(HP_PAIR_RAY_TRIANGLE, false, &def->config).clocks;
}

#define BOTH_ENGINES(engine) for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++)

/* One ray, one lane, ideal memory: one clock to fill, N issues, the latency, one record. */
static void a_ray_takes_its_triangles_and_the_latency(void **state) {
    (void)state;
    static const uint32_t ns[] = {1, 2, 99, 100, 101, TRIANGLES};
    BOTH_ENGINES(engine) {
        hp_board_def def = hpt_board("ideal", engine);
        for (unsigned i = 0; i < sizeof ns / sizeof ns[0]; i++) {
            hp_counters c = count(&def, HP_MODE_CLOSEST, ns[i], 1);
            assert_int_equal(c.clocks_issue, ns[i]);
            assert_int_equal(c.stalls_fill, 1);
            assert_int_equal(c.stalls_drain, latency_of(&def));
            assert_int_equal(c.stalls_flush, 1);
            assert_int_equal(c.phase_compute, 1 + ns[i] + latency_of(&def) + 1);
            assert_int_equal(c.clocks_pipe, ns[i] + latency_of(&def) - 1);
        }
    }
}

/* N * ceil(P / L) issues in either loop order; with ideal memory nothing else takes a clock. */
static void lanes_share_the_primaries(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        for (unsigned lanes = 1; lanes <= 9; lanes += 2)
            for (unsigned order = 0; order < 2; order++) {
                hp_board_def def = hpt_board("ideal", engine);
                def.config.lanes = lanes;
                def.config.loop_order = order;
                hp_counters c = count(&def, HP_MODE_CLOSEST, 200, RAYS);
                assert_int_equal(c.clocks_issue, 200 * ((RAYS + lanes - 1) / lanes));
                assert_int_equal(c.tests_run, 200 * RAYS);
                assert_int_equal(c.stalls_fill + c.stalls_row + c.stalls_refresh, 1);
                assert_int_equal(c.clocks_ddr_read, order == HP_SECONDARY_OUTER ? 200 : c.clocks_issue);
            }
    }
}

/* In `all` a record a clock goes through the SRAM port, however many lanes there are. */
static void records_take_turns_at_the_port(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        hp_board_def def = hpt_board("ideal", engine);
        def.config.lanes = 4;
        hp_counters c = count(&def, HP_MODE_ALL, 50, RAYS);
        assert_int_equal(c.clocks_sram, 50 * RAYS);
        assert_int_equal(c.clocks_issue, 50 * RAYS / 4);
        assert_int_equal(c.stalls_sram_port, 50 * RAYS * 3 / 4);
        assert_int_equal(c.stalls_sram_full, 0);
    }
}

/* Rows: an upload of n beats from beat 0 opens ceil(n / row) of them. */
static void rows_cost_their_opening(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        for (uint32_t n = 15; n <= 17; n++) {
            hp_board_def def = hpt_board("ideal", engine);
            def.config.ddr_row_beats = 16;
            def.config.ddr_row_clocks = 5;
            hpt_script script = {0};
            hpt_hello(&script);
            hpt_upload(&script, HP_TRIANGLE, 0, n, triangles);
            hpt_log log = hpt_play(&def, &script, 1);
            assert_int_equal(log.counters.stalls_command, n + (n + 15) / 16 * 5);
            assert_int_equal(log.counters.clocks_ddr_row, (n + 15) / 16 * 5);
            assert_int_equal(log.counters.clocks_ddr_write, n);
            hpt_script_free(&script);
            hpt_log_free(&log);
        }
    }
}

/* The first object: legal after row_clocks, not a clock before; then the latency of the memory. */
static void a_row_is_open_after_its_clocks(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        for (unsigned row = 0; row < 6; row++)
            for (unsigned latency = 0; latency < 4; latency++) {
                hp_board_def def = hpt_board("ideal", engine);
                def.config.ddr_row_beats = 1; /* the upload left the last triangle's row open */
                def.config.ddr_row_clocks = row;
                def.config.ddr_latency = latency;
                hp_counters c = count(&def, HP_MODE_CLOSEST, 2, 1);
                assert_int_equal(c.stalls_row, 2 * row); /* and as long for the second one's */
                assert_int_equal(c.stalls_fill, 1 + latency);
            }
    }
}

/* Clocks of an upload of n beats that begins in clock *begin, refreshes being due every `interval` clocks. */
static uint64_t upload_clocks(hp_engine_kind engine, uint64_t interval, uint64_t refresh, uint32_t n,
                              uint64_t *begin) {
    hp_board_def def = hpt_board("ideal", engine);
    def.config.decoder_clocks = 500; /* the upload begins late, and no second refresh falls into it */
    def.config.ddr_refresh_interval = interval;
    def.config.ddr_refresh_clocks = refresh;
    hpt_script script = {0};
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, n, triangles);
    hpt_log log = hpt_play(&def, &script, 1);
    uint64_t clocks = log.counters.stalls_command;
    *begin = log.events[2].clock + def.config.decoder_clocks; /* HELLO received, answered, UPLOAD received */
    hpt_script_free(&script);
    hpt_log_free(&log);
    return clocks;
}

/* A refresh due in the clock of the last beat comes before it; one due a clock later does not touch the upload. */
static void a_refresh_begins_in_its_clock(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        uint64_t begin, n = 20;
        assert_int_equal(upload_clocks(engine, 1000000, 0, (uint32_t)n, &begin), n);
        for (uint64_t due = begin; due < begin + n + 3; due++) {
            uint64_t b, clocks = upload_clocks(engine, due, 3, (uint32_t)n, &b);
            assert_int_equal(b, begin);
            assert_int_equal(clocks, due < begin + n ? n + 3 : n);
        }
    }
}

/* Over a long stream the DDR delivers a beat a clock less refresh and reopening in each interval. */
static void refreshes_cost_their_share(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        hp_board_def def = hpt_board("ideal", engine);
        def.config.ddr_row_clocks = 6;
        def.config.ddr_refresh_interval = 100;
        def.config.ddr_refresh_clocks = 8;
        hp_counters c = count(&def, HP_MODE_CLOSEST, TRIANGLES, 1);
        uint64_t stream = c.clocks_issue + c.stalls_fill + c.stalls_row + c.stalls_refresh;
        uint64_t least = TRIANGLES * 100ull / (100 - 8 - 6);
        assert_in_range(stream, least - 14, least + 14 + 1);
        assert_int_equal(c.clocks_ddr_read, TRIANGLES);
    }
}

/* A transfer takes its bytes over the bandwidth, rounded up, and its turnaround. */
static void transfers_take_bytes_over_bandwidth(void **state) {
    (void)state;
    static const struct {
        uint64_t rate, ns;
    } links[] = {{350000000, 20000}, {330000000, 5000}, {1000000007, 15}, {100000000, 0}};
    BOTH_ENGINES(engine) {
        for (unsigned i = 0; i < sizeof links / sizeof links[0]; i++) {
            hp_board_def def = hpt_board("ideal", engine);
            def.config.link_to_board_rate = def.config.link_to_host_rate = links[i].rate;
            def.config.link_turnaround_ns = links[i].ns;
            hpt_log log = ask(&def, HP_MODE_ALL, 7, 3);
            uint64_t up = HP_HEADER_BYTES + HP_QUERY_FIXED + 3 * 24 + HP_CRC_BYTES;
            uint64_t down = HP_HEADER_BYTES + HP_RESULT_FIXED + 21 * HP_RESULT_BYTES + HP_CRC_BYTES;
            uint64_t counters = HP_HEADER_BYTES + 8 * HP_REGISTER_COUNT + HP_CRC_BYTES;
            uint64_t turn = (links[i].ns + 9) / 10;
            assert_int_equal(log.counters.clocks_link_to_board,
                             turn + (up * 100000000 + links[i].rate - 1) / links[i].rate);
            assert_int_equal(log.counters.clocks_link_to_host, /* the answer of COUNTERS, and this one */
                             2 * turn + (down * 100000000 + links[i].rate - 1) / links[i].rate +
                                 (counters * 100000000 + links[i].rate - 1) / links[i].rate);
            assert_int_equal(log.counters.bytes_to_board, up);
            assert_int_equal(log.counters.bytes_to_host, down + counters);
            hpt_log_free(&log);
        }
    }
}

/* Two packets in flight hide the transfers behind the tests: block RAM is double-buffered. */
static void the_next_packet_loads_while_one_is_tested(void **state) {
    (void)state;
    BOTH_ENGINES(engine) {
        hp_board_def def = hpt_board("usb3", engine);
        hpt_script script = {0};
        hpt_query query = hpt_query_all(HP_MODE_CLOSEST, 100, RAYS, rays);
        hpt_hello(&script);
        hpt_upload(&script, HP_TRIANGLE, 0, 100, triangles);
        hpt_counters(&script, true);
        for (unsigned i = 0; i < 6; i++) hpt_ask(&script, &query);
        hpt_log one = hpt_play(&def, &script, 1), two = hpt_play(&def, &script, 2);
        assert_int_equal(one.counters.clocks_issue, two.counters.clocks_issue);
        uint64_t transfer = one.counters.clocks_link_to_board / 6;
        assert_true(two.counters.clocks_total + 5 * transfer <= one.counters.clocks_total);
        hpt_log_free(&one);
        hpt_log_free(&two);
        hpt_script_free(&script);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_ray_takes_its_triangles_and_the_latency),
                                       cmocka_unit_test(lanes_share_the_primaries),
                                       cmocka_unit_test(records_take_turns_at_the_port),
                                       cmocka_unit_test(rows_cost_their_opening),
                                       cmocka_unit_test(a_row_is_open_after_its_clocks),
                                       cmocka_unit_test(a_refresh_begins_in_its_clock),
                                       cmocka_unit_test(refreshes_cost_their_share),
                                       cmocka_unit_test(transfers_take_bytes_over_bandwidth),
                                       cmocka_unit_test(the_next_packet_loads_while_one_is_tested)};
    return cmocka_run_group_tests(tests, make_input, NULL);
}
