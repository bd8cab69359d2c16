/* The DDR controller, clock by clock. */
#ifndef HITPIPE_CONTROLLER_H
#define HITPIPE_CONTROLLER_H

#include "ddr.h"

typedef struct hp_controller {
    const hp_config *config;
    hp_ddr_state state; /* of the present clock */
    uint64_t left;      /* clocks that a refresh or an opening still takes after the present one */
    bool row_open;
    uint64_t row_first; /* first beat of the open row */
    uint64_t interval;  /* clocks since the last multiple of the refresh interval */
    bool due;           /* a refresh */
    uint64_t beat;      /* address of the present clock */
} hp_controller;

hp_controller hp_controller_reset(const hp_config *config);

/* One clock, in which `beat` is wanted if `wanted`. Returns whether it was moved. */
bool hp_controller_tick(hp_controller *controller, bool wanted, uint64_t beat);

#endif
