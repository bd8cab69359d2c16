#include "stream.h"
#include <stdlib.h>
#include <string.h>

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

static void shorten(stream_run *run, uint64_t clocks) {
    if (clocks < run->clocks) run->clocks = clocks;
}

hp_status hp_stream_create(hp_stream *stream, const hp_config *config, uint64_t latency_max) {
    *stream = (hp_stream){.config = config, .tests_room = latency_max + 2};
    stream->objects = malloc((config->secondary_depth + 1) * sizeof *stream->objects);
    stream->tests = malloc(stream->tests_room * sizeof *stream->tests);
    return stream->objects && stream->tests ? HP_OK : HP_ERROR_MEMORY;
}

void hp_stream_free(hp_stream *stream) {
    free(stream->objects);
    free(stream->tests);
}

/* ---- beginning ---- */

static void sort_hits(hp_stream *st) {
    for (unsigned p = 0; p < st->query->active; p++) {
        if (st->hit[p] == HP_NO_INDEX) continue;
        unsigned at = st->hits++;
        for (; at > 0; at--) {
            unsigned q = st->by_hit[at - 1];
            bool before = st->secondary_outer ? st->hit[q] <= st->hit[p]
                                              : q / st->lanes < p / st->lanes || st->hit[q] <= st->hit[p];
            if (before) break;
            st->by_hit[at] = q;
        }
        st->by_hit[at] = p;
    }
}

static void form_groups(hp_stream *st) {
    st->alive_all = st->query->active;
    for (unsigned g = 0; g < st->groups; g++) {
        unsigned left = st->query->active - g * st->lanes;
        st->order[g] = g;
        st->alive[g] = left < st->lanes ? left : st->lanes;
    }
}

void hp_stream_begin(hp_stream *st, hp_query *query, const uint32_t *hit, hp_stream_timing timing, uint64_t *sram) {
    const hp_config *config = st->config;
    bool zip = query->mode == HP_MODE_ZIP;
    *st = (hp_stream){.config = config, .objects = st->objects, .tests = st->tests, .tests_room = st->tests_room};
    st->query = query;
    st->hit = hit;
    st->sram = sram;
    st->secondary_outer = !zip && config->loop_order == HP_SECONDARY_OUTER;
    st->records_tests = hp_query_records_tests(query);
    st->beats = hp_object_beats(query->secondary);
    st->latency = timing.latency;
    st->interval = timing.interval;
    st->read_clocks = 1 + config->ddr_latency + (query->moved ? timing.transformer : 0);
    st->packet_records = hp_min(config->packet_results, config->sram_records);
    st->total = hp_query_records(query);
    st->lanes = zip ? 1 : (unsigned)config->lanes;
    st->groups = (query->active + st->lanes - 1) / st->lanes;
    if (st->groups == 1) st->secondary_outer = false; /* the loops are the same */
    st->sweeps = st->secondary_outer ? 1 : st->groups;
    st->per_sweep = zip ? 1 : query->count;
    st->start = timing.clock;
    st->streams = timing.clock + (timing.select ? config->selector_clocks : 0);
    st->phase = HP_STREAM_SELECT;
    form_groups(st);
    if (hit) sort_hits(st);
}

/* ---- secondary register file ---- */

static hp_object_run *objects_at(hp_stream *st, uint64_t i) {
    uint64_t at = st->objects_head + i, room = st->config->secondary_depth + 1;
    return &st->objects[at < room ? at : at - room];
}

static void push_objects(hp_stream *st, hp_object_run run) {
    if (st->objects_count && !run.refresh && !run.row) {
        hp_object_run *last = objects_at(st, st->objects_count - 1);
        if (last->ready + last->objects * st->beats == run.ready) {
            last->objects += run.objects;
            return;
        }
    }
    *objects_at(st, st->objects_count++) = run;
}

static void pop_objects(hp_stream *st, uint64_t n) {
    st->outstanding -= n;
    while (n) {
        hp_object_run *first = objects_at(st, 0);
        uint64_t some = hp_min(n, first->objects);
        first->objects -= some;
        first->ready += some * st->beats;
        first->refresh = first->row = 0;
        n -= some;
        if (first->objects) continue;
        st->objects_head = st->objects_head == st->config->secondary_depth ? 0 : st->objects_head + 1;
        st->objects_count--;
    }
}

/* ---- reader ---- */

