/* The vertices of a mesh file while it is read, and the polygons over them. */
#ifndef HITPIPE_HOST_VERTICES_H
#define HITPIPE_HOST_VERTICES_H

#include "host/import/mesh.h"

typedef struct hp_vertices {
    float (*xyz)[3];
    size_t count, room;
} hp_vertices;

/* What is wrong with a coordinate triple ("coordinate is NaN"), or NULL. */
const char *hp_vertex_fault(const float xyz[3]);

bool hp_vertices_add(hp_vertices *vertices, const float xyz[3]); /* false: out of memory */
void hp_vertices_free(hp_vertices *vertices);

/* A polygon taken corner by corner: from the third on, each makes a triangle of the fan. Start with zeros. */
typedef struct hp_fan {
    size_t corners;
    const float *first, *last;
} hp_fan;
bool hp_fan_corner(hp_fan *fan, hp_mesh *mesh, const float *xyz); /* false: out of memory */

#endif
