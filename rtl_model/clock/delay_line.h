/* A pipe as the clock sees it: `latency` stages, the last of them the output register. Results are computed where a
 * test enters and carried down the stages with it. */
#ifndef HITPIPE_DELAY_LINE_H
#define HITPIPE_DELAY_LINE_H

#include <hitpipe/types.h>

typedef struct hp_stage {
    bool valid;
    unsigned first, lanes; /* active primaries tested */
    uint32_t index;        /* the secondary */
    uint64_t tested;       /* bit set: the lane is a test */
    hp_result *results;    /* of the lanes; the delay line's */
} hp_stage;

typedef struct hp_delay_line {
    hp_stage *stages;   /* ring of latency - 1, and one more that is on its way in */
    hp_result *results; /* room of all stages and of the output register */
    unsigned room;      /* stages */
    unsigned length, at, inside;
    hp_stage output; /* the output register */
} hp_delay_line;

/* Empties the line and gives it a length. A line of zeros is one without room yet; `lanes` is always the same. */
hp_status hp_delay_line_begin(hp_delay_line *line, unsigned latency, unsigned lanes);
void hp_delay_line_free(hp_delay_line *line);

/* Where a test that enters in this clock is to be written; `valid` is false when none does. */
static inline hp_stage *hp_delay_line_entry(hp_delay_line *line) {
    return &line->stages[line->at];
}

/* The pipe moves: the entry goes in, the oldest stage into the output register. */
void hp_delay_line_move(hp_delay_line *line);

#endif
