/* The boundary of a body about the origin, by a polytope that grows from inside: G. van den Bergen, "Proximity
 * queries and penetration depth computation on 3D game objects", 2001. No include guard; see search_vector.h.
 *
 * The face nearest to the origin either lies on the boundary, and its distance is the depth; or there is a corner
 * beyond it, and the hull takes that in. The hull need not hold the origin at first: a face with the origin outside
 * it has a negative distance, so its turn comes before all others. */

typedef struct HPT_NAMED(face) {
    unsigned v[3], next[3]; /* next[i] is the face beyond the edge from v[i] to v[i + 1] */
    REAL normal[3], offset; /* outward, of length 1; 0 when the face has no area */
    REAL key;               /* its distance from the origin, as far as known */
    REAL slack;             /* what rounding can have turned the normal by: the narrower the face the more */
    bool alive, final, seen;
} HPT_NAMED(face);

typedef struct HPT_NAMED(hull) {
    const HPT_NAMED(body) * body;
    unsigned vertices, faces;
    REAL upper, direction[3]; /* the least support found, and where */
    HPT_NAMED(vertex) vertex[HPT_VERTICES];
    HPT_NAMED(face) face[HPT_FACES];
    unsigned spare[HPT_FACES], spares;
    unsigned at_vertex[HPT_VERTICES]; /* horizon edge that starts there */
    unsigned pile[HPT_FACES];
    struct {
        unsigned from, to, beyond, inner;
    } horizon[HPT_FACES];
    unsigned edges;
} HPT_NAMED(hull);

HPT_LOCAL unsigned HPT_NAMED(new_face)(HPT_NAMED(hull) * hull, unsigned a, unsigned b, unsigned c) {
    unsigned i = hull->spares ? hull->spare[--hull->spares] : hull->faces++;
    HPT_NAMED(face) *f = &hull->face[i];
    *f = (HPT_NAMED(face)){.v = {a, b, c}, .alive = true};
    const REAL *p = hull->vertex[a].at;
    REAL ab[3], ac[3];
    HPT_NAMED(sub)(hull->vertex[b].at, p, ab);
    HPT_NAMED(sub)(hull->vertex[c].at, p, ac);
    HPT_NAMED(cross)(ab, ac, f->normal);
    REAL length = HPT_NAMED(root)(HPT_NAMED(dot)(f->normal, f->normal));
    REAL longest =
        HPT_NAMED(root)(HPT_NAMED(dot)(ab, ab) + HPT_NAMED(dot)(ac, ac)); /* no shorter than any edge / 2 */
    f->slack = length > 0 ? HPT_EPSILON * longest / length : 0;
    for (int k = 0; k < 3; k++) f->normal[k] = length > 0 ? f->normal[k] / length : 0;
    f->offset = f->key = HPT_NAMED(dot)(f->normal, p);
    f->final = !(length > 0);
    return i;
}

HPT_LOCAL REAL HPT_NAMED(beyond)(const HPT_NAMED(face) * f, const REAL at[3]) {
    return HPT_NAMED(dot)(f->normal, at) - f->offset;
}

/* Whether a point is beyond a face, rounding allowed for. */
HPT_LOCAL bool HPT_NAMED(sees)(const HPT_NAMED(hull) * hull, const HPT_NAMED(face) * f, const REAL at[3]) {
    REAL arm[3], distance = 0;
    HPT_NAMED(sub)(at, hull->vertex[f->v[0]].at, arm);
    for (int k = 0; k < 3; k++) distance += HPT_NAMED(absolute)(arm[k]);
    return HPT_NAMED(beyond)(f, at) > HPT_EPSILON + f->slack * distance;
}

/* The support point along d, whose length is 1 or nearly; keeps the least upper bound. */
HPT_LOCAL void HPT_NAMED(ask)(HPT_NAMED(hull) * hull, const REAL d[3], HPT_NAMED(vertex) * to) {
    REAL reach = HPT_NAMED(support)(hull->body, d, to);
    if (reach >= hull->upper) return;
    hull->upper = reach;
    memcpy(hull->direction, d, sizeof hull->direction);
}

/* ---- the first four corners ---- */

/* Keeps in `best` the farther of both ends along d, by the measure |(x - base).d|. */
HPT_LOCAL REAL HPT_NAMED(farther)(HPT_NAMED(hull) * hull, const REAL d[3], const REAL base[3],
                                  HPT_NAMED(vertex) * best, REAL most) {
    for (int sign = -1; sign <= 1; sign += 2) {
        HPT_NAMED(vertex) w;
        REAL along[3] = {sign * d[0], sign * d[1], sign * d[2]}, arm[3];
        HPT_NAMED(ask)(hull, along, &w);
        HPT_NAMED(sub)(w.at, base, arm);
        REAL reach = HPT_NAMED(absolute)(HPT_NAMED(dot)(arm, d));
        if (reach <= most) continue;
        most = reach;
        *best = w;
    }
    return most;
}

HPT_LOCAL void HPT_NAMED(unit)(REAL a[3]) {
    REAL length = HPT_NAMED(root)(HPT_NAMED(dot)(a, a));
    for (int k = 0; k < 3; k++) a[k] = length > 0 ? a[k] / length : 0;
}

