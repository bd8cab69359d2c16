/* A triangle mesh, and the files it comes from.
 *
 * Triangles are numbered in file order; a polygon of k corners becomes the fan (0,1,2), (0,2,3) ... of k - 2
 * triangles. Nothing is merged, sorted or dropped. Coordinates are binary32: decimal text becomes the nearest one.
 * Plain values without shared state: any thread. */
#ifndef HITPIPE_HOST_MESH_H
#define HITPIPE_HOST_MESH_H

#include "host/import/bytes.h"

typedef struct hp_mesh {
    float *words;      /* HP_TRIANGLE_WORDS a triangle: v0 xyz, v1 xyz, v2 xyz */
    size_t count;      /* triangles */
    size_t degenerate; /* how many of them have exactly no area: kept, and never hit */
    size_t room;       /* triangles that fit in `words` */
} hp_mesh;

/* Loads the mesh in a file: OBJ, PLY and STL by the readers below, everything else through assimp.
 * HP_ERROR_INPUT names file, place and cause: unreadable, truncated, corrupt, no triangle, a NaN or infinite
 * coordinate, an index out of range. HP_ERROR_MEMORY. On error *mesh is empty. The caller frees with hp_mesh_free. */
hp_status hp_mesh_load(const char *path, hp_mesh *mesh, hp_fault *fault);

/* The same from memory. *mesh may hold triangles already; on error the caller still frees it. */
hp_status hp_mesh_read_obj(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault);
hp_status hp_mesh_read_ply(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault); /* ascii, binary of both endians */
hp_status hp_mesh_read_stl(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault); /* ascii, binary */

/* Any format of assimp. Its text formats parse decimals in binary32 arithmetic, which can miss the nearest one by
 * some units in the last place: that is why OBJ, PLY and STL have readers of their own. */
hp_status hp_mesh_read_assimp(const char *path, hp_mesh *mesh, hp_fault *fault);

/* Makes room for that many triangles at once: no more is taken than they need, and what does not fit shows before any
 * work. False: out of memory. */
bool hp_mesh_reserve(hp_mesh *mesh, size_t count);

/* Adds a triangle of three vertices (xyz each). False: out of memory. */
bool hp_mesh_add(hp_mesh *mesh, const float *v0, const float *v1, const float *v2);

void hp_mesh_free(hp_mesh *mesh);

/* Whether the corners of a triangle (9 words) lie exactly on a line, decided without rounding. */
bool hp_triangle_degenerate(const float *words);

#endif
