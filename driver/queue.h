/* Commands on their way to the board and back: credits, tags, sequence numbers, timeouts, sending again.
 *
 *      reserve, post                          the window                             answer
 *     ---------------->  [ oldest | ... | newest sent | ... waiting for credit ]  ------------>  take()
 *                           ^ answers are taken for this one alone
 *
 * The board answers in the order of the commands, so only an answer to the oldest one is taken. Anything else that
 * names a command of the window, a damaged packet or silence means that something was lost: the queue stops sending,
 * hears out the answers to what it has sent, and then goes back: everything not yet answered is sent again, from the
 * sequence number that the board expects, under new tags. An answer whose tag is in nobody's hands is dropped and
 * counted. docs/protocol.md tells the same from the board's side.
 *
 * One thread at a time. No allocation once each slot was used. Not part of the public interface. */
#ifndef HITPIPE_QUEUE_H
#define HITPIPE_QUEUE_H

#include "message.h"
#include "transport/transport.h"
#include <hitpipe/packet.h>

enum { HP_WINDOW_MAX = 64, HP_IN_TRANSFERS = 4, HP_IN_TRANSFERS_MAX = 32 };

typedef struct hp_queue hp_queue;
typedef struct hp_command hp_command;

/* Takes one undamaged answer of the expected opcode. Moves command->position on by what it took. On anything but
 * HP_OK and HP_ERROR_CANCELLED the answer does not fit, nothing of it was used, and the command is asked again. */
typedef hp_status hp_take_answer(hp_command *command, const uint8_t *payload, uint32_t length, bool last);

struct hp_command {
    /* Filled in between reserve and post. */
    uint8_t *payload; /* room for hp_queue.payload_max bytes, already there */
    uint32_t length;  /* of the payload */
    hp_opcode opcode;
    hp_opcode reply; /* opcode of the answer */
    bool once;       /* must not be carried out twice: when its answer is lost, that is an error */
    hp_take_answer *take;
    void *owner; /* the taker's own */

    /* For take(). */
    unsigned slot;     /* 0 to window - 1 */
    uint64_t position; /* taken since it was last sent */
    uint64_t farthest; /* taken at most, by this and all earlier sendings: what lies before must not be taken twice */

    /* The queue's own. */
    hp_queue *queue;
    uint32_t tag, sequence;
    unsigned sendings; /* how often it was sent */
    uint64_t told;     /* records that its answers told of since it was last sent, taken or not */
    hp_transfer transfer;
    bool sending; /* the transport holds the transfer */
    bool unsent;  /* it did not get to the board, as far as the transport knows: no answer is awaited */
};

/* What the queue went through, for reports and tests. */
typedef struct hp_link_counts {
    uint64_t sent;    /* packets to the board, those sent again included */
    uint64_t again;   /* commands sent more than once: times */
    uint64_t damaged; /* packets from the board that could not be read */
    uint64_t dropped; /* packets from the board that answered nothing asked, or came while going back */
} hp_link_counts;

struct hp_queue {
    hp_transport *transport;
    hp_message *message;
    unsigned timeout_ms, retries;
    bool (*tick)(void *context); /* called some tens of times a second in long waits; false: the call is cancelled */
    void *tick_context;
    size_t payload_max; /* most payload bytes of a packet on this link */
    hp_link_counts counts;

    hp_command commands[HP_WINDOW_MAX]; /* a ring of `window` slots */
    unsigned window, head, count;       /* slots in use; the oldest one; how many are in the window */
    unsigned sent, heard;               /* of those: sent since the last going back; answered or known to be lost */
    uint32_t next_tag, next_sequence;
    uint32_t highest;         /* no number of this session reached this one: the board cannot expect a later one */
    uint32_t base;            /* the board expected this number when the oldest was first sent */
    uint32_t expected, limit; /* what the board last said */

    hp_status fault;   /* why the queue goes back; HP_OK: it does not */
    hp_status stuck;   /* why a command was not sent: the queue goes back when all before it are answered */
    bool guessing;     /* after silence: `expected` may be behind the board's */
    unsigned tries;    /* goings back since something was last taken */
    uint64_t deadline; /* monotonic milliseconds */
    bool abandoned;    /* nobody wants the answers to what is in the window */
    bool forgotten;    /* the board was reset: session and scene are lost */
    hp_status failure; /* of the present call */
    bool disconnected;

    bool borrows; /* the bytes of transfers are the transport's own */
    unsigned ins;
    hp_transfer in[HP_IN_TRANSFERS_MAX];
    bool idle[HP_IN_TRANSFERS_MAX];            /* the transport did not take it: to be submitted again */
    hp_transfer *arrived[HP_IN_TRANSFERS_MAX]; /* completed, in order, not yet looked at */
    unsigned arrivals;
};

/* An open link with a window of one. HP_ERROR_MEMORY, or what the transport says. The transport stays the caller's,
 * and is to be closed before hp_queue_close frees the buffers that are not the transport's own. */
hp_status hp_queue_open(hp_queue *queue, hp_transport *transport, hp_message *message, unsigned timeout_ms,
                        unsigned retries);
void hp_queue_close(hp_queue *queue);

/* Sets window (1 to HP_WINDOW_MAX) and payload_max; only while the window is empty. */
void hp_queue_shape(hp_queue *queue, unsigned window, size_t payload_max);

/* Begins a call: hears out what an earlier call abandoned, so that the window is empty. */
hp_status hp_queue_settle(hp_queue *queue);

/* A free slot, waiting for one if need be. On error the call is over: its commands are abandoned, the message is set.
 */
hp_status hp_queue_reserve(hp_queue *queue, hp_command **command);

/* Sends what was filled in, as soon as there is credit. */
void hp_queue_post(hp_queue *queue, hp_command *command);

/* Waits for all answers. */
hp_status hp_queue_finish(hp_queue *queue);

/* ---- between queue.c and answers.c ---- */

static inline hp_command *hp_queue_at(hp_queue *queue, unsigned i) {
    return &queue->commands[(queue->head + i) % queue->window];
}

/* How far sequence number a lies ahead of b. */
static inline int32_t hp_ahead(uint32_t a, uint32_t b) {
    return (int32_t)(a - b);
}

/* Starts a new wait of timeout_ms. */
void hp_queue_renew_deadline(hp_queue *queue);

/* Ends the present call; what is in the window is abandoned. Message printf-like. Only the first failure counts. */
__attribute__((format(printf, 3, 4))) void hp_queue_fail(hp_queue *queue, hp_status status, const char *format, ...);

/* Looks at one IN transfer that completed. */
void hp_queue_judge(hp_queue *queue, const hp_transfer *transfer);

#endif
