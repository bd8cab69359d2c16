/* Every knob of config.def does something: turning it changes the count or the bits it says it changes, in both
 * engines. A knob without a row here fails. */
#include "testbench/support/board_host.h"
#include "testbench/support/pair_cases.h"
#include <hitpipe/pipe.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { TRIANGLES = 300, RAYS = 20 };

typedef struct turn {
    const char *key, *value;
    const char *changes; /* a register; or "results", "identity": bytes of RESULT, HELLO_REPLY */
    const char *with;    /* a knob both sides are set to, for this one to matter, or NULL ... */
    const char *to;      /* ... and its value */
} turn;

static const turn turns[] = {
    {"name", "another", "identity", NULL, NULL},
    {"clock_hz", "50000000", "clocks.link_to_board", NULL, NULL},
    {"lanes", "4", "clocks.issue", NULL, NULL},
    {"loop_order", "primary-outer", "clocks.ddr_read", NULL, NULL},
    {"subnormals", "gradual", "results", NULL, NULL},
    {"packet.primaries", "8", "tests.run", NULL, NULL},
    {"packet.buffers", "1", "tests.run", NULL, NULL}, /* two are in flight */
    {"packet.results", "5", "bytes.to_host", NULL, NULL},
    {"decoder.clocks", "9", "clocks.decoder", NULL, NULL},
    {"selector.clocks", "9", "stalls.select", NULL, NULL},
    {"operators.add", "12", "stalls.drain", NULL, NULL},
    {"operators.sub", "12", "stalls.drain", NULL, NULL},
    {"operators.mul", "7", "stalls.drain", NULL, NULL},
    {"operators.div", "30", "stalls.drain", NULL, NULL},
    {"operators.sqrt", "30", "stalls.drain", NULL, NULL},
    {"operators.compare", "60", "stalls.drain", NULL, NULL},
    {"operators.select", "1", "stalls.drain", NULL, NULL},
    {"ddr.bytes", "3600", "clocks.ddr_write", NULL, NULL},
    {"ddr.row_beats", "16", "clocks.ddr_row", NULL, NULL},
    {"ddr.row_clocks", "9", "stalls.row", NULL, NULL},
    {"ddr.latency", "9", "stalls.fill", NULL, NULL},
    {"ddr.refresh_interval", "500", "clocks.ddr_refresh", NULL, NULL},
    {"ddr.refresh_clocks", "9", "clocks.ddr_refresh", NULL, NULL},
    {"secondary.depth", "2", "stalls.fill", "ddr.latency", "200"},
    {"sram.records", "100", "stalls.sram_full", NULL, NULL},
    {"link.duplex", "half", "clocks.total", NULL, NULL},
    {"link.to_board_bytes_per_second", "300000000", "clocks.link_to_board", NULL, NULL},
    {"link.to_host_bytes_per_second", "300000000", "clocks.link_to_host", NULL, NULL},
    {"link.turnaround_ns", "10000", "clocks.link_to_board", NULL, NULL},
};

static const turn *turn_of(const char *key) {
    for (unsigned i = 0; i < sizeof turns / sizeof turns[0]; i++)
        if (strcmp(turns[i].key, key) == 0) return &turns[i];
    return NULL;
}

static hp_config config_with(const char *key, const char *value) {
    char message[HP_CONFIG_MESSAGE];
    hp_config config;
    assert_int_equal(hp_config_preset(&config, "usb3"), HP_OK);
    if (key && hp_config_set(&config, key, value, message) != HP_OK) fail_msg("%s", message);
    return config;
}

/* A pipe with a square root. */
static void ask_spheres(hpt_script *script) {
    const float spheres[2 * HP_SPHERE_WORDS] = {0, 0, 0, 1, 1, 1, 1, 1};
    hpt_upload(script, HP_SPHERE, 0, 2, spheres);
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, 2, 2, spheres);
    query.pair = HP_PAIR_SPHERE_SPHERE;
    hpt_ask(script, &query);
}

static hpt_log play(const hp_config *config, hp_engine_kind engine) {
    static float triangles[TRIANGLES * HP_TRIANGLE_WORDS], rays[RAYS * HP_RAY_WORDS];
    hpt_script script = {0};
    hpt_triangles(1, TRIANGLES, 1, triangles);
    hpt_rays(2, RAYS, rays);
    /* a hit whose T is subnormal */
    const float ahead[HP_RAY_WORDS] = {0, 0, 0, 0, 0, 1},
                near[HP_TRIANGLE_WORDS] = {-1, -1, 1e-40f, 3, -1, 1e-40f, -1, 3, 1e-40f};
    memcpy(rays, ahead, sizeof ahead);
    memcpy(triangles, near, sizeof near);
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES / 2, triangles);
    hpt_upload(&script, HP_TRIANGLE, TRIANGLES / 2, TRIANGLES / 2, triangles + TRIANGLES / 2 * HP_TRIANGLE_WORDS);
    for (hp_mode mode = HP_MODE_CLOSEST; mode <= HP_MODE_ZIP; mode++) {
        hpt_query query = hpt_query_all(mode, mode == HP_MODE_ZIP ? RAYS : TRIANGLES, RAYS, rays);
        hpt_ask(&script, &query);
    }
    ask_spheres(&script);
    hp_board_def def = {.config = *config, .engine = engine, .threads = 1};
    hpt_log log = hpt_play(&def, &script, 2);
    hpt_script_free(&script);
    return log;
}