static bool reads_left(const hp_stream *st) {
    return st->read_sweep < st->sweeps;
}

static uint64_t read_address(const hp_stream *st) {
    uint64_t first = hp_query_secondary(st->query, st->read_sweep, 0);
    return first * st->beats + st->read_beat;
}

/* Beats in a row that the reader wants while the selector does what `run` says. */
static uint64_t beats_wanted(const hp_stream *st, const stream_run *run) {
    if (!reads_left(st) || st->outstanding >= st->config->secondary_depth) return 0;
    uint64_t in_sweep = st->per_sweep * st->beats - st->read_beat;
    if (run->selector == SELECTOR_ISSUE && !st->secondary_outer && st->beats == 1) return in_sweep;
    uint64_t room = (st->config->secondary_depth - st->outstanding) * st->beats - st->read_beat % st->beats;
    return hp_min(in_sweep, room);
}

static void plan_ddr(hp_stream *st, uint64_t t, hp_ddr_runs *ddr, stream_run *run) {
    uint64_t wanted = beats_wanted(st, run);
    hp_ddr_run plan = hp_ddr_plan(ddr, t, wanted ? read_address(st) : 0, wanted);
    run->ddr = plan.state;
    shorten(run, plan.clocks);
    bool no_room = !wanted && reads_left(st);
    if (no_room && run->selector == SELECTOR_ISSUE && !st->secondary_outer) shorten(run, 1);
}

static void read_beats(hp_stream *st, uint64_t t, uint64_t n, hp_counters *counters) {
    uint64_t begun = st->read_beat % st->beats, objects = (begun + n) / st->beats;
    if (objects) {
        uint64_t ready = t + st->beats - begun - 1 + st->read_clocks;
        push_objects(st, (hp_object_run){ready, 1, st->refresh, st->row});
        if (objects > 1) push_objects(st, (hp_object_run){ready + st->beats, objects - 1, 0, 0});
        st->refresh = st->row = 0;
        st->outstanding += objects;
        if (st->query->moved) counters->clocks_transformer += objects;
    }
    st->read_beat += n;
    if (st->read_beat < st->per_sweep * st->beats) return;
    st->read_beat = 0;
    st->read_sweep++;
}

/* ---- waiting: which cause a clock without an object has ---- */

static void wait_for(uint64_t *refresh, uint64_t *row, uint64_t clocks, hp_counters *counters) {
    uint64_t by_refresh = hp_min(clocks, *refresh), by_row = hp_min(clocks - by_refresh, *row);
    *refresh -= by_refresh;
    *row -= by_row;
    counters->stalls_refresh += by_refresh;
    counters->stalls_row += by_row;
    counters->stalls_fill += clocks - by_refresh - by_row;
}

/* Counts a run's clocks of refresh and opening against the object being read, and what the selector waited. In a
 * clock that both holds up and waits, what holds up is there to be counted at once. */
static void count_waits(hp_stream *st, const stream_run *run, hp_counters *counters) {
    if (reads_left(st)) {
        if (run->ddr == HP_DDR_REFRESH) st->refresh += run->clocks;
        if (run->ddr == HP_DDR_ROW) st->row += run->clocks;
    }
    if (run->selector != SELECTOR_WAIT) return;
    hp_object_run *first = st->objects_count ? objects_at(st, 0) : NULL;
    if (first)
        wait_for(&first->refresh, &first->row, run->clocks, counters);
    else
        wait_for(&st->refresh, &st->row, run->clocks, counters);
}

/* ---- selector ---- */

/* Objects from the oldest on that can be issued one a clock from clock t on. */
static uint64_t objects_in_step(hp_stream *st, uint64_t t, const stream_run *run) {
    const hp_object_run *first = objects_at(st, 0);
    if (st->beats > 1) return hp_min(first->objects, (t - first->ready) / (st->beats - 1) + 1);
    bool fed =
        run->ddr == HP_DDR_BEAT && st->objects_count == 1 && first->ready + first->objects == t + st->read_clocks;
    return fed ? UINT64_MAX : first->objects;
}