/* Two unit vectors across u. */
HPT_LOCAL void HPT_NAMED(across)(const REAL u[3], REAL a[3], REAL b[3]) {
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (HPT_NAMED(absolute)(u[k]) < HPT_NAMED(absolute)(u[least])) least = k;
    REAL e[3] = {least == 0, least == 1, least == 2};
    HPT_NAMED(cross)(u, e, a);
    HPT_NAMED(unit)(a);
    HPT_NAMED(cross)(u, a, b);
    HPT_NAMED(unit)(b);
}

/* False when the body is flat within the tolerance: then the direction across it is known. */
HPT_LOCAL bool HPT_NAMED(first_corners)(HPT_NAMED(hull) * hull) {
    static const int tries[7][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, -1, 1}, {1, 1, -1}, {-1, 1, 1}};
    HPT_NAMED(vertex) *v = hull->vertex;
    REAL most = 0, u[3], a[3], b[3], n[3];
    const REAL x[3] = {1, 0, 0};
    HPT_NAMED(ask)(hull, x, &v[0]);
    for (int i = 0; i < 7; i++) {
        REAL d[3] = {tries[i][0], tries[i][1], tries[i][2]};
        HPT_NAMED(unit)(d);
        most = HPT_NAMED(farther)(hull, d, v[0].at, &v[1], most);
    }
    HPT_NAMED(sub)(v[1].at, v[0].at, u);
    HPT_NAMED(unit)(u);
    HPT_NAMED(across)(u, a, b);
    REAL wide = HPT_NAMED(farther)(hull, a, v[0].at, &v[2], 0);
    wide = HPT_NAMED(farther)(hull, b, v[0].at, &v[2], wide);
    if (wide <= HPT_THIN) return false;
    HPT_NAMED(sub)(v[2].at, v[0].at, a);
    HPT_NAMED(cross)(u, a, n);
    HPT_NAMED(unit)(n);
    return HPT_NAMED(farther)(hull, n, v[0].at, &v[3], 0) > HPT_THIN;
}

HPT_LOCAL void HPT_NAMED(join)(HPT_NAMED(hull) * hull, unsigned f, unsigned i, unsigned g) {
    const unsigned *v = hull->face[f].v;
    hull->face[f].next[i] = g;
    for (unsigned k = 0; k < 3; k++)
        if (hull->face[g].v[k] == v[(i + 1) % 3]) hull->face[g].next[k] = f;
}

HPT_LOCAL void HPT_NAMED(first_faces)(HPT_NAMED(hull) * hull) {
    HPT_NAMED(vertex) *v = hull->vertex;
    if (HPT_NAMED(volume)(v[0].at, v[1].at, v[2].at, v[3].at) > 0) {
        HPT_NAMED(vertex) swapped = v[1];
        v[1] = v[2];
        v[2] = swapped;
    }
    hull->vertices = 4;
    unsigned bottom = HPT_NAMED(new_face)(hull, 0, 1, 2), side[3];
    for (unsigned i = 0; i < 3; i++) side[i] = HPT_NAMED(new_face)(hull, (i + 1) % 3, i, 3);
    for (unsigned i = 0; i < 3; i++) {
        HPT_NAMED(join)(hull, bottom, i, side[i]);
        HPT_NAMED(join)(hull, side[i], 1, side[(i + 2) % 3]);
    }
}

/* ---- growing ---- */

/* Takes away the faces that w sees, from the first on, and lists the edges round them. */
HPT_LOCAL void HPT_NAMED(open_up)(HPT_NAMED(hull) * hull, unsigned first, const REAL w[3]) {
    unsigned piled = 0;
    hull->edges = 0;
    hull->pile[piled++] = first;
    hull->face[first].seen = true;
    while (piled) {
        unsigned f = hull->pile[--piled];
        for (unsigned i = 0; i < 3; i++) {
            unsigned g = hull->face[f].next[i];
            HPT_NAMED(face) *other = &hull->face[g];
            if (other->seen) continue;
            if (HPT_NAMED(sees)(hull, other, w)) {
                other->seen = true;
                hull->pile[piled++] = g;
            } else {
                unsigned e = hull->edges++;
                hull->horizon[e].from = hull->face[f].v[i];
                hull->horizon[e].to = hull->face[f].v[(i + 1) % 3];
                hull->horizon[e].beyond = g;
                hull->horizon[e].inner = f;
            }
        }
    }
}

/* A horizon edge listed while the face beyond was still to be seen is none. Then: one loop, each corner once? */
HPT_LOCAL bool HPT_NAMED(is_loop)(HPT_NAMED(hull) * hull) {
    unsigned kept = 0;
    for (unsigned e = 0; e < hull->edges; e++)
        if (!hull->face[hull->horizon[e].beyond].seen) hull->horizon[kept++] = hull->horizon[e];
    hull->edges = kept;
    for (unsigned e = 0; e < kept; e++) hull->at_vertex[hull->horizon[e].from] = HPT_FACES;
    for (unsigned e = 0; e < kept; e++) hull->at_vertex[hull->horizon[e].to] = HPT_FACES;
    for (unsigned e = 0; e < kept; e++) {
        if (hull->at_vertex[hull->horizon[e].from] != HPT_FACES) return false;
        hull->at_vertex[hull->horizon[e].from] = e;
    }
    unsigned length = 0, e = 0;
    do {
        e = hull->at_vertex[hull->horizon[e].to];
        length++;
    } while (e != 0 && e != HPT_FACES && length <= kept);
    return e == 0 && length == kept && kept >= 3;
}

