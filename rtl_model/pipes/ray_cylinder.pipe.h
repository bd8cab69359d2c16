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

/* The ray's line in the cylinder's frame, and where it comes nearest to the axis. */
typedef struct HP_NAMED(axial_line) {
    vec3 q, d;                                 /* a point of the line, its direction */
    num t0;                                    /* that point's t; other parameters are counted from it */
    num squared, inverse;                      /* d.d, 1/(d.d) */
    num across, inverse_across, inverse_along; /* of the direction, squared; 1/across, 1/d.z */
    flag parallel, flat;                       /* to the axis; to the caps */
    num tc, p;                                 /* nearest to the axis: where and how near; tc = 0 if parallel */
} HP_NAMED(axial_line);

HP_INLINE HP_NAMED(axial_line) HP_NAMED(axial_line_of)(HP_NAMED(cylinder) c, vec3 o, vec3 direction) {
    HP_NAMED(approach) near = HP_NAMED(approach_of)(sub3(c.origin, o), direction);
    vec3 q = HP_NAMED(turn_in)(c, neg3(near.offset)), d = HP_NAMED(turn_in)(c, direction);
    q.z = sub(q.z, c.h);

    num across = add(mul(d.x, d.x), mul(d.y, d.y)), least = mul(near.squared, constant(0x1p-54f));
    num inverse_across = div(constant(1), across);
    flag parallel = at_most(across, least);
    num tc = mul(neg(add(mul(q.x, d.x), mul(q.y, d.y))), inverse_across);
    tc = select(parallel, constant(0), tc);
    num px = add(q.x, mul(tc, d.x)), py = add(q.y, mul(tc, d.y));
    return (HP_NAMED(axial_line)){.q = q,
                                  .d = d,
                                  .t0 = near.t,
                                  .squared = near.squared,
                                  .inverse = near.inverse,
                                  .across = across,
                                  .inverse_across = inverse_across,
                                  .inverse_along = div(constant(1), d.z),
                                  .parallel = parallel,
                                  .flat = at_most(mul(d.z, d.z), least),
                                  .tc = tc,
                                  .p = sqrt(add(mul(px, px), mul(py, py)))};
}

/* The distance from cylinder to ray: the least over t >= 0 of the distance f of the ray's point, which is convex in
 * t.
 *
 * Where the line is nearest to the axis, at tc, it may be between the caps: then that is the place. Else it is on the
 * way from there to the plane of the nearer cap. On that way let s be the length gone (s = 0 at tc), rho the distance
 * from the axis and g = g0 - k s that from the plane. Half the derivative of f^2 = (rho - r)^2 + g^2 is
 *
 *   F(s) = (rho - r) rho' - k g     with 0 for rho - r where the point is over the cap
 *
 * and rises, and so does its slope where F >= 0: Newton's steps from there stay there and converge. The start is the
 * plane of the cap, or the place where F would be 0 for a straight rho = m s, which is never greater. A steep line
 * counts its s from the plane, for tc may be far off; a shallow one from tc, for the plane may.
 *
 * A start t < 0 is put to 0 last: f is convex. */
typedef struct HP_NAMED(descent) {
    num bx, by, ex, ey, rise; /* across the axis: where s = 0, unit direction, their product */
    num k, k2, m2, g0;        /* the direction along the axis, its square, that of the rest; g at s = 0 */
    num s;
} HP_NAMED(descent);

HP_INLINE num HP_NAMED(descent_step)(HP_NAMED(descent) w, num r) {
    num zero = constant(0), one = constant(1);
    num x = add(w.bx, mul(w.s, w.ex)), y = add(w.by, mul(w.s, w.ey));
    num rho = sqrt(add(mul(x, x), mul(y, y))), inverse = div(one, rho);
    num slope = min(mul(add(w.rise, mul(w.m2, w.s)), inverse), one); /* NaN on the axis: 1 */
    num bend = min(mul(r, inverse), one);
    num radial = max(sub(rho, r), zero);
    num F = sub(mul(slope, radial), mul(w.k, sub(w.g0, mul(w.k, w.s))));
    num bent = add(mul(w.m2, sub(one, bend)), mul(bend, mul(slope, slope)));
    num rises = add(w.k2, select(less(zero, radial), bent, zero));
    return sub(w.s, select(less(zero, F), div(F, rises), zero));
}

HP_INLINE num HP_NAMED(ray_cylinder_distance)(HP_NAMED(cylinder) c, HP_NAMED(axial_line) l) {
    num zero = constant(0);
    num zc = add(l.q.z, mul(l.tc, l.d.z)), gap = sub(abs(zc), c.h);
    num k2 = mul(mul(l.d.z, l.d.z), l.inverse), m2 = mul(l.across, l.inverse);
    num unit = sqrt(l.inverse), k = sqrt(k2);
    num onward = select(less(zero, mul(zc, l.d.z)), neg(unit), unit); /* t of a unit of s, towards the plane */
    num side = select(less(zc, zero), neg(c.h), c.h);
    flag steep = at_most(l.across, mul(l.d.z, l.d.z));

    num start = select(steep, mul(sub(side, l.q.z), l.inverse_along), l.tc);
    HP_NAMED(descent)
    way = {.bx = add(l.q.x, mul(start, l.d.x)),
           .by = add(l.q.y, mul(start, l.d.y)),
           .ex = mul(onward, l.d.x),
           .ey = mul(onward, l.d.y),
           .k = k,
           .k2 = k2,
           .m2 = m2,
           .g0 = select(steep, zero, gap),
           .s = select(steep, zero, add(mul(sqrt(m2), c.r), mul(k, gap)))};
    way.rise = add(mul(way.bx, way.ex), mul(way.by, way.ey));
    REPEAT(i, 12) {
        way.s = HP_NAMED(descent_step)(way, c.r);
    }
    num t = select(less(zero, gap), add(start, mul(onward, way.s)), l.tc);
    t = max(t, neg(l.t0));

    num x = add(l.q.x, mul(t, l.d.x)), y = add(l.q.y, mul(t, l.d.y)), z = add(l.q.z, mul(t, l.d.z));
    num radial = max(sub(sqrt(add(mul(x, x), mul(y, y))), c.r), zero), axial = max(sub(abs(z), c.h), zero);
    return sqrt(add(mul(radial, radial), mul(axial, axial)));
}

HP_INLINE answer HP_NAMED(ray_cylinder_test)(const num primary[6], const num prepared[15], bits index,
                                             bool separation) {
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

    num distance = HP_NAMED(ray_cylinder_distance)(c, l);
    legal = and(less(l.squared, infinity), less(distance, c.limit));
    return answer_with(F, index, T, select(legal, distance, infinity), CP);
}
