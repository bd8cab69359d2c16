/* The counter registers of a board (registers.def) as a struct. */
#ifndef HITPIPE_COUNTERS_H
#define HITPIPE_COUNTERS_H

#include <hitpipe/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hp_counters {
#define HP_REGISTER(group, name, meaning) uint64_t group##_##name;
#include <hitpipe/registers.def>
#undef HP_REGISTER
} hp_counters;

/* Name of register i as in reports ("clocks.total"), its meaning, its value; NULL / 0 past the last. */
const char *hp_register_name(unsigned i);
const char *hp_register_meaning(unsigned i);
uint64_t hp_register_value(const hp_counters *counters, unsigned i);
void hp_register_set(hp_counters *counters, unsigned i, uint64_t value);

enum {
    HP_REGISTER_COUNT = 0
#define HP_REGISTER(group, name, meaning) +1
#include <hitpipe/registers.def>
#undef HP_REGISTER
};

#ifdef __cplusplus
}
#endif
#endif
