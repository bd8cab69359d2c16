/* The window of commands: sending, waiting, going back. */
#include "queue.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TICK_MS = 50 };

static uint64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

void hp_queue_renew_deadline(hp_queue *queue) {
    queue->deadline = now_ms() + queue->timeout_ms;
}

void hp_queue_fail(hp_queue *queue, hp_status status, const char *format, ...) {
    if (!queue->failure && !queue->abandoned) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(queue->message->text, sizeof queue->message->text, format, arguments);
        va_end(arguments);
    }
    if (!queue->failure) queue->failure = status;
    queue->abandoned = true;
    queue->count = queue->sent;
}

/* ---- transfers ---- */

static void lost_link(hp_queue *queue) {
    queue->disconnected = true;
    hp_queue_fail(queue, HP_ERROR_DISCONNECTED, "%s", hp_status_text(HP_ERROR_DISCONNECTED));
}

/* Answers to what was sent before are still good. */
static void not_sent(hp_queue *queue, hp_command *command, hp_status status) {
    command->unsent = true;
    if (!queue->stuck || status == HP_ERROR_DISCONNECTED) queue->stuck = status;
}

static void in_done(hp_transfer *transfer) {
    hp_queue *queue = transfer->owner;
    queue->arrived[queue->arrivals++] = transfer;
}

static void out_done(hp_transfer *transfer) {
    hp_command *command = transfer->owner;
    hp_queue *queue = command->queue;
    command->sending = false;
    hp_queue_renew_deadline(queue);
    if (transfer->status) not_sent(queue, command, transfer->status);
}

static void listen(hp_queue *queue, hp_transfer *transfer) {
    hp_status status = queue->transport->ops->submit_in(queue->transport, transfer);
    queue->idle[transfer - queue->in] = status != HP_OK;
    if (status == HP_ERROR_DISCONNECTED)
        lost_link(queue);
    else if (status)
        hp_queue_fail(queue, status, "cannot read from the board: %s", hp_status_text(status));
}

/* With all transfers that the transport did not take before. */
static void listen_again(hp_queue *queue) {
    for (unsigned i = 0; i < queue->ins && !queue->disconnected; i++)
        if (queue->idle[i]) listen(queue, &queue->in[i]);
}

static uint8_t *allocate(const hp_queue *queue, size_t bytes) {
    hp_transport *transport = queue->transport;
    return transport->ops->allocate ? transport->ops->allocate(transport, bytes) : malloc(bytes);
}

hp_status hp_queue_open(hp_queue *queue, hp_transport *transport, hp_message *message, unsigned timeout_ms,
                        unsigned retries) {
    const hp_transport_ops *ops = transport->ops;
    size_t most = ops->transfer_max(transport);
    size_t packet = hp_packet_bytes(HP_PAYLOAD_MAX) < most ? hp_packet_bytes(HP_PAYLOAD_MAX) : most;
    size_t room = ops->in_room ? ops->in_room(transport) : packet;
    memset(queue, 0, sizeof *queue);
    queue->transport = transport;
    queue->message = message;
    queue->timeout_ms = timeout_ms;
    queue->retries = retries;
    queue->next_tag = 1;
    queue->borrows = ops->allocate != NULL;
    hp_queue_shape(queue, 1, packet - hp_packet_bytes(0) - HP_CRC_BYTES);
    queue->ins = ops->in_transfers ? ops->in_transfers(transport) : HP_IN_TRANSFERS;
    if (queue->ins > HP_IN_TRANSFERS_MAX) queue->ins = HP_IN_TRANSFERS_MAX;
    for (unsigned i = 0; i < queue->ins; i++) {
        queue->in[i] = (hp_transfer){.bytes = allocate(queue, room), .room = room, .done = in_done, .owner = queue};
        if (!queue->in[i].bytes) return hp_say(message, HP_ERROR_MEMORY, "no memory for packets from the board");
    }
    for (unsigned i = 0; i < queue->ins; i++) listen(queue, &queue->in[i]);
    return queue->failure;
}

void hp_queue_close(hp_queue *queue) {
    for (unsigned i = 0; i < HP_WINDOW_MAX && !queue->borrows; i++) free(queue->commands[i].transfer.bytes);
    for (unsigned i = 0; i < queue->ins && !queue->borrows; i++) free(queue->in[i].bytes);
}

void hp_queue_shape(hp_queue *queue, unsigned window, size_t payload_max) {
    queue->window = window;
    queue->head = 0;
    queue->payload_max = payload_max;
}

/* ---- sending ---- */