HPT_LOCAL void HPT_NAMED(bury)(HPT_NAMED(hull) * hull) {
    for (unsigned i = 0; i < hull->faces; i++)
        if (hull->face[i].seen && hull->face[i].alive) {
            hull->face[i].alive = hull->face[i].seen = false;
            hull->spare[hull->spares++] = i;
        }
}

/* Joins the corner to the hull; false when rounding has made that impossible: the hull stays as it was. */
HPT_LOCAL bool HPT_NAMED(take_in)(HPT_NAMED(hull) * hull, unsigned face, const HPT_NAMED(vertex) * w) {
    if (hull->vertices == HPT_VERTICES) return false;
    HPT_NAMED(open_up)(hull, face, w->at);
    if (!HPT_NAMED(is_loop)(hull)) {
        for (unsigned i = 0; i < hull->faces; i++) hull->face[i].seen = false;
        return false;
    }
    HPT_NAMED(bury)(hull);
    unsigned apex = hull->vertices++, first = 0, last = 0, e = 0;
    hull->vertex[apex] = *w;
    for (unsigned k = 0; k < hull->edges; k++, e = hull->at_vertex[hull->horizon[e].to]) {
        unsigned f = HPT_NAMED(new_face)(hull, hull->horizon[e].from, hull->horizon[e].to, apex);
        HPT_NAMED(join)(hull, f, 0, hull->horizon[e].beyond);
        if (k)
            HPT_NAMED(join)(hull, last, 1, f);
        else
            first = f;
        last = f;
    }
    HPT_NAMED(join)(hull, last, 1, first);
    return true;
}

/* A corner of the hull is beyond none of its faces, whatever a narrow one says. */
HPT_LOCAL bool HPT_NAMED(is_corner)(const HPT_NAMED(hull) * hull, const REAL at[3]) {
    for (unsigned i = 0; i < hull->vertices; i++) {
        const REAL *v = hull->vertex[i].at;
        if (v[0] == at[0] && v[1] == at[1] && v[2] == at[2]) return true;
    }
    return false;
}

/* The face of the least key that may still hold a better bound, or HPT_FACES. */
HPT_LOCAL unsigned HPT_NAMED(nearest_face)(const HPT_NAMED(hull) * hull) {
    unsigned best = HPT_FACES;
    REAL least = hull->upper - HPT_TOLERANCE;
    for (unsigned i = 0; i < hull->faces; i++)
        if (hull->face[i].alive && !hull->face[i].final && hull->face[i].key < least) {
            least = hull->face[i].key;
            best = i;
        }
    return best;
}

/* Where the foot of the origin's perpendicular lies off a face that does not have the origin outside, as with a face
 * too narrow for its normal to mean much, the key becomes the distance of the triangle itself. True if it did. */
HPT_LOCAL bool HPT_NAMED(better_key)(HPT_NAMED(hull) * hull, HPT_NAMED(face) * f, REAL nearest[3]) {
    const REAL *p[3];
    REAL weight[4];
    unsigned used = 0;
    for (int i = 0; i < 3; i++) p[i] = hull->vertex[f->v[i]].at;
    REAL distance = HPT_NAMED(root)(HPT_NAMED(nearest_of)(p, 3, weight, &used, nearest));
    if (f->key < 0 || distance - f->key <= HPT_TOLERANCE / 4) return false;
    f->key = distance;
    return true;
}

HPT_LOCAL void HPT_NAMED(grow)(HPT_NAMED(hull) * hull) {
    for (;;) {
        unsigned i = HPT_NAMED(nearest_face)(hull);
        if (i == HPT_FACES) return;
        HPT_NAMED(face) *f = &hull->face[i];
        HPT_NAMED(vertex) w, aside;
        REAL nearest[3];
        if (HPT_NAMED(better_key)(hull, f, nearest)) continue;
        HPT_NAMED(ask)(hull, f->normal, &w);
        REAL length = HPT_NAMED(root)(HPT_NAMED(dot)(nearest, nearest));
        if (length > HPT_EPSILON && f->offset > 0) {
            for (int k = 0; k < 3; k++) nearest[k] /= length;
            HPT_NAMED(ask)(hull, nearest, &aside);
            if (HPT_NAMED(beyond)(f, aside.at) > HPT_NAMED(beyond)(f, w.at)) w = aside;
        }
        if (!HPT_NAMED(sees)(hull, f, w.at) || HPT_NAMED(is_corner)(hull, w.at) || !HPT_NAMED(take_in)(hull, i, &w))
            f->final = true;
    }
}
