#include "stranger.h"
#include <hitpipe/packet.h>
#include <hitpipe/pipe.h>
#include <stdlib.h>
#include <string.h>

enum { LENGTH_MOST = 524252, DDR_BYTES = 36 * 100000 };

typedef struct answer {
    struct answer *next;
    size_t n;
    uint8_t bytes[];
} answer;

typedef struct stranger {
    hp_transport head;
    stranger_def def;
    hp_transfer *out, *in; /* in order */
    answer *answers;
    bool open, moved;
    uint32_t expected, triangles;
    float matrix[12];
    float *scene;
    uint64_t counter;
    unsigned count[256];
} stranger;

/* ---- bytes ---- */

static uint32_t word(const uint8_t *at) {
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void put(uint8_t *at, uint64_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; i++) at[i] = (uint8_t)(value >> 8 * i);
}

static uint32_t crc(const uint8_t *bytes, size_t n) {
    uint32_t sum = 0xFFFFFFFF;
    for (size_t i = 0; i < n; i++) {
        sum ^= bytes[i];
        for (unsigned bit = 0; bit < 8; bit++) sum = sum >> 1 ^ (sum & 1 ? 0x82F63B78u : 0);
    }
    return ~sum;
}

/* ---- answers ---- */

static uint8_t *new_answer(stranger *board, uint8_t opcode, uint32_t tag, uint32_t length, bool last,
                           unsigned status) {
    size_t n = 32 + (length ? length + 4 : 0);
    answer *made = calloc(1, sizeof *made + n);
    answer **end = &board->answers;
    if (!made) abort();
    made->n = n;
    put(made->bytes, 0x50544948, 4);
    made->bytes[4] = 1;
    made->bytes[5] = opcode;
    made->bytes[6] = last;
    put(made->bytes + 8, tag, 4);
    put(made->bytes + 12, length, 4);
    put(made->bytes + 16, board->expected, 4);
    put(made->bytes + 20, board->expected + board->def.buffers - (last ? 0 : 1), 4);
    put(made->bytes + 24, status, 2);
    put(made->bytes + 28, crc(made->bytes, 28), 4);
    while (*end) end = &(*end)->next;
    *end = made;
    return made->bytes + 32;
}

static void close_answer(uint8_t *payload, uint32_t length) {
    put(payload + length, crc(payload, length), 4);
}

static void refuse(stranger *board, uint32_t tag, unsigned status, uint32_t detail) {
    uint8_t *payload = new_answer(board, 133, tag, 4, true, status);
    put(payload, detail, 4);
    close_answer(payload, 4);
}

static void hello(stranger *board, uint32_t tag, const uint8_t *payload) {
    if ((payload[0] | payload[1] << 8) > 1 || (payload[2] | payload[3] << 8) < 1) {
        refuse(board, tag, 16, 1);
        return;
    }
    board->open = true;
    board->moved = false;
    board->expected = 1;
    board->triangles = 0;
    uint8_t *reply = new_answer(board, 129, tag, 96, true, 0);
    put(reply, 1, 2);
    put(reply + 2, board->def.lanes, 2);
    put(reply + 8, 1000000, 8);
    put(reply + 16, DDR_BYTES, 8);
    put(reply + 24, 1 << 1, 4);
    put(reply + 28, board->def.packet_size, 4);
    put(reply + 32, board->def.buffers, 4);
    put(reply + 36, LENGTH_MOST, 4);
    put(reply + 40, board->def.secondary_outer, 4);
    memcpy(reply + 64, "stranger", 8);
    close_answer(reply, 96);
}

static void upload(stranger *board, uint32_t tag, const uint8_t *payload) {
    uint32_t first = word(payload + 4), count = word(payload + 8);
    if (first > board->triangles) {
        refuse(board, tag, 19, 32 + 4);
        return;
    }
    memcpy(board->scene + 9 * (size_t)first, payload + 16, 36 * (size_t)count);
    if (first == 0) board->triangles = 0;
    if (first + count > board->triangles) board->triangles = first + count;
    new_answer(board, 130, tag, 0, true, 0);
}

