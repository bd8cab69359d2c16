/* The quick engine: goes from one change on the board to the next, and computes what lies between. */
#include "results.h"
#include "rtl_model/board/internal.h"
#include "stream.h"
#include <stdlib.h>

typedef struct quick {
    hp_ddr_runs ddr;
    hp_stream stream;
    uint64_t sram; /* records held */
    struct {
        bool busy;
        uint64_t end; /* clock of arrival */
        size_t n;
    } channel[HP_DIRECTIONS];
    bool decoding;
    uint64_t decoded_at;
    unsigned decoded; /* packets decoded whose commands have not begun */
    bool executing;
    uint64_t command_ends;           /* of a command of fixed length */
    uint64_t write_beat, write_left; /* of an UPLOAD */
    uint32_t hit[HP_PACKET_PRIMARIES];
} quick;

static hp_results_job results_job(const hp_board *board, const hp_query *query) {
    return (hp_results_job){&board->config, &board->ddr, hp_wide_pipe_of(board->isa, query->pair), board->threads};
}

/* ---- what begins in the present clock ---- */

static void begin_decoding(hp_board *board) {
    quick *q = board->state;
    if (q->decoding || board->held_count == q->decoded + q->executing) return;
    q->decoding = true;
    q->decoded_at = board->clock + board->config.decoder_clocks;
}

static void begin_query(hp_board *board) {
    quick *q = board->state;
    hp_query *query = board->query;
    hp_results_job job = results_job(board, query);
    uint32_t *hit = query->mode == HP_MODE_ANY ? q->hit : NULL;
    hp_pipe_times pipe = hp_board_pipe(board, query);
    hp_stream_timing timing = {board->clock, board->session.selected != hp_selection(query), pipe.clocks,
                               pipe.interval, board->transformer_clocks[query->secondary]};
    if (!pipe.clocks || hp_stream_reserve(&q->stream, pipe.clocks) != HP_OK) {
        hp_query_refuse(board);
        return;
    }
    if (query->mode != HP_MODE_ALL) hp_results_find(&job, query, hit);
    board->session.selected = hp_selection(query);
    hp_stream_begin(&q->stream, query, hit, timing, &q->sram);
}

static void begin_command(hp_board *board) {
    quick *q = board->state;
    if (q->executing || !q->decoded) return;
    q->decoded--;
    q->executing = true;
    hp_command_begin(board);
    q->command_ends = board->clock + (board->command.opcode == HP_OPCODE_TRANSFORM ? 2 : 1);
    if (board->command.opcode == HP_OPCODE_QUERY) begin_query(board);
    if (board->command.opcode != HP_OPCODE_UPLOAD) return;
    unsigned beats = hp_object_beats(board->session.object);
    q->write_beat = (uint64_t)hp_upload_first(&board->command) * beats;
    q->write_left = (uint64_t)hp_upload_count(&board->command) * beats;
}

static void begin_transfers(hp_board *board) {
    quick *q = board->state;
    bool waits[HP_DIRECTIONS] = {board->inbound != NULL, board->answers != NULL};
    bool busy[HP_DIRECTIONS] = {q->channel[HP_TO_BOARD].busy, q->channel[HP_TO_HOST].busy}, grant[HP_DIRECTIONS];
    hp_link_grant(&board->config, waits, busy, grant);
    for (int d = 0; d < HP_DIRECTIONS; d++) {
        if (!grant[d]) continue;
        q->channel[d].busy = true;
        q->channel[d].n = d == HP_TO_BOARD ? board->inbound->n : hp_answer_bytes(board->answers);
        q->channel[d].end = board->clock + hp_link_clocks(&board->config, (hp_direction)d, q->channel[d].n);
    }
}

static bool under_way(const hp_board *board) {
    const quick *q = board->state;
    return q->channel[HP_TO_BOARD].busy || q->channel[HP_TO_HOST].busy || board->held_count;
}

/* ---- time ---- */

/* The first clock, as far as it is known, in which something arrives, is decoded or ends. */
static uint64_t next_change(const hp_board *board) {
    const quick *q = board->state;
    uint64_t next = UINT64_MAX;
    for (int d = 0; d < HP_DIRECTIONS; d++)
        if (q->channel[d].busy) next = hp_min(next, q->channel[d].end);
    if (q->decoding) next = hp_min(next, q->decoded_at);
    bool fixed =
        board->command.opcode != HP_OPCODE_QUERY && (board->command.opcode != HP_OPCODE_UPLOAD || !q->write_left);
    if (q->executing && fixed) next = hp_min(next, q->command_ends);
    return next;
}

/* Writes an UPLOAD's beats in clocks [from, to); returns the clock after the last beat if that comes first. */
static uint64_t write_beats(quick *q, uint64_t from, uint64_t to, hp_counters *counters) {
    uint64_t t = from;
    while (t < to && q->write_left) {
        hp_ddr_run run = hp_ddr_plan(&q->ddr, t, q->write_beat, q->write_left);
        uint64_t clocks = hp_min(run.clocks, to - t);
        hp_ddr_count(counters, run.state, clocks, true);
        if (run.state == HP_DDR_BEAT) {
            q->write_beat += clocks;
            q->write_left -= clocks;
        }
        t += clocks;
    }
    if (!q->write_left) q->command_ends = t;
    return t;
}

static void count_clocks(hp_board *board, uint64_t clocks) {
    const quick *q = board->state;
    hp_busy busy = {q->channel[HP_TO_BOARD].busy, q->channel[HP_TO_HOST].busy, q->decoding, q->executing};
    hp_board_count(board, busy, clocks);
}

