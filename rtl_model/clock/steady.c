/* Steady issuing: what nearly all clocks of a secondary-outer query are like.
 *
 * The register file is full, so an object is read for each one released, and every object is ready long before its
 * turn: the selector never waits. Each object takes a window of one clock a group, in which the controller reads its
 * successor and does what else is due. */
#include "stream_parts.h"

typedef struct window {
    uint64_t clocks, beats;
    uint64_t refresh, row;           /* clocks counted in all windows */
    uint64_t held_refresh, held_row; /* since the last object was read */
} window;

/* Objects from clock t on, one a window, that are certain to be ready: the entries now in the file, and all that will
 * be read into it. */
static bool ready_in_time(hp_stream *st, uint64_t t, uint64_t clocks) {
    if (st->beats > clocks || st->read_clocks - 1 > (st->config->secondary_depth - 2) * clocks) return false;
    uint64_t turn = t;
    for (uint64_t i = 0; i < st->objects_count; i++) {
        const hp_object_run *run = objects_at(st, i);
        if (run->ready > turn) return false;
        turn += run->objects * clocks;
    }
    return true;
}

/* Windows to be taken from clock t on; 0: none. */
static uint64_t steady_windows(hp_stream *st, uint64_t t, uint64_t to) {
    if (!st->secondary_outer || st->records_tests || st->interval > 1 || st->group || st->over || st->stops_count)
        return 0;
    if (!reads_left(st) || st->outstanding + 1 != st->config->secondary_depth || st->read_beat % st->beats) return 0;
    if (t < st->issue_from) return 0;
    uint64_t n = hp_min((to - t) / st->groups, st->per_sweep - st->read_beat / st->beats);
    if (st->next_hit < st->hits) n = hp_min(n, st->hit[st->by_hit[st->next_hit]] - st->object);
    return n > 1 && ready_in_time(st, t, st->groups) ? n : 0;
}

/* The common window: the object is read at once, or after its row was opened, and at most one refresh follows. */
static bool plain_window(hp_ddr_runs *ddr, uint64_t t, uint64_t row, window *w) {
    uint64_t opening = row == ddr->open_row ? 0 : ddr->row_clocks, end = t + w->clocks;
    if (t < ddr->until || t + opening + w->beats > hp_min(ddr->due, end)) return false;
    if (ddr->due < end && (ddr->due + ddr->refresh_clocks > end || ddr->due + ddr->interval < end)) return false;
    ddr->open_row = row;
    w->row += opening;
    w->held_refresh = w->held_row = 0;
    if (ddr->due >= end) return true;
    ddr->open_row = HP_NO_ROW;
    ddr->due += ddr->interval;
    w->refresh += ddr->refresh_clocks;
    w->held_refresh = ddr->refresh_clocks;
    return true;
}

/* Any window. False, and the controller as it was: the object cannot be read within it. */
static bool crowded_window(hp_ddr_runs *ddr, uint64_t t, uint64_t beat, window *w) {
    hp_ddr_runs now = *ddr;
    window counted = *w;
    uint64_t end = t + w->clocks, left = w->beats;
    while (t < end) {
        hp_ddr_run run = hp_ddr_plan(&now, t, beat, left);
        uint64_t clocks = hp_min(run.clocks, end - t);
        counted.refresh += run.state == HP_DDR_REFRESH ? clocks : 0;
        counted.row += run.state == HP_DDR_ROW ? clocks : 0;
        counted.held_refresh += run.state == HP_DDR_REFRESH ? clocks : 0;
        counted.held_row += run.state == HP_DDR_ROW ? clocks : 0;
        if (run.state == HP_DDR_BEAT) {
            beat += clocks;
            left -= clocks;
            if (left == 0) counted.held_refresh = counted.held_row = 0;
        }
        t += clocks;
    }
    if (left) return false;
    *ddr = now;
    *w = counted;
    return true;
}

static uint64_t read_in_windows(hp_stream *st, uint64_t t, uint64_t n, hp_ddr_runs *ddr, window *w) {
    uint64_t beat = read_address(st), row = beat / ddr->row_beats, row_end = (row + 1) * ddr->row_beats, done = 0;
    for (; done < n; done++, t += w->clocks, beat += w->beats) {
        if (beat >= row_end) {
            row = beat / ddr->row_beats;
            row_end = (row + 1) * ddr->row_beats;
        }
        if (beat + w->beats <= row_end && plain_window(ddr, t, row, w)) continue;
        if (!crowded_window(ddr, t, beat, w)) break;
    }
    return done;
}

/* Takes as many windows as it can; returns the clock after them, t when there was none. */
uint64_t hp_steady_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    uint64_t n = steady_windows(st, t, to);
    if (n == 0) return t;
    window w = {.clocks = st->groups, .beats = st->beats, .held_refresh = st->refresh, .held_row = st->row};
    n = read_in_windows(st, t, n, ddr, &w);
    if (n == 0) return t;
    stream_run run = {.clocks = n * st->groups, .moves = true};
    counters->clocks_ddr_read += n * st->beats;
    counters->clocks_ddr_refresh += w.refresh;
    counters->clocks_ddr_row += w.row;
    counters->clocks_transformer += st->query->moved ? n : 0;
    counters->clocks_issue += run.clocks;
    counters->tests_run += n * st->alive_all;
    st->run += n * st->alive_all;
    st->refresh = w.held_refresh;
    st->row = w.held_row;
    st->read_beat += n * st->beats;
    if (st->read_beat == st->per_sweep * st->beats) st->read_beat = 0, st->read_sweep++;
    st->object += n;
    st->objects_head = 0;
    st->objects_count = 1;
    st->objects[0] = (hp_object_run){.ready = 0, .objects = st->outstanding};
    hp_stream_push_tests(st, st->moves + st->latency, run.clocks, 0);
    st->exit = st->moves + st->latency + run.clocks - 1;
    st->issue_from = t + run.clocks;
    hp_stream_move_pipe(st, &run, counters);
    return t + run.clocks;
}
