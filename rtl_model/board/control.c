/* What a control plane beside the link does to a board: reset, abort, clock; and how the board is. */
#include "internal.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double cold_celsius = 35, warm_celsius = 65, warming_seconds = 1;

void hp_held_drop(hp_board *board) {
    hp_held *held = board->held;
    board->held = held->next;
    if (!board->held) board->held_end = &board->held;
    board->held_count--;
    board->buffers_taken -= !held->lost;
    free(held);
}

static void drop_inbound(hp_board *board) {
    while (board->inbound) {
        hp_inbound *next = board->inbound->next;
        free(board->inbound);
        board->inbound = next;
    }
    board->inbound_end = &board->inbound;
    board->inbound_count = 0;
    board->received = false;
}

static void drop_answers(hp_board *board) {
    while (board->answers) {
        hp_answer *next = board->answers->next;
        hp_answer_free(board->answers);
        board->answers = next;
    }
    board->answers_end = &board->answers;
}

void hp_board_reset(hp_board *board) {
    board->engine->reset(board);
    drop_inbound(board);
    drop_answers(board);
    while (board->held) hp_held_drop(board);
    hp_query_release(board->query);
    board->query = NULL;
    board->command = (hp_command){0};
    board->session = (hp_session){0};
    board->counters = (hp_counters){0};
    board->sent = false;
    hp_ddr_free(&board->ddr);
    board->ddr = (hp_ddr){0};
}

/* Keeps the packet of the command under way, which is the oldest. */
void hp_board_abort(hp_board *board) {
    board->engine->drop_waiting(board);
    drop_inbound(board);
    hp_held *kept = NULL;
    if (board->engine->executing(board)) {
        kept = board->held;
        board->held = kept->next;
    }
    while (board->held) hp_held_drop(board);
    board->held = kept;
    board->held_end = kept ? &kept->next : &board->held;
    if (kept) kept->next = NULL;
}

hp_status hp_board_set_clock(hp_board *board, uint64_t hz) {
    char text[HP_CONFIG_MESSAGE], message[HP_CONFIG_MESSAGE];
    hp_config config = board->config;
    if (board->def.vcd) return HP_ERROR_USAGE;
    snprintf(text, sizeof text, "%" PRIu64, hz);
    if (hp_config_set(&config, "clock_hz", text, message) != HP_OK) return HP_ERROR_FIELD;
    if (hp_config_check(&config, message) != HP_OK) return HP_ERROR_FIELD;
    board->next_clock_hz = hz;
    return HP_OK;
}

const hp_config *hp_board_config(const hp_board *board) {
    return &board->config;
}

void hp_health_reset(hp_board *board) {
    board->health = (hp_health){.celsius = cold_celsius};
}

/* Of the clocks since it was last looked at, only their number and how many were busy count: so both engines show the
 * same. */
static void warm(hp_board *board) {
    uint64_t clocks = board->clock - board->warmed_at, busy = board->busy_clocks - board->warmed_busy_clocks;
    if (clocks == 0) return;
    double towards = cold_celsius + (warm_celsius - cold_celsius) * (double)busy / (double)clocks;
    double left = exp(-(double)clocks / (double)board->config.clock_hz / warming_seconds);
    board->health.celsius = towards + (board->health.celsius - towards) * left;
    board->warmed_at = board->clock;
    board->warmed_busy_clocks = board->busy_clocks;
}

hp_health hp_board_health(hp_board *board) {
    warm(board);
    board->health.session = board->session.open;
    return board->health;
}
