/* Heightfields: a grid of heights, from an EXR channel or a PGM, as triangles.
 *
 * Sample (row i, column j) stands at x = j * spacing[0], y = i * spacing[1], z = its height. A cell (i, j) makes two
 * triangles, (i,j),(i,j+1),(i+1,j) and (i,j+1),(i+1,j+1),(i+1,j); cells in row-major order. */
#ifndef HITPIPE_HOST_HEIGHTFIELD_H
#define HITPIPE_HOST_HEIGHTFIELD_H

#include "host/import/mesh.h"

typedef struct hp_heightfield {
    size_t rows, columns;
    float *heights;    /* rows * columns, row by row */
    double spacing[2]; /* lengths between columns and between rows; of either sign, default 1 */
} hp_heightfield;

/* Whether a path is a heightfield's by its extension: .exr, .pgm. */
bool hp_is_heightfield(const char *path);

/* From memory. EXR: its only channel, or of several the one named "height", "Z" or "Y"; uint, half or float; the
 * spacing from the v2f attribute "spacing". PGM: P2 or P5, 8 or 16 bits (Netpbm's pgm(5)). The caller frees.
 * HP_ERROR_INPUT: corrupt or truncated, a NaN or infinite height, fewer than 2 rows or columns. HP_ERROR_MEMORY. */
hp_status hp_heightfield_read_exr(const hp_bytes *bytes, hp_heightfield *field, hp_fault *fault);
hp_status hp_heightfield_read_pgm(const hp_bytes *bytes, hp_heightfield *field, hp_fault *fault);

/* From a file, by its extension. Errors as above. */
hp_status hp_heightfield_load(const char *path, hp_heightfield *field, hp_fault *fault);

/* Replaces the grid by one of rows x columns (2 at least) over the same area: bilinear, corners on corners, computed
 * in double and rounded once. HP_ERROR_MEMORY leaves the field as it was. */
hp_status hp_heightfield_resample(hp_heightfield *field, size_t rows, size_t columns, hp_fault *fault);

/* 2 (rows-1) (columns-1) triangles. HP_ERROR_MEMORY, HP_ERROR_INPUT (a coordinate past binary32): *mesh is empty. */
hp_status hp_heightfield_mesh(const hp_heightfield *field, hp_mesh *mesh, hp_fault *fault);

void hp_heightfield_free(hp_heightfield *field);

#endif