static void transform(stranger *board, uint32_t tag, const uint8_t *payload) {
    board->moved = word(payload);
    memcpy(board->matrix, payload + 4, 48);
    new_answer(board, 130, tag, 0, true, 0);
}

static void counters(stranger *board, uint32_t tag, const uint8_t *payload) {
    uint8_t *reply = new_answer(board, 132, tag, 8 * HP_REGISTER_COUNT, true, 0);
    put(reply, board->counter, 8);
    close_answer(reply, 8 * HP_REGISTER_COUNT);
    if (word(payload)) board->counter = 0;
}

/* ---- queries ---- */

typedef struct asked {
    uint32_t mode, first, count, primaries, active[256], actives;
    const uint8_t *rays;
} asked;

static hp_result test(stranger *board, const asked *query, uint32_t primary, uint32_t secondary) {
    float ray[6], triangle[9];
    memcpy(ray, query->rays + 24 * primary, 24);
    memcpy(triangle, board->scene + 9 * (size_t)secondary, 36);
    if (board->moved) hp_transform_object(HP_TRIANGLE, HP_GRADUAL, board->matrix, triangle, triangle);
    return hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, ray, triangle, secondary);
}

static hp_result fold(stranger *board, const asked *query, uint32_t primary) {
    hp_result best = {.index = 0xFFFFFFFF, .T = __builtin_inff(), .stencil = 1};
    for (uint32_t i = 0; i < query->count; i++) {
        hp_result next = test(board, query, primary, query->first + i);
        if (!next.F || (best.F && !(next.T < best.T))) continue;
        best = next;
        if (query->mode != 2) continue;
        best.stencil = 0;
        break;
    }
    return best;
}

static size_t all_records(stranger *board, const asked *query, hp_result *records) {
    uint32_t lanes = board->def.secondary_outer ? query->actives : board->def.lanes;
    size_t n = 0;
    for (uint32_t group = 0; group < query->actives; group += lanes)
        for (uint32_t i = 0; i < query->count; i++)
            for (uint32_t lane = group; lane < group + lanes && lane < query->actives; lane++)
                records[n++] = test(board, query, query->active[lane], query->first + i);
    return n;
}

static void send_records(stranger *board, uint32_t tag, const hp_result *records, size_t n) {
    size_t first = 0;
    do {
        uint32_t count = (uint32_t)(n - first < board->def.records ? n - first : board->def.records);
        uint32_t length = 16 + 28 * count;
        uint8_t *payload = new_answer(board, 131, tag, length, first + count == n, 0);
        put(payload, first, 8);
        put(payload + 8, count, 4);
        memcpy(payload + 16, records + first, 28 * (size_t)count);
        close_answer(payload, length);
        first += count;
    } while (first < n);
}

static void query(stranger *board, uint32_t tag, const uint8_t *payload) {
    asked query = {.mode = word(payload + 4),
                   .first = word(payload + 12),
                   .count = word(payload + 16),
                   .primaries = word(payload + 20),
                   .rays = payload + 64};
    if (query.first + query.count > board->triangles) {
        refuse(board, tag, 6, board->triangles);
        return;
    }
    for (uint32_t i = 0; i < query.primaries; i++)
        if (payload[32 + i / 8] >> i % 8 & 1) query.active[query.actives++] = i;
    size_t n = query.mode == 3 ? (size_t)query.actives * query.count : query.actives;
    hp_result *records = malloc((n + 1) * sizeof *records);
    if (!records) abort();
    if (query.mode == 3) all_records(board, &query, records);
    for (uint32_t i = 0; query.mode != 3 && i < query.actives; i++) {
        uint32_t primary = query.active[i];
        records[i] =
            query.mode == 4 ? test(board, &query, primary, query.first + primary) : fold(board, &query, primary);
    }
    send_records(board, tag, records, n);
    free(records);
}

/* ---- packets ---- */