static void pass_time(hp_board *board) {
    quick *q = board->state;
    uint64_t from = board->clock, to = next_change(board);
    if (q->executing && board->command.opcode == HP_OPCODE_QUERY)
        to = hp_stream_advance(&q->stream, from, to, &q->ddr, &board->counters);
    else if (q->executing && board->command.opcode == HP_OPCODE_UPLOAD && q->write_left)
        to = write_beats(q, from, to, &board->counters);
    else
        hp_ddr_pass(&q->ddr, from, to, &board->counters);
    count_clocks(board, to - from);
    board->clock = to;
}

/* ---- what ends at the start of the present clock ---- */

static bool arrives(hp_board *board, hp_direction direction) {
    quick *q = board->state;
    if (!q->channel[direction].busy || q->channel[direction].end != board->clock) return false;
    q->channel[direction].busy = false;
    *(direction == HP_TO_BOARD ? &board->counters.bytes_to_board : &board->counters.bytes_to_host) +=
        q->channel[direction].n;
    return true;
}

static void end_command(hp_board *board) {
    quick *q = board->state;
    if (!q->executing) return;
    if (board->command.opcode == HP_OPCODE_QUERY) {
        if (!hp_stream_ended(&q->stream)) return;
        hp_query_end(board, q->stream.known, q->stream.written, q->stream.run);
    } else if ((board->command.opcode == HP_OPCODE_UPLOAD && q->write_left) || q->command_ends != board->clock) {
        return;
    }
    q->executing = false;
    hp_command_end(board);
}

static void make_packet_known(hp_board *board) {
    quick *q = board->state;
    if (!q->executing || board->command.opcode != HP_OPCODE_QUERY || !hp_stream_packet(&q->stream)) return;
    hp_result_known(board, q->stream.known, (uint32_t)q->stream.packet_records, false);
    q->stream.known += q->stream.packet_records;
}

static void end_what_ends(hp_board *board) {
    quick *q = board->state;
    bool answered = arrives(board, HP_TO_HOST), received = arrives(board, HP_TO_BOARD);
    if (answered) q->sram -= board->answers->count;
    if (answered) hp_board_answered(board);
    make_packet_known(board);
    end_command(board);
    if (received) hp_board_received(board);
    if (q->decoding && q->decoded_at == board->clock) {
        q->decoding = false;
        q->decoded++;
    }
}

static bool quick_run(hp_board *board) {
    do {
        begin_decoding(board);
        begin_command(board);
        begin_transfers(board);
        if (!under_way(board)) return false;
        pass_time(board);
        end_what_ends(board);
    } while (!board->sent && !board->received);
    return true;
}

/* ---- records ---- */

typedef struct place {
    uint8_t *bytes;     /* of the records from `first` on, as the wire has them; or */
    hp_result *records; /* as they are */
    uint64_t first;
} place;

static void place_record(void *context, uint64_t number, const hp_result *record) {
    const place *to = context;
    if (to->records)
        to->records[number - to->first] = *record;
    else
        hp_record_encode(record, to->bytes + (number - to->first) * HP_RESULT_BYTES);
}

static void quick_records(hp_board *board, const hp_answer *answer, uint8_t *bytes) {
    const hp_query *query = answer->query;
    place to = {bytes, NULL, answer->first};
    if (query->mode == HP_MODE_ALL && !answer->records) {
        hp_results_job job = results_job(board, query);
        hp_results_range(&job, query, answer->first, answer->count, place_record, &to);
        return;
    }
    const hp_result *records = answer->records ? answer->records : query->results + answer->first;
    for (uint32_t i = 0; i < answer->count; i++) place_record(&to, answer->first + i, &records[i]);
}

/* Records of `all` are computed when they cross the link; those that wait for it while the scene changes, before
 * that. */
static hp_status quick_settle(hp_board *board) {
    for (hp_answer *answer = board->answers; answer; answer = answer->next) {
        if (!answer->count || answer->records || answer->query->mode != HP_MODE_ALL) continue;
        place to = {NULL, malloc(answer->count * sizeof(hp_result)), answer->first};
        if (!to.records) return HP_ERROR_MEMORY;
        hp_results_job job = results_job(board, answer->query);
        hp_results_range(&job, answer->query, answer->first, answer->count, place_record, &to);
        answer->records = to.records;
    }
    return HP_OK;
}

static bool quick_executing(const hp_board *board) {
    return ((const quick *)board->state)->executing;
}

static void quick_drop_waiting(hp_board *board) {
    quick *q = board->state;
    q->channel[HP_TO_BOARD].busy = false;
    q->decoding = false;
    q->decoded = 0;
}

static void quick_reset(hp_board *board) {
    quick *q = board->state;
    quick_drop_waiting(board);
    q->channel[HP_TO_HOST].busy = false;
    q->executing = false;
    q->sram = 0;
}

static hp_status quick_create(hp_board *board) {
    quick *q = calloc(1, sizeof *q);
    if (!q) return HP_ERROR_MEMORY;
    board->state = q;
    q->ddr = hp_ddr_runs_reset(&board->config);
    return hp_stream_create(&q->stream, &board->config);
}

static void quick_destroy(hp_board *board) {
    quick *q = board->state;
    hp_stream_free(&q->stream);
    free(q);
}

const hp_engine hp_engine_quick = {quick_create, quick_destroy,   quick_run,          quick_records,
                                   quick_settle, quick_executing, quick_drop_waiting, quick_reset};