static void plan_selector(hp_stream *st, uint64_t t, stream_run *run) {
    if (!run->moves) {
        run->selector = SELECTOR_HELD;
    } else if (st->over) {
        run->selector = SELECTOR_DRAIN;
    } else if (!st->objects_count || objects_at(st, 0)->ready > t) {
        run->selector = SELECTOR_WAIT;
        if (st->objects_count) shorten(run, objects_at(st, 0)->ready - t);
    } else if (t < st->issue_from) {
        run->selector = SELECTOR_INTERVAL;
        shorten(run, st->issue_from - t);
    } else {
        run->selector = SELECTOR_ISSUE;
    }
}

/* How long issuing, or waiting for the object being read, can go on. */
static void bound_selector(hp_stream *st, uint64_t t, stream_run *run) {
    if (run->selector == SELECTOR_WAIT && !st->objects_count && run->ddr == HP_DDR_BEAT)
        shorten(run, st->beats - st->read_beat % st->beats);
    if (run->selector != SELECTOR_ISSUE) return;
    if (st->interval > 1) shorten(run, 1);
    if (st->secondary_outer) {
        shorten(run, st->groups - st->group);
    } else {
        shorten(run, st->per_sweep - st->object);
        shorten(run, objects_in_step(st, t, run));
    }
}

static void push_tests(hp_stream *st, uint64_t exit, uint64_t tests, unsigned records) {
    if (st->tests_count) {
        uint64_t at = (st->tests_head + st->tests_count - 1) % st->tests_room;
        hp_test_run *last = &st->tests[at];
        if (last->exit + last->tests == exit && last->records == records) {
            last->tests += tests;
            return;
        }
    }
    st->tests[(st->tests_head + st->tests_count++) % st->tests_room] = (hp_test_run){exit, tests, records};
}

/* The stops that the tests of a run will bring: by_hit has them in the order of their issue. */
static void foresee_stops(hp_stream *st, uint64_t t, uint64_t n) {
    while (st->next_hit < st->hits) {
        unsigned p = st->by_hit[st->next_hit], g = p / st->lanes;
        uint64_t hit = st->hit[p], issued = t;
        if (st->secondary_outer) {
            if (hit != st->object || g > st->order[st->group + n - 1]) return;
            for (unsigned turn = st->group; st->order[turn] != g; turn++) issued++;
        } else {
            if (g != st->group || hit >= st->object + n) return;
            issued += hit - st->object;
        }
        st->stops[(st->stops_head + st->stops_count++) % HP_PACKET_PRIMARIES] = (hp_stop){issued + st->latency, p};
        st->next_hit++;
    }
}

static void next_object(hp_stream *st, uint64_t n) {
    pop_objects(st, n);
    st->object += n;
    if (st->object < st->per_sweep) return;
    st->object = 0;
    if (st->secondary_outer || ++st->group == st->groups) st->over = true;
}

/* Active primaries in the next n groups. */
static uint64_t alive_in_turns(const hp_stream *st, uint64_t n) {
    if (n == st->groups) return st->alive_all;
    uint64_t alive = 0;
    if (st->lanes == 1) return n;
    for (uint64_t i = 0; i < n; i++) alive += st->alive[st->order[st->group + i]];
    return alive;
}

/* Puts a run's tests into the pipe. Only the last group may have fewer primaries than lanes. */
static void push_issues(hp_stream *st, uint64_t exit, uint64_t n) {
    unsigned last = st->secondary_outer ? st->order[st->group + n - 1] : st->group;
    unsigned records = st->records_tests ? st->alive[last] : 0;
    if (st->records_tests && n > 1 && st->secondary_outer) {
        push_tests(st, exit, n - 1, st->lanes);
        push_tests(st, exit + n - 1, 1, records);
    } else {
        push_tests(st, exit, n, records);
    }
}

static void issue(hp_stream *st, uint64_t t, uint64_t n, hp_counters *counters) {
    uint64_t tests = 0, exit = st->moves + st->latency;
    if (st->hit) foresee_stops(st, t, n);
    push_issues(st, exit, n);
    if (st->secondary_outer) {
        tests = alive_in_turns(st, n);
        st->group += (unsigned)n;
        if (st->group == st->groups) {
            st->group = 0;
            next_object(st, 1);
        }
    } else {
        tests = n * st->alive[st->group];
        next_object(st, n);
    }
    st->exit = exit + n - 1;
    st->issue_from = t + n - 1 + st->interval;
    st->run += tests;
    counters->tests_run += tests;
    counters->clocks_issue += n;
}

/* ---- stops of mode any ---- */

