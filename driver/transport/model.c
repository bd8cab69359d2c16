/* The model transport: the simulated board behind submit and poll, in the caller's thread.
 *
 * Board time goes on only inside poll, one event of the link at a time, and stops when there is nothing under way or
 * when a packet for the host finds no transfer to take it. So what the board does depends on the order of the calls
 * alone. */
#include "transport.h"
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

typedef struct fifo {
    hp_transfer *first, *last;
} fifo;

typedef struct model_transport {
    hp_transport head;
    hp_board *board;
    fifo out, in;      /* submitted, in order */
    fifo cancelled;    /* to be completed by the next poll */
    uint8_t *held;     /* a packet that came when no IN transfer was there to take it ... */
    size_t held_bytes; /* ... and its size; 0: none */
} model_transport;

static void append(fifo *queue, hp_transfer *transfer) {
    transfer->next = NULL;
    if (queue->first)
        queue->last->next = transfer;
    else
        queue->first = transfer;
    queue->last = transfer;
}

static hp_transfer *take_first(fifo *queue) {
    hp_transfer *transfer = queue->first;
    queue->first = transfer->next;
    return transfer;
}

static bool take_out(fifo *queue, hp_transfer *transfer) {
    hp_transfer *before = NULL;
    for (hp_transfer *at = queue->first; at; before = at, at = at->next) {
        if (at != transfer) continue;
        if (before)
            before->next = at->next;
        else
            queue->first = at->next;
        if (queue->last == at) queue->last = before;
        return true;
    }
    return false;
}

static void complete(hp_transfer *transfer, hp_status status, size_t moved) {
    transfer->status = status;
    transfer->moved = moved;
    transfer->done(transfer);
}

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    model_transport *model = (model_transport *)transport;
    hp_status status = hp_board_send(model->board, transfer->bytes, transfer->room);
    if (status) return status;
    transfer->in = false;
    append(&model->out, transfer);
    return HP_OK;
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    transfer->in = true;
    append(&((model_transport *)transport)->in, transfer);
    return HP_OK;
}

/* Bytes on their way to the board cannot be called back: such a transfer completes with its result. */
static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    model_transport *model = (model_transport *)transport;
    if (take_out(&model->in, transfer)) append(&model->cancelled, transfer);
    return HP_OK;
}

static unsigned complete_cancelled(model_transport *model) {
    unsigned completed = 0;
    for (; model->cancelled.first; completed++) complete(take_first(&model->cancelled), HP_ERROR_CANCELLED, 0);
    return completed;
}

/* Gives a packet that has crossed the link to the oldest IN transfer. */
static void deliver(model_transport *model, const uint8_t *bytes, size_t n) {
    hp_transfer *transfer = take_first(&model->in);
    bool fits = n <= transfer->room;
    if (fits) memcpy(transfer->bytes, bytes, n);
    complete(transfer, fits ? HP_OK : HP_ERROR_LENGTH, fits ? n : 0);
}

/* Carries the board on to its next event. True: a transfer completed. */
static bool step(model_transport *model) {
    hp_board_event event = hp_board_step(model->board);
    if (event.kind == HP_BOARD_IDLE) return false;
    if (event.kind == HP_BOARD_RECEIVED) {
        hp_transfer *transfer = take_first(&model->out);
        complete(transfer, HP_OK, transfer->room);
        return true;
    }
    if (model->in.first) {
        deliver(model, event.bytes, event.n);
        return true;
    }
    memcpy(model->held, event.bytes, event.n); /* the board's bytes last only until the next call on it */
    model->held_bytes = event.n;
    return false;
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    model_transport *model = (model_transport *)transport;
    (void)timeout_ms; /* the board's time is not ours */
    *completed = complete_cancelled(model);
    if (*completed) return HP_OK;
    if (model->held_bytes && model->in.first) {
        size_t n = model->held_bytes;
        model->held_bytes = 0;
        deliver(model, model->held, n);
        *completed = 1;
    } else if (!model->held_bytes && (model->in.first || model->out.first)) {
        *completed = step(model);
    }
    return *completed ? HP_OK : HP_ERROR_TIMEOUT;
}

static size_t transfer_max(const hp_transport *transport) {
    (void)transport;
    return hp_packet_bytes(HP_PAYLOAD_MAX);
}

static void close_model(hp_transport *transport) {
    model_transport *model = (model_transport *)transport;
    hp_board_destroy(model->board);
    while (model->in.first) append(&model->cancelled, take_first(&model->in));
    while (model->out.first) append(&model->cancelled, take_first(&model->out));
    complete_cancelled(model);
    free(model->held);
    free(model);
}

static const hp_transport_ops model_ops = {
    .name = "model",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .transfer_max = transfer_max,
    .close = close_model,
};

hp_status hp_transport_model(const hp_board_def *def, hp_transport **transport) {
    model_transport *model = calloc(1, sizeof *model);
    if (!model) return HP_ERROR_MEMORY;
    model->head.ops = &model_ops;
    model->held = malloc(hp_packet_bytes(HP_PAYLOAD_MAX));
    hp_status status = model->held ? hp_board_create(def, &model->board) : HP_ERROR_MEMORY;
    if (status) {
        free(model->held);
        free(model);
        return status;
    }
    *transport = &model->head;
    return HP_OK;
}

hp_board *hp_transport_model_board(hp_transport *transport) {
    return transport->ops == &model_ops ? ((model_transport *)transport)->board : NULL;
}
