/* Ray against solid sphere. Not the textbook's quadratic, whose discriminant cancels: after E. Haines and others,
 * "Precision improvements for ray/sphere intersection", Ray Tracing Gems, 2019, the perpendicular p from the ray's
 * line to the centre is formed as a vector, and r^2 - p^2 as a product:
 *
 *   tc = (c - o).d / d.d     p = c - o - tc d     half = sqrt((r - |p|)(r + |p|) / d.d)     T = max(tc - half, 0)
 *
 * The line meets the sphere when |p| <= r, the ray when besides tc + half >= 0. An origin inside gives T = 0.
 *
 * tc is refined once by what p still has along d, so that T has its rounding alone. */

HP_INLINE void HP_NAMED(ray_sphere_prepare)(const num secondary[4], num prepared[4]) {
    put_vec3(prepared, 0, vec3_of(secondary, 0));
    prepared[3] = HP_NAMED(legal_size)(secondary[3]);
}

HP_INLINE answer HP_NAMED(ray_sphere_test)(const num primary[6], const num prepared[4], bits index, bool separation,
                                           num bar) {
    (void)bar; /* what it would spare comes too late to be worth asking */
    vec3 o = vec3_of(primary, 0), d = vec3_of(primary, 3);
    num r = prepared[3], zero = constant(0), infinity = constant(INFINITY);

    vec3 s = sub3(vec3_of(prepared, 0), o);
    HP_NAMED(approach) first = HP_NAMED(approach_of)(s, d);
    num rest = mul(dot(first.offset, d), first.inverse), tc = add(first.t, rest);
    num p = length(sub3(first.offset, scale3(rest, d)));
    flag direction = and(less(zero, first.inverse), less(first.inverse, infinity)),
         line = and(direction, at_most(p, r));
    UNLESS_ANY(line) if (!separation) return miss();

    num half = sqrt(mul(mul(sub(r, p), add(r, p)), first.inverse));
    flag F = and(line, at_least(add(tc, half), zero));
    num T = max(zero, sub(tc, half)); /* in this order -0 becomes 0 */
    vec3 CP = add3(o, scale3(T, d));
    if (!separation) return answer_of(F, index, T, CP);

    num distance = sub(select(at_least(tc, zero), p, length(s)), r);
    flag legal = and(direction, HP_NAMED(finite)(distance));
    return answer_with(F, index, T, select(legal, max(zero, distance), infinity), CP);
}
