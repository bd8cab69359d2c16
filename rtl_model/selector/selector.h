/* The function selector, clock by clock: meets groups of primaries with the oldest secondary. */
#ifndef HITPIPE_SELECTOR_H
#define HITPIPE_SELECTOR_H

#include "rtl_model/regfile/secondary.h"

typedef struct hp_selector {
    const hp_query *query;
    bool secondary_outer;
    unsigned lanes, groups;
    unsigned group;  /* whose test is next */
    uint32_t object; /* number of the oldest secondary in its sweep */
    uint64_t rest;   /* clocks until the pipe's interval has passed */
    unsigned interval;
    bool over;                         /* no test is left */
    bool stopped[HP_PACKET_PRIMARIES]; /* mode any: the primary has its hit */
} hp_selector;

void hp_selector_begin(hp_selector *selector, const hp_query *query, const hp_config *config, unsigned interval);

/* Times the secondaries have to be read. */
unsigned hp_selector_sweeps(const hp_selector *selector);

/* First active primary of the group whose test is next, and how many the group has. */
static inline unsigned hp_selector_first(const hp_selector *selector) {
    return selector->group * selector->lanes;
}
unsigned hp_selector_size(const hp_selector *selector);

/* The next test was issued: goes on to the test after it, and releases the secondary after its last. */
void hp_selector_issued(hp_selector *selector, hp_secondary_file *file);

/* Primaries were stopped in this clock: passes over groups that have none left. */
void hp_selector_pass_over(hp_selector *selector, hp_secondary_file *file);

#endif
