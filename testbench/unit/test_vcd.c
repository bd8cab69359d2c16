/* The waveform of the clocked engine: a parser of value change dumps reads it, refuses what IEEE 1364-2005 clause 18
 * refuses, and counts in it what the counter registers count. */
#include "testbench/support/board_host.h"
#include "testbench/support/pair_cases.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { SIGNALS_MOST = 256 };

typedef struct text {
    char *bytes;
    size_t used, room;
} text;

static void take_text(void *context, const char *bytes, size_t n) {
    text *t = context;
    if (t->used + n + 1 > t->room) {
        t->room = 2 * (t->used + n + 1);
        t->bytes = realloc(t->bytes, t->room);
        assert_non_null(t->bytes);
    }
    memcpy(t->bytes + t->used, bytes, n);
    t->used += n;
    t->bytes[t->used] = '\0';
}

typedef struct signal {
    char id[8], name[88]; /* "selector.pipe_valid" */
    unsigned bits;
    uint64_t value;
    bool known;
} signal_t;

typedef struct wave {
    signal_t signals[SIGNALS_MOST];
    unsigned count;
    uint64_t time, per_clock;
    const char *fault; /* what is wrong with the text, NULL: nothing */
    /* counted while reading: clocks in which signal a is 1, and both a and b are */
    uint64_t high[SIGNALS_MOST], both[SIGNALS_MOST];
} wave;

static signal_t *by_id(wave *w, const char *id) {
    for (unsigned i = 0; i < w->count; i++)
        if (strcmp(w->signals[i].id, id) == 0) return &w->signals[i];
    return NULL;
}

static int by_name(const wave *w, const char *name) {
    for (unsigned i = 0; i < w->count; i++)
        if (strcmp(w->signals[i].name, name) == 0) return (int)i;
    return -1;
}

/* Signal NAME_ready of a signal NAME_valid, or -1. */
static int partner(const wave *w, unsigned i) {
    char name[96];
    size_t n = strlen(w->signals[i].name);
    if (n < 6 || strcmp(w->signals[i].name + n - 6, "_valid") != 0) return -1;
    snprintf(name, sizeof name, "%.*s_ready", (int)(n - 6), w->signals[i].name);
    return by_name(w, name);
}

static void pass(wave *w, uint64_t time) {
    uint64_t clocks = (time - w->time) / w->per_clock;
    if (time < w->time) w->fault = "time goes back";
    if (time % w->per_clock) w->fault = "a change between clocks";
    for (unsigned i = 0; i < w->count && !w->fault; i++) {
        int ready = partner(w, i);
        if (!w->signals[i].known && clocks) w->fault = "a signal without a first value";
        if (w->signals[i].value) w->high[i] += clocks;
        if (ready >= 0 && w->signals[i].value && w->signals[ready].value) w->both[i] += clocks;
    }
    w->time = time;
}

static void change(wave *w, const char *id, uint64_t value, unsigned bits) {
    signal_t *signal = by_id(w, id);
    if (!signal)
        w->fault = "a change of a signal not declared";
    else if (bits > signal->bits)
        w->fault = "a value wider than its signal";
    else if (signal->known && signal->value == value)
        w->fault = "a change to the value that was there";
    else
        signal->value = value, signal->known = true;
}

static void declare(wave *w, const char *scope, char *line) {
    signal_t *signal = &w->signals[w->count++];
    char name[40], end[8];
    if (sscanf(line, "$var wire %u %7s %39s %7s", &signal->bits, signal->id, name, end) != 4 || strcmp(end, "$end"))
        w->fault = "a declaration that cannot be read";
    snprintf(signal->name, sizeof signal->name, "%s.%s", scope, name);
    if (by_id(w, signal->id) != signal) w->fault = "an identifier declared twice";
}

static void read_vector(wave *w, char *line) {
    char digits[80], id[8];
    uint64_t value = 0;
    if (sscanf(line, "b%79[01] %7s", digits, id) != 2) {
        w->fault = "a vector that cannot be read";
        return;
    }
    for (const char *d = digits; *d; d++) value = value << 1 | (uint64_t)(*d - '0');
    change(w, id, value, (unsigned)strlen(digits));
}

/* Header lines up to $enddefinitions, scopes two deep; then times and changes. */
static void read_header(wave *w, char *line, char scope[40], int *depth, bool *defined) {
    if (strncmp(line, "$scope module ", 14) == 0) {
        sscanf(line, "$scope module %39s", scope);
        ++*depth;
    } else if (strcmp(line, "$upscope $end") == 0) {
        if (--*depth < 0) w->fault = "a scope closed twice";
    } else if (strncmp(line, "$var ", 5) == 0) {
        if (*depth != 2 || w->count == SIGNALS_MOST) w->fault = "a signal outside a scope";
        declare(w, scope, line);
    } else if (strcmp(line, "$enddefinitions $end") == 0) {
        if (*depth) w->fault = "a scope left open";
        *defined = true;
    } else if (strncmp(line, "$timescale 1 ", 13) && strncmp(line, "$version ", 9)) {
        w->fault = "a header line that is none";
    }
}

