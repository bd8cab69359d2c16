/* Ray against solid cylinder with flat caps: where the ray's line is between the planes of the caps, and where inside
 * the endless cylinder, as two intervals of t (T. Kay, J. Kajiya, "Ray Tracing Complex Scenes", 1986, section 3, with
 * the second slab bent round; J. Cychosz, W. Waggenspack, "Intersecting a Ray with a Cylinder", Graphics Gems IV,
 * 1994). The ray enters at the later entry and leaves at the earlier exit.
 *
 * Everything is counted from the point of the line nearest to p0, at t0, so that a far origin does no harm, and seen
 * from the cylinder's frame, where the ray is (x, y, z) + t (dx, dy, dz). Across the axis as in ray_sphere: nearest
 * to the axis at tc, p away, and half = sqrt((r - p)(r + p) / across) to either side, without a discriminant.
 *
 * Almost along the axis or almost across it, one of the intervals has no end: the share of the direction that is
 * squared away, less than 2^-27 of it, moves the ray by less than the rounding of its coordinates does anywhere near
 * the cylinder. In between, ends are as uncertain as the slope of the ray against the surface makes them, but always
 * those of a cylinder and a ray with coordinates a few roundings away. */

HP_INLINE void HP_NAMED(ray_cylinder_prepare)(const num secondary[7], num prepared[15]) {
    HP_NAMED(put_cylinder)(prepared, HP_NAMED(cylinder_of)(secondary));
}

HP_INLINE HP_NAMED(axial_line) HP_NAMED(axial_line_of)(HP_NAMED(cylinder) c, vec3 o, vec3 direction) {
    HP_NAMED(approach) near = HP_NAMED(approach_of)(sub3(c.origin, o), direction);
    vec3 q = HP_NAMED(turn_in)(c, neg3(near.offset)), d = HP_NAMED(turn_in)(c, direction);
    q.z = sub(q.z, c.h);
    return HP_NAMED(axial_line_in)(q, d, near.t, near.squared, near.inverse);
}

HP_INLINE answer HP_NAMED(ray_cylinder_test)(const num primary[6], const num prepared[15], bits index,
                                             bool separation, num bar) {
    (void)bar; /* what it would spare comes too late to be worth asking */
    vec3 o = vec3_of(primary, 0), d = vec3_of(primary, 3);
    HP_NAMED(cylinder) c = HP_NAMED(get_cylinder)(prepared);
    num zero = constant(0), infinity = constant(INFINITY);

    HP_NAMED(axial_line) l = HP_NAMED(axial_line_of)(c, o, d);
    flag line = at_most(l.p, c.r);
    UNLESS_ANY(line) if (!separation) return miss();

    num half = sqrt(mul(mul(sub(c.r, l.p), add(c.r, l.p)), l.inverse_across));
    half = select(l.parallel, infinity, half);
    num lower = mul(neg(add(l.q.z, c.h)), l.inverse_along), upper = mul(sub(c.h, l.q.z), l.inverse_along);
    num between = select(at_most(abs(l.q.z), c.h), infinity, neg(infinity));
    num into = select(l.flat, neg(between), min(lower, upper)), out = select(l.flat, between, max(lower, upper));
    num enter = max(into, sub(l.tc, half)), leave = min(out, add(l.tc, half));

    num T = max(zero, add(l.t0, enter)); /* in this order -0 becomes 0 */
    flag legal = and(less(l.squared, infinity), less(T, c.limit));
    flag F = and(and(line, legal), and(at_most(enter, leave), at_least(add(l.t0, leave), zero)));
    vec3 CP = add3(o, scale3(T, d));
    if (!separation) return answer_of(F, index, T, CP);

    num distance = HP_NAMED(line_to_cylinder)(l, c.h, c.r, zero, infinity);
    legal = and(less(l.squared, infinity), less(distance, c.limit));
    return answer_with(F, index, T, select(legal, distance, infinity), CP);
}
