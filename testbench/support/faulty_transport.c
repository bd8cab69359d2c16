#include "faulty_transport.h"
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

enum { INNER_INS = 4 };

typedef struct wire wire; /* a packet between the two sides */

struct wire {
    wire *next;
    unsigned silences; /* left to wait, for a delayed one */
    bool in;
    hp_transfer transfer; /* to the inner transport */
    size_t n;
    uint8_t bytes[];
};

typedef struct transfers {
    hp_transfer *first, *last;
} transfers;

typedef struct faulty {
    hp_transport head;
    hp_transport *inner;
    faulty_choose *choose;
    void *context;
    unsigned number[2]; /* packets seen; [1]: to the host */
    bool disconnected, closing;
    transfers out, in; /* of the user: done at the next poll; waiting for a packet */
    transfers cancelled;
    wire *arrived;    /* for the user, in order */
    wire *swapped[2]; /* waits for the next one */
    wire *delayed;
    wire *babble;     /* comes again and again ... */
    unsigned babbles; /* ... so many times yet */
    hp_transfer inner_in[INNER_INS];
} faulty;

static void append(transfers *queue, hp_transfer *transfer) {
    transfer->next = NULL;
    if (queue->first)
        queue->last->next = transfer;
    else
        queue->first = transfer;
    queue->last = transfer;
}

static hp_transfer *take_first(transfers *queue) {
    hp_transfer *transfer = queue->first;
    queue->first = transfer->next;
    return transfer;
}

static wire *copy_of(const uint8_t *bytes, size_t n, bool in) {
    wire *made = calloc(1, sizeof *made + n);
    if (!made) abort();
    made->n = n;
    made->in = in;
    memcpy(made->bytes, bytes, n);
    return made;
}

static void put_last(wire **list, wire *packet) {
    while (*list) list = &(*list)->next;
    packet->next = NULL;
    *list = packet;
}

static void free_list(wire *list) {
    while (list) {
        wire *next = list->next;
        free(list);
        list = next;
    }
}

static void wire_done(hp_transfer *transfer) {
    free(transfer->owner);
}

/* ---- passing on ---- */

static void deliver(faulty *link, wire *packet) {
    if (packet->in) {
        put_last(&link->arrived, packet);
        return;
    }
    packet->transfer = (hp_transfer){.bytes = packet->bytes, .room = packet->n, .done = wire_done, .owner = packet};
    if (link->inner->ops->submit_out(link->inner, &packet->transfer)) free(packet);
}

static void deliver_with_swapped(faulty *link, wire *packet) {
    wire *before = link->swapped[packet->in];
    link->swapped[packet->in] = NULL;
    deliver(link, packet);
    if (before) deliver(link, before);
}

static void pass(faulty *link, const uint8_t *bytes, size_t n, bool in) {
    fault now = link->choose(link->context, in, link->number[in]++, bytes, n);
    wire *packet = copy_of(bytes, n, in);
    switch (now.kind) {
    case FAULT_DROP:
        free(packet);
        return;
    case FAULT_DUPLICATE:
        deliver_with_swapped(link, copy_of(bytes, n, in));
        break;
    case FAULT_SWAP:
        if (link->swapped[in]) break;
        link->swapped[in] = packet;
        return;
    case FAULT_TRUNCATE:
        packet->n = now.argument < n ? n - now.argument : 1;
        break;
    case FAULT_FLIP:
        packet->bytes[now.argument / 8 % n] ^= (uint8_t)(1 << now.argument % 8);
        break;
    case FAULT_DELAY:
        packet->silences = now.argument;
        put_last(&link->delayed, packet);
        return;
    case FAULT_BABBLE:
        link->babble = packet;
        link->babbles = now.argument;
        return;
    case FAULT_DISCONNECT:
        link->disconnected = true;
        free(packet);
        return;
    default:
        break;
    }
    deliver_with_swapped(link, packet);
}

static void inner_in_done(hp_transfer *transfer) {
    faulty *link = transfer->owner;
    if (link->closing || transfer->status) return;
    pass(link, transfer->bytes, transfer->moved, true);
    link->inner->ops->submit_in(link->inner, transfer);
}

static void babble(faulty *link) {
    free_list(link->arrived);
    link->arrived = copy_of(link->babble->bytes, link->babble->n, true);
    link->disconnected = --link->babbles == 0;
}

/* Nothing else happens: what was held comes through. True when something did. */
static bool release(faulty *link) {
    wire *held = link->delayed;
    bool any = false;
    link->delayed = NULL;
    for (unsigned in = 0; in < 2; in++) {
        if (!link->swapped[in]) continue;
        deliver(link, link->swapped[in]);
        link->swapped[in] = NULL;
        any = true;
    }
    while (held) {
        wire *next = held->next;
        if (held->silences == 0) {
            deliver(link, held);
            any = true;
        } else {
            held->silences--;
            put_last(&link->delayed, held);
        }
        held = next;
    }
    return any;
}

