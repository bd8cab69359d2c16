#include "stream_parts.h"
#include <stdlib.h>
#include <string.h>

static void shorten(stream_run *run, uint64_t clocks) {
    if (clocks < run->clocks) run->clocks = clocks;
}

hp_status hp_stream_create(hp_stream *stream, const hp_config *config) {
    *stream = (hp_stream){.config = config};
    stream->objects = malloc((config->secondary_depth + 1) * sizeof *stream->objects);
    return stream->objects ? HP_OK : HP_ERROR_MEMORY;
}

hp_status hp_stream_reserve(hp_stream *stream, uint64_t latency) {
    if (latency + 2 <= stream->tests_room) return HP_OK;
    hp_test_run *tests = realloc(stream->tests, (latency + 2) * sizeof *tests);
    if (!tests) return HP_ERROR_MEMORY;
    stream->tests = tests;
    stream->tests_room = latency + 2;
    return HP_OK;
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

void hp_stream_push_tests(hp_stream *st, uint64_t exit, uint64_t tests, unsigned records) {
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
        hp_stream_push_tests(st, exit, n - 1, st->lanes);
        hp_stream_push_tests(st, exit + n - 1, 1, records);
    } else {
        hp_stream_push_tests(st, exit, n, records);
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
void hp_stream_move_pipe(hp_stream *st, const stream_run *run, hp_counters *counters) {
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
    hp_stream_move_pipe(st, &run, counters);
    if (st->stops_count) stop_primaries(st, t + n - 1);
    if (st->over && !st->tests_count && !st->output) st->phase = st->records_tests ? HP_STREAM_END : HP_STREAM_FLUSH;
    return t + n;
}

static uint64_t tests_run(hp_stream *st, uint64_t t, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters) {
    uint64_t steady = hp_steady_run(st, t, to, ddr, counters);
    if (steady == t) steady = hp_lockstep_run(st, t, to, ddr, counters);
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
