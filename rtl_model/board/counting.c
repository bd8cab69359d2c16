#include "internal.h"

void hp_board_count(hp_board *board, hp_busy busy, uint64_t clocks) {
    hp_counters *counters = &board->counters;
    bool query = busy.command && board->command.opcode == HP_OPCODE_QUERY;
    counters->clocks_total += clocks;
    if (busy.command) board->busy_clocks += clocks;
    if (busy.to_board) counters->clocks_link_to_board += clocks;
    if (busy.to_host) counters->clocks_link_to_host += clocks;
    if (busy.decoder) counters->clocks_decoder += clocks;
    if (!busy.command) counters->stalls_idle += clocks;
    if (busy.command && !query) counters->stalls_command += clocks;
    if (query)
        counters->phase_compute += clocks;
    else if (busy.to_host)
        counters->phase_read_back += clocks;
    else if (busy.to_board || busy.decoder || busy.command)
        counters->phase_upload += clocks;
    else
        counters->phase_idle += clocks;
}

void hp_query_end(hp_board *board, uint64_t known, uint64_t written, uint64_t tests_run) {
    uint64_t per_primary = board->query->mode == HP_MODE_ZIP ? 1 : board->query->count;
    board->counters.tests_skipped += board->query->primaries * per_primary - tests_run;
    hp_result_known(board, known, (uint32_t)(written - known), true);
}
