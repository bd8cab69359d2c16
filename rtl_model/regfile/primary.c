#include "primary.h"
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

static void load_primary(hp_query *query, unsigned number, const uint8_t *bytes) {
    unsigned words = hp_object_words(query->primary);
    float *primary = query->words + (size_t)query->active * words;
    memcpy(primary, bytes, 4 * words);
    for (unsigned w = 0; w < words; w++) query->lanes.word[w][query->active] = primary[w];
    query->number[query->active++] = (uint16_t)number;
}

hp_query *hp_query_create(const uint8_t *payload) {
    size_t room = (sizeof(hp_query) + 63) / 64 * 64;
    hp_query *query = aligned_alloc(64, room);
    if (!query) return NULL;
    memset(query, 0, room);
    query->users = 1;
    query->pair = (hp_pair)hp_get32(payload + HP_AT_QUERY_pair);
    query->mode = (hp_mode)hp_get32(payload + HP_AT_QUERY_mode);
    uint32_t options = hp_get32(payload + HP_AT_QUERY_options);
    query->separation = options & HP_OPTION_SEPARATION;
    query->nearest = options & HP_OPTION_NEAREST;
    query->first = hp_get32(payload + HP_AT_QUERY_first);
    query->count = hp_get32(payload + HP_AT_QUERY_count);
    query->primaries = hp_get32(payload + HP_AT_QUERY_primaries);
    query->primary = hp_pair_primary(query->pair);
    query->secondary = hp_pair_secondary(query->pair);
    const uint8_t *stencil = payload + HP_AT_QUERY_stencil;
    for (unsigned i = 0; i < query->primaries; i++)
        if (stencil[i / 8] >> i % 8 & 1)
            load_primary(query, i, payload + HP_QUERY_FIXED + (size_t)i * 4 * hp_object_words(query->primary));
    return query;
}

void hp_query_release(hp_query *query) {
    if (query && --query->users == 0) free(query);
}
