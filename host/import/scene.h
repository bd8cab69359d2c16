/* What rays are traced against: a mesh or a heightfield as triangles, or objects of a CSV file, and the box around
 * all. */
#ifndef HITPIPE_HOST_SCENE_H
#define HITPIPE_HOST_SCENE_H

#include "host/import/mesh.h"
#include "host/import/shape.h"

/* How to take a scene. Zeros: as it is in the file. */
typedef struct hp_scene_def {
    hp_object objects;    /* the file is CSV, and its lines are these; 0: by its name, and the numbers of a line */
    size_t rows, columns; /* resample a heightfield to these */
    double spacing[2];    /* of a heightfield, instead of the file's, between the file's own samples */
} hp_scene_def;

typedef struct hp_scene {
    hp_object object; /* triangle, sphere or cylinder */
    float *words;     /* hp_object_words(object) each */
    size_t count;
    size_t degenerate; /* triangles without area */
    hp_bounds bounds;
    size_t rows, columns; /* samples of a heightfield; else 0 */
} hp_scene;

/* The pipe for rays against these objects; 0: there is none. */
hp_pair hp_ray_pair(hp_object object);

/* The type that rays can be traced against and that has so many numbers; 0: there is none. */
hp_object hp_scene_object(unsigned words);

/* Loads a scene by its extension: .exr and .pgm are heightfields, .csv objects (hp_csv_read) of the type that has as
 * many numbers as its first line, everything else meshes. Errors as hp_csv_load, hp_mesh_load and
 * hp_heightfield_load; HP_ERROR_INPUT: a line with a number of numbers that is no such object's; HP_ERROR_USAGE:
 * resampling or spacing of what is no heightfield, fewer than 2 x 2 samples. The caller frees. */
hp_status hp_scene_load(const char *path, const hp_scene_def *def, hp_scene *scene, hp_fault *fault);
void hp_scene_free(hp_scene *scene);

#endif
