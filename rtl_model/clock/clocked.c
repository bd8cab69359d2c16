/* The clocked engine: the truth about time. In each clock every block decides on what it saw at the end of the clock
 * before; objects, tests and records move from block to block as they do on the board. */
#include "vcd.h"
#include <hitpipe/pipe.h>
#include <stdlib.h>

/* ---- what begins in the present clock ---- */

static void begin_decoding(hp_board *board) {
    hp_clocked *c = board->state;
    if (c->decoding || board->held_count == c->decoded + (c->activity != HP_ACTIVITY_NONE)) return;
    c->decoding = true;
    c->decode_left = board->config.decoder_clocks;
}

/* From clock s on: streams, or goes on to the end of the query if there is nothing to stream. */
static void begin_streaming(hp_board *board) {
    hp_clocked *c = board->state;
    bool ends = c->total == 0 && board->clock > c->query_start;
    c->activity = !c->selector.over ? HP_ACTIVITY_TESTS : ends ? HP_ACTIVITY_ENDED : HP_ACTIVITY_FLUSH;
}

static void begin_query(hp_board *board) {
    hp_clocked *c = board->state;
    hp_query *query = board->query;
    c->total = hp_query_records(query);
    hp_pipe_times pipe = hp_board_pipe(board, query);
    if (!pipe.clocks || hp_sram_reserve(&c->sram, c->sram.count + c->total) != HP_OK ||
        hp_delay_line_begin(&c->pipe, pipe.clocks, (unsigned)board->config.lanes) != HP_OK) {
        hp_query_refuse(board);
        return;
    }
    hp_selector_begin(&c->selector, query, &board->config, pipe.interval);
    hp_secondary_begin(&c->secondary, query, hp_selector_sweeps(&c->selector),
                       board->transformer_clocks[query->secondary]);
    hp_update_begin(&c->update, query);
    c->flushed = c->output_left = 0;
    c->written = c->known = c->tests_run = 0;
    c->query_start = board->clock;
    bool other = board->session.selected != hp_selection(query);
    board->session.selected = hp_selection(query);
    c->activity = HP_ACTIVITY_SELECT;
    c->left = other ? board->config.selector_clocks : 0;
    if (c->left == 0) begin_streaming(board);
}

static void begin_command(hp_board *board) {
    hp_clocked *c = board->state;
    if (c->activity != HP_ACTIVITY_NONE || !c->decoded) return;
    c->decoded--;
    hp_command_begin(board);
    c->activity = HP_ACTIVITY_COMMAND;
    c->left = board->command.opcode == HP_OPCODE_TRANSFORM ? 2 : 1;
    if (board->command.opcode == HP_OPCODE_QUERY) begin_query(board);
    if (board->command.opcode != HP_OPCODE_UPLOAD || hp_upload_count(&board->command) == 0) return;
    unsigned beats = hp_object_beats(board->session.object);
    c->activity = HP_ACTIVITY_WRITE;
    c->write_beat = (uint64_t)hp_upload_first(&board->command) * beats;
    c->write_left = (uint64_t)hp_upload_count(&board->command) * beats;
}

static void begin_transfers(hp_board *board) {
    hp_clocked *c = board->state;
    bool waits[HP_DIRECTIONS] = {board->inbound != NULL, board->answers != NULL};
    bool busy[HP_DIRECTIONS] = {c->channel[HP_TO_BOARD].busy, c->channel[HP_TO_HOST].busy}, grant[HP_DIRECTIONS];
    if (!((waits[0] && !busy[0]) || (waits[1] && !busy[1]))) return;
    hp_link_grant(&board->config, waits, busy, grant);
    for (int d = 0; d < HP_DIRECTIONS; d++) {
        if (!grant[d]) continue;
        size_t n = d == HP_TO_BOARD ? board->inbound->n : hp_answer_bytes(board->answers);
        c->channel[d] = (hp_channel){true, hp_link_clocks(&board->config, (hp_direction)d, n), n};
    }
}

/* ---- one clock of the blocks ---- */

