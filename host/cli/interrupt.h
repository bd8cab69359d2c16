/* Ctrl-C: the first one asks for an orderly end, so that a board is left as it should be; the second one kills. */
#ifndef HITPIPE_HOST_INTERRUPT_H
#define HITPIPE_HOST_INTERRUPT_H

#include <stdbool.h>

/* From now on. Calling it again does nothing. */
void hp_interrupt_watch(void);

/* Whether Ctrl-C was pressed since. */
bool hp_interrupted(void);

#endif
