/* What the quick engine answers, by the wide pipes. */
#ifndef HITPIPE_RESULTS_H
#define HITPIPE_RESULTS_H

#include "rtl_model/memory/ddr.h"
#include "rtl_model/regfile/primary.h"

typedef struct hp_results_job {
    const hp_config *config;
    const hp_ddr *ddr;
    const hp_wide_pipe *pipe;
    unsigned threads;
} hp_results_job;

/* closest, any, zip: fills query->results. hit (any; one for each active primary, else NULL) becomes the number,
 * among the query's secondaries, of the one that stops it, or HP_NO_INDEX. */
void hp_results_find(const hp_results_job *job, hp_query *query, uint32_t *hit);

/* all: records [first, first + count) in the order in which the board issues their tests. */
void hp_results_range(const hp_results_job *job, const hp_query *query, uint64_t first, uint32_t count,
                      void (*take)(void *context, uint64_t number, const hp_result *record), void *context);

#endif
