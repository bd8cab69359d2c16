#include "host/import/heightfield.h"

#include "host/import/exr.h"
#include "host/import/pgm.h"
#include "host/import/vertices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void hp_heightfield_free(hp_heightfield *field) {
    free(field->heights);
    *field = (hp_heightfield){0};
}

static hp_status check(const hp_heightfield *field, const char *name, hp_fault *fault) {
    if (field->rows < 2 || field->columns < 2)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %zu x %zu samples; a heightfield needs 2 x 2", name,
                            field->rows, field->columns);
    if (!isfinite(field->spacing[0]) || !isfinite(field->spacing[1]) || field->spacing[0] == 0 ||
        field->spacing[1] == 0)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: the spacing must be finite and not zero", name);
    for (size_t i = 0; i < field->rows * field->columns; i++)
        if (!isfinite(field->heights[i]))
            return hp_fault_set(fault, HP_ERROR_INPUT, "%s: row %zu, column %zu: the height is %s", name,
                                i / field->columns, i % field->columns,
                                isnan(field->heights[i]) ? "NaN" : "infinite");
    return HP_OK;
}

static const hp_exr_channel *height_channel(const hp_exr *image) {
    static const char *const names[] = {"height", "Z", "Y"};
    if (image->channel_count == 1) return &image->channels[0];
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++)
        for (size_t i = 0; i < image->channel_count; i++)
            if (strcmp(image->channels[i].name, names[n]) == 0) return &image->channels[i];
    return NULL;
}

hp_status hp_heightfield_read_exr(const hp_bytes *bytes, hp_heightfield *field, hp_fault *fault) {
    *field = (hp_heightfield){.spacing = {1, 1}};
    hp_exr image;
    hp_status status = hp_exr_read(bytes, &image, fault);
    if (status != HP_OK) return status;
    const hp_exr_channel *channel = height_channel(&image);
    size_t n = image.width * image.height;
    if (!channel)
        status = hp_fault_set(fault, HP_ERROR_INPUT, "%s: several channels, none named height, Z or Y", bytes->name);
    else if (!(field->heights = malloc(n * sizeof(float))))
        status = hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", bytes->name);
    if (status == HP_OK) {
        field->rows = image.height;
        field->columns = image.width;
        if (channel->type == HP_EXR_FLOAT)
            memcpy(field->heights, channel->words, n * sizeof(float));
        else
            for (size_t i = 0; i < n; i++) field->heights[i] = (float)channel->words[i];
        for (int axis = 0; axis < 2 && image.spacing[0] != 0; axis++) field->spacing[axis] = image.spacing[axis];
        status = check(field, bytes->name, fault);
    }
    hp_exr_free(&image);
    if (status != HP_OK) hp_heightfield_free(field);
    return status;
}

hp_status hp_heightfield_read_pgm(const hp_bytes *bytes, hp_heightfield *field, hp_fault *fault) {
    *field = (hp_heightfield){.spacing = {1, 1}};
    hp_status status = hp_pgm_read(bytes, &field->rows, &field->columns, &field->heights, fault);
    if (status == HP_OK) status = check(field, bytes->name, fault);
    if (status != HP_OK) hp_heightfield_free(field);
    return status;
}

static bool ends_in(const char *path, const char *extension) {
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, extension) == 0;
}

bool hp_is_heightfield(const char *path) {
    return ends_in(path, ".exr") || ends_in(path, ".pgm");
}

hp_status hp_heightfield_load(const char *path, hp_heightfield *field, hp_fault *fault) {
    hp_bytes bytes;
    *field = (hp_heightfield){0};
    hp_status status = hp_bytes_read(path, &bytes, fault);
    if (status != HP_OK) return status;
    status = ends_in(path, ".exr") ? hp_heightfield_read_exr(&bytes, field, fault)
                                   : hp_heightfield_read_pgm(&bytes, field, fault);
    hp_bytes_free(&bytes);
    return status;
}

/* Height between samples, at exact place row `i / of_rows` of the way from the first to the last. */
static double between(const hp_heightfield *field, double row, double column) {
    size_t i = (size_t)row, j = (size_t)column;
    if (i > field->rows - 2) i = field->rows - 2;
    if (j > field->columns - 2) j = field->columns - 2;
    double v = row - (double)i, u = column - (double)j;
    const float *upper = field->heights + i * field->columns + j, *lower = upper + field->columns;
    return (1 - v) * ((1 - u) * upper[0] + u * upper[1]) + v * ((1 - u) * lower[0] + u * lower[1]);
}

hp_status hp_heightfield_resample(hp_heightfield *field, size_t rows, size_t columns, hp_fault *fault) {
    float *heights = rows > SIZE_MAX / sizeof(float) / columns ? NULL : malloc(rows * columns * sizeof(float));
    if (!heights) return hp_fault_set(fault, HP_ERROR_MEMORY, "no memory for %zu x %zu samples", rows, columns);
    double old_rows = (double)(field->rows - 1), old_columns = (double)(field->columns - 1);
    double new_rows = (double)(rows - 1), new_columns = (double)(columns - 1);
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < columns; j++)
            heights[i * columns + j] =
                (float)between(field, (double)i * old_rows / new_rows, (double)j * old_columns / new_columns);
    free(field->heights);
    field->heights = heights;
    field->rows = rows;
    field->columns = columns;
    field->spacing[0] *= old_columns / new_columns;
    field->spacing[1] *= old_rows / new_rows;
    return HP_OK;
}

/* A product without the -0 that a negative spacing gives the first row. */
static float length(size_t i, double spacing) {
    return i == 0 ? 0 : (float)((double)i * spacing);
}

static void place(const hp_heightfield *field, size_t i, size_t j, float xyz[3]) {
    xyz[0] = length(j, field->spacing[0]);
    xyz[1] = length(i, field->spacing[1]);
    xyz[2] = field->heights[i * field->columns + j];
}

hp_status hp_heightfield_mesh(const hp_heightfield *field, hp_mesh *mesh, hp_fault *fault) {
    *mesh = (hp_mesh){0};
    float corner[3];
    size_t triangles = 2 * (field->rows - 1) * (field->columns - 1);
    place(field, field->rows - 1, field->columns - 1, corner);
    if (hp_vertex_fault(corner))
        return hp_fault_set(fault, HP_ERROR_INPUT, "the heightfield is too wide: %s", hp_vertex_fault(corner));
    if (!hp_mesh_reserve(mesh, triangles))
        return hp_fault_set(fault, HP_ERROR_MEMORY, "no memory for the heightfield's %zu triangles", triangles);
    for (size_t i = 0; i + 1 < field->rows; i++)
        for (size_t j = 0; j + 1 < field->columns; j++) {
            float v[2][2][3];
            for (size_t k = 0; k < 4; k++) place(field, i + k / 2, j + k % 2, v[k / 2][k % 2]);
            hp_mesh_add(mesh, v[0][0], v[0][1], v[1][0]); /* there is room */
            hp_mesh_add(mesh, v[0][1], v[1][1], v[1][0]);
        }
    return HP_OK;
}