static void read_change(wave *w, char *line) {
    if (line[0] == '#')
        pass(w, strtoull(line + 1, NULL, 10));
    else if (line[0] == 'b')
        read_vector(w, line);
    else if (line[0] == '0' || line[0] == '1')
        change(w, line + 1, (uint64_t)(line[0] - '0'), 1);
    else if (strcmp(line, "$dumpvars") && strcmp(line, "$end"))
        w->fault = "a line that is no change";
}

static wave *read_wave(text *t, uint64_t per_clock) {
    wave *w = calloc(1, sizeof *w);
    char scope[40] = "", *save = NULL;
    bool defined = false;
    int depth = 0;
    assert_non_null(w);
    w->per_clock = per_clock;
    for (char *line = strtok_r(t->bytes, "\n", &save); line && !w->fault; line = strtok_r(NULL, "\n", &save)) {
        if (!defined)
            read_header(w, line, scope, &depth, &defined);
        else
            read_change(w, line);
    }
    if (!defined && !w->fault) w->fault = "no definitions";
    return w;
}

/* A scene of another type, asked by two pipes in turn, with and without the distance of a miss. */
static void ask_boxes(hpt_script *script) {
    float boxes[8 * HP_OBB_WORDS], spheres[4 * HP_SPHERE_WORDS];
    hpt_random random = hpt_random_seed(5);
    for (unsigned i = 0; i < 8; i++)
        hpt_draw_objects(&random, HP_SPHERE, HP_OBB, HPT_RANDOM, i, spheres + i % 4 * HP_SPHERE_WORDS,
                         boxes + i * HP_OBB_WORDS);
    hpt_upload(script, HP_OBB, 0, 8, boxes);
    hpt_transform(script, NULL);
    for (unsigned i = 0; i < 4; i++) {
        hpt_query query = hpt_query_all(HP_MODE_CLOSEST, 8, 4, i & 1 ? boxes : spheres);
        query.pair = i & 1 ? HP_PAIR_OBB_OBB : HP_PAIR_SPHERE_OBB;
        query.options = i & 2 ? HP_OPTION_SEPARATION | HP_OPTION_NEAREST : 0;
        hpt_ask(script, &query);
    }
}

/* A board that does everything once: uploads, a transform, all modes, SRAMs that fill, a refresh and rows, several
 * pipes. */
static hpt_log play_everything(text *t, uint64_t clock_hz) {
    hp_board_def def = hpt_board("usb3", HP_ENGINE_CLOCKED);
    hpt_script script = {0};
    float triangles[40 * HP_TRIANGLE_WORDS], rays[20 * HP_RAY_WORDS];
    float matrix[12] = {1, 0, 0, 0.1f, 0, 1, 0, 0, 0, 0, 1, 0};
    def.config.clock_hz = clock_hz;
    def.config.lanes = 3;
    def.config.sram_records = 50;
    def.config.packet_results = 20;
    def.config.ddr_row_beats = 16;
    def.vcd = take_text;
    def.vcd_context = t;
    hpt_triangles(3, 40, 1, triangles);
    hpt_rays(4, 20, rays);
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, 40, triangles);
    hpt_transform(&script, matrix);
    for (hp_mode mode = HP_MODE_CLOSEST; mode <= HP_MODE_ZIP; mode++) {
        hpt_query query = hpt_query_all(mode, mode == HP_MODE_ZIP ? 20 : 40, 20, rays);
        hpt_ask(&script, &query);
    }
    ask_boxes(&script);
    hpt_log log = hpt_play(&def, &script, 2);
    hpt_script_free(&script);
    return log;
}

static uint64_t handed_over(const wave *w, const char *name) {
    char valid[64];
    snprintf(valid, sizeof valid, "%s_valid", name);
    int i = by_name(w, valid);
    assert_true(i >= 0);
    assert_true(partner(w, (unsigned)i) >= 0);
    return w->both[i];
}

/* HELLO clears the counters: of what is counted here, only its own clock came before. */
static void waveform_counts_what_the_counters_count(void **state) {
    (void)state;
    static const struct {
        const char *handshake, *counter;
    } pairs[] = {{"ddr.secondary", "clocks.ddr_read"},
                 {"ddr.write", "clocks.ddr_write"},
                 {"selector.pipe", "clocks.issue"},
                 {"pipe.update", "clocks.update"},
                 {"update.sram", "clocks.sram"}};
    text t = {0};
    hpt_log log = play_everything(&t, 100000000);
    wave *w = read_wave(&t, 10);
    if (w->fault) fail_msg("the waveform has %s", w->fault);
    assert_int_equal(w->time, 10 * log.clock);
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) {
        const char *counter = hp_register_name(i);
        uint64_t value = hp_register_value(&log.counters, i);
        for (unsigned k = 0; k < sizeof pairs / sizeof pairs[0]; k++) {
            if (strcmp(pairs[k].counter, counter) != 0) continue;
            assert_int_equal(handed_over(w, pairs[k].handshake), value);
            assert_true(value > 0);
        }
        if (strncmp(counter, "stalls.", 7) != 0 || strcmp(counter, "stalls.idle") == 0) continue;
        char name[64];
        snprintf(name, sizeof name, "stall.%s", counter + 7);
        int signal = by_name(w, name);
        assert_true(signal >= 0);
        uint64_t before_hello = strcmp(counter, "stalls.command") == 0; /* HELLO's own clock */
        assert_int_equal(w->high[signal], value + before_hello);
    }
    free(t.bytes);
    free(w);
    hpt_log_free(&log);
}

