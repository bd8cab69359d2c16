/* Commands: what the packet decoder makes of a packet, and the session they act on. */
#ifndef HITPIPE_COMMAND_H
#define HITPIPE_COMMAND_H

#include <hitpipe/config.h>
#include <hitpipe/packet.h>

/* What the board remembers between commands; HELLO clears it. */
typedef struct hp_session {
    bool open;         /* there was a HELLO */
    uint32_t expected; /* sequence number of the next packet */
    hp_object object;  /* type of the scene's secondaries, 0: no scene */
    uint32_t present;  /* how many */
    bool moved;        /* the transformer is on */
    float matrix[12];
    unsigned selected; /* hp_selection of the last query, 0: none */
} hp_session;

typedef struct hp_command {
    hp_opcode opcode; /* of a command that is carried out; HP_OPCODE_ERROR for one that is refused */
    uint32_t tag;
    hp_status status; /* why it is refused */
    uint32_t detail;
    bool advances;          /* the packet was taken: the next one is expected */
    const uint8_t *payload; /* points into the packet */
} hp_command;

/* What one packet asks for. `lost`: the board had no buffer for it, so only its header (if n reaches so far) is
 * there. Everything that can be wrong with the bytes is found here; what is carried out later needs no check. */
hp_command hp_decode(const hp_config *config, const hp_session *session, const uint8_t *packet, size_t n, bool lost);

#endif