static void drop_group(hp_stream *st) {
    st->objects_head = st->objects_count = 0;
    st->outstanding = 0;
    st->refresh = st->row = 0;
    st->read_beat = 0;
    st->object = 0;
    st->read_sweep = ++st->group;
    if (st->group == st->groups) st->over = true;
}

static void pass_over(hp_stream *st, unsigned g) {
    unsigned turn = 0;
    while (st->order[turn] != g) turn++;
    memmove(st->order + turn, st->order + turn + 1, (st->groups - turn - 1) * sizeof *st->order);
    st->groups--;
    if (turn < st->group) st->group--;
    if (st->groups == 0) {
        st->over = true;
        st->read_sweep = st->sweeps;
    } else if (st->group == st->groups) {
        st->group = 0;
        next_object(st, 1);
    }
}

static void stop_primaries(hp_stream *st, uint64_t clock) {
    while (st->stops_count && st->stops[st->stops_head].clock == clock) {
        unsigned g = st->stops[st->stops_head].primary / st->lanes;
        st->stops_head = (st->stops_head + 1) % HP_PACKET_PRIMARIES;
        st->stops_count--;
        st->alive_all--;
        if (--st->alive[g] || st->over) continue;
        if (st->secondary_outer)
            pass_over(st, g);
        else if (g == st->group)
            drop_group(st);
    }
}

/* ---- pipe, update engine, output register ---- */

static hp_test_run *oldest_tests(hp_stream *st) {
    return st->tests_count ? &st->tests[st->tests_head] : NULL;
}

/* Takes tests that leave the pipe before move `to`. *records are those of the one that leaves last, with move to - 1.
 */
static uint64_t leave_pipe(hp_stream *st, uint64_t to, unsigned *records) {
    uint64_t left = 0;
    *records = 0;
    for (hp_test_run *first; (first = oldest_tests(st)) && first->exit < to;) {
        uint64_t some = hp_min(first->tests, to - first->exit);
        *records = first->exit + some == to ? first->records : 0;
        left += some;
        first->exit += some;
        first->tests -= some;
        if (first->tests) break;
        st->tests_head = (st->tests_head + 1) % st->tests_room;
        st->tests_count--;
    }
    return left;
}

static uint64_t sram_room(const hp_stream *st) {
    uint64_t room = st->config->sram_records - *st->sram;
    return hp_min(room, st->packet_records - (st->written - st->known));
}

static void plan_output(hp_stream *st, uint64_t t, stream_run *run) {
    run->moves = true;
    if (!st->records_tests) {
        if (st->over) shorten(run, st->exit - st->moves + 1);
        if (st->stops_count) shorten(run, st->stops[st->stops_head].clock - t + 1);
        if (st->next_hit < st->hits) shorten(run, st->latency); /* before a test of this run can stop anything */
        return;
    }
    const hp_test_run *next = oldest_tests(st);
    if (st->output == 0) {
        shorten(run, next ? next->exit - st->moves : st->latency);
        return;
    }
    run->full = *st->sram == st->config->sram_records;
    run->writes = !run->full;
    run->moves = run->writes && st->output == 1;
    if (run->full) return;
    shorten(run, sram_room(st));
    if (!run->moves)
        shorten(run, st->output - 1);
    else
        shorten(run, next && next->exit == st->moves + 1 && next->records == 1 ? next->tests : 1);
}

static void write_records(hp_stream *st, uint64_t n, hp_counters *counters) {
    *st->sram += n;
    st->written += n;
    counters->clocks_sram += n;
}

/* Everything behind the selector. Tests are in the output register after the move before their exit: in the clocks of
 * move `exit` they are the update engine's or the register's. */
static void move_pipe(hp_stream *st, const stream_run *run, hp_counters *counters) {
    uint64_t n = run->clocks, inside = st->exit > st->moves ? st->exit - st->moves : 0;
    unsigned records;
    counters->clocks_pipe += run->moves ? hp_min(n, inside) : inside ? n : 0;
    if (!st->records_tests) {
        counters->clocks_update += leave_pipe(st, st->moves + n, &records);
        st->moves += n;
        return;
    }
    if (run->writes) write_records(st, n, counters);
    if (!run->moves) {
        st->output -= run->writes ? n : 0;
        return;
    }
    st->moves += n;
    leave_pipe(st, st->moves + 1, &records);
    st->output = records;
}

/* ---- the run ---- */

