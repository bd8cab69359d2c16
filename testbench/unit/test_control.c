/* The board beside its link: reset, abort, clock, health; the same by both engines, wherever in its work it is met.
 */
#include "testbench/support/board_host.h"
#include "testbench/support/random.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { TRIANGLES = 300, RAYS = 20 };

static float triangles[TRIANGLES * HP_TRIANGLE_WORDS], rays[RAYS * HP_RAY_WORDS];

static int make_input(void **state) {
    (void)state;
    hpt_triangles(7, TRIANGLES, 1, triangles);
    hpt_rays(8, RAYS, rays);
    return 0;
}

static hp_board *board_of(const hp_board_def *def) {
    hp_board *board;
    assert_int_equal(hp_board_create(def, &board), HP_OK);
    return board;
}

/* HELLO, a scene, three queries of different modes, counters. */
static hpt_script some_work(void) {
    hpt_script script = {0};
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
    for (hp_mode mode = HP_MODE_CLOSEST; mode <= HP_MODE_ALL; mode++) {
        hpt_query query = hpt_query_all(mode, TRIANGLES, RAYS, rays);
        hpt_ask(&script, &query);
    }
    hpt_counters(&script, false);
    return script;
}

static void send(hp_board *board, const hpt_packet *packet) {
    assert_int_equal(hp_board_send(board, packet->bytes, packet->n), HP_OK);
}

/* The last packet with LAST that the board sends before it is idle; its header and how many there were. */
static unsigned run(hp_board *board, hp_header *header) {
    unsigned answers = 0;
    for (;;) {
        hp_board_event event = hp_board_step(board);
        const uint8_t *payload;
        if (event.kind == HP_BOARD_IDLE) return answers;
        if (event.kind != HP_BOARD_SENT) continue;
        assert_int_equal(hp_packet_open(event.bytes, event.n, header, &payload), HP_OK);
        answers += header->flags & HP_FLAG_LAST;
    }
}

/* ---- both engines, stopped anywhere ---- */

typedef struct outcome {
    uint64_t clock;
    uint64_t hash; /* of all that the board sent */
    unsigned received;
    hp_counters counters;
    hp_health health;
} outcome;

static uint64_t hash_more(uint64_t hash, const void *bytes, size_t n) {
    for (size_t i = 0; i < n; i++) hash = (hash ^ ((const uint8_t *)bytes)[i]) * 0x100000001B3;
    return hash;
}

static void hear_all(hp_board *board, outcome *heard) {
    for (hp_board_event event; (event = hp_board_step(board)).kind != HP_BOARD_IDLE;) {
        heard->hash = hash_more(heard->hash, &event.clock, sizeof event.clock);
        heard->hash = hash_more(heard->hash, &event.kind, sizeof event.kind);
        heard->received += event.kind == HP_BOARD_RECEIVED;
        if (event.kind == HP_BOARD_SENT) heard->hash = hash_more(heard->hash, event.bytes, event.n);
    }
}

/* Everything is sent at once, the board stopped after so many events, and then it does all of it again. */
static outcome stopped_after(const hp_board_def *def, unsigned events, void (*stop)(hp_board *)) {
    hp_board *board = board_of(def);
    hpt_script script = some_work();
    outcome heard = {0};
    for (size_t i = 0; i < script.count; i++) send(board, &script.packets[i]);
    for (unsigned i = 0; i < events; i++) hp_board_step(board);
    stop(board);
    heard.received = 0;
    hear_all(board, &heard);
    assert_int_equal(heard.received, 0); /* no transfer is on its way any more */
    for (size_t i = 0; i < script.count; i++) {
        send(board, &script.packets[i]);
        hear_all(board, &heard);
    }
    heard.counters = hp_board_counters(board);
    heard.clock = hp_board_clock(board);
    heard.health = hp_board_health(board);
    hp_board_destroy(board);
    hpt_script_free(&script);
    return heard;
}

/* Half of them have a link that takes no time, so that much happens in one clock. */
static void random_board(hpt_random *random, hp_config *config) {
    if (hpt_random_below(random, 2)) hp_config_preset(config, "ideal");
    config->packet_buffers = 1 + hpt_random_below(random, 6);
    config->packet_results = 1 + hpt_random_below(random, 500);
    config->link_duplex = hpt_random_below(random, 2);
    if (config->link_turnaround_ns) {
        config->decoder_clocks = 1 + hpt_random_below(random, 300);
        config->link_to_board_rate = 1000000 * (1 + hpt_random_below(random, 3000));
        config->link_to_host_rate = 1000000 * (1 + hpt_random_below(random, 3000));
    }
    config->sram_records = 1 + hpt_random_below(random, 1000);
    config->ddr_refresh_interval = 100 + hpt_random_below(random, 700);
}

