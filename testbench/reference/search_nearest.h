/* The point of a body nearest to the origin, by growing simplices: E. Gilbert, D. Johnson, S. Keerthi, "A fast
 * procedure for computing the distance between complex objects in three-dimensional space", 1988. No include guard;
 * see search_vector.h.
 *
 * A simplex of at most four corners keeps its point v nearest to the origin. The corner farthest towards -v either
 * shows that v is nearest of all (v.w = v.v), or makes the simplex better. */

typedef struct HPT_NAMED(simplex) {
    unsigned n;
    HPT_NAMED(vertex) corner[4];
    REAL weight[4], v[3], length;
    bool around; /* four corners, the origin between them */
} HPT_NAMED(simplex);

HPT_LOCAL REAL HPT_NAMED(volume)(const REAL a[3], const REAL b[3], const REAL c[3], const REAL d[3]) {
    REAL ab[3], ac[3], ad[3], n[3];
    HPT_NAMED(sub)(b, a, ab);
    HPT_NAMED(sub)(c, a, ac);
    HPT_NAMED(sub)(d, a, ad);
    HPT_NAMED(cross)(ab, ac, n);
    return HPT_NAMED(dot)(n, ad);
}

HPT_LOCAL bool HPT_NAMED(holds_origin)(HPT_NAMED(simplex) * s) {
    const REAL zero[3] = {0, 0, 0};
    REAL whole = HPT_NAMED(volume)(s->corner[0].at, s->corner[1].at, s->corner[2].at, s->corner[3].at);
    if (HPT_NAMED(absolute)(whole) < HPT_EPSILON) return false;
    for (int i = 0; i < 4; i++) {
        const REAL *p[4];
        for (int k = 0; k < 4; k++) p[k] = k == i ? zero : s->corner[k].at;
        s->weight[i] = HPT_NAMED(volume)(p[0], p[1], p[2], p[3]) / whole;
        if (!(s->weight[i] >= 0)) return false;
    }
    return true;
}

/* Keeps the corners that v needs. */
HPT_LOCAL void HPT_NAMED(reduce)(HPT_NAMED(simplex) * s) {
    const REAL *p[4];
    REAL weight[4];
    unsigned used = 0, kept = 0;
    if (s->n == 4 && HPT_NAMED(holds_origin)(s)) {
        s->around = true;
        s->v[0] = s->v[1] = s->v[2] = s->length = 0;
        return;
    }
    for (unsigned i = 0; i < s->n; i++) p[i] = s->corner[i].at;
    s->length = HPT_NAMED(root)(HPT_NAMED(nearest_of)(p, (int)s->n, weight, &used, s->v));
    for (unsigned i = 0; i < s->n; i++)
        if (used >> i & 1) {
            s->corner[kept] = s->corner[i];
            s->weight[kept++] = weight[i];
        }
    s->n = kept;
}

/* Leaves the nearest point in the simplex and the best direction in `direction`. True when lower and upper bound meet
 * within the tolerance. */
HPT_LOCAL bool HPT_NAMED(find_nearest)(const HPT_NAMED(body) * body, HPT_NAMED(simplex) * s, REAL direction[3]) {
    const REAL start[3] = {1, (REAL)0.25, (REAL)0.5};
    REAL best = -4;
    memcpy(direction, start, sizeof start);
    *s = (HPT_NAMED(simplex)){.n = 1};
    HPT_NAMED(support)(body, start, &s->corner[0]);
    HPT_NAMED(reduce)(s);
    for (int step = 0; step < 300; step++) {
        REAL d[3] = {-s->v[0], -s->v[1], -s->v[2]}, before = s->length;
        if (s->around || s->length <= HPT_EPSILON) return true;
        REAL lower = -HPT_NAMED(support)(body, d, &s->corner[s->n]) / s->length;
        if (lower > best) {
            best = lower;
            memcpy(direction, d, sizeof d);
        }
        if (s->length - best <= HPT_TOLERANCE) return true;
        HPT_NAMED(simplex) kept = *s;
        s->n++;
        HPT_NAMED(reduce)(s);
        if (s->around || s->length < before) continue;
        *s = kept;
        return false;
    }
    return false;
}