/* Each test goes into the pipe of its query; no other pipe is offered one, and each resident one stands ready. */
static void each_pipe_has_its_handshake(void **state) {
    (void)state;
    text t = {0};
    hpt_log log = play_everything(&t, 100000000);
    wave *w = read_wave(&t, 10);
    uint64_t tests = 0;
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    tests += handed_over(w, "selector." #name);                                                                      \
    assert_true(w->high[by_name(w, "selector." #name "_ready")] > 0);
#include <hitpipe/pairs.def>
#undef HP_PAIR
    assert_int_equal(tests, log.counters.clocks_issue);
    assert_int_equal(handed_over(w, "selector.obb_obb"), 2 * 2 * 8); /* four primaries in three lanes */
    assert_int_equal(handed_over(w, "selector.sphere_obb"), 2 * 2 * 8);
    assert_int_equal(handed_over(w, "selector.ray_sphere"), 0);
    assert_true(w->high[by_name(w, "selector.separation")] > 0);
    free(t.bytes);
    free(w);
    hpt_log_free(&log);
}

static void every_handshake_is_seen(void **state) {
    (void)state;
    static const char *const names[] = {"link.to_board", "link.to_host", "decoder.packet",
                                        "ddr.secondary", "ddr.write",    "selector.pipe",
                                        "pipe.update",   "update.sram",  "sram.link"};
    static const char *const others[] = {"selector.code",         "ddr.state",        "ddr.address",
                                         "secondary.level",       "sram.level",       "stall.code",
                                         "update.buffer_0_read",  "update.T_in",      "update.kept",
                                         "update.buffer_0_write", "update.address",   "update.T_read",
                                         "update.buffer_1_read",  "update.T_written", "update.buffer_1_write",
                                         "sequencer.activity",    "sequencer.opcode"};
    text t = {0};
    hpt_log log = play_everything(&t, 100000000);
    wave *w = read_wave(&t, 10);
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++) assert_true(handed_over(w, names[i]) > 0);
    for (unsigned i = 0; i < sizeof others / sizeof others[0]; i++) {
        int signal = by_name(w, others[i]);
        if (signal < 0) fail_msg("no signal %s", others[i]);
        assert_true(w->high[signal] > 0);
    }
    free(t.bytes);
    free(w);
    hpt_log_free(&log);
}

/* A clock whose period is no whole number of nanoseconds is told in picoseconds. */
static void time_is_told_in_picoseconds_where_needed(void **state) {
    (void)state;
    text t = {0};
    hpt_log log = play_everything(&t, 400000000);
    assert_non_null(strstr(t.bytes, "$timescale 1 ps $end"));
    wave *w = read_wave(&t, 2500);
    assert_null(w->fault);
    assert_int_equal(w->time, 2500 * log.clock);
    free(t.bytes);
    free(w);
    hpt_log_free(&log);
}

/* The parser itself: each of these must be refused. */
static void broken_waveforms_are_refused(void **state) {
    (void)state;
    static const char head[] = "$timescale 1 ns $end\n$scope module board $end\n$scope module a $end\n"
                               "$var wire 1 ! x $end\n$var wire 2 # y $end\n$upscope $end\n$upscope $end\n"
                               "$enddefinitions $end\n#0\n$dumpvars\n0!\nb1 #\n$end\n";
    static const char *const tails[] = {"#10\n1%\n", "#20\n1!\n#10\n0!\n", "#5\n1!\n",
                                        "#10\n0!\n", "#10\nb101 #\n",      "x\n"};
    for (unsigned i = 0; i < sizeof tails / sizeof tails[0]; i++) {
        text t = {0};
        take_text(&t, head, sizeof head - 1);
        take_text(&t, tails[i], strlen(tails[i]));
        wave *w = read_wave(&t, 10);
        assert_non_null(w->fault);
        free(t.bytes);
        free(w);
    }
}

static void only_the_clocked_engine_has_one(void **state) {
    (void)state;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
    hp_board *board;
    text t = {0};
    def.vcd = take_text;
    def.vcd_context = &t;
    assert_int_equal(hp_board_create(&def, &board), HP_ERROR_USAGE);
    assert_null(board);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(waveform_counts_what_the_counters_count),
                                       cmocka_unit_test(each_pipe_has_its_handshake),
                                       cmocka_unit_test(every_handshake_is_seen),
                                       cmocka_unit_test(time_is_told_in_picoseconds_where_needed),
                                       cmocka_unit_test(broken_waveforms_are_refused),
                                       cmocka_unit_test(only_the_clocked_engine_has_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
