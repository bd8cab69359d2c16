/* The primary register file: block RAM that holds the packet of primaries under test, structure-of-arrays, and with
 * it the query they are tested for. Only active primaries (those in the stencil) are kept, in their order. */
#ifndef HITPIPE_PRIMARY_H
#define HITPIPE_PRIMARY_H

#include "rtl_model/pipes/wide.h"
#include <hitpipe/config.h>

typedef struct hp_query {
    hp_lanes lanes; /* active primaries as the wide pipes read them */
    hp_pair pair;
    hp_mode mode;
    bool separation, nearest;   /* options */
    uint32_t first, count;      /* secondaries */
    unsigned primaries, active; /* in the packet; of them in the stencil */
    bool moved;                 /* secondaries pass through the transformer */
    float matrix[12];
    hp_object primary, secondary;                           /* types of the pair */
    unsigned users;                                         /* the command and the answers that still need it */
    uint16_t number[HP_PACKET_PRIMARIES];                   /* number in the packet of active primary i */
    float words[HP_PACKET_PRIMARIES * HP_OBJECT_WORDS_MAX]; /* active primaries one after another */
    hp_result results[HP_PACKET_PRIMARIES];                 /* closest, any, zip: record of active primary i */
} hp_query;

/* A query over the payload of a QUERY packet that the decoder has found right. NULL: out of memory. */
hp_query *hp_query_create(const uint8_t *payload);
void hp_query_release(hp_query *query);

/* Words of active primary i. */
static inline const float *hp_query_primary(const hp_query *query, unsigned i) {
    return query->words + (size_t)i * hp_object_words(query->primary);
}

/* Scene index of the secondary that meets active primary i in mode zip; in other modes of secondary k. */
static inline uint32_t hp_query_secondary(const hp_query *query, unsigned i, uint32_t k) {
    return query->first + (query->mode == HP_MODE_ZIP ? query->number[i] : k);
}

/* Whether every test leaves a record of its own. */
static inline bool hp_query_records_tests(const hp_query *query) {
    return query->mode == HP_MODE_ALL || query->mode == HP_MODE_ZIP;
}

/* Records of the whole answer. */
static inline uint64_t hp_query_records(const hp_query *query) {
    return query->mode == HP_MODE_ALL ? (uint64_t)query->active * query->count : query->active;
}

#endif
