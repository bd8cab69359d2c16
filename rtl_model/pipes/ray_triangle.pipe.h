/* Ray against triangle, two-sided: T. Moller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997,
 * with u, v and u + v compared against det undivided, so that the one division makes T alone.
 *
 *   o + T d = v0 + u/det e1 + v/det e2,   det = e1.(d x e2)
 *
 * The decision. The point is inside when u, v, det - u - v all have the sign of det or are zero: edges and vertices
 * belong to the triangle. The sign of det needs no comparator: with det > 0 only `front` can hold, with det < 0 only
 * `back`; with det = 0 both can, but then T = t/0 is an infinity or a NaN. So T < inf says "not parallel" as well as
 * "T did not overflow". det < inf is asked for because t/inf = 0 would look like a hit at the origin. With it no NaN
 * and no infinity in any word of ray or triangle can hit: in d, v0, v1 or v2 they make det an infinity or a NaN; in o
 * they do that to u, hence to u + v or to the smaller and greater of u and v, and no comparison with a finite det
 * then holds. T leaves as |T|: -0 is 0.
 *
 * The distance of a miss. Where ray and triangle are nearest, one of the two points is on a border: the ray's origin,
 * or a point of an edge. The origin's nearest point is triangle.part.h's. The edges are seen along the ray, in which
 * view the line is a point: each edge has a place nearest to that, and where it is not behind the origin, it counts.
 * So do the vertices, for an edge along the ray has no one place, and what rounding picks may be behind. An edge
 * that is nearest to the line behind the origin is nearest to the ray at the origin. Rays in the triangle's plane and
 * triangles of no area, which never hit, come out 0 where they meet. */

HP_INLINE void HP_NAMED(ray_triangle_prepare)(const num triangle[9], num prepared[9]) {
    vec3 v0 = vec3_of(triangle, 0), v1 = vec3_of(triangle, 3), v2 = vec3_of(triangle, 6);
    put_vec3(prepared, 0, v0);
    put_vec3(prepared, 3, sub3(v1, v0));
    put_vec3(prepared, 6, sub3(v2, v0));
}

/* A vertex or a place of an edge, seen along the ray: which way the line passes it, and at what t. */
typedef struct HP_NAMED(sight) {
    vec3 offset;
    num t;
} HP_NAMED(sight);

/* The square of the offset, where t is on the ray. */
HP_INLINE num HP_NAMED(seen)(HP_NAMED(sight) a) {
    return select(at_least(a.t, constant(0)), dot(a.offset, a.offset), constant(INFINITY));
}

HP_INLINE num HP_NAMED(edge_seen)(HP_NAMED(sight) a, HP_NAMED(sight) b) {
    vec3 way = sub3(b.offset, a.offset);
    num share = clamp(HP_NAMED(passing)(a.offset, way), constant(0), constant(1));
    return HP_NAMED(seen)((HP_NAMED(sight)){add3(a.offset, scale3(share, way)), add(a.t, mul(share, sub(b.t, a.t)))});
}

/* s: from v0 to the ray's origin. */
HP_INLINE num HP_NAMED(ray_triangle_distance)(vec3 s, vec3 d, vec3 e1, vec3 e2) {
    vec3 a = neg3(s), b = add3(a, e1), c = add3(a, e2);
    num inverse = div(constant(1), dot(d, d)), infinity = constant(INFINITY);
    num ta = mul(dot(a, d), inverse), tb = mul(dot(b, d), inverse), tc = mul(dot(c, d), inverse);
    HP_NAMED(sight)
    at_a = {sub3(a, scale3(ta, d)), ta}, at_b = {sub3(b, scale3(tb, d)), tb}, at_c = {sub3(c, scale3(tc, d)), tc};
    num vertices = min(min(HP_NAMED(seen)(at_a), HP_NAMED(seen)(at_b)), HP_NAMED(seen)(at_c));
    num edges =
        min(min(HP_NAMED(edge_seen)(at_a, at_b), HP_NAMED(edge_seen)(at_a, at_c)), HP_NAMED(edge_seen)(at_b, at_c));

    flag finite;
    num origin = HP_NAMED(nearest_of_triangle)(a, b, e1, e2, sub3(e2, e1), &finite).squared;
    flag legal = and(and(less(constant(0), inverse), less(inverse, infinity)), finite);
    return select(legal, sqrt(min(min(vertices, edges), origin)), infinity);
}

HP_INLINE answer HP_NAMED(ray_triangle_test)(const num ray[6], const num prepared[9], bits index, bool separation,
                                             num bar) {
    (void)bar; /* what it would spare comes too late to be worth asking */
    vec3 o = vec3_of(ray, 0), d = vec3_of(ray, 3);
    vec3 v0 = vec3_of(prepared, 0), e1 = vec3_of(prepared, 3), e2 = vec3_of(prepared, 6);
    num zero = constant(0), infinity = constant(INFINITY);

    vec3 s = sub3(o, v0);
    vec3 p = cross(d, e2);
    vec3 q = cross(s, e1);
    num det = dot(e1, p);
    num u = dot(s, p);
    num v = dot(d, q);

    num uv = add(u, v);
    flag front = and(at_least(min(u, v), zero), at_most(uv, det));
    flag back = and(at_most(max(u, v), zero), at_least(uv, det));
    UNLESS_ANY(or (front, back)) if (!separation) return miss();

    num T = div(dot(e2, q), det);
    flag in_range = and(and(at_least(T, zero), less(T, infinity)), less(abs(det), infinity));
    flag F = or (and(front, in_range), and(back, in_range));
    T = abs(T);
    vec3 CP = add3(o, scale3(T, d));
    if (!separation) return answer_of(F, index, T, CP);
    return answer_with(F, index, T, HP_NAMED(ray_triangle_distance)(s, d, e1, e2), CP);
}