static void engines_stop_alike(void **state) {
    (void)state;
    static void (*const stops[])(hp_board *) = {hp_board_reset, hp_board_abort};
    hpt_random random = hpt_random_seed(1);
    for (unsigned events = 0; events < 60; events++)
        for (unsigned i = 0; i < 2; i++) {
            hp_board_def quick = hpt_board("usb3", HP_ENGINE_QUICK), clocked;
            random_board(&random, &quick.config);
            clocked = quick;
            clocked.engine = HP_ENGINE_CLOCKED;
            outcome a = stopped_after(&quick, events, stops[i]), b = stopped_after(&clocked, events, stops[i]);
            assert_int_equal(a.clock, b.clock);
            assert_int_equal(a.hash, b.hash);
            assert_memory_equal(&a.counters, &b.counters, sizeof a.counters);
            assert_true(hpt_clocks_add_up(&a.counters));
            assert_memory_equal(&a.health, &b.health, sizeof a.health);
        }
}

/* ---- reset ---- */

static void a_reset_board_knows_nothing(void **state) {
    (void)state;
    for (unsigned events = 0; events < 25; events++) {
        hp_board_def def = hpt_board("usb3", events % 2 ? HP_ENGINE_CLOCKED : HP_ENGINE_QUICK);
        hp_board *board = board_of(&def);
        hpt_script script = some_work();
        hp_header header;
        for (size_t i = 0; i < script.count; i++) send(board, &script.packets[i]);
        for (unsigned i = 0; i < events; i++) hp_board_step(board);
        hp_board_reset(board);
        uint64_t clock = hp_board_clock(board);
        assert_int_equal(hp_board_step(board).kind, HP_BOARD_IDLE); /* nothing is under way */
        assert_int_equal(hp_board_counters(board).clocks_total, 0);
        assert_int_equal(hp_board_clock(board), clock);
        assert_false(hp_board_health(board).session);
        send(board, &script.packets[1]);
        assert_int_equal(run(board, &header), 1);
        assert_int_equal(header.status, HP_ERROR_SEQUENCE);
        assert_int_equal(header.sequence, 0);
        send(board, &script.packets[0]);
        run(board, &header);
        script.packets[2].bytes[HP_AT_HEADER_sequence] = 1; /* the scene is gone */
        hp_put32(script.packets[2].bytes + HP_AT_HEADER_header_crc,
                 hp_crc32c(0, script.packets[2].bytes, HP_AT_HEADER_header_crc));
        send(board, &script.packets[2]);
        run(board, &header);
        assert_int_equal(header.status, HP_ERROR_FIELD);
        hp_board_destroy(board);
        hpt_script_free(&script);
    }
}

/* ---- abort ---- */

static void abort_keeps_the_command_under_way_and_the_session(void **state) {
    (void)state;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++) {
        hp_board_def def = hpt_board("usb3", engine);
        hpt_script script = some_work();
        hp_header header;
        def.config.packet_buffers = 8;
        def.config.link_turnaround_ns = 0;
        hp_board *board = board_of(&def);
        for (size_t i = 0; i < 2; i++) {
            send(board, &script.packets[i]);
            run(board, &header);
        }
        for (size_t i = 2; i < script.count; i++) send(board, &script.packets[i]);
        while (hp_board_step(board).kind != HP_BOARD_RECEIVED) {
        }
        assert_int_equal(hp_board_step(board).kind, HP_BOARD_RECEIVED); /* by now the first query is carried out */
        hp_board_abort(board);
        send(board, &script.packets[3]); /* while that is still under way */
        assert_int_equal(run(board, &header), 2);
        assert_int_equal(header.status, HP_OK);
        assert_int_equal(header.tag, 4);
        assert_int_equal(header.sequence, 4);
        assert_int_equal(header.limit, 4 + 8); /* what was dropped takes no buffers */
        for (size_t i = 4; i < script.count; i++) {
            send(board, &script.packets[i]);
            assert_int_equal(run(board, &header), 1);
            assert_int_equal(header.status, HP_OK);
        }
        hp_board_destroy(board);
        hpt_script_free(&script);
    }
}

/* ---- clock ---- */

