/* Answers: packets for the host, from the clock in which the link knows of them to their arrival. */
#ifndef HITPIPE_ANSWER_H
#define HITPIPE_ANSWER_H

#include "command.h"
#include "rtl_model/regfile/primary.h"
#include <hitpipe/counters.h>

typedef struct hp_answer {
    struct hp_answer *next;
    hp_header header;
    uint32_t detail;       /* ERROR */
    hp_counters *counters; /* COUNTERS_REPLY: the values; the answer's own */
    hp_query *query;       /* RESULT: whose records; the answer is one of its users */
    uint64_t first;        /* RESULT: number of its first record */
    uint32_t count;        /* RESULT: records */
    hp_result *records;    /* RESULT: its records, when they had to be saved; the answer's own */
} hp_answer;

/* An answer to the packet with this tag. `last`: it is the last one, so the packet's credit goes back with it. NULL:
 * out of memory. */
hp_answer *hp_answer_create(const hp_config *config, const hp_session *session, hp_opcode opcode, uint32_t tag,
                            bool last);
void hp_answer_free(hp_answer *answer);

/* Bytes of the whole packet. */
size_t hp_answer_bytes(const hp_answer *answer);

/* Writes the packet, but for a RESULT's records. `packet` has room for hp_answer_bytes. */
void hp_answer_encode(const hp_config *config, const hp_answer *answer, uint8_t *packet);

/* Writes one record as the wire has it. */
void hp_record_encode(const hp_result *record, uint8_t *bytes);

#endif
