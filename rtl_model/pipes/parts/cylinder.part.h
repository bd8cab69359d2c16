/* A cylinder's own frame, in which it is x^2 + y^2 <= r^2, |z| <= h, and the nearest normal of an ellipse.
 *
 * Coordinates are taken from p0, since p - p0 rounds relative to the distance of the two points and not to their
 * distance from the origin; then z is counted from the middle. Fourteen words of it depend on the cylinder alone. */

typedef struct HP_NAMED(cylinder) {
    vec3 origin;  /* p0 */
    vec3 u, v, a; /* orthonormal, a along the axis */
    num h, r;     /* half length, radius */
    num limit;    /* infinity; 0 when there is no such cylinder: p0 = p1, a negative radius, a NaN, an infinity */
} HP_NAMED(cylinder);

/* The two axes beside a: T. Duff et al., "Building an Orthonormal Basis, Revisited", 2017, listing 3. */
HP_INLINE HP_NAMED(cylinder) HP_NAMED(cylinder_of)(const num words[7]) {
    num zero = constant(0), one = constant(1);
    vec3 p0 = vec3_of(words, 0), way = sub3(vec3_of(words, 3), p0);
    num long_way = length(way), r = words[6];
    vec3 a = {div(way.x, long_way), div(way.y, long_way), div(way.z, long_way)};

    flag down = less(a.z, zero);
    num sign = select(down, constant(-1), one);
    num s = div(constant(-1), add(sign, a.z)), b = mul(mul(a.x, a.y), s);
    num xx = mul(mul(a.x, a.x), s);
    vec3 u = {add(one, select(down, neg(xx), xx)), select(down, neg(b), b), select(down, a.x, neg(a.x))};
    vec3 v = {b, add(sign, mul(mul(a.y, a.y), s)), neg(a.y)};

    num h = mul(constant(0.5f), long_way), infinity = constant(INFINITY);
    flag whole = and(and(less(zero, h), at_most(zero, r)), less(add(h, r), infinity));
    return (HP_NAMED(cylinder)){p0, u, v, a, h, r, select(whole, infinity, zero)};
}

HP_INLINE void HP_NAMED(put_cylinder)(num prepared[15], HP_NAMED(cylinder) c) {
    put_vec3(prepared, 0, c.origin);
    put_vec3(prepared, 3, c.u);
    put_vec3(prepared, 6, c.v);
    put_vec3(prepared, 9, c.a);
    prepared[12] = c.h;
    prepared[13] = c.r;
    prepared[14] = c.limit;
}

HP_INLINE HP_NAMED(cylinder) HP_NAMED(get_cylinder)(const num prepared[15]) {
    return (HP_NAMED(cylinder)){vec3_of(prepared, 0), vec3_of(prepared, 3), vec3_of(prepared, 6),
                                vec3_of(prepared, 9), prepared[12],         prepared[13],
                                prepared[14]};
}

/* A direction, and a point, as the cylinder sees them; and a point back. */
HP_INLINE vec3 HP_NAMED(turn_in)(HP_NAMED(cylinder) c, vec3 d) {
    return (vec3){dot(d, c.u), dot(d, c.v), dot(d, c.a)};
}

HP_INLINE vec3 HP_NAMED(move_in)(HP_NAMED(cylinder) c, vec3 p) {
    vec3 in = HP_NAMED(turn_in)(c, sub3(p, c.origin));
    return (vec3){in.x, in.y, sub(in.z, c.h)};
}

HP_INLINE vec3 HP_NAMED(move_out)(HP_NAMED(cylinder) c, vec3 p) {
    vec3 across = add3(scale3(p.x, c.u), scale3(p.y, c.v));
    return add3(c.origin, add3(across, scale3(add(p.z, c.h), c.a)));
}

/* The nearest normal of an ellipse with semi-axes r and k r to a point (x, y) inside it or near it: the cotangent of
 * the eccentric angle t of the nearest point (r cos t, k r sin t), whose normal is (k cos t, sin t).
 *
 * The normal through that point meets (x, y) when X/cos t - Y/sin t = R, with X = x, Y = k y, R = (1 - k^2) r: one
 * equation in two numbers, whatever the ellipse. With rho = cot t, p = (1 + rho^2)^(3/2) it says
 *
 *   X - Y rho - R rho / sqrt(1 + rho^2) = 0,    and Newton's step is rho' = (X p - R rho^3) / (R + Y p).
 *
 * X is not negative. The least positive root is the nearest point of the half y > 0, also from y < 0, where it need
 * not exist; the left side is convex, so that steps from the left of the root stay left and converge. */
HP_INLINE num HP_NAMED(ellipse_step)(num rho, num X, num Y, num R) {
    num rho2 = mul(rho, rho), w = add(constant(1), rho2);
    num p = mul(w, sqrt(w));
    return div(sub(mul(X, p), mul(R, mul(rho2, rho))), add(R, mul(Y, p)));
}

/* Steps are slow near the cusp of the evolute (X = R, Y = 0), where three normals meet. So begin at the last of a
 * few stations left of the root, which is where the left side is positive and falls. Then three steps leave at most
 * 2e-6 r of the distance, measured over ellipses from k = 1e-4 to 1 - 1e-4 and points close to the cusp and to the
 * rim. Where there is no root, it is any number. */
HP_INLINE num HP_NAMED(ellipse_normal)(num X, num Y, num R) {
    /* rho, rho / sqrt(1 + rho^2), minus the derivative of that */
    static const float station[7][3] = {
        {0.5f, 0.447213595f, -0.715541753f},   {1.2f, 0.76822128f, -0.262370656f},
        {2.2f, 0.910366477f, -0.0708566685f},  {4.0f, 0.9701425f, -0.0142668015f},
        {8.0f, 0.992277877f, -0.00190822669f}, {16.0f, 0.998052578f, -0.000242717067f},
        {40.0f, 0.999687646f, -1.5610363e-05f}};
    num rho = constant(0);
    for (unsigned i = 0; i < 7; i++) {
        num reach = add(mul(Y, constant(station[i][0])), mul(R, constant(station[i][1])));
        flag left = and(at_least(X, reach), less(mul(R, constant(station[i][2])), Y));
        rho = select(left, constant(station[i][0]), rho);
    }
    for (unsigned i = 0; i < 3; i++) rho = HP_NAMED(ellipse_step)(rho, X, Y, R);
    return rho;
}