static void send_command(hp_queue *queue, hp_command *command) {
    if (command->opcode == HP_OPCODE_HELLO) { /* a new session: its numbers begin at 0 */
        queue->next_sequence = queue->highest = queue->base = queue->expected = 0;
        queue->limit = 1;
    }
    command->tag = queue->next_tag++;
    if (queue->next_tag == HP_NO_TAG) queue->next_tag = 0;
    command->sequence = queue->next_sequence++;
    if (hp_ahead(queue->next_sequence, queue->highest) > 0) queue->highest = queue->next_sequence;
    command->position = command->told = 0;
    command->sendings++;
    if (queue->sent == queue->heard) hp_queue_renew_deadline(queue);
    const hp_header header = {
        .version = HP_PROTOCOL_VERSION,
        .opcode = (uint8_t)command->opcode,
        .tag = command->tag,
        .length = command->length,
        .sequence = command->sequence,
    };
    command->transfer.room = hp_packet_seal(command->transfer.bytes, &header);
    command->sending = true;
    command->unsent = false;
    queue->sent++;
    queue->counts.sent++;
    hp_status status = queue->transport->ops->submit_out(queue->transport, &command->transfer);
    if (status == HP_OK) return;
    command->sending = false;
    not_sent(queue, command, status);
}

static void send_ready(hp_queue *queue) {
    while (!queue->fault && !queue->stuck && !queue->abandoned && queue->sent < queue->count) {
        hp_command *command = hp_queue_at(queue, queue->sent);
        bool credit = hp_ahead(queue->limit, queue->next_sequence) > 0 || command->opcode == HP_OPCODE_HELLO;
        if (!credit) break;
        send_command(queue, command);
    }
}

/* ---- going back ---- */

static bool holds_some(const hp_queue *queue) {
    for (unsigned i = 0; i < queue->window; i++)
        if (queue->commands[i].sending) return true;
    return false;
}

/* Takes back what the transport still holds; false when it does not let go in time. */
static bool recall(hp_queue *queue) {
    const hp_transport_ops *ops = queue->transport->ops;
    uint64_t deadline = now_ms() + queue->timeout_ms;
    for (unsigned i = 0; i < queue->window; i++) {
        hp_command *command = &queue->commands[i];
        if (command->sending) ops->cancel(queue->transport, &command->transfer);
    }
    while (holds_some(queue)) {
        uint64_t now = now_ms();
        unsigned completed;
        hp_status status = ops->poll(queue->transport, now < deadline ? (unsigned)(deadline - now) : 0, &completed);
        while (queue->arrivals) listen(queue, queue->arrived[--queue->arrivals]); /* too late to be of use */
        if (status == HP_ERROR_DISCONNECTED) lost_link(queue);
        if (status || now >= deadline) break;
    }
    return !holds_some(queue);
}

static void give_up(hp_queue *queue) {
    const char *what = hp_opcode_name(hp_queue_at(queue, 0)->opcode);
    hp_queue_fail(queue, queue->fault, "%s: %s (retries: %u)", what, hp_status_text(queue->fault), queue->retries);
}

/* Everything sent is answered or lost. Renumbers the window so that it is sent again from what the board expects. */
static void go_back(hp_queue *queue, bool silent) {
    const hp_command *oldest = hp_queue_at(queue, 0);
    /* After silence the number was a guess. Being told the right one is no further failure. */
    bool renumbering = queue->guessing && !silent && queue->fault == HP_ERROR_SEQUENCE;
    bool carried_out =
        queue->sent && hp_ahead(queue->expected, oldest->sequence) > 0 && !(renumbering && oldest->sendings == 1);
    if (!recall(queue)) {
        queue->disconnected = true;
        hp_queue_fail(queue, HP_ERROR_DISCONNECTED, "the link neither sends a packet nor gives it back");
    } else if (!queue->abandoned && oldest->once && carried_out) {
        hp_queue_fail(queue, queue->fault, "%s was carried out, but its answer was lost: %s",
                      hp_opcode_name(oldest->opcode), hp_status_text(queue->fault));
    } else if (!queue->abandoned && !renumbering && ++queue->tries > queue->retries) {
        give_up(queue);
    }
    queue->counts.again += queue->abandoned ? 0 : queue->sent;
    if (queue->abandoned) queue->count = 0;
    queue->sent = queue->heard = 0;
    queue->fault = queue->stuck = HP_OK;
    queue->guessing = silent;
    queue->next_sequence = queue->expected;
    /* A board that says nothing has nothing left to do, so it has room for a packet, whatever the credit says. */
    if (silent && hp_ahead(queue->limit, queue->next_sequence) <= 0) queue->limit = queue->next_sequence + 1;
    hp_queue_renew_deadline(queue);
}

/* ---- waiting ---- */

/* Looks at what came, in order, and gives the transfers back to the transport. What came before the link was lost is
 * good. */
