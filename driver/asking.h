/* A query call under way: what hp_query and hp_query_all have in common. Not part of the public interface. */
#ifndef HITPIPE_ASKING_H
#define HITPIPE_ASKING_H

#include "device.h"

/* The part of the primaries that one QUERY packet asks for. */
typedef struct hp_part {
    size_t first;                       /* primary */
    unsigned primaries;                 /* in the packet */
    unsigned active;                    /* of those: in the stencil */
    uint8_t order[HP_PACKET_PRIMARIES]; /* the active ones, ascending, from 0 in the packet */
    uint32_t first_secondary, secondaries;
    uint64_t records; /* that will answer it */
} hp_part;

typedef struct hp_asking {
    hp_device *device;
    const hp_query_def *def;
    const float *primaries;
    size_t n;             /* primaries */
    size_t packet;        /* primaries in a packet */
    uint32_t secondaries; /* to test each with; mode zip: n */
    hp_take_answer *take;
    size_t answered;         /* primaries, from the first on: packets are answered in order */
    uint64_t had;            /* mode all: records of the packet behind those, which the taker has already */
    uint64_t taken;          /* results and records that came, each counted once: how far the call has got */
    hp_result *results;      /* hp_query */
    hp_records_taker *taker; /* hp_query_all */
    void *context;
    hp_part parts[HP_WINDOW_MAX]; /* by slot */
} hp_asking;

/* Begins a call: settles what an earlier one left, checks def and primaries, and fills in all but whom the answers
 * are for. No query is sent. HP_ERROR_USAGE for a device that is NULL. */
hp_status hp_begin_asking(hp_asking *asking, hp_device *device, const hp_query_def *def, const float *primaries,
                          size_t n, hp_take_answer *take);

/* Asks for all primaries and waits for the answers. */
hp_status hp_ask_all(hp_asking *asking);

/* Whether a RESULT payload goes on where the command stands: then its records, and *count of them; else NULL. */
const uint8_t *hp_next_records(const hp_command *command, const hp_part *part, const uint8_t *payload,
                               uint32_t length, bool last, uint32_t *count);

/* Whether a record can be true: F is 0 or 1, and a miss has no index. */
bool hp_plausible(const hp_asking *asking, const hp_result *record);

#endif
