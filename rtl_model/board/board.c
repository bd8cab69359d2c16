#include "internal.h"
#include <hitpipe/pipe.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { INBOUND_MOST = 4096 }; /* transfers that may wait for the link to the board */

hp_pipe_times hp_board_pipe(hp_board *board, const hp_query *query) {
    hp_pipe_times *times = &board->pipe_times[query->separation][query->pair];
    if (times->clocks) return *times;
    hp_pipe_cost cost = hp_pipe_cost_of(query->pair, query->separation, &board->config);
    if (cost.levels) *times = (hp_pipe_times){cost.clocks > 0 ? cost.clocks : 1, cost.interval};
    return *times;
}

static void read_transformer_costs(hp_board *board) {
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    board->transformer_clocks[code] = hp_transformer_cost_of(HP_##NAME, &board->config).clocks;
#include <hitpipe/objects.def>
#undef HP_OBJECT
}

static unsigned processors(void) {
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (unsigned)n : 1;
}

static hp_status fill(hp_board *board, const hp_board_def *def) {
    board->config = def->config;
    board->def = *def;
    board->engine = def->engine == HP_ENGINE_CLOCKED ? &hp_engine_clocked : &hp_engine_quick;
    board->isa = hp_isa_choose(def->isa);
    if (!board->isa || (def->vcd && def->engine != HP_ENGINE_CLOCKED)) return HP_ERROR_USAGE;
    board->threads = def->threads ? def->threads : processors();
    board->inbound_end = &board->inbound;
    board->held_end = &board->held;
    board->answers_end = &board->answers;
    board->next_clock_hz = def->config.clock_hz;
    hp_health_reset(board);
    board->packet = malloc(hp_packet_bytes(HP_PAYLOAD_MAX));
    if (!board->packet) return HP_ERROR_MEMORY;
    read_transformer_costs(board);
    return board->engine->create(board);
}

hp_status hp_board_create(const hp_board_def *def, hp_board **board) {
    char message[HP_CONFIG_MESSAGE];
    *board = NULL;
    if (hp_config_check(&def->config, message) != HP_OK) return HP_ERROR_CONFIG;
    hp_board *made = calloc(1, sizeof *made);
    if (!made) return HP_ERROR_MEMORY;
    hp_status status = fill(made, def);
    if (status != HP_OK)
        hp_board_destroy(made);
    else
        *board = made;
    return status;
}

void hp_board_destroy(hp_board *board) {
    if (!board) return;
    if (board->state) {
        hp_board_reset(board);
        board->engine->destroy(board);
    }
    free(board->packet);
    free(board);
}

hp_status hp_board_send(hp_board *board, const void *bytes, size_t n) {
    if (board->inbound_count == INBOUND_MOST) return HP_ERROR_MEMORY;
    hp_inbound *transfer = malloc(sizeof *transfer);
    if (!transfer) return HP_ERROR_MEMORY;
    *transfer = (hp_inbound){NULL, bytes, n};
    *board->inbound_end = transfer;
    board->inbound_end = &transfer->next;
    board->inbound_count++;
    return HP_OK;
}

/* Every packet needs one of the board's buffers, but HELLO, which finds room when all are taken: a host that has lost
 * count says HELLO. */
static bool has_buffer(const hp_board *board, const hp_inbound *transfer) {
    hp_header header;
    const uint8_t *payload;
    if (board->buffers_taken < board->config.packet_buffers) return true;
    return transfer->n <= HP_HEADER_BYTES + HP_HELLO_FIXED + HP_CRC_BYTES &&
           hp_packet_open(transfer->bytes, transfer->n, &header, &payload) == HP_OK &&
           header.opcode == HP_OPCODE_HELLO;
}

/* Bytes of a transfer that are kept: of a packet that is lost its header; of more than any packet has, one more than
 * a header, which is the wrong length whatever that header says. */
static size_t bytes_kept(const hp_inbound *transfer, bool lost) {
    if (lost) return transfer->n < HP_HEADER_BYTES ? transfer->n : HP_HEADER_BYTES;
    return transfer->n > hp_packet_bytes(HP_PAYLOAD_MAX) ? HP_HEADER_BYTES + 1 : transfer->n;
}

void hp_board_received(hp_board *board) {
    hp_inbound *transfer = board->inbound;
    bool lost = !has_buffer(board, transfer);
    size_t n = bytes_kept(transfer, lost);
    hp_held *held = malloc(sizeof *held + n);
    if (held) {
        *held = (hp_held){.lost = lost, .n = n};
        if (n) memcpy(held->bytes, transfer->bytes, n);
        *board->held_end = held;
        board->held_end = &held->next;
        board->held_count++;
        board->buffers_taken += !lost;
    }
    board->inbound = transfer->next;
    if (!board->inbound) board->inbound_end = &board->inbound;
    board->inbound_count--;
    free(transfer);
    board->received = true;
}

void hp_board_answered(hp_board *board) {
    hp_answer *answer = board->answers;
    if (answer->count) board->engine->records(board, answer, board->packet + HP_HEADER_BYTES + HP_RESULT_FIXED);
    hp_answer_encode(&board->config, answer, board->packet);
    board->sent_bytes = hp_answer_bytes(answer);
    board->sent = true;
    board->answers = answer->next;
    if (!board->answers) board->answers_end = &board->answers;
    hp_answer_free(answer);
}

hp_board_event hp_board_step(hp_board *board) {
    if (!board->sent && !board->received && !board->engine->run(board))
        return (hp_board_event){.kind = HP_BOARD_IDLE, .clock = board->clock};
    if (board->sent) {
        board->sent = false;
        return (hp_board_event){HP_BOARD_SENT, board->clock, board->packet, board->sent_bytes};
    }
    board->received = false;
    return (hp_board_event){.kind = HP_BOARD_RECEIVED, .clock = board->clock};
}

hp_counters hp_board_counters(const hp_board *board) {
    return board->counters;
}
uint64_t hp_board_clock(const hp_board *board) {
    return board->clock;
}
const char *hp_board_isa(const hp_board *board) {
    return board->isa;
}