static void tick_ddr(hp_board *board) {
    hp_clocked *c = board->state;
    bool tests = c->activity == HP_ACTIVITY_TESTS, write = c->activity == HP_ACTIVITY_WRITE;
    bool read = tests && hp_secondary_wants(&c->secondary);
    uint64_t beat = write ? c->write_beat : read ? hp_secondary_address(&c->secondary) : 0;
    bool moved = hp_controller_tick(&c->ddr, read || write, beat);
    c->took = false;
    if (tests) hp_secondary_held_up(&c->secondary, c->ddr.state);
    if (moved && read) c->took = hp_secondary_take(&c->secondary, board->clock);
    if (moved && write) {
        c->write_beat++;
        c->write_left--;
    }
}

static void write_record(hp_clocked *c, hp_result record) {
    hp_sram_write(&c->sram, &record);
    c->written++;
    c->wrote = true;
}

/* The output register of `all` and `zip`: a record a clock. Returns whether the pipe moves. */
static bool tick_output(hp_clocked *c) {
    const hp_stage *output = &c->pipe.output;
    if (!output->valid) return true;
    if (c->full) return false;
    write_record(c, output->results[output->lanes - c->output_left]);
    return --c->output_left == 0;
}

/* The update engine of `closest` and `any`. Returns the lanes whose primaries stop. */
static uint64_t tick_update(hp_clocked *c) {
    const hp_stage *output = &c->pipe.output;
    if (!output->valid) return 0;
    c->updated = true;
    return hp_update_take(&c->update, output->first, output->lanes, output->tested, output->index, output->results);
}

static void issue_test(hp_board *board) {
    hp_clocked *c = board->state;
    const hp_query *query = board->query;
    const hp_secondary *secondary = hp_secondary_oldest(&c->secondary);
    hp_stage *stage = hp_delay_line_entry(&c->pipe);
    stage->valid = true;
    stage->first = hp_selector_first(&c->selector);
    stage->lanes = hp_selector_size(&c->selector);
    stage->index = secondary->index;
    stage->tested = 0;
    for (unsigned lane = 0; lane < stage->lanes; lane++) {
        unsigned primary = stage->first + lane;
        if (c->selector.stopped[primary]) continue;
        stage->tested |= UINT64_C(1) << lane;
        stage->results[lane] = hp_pipe_test(query->pair, (hp_subnormals)board->config.subnormals, query->separation,
                                            hp_query_primary(query, primary), secondary->words, secondary->index);
        c->tests_run++;
        board->counters.tests_run++;
    }
    c->issued = true;
    hp_selector_issued(&c->selector, &c->secondary);
}

static hp_stall waiting_for(hp_ddr_state cause) {
    return cause == HP_DDR_REFRESH ? HP_STALL_refresh : cause == HP_DDR_ROW ? HP_STALL_row : HP_STALL_fill;
}

static hp_stall tick_selector(hp_board *board) {
    hp_clocked *c = board->state;
    bool rested = c->selector.rest == 0;
    if (!rested) c->selector.rest--;
    if (!c->moved) return c->full ? HP_STALL_sram_full : HP_STALL_sram_port;
    if (c->selector.over) return HP_STALL_drain;
    const hp_secondary *oldest = hp_secondary_oldest(&c->secondary);
    if (!oldest || oldest->ready > board->clock) return waiting_for(hp_secondary_wait(&c->secondary));
    if (!rested) return HP_STALL_fill;
    issue_test(board);
    return HP_STALL_none;
}

static void stop_primaries(hp_clocked *c, unsigned first, uint64_t lanes) {
    for (; lanes; lanes >>= 1, first++)
        if (lanes & 1) c->selector.stopped[first] = true;
    hp_selector_pass_over(&c->selector, &c->secondary);
}

static hp_stall tick_tests(hp_board *board) {
    hp_clocked *c = board->state;
    bool records = hp_query_records_tests(board->query);
    unsigned first = c->pipe.output.first;
    uint64_t stops = records ? 0 : tick_update(c);
    c->moved = records ? tick_output(c) : true;
    hp_stall stall = tick_selector(board);
    if (c->pipe.inside || c->issued) board->counters.clocks_pipe++;
    if (c->moved) {
        hp_delay_line_move(&c->pipe);
        if (c->pipe.output.valid) c->output_left = c->pipe.output.lanes;
    }
    if (stops) stop_primaries(c, first, stops);
    if (c->selector.over && !c->pipe.inside && !c->pipe.output.valid)
        c->activity = records ? HP_ACTIVITY_ENDED : HP_ACTIVITY_FLUSH;
    return stall;
}

