/* Makes an EXR heightfield of a PGM, with its provenance in the header.
 *
 *     pgm_to_exr IN.pgm OUT.exr SPACING_X SPACING_Y OWNER COMMENTS
 *
 * One float channel "height" of the same numbers; attributes "spacing", "owner", "comments". */
#include "host/import/exr.h"
#include "host/import/pgm.h"
#include "host/import/text.h"
#include "host/output/file.h"

#include <stdlib.h>
#include <string.h>

static hp_status convert(const hp_bytes *pgm, const char *out, const float spacing[2], const hp_exr_text *texts,
                         hp_fault *fault) {
    size_t rows, columns;
    float *samples;
    if (hp_pgm_read(pgm, &rows, &columns, &samples, fault) != HP_OK) return fault->status;
    hp_exr image;
    hp_bytes exr;
    hp_exr_create(&image, columns, rows);
    image.texts = texts;
    memcpy(image.spacing, spacing, sizeof image.spacing);
    uint32_t *words = hp_exr_add_channel(&image, "height", HP_EXR_FLOAT);
    hp_status status = words ? HP_OK : hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", out);
    if (words) memcpy(words, samples, rows * columns * sizeof *words);
    free(samples);
    if (status == HP_OK) status = hp_exr_write(&image, out, &exr, fault);
    hp_exr_free(&image);
    if (status != HP_OK) return status;
    status = hp_file_write(out, exr.data, exr.n, fault);
    hp_bytes_free(&exr);
    return status;
}

int main(int argc, char **argv) {
    float spacing[2];
    if (argc != 7 || !hp_parse_float(argv[3], &spacing[0]) || !hp_parse_float(argv[4], &spacing[1])) {
        fputs("usage: pgm_to_exr IN.pgm OUT.exr SPACING_X SPACING_Y OWNER COMMENTS\n", stderr);
        return hp_status_exit(HP_ERROR_USAGE);
    }
    const hp_exr_text texts[] = {{"owner", argv[5]}, {"comments", argv[6]}, {NULL, NULL}};
    hp_fault fault;
    hp_bytes pgm;
    hp_status status = hp_bytes_read(argv[1], &pgm, &fault);
    if (status == HP_OK) {
        status = convert(&pgm, argv[2], spacing, texts, &fault);
        hp_bytes_free(&pgm);
    }
    if (status != HP_OK) fprintf(stderr, "pgm_to_exr: %s\n", fault.message);
    return hp_status_exit(status);
}