/* ---- the user's side ---- */

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    faulty *link = (faulty *)transport;
    if (link->disconnected) return HP_ERROR_DISCONNECTED;
    transfer->in = false;
    transfer->status = HP_OK;
    transfer->moved = transfer->room;
    append(&link->out, transfer);
    pass(link, transfer->bytes, transfer->room, false);
    return HP_OK;
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    faulty *link = (faulty *)transport;
    if (link->disconnected) return HP_ERROR_DISCONNECTED;
    transfer->in = true;
    append(&link->in, transfer);
    return HP_OK;
}

static void cancel_all(transfers *from, transfers *to, hp_status status) {
    while (from->first) {
        hp_transfer *transfer = take_first(from);
        transfer->status = status;
        append(to, transfer);
    }
}

static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    faulty *link = (faulty *)transport;
    transfers kept = {NULL, NULL};
    while (link->in.first) {
        hp_transfer *at = take_first(&link->in);
        at->status = HP_ERROR_CANCELLED;
        append(at == transfer ? &link->cancelled : &kept, at);
    }
    link->in = kept;
    return HP_OK;
}

static unsigned complete(transfers *queue) {
    unsigned completed = 0;
    for (transfers now = *queue; now.first; completed++) {
        hp_transfer *transfer = take_first(&now);
        *queue = now;
        transfer->done(transfer);
    }
    return completed;
}

static unsigned hand_over(faulty *link) {
    unsigned completed = complete(&link->cancelled) + complete(&link->out);
    if (link->babble) babble(link);
    while (link->arrived && link->in.first) {
        wire *packet = link->arrived;
        hp_transfer *transfer = take_first(&link->in);
        link->arrived = packet->next;
        transfer->status = packet->n > transfer->room ? HP_ERROR_LENGTH : HP_OK;
        transfer->moved = transfer->status ? 0 : packet->n;
        memcpy(transfer->bytes, packet->bytes, transfer->moved);
        free(packet);
        transfer->done(transfer);
        completed++;
    }
    return completed;
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    faulty *link = (faulty *)transport;
    for (*completed = 0; *completed == 0;) {
        if (link->disconnected) {
            cancel_all(&link->in, &link->cancelled, HP_ERROR_DISCONNECTED);
            *completed = complete(&link->cancelled) + complete(&link->out);
            return *completed ? HP_OK : HP_ERROR_DISCONNECTED;
        }
        unsigned moved;
        *completed = hand_over(link);
        if (*completed) break;
        hp_status status = link->inner->ops->poll(link->inner, timeout_ms, &moved);
        if (status == HP_ERROR_TIMEOUT && !release(link)) return status;
        if (status && status != HP_ERROR_TIMEOUT) return status;
    }
    return HP_OK;
}

static size_t transfer_max(const hp_transport *transport) {
    const faulty *link = (const faulty *)transport;
    return link->inner->ops->transfer_max(link->inner);
}

static void close_faulty(hp_transport *transport) {
    faulty *link = (faulty *)transport;
    link->closing = true;
    link->inner->ops->close(link->inner);
    cancel_all(&link->in, &link->cancelled, HP_ERROR_CANCELLED);
    complete(&link->cancelled);
    complete(&link->out);
    free_list(link->arrived);
    free_list(link->delayed);
    free(link->babble);
    free(link->swapped[0]);
    free(link->swapped[1]);
    for (unsigned i = 0; i < INNER_INS; i++) free(link->inner_in[i].bytes);
    free(link);
}

static const hp_transport_ops faulty_ops = {
    .name = "faulty",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .transfer_max = transfer_max,
    .close = close_faulty,
};

hp_status faulty_transport(hp_transport *inner, faulty_choose *choose, void *context, hp_transport **transport) {
    faulty *link = calloc(1, sizeof *link);
    if (!link) abort();
    link->head.ops = &faulty_ops;
    link->inner = inner;
    link->choose = choose;
    link->context = context;
    size_t room = inner->ops->transfer_max(inner);
    for (unsigned i = 0; i < INNER_INS; i++) {
        link->inner_in[i] = (hp_transfer){.bytes = malloc(room), .room = room, .done = inner_in_done, .owner = link};
        if (!link->inner_in[i].bytes) abort();
        inner->ops->submit_in(inner, &link->inner_in[i]);
    }
    *transport = &link->head;
    return HP_OK;
}
