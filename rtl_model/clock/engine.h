/* What a timing engine is to the board: the part that lets time pass.
 *
 * Both engines go through the clocks in the order of docs/timing.md. At the start of a clock, transfers arrive, a
 * command ends, and the host acts; then the decoder, the sequencer and the link start what they can; then the blocks
 * work. */
#ifndef HITPIPE_ENGINE_H
#define HITPIPE_ENGINE_H

#include <hitpipe/board.h>

struct hp_answer;

typedef struct hp_engine {
    hp_status (*create)(hp_board *board);
    void (*destroy)(hp_board *board);
    /* Lets time pass until something arrives at an end of the link, or returns false: nothing is under way. */
    bool (*run)(hp_board *board);
    /* Writes the records [first, first + count) of the RESULT that just arrived at the host. */
    void (*records)(hp_board *board, const struct hp_answer *answer, uint8_t *bytes);
    /* The scene is about to change: answers that still wait for the link must not see it. */
    hp_status (*settle)(hp_board *board);
    /* Whether a command is carried out: that of the oldest packet held. */
    bool (*executing)(const hp_board *board);
    /* The decoder and the link to the board have nothing under way any more: the board drops the packets whose
     * commands have not begun. */
    void (*drop_waiting)(hp_board *board);
    /* Nothing is under way any more, but the memory's refresh. */
    void (*reset)(hp_board *board);
} hp_engine;

extern const hp_engine hp_engine_quick, hp_engine_clocked;

#endif
