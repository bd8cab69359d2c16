#include "vcd.h"
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *scope, *name;
    unsigned bits;
} signals[] = {
#define HP_SIGNAL(scope, name, bits, value) {#scope, #name, bits},
#include "signals.def"
};

enum {
    SIGNALS = sizeof signals / sizeof signals[0],
    TEXT_ROOM = 1 << 16, /* bytes handed to the sink at a time */
    LINE_MOST = 128
};

struct hp_vcd {
    hp_vcd_sink *sink;
    void *context;
    uint64_t clock_hz, unit; /* units of time in a second */
    bool begun;
    hp_probe probe;
    uint64_t values[SIGNALS];
    size_t used;
    char text[TEXT_ROOM];
};

static void flush(hp_vcd *vcd) {
    if (vcd->used) vcd->sink(vcd->context, vcd->text, vcd->used);
    vcd->used = 0;
}

__attribute__((format(printf, 2, 3))) static void put(hp_vcd *vcd, const char *format, ...) {
    va_list list;
    if (vcd->used + LINE_MOST > TEXT_ROOM) flush(vcd);
    va_start(list, format);
    vcd->used += (size_t)vsnprintf(vcd->text + vcd->used, LINE_MOST, format, list);
    va_end(list);
}

/* Identifiers count in the printable characters from '!' to '~'. */
static void name_signal(unsigned i, char id[4]) {
    unsigned at = 0;
    do {
        id[at++] = (char)('!' + i % 94);
        i /= 94;
    } while (i);
    id[at] = '\0';
}

static void put_value(hp_vcd *vcd, unsigned i, uint64_t value) {
    char id[4], digits[65];
    name_signal(i, id);
    if (signals[i].bits == 1) {
        put(vcd, "%c%s\n", value ? '1' : '0', id);
        return;
    }
    unsigned n = 0;
    for (int bit = 63; bit >= 0; bit--)
        if (n || value >> bit & 1 || bit == 0) digits[n++] = value >> bit & 1 ? '1' : '0';
    digits[n] = '\0';
    put(vcd, "b%s %s\n", digits, id);
}

static void put_header(hp_vcd *vcd) {
    const char *scope = NULL;
    put(vcd, "$version hitpipe clocked engine $end\n$timescale 1 %s $end\n", vcd->unit == 1000000000 ? "ns" : "ps");
    put(vcd, "$scope module board $end\n");
    for (unsigned i = 0; i < SIGNALS; i++) {
        char id[4];
        name_signal(i, id);
        if (!scope || strcmp(scope, signals[i].scope) != 0) {
            if (scope) put(vcd, "$upscope $end\n");
            put(vcd, "$scope module %s $end\n", signals[i].scope);
        }
        scope = signals[i].scope;
        put(vcd, "$var wire %u %s %s $end\n", signals[i].bits, id, signals[i].name);
    }
    put(vcd, "$upscope $end\n$upscope $end\n$enddefinitions $end\n");
}

hp_vcd *hp_vcd_create(const hp_board *board) {
    hp_vcd *vcd = calloc(1, sizeof *vcd);
    if (!vcd) return NULL;
    vcd->sink = board->def.vcd;
    vcd->context = board->def.vcd_context;
    vcd->clock_hz = board->config.clock_hz;
    vcd->unit = 1000000000 % vcd->clock_hz == 0 ? 1000000000 : 1000000000000;
    put_header(vcd);
    return vcd;
}

static void put_time(hp_vcd *vcd, uint64_t clock) {
    put(vcd, "#%" PRIu64 "\n", (uint64_t)((unsigned __int128)clock * vcd->unit / vcd->clock_hz));
}

void hp_vcd_destroy(hp_vcd *vcd, const hp_board *board) {
    if (!vcd) return;
    put_time(vcd, board->clock);
    flush(vcd);
    free(vcd);
}

void hp_vcd_probe(hp_vcd *vcd, const hp_board *board) {
    const hp_clocked *c = board->state;
    const hp_secondary *oldest = c->secondary.count ? &c->secondary.entries[c->secondary.head] : NULL;
    hp_probe *p = &vcd->probe;
    bool tests = c->activity == HP_ACTIVITY_TESTS;
    *p = (hp_probe){.inbound = board->inbound, .answer = board->answers, .activity = c->activity};
    p->result = board->answers && board->answers->count;
    p->to_board = c->channel[HP_TO_BOARD].busy;
    p->to_host = c->channel[HP_TO_HOST].busy;
    p->packet = p->decoding = c->decoding;
    p->records = tests && hp_query_records_tests(board->query);
    p->wanted = tests && hp_secondary_wants(&c->secondary);
    p->tests = tests;
    p->rested = c->selector.rest == 0;
    p->test = tests && !c->selector.over && oldest && oldest->ready <= board->clock;
    p->output = tests && c->pipe.output.valid;
    p->record = (p->output && p->records) || (c->activity == HP_ACTIVITY_FLUSH && c->total > 0);
    p->level = c->secondary.count;
    p->held = c->sram.count;
}

/* A pipe that is not selected stands empty; the selected one takes a test in a clock in which it moves and its
 * interval has passed. */
static bool pipe_is_ready(const hp_board *board, const hp_probe *p, unsigned pair) {
    const hp_clocked *c = board->state;
    bool resident = board->config.pipes >> pair & 1;
    return resident && (!p->tests || board->query->pair != pair || (c->moved && p->rested));
}

static bool pipe_is_offered(const hp_board *board, const hp_probe *p, unsigned pair) {
    return p->test && board->query->pair == pair;
}

static uint64_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    return bits;
}

void hp_vcd_dump(hp_vcd *vcd, const hp_board *board) {
    const hp_clocked *c = board->state;
    const hp_probe *p = &vcd->probe;
    const uint64_t values[SIGNALS] = {
#define HP_SIGNAL(scope, name, bits, value) (uint64_t)(value),
#include "signals.def"
    };
    bool timed = false;
    if (!vcd->begun) put(vcd, "#0\n$dumpvars\n");
    for (unsigned i = 0; i < SIGNALS; i++) {
        if (vcd->begun && values[i] == vcd->values[i]) continue;
        if (vcd->begun && !timed) put_time(vcd, board->clock);
        timed = true;
        put_value(vcd, i, values[i]);
        vcd->values[i] = values[i];
    }
    if (!vcd->begun) put(vcd, "$end\n");
    vcd->begun = true;
}
