/* The null transport: a link that takes every packet and answers none. */
#include "transport.h"
#include <stdlib.h>

typedef struct null_transport {
    hp_transport head;
    hp_transfer *first, *last; /* to the board, not yet completed */
    hp_transfer *waiting;      /* to the host: for ever, or until they are cancelled */
} null_transport;

static void append(null_transport *null, hp_transfer *transfer, hp_status status) {
    transfer->status = status;
    transfer->next = NULL;
    if (null->first)
        null->last->next = transfer;
    else
        null->first = transfer;
    null->last = transfer;
}

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    transfer->in = false;
    transfer->moved = transfer->room;
    append((null_transport *)transport, transfer, HP_OK);
    return HP_OK;
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    null_transport *null = (null_transport *)transport;
    transfer->in = true;
    transfer->moved = 0;
    transfer->next = null->waiting;
    null->waiting = transfer;
    return HP_OK;
}

static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    null_transport *null = (null_transport *)transport;
    for (hp_transfer **at = &null->waiting; *at; at = &(*at)->next) {
        if (*at != transfer) continue;
        *at = transfer->next;
        append(null, transfer, HP_ERROR_CANCELLED);
        break;
    }
    return HP_OK;
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    null_transport *null = (null_transport *)transport;
    hp_transfer *transfer = null->first;
    (void)timeout_ms; /* waiting would bring nothing */
    *completed = 0;
    null->first = NULL;
    while (transfer) { /* not those that `done` submits again */
        hp_transfer *next = transfer->next;
        ++*completed;
        transfer->done(transfer);
        transfer = next;
    }
    return *completed ? HP_OK : HP_ERROR_TIMEOUT;
}

static size_t transfer_max(const hp_transport *transport) {
    (void)transport;
    return 512 * 1024;
}

static void close_null(hp_transport *transport) {
    null_transport *null = (null_transport *)transport;
    while (null->waiting) cancel(transport, null->waiting);
    unsigned completed;
    poll(transport, 0, &completed);
    free(null);
}

static const hp_transport_ops null_ops = {
    .name = "null",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .transfer_max = transfer_max,
    .close = close_null,
};

hp_status hp_transport_null(hp_transport **transport) {
    null_transport *null = calloc(1, sizeof *null);
    if (!null) return HP_ERROR_MEMORY;
    null->head.ops = &null_ops;
    *transport = &null->head;
    return HP_OK;
}
