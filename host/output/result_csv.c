#include "host/output/result_csv.h"

#include <inttypes.h>

void hp_result_csv_header(FILE *file) {
    fputs("primary,secondary,F,T,cpx,cpy,cpz\n", file);
}

void hp_result_csv_line(FILE *file, uint64_t primary, uint32_t secondary, const hp_result *result) {
    fprintf(file, "%" PRIu64 ",%" PRIu32 ",%" PRIu32 ",%.9g,%.9g,%.9g,%.9g\n", primary, secondary, result->F,
            (double)result->T, (double)result->CP[0], (double)result->CP[1], (double)result->CP[2]);
}