static hp_stall tick_flush(hp_clocked *c) {
    if (c->total > 0 && c->full) return HP_STALL_sram_full;
    if (c->total > 0) write_record(c, hp_update_record(&c->update, c->flushed++));
    if (c->flushed == c->total) c->activity = HP_ACTIVITY_ENDED;
    return c->total > 0 ? HP_STALL_flush : HP_STALL_drain;
}

static hp_stall tick_activity(hp_board *board) {
    hp_clocked *c = board->state;
    switch (c->activity) {
    case HP_ACTIVITY_SELECT:
        c->left--;
        return HP_STALL_select;
    case HP_ACTIVITY_TESTS:
        return tick_tests(board);
    case HP_ACTIVITY_FLUSH:
        return tick_flush(c);
    case HP_ACTIVITY_COMMAND:
        c->left--;
        return HP_STALL_command;
    case HP_ACTIVITY_WRITE:
        return HP_STALL_command;
    default:
        return HP_STALL_idle;
    }
}

static void count_ddr(hp_counters *counters, hp_ddr_state state, bool write) {
    switch (state) {
    case HP_DDR_REFRESH:
        counters->clocks_ddr_refresh++;
        break;
    case HP_DDR_ROW:
        counters->clocks_ddr_row++;
        break;
    case HP_DDR_BEAT:
        write ? counters->clocks_ddr_write++ : counters->clocks_ddr_read++;
        break;
    case HP_DDR_IDLE:
        break;
    }
}

static void count_stall(hp_counters *counters, hp_stall stall) {
    switch (stall) {
    case HP_STALL_select:
        counters->stalls_select++;
        break;
    case HP_STALL_fill:
        counters->stalls_fill++;
        break;
    case HP_STALL_row:
        counters->stalls_row++;
        break;
    case HP_STALL_refresh:
        counters->stalls_refresh++;
        break;
    case HP_STALL_sram_port:
        counters->stalls_sram_port++;
        break;
    case HP_STALL_sram_full:
        counters->stalls_sram_full++;
        break;
    case HP_STALL_drain:
        counters->stalls_drain++;
        break;
    case HP_STALL_flush:
        counters->stalls_flush++;
        break;
    default:
        break; /* idle, command: hp_board_count knows of them; none: an issue */
    }
}

static void count_clock(hp_board *board, bool write) {
    const hp_clocked *c = board->state;
    hp_counters *counters = &board->counters;
    count_ddr(counters, c->ddr.state, write);
    count_stall(counters, c->stall);
    counters->clocks_issue += c->issued;
    counters->clocks_update += c->updated;
    counters->clocks_sram += c->wrote;
    counters->clocks_transformer += c->took && board->query->moved;
}

static void tick(hp_board *board) {
    hp_clocked *c = board->state;
    hp_busy busy = {c->channel[HP_TO_BOARD].busy, c->channel[HP_TO_HOST].busy, c->decoding,
                    c->activity != HP_ACTIVITY_NONE};
    bool write = c->activity == HP_ACTIVITY_WRITE;
    c->issued = c->moved = c->wrote = c->updated = false;
    c->full = hp_sram_full(&c->sram);
    if (c->vcd) hp_vcd_probe(c->vcd, board);
    tick_ddr(board);
    c->stall = tick_activity(board);
    hp_board_count(board, busy, 1);
    count_clock(board, write);
    for (int d = 0; d < HP_DIRECTIONS; d++) c->channel[d].left -= c->channel[d].busy;
    c->decode_left -= c->decoding;
    if (c->vcd) hp_vcd_dump(c->vcd, board);
    board->clock++;
}

/* ---- what ends at the start of the present clock ---- */

static bool arrives(hp_board *board, hp_direction direction) {
    hp_channel *channel = &((hp_clocked *)board->state)->channel[direction];
    if (!channel->busy || channel->left) return false;
    channel->busy = false;
    *(direction == HP_TO_BOARD ? &board->counters.bytes_to_board : &board->counters.bytes_to_host) += channel->n;
    return true;
}

