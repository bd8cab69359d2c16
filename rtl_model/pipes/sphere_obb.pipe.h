/* Sphere against oriented box. In the box's own frame the centre is p, and e = |p| - h says how far it is beyond each
 * pair of faces. After J. Arvo, "A simple method for box-sphere intersection testing", Graphics Gems, 1990,
 *
 *   s = |max(e, 0)| outside, the greatest e inside: the signed distance of the centre from the box
 *   depth = r - s     separation = s - r
 *
 * inside too: the nearest face, and r more, is the shortest way out. The two cases add up, for outside the greatest e
 * is positive and inside max(e, 0) is 0.
 *
 * CP is the box point nearest to the centre, found from the centre by what the centre is beyond the faces: that is
 * small beside the box when the sphere is, and 0 along an axis on which the centre is within. */

HP_INLINE void HP_NAMED(sphere_obb_prepare)(const num secondary[15], num prepared[15]) {
    for (unsigned i = 0; i < 15; i++) prepared[i] = secondary[i];
    for (unsigned i = 3; i < 6; i++) prepared[i] = HP_NAMED(legal_size)(secondary[i]);
}

/* The part of p beyond -h and h, signed as p is. */
HP_INLINE num HP_NAMED(sphere_obb_excess)(num p, num beyond) {
    return select(less(p, constant(0)), neg(beyond), beyond);
}

HP_INLINE answer HP_NAMED(sphere_obb_test)(const num primary[4], const num prepared[15], bits index, bool separation,
                                           num bar) {
    vec3 c = vec3_of(primary, 0), h = vec3_of(prepared, 3);
    vec3 u = vec3_of(prepared, 6), v = vec3_of(prepared, 9), w = vec3_of(prepared, 12);
    num r = primary[3], zero = constant(0), infinity = constant(INFINITY);

    vec3 from = sub3(c, vec3_of(prepared, 0));
    vec3 p = {dot(u, from), dot(v, from), dot(w, from)};
    vec3 e = {sub(abs(p.x), h.x), sub(abs(p.y), h.y), sub(abs(p.z), h.z)};
    vec3 beyond = {max(e.x, zero), max(e.y, zero), max(e.z, zero)}; /* NaN stays NaN */
    num s = add(length(beyond), min(max(max(e.x, e.y), e.z), zero));

    num T = sub(r, s);
    flag legal = and(at_least(r, zero), HP_NAMED(finite)(T)), F = and(legal, at_most(s, r));
    UNLESS_ANY(and(F, less(bar, T))) if (!separation) return miss();

    vec3 excess = {HP_NAMED(sphere_obb_excess)(p.x, beyond.x), HP_NAMED(sphere_obb_excess)(p.y, beyond.y),
                   HP_NAMED(sphere_obb_excess)(p.z, beyond.z)};
    vec3 out = add3(add3(scale3(excess.x, u), scale3(excess.y, v)), scale3(excess.z, w));
    vec3 CP = sub3(c, out);
    if (!separation) return answer_of(F, index, T, CP);
    return answer_with(F, index, T, select(legal, sub(s, r), infinity), CP);
}
