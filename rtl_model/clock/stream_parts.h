/* What the parts of a stream share: stream.c, which takes any run, and steady.c and lockstep.c, which take the common
 * ones at once. */
#ifndef HITPIPE_STREAM_PARTS_H
#define HITPIPE_STREAM_PARTS_H

#include "stream.h"

/* What the selector does in a run. */
typedef enum selector_state {
    SELECTOR_ISSUE,
    SELECTOR_WAIT,
    SELECTOR_INTERVAL,
    SELECTOR_HELD,
    SELECTOR_DRAIN
} selector_state;

typedef struct stream_run {
    uint64_t clocks;
    selector_state selector;
    hp_ddr_state ddr;
    bool moves, writes, full;
} stream_run;

/* Run i of the objects in the secondary register file, from the oldest on. */
static inline hp_object_run *objects_at(hp_stream *st, uint64_t i) {
    uint64_t at = st->objects_head + i, room = st->config->secondary_depth + 1;
    return &st->objects[at < room ? at : at - room];
}

static inline bool reads_left(const hp_stream *st) {
    return st->read_sweep < st->sweeps;
}

static inline uint64_t read_address(const hp_stream *st) {
    uint64_t first = hp_query_secondary(st->query, st->read_sweep, 0);
    return first * st->beats + st->read_beat;
}

/* Puts tests into the pipe, one a move, the first to leave it with move `exit`. */
void hp_stream_push_tests(hp_stream *st, uint64_t exit, uint64_t tests, unsigned records);

/* A run of everything behind the selector. */
void hp_stream_move_pipe(hp_stream *st, const stream_run *run, hp_counters *counters);

/* Both take as much as they can from clock t on, and return the clock after it: t when there was nothing for them. */
uint64_t hp_steady_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters);
uint64_t hp_lockstep_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters);

#endif
