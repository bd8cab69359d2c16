/* The update engine, clock by clock: keeps for each primary the best of its tests.
 *
 *        F, index, CP --> F-index buffer
 *        T -----------> compare <-- stencil-T buffer 0 (read) ---+
 *                          |                                     | turned after each update
 *                          +------> stencil-T buffer 1 (write) --+
 *
 * Block RAM cannot be read and written in one place in one clock, so there are two stencil-T buffers: an entry is
 * read from the one that was written last for its primary, and the outcome is written to the other. */
#ifndef HITPIPE_UPDATE_H
#define HITPIPE_UPDATE_H

#include "rtl_model/regfile/primary.h"

typedef struct hp_stencil_T {
    float T;
    uint32_t stencil; /* 1: the primary is still looking */
} hp_stencil_T;

typedef struct hp_F_index {
    uint32_t F, index;
    float CP[3];
} hp_F_index;

typedef struct hp_update {
    const hp_query *query;
    bool any;
    hp_stencil_T stencil_T[2][HP_PACKET_PRIMARIES];
    uint8_t newest[HP_PACKET_PRIMARIES]; /* buffer written last */
    hp_F_index F_index[HP_PACKET_PRIMARIES];
    /* what the waveform shows of the last update */
    unsigned address, reads;
    uint64_t kept; /* compare results, a bit a lane */
    float T_in, T_read, T_written;
} hp_update;

void hp_update_begin(hp_update *update, const hp_query *query);

/* Compares and keeps the results of `lanes` primaries with secondary `index`, from primary `first` on. `tested`: bit
 * set for each lane that was a test. Returns the lanes whose primary stops with this clock (mode any). */
uint64_t hp_update_take(hp_update *update, unsigned first, unsigned lanes, uint64_t tested, uint32_t index,
                        const hp_result *results);

/* Whether a result takes the place of what was kept so far (index HP_NO_INDEX: nothing) in mode closest. Of equals
 * it does not. */
bool hp_closer(const hp_query *query, const hp_result *result, const hp_result *kept);

/* Record of active primary i. */
hp_result hp_update_record(const hp_update *update, unsigned i);

#endif