static void the_clock_changes_with_the_next_hello(void **state) {
    (void)state;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++) {
        hp_board_def def = hpt_board("usb3", engine);
        hp_board *board = board_of(&def);
        hpt_script script = some_work();
        hp_header header;
        uint64_t slow[2], fast[2];
        assert_int_equal(hp_board_set_clock(board, 0), HP_ERROR_FIELD);
        assert_int_equal(hp_board_set_clock(board, 999999), HP_ERROR_FIELD);
        assert_int_equal(hp_board_set_clock(board, UINT64_MAX), HP_ERROR_FIELD);
        send(board, &script.packets[0]), run(board, &header);
        for (unsigned i = 0; i < 2; i++) {
            slow[i] = hp_board_clock(board);
            send(board, &script.packets[1 + i]), run(board, &header);
            slow[i] = hp_board_clock(board) - slow[i];
            if (i == 0) assert_int_equal(hp_board_set_clock(board, 400000000), HP_OK);
            assert_int_equal(hp_board_config(board)->clock_hz, 100000000);
        }
        send(board, &script.packets[0]), run(board, &header);
        assert_int_equal(hp_board_config(board)->clock_hz, 400000000);
        for (unsigned i = 0; i < 2; i++) {
            fast[i] = hp_board_clock(board);
            send(board, &script.packets[1 + i]), run(board, &header);
            fast[i] = hp_board_clock(board) - fast[i];
        }
        assert_true(fast[0] > 3 * slow[0]); /* the upload is nearly all link: as many seconds, more clocks */
        hp_board_reset(board);
        assert_int_equal(hp_board_config(board)->clock_hz, 400000000);
        hp_board_destroy(board);
        hpt_script_free(&script);
    }
}

static void forget(void *context, const char *text, size_t n) {
    (void)context, (void)text, (void)n;
}

static void a_waveform_has_one_clock(void **state) {
    (void)state;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_CLOCKED);
    def.vcd = forget;
    hp_board *board = board_of(&def);
    assert_int_equal(hp_board_set_clock(board, 200000000), HP_ERROR_USAGE);
    hp_board_destroy(board);
}

/* ---- health ---- */

static void health_counts_over_sessions(void **state) {
    (void)state;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
    hp_board *board = board_of(&def);
    hpt_script script = some_work();
    hp_header header;
    hp_health health = hp_board_health(board);
    assert_false(health.session);
    assert_int_equal(health.packets + health.refused, 0);
    assert_true(health.celsius == 35);
    send(board, &script.packets[3]), run(board, &header); /* no session yet: out of order */
    for (size_t i = 0; i < 3; i++) send(board, &script.packets[i]), run(board, &header);
    script.packets[3].bytes[70] ^= 1;
    send(board, &script.packets[3]), run(board, &header); /* damaged */
    script.packets[3].bytes[70] ^= 1;
    send(board, &script.packets[0]), run(board, &header);
    script.packets[2].bytes[HP_AT_HEADER_sequence] = 1;
    hp_put32(script.packets[2].bytes + HP_AT_HEADER_header_crc,
             hp_crc32c(0, script.packets[2].bytes, HP_AT_HEADER_header_crc));
    send(board, &script.packets[2]), run(board, &header); /* taken, and refused: there is no scene */
    hp_board_reset(board);
    health = hp_board_health(board);
    assert_false(health.session);
    assert_int_equal(health.packets, 5);
    assert_int_equal(health.refused, 3);
    assert_int_equal(health.crc, 1);
    assert_int_equal(health.sequence, 1);
    hp_board_destroy(board);
    hpt_script_free(&script);
}

/* Seconds of board time at work, then at rest on a slow link. */
static void work_warms_the_board(void **state) {
    (void)state;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
    def.config.clock_hz = 1000000;
    def.config.operator_clocks[HP_OP_DIV] = 255;
    hp_board *board = board_of(&def);
    hpt_script script = {0};
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, TRIANGLES, RAYS, rays);
    hp_header header;
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
    for (unsigned i = 0; i < 400; i++) hpt_ask(&script, &query);
    for (size_t i = 0; i < script.count; i++) send(board, &script.packets[i]), run(board, &header);
    assert_true(hp_board_clock(board) > 1000000); /* more than a second */
    double warm = hp_board_health(board).celsius;
    assert_true(warm > 45 && warm < 65);
    assert_true(hp_board_health(board).celsius == warm); /* no time has passed */
    hpt_hello(&script);
    script.packets[script.count - 1].n = 1;
    while (hp_board_clock(board) < 8000000) {
        hp_board_event event;
        send(board, &script.packets[script.count - 1]);
        while ((event = hp_board_step(board)).kind != HP_BOARD_IDLE) {
        }
    }
    double cool = hp_board_health(board).celsius;
    assert_true(cool < warm && cool > 35);
    hp_board_destroy(board);
    hpt_script_free(&script);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(engines_stop_alike),
                                       cmocka_unit_test(a_reset_board_knows_nothing),
                                       cmocka_unit_test(abort_keeps_the_command_under_way_and_the_session),
                                       cmocka_unit_test(the_clock_changes_with_the_next_hello),
                                       cmocka_unit_test(a_waveform_has_one_clock),
                                       cmocka_unit_test(health_counts_over_sessions),
                                       cmocka_unit_test(work_warms_the_board)};
    return cmocka_run_group_tests(tests, make_input, NULL);
}
