/* The DDR controller of the quick engine: what it does from a clock on, and for how many clocks it keeps to that. */
#ifndef HITPIPE_DDR_RUNS_H
#define HITPIPE_DDR_RUNS_H

#include "ddr.h"
#include <hitpipe/counters.h>

typedef struct hp_ddr_runs {
    uint64_t until;    /* a refresh or an opening goes on up to this clock (exclusive) */
    hp_ddr_state busy; /* which of them */
    uint64_t open_row;
    uint64_t due;            /* first clock in which the next refresh may begin: a multiple of the interval */
    uint64_t row, row_first; /* the row looked at last, and its first beat */
    uint64_t row_beats, row_clocks, interval, refresh_clocks;
} hp_ddr_runs;

typedef struct hp_ddr_run {
    hp_ddr_state state;
    uint64_t clocks;
} hp_ddr_run;

static inline hp_ddr_runs hp_ddr_runs_reset(const hp_config *config) {
    return (hp_ddr_runs){.open_row = HP_NO_ROW,
                         .due = config->ddr_refresh_clocks ? config->ddr_refresh_interval : UINT64_MAX,
                         .row_beats = config->ddr_row_beats,
                         .row_clocks = config->ddr_row_clocks,
                         .interval = config->ddr_refresh_interval,
                         .refresh_clocks = config->ddr_refresh_clocks};
}

static inline uint64_t hp_min(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

/* The row of a beat. Divisions are dear and beats come in order, so the last row is tried first. */
static inline uint64_t hp_ddr_row(hp_ddr_runs *ddr, uint64_t beat) {
    if (beat - ddr->row_first >= ddr->row_beats) {
        ddr->row = beat / ddr->row_beats;
        ddr->row_first = ddr->row * ddr->row_beats;
    }
    return ddr->row;
}

/* The run that begins in clock t when `beats` beats from `beat` on are wanted (0: none). A refresh or an opening that
 * begins in t begins by this call. */
static inline hp_ddr_run hp_ddr_plan(hp_ddr_runs *ddr, uint64_t t, uint64_t beat, uint64_t beats) {
    if (t < ddr->until) return (hp_ddr_run){ddr->busy, ddr->until - t};
    if (t >= ddr->due) {
        ddr->due += ddr->interval;
        if (t >= ddr->due) ddr->due = (t / ddr->interval + 1) * ddr->interval;
        ddr->open_row = HP_NO_ROW;
        ddr->busy = HP_DDR_REFRESH;
        ddr->until = t + ddr->refresh_clocks;
        return (hp_ddr_run){HP_DDR_REFRESH, ddr->refresh_clocks};
    }
    if (beats == 0) return (hp_ddr_run){HP_DDR_IDLE, ddr->due - t};
    uint64_t row = hp_ddr_row(ddr, beat);
    if (row != ddr->open_row) {
        ddr->open_row = row;
        if (ddr->row_clocks) {
            ddr->busy = HP_DDR_ROW;
            ddr->until = t + ddr->row_clocks;
            return (hp_ddr_run){HP_DDR_ROW, ddr->row_clocks};
        }
    }
    uint64_t in_row = ddr->row_first + ddr->row_beats - beat;
    return (hp_ddr_run){HP_DDR_BEAT, hp_min(hp_min(beats, in_row), ddr->due - t)};
}

static inline void hp_ddr_count(hp_counters *counters, hp_ddr_state state, uint64_t clocks, bool write) {
    switch (state) {
    case HP_DDR_ROW:
        counters->clocks_ddr_row += clocks;
        break;
    case HP_DDR_REFRESH:
        counters->clocks_ddr_refresh += clocks;
        break;
    case HP_DDR_BEAT:
        *(write ? &counters->clocks_ddr_write : &counters->clocks_ddr_read) += clocks;
        break;
    case HP_DDR_IDLE:
        break;
    }
}

/* Clocks [from, to) in which nothing is wanted: only refreshes. */
void hp_ddr_pass(hp_ddr_runs *ddr, uint64_t from, uint64_t to, hp_counters *counters);

#endif
