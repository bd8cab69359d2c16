/* The secondary register file with what feeds it, clock by clock: the reader that asks the DDR for objects in the
 * order of the query, and the queue of objects that are read: in the DDR's latency, in the transformer, or ready. */
#ifndef HITPIPE_SECONDARY_H
#define HITPIPE_SECONDARY_H

#include "primary.h"
#include "rtl_model/memory/ddr.h"

typedef struct hp_secondary {
    float words[HP_OBJECT_WORDS_MAX];
    uint32_t index;        /* in the scene */
    uint64_t ready;        /* first clock in which it can be issued */
    uint64_t refresh, row; /* clocks it was held up by, not yet counted as waited */
} hp_secondary;

typedef struct hp_secondary_file {
    const hp_config *config;
    const hp_ddr *ddr;
    const hp_query *query;
    unsigned transformer_clocks, beats, words;
    unsigned sweeps; /* times the secondaries are read: 1, or once a group */
    uint32_t per_sweep;
    /* reader: what it reads now */
    unsigned sweep;
    uint32_t object;
    unsigned beat;
    hp_secondary reading;
    /* queue */
    hp_secondary *entries;
    uint64_t head, count;
} hp_secondary_file;

hp_status hp_secondary_create(hp_secondary_file *file, const hp_config *config, const hp_ddr *ddr);
void hp_secondary_free(hp_secondary_file *file);
void hp_secondary_begin(hp_secondary_file *file, const hp_query *query, unsigned sweeps, unsigned transformer_clocks);

/* Whether a beat is wanted, and its address. */
bool hp_secondary_wants(const hp_secondary_file *file);
uint64_t hp_secondary_address(const hp_secondary_file *file);

/* The wanted beat came in this clock. Returns whether it was an object's last. */
bool hp_secondary_take(hp_secondary_file *file, uint64_t clock);

/* The controller held up the object being read. */
void hp_secondary_held_up(hp_secondary_file *file, hp_ddr_state by);

/* The oldest object, NULL when none is read. */
static inline hp_secondary *hp_secondary_oldest(hp_secondary_file *file) {
    return file->count ? &file->entries[file->head] : NULL;
}

void hp_secondary_release(hp_secondary_file *file);

/* Everything read or being read is dropped, and reading goes on with this sweep. */
void hp_secondary_restart(hp_secondary_file *file, unsigned sweep);

/* The cause that a clock of waiting for the oldest object, or the one being read, counts to. */
hp_ddr_state hp_secondary_wait(hp_secondary_file *file);

#endif
