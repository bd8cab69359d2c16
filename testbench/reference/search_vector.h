/* Vectors, bodies and support points under one number type. No include guard: search_numbers.h includes it once per
 * type, with REAL the type and HPT_NAMED(word) its names. */

typedef struct HPT_NAMED(body) {
    unsigned points, segments, discs;
    REAL point[HPT_BODY_POINTS][3], segment[HPT_BODY_SEGMENTS][3], axis[HPT_BODY_DISCS][3], radius[HPT_BODY_DISCS];
} HPT_NAMED(body);

typedef struct HPT_NAMED(vertex) {
    REAL at[3];
    hpt_corner name;
} HPT_NAMED(vertex);

HPT_LOCAL REAL HPT_NAMED(dot)(const REAL a[3], const REAL b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

HPT_LOCAL void HPT_NAMED(cross)(const REAL a[3], const REAL b[3], REAL to[3]) {
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

HPT_LOCAL void HPT_NAMED(sub)(const REAL a[3], const REAL b[3], REAL to[3]) {
    for (int i = 0; i < 3; i++) to[i] = a[i] - b[i];
}

HPT_LOCAL void HPT_NAMED(add_scaled)(REAL to[3], REAL k, const REAL a[3]) {
    for (int i = 0; i < 3; i++) to[i] += k * a[i];
}

HPT_LOCAL REAL HPT_NAMED(absolute)(REAL a) {
    return a < 0 ? -a : a;
}

HPT_LOCAL void HPT_NAMED(read_body)(const hpt_body *from, REAL scale, HPT_NAMED(body) * to) {
    to->points = from->points;
    to->segments = from->segments;
    to->discs = from->discs;
    for (int k = 0; k < 3; k++) {
        for (unsigned i = 0; i < from->points; i++) to->point[i][k] = (REAL)from->point[i][k] * scale;
        for (unsigned i = 0; i < from->segments; i++) to->segment[i][k] = (REAL)from->segment[i][k] * scale;
        for (unsigned i = 0; i < from->discs; i++) to->axis[i][k] = (REAL)from->disc[i].axis[k];
    }
    for (unsigned i = 0; i < from->discs; i++) to->radius[i] = (REAL)from->disc[i].radius * scale;
}

/* to += the rim point of disc i towards d. None when d is along the axis: then the centre is as good. */
HPT_LOCAL void HPT_NAMED(add_rim)(const HPT_NAMED(body) * body, unsigned i, const REAL d[3], REAL to[3]) {
    REAL out[3] = {d[0], d[1], d[2]};
    for (int twice = 0; twice < 2; twice++)
        HPT_NAMED(add_scaled)(out, -HPT_NAMED(dot)(out, body->axis[i]), body->axis[i]);
    REAL length = HPT_NAMED(root)(HPT_NAMED(dot)(out, out));
    if (length > 0) HPT_NAMED(add_scaled)(to, body->radius[i] / length, out);
}

/* The point that a name stands for. */
HPT_LOCAL void HPT_NAMED(find_corner)(const HPT_NAMED(body) * body, const hpt_corner *name, REAL at[3]) {
    memcpy(at, body->point[name->point], sizeof body->point[0]);
    for (unsigned i = 0; i < body->segments; i++)
        HPT_NAMED(add_scaled)(at, name->ends >> i & 1 ? 1 : -1, body->segment[i]);
    for (unsigned i = 0; i < body->discs; i++) {
        REAL rim[3] = {(REAL)name->rim[i][0], (REAL)name->rim[i][1], (REAL)name->rim[i][2]};
        HPT_NAMED(add_rim)(body, i, rim, at);
    }
}

/* The farthest point of the body in direction d; returns how far: d . point. */
HPT_LOCAL REAL HPT_NAMED(support)(const HPT_NAMED(body) * body, const REAL d[3], HPT_NAMED(vertex) * to) {
    hpt_corner *name = &to->name;
    name->point = name->ends = 0;
    for (unsigned i = 1; i < body->points; i++)
        if (HPT_NAMED(dot)(body->point[i], d) > HPT_NAMED(dot)(body->point[name->point], d)) name->point = i;
    for (unsigned i = 0; i < body->segments; i++)
        if (HPT_NAMED(dot)(body->segment[i], d) >= 0) name->ends |= 1u << i;
    for (unsigned i = 0; i < body->discs; i++)
        for (int k = 0; k < 3; k++) name->rim[i][k] = d[k];
    HPT_NAMED(find_corner)(body, name, to->at);
    return HPT_NAMED(dot)(d, to->at);
}

/* Weights of the point of the triangle (or segment, or point: n = 3, 2, 1) nearest to the origin, if it lies in its
 * relative inside; else false. */
HPT_LOCAL bool HPT_NAMED(inner_weights)(const REAL *const p[3], int n, REAL weight[3]) {
    REAL a[3], b[3];
    weight[0] = 1;
    if (n == 1) return true;
    HPT_NAMED(sub)(p[1], p[0], a);
    REAL aa = HPT_NAMED(dot)(a, a), ap = -HPT_NAMED(dot)(a, p[0]);
    if (n == 2) {
        weight[1] = aa > 0 ? ap / aa : -1;
        weight[0] = 1 - weight[1];
        return weight[0] >= 0 && weight[1] >= 0;
    }
    HPT_NAMED(sub)(p[2], p[0], b);
    REAL bb = HPT_NAMED(dot)(b, b), ab = HPT_NAMED(dot)(a, b), bp = -HPT_NAMED(dot)(b, p[0]);
    REAL det = aa * bb - ab * ab;
    if (!(det > 0)) return false;
    weight[1] = (ap * bb - bp * ab) / det;
    weight[2] = (bp * aa - ap * ab) / det;
    weight[0] = 1 - weight[1] - weight[2];
    return weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0;
}

/* The sum of weighted points. */
HPT_LOCAL void HPT_NAMED(mix)(const REAL *const p[3], int n, const REAL weight[3], REAL to[3]) {
    to[0] = to[1] = to[2] = 0;
    for (int i = 0; i < n; i++) HPT_NAMED(add_scaled)(to, weight[i], p[i]);
}

/* The nearest point of points p[0..n) to the origin on any of their points, edges and triangles: `used` has bit i
 * when p[i] takes part, with its weight. Returns its square distance. */
HPT_LOCAL REAL HPT_NAMED(nearest_of)(const REAL *const p[], int n, REAL weight[4], unsigned *used, REAL at[3]) {
    REAL least = -1;
    for (unsigned set = 1; set < 1u << n; set++) {
        const REAL *chosen[4];
        REAL w[3], point[3];
        int members = 0;
        for (int i = 0; i < n; i++)
            if (set >> i & 1) chosen[members++] = p[i];
        if (members > 3 || !HPT_NAMED(inner_weights)(chosen, members, w)) continue;
        HPT_NAMED(mix)(chosen, members, w, point);
        REAL square = HPT_NAMED(dot)(point, point);
        if (least >= 0 && square >= least) continue;
        least = square;
        *used = set;
        memcpy(at, point, sizeof point);
        for (int i = 0, m = 0; i < n; i++) weight[i] = set >> i & 1 ? w[m++] : 0;
    }
    return least;
}
