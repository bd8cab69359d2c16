/* Oriented box against the thin, two-sided plane n.x = d. After S. Gottschalk, M. Lin, D. Manocha, "OBBTree", 1996,
 * section 5, for the one axis n:
 *
 *   reach = sum of h_k |n.u_k|      off = n.c - d      depth = reach - |off|      separation = |off| - reach
 *
 * n is a unit vector, so nothing is divided.
 *
 * CP is where the diagonal towards the plane meets it: the corner farthest along n is reach away, so the share off /
 * reach of the way from the centre to it, backwards, is the plane. A box that reaches nowhere (a point, or a plate in
 * the plane) shows its centre.
 *
 * The halves h are words of a primary: a negative one is asked for here. NaN and infinity anywhere make `off` or
 * `reach` an infinity or a NaN, and no such T is a hit. */

HP_INLINE void HP_NAMED(obb_plane_prepare)(const num secondary[4], num prepared[4]) {
    vec3 n = vec3_of(secondary, 0);
    put_vec3(prepared, 0, n);
    prepared[3] = select(less(constant(0), dot(n, n)), secondary[3], constant(NAN));
}

/* The vertex vector of one axis, on the side to which n points. */
HP_INLINE vec3 HP_NAMED(obb_plane_towards)(num along, num h, vec3 axis) {
    return scale3(select(less(along, constant(0)), neg(h), h), axis);
}

HP_INLINE answer HP_NAMED(obb_plane_test)(const num primary[15], const num prepared[4], bits index, bool separation,
                                          num bar) {
    vec3 c = vec3_of(primary, 0), h = vec3_of(primary, 3), n = vec3_of(prepared, 0);
    vec3 u = vec3_of(primary, 6), v = vec3_of(primary, 9), w = vec3_of(primary, 12);
    num zero = constant(0), infinity = constant(INFINITY);

    vec3 along = {dot(n, u), dot(n, v), dot(n, w)};
    num reach = dot(h, (vec3){abs(along.x), abs(along.y), abs(along.z)});
    num off = sub(dot(n, c), prepared[3]), distance = abs(off);

    num T = sub(reach, distance);
    flag sizes = and(and(at_least(h.x, zero), at_least(h.y, zero)), at_least(h.z, zero));
    flag legal = and(sizes, HP_NAMED(finite)(T)), F = and(legal, at_most(distance, reach));
    UNLESS_ANY(and(F, less(bar, T))) if (!separation) return miss();

    vec3 corner =
        add3(add3(HP_NAMED(obb_plane_towards)(along.x, h.x, u), HP_NAMED(obb_plane_towards)(along.y, h.y, v)),
             HP_NAMED(obb_plane_towards)(along.z, h.z, w));
    num share = select(less(zero, reach), div(off, reach), zero);
    vec3 CP = sub3(c, scale3(share, corner));
    if (!separation) return answer_of(F, index, T, CP);
    return answer_with(F, index, T, select(legal, sub(distance, reach), infinity), CP);
}
