/* What came from the board: whose answer it is, and whether it can be believed. */
#include "queue.h"

/* Place in the window of the command that was sent under this tag, or `sent` when there is none. */
static unsigned place_of(hp_queue *queue, uint32_t tag) {
    unsigned i = 0;
    while (i < queue->sent && hp_queue_at(queue, i)->tag != tag) i++;
    return i;
}

/* Whether an answer tells of records that none before it told of. */
static bool tells_more(hp_command *command, const hp_header *header, const uint8_t *payload) {
    if (!payload || header->opcode != HP_OPCODE_RESULT || header->length < HP_RESULT_FIXED) return false;
    uint64_t told = hp_get64(payload + HP_AT_RESULT_first) + hp_get32(payload + HP_AT_RESULT_count);
    if (told <= command->told) return false;
    command->told = told;
    return true;
}

/* Believes the header's word on sequence, credit and how far the board has got. Only what is new starts a new wait: a
 * board that says the same for ever is not waited for. `payload` may be NULL. */
static void note(hp_queue *queue, const hp_header *header, const uint8_t *payload, unsigned place) {
    bool final = header->opcode == HP_OPCODE_ERROR || header->flags & HP_FLAG_LAST;
    unsigned heard = place + final;
    if (heard > queue->heard || tells_more(hp_queue_at(queue, place), header, payload))
        hp_queue_renew_deadline(queue);
    if (heard > queue->heard) queue->heard = heard;
    if (hp_ahead(header->sequence, queue->expected) > 0 && hp_ahead(header->sequence, queue->highest) <= 0)
        queue->expected = header->sequence;
    if (hp_ahead(header->limit, queue->limit) > 0) queue->limit = header->limit;
}

/* A number that no packet of this session can have made the board expect: it was reset, and knows nothing any more.
 */
static bool forgotten(const hp_queue *queue, const hp_header *header) {
    return header->opcode == HP_OPCODE_ERROR && header->status == HP_ERROR_SEQUENCE &&
           hp_queue_at((hp_queue *)queue, 0)->opcode != HP_OPCODE_HELLO &&
           (hp_ahead(header->sequence, queue->base) < 0 || hp_ahead(header->sequence, queue->highest) > 0);
}

/* Errors that come of the link, not of what was asked: sending again helps. */
static bool of_the_link(unsigned status) {
    return status == HP_ERROR_MAGIC || status == HP_ERROR_CRC || status == HP_ERROR_LENGTH ||
           status == HP_ERROR_SEQUENCE;
}

static void other_version(hp_queue *queue, unsigned version) {
    hp_queue_fail(queue, HP_ERROR_VERSION, "%s: the board speaks version %u, this program version %d; %s",
                  hp_status_text(HP_ERROR_VERSION), version, HP_PROTOCOL_VERSION,
                  version > HP_PROTOCOL_VERSION ? "a newer hitpipe is needed" : "the board needs newer firmware");
}

static void refused(hp_queue *queue, const hp_command *command, const hp_header *header, const uint8_t *payload) {
    if (header->status == HP_ERROR_VERSION) {
        other_version(queue, (unsigned)hp_get32(payload + HP_AT_ERROR_detail));
        return;
    }
    const char *text = hp_status_text((hp_status)header->status);
    hp_status status = text && header->status != HP_OK ? (hp_status)header->status : HP_ERROR_INTERNAL;
    hp_queue_fail(queue, status, "the board refuses %s: %s (detail %u)", hp_opcode_name(command->opcode),
                  text ? text : "for a reason unknown here", (unsigned)hp_get32(payload + HP_AT_ERROR_detail));
}

static void pop(hp_queue *queue) {
    queue->base = hp_queue_at(queue, 0)->sequence + 1;
    queue->head = (queue->head + 1) % queue->window;
    queue->count--;
    queue->sent--;
    queue->heard--;
}

/* An undamaged answer to the oldest command. */
static void take(hp_queue *queue, const hp_header *header, const uint8_t *payload) {
    hp_command *command = hp_queue_at(queue, 0);
    bool last = header->flags & HP_FLAG_LAST;
    if (header->opcode == HP_OPCODE_ERROR) {
        if (header->length < HP_ERROR_FIXED)
            queue->fault = HP_ERROR_LENGTH;
        else if (of_the_link(header->status))
            queue->fault = (hp_status)header->status;
        else
            refused(queue, command, header, payload);
        return;
    }
    hp_status status = HP_ERROR_OPCODE;
    uint64_t before = command->position;
    if (header->opcode == command->reply && header->status == HP_OK)
        status = command->take(command, payload, header->length, last);
    if (last || command->position > before) hp_queue_renew_deadline(queue); /* the taker's time is not the board's */
    if (status == HP_ERROR_CANCELLED) {
        hp_queue_fail(queue, status, "%s", hp_status_text(status));
    } else if (status) {
        queue->counts.damaged++;
        queue->fault = status;
        return;
    }
    if (command->position > command->farthest) {
        command->farthest = command->position;
        queue->tries = 0;
    }
    if (!last) return;
    queue->tries = 0;
    queue->guessing = false;
    pop(queue);
}

void hp_queue_judge(hp_queue *queue, const hp_transfer *transfer) {
    hp_header header = {.tag = HP_NO_TAG};
    const uint8_t *payload = NULL;
    hp_status damage = transfer->status;
    if (!damage) damage = hp_packet_open(transfer->bytes, transfer->moved, &header, &payload);
    unsigned place = place_of(queue, header.tag);
    bool known = place < queue->sent;
    bool nobodys = !damage && header.opcode == HP_OPCODE_ERROR && header.tag == HP_NO_TAG;
    bool waiting = queue->heard < queue->sent;

    if (known && forgotten(queue, &header)) {
        queue->forgotten = true;
        hp_queue_fail(queue, HP_ERROR_SEQUENCE, "the board was reset and holds no scene any more: upload it again");
        return;
    }
    if (known && damage == HP_ERROR_VERSION && hp_queue_at(queue, 0)->opcode == HP_OPCODE_HELLO) {
        other_version(queue, header.version); /* its packets are undamaged, and of another version */
        return;
    }
    if (known) note(queue, &header, damage ? NULL : payload, place);
    if (damage || nobodys) {
        queue->counts.damaged += damage != HP_OK;
        queue->counts.dropped += nobodys;
        if (nobodys && waiting) note(queue, &header, NULL, queue->heard);
        if (waiting && !queue->fault) queue->fault = damage ? damage : (hp_status)header.status;
    } else if (!known || queue->fault || queue->abandoned) {
        queue->counts.dropped++;
    } else if (place > 0) {
        queue->counts.dropped++;
        queue->fault = HP_ERROR_SEQUENCE; /* the oldest, or its answer, was lost */
    } else {
        take(queue, &header, payload);
    }
}
