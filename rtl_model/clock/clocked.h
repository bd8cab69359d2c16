/* The clocked engine: all blocks of the board, and one clock of them. */
#ifndef HITPIPE_CLOCKED_H
#define HITPIPE_CLOCKED_H

#include "delay_line.h"
#include "rtl_model/board/internal.h"
#include "rtl_model/memory/controller.h"
#include "rtl_model/memory/sram.h"
#include "rtl_model/selector/selector.h"
#include "rtl_model/update/update.h"

/* What the sequencer has the blocks do. */
typedef enum hp_activity {
    HP_ACTIVITY_NONE,
    HP_ACTIVITY_COMMAND, /* for a fixed number of clocks */
    HP_ACTIVITY_WRITE,   /* UPLOAD into DDR */
    HP_ACTIVITY_SELECT,  /* the selector changes to another pipe */
    HP_ACTIVITY_TESTS,   /* streaming, up to the last update or record */
    HP_ACTIVITY_FLUSH,   /* the update engine writes its buffers */
    HP_ACTIVITY_ENDED    /* the query ends with the clock */
} hp_activity;

/* Why no test is issued: the group `stalls` of registers.def. */
#define HP_CAUSE_clocks(name)
#define HP_CAUSE_stalls(name) HP_STALL_##name,
#define HP_CAUSE_phase(name)
#define HP_CAUSE_bytes(name)
#define HP_CAUSE_tests(name)
typedef enum hp_stall {
#define HP_REGISTER(group, name, meaning) HP_CAUSE_##group(name)
#include <hitpipe/registers.def>
#undef HP_REGISTER
    HP_STALLS,
    HP_STALL_none = HP_STALLS
} hp_stall;

typedef struct hp_channel {
    bool busy;
    uint64_t left; /* clocks */
    size_t n;      /* bytes */
} hp_channel;

typedef struct hp_clocked {
    hp_channel channel[HP_DIRECTIONS];
    bool decoding;
    uint64_t decode_left;
    unsigned decoded; /* packets decoded whose commands have not begun */
    hp_activity activity;
    uint64_t left; /* clocks of COMMAND and SELECT */
    uint64_t write_beat, write_left;
    hp_controller ddr;
    hp_secondary_file secondary;
    hp_selector selector;
    hp_delay_line pipe;
    unsigned output_left; /* records in the output register not yet written */
    hp_update update;
    unsigned flushed; /* primaries */
    hp_sram sram;
    uint64_t query_start, tests_run;
    uint64_t written, known, total;                 /* records of the query */
    hp_stall stall;                                 /* of the present clock */
    bool issued, moved, wrote, took, updated, full; /* in the present clock */
    struct hp_vcd *vcd;
} hp_clocked;

#endif
