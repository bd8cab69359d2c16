/* A board as a stranger would build it from docs/protocol.md: offsets and codes are typed in from that page, not
 * taken from the tables, and it takes no time. It speaks ray-triangle. So the driver is tested against the page, not
 * against itself. */
#ifndef HITPIPE_STRANGER_H
#define HITPIPE_STRANGER_H

#include "driver/transport/transport.h"

typedef struct stranger_def {
    unsigned packet_size, buffers, lanes;
    unsigned records; /* most in a RESULT */
    bool secondary_outer;
} stranger_def;

hp_status stranger_open(const stranger_def *def, hp_transport **transport);

/* Power goes off and on again. */
void stranger_reset(hp_transport *transport);

/* Commands carried out since stranger_open, by opcode. */
unsigned stranger_count(hp_transport *transport, unsigned opcode);

#endif