/* Whether the n-th packets of an opcode differ in their payloads. */
static bool payloads_differ(const hpt_log *a, const hpt_log *b, unsigned opcode) {
    hp_header ha, hb;
    for (unsigned n = 0;; n++) {
        const uint8_t *pa = hpt_answer(a, opcode, n, &ha), *pb = hpt_answer(b, opcode, n, &hb);
        if (!pa || !pb) return pa != pb;
        if (ha.length != hb.length || memcmp(pa, pb, ha.length) != 0) return true;
    }
}

static bool differ(const hpt_log *a, const hpt_log *b, const char *what) {
    if (strcmp(what, "identity") == 0) return payloads_differ(a, b, HP_OPCODE_HELLO_REPLY);
    if (strcmp(what, "results") == 0) return payloads_differ(a, b, HP_OPCODE_RESULT);
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++)
        if (strcmp(hp_register_name(i), what) == 0)
            return hp_register_value(&a->counters, i) != hp_register_value(&b->counters, i);
    fail_msg("no register %s", what);
    return false;
}

static void every_knob_changes_what_it_says(void **state) {
    (void)state;
    for (unsigned i = 0; hp_config_key(i); i++) {
        const char *key = hp_config_key(i);
        char message[HP_CONFIG_MESSAGE];
        if (strcmp(key, "pipes") == 0) continue; /* below */
        const turn *t = turn_of(key);
        if (!t) fail_msg("no test for the knob %s", key);
        for (int engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++) {
            hp_config before = config_with(t->with, t->to), after = before;
            assert_int_equal(hp_config_set(&after, key, t->value, message), HP_OK);
            hpt_log a = play(&before, (hp_engine_kind)engine), b = play(&after, (hp_engine_kind)engine);
            if (!differ(&a, &b, t->changes)) fail_msg("%s = %s leaves %s as it was", key, t->value, t->changes);
            hpt_log_free(&a);
            hpt_log_free(&b);
        }
    }
}

/* Asks a pair of its own kind of scene; returns the status of the answer. */
static hp_status ask_pair(const hp_config *config, hp_pair pair) {
    float primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX];
    hpt_random random = hpt_random_seed(7);
    hpt_script script = {0};
    hp_header header;
    hpt_draw_pair(&random, pair, HPT_RANDOM, 0, primary, secondary);
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, 1, 1, primary);
    query.pair = pair;
    hpt_hello(&script);
    hpt_upload(&script, hp_pair_secondary(pair), 0, 1, secondary);
    hpt_ask(&script, &query);
    hp_board_def def = {.config = *config, .engine = HP_ENGINE_QUICK, .threads = 1};
    hpt_log log = hpt_play(&def, &script, 1);
    bool answered = hpt_answer(&log, HP_OPCODE_RESULT, 0, &header);
    assert_true(answered || hpt_answer(&log, HP_OPCODE_ERROR, 0, &header));
    hpt_log_free(&log);
    hpt_script_free(&script);
    return (hp_status)header.status;
}

/* Pipes: a query is carried out if its pipe is resident, and refused if not; the board says which are. */
static void pipes_are_resident_or_not(void **state) {
    (void)state;
    static const hp_pair pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
    };
    enum { PAIRS = sizeof pairs / sizeof pairs[0] };
    for (unsigned i = 0; i <= PAIRS; i++) {
        hp_config config = config_with("pipes", i == PAIRS ? "none" : hp_pair_name(pairs[i]));
        hpt_log log = play(&config, HP_ENGINE_QUICK);
        hp_header header;
        const uint8_t *reply = hpt_answer(&log, HP_OPCODE_HELLO_REPLY, 0, &header);
        assert_non_null(reply);
        assert_int_equal(hp_get32(reply + HP_AT_HELLO_REPLY_pairs), i == PAIRS ? 0 : 1u << pairs[i]);
        for (unsigned k = 0; k < PAIRS; k++)
            assert_int_equal(ask_pair(&config, pairs[k]), i == k ? HP_OK : HP_ERROR_NOT_RESIDENT);
        hpt_log_free(&log);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_knob_changes_what_it_says),
                                       cmocka_unit_test(pipes_are_resident_or_not)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
