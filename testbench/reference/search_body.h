/* The whole search under one number type. No include guard; see search_vector.h. */
#include "search_vector.h"

#include "search_nearest.h"

#include "search_hull.h"

HPT_LOCAL void HPT_NAMED(keep_simplex)(const HPT_NAMED(simplex) * s, const REAL direction[3], hpt_search *found) {
    for (int k = 0; k < 3; k++) found->direction[k] = direction[k];
    found->members = s->n;
    for (unsigned i = 0; i < s->n; i++) {
        found->member[i] = s->corner[i].name;
        found->weight[i] = s->weight[i];
    }
}

HPT_LOCAL void HPT_NAMED(keep_hull)(const HPT_NAMED(hull) * hull, hpt_search *found) {
    found->corners = hull->vertices;
    for (unsigned i = 0; i < hull->vertices; i++) found->corner[i] = hull->vertex[i].name;
    for (unsigned i = 0; i < hull->faces; i++)
        if (hull->face[i].alive) memcpy(found->face[found->faces++], hull->face[i].v, sizeof found->face[0]);
}

HPT_LOCAL void HPT_NAMED(look_inside)(const HPT_NAMED(body) * body, hpt_search *found) {
    HPT_NAMED(hull) *hull = malloc(sizeof *hull);
    if (!hull) abort();
    hull->body = body;
    hull->vertices = hull->faces = hull->spares = hull->edges = 0;
    hull->upper = 4;
    if (HPT_NAMED(first_corners)(hull)) {
        HPT_NAMED(first_faces)(hull);
        HPT_NAMED(grow)(hull);
        HPT_NAMED(keep_hull)(hull, found);
    }
    for (int k = 0; k < 3; k++) found->direction[k] = hull->direction[k];
    free(hull);
}

/* `scale` brings the body's size to about 1. */
HPT_LOCAL void HPT_NAMED(search)(const hpt_body *from, hp_quad scale, hpt_search *found) {
    HPT_NAMED(body) body;
    HPT_NAMED(simplex) simplex;
    REAL direction[3];
    HPT_NAMED(read_body)(from, (REAL)scale, &body);
    HPT_NAMED(find_nearest)(&body, &simplex, direction);
    HPT_NAMED(keep_simplex)(&simplex, direction, found);
    found->corners = found->faces = 0;
    if (simplex.length <= HPT_THIN) HPT_NAMED(look_inside)(&body, found);
}
