/* The command sequencer: takes packets in order, one command at a time. */
#include "internal.h"
#include <stdlib.h>
#include <string.h>

uint32_t hp_upload_count(const hp_command *command) {
    return hp_get32(command->payload + HP_AT_UPLOAD_count);
}
uint32_t hp_upload_first(const hp_command *command) {
    return hp_get32(command->payload + HP_AT_UPLOAD_first);
}

static hp_status begin_upload(hp_board *board) {
    hp_session *session = &board->session;
    hp_object object = (hp_object)hp_get32(board->command.payload + HP_AT_UPLOAD_object);
    uint32_t first = hp_upload_first(&board->command), count = hp_upload_count(&board->command);
    hp_status status = board->engine->settle(board);
    if (status == HP_OK) status = hp_ddr_reserve(&board->ddr, object, (uint64_t)first + count);
    if (status != HP_OK) return status;
    size_t words = hp_object_words(object);
    if (count) memcpy(board->ddr.words + first * words, board->command.payload + HP_UPLOAD_FIXED, 4 * words * count);
    uint32_t present = first ? session->present : 0;
    session->object = object;
    session->present = first + count > present ? first + count : present;
    return HP_OK;
}

static void begin_transform(hp_board *board) {
    const uint8_t *payload = board->command.payload;
    board->session.moved = hp_get32(payload + HP_AT_TRANSFORM_enable) == 1;
    memcpy(board->session.matrix, payload + HP_AT_TRANSFORM_matrix, sizeof board->session.matrix);
}

static hp_status begin_query(hp_board *board) {
    hp_query *query = hp_query_create(board->command.payload);
    if (!query) return HP_ERROR_MEMORY;
    query->moved = board->session.moved;
    memcpy(query->matrix, board->session.matrix, sizeof query->matrix);
    board->query = query;
    return HP_OK;
}

void hp_query_refuse(hp_board *board) {
    hp_query_release(board->query);
    board->query = NULL;
    board->command.opcode = HP_OPCODE_ERROR;
    board->command.status = HP_ERROR_MEMORY;
}

void hp_command_begin(hp_board *board) {
    hp_command *command = &board->command;
    hp_status status = HP_OK;
    *command = hp_decode(&board->config, &board->session, board->held->bytes, board->held->n, board->held->lost);
    switch (command->opcode) {
    case HP_OPCODE_HELLO:
        board->session = (hp_session){.open = true};
        board->config.clock_hz = board->next_clock_hz;
        break;
    case HP_OPCODE_UPLOAD:
        status = begin_upload(board);
        break;
    case HP_OPCODE_TRANSFORM:
        begin_transform(board);
        break;
    case HP_OPCODE_QUERY:
        status = begin_query(board);
        break;
    default:
        break;
    }
    if (status != HP_OK) {
        command->opcode = HP_OPCODE_ERROR;
        command->status = status;
    }
    if (command->advances) board->session.expected++;
    board->health.packets += command->advances;
}

/* Out of memory, the answer is lost like any other packet may be: the host asks again. */
static void known(hp_board *board, hp_answer *answer) {
    if (!answer) return;
    *board->answers_end = answer;
    board->answers_end = &answer->next;
}

static hp_answer *answer_with(hp_board *board, hp_opcode opcode, bool last) {
    return hp_answer_create(&board->config, &board->session, opcode, board->command.tag, last);
}

void hp_result_known(hp_board *board, uint64_t first, uint32_t count, bool last) {
    hp_answer *answer = answer_with(board, HP_OPCODE_RESULT, last);
    if (answer) {
        answer->header.length += count * HP_RESULT_BYTES;
        answer->query = board->query;
        answer->query->users++;
        answer->first = first;
        answer->count = count;
    }
    known(board, answer);
}

static void answer_error(hp_board *board) {
    board->health.refused++;
    board->health.crc += board->command.status == HP_ERROR_CRC;
    board->health.sequence += board->command.status == HP_ERROR_SEQUENCE;
    hp_answer *answer = answer_with(board, HP_OPCODE_ERROR, true);
    if (answer) {
        answer->header.status = (uint16_t)board->command.status;
        answer->detail = board->command.detail;
    }
    known(board, answer);
}

static void answer_counters(hp_board *board) {
    hp_answer *answer = answer_with(board, HP_OPCODE_COUNTERS_REPLY, true);
    if (answer) {
        answer->header.length = sizeof(hp_counters);
        answer->counters = malloc(sizeof *answer->counters);
        if (answer->counters) *answer->counters = board->counters;
    }
    if (answer && !answer->counters) {
        hp_answer_free(answer);
        answer = NULL;
    }
    known(board, answer);
    if (hp_get32(board->command.payload + HP_AT_COUNTERS_clear)) board->counters = (hp_counters){0};
}

void hp_command_end(hp_board *board) {
    switch (board->command.opcode) {
    case HP_OPCODE_HELLO:
        known(board, answer_with(board, HP_OPCODE_HELLO_REPLY, true));
        board->counters = (hp_counters){0};
        break;
    case HP_OPCODE_UPLOAD:
    case HP_OPCODE_TRANSFORM:
        known(board, answer_with(board, HP_OPCODE_ACK, true));
        break;
    case HP_OPCODE_COUNTERS:
        answer_counters(board);
        break;
    case HP_OPCODE_QUERY: /* its last RESULT is known already */
        hp_query_release(board->query);
        board->query = NULL;
        break;
    default:
        answer_error(board);
        break;
    }
    hp_held_drop(board);
}
