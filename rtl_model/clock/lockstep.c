/* Lockstep: what nearly all clocks of a primary-outer query are like.
 *
 * Each object is issued once, read_clocks after it is read: the selector waits as long as the controller does not
 * read, and for the same cause. So the controller's time tells all, up to a clock before which it has read long
 * enough without a gap for register file and pipe to hold nothing else. */
#include "stream_parts.h"

typedef struct lockstep {
    hp_ddr_runs ddr;
    uint64_t clock, reads, beat; /* beat: of the present sweep */
    unsigned sweep;
    uint64_t refresh, row, empty; /* clocks of refresh, of opening; with no test in the pipe */
    uint64_t gap, together;       /* clocks without, or with a read, up to the present one */
} lockstep;

static bool in_lockstep(hp_stream *st, uint64_t t) {
    if (st->secondary_outer || st->records_tests || st->hit || st->beats > 1 || st->interval > 1 || st->loose)
        return false;
    if (st->over || !reads_left(st) || st->read_clocks >= st->config->secondary_depth) return false;
    if (st->objects_count != 1 || st->refresh || st->row) return false;
    const hp_object_run *first = objects_at(st, 0);
    return first->ready == t && first->objects == st->read_clocks && !first->refresh && !first->row;
}

/* The controller's next run. */
static void read_on(hp_stream *st, lockstep *now, uint64_t to) {
    uint64_t address = (uint64_t)st->query->first + now->beat;
    hp_ddr_run run = hp_ddr_plan(&now->ddr, now->clock, address, st->per_sweep - now->beat);
    uint64_t n = hp_min(run.clocks, to - now->clock);
    now->clock += n;
    if (run.state != HP_DDR_BEAT) {
        *(run.state == HP_DDR_ROW ? &now->row : &now->refresh) += n;
        now->gap += n;
        now->together = 0;
        return;
    }
    if (now->gap + 1 > st->latency) now->empty += now->gap + 1 - st->latency;
    now->gap = 0;
    now->together += n;
    now->reads += n;
    now->beat += n;
    if (now->beat < st->per_sweep) return;
    now->beat = 0;
    now->sweep++;
}

/* Tests among the first `issues` of the query. */
static uint64_t tests_in(const hp_stream *st, uint64_t issues) {
    uint64_t group = issues / st->per_sweep, in_group = issues % st->per_sweep;
    uint64_t before = hp_min(group * st->lanes, st->query->active);
    return before * st->per_sweep + (in_group ? in_group * st->alive[group] : 0);
}

static void take_lockstep(hp_stream *st, uint64_t t, const lockstep *to, hp_counters *counters) {
    uint64_t before = st->group * st->per_sweep + st->object, after = before + to->reads;
    uint64_t tests = tests_in(st, after) - tests_in(st, before), in_pipe = 0;
    for (uint64_t i = 0; i < st->tests_count; i++) in_pipe += st->tests[(st->tests_head + i) % st->tests_room].tests;
    counters->clocks_ddr_read += to->reads;
    counters->clocks_ddr_refresh += to->refresh;
    counters->clocks_ddr_row += to->row;
    counters->clocks_transformer += st->query->moved ? to->reads : 0;
    counters->clocks_issue += to->reads;
    counters->stalls_refresh += to->refresh;
    counters->stalls_row += to->row;
    counters->clocks_pipe += to->clock - t - to->empty;
    counters->clocks_update += in_pipe + to->reads - st->latency;
    counters->tests_run += tests;
    st->run += tests;
    st->read_sweep = to->sweep;
    st->read_beat = to->beat;
    st->group = (unsigned)(after / st->per_sweep);
    st->object = after % st->per_sweep;
    st->issue_from = to->clock;
    st->moves += to->clock - t;
    st->exit = st->moves + st->latency - 1;
    st->tests_count = 0;
    hp_stream_push_tests(st, st->moves, st->latency, 0);
    objects_at(st, 0)->ready = to->clock;
}

uint64_t hp_lockstep_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    enum { RUNS_MOST = 64 }; /* without a long one: this memory is not worth it */
    uint64_t whole = st->read_clocks + st->latency + 1;
    if (!in_lockstep(st, t) || to - t < whole) return t;
    lockstep now = {.ddr = *ddr, .clock = t, .beat = st->read_beat, .sweep = st->read_sweep}, last = now;
    for (unsigned runs = 0; now.clock < to && now.sweep < st->sweeps && runs < RUNS_MOST; runs++) {
        read_on(st, &now, to);
        if (now.together < whole) continue;
        last = now;
        runs = 0;
    }
    if (last.clock == t) {
        st->loose = now.clock < to;
        return t;
    }
    *ddr = last.ddr;
    take_lockstep(st, t, &last, counters);
    return last.clock;
}
