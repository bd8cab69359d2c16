#include "host/import/vertices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *hp_vertex_fault(const float xyz[3]) {
    for (int i = 0; i < 3; i++) {
        if (isnan(xyz[i])) return "a coordinate is NaN";
        if (isinf(xyz[i])) return "a coordinate is infinite";
    }
    return NULL;
}

bool hp_vertices_add(hp_vertices *vertices, const float xyz[3]) {
    if (!hp_grow((void **)&vertices->xyz, &vertices->room, vertices->count, sizeof *vertices->xyz)) return false;
    memcpy(vertices->xyz[vertices->count++], xyz, sizeof *vertices->xyz);
    return true;
}

void hp_vertices_free(hp_vertices *vertices) {
    free(vertices->xyz);
    *vertices = (hp_vertices){0};
}

bool hp_fan_corner(hp_fan *fan, hp_mesh *mesh, const float *xyz) {
    bool added = fan->corners < 2 || hp_mesh_add(mesh, fan->first, fan->last, xyz);
    if (fan->corners++ == 0) fan->first = xyz;
    fan->last = xyz;
    return added;
}
