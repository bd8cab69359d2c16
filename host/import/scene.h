/* What rays are traced against: a mesh or a heightfield as triangles, and the box around it. */
#ifndef HITPIPE_HOST_SCENE_H
#define HITPIPE_HOST_SCENE_H

#include "host/import/mesh.h"

typedef struct hp_bounds {
    double low[3], high[3];
} hp_bounds;

/* How to take a heightfield; refused for a mesh. Zeros: as it is in the file. */
typedef struct hp_scene_def {
    size_t rows, columns; /* resample to these */
    double spacing[2];    /* instead of the file's, between the file's own samples */
} hp_scene_def;

typedef struct hp_scene {
    hp_mesh mesh;
    hp_bounds bounds;
    size_t rows, columns; /* samples of a heightfield; 0 of a mesh */
} hp_scene;

/* Loads a scene by its extension: .exr and .pgm are heightfields, everything else meshes. Errors as hp_mesh_load and
 * hp_heightfield_load; HP_ERROR_USAGE: resampling or spacing of a mesh, fewer than 2 x 2 samples. The caller frees.
 */
hp_status hp_scene_load(const char *path, const hp_scene_def *def, hp_scene *scene, hp_fault *fault);
void hp_scene_free(hp_scene *scene);

#endif