static void make_packet_known(hp_board *board) {
    hp_clocked *c = board->state;
    uint64_t most = board->config.packet_results, waiting = c->written - c->known;
    if (most > board->config.sram_records) most = board->config.sram_records;
    if (waiting < most || c->written == c->total) return;
    hp_result_known(board, c->known, (uint32_t)waiting, false);
    c->known = c->written;
}

static bool command_ends(hp_board *board) {
    hp_clocked *c = board->state;
    switch (c->activity) {
    case HP_ACTIVITY_COMMAND:
        return c->left == 0;
    case HP_ACTIVITY_WRITE:
        return c->write_left == 0;
    case HP_ACTIVITY_ENDED:
        return true;
    default:
        return false;
    }
}

static void end_command(hp_board *board) {
    hp_clocked *c = board->state;
    if (board->query) make_packet_known(board);
    if (c->activity == HP_ACTIVITY_SELECT && c->left == 0) begin_streaming(board);
    if (!command_ends(board)) return;
    if (board->query) hp_query_end(board, c->known, c->written, c->tests_run);
    c->activity = HP_ACTIVITY_NONE;
    hp_command_end(board);
}

static void end_what_ends(hp_board *board) {
    hp_clocked *c = board->state;
    bool answered = arrives(board, HP_TO_HOST), received = arrives(board, HP_TO_BOARD);
    if (answered) hp_board_answered(board);
    end_command(board);
    if (received) hp_board_received(board);
    if (c->decoding && c->decode_left == 0) {
        c->decoding = false;
        c->decoded++;
    }
}

static bool clocked_run(hp_board *board) {
    hp_clocked *c = board->state;
    do {
        begin_decoding(board);
        begin_command(board);
        begin_transfers(board);
        if (!c->channel[HP_TO_BOARD].busy && !c->channel[HP_TO_HOST].busy && !board->held_count) return false;
        tick(board);
        end_what_ends(board);
    } while (!board->sent && !board->received);
    return true;
}

/* Records leave the SRAMs by DMA, in the order in which they came. */
static void clocked_records(hp_board *board, const hp_answer *answer, uint8_t *bytes) {
    hp_sram *sram = &((hp_clocked *)board->state)->sram;
    for (uint32_t i = 0; i < answer->count; i++) {
        hp_result record = hp_sram_read(sram);
        hp_record_encode(&record, bytes + (size_t)i * HP_RESULT_BYTES);
    }
}

/* Records are computed when their tests are issued: the scene may change. */
static hp_status clocked_settle(hp_board *board) {
    (void)board;
    return HP_OK;
}

static bool clocked_executing(const hp_board *board) {
    return ((const hp_clocked *)board->state)->activity != HP_ACTIVITY_NONE;
}

static void clocked_drop_waiting(hp_board *board) {
    hp_clocked *c = board->state;
    c->channel[HP_TO_BOARD].busy = false;
    c->decoding = false;
    c->decoded = 0;
}

static void clocked_reset(hp_board *board) {
    hp_clocked *c = board->state;
    clocked_drop_waiting(board);
    c->channel[HP_TO_HOST].busy = false;
    c->activity = HP_ACTIVITY_NONE;
    c->sram.count = 0;
}

static hp_status clocked_create(hp_board *board) {
    hp_clocked *c = calloc(1, sizeof *c);
    if (!c) return HP_ERROR_MEMORY;
    board->state = c;
    c->ddr = hp_controller_reset(&board->config);
    c->sram.capacity = board->config.sram_records;
    if (board->def.vcd && !(c->vcd = hp_vcd_create(board))) return HP_ERROR_MEMORY;
    return hp_secondary_create(&c->secondary, &board->config, &board->ddr);
}

static void clocked_destroy(hp_board *board) {
    hp_clocked *c = board->state;
    hp_vcd_destroy(c->vcd, board);
    hp_secondary_free(&c->secondary);
    hp_delay_line_free(&c->pipe);
    hp_sram_free(&c->sram);
    free(c);
}

const hp_engine hp_engine_clocked = {clocked_create, clocked_destroy,   clocked_run,          clocked_records,
                                     clocked_settle, clocked_executing, clocked_drop_waiting, clocked_reset};
