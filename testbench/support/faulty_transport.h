/* A link with faults: wraps another transport and does to the packets what cables, hubs and bad firmware do.
 *
 * Each packet that passes, in either direction, is shown to `choose`, which says what happens to it. */
#ifndef HITPIPE_FAULTY_TRANSPORT_H
#define HITPIPE_FAULTY_TRANSPORT_H

#include "driver/transport/transport.h"

typedef enum fault_kind {
    FAULT_NONE,
    FAULT_DROP,
    FAULT_DUPLICATE,
    FAULT_SWAP,       /* comes after the next one of its direction */
    FAULT_TRUNCATE,   /* to `argument` bytes less; at least 1 is left */
    FAULT_FLIP,       /* bit `argument`, modulo the packet's bits */
    FAULT_DELAY,      /* until nothing else happens; `argument` silences later */
    FAULT_DISCONNECT, /* and everything behind it */
    FAULT_BABBLE,     /* to the host: comes `argument` times, and nothing else does; then the link is gone */
    FAULT_KINDS
} fault_kind;

typedef struct fault {
    fault_kind kind;
    unsigned argument;
} fault;

/* Packet `number` (from 0) of its direction, `in`: to the host. */
typedef fault faulty_choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n);

/* `inner` becomes the new transport's, also on error. */
hp_status faulty_transport(hp_transport *inner, faulty_choose *choose, void *context, hp_transport **transport);

#endif
