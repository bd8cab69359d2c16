/* Triangle against sphere. The triangle is thin, so wherever the centre is,
 *
 *   depth = r - c     separation = c - r     with c the distance of the centre from the triangle
 *
 * and CP is the triangle's point nearest to the centre. Coordinates are taken from the centre first; edges come from
 * the vertices themselves, which is a rounding less. */

HP_INLINE void HP_NAMED(triangle_sphere_prepare)(const num secondary[4], num prepared[4]) {
    put_vec3(prepared, 0, vec3_of(secondary, 0));
    prepared[3] = HP_NAMED(legal_size)(secondary[3]);
}

HP_INLINE answer HP_NAMED(triangle_sphere_test)(const num primary[9], const num prepared[4], bits index,
                                                bool separation, num bar) {
    vec3 v0 = vec3_of(primary, 0), v1 = vec3_of(primary, 3), v2 = vec3_of(primary, 6), centre = vec3_of(prepared, 0);
    num r = prepared[3], infinity = constant(INFINITY);

    vec3 ab = sub3(v1, v0), ac = sub3(v2, v0), bc = sub3(v2, v1);
    flag finite;
    HP_NAMED(nearest) near = HP_NAMED(nearest_of_triangle)(sub3(v0, centre), sub3(v1, centre), ab, ac, bc, &finite);
    num c = sqrt(near.squared), T = sub(r, c);
    flag legal = and(finite, HP_NAMED(finite)(T));
    flag F = and(legal, at_most(c, r));
    UNLESS_ANY(and(F, less(bar, T))) if (!separation) return miss();

    vec3 CP = add3(centre, near.point);
    if (!separation) return answer_of(F, index, T, CP);
    return answer_with(F, index, T, select(legal, sub(c, r), infinity), CP);
}
