/* A transport moves whole packets between the driver and a board. Each kind (null, model, usb) fills one
 * vtable; several may be open at a time. The shape is libusb's asynchronous interface: submit a transfer, poll for
 * completions, cancel; so a USB transport needs no adapter, and an in-process one no thread.
 *
 * Rules every transport keeps:
 *  - A submitted transfer belongs to the transport until its `done` runs. `done` runs exactly once for each transfer
 * that submit accepted, only from inside poll (or close), on the thread that called it, and may submit again.
 *  - OUT transfers (to the board) complete in the order of submission, and so do IN transfers (to the host).
 *  - One transfer carries one packet. An IN transfer completes with the bytes that came; a packet longer than its
 * buffer completes it with HP_ERROR_LENGTH.
 *  - cancel makes the transfer complete, from a later poll, with HP_ERROR_CANCELLED, or with its result if that came
 * first.
 *  - Nothing comes that the board sent before the transport was opened: a link that buffers is drained by open.
 *  - After HP_ERROR_DISCONNECTED nothing but cancel, poll and close is of use.
 * A transport is used by one thread at a time; different transports are independent. */
#ifndef HITPIPE_TRANSPORT_H
#define HITPIPE_TRANSPORT_H

#include <hitpipe/board.h>

typedef struct hp_transfer hp_transfer;
struct hp_transfer {
    uint8_t *bytes;   /* OUT: what to send; IN: where to put what comes */
    size_t room;      /* bytes to send, or room for them */
    size_t moved;     /* set before `done`: bytes sent or received */
    hp_status status; /* set before `done` */
    void (*done)(hp_transfer *transfer);
    void *owner; /* the submitter's own */
    bool in;     /* set by submit */
    /* The transport's own, while it holds the transfer. */
    hp_transfer *next;
    size_t begun;    /* of the bytes: handed on */
    unsigned pieces; /* that they are under way in */
    bool cancelled;
};

typedef struct hp_transport hp_transport;

typedef struct hp_transport_ops {
    const char *name; /* "model" */
    /* Queues a transfer to the board / from the board. On anything but HP_OK `done` will not run. */
    hp_status (*submit_out)(hp_transport *transport, hp_transfer *transfer);
    hp_status (*submit_in)(hp_transport *transport, hp_transfer *transfer);
    hp_status (*cancel)(hp_transport *transport, hp_transfer *transfer);
    /* Runs what can complete; waits up to timeout_ms (0: not at all) for the first completion. HP_OK with *completed
     * the number of `done` calls made, which may be 0 when something else ended the wait early, such as a signal;
     * HP_ERROR_TIMEOUT when there was none, HP_ERROR_DISCONNECTED, HP_ERROR_IO. */
    hp_status (*poll)(hp_transport *transport, unsigned timeout_ms, unsigned *completed);
    /* Whether poll waits in earnest. An in-process board does not: when it has nothing under way, poll says
     * HP_ERROR_TIMEOUT at once, since waiting would bring nothing. */
    bool waits;
    /* Largest packet the link takes in one transfer. */
    size_t (*transfer_max)(const hp_transport *transport);
    /* How an IN transfer gets such a packet: the room it needs, and how many of them keep the link busy. NULL:
     * transfer_max, and 4. */
    size_t (*in_room)(const hp_transport *transport);
    unsigned (*in_transfers)(const hp_transport *transport);
    /* Memory for the bytes of transfers, where the link reaches it without a copy if there is such memory; close
     * frees it. NULL function: malloc does as well. NULL: no memory. */
    uint8_t *(*allocate)(hp_transport *transport, size_t bytes);
    /* Completes what is pending with HP_ERROR_CANCELLED and frees the transport. */
    void (*close)(hp_transport *transport);
} hp_transport_ops;

/* The head of every transport's own struct. */
struct hp_transport {
    const hp_transport_ops *ops;
};

/* A link with no board: takes every packet, answers none. For measuring the driver alone and for its time-outs. */
hp_status hp_transport_null(hp_transport **transport);

/* The simulated board in this process. */
hp_status hp_transport_model(const hp_board_def *def, hp_transport **transport);

/* The board behind a model transport (its isa, its counters without a packet), or NULL for another kind. */
hp_board *hp_transport_model_board(hp_transport *transport);

#endif
