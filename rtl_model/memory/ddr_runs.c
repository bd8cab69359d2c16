#include "ddr_runs.h"

/* Refreshes with nothing else to do begin in every multiple of the interval: all but the last few in one step. */
static uint64_t pass_whole_intervals(hp_ddr_runs *ddr, uint64_t from, uint64_t to, hp_counters *counters) {
    if (from < ddr->until || from != ddr->due || from % ddr->interval || to - from < 2 * ddr->interval) return from;
    uint64_t n = (to - from) / ddr->interval - 1;
    counters->clocks_ddr_refresh += n * ddr->refresh_clocks;
    ddr->open_row = HP_NO_ROW;
    ddr->due += n * ddr->interval;
    return from + n * ddr->interval;
}

void hp_ddr_pass(hp_ddr_runs *ddr, uint64_t from, uint64_t to, hp_counters *counters) {
    while (from < to) {
        from = pass_whole_intervals(ddr, from, to, counters);
        hp_ddr_run run = hp_ddr_plan(ddr, from, 0, 0);
        uint64_t clocks = hp_min(run.clocks, to - from);
        hp_ddr_count(counters, run.state, clocks, false);
        from += clocks;
    }
}
