/* Portable graymaps: P2 (decimal) and P5 (binary), up to 65535, comments from '#' to the line's end (Netpbm's
 * pgm(5)). */
#ifndef HITPIPE_HOST_PGM_H
#define HITPIPE_HOST_PGM_H

#include "host/import/bytes.h"

/* The samples as numbers, row by row from the top; the caller frees *samples. On failure nothing is to be freed.
 * HP_ERROR_INPUT: no PGM, truncated, a sample above the file's maximum. HP_ERROR_MEMORY. */
hp_status hp_pgm_read(const hp_bytes *bytes, size_t *rows, size_t *columns, float **samples, hp_fault *fault);

#endif
