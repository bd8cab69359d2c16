/* The output SRAMs: a queue of records, seven words each, of the clocked engine. */
#ifndef HITPIPE_SRAM_H
#define HITPIPE_SRAM_H

#include <hitpipe/types.h>

typedef struct hp_sram {
    hp_result *records; /* ring */
    uint64_t room, head, count;
    uint64_t capacity; /* knob sram.records */
} hp_sram;

/* Memory for `records` in all, or for the capacity if that is less. HP_ERROR_MEMORY: nothing changes. */
hp_status hp_sram_reserve(hp_sram *sram, uint64_t records);
void hp_sram_free(hp_sram *sram);

static inline bool hp_sram_full(const hp_sram *sram) {
    return sram->count == sram->capacity;
}

static inline void hp_sram_write(hp_sram *sram, const hp_result *record) {
    uint64_t at = sram->head + sram->count++;
    sram->records[at < sram->room ? at : at - sram->room] = *record;
}

static inline hp_result hp_sram_read(hp_sram *sram) {
    hp_result record = sram->records[sram->head++];
    if (sram->head == sram->room) sram->head = 0;
    sram->count--;
    return record;
}

#endif
