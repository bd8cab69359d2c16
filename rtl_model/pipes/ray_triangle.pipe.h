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
 * then holds. T leaves as |T|: -0 is 0. */

HP_INLINE void HP_NAMED(ray_triangle_prepare)(const num triangle[9], num prepared[9]) {
    vec3 v0 = vec3_of(triangle, 0), v1 = vec3_of(triangle, 3), v2 = vec3_of(triangle, 6);
    put_vec3(prepared, 0, v0);
    put_vec3(prepared, 3, sub3(v1, v0));
    put_vec3(prepared, 6, sub3(v2, v0));
}

HP_INLINE answer HP_NAMED(ray_triangle_test)(const num ray[6], const num prepared[9], bits index, bool separation) {
    (void)separation; /* TODO */
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
    UNLESS_ANY(or (front, back)) return miss();

    num T = div(dot(e2, q), det);
    flag in_range = and(and(at_least(T, zero), less(T, infinity)), less(abs(det), infinity));
    flag F = or (and(front, in_range), and(back, in_range));
    T = abs(T);
    return answer_of(F, index, T, add3(o, scale3(T, d)));
}