static void count_stalls(const stream_run *run, hp_counters *counters) {
    switch (run->selector) {
    case SELECTOR_INTERVAL:
        counters->stalls_fill += run->clocks;
        break;
    case SELECTOR_DRAIN:
        counters->stalls_drain += run->clocks;
        break;
    case SELECTOR_HELD:
        *(run->full ? &counters->stalls_sram_full : &counters->stalls_sram_port) += run->clocks;
        break;
    case SELECTOR_ISSUE:
    case SELECTOR_WAIT:
        break;
    }
}

static uint64_t test_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    stream_run run = {.clocks = to - t};
    plan_output(st, t, &run);
    plan_selector(st, t, &run);
    plan_ddr(st, t, ddr, &run);
    bound_selector(st, t, &run);
    uint64_t n = run.clocks;
    hp_ddr_count(counters, run.ddr, n, false);
    count_waits(st, &run, counters);
    count_stalls(&run, counters);
    if (run.ddr == HP_DDR_BEAT) read_beats(st, t, n, counters);
    if (run.selector == SELECTOR_ISSUE) issue(st, t, n, counters);
    move_pipe(st, &run, counters);
    if (st->stops_count) stop_primaries(st, t + n - 1);
    if (st->over && !st->tests_count && !st->output) st->phase = st->records_tests ? HP_STREAM_END : HP_STREAM_FLUSH;
    return t + n;
}

/* ---- steady issuing: what nearly all clocks of a secondary-outer query are like ----
 *
 * The register file is full, so an object is read for each one released, and every object is ready long before its
 * turn: the selector never waits. Each object takes a window of one clock a group, in which the controller reads its
 * successor and does what else is due. */

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
static uint64_t steady_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
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
    push_tests(st, st->moves + st->latency, run.clocks, 0);
    st->exit = st->moves + st->latency + run.clocks - 1;
    st->issue_from = t + run.clocks;
    move_pipe(st, &run, counters);
    return t + run.clocks;
}

/* ---- lockstep: what nearly all clocks of a primary-outer query are like ----
 *
 * Each object is issued once, read_clocks after it is read: the selector waits as long as the controller does not
 * read, and for the same cause. So the controller's time tells all, up to a clock before which it has read long
 * enough without a gap for register file and pipe to hold nothing else. */

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
    push_tests(st, st->moves, st->latency, 0);
    objects_at(st, 0)->ready = to->clock;
}

static uint64_t lockstep_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
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

static uint64_t tests_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    uint64_t steady = steady_run(st, t, to, ddr, counters);
    if (steady == t) steady = lockstep_run(st, t, to, ddr, counters);
    return steady > t ? steady : test_run(st, t, to, ddr, counters);
}

static uint64_t select_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    uint64_t n = hp_min(st->streams, to) - t;
    hp_ddr_pass(ddr, t, t + n, counters);
    counters->stalls_select += n;
    if (t + n == st->streams) {
        bool streams = st->query->active > 0 && st->query->count > 0;
        bool ends = st->total == 0 && t + n > st->start;
        st->phase = streams ? HP_STREAM_TESTS : ends ? HP_STREAM_END : HP_STREAM_FLUSH;
    }
    return t + n;
}

static uint64_t flush_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    uint64_t n = 0;
    if (st->written == st->total) { /* a query never ends in the clock in which it began */
        if (t == st->start) counters->stalls_drain += n = 1;
    } else if (*st->sram == st->config->sram_records) {
        counters->stalls_sram_full += n = to - t;
    } else {
        n = hp_min(hp_min(st->total - st->written, sram_room(st)), to - t);
        write_records(st, n, counters);
        counters->stalls_flush += n;
    }
    hp_ddr_pass(ddr, t, t + n, counters);
    if (st->written == st->total) st->phase = HP_STREAM_END;
    return t + n;
}

uint64_t hp_stream_advance(hp_stream *st, uint64_t from, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    uint64_t t = from;
    while (t < to && !hp_stream_ended(st) && !hp_stream_packet(st)) {
        switch (st->phase) {
        case HP_STREAM_SELECT:
            t = select_run(st, t, to, ddr, counters);
            break;
        case HP_STREAM_TESTS:
            t = tests_run(st, t, to, ddr, counters);
            break;
        default:
            t = flush_run(st, t, to, ddr, counters);
            break;
        }
    }
    return t;
}
