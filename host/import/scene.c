#include "host/import/scene.h"

#include "host/import/csv.h"
#include "host/import/heightfield.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

void hp_scene_free(hp_scene *scene) {
    free(scene->words);
    *scene = (hp_scene){0};
}

hp_pair hp_ray_pair(hp_object object) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    if (HP_##PRIMARY == HP_RAY && HP_##SECONDARY == object) return HP_PAIR_##NAME;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    return (hp_pair)0;
}

hp_object hp_scene_object(unsigned words) {
#define HP_OBJECT(name, NAME, code, n, layout)                                                                       \
    if (n == words && hp_ray_pair(HP_##NAME)) return HP_##NAME;
#include <hitpipe/objects.def>
#undef HP_OBJECT
    return (hp_object)0;
}

/* The mesh's triangles become the scene's. */
static void take_mesh(hp_mesh *mesh, hp_scene *scene) {
    scene->object = HP_TRIANGLE;
    scene->words = mesh->words;
    scene->count = mesh->count;
    scene->degenerate = mesh->degenerate;
}

static hp_status load_mesh(const char *path, hp_scene *scene, hp_fault *fault) {
    hp_mesh mesh;
    hp_status status = hp_mesh_load(path, &mesh, fault);
    if (status == HP_OK) take_mesh(&mesh, scene);
    return status;
}

static hp_status load_heightfield(const char *path, const hp_scene_def *def, hp_scene *scene, hp_fault *fault) {
    hp_heightfield field;
    hp_mesh mesh;
    hp_status status = hp_heightfield_load(path, &field, fault);
    if (status != HP_OK) return status;
    for (int axis = 0; axis < 2 && def->spacing[0] != 0; axis++) field.spacing[axis] = def->spacing[axis];
    if (def->rows != 0) status = hp_heightfield_resample(&field, def->rows, def->columns, fault);
    if (status == HP_OK) status = hp_heightfield_mesh(&field, &mesh, fault);
    if (status == HP_OK) take_mesh(&mesh, scene);
    scene->rows = field.rows;
    scene->columns = field.columns;
    hp_heightfield_free(&field);
    return status;
}

static hp_status read_objects(const hp_bytes *bytes, hp_object object, hp_scene *scene, hp_fault *fault) {
    unsigned numbers = hp_csv_numbers(bytes);
    scene->object = object ? object : hp_scene_object(numbers);
    if (!scene->object && numbers > 0)
        return hp_fault_set(fault, HP_ERROR_INPUT,
                            "%s: objects of %u numbers: rays meet spheres (4), cylinders (7) and triangles (9)",
                            bytes->name, numbers);
    hp_objects objects;
    hp_status status = hp_csv_read(bytes, scene->object ? scene->object : HP_TRIANGLE, &objects, fault);
    if (status != HP_OK) return status;
    scene->words = objects.words;
    scene->count = objects.count;
    for (size_t i = 0; scene->object == HP_TRIANGLE && i < scene->count; i++)
        scene->degenerate += hp_triangle_degenerate(scene->words + i * HP_TRIANGLE_WORDS);
    return HP_OK;
}

static hp_status load_objects(const char *path, hp_object object, hp_scene *scene, hp_fault *fault) {
    hp_bytes bytes;
    hp_status status = hp_bytes_read(path, &bytes, fault);
    if (status != HP_OK) return status;
    status = read_objects(&bytes, object, scene, fault);
    hp_bytes_free(&bytes);
    return status;
}

static hp_bounds bounds_of(const hp_scene *scene) {
    hp_bounds bounds = hp_bounds_none();
    for (size_t i = 0; i < scene->count; i++) {
        hp_bounds inner = hp_shape_bounds(scene->object, scene->words + i * hp_object_words(scene->object));
        hp_bounds_add(&bounds, &inner);
    }
    return bounds;
}

static bool is_csv(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, ".csv") == 0;
}

hp_status hp_scene_load(const char *path, const hp_scene_def *def, hp_scene *scene, hp_fault *fault) {
    *scene = (hp_scene){0};
    bool objects = def->objects || is_csv(path), field = !objects && hp_is_heightfield(path);
    bool as_field = def->rows != 0 || def->spacing[0] != 0;
    if (as_field && !field)
        return hp_fault_set(fault, HP_ERROR_USAGE, "%s: only heightfields (.exr, .pgm) are resampled or spaced",
                            path);
    if (def->rows != 0 && (def->rows < 2 || def->columns < 2))
        return hp_fault_set(fault, HP_ERROR_USAGE, "resampling needs 2 x 2 samples at least");
    hp_status status = objects ? load_objects(path, def->objects, scene, fault)
                       : field ? load_heightfield(path, def, scene, fault)
                               : load_mesh(path, scene, fault);
    if (status == HP_OK) scene->bounds = bounds_of(scene);
    return status;
}
