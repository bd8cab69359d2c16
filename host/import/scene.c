#include "host/import/scene.h"

#include "host/import/heightfield.h"

#include <math.h>

void hp_scene_free(hp_scene *scene) {
    hp_mesh_free(&scene->mesh);
}

static hp_bounds bounds_of(const hp_mesh *mesh) {
    hp_bounds bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < mesh->count * HP_TRIANGLE_WORDS; i++) {
        bounds.low[i % 3] = fmin(bounds.low[i % 3], (double)mesh->words[i]);
        bounds.high[i % 3] = fmax(bounds.high[i % 3], (double)mesh->words[i]);
    }
    return bounds;
}

static hp_status load_heightfield(const char *path, const hp_scene_def *def, hp_scene *scene, hp_fault *fault) {
    hp_heightfield field;
    hp_status status = hp_heightfield_load(path, &field, fault);
    if (status != HP_OK) return status;
    for (int axis = 0; axis < 2 && def->spacing[0] != 0; axis++) field.spacing[axis] = def->spacing[axis];
    if (def->rows != 0) status = hp_heightfield_resample(&field, def->rows, def->columns, fault);
    if (status == HP_OK) status = hp_heightfield_mesh(&field, &scene->mesh, fault);
    scene->rows = field.rows;
    scene->columns = field.columns;
    hp_heightfield_free(&field);
    return status;
}

hp_status hp_scene_load(const char *path, const hp_scene_def *def, hp_scene *scene, hp_fault *fault) {
    *scene = (hp_scene){0};
    bool field = hp_is_heightfield(path), as_field = def->rows != 0 || def->spacing[0] != 0;
    if (as_field && !field)
        return hp_fault_set(fault, HP_ERROR_USAGE, "%s: only heightfields (.exr, .pgm) are resampled or spaced",
                            path);
    if (def->rows != 0 && (def->rows < 2 || def->columns < 2))
        return hp_fault_set(fault, HP_ERROR_USAGE, "resampling needs 2 x 2 samples at least");
    hp_status status = field ? load_heightfield(path, def, scene, fault) : hp_mesh_load(path, &scene->mesh, fault);
    if (status == HP_OK) scene->bounds = bounds_of(&scene->mesh);
    return status;
}
