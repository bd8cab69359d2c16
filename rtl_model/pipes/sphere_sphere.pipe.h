/* Sphere against sphere. With c the distance of the centres,
 *
 *   depth = r1 + r2 - c      separation = c - (r1 + r2)
 *
 * also when one contains the other: the way out is along the line of centres, and with equal centres it is any. One
 * root in the path of F and T; both sums are symmetric, so swapped spheres give the same bits.
 *
 * CP. On the line of centres, from the first centre on, the spheres are the intervals [-r1, r1] and [c - r2, c + r2];
 * CP is the middle of what they share. Equal centres share that point, and there is no line. */

HP_INLINE void HP_NAMED(sphere_sphere_prepare)(const num secondary[4], num prepared[4]) {
    put_vec3(prepared, 0, vec3_of(secondary, 0));
    prepared[3] = HP_NAMED(legal_size)(secondary[3]);
}

HP_INLINE answer HP_NAMED(sphere_sphere_test)(const num primary[4], const num prepared[4], bits index,
                                              bool separation, num bar) {
    num r1 = primary[3], r2 = prepared[3], zero = constant(0), infinity = constant(INFINITY);
    vec3 c1 = vec3_of(primary, 0), between = sub3(vec3_of(prepared, 0), c1);
    num c = length(between), reach = add(r1, r2);

    num T = sub(reach, c);
    flag legal = and(at_least(r1, zero), HP_NAMED(finite)(T)), F = and(legal, at_most(c, reach));
    UNLESS_ANY(and(F, less(bar, T))) if (!separation) return miss();

    num first = max(neg(add(r1, zero)), sub(c, r2)), last = min(add(r1, zero), add(c, r2));
    num middle = mul(constant(0.5f), add(first, last));
    vec3 CP = add3(c1, scale3(select(less(zero, c), div(middle, c), zero), between));
    if (!separation) return answer_of(F, index, T, CP);
    return answer_with(F, index, T, select(legal, sub(c, reach), infinity), CP);
}