static void take_arrivals(hp_queue *queue) {
    unsigned arrivals = queue->arrivals, i = 0;
    hp_transfer *arrived[HP_IN_TRANSFERS_MAX];
    memcpy(arrived, queue->arrived, sizeof arrived);
    queue->arrivals = 0;
    for (; i < arrivals && arrived[i]->status != HP_ERROR_DISCONNECTED; i++) hp_queue_judge(queue, arrived[i]);
    if (i < arrivals || queue->stuck == HP_ERROR_DISCONNECTED) lost_link(queue);
    for (i = 0; i < arrivals && !queue->disconnected; i++) listen(queue, arrived[i]);
}

/* Whether no answer is on its way: to what was sent, all came or are lost. */
static bool all_heard(hp_queue *queue) {
    for (unsigned i = queue->heard; i < queue->sent; i++)
        if (!hp_queue_at(queue, i)->unsent) return false;
    return true;
}

/* Waits for the next thing to happen on the link, in short steps when somebody wants to be called meanwhile. */
static hp_status await_link(hp_queue *queue, uint64_t now) {
    const hp_transport_ops *ops = queue->transport->ops;
    unsigned wait = now < queue->deadline ? (unsigned)(queue->deadline - now) : 0, completed;
    if (queue->stuck && all_heard(queue)) wait = 0; /* there is nothing to wait for */
    bool ticks = queue->tick && ops->waits && !queue->abandoned;
    hp_status status = ops->poll(queue->transport, ticks && wait > TICK_MS ? TICK_MS : wait, &completed);
    if (ticks && !queue->tick(queue->tick_context))
        hp_queue_fail(queue, HP_ERROR_CANCELLED, "%s", hp_status_text(HP_ERROR_CANCELLED));
    return status;
}

/* Whether the time for something new is over, or nothing will come. */
static bool is_silent(const hp_queue *queue, uint64_t before, hp_status status) {
    if (status == HP_ERROR_TIMEOUT && queue->transport->ops->waits) return now_ms() >= queue->deadline;
    return status != HP_OK || before > queue->deadline;
}

/* Sends what may be sent and waits for the next thing to happen on the link. */
static void advance(hp_queue *queue) {
    listen_again(queue);
    send_ready(queue);
    if (queue->disconnected) return;
    uint64_t before = now_ms();
    hp_status status = await_link(queue, before);
    take_arrivals(queue);
    if (status == HP_ERROR_DISCONNECTED) lost_link(queue);
    if (queue->disconnected || queue->forgotten) return;
    bool silent = is_silent(queue, before, status), over = silent || all_heard(queue);
    if (over && !queue->fault) queue->fault = queue->stuck;
    if (silent && !queue->fault) queue->fault = status == HP_ERROR_IO ? HP_ERROR_IO : HP_ERROR_TIMEOUT;
    if (over && queue->fault) go_back(queue, silent);
}

hp_status hp_queue_settle(hp_queue *queue) {
    queue->message->text[0] = '\0';
    while (queue->count && !queue->disconnected && !queue->forgotten) {
        if (all_heard(queue))
            go_back(queue, false);
        else
            advance(queue);
    }
    queue->count = queue->sent = queue->heard = 0;
    queue->fault = queue->stuck = queue->failure = HP_OK;
    queue->abandoned = false;
    queue->tries = 0;
    hp_queue_renew_deadline(queue);
    if (queue->disconnected) lost_link(queue);
    listen_again(queue);
    return queue->failure;
}

hp_status hp_queue_reserve(hp_queue *queue, hp_command **command) {
    while (!queue->failure && (queue->count == queue->window || hp_queue_at(queue, queue->count)->sending))
        advance(queue);
    if (queue->failure) return queue->failure;
    hp_command *free_one = hp_queue_at(queue, queue->count);
    uint8_t *bytes = free_one->transfer.bytes;
    if (!bytes && !(bytes = allocate(queue, hp_packet_bytes(queue->payload_max)))) {
        hp_queue_fail(queue, HP_ERROR_MEMORY, "no memory for a packet");
        return queue->failure;
    }
    *free_one = (hp_command){
        .payload = bytes + HP_HEADER_BYTES,
        .slot = (queue->head + queue->count) % queue->window,
        .queue = queue,
        .transfer = {.bytes = bytes, .done = out_done, .owner = free_one},
    };
    *command = free_one;
    return HP_OK;
}

void hp_queue_post(hp_queue *queue, hp_command *command) {
    (void)command; /* the slot behind the newest: the one that was reserved */
    queue->count++;
    send_ready(queue);
}

hp_status hp_queue_finish(hp_queue *queue) {
    while (!queue->failure && queue->count) advance(queue);
    return queue->failure;
}
