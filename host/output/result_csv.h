/* Results as text: a line each, primary,secondary,F,T,cpx,cpy,cpz. Floats have nine significant digits, so that they
 * read back to the same bits; a miss has T inf, and in the modes that keep one of many secondary 4294967295. */
#ifndef HITPIPE_HOST_RESULT_CSV_H
#define HITPIPE_HOST_RESULT_CSV_H

#include <hitpipe/types.h>
#include <stdio.h>

void hp_result_csv_header(FILE *file);
void hp_result_csv_line(FILE *file, uint64_t primary, uint32_t secondary, const hp_result *result);

#endif