static unsigned damage(const uint8_t *packet, size_t n, uint32_t *tag) {
    *tag = 0xFFFFFFFF;
    if (n < 32) return 15;
    if (word(packet) != 0x50544948) return 13;
    if (word(packet + 28) != crc(packet, 28)) return 14;
    *tag = word(packet + 8);
    uint32_t length = word(packet + 12);
    if (length > LENGTH_MOST || n != 32 + (length ? length + 4 : 0)) return 15;
    if (length && word(packet + 32 + length) != crc(packet + 32, length)) return 14;
    return 0;
}

static void receive(stranger *board, const uint8_t *packet, size_t n) {
    uint32_t tag;
    unsigned status = damage(packet, n, &tag);
    if (status) {
        refuse(board, tag, status, 0);
        return;
    }
    uint8_t opcode = packet[5];
    uint32_t expected = opcode == 1 ? 0 : board->expected;
    if (word(packet + 16) != expected || (opcode != 1 && !board->open)) {
        refuse(board, tag, 18, expected);
        return;
    }
    board->expected++;
    board->count[opcode]++;
    board->counter++;
    switch (opcode) {
    case 1:
        hello(board, tag, packet + 32);
        break;
    case 2:
        upload(board, tag, packet + 32);
        break;
    case 3:
        transform(board, tag, packet + 32);
        break;
    case 4:
        query(board, tag, packet + 32);
        break;
    case 5:
        counters(board, tag, packet + 32);
        break;
    default:
        refuse(board, tag, 17, 5);
        break;
    }
}

/* ---- transport ---- */

static void put_last(hp_transfer **list, hp_transfer *transfer) {
    while (*list) list = &(*list)->next;
    transfer->next = NULL;
    *list = transfer;
}

static void finish_first(hp_transfer **list, hp_status status, size_t moved) {
    hp_transfer *transfer = *list;
    *list = transfer->next;
    transfer->status = status;
    transfer->moved = moved;
    transfer->done(transfer);
}

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    put_last(&((stranger *)transport)->out, transfer);
    return HP_OK;
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    put_last(&((stranger *)transport)->in, transfer);
    return HP_OK;
}

static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    (void)transport, (void)transfer;
    return HP_OK;
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    stranger *board = (stranger *)transport;
    (void)timeout_ms;
    *completed = 1;
    if (board->out) {
        receive(board, board->out->bytes, board->out->room);
        finish_first(&board->out, HP_OK, board->out->room);
        return HP_OK;
    }
    if (board->answers && board->in) {
        answer *sent = board->answers;
        memcpy(board->in->bytes, sent->bytes, sent->n);
        board->answers = sent->next;
        size_t n = sent->n;
        free(sent);
        finish_first(&board->in, HP_OK, n);
        return HP_OK;
    }
    *completed = 0;
    return HP_ERROR_TIMEOUT;
}

static size_t transfer_max(const hp_transport *transport) {
    (void)transport;
    return 512 * 1024;
}

static void close_stranger(hp_transport *transport) {
    stranger *board = (stranger *)transport;
    while (board->out) finish_first(&board->out, HP_ERROR_CANCELLED, 0);
    while (board->in) finish_first(&board->in, HP_ERROR_CANCELLED, 0);
    while (board->answers) {
        answer *next = board->answers->next;
        free(board->answers);
        board->answers = next;
    }
    free(board->scene);
    free(board);
}

static const hp_transport_ops ops = {
    .name = "stranger",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .transfer_max = transfer_max,
    .close = close_stranger,
};

hp_status stranger_open(const stranger_def *def, hp_transport **transport) {
    stranger *board = calloc(1, sizeof *board);
    if (!board || !(board->scene = malloc(DDR_BYTES))) abort();
    board->head.ops = &ops;
    board->def = *def;
    *transport = &board->head;
    return HP_OK;
}

void stranger_reset(hp_transport *transport) {
    stranger *board = (stranger *)transport;
    board->open = false;
    board->expected = 0;
    board->triangles = 0;
}

unsigned stranger_count(hp_transport *transport, unsigned opcode) {
    return ((stranger *)transport)->count[opcode];
}
