/* Lines as a cylinder sees them, and how far from it they stay: of rays, of edges of triangles and boxes. In the
 * cylinder's frame: x^2 + y^2 <= r^2, |z| <= h. */

/* A line in the cylinder's frame, and where it comes nearest to the axis. */
typedef struct HP_NAMED(axial_line) {
    vec3 q, d;                                 /* a point of the line, its direction */
    num t0;                                    /* that point's t; other parameters are counted from it */
    num squared, inverse;                      /* d.d, 1/(d.d) */
    num across, inverse_across, inverse_along; /* of the direction, squared; 1/across, 1/d.z */
    flag parallel, flat;                       /* to the axis; to the caps */
    num tc, p;                                 /* nearest to the axis: where and how near; tc = 0 if parallel */
} HP_NAMED(axial_line);

/* The line through q in the direction d, both in the cylinder's frame; q is at t0. */
HP_INLINE HP_NAMED(axial_line) HP_NAMED(axial_line_in)(vec3 q, vec3 d, num t0, num squared, num inverse) {
    num across = add(mul(d.x, d.x), mul(d.y, d.y)), least = mul(squared, constant(0x1p-54f));
    num inverse_across = div(constant(1), across);
    flag parallel = at_most(across, least);
    num tc = mul(neg(add(mul(q.x, d.x), mul(q.y, d.y))), inverse_across);
    tc = select(parallel, constant(0), tc);
    num px = add(q.x, mul(tc, d.x)), py = add(q.y, mul(tc, d.y));
    return (HP_NAMED(axial_line)){.q = q,
                                  .d = d,
                                  .t0 = t0,
                                  .squared = squared,
                                  .inverse = inverse,
                                  .across = across,
                                  .inverse_across = inverse_across,
                                  .inverse_along = div(constant(1), d.z),
                                  .parallel = parallel,
                                  .flat = at_most(mul(d.z, d.z), least),
                                  .tc = tc,
                                  .p = sqrt(add(mul(px, px), mul(py, py)))};
}

/* The distance from a cylinder to a part of a line: the least over t from first to last of the distance f of the
 * line's point, which is convex in t.
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
 * The place found is put between first and last at the end: f is convex. */
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

HP_INLINE num HP_NAMED(line_to_cylinder)(HP_NAMED(axial_line) l, num h, num r, num first, num last) {
    num zero = constant(0);
    num zc = add(l.q.z, mul(l.tc, l.d.z)), gap = sub(abs(zc), h);
    num k2 = mul(mul(l.d.z, l.d.z), l.inverse), m2 = mul(l.across, l.inverse);
    num unit = sqrt(l.inverse), k = sqrt(k2);
    num onward = select(less(zero, mul(zc, l.d.z)), neg(unit), unit); /* t of a unit of s, towards the plane */
    num side = select(less(zc, zero), neg(h), h);
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
           .s = select(steep, zero, add(mul(sqrt(m2), r), mul(k, gap)))};
    way.rise = add(mul(way.bx, way.ex), mul(way.by, way.ey));
    REPEAT(i, 12) {
        way.s = HP_NAMED(descent_step)(way, r);
    }
    num t = select(less(zero, gap), add(start, mul(onward, way.s)), l.tc);
    t = clamp(t, sub(first, l.t0), sub(last, l.t0));

    num x = add(l.q.x, mul(t, l.d.x)), y = add(l.q.y, mul(t, l.d.y)), z = add(l.q.z, mul(t, l.d.z));
    num radial = max(sub(sqrt(add(mul(x, x), mul(y, y))), r), zero), axial = max(sub(abs(z), h), zero);
    return sqrt(add(mul(radial, radial), mul(axial, axial)));
}

HP_INLINE num HP_NAMED(point_to_cylinder)(vec3 p, num h, num r) {
    num radial = sub(sqrt(add(mul(p.x, p.x), mul(p.y, p.y))), r), axial = sub(abs(p.z), h), zero = constant(0);
    radial = max(radial, zero), axial = max(axial, zero);
    return sqrt(add(mul(radial, radial), mul(axial, axial)));
}

/* The distance from the edge between a and a + d. Without a length it is that of a. */
HP_INLINE num HP_NAMED(edge_to_cylinder)(vec3 a, vec3 d, num h, num r) {
    num squared = dot(d, d), zero = constant(0), one = constant(1);
    HP_NAMED(axial_line) line = HP_NAMED(axial_line_in)(a, d, zero, squared, div(one, squared));
    return min(HP_NAMED(line_to_cylinder)(line, h, r, zero, one), HP_NAMED(point_to_cylinder)(a, h, r));
}
