/* Cylinder against cylinder, solid, flat caps: the depth is the least over all directions d, |d| = 1, of
 *
 *   f(d) = h1 |a1.d| + h2 |a2.d| + r1 |a1 x d| + r2 |a2 x d| - c.d
 *
 * with axes a, half lengths h, radii r, and c from the first middle to the second: what the second must move along d
 * to be free of the first. It is the support function of the Minkowski difference; a negative one separates. Any d
 * gives an upper bound, and f hardly changes near a smooth minimum, so directions need only be good, if f is
 * evaluated on the direction as it is.
 *
 * The frame. f depends on angles among a1, a2, c alone. The bisectors e+ of a1 and a2 (the sign of a2 makes their
 * angle at most a right one) and e- of a1 and -a2 are orthogonal however near the axes are to parallel, and what is
 * left of c gives the third coordinate: no cross product, no case. The numbers are the same when the cylinders are
 * swapped, but for the sign of e-. All else is done twice, each cylinder in turn being "one", in its own turned frame
 *
 *   a1 = (1, 0, 0), a2 = (g, -s, 0), c = (along, across, height), all but `across` not negative.
 *
 * Where a least f can be (K is the Minkowski difference, "rim" the circle around a cap):
 *   d = a1             cap of one against rim of the other;
 *   d = (0, 0, 1)      side against side, along a line each;
 *   d = (0, k, n)      side of one against rim of the other: an ellipse in the plane across a1 (`side`);
 *   anything           rim against rim (`rims`). */

typedef struct HP_NAMED(cylinders_roles) {
    num along, across, height;
    num g, s; /* cosine and sine of the angle between the axes */
    num h1, r1, h2, r2;
} HP_NAMED(cylinders_roles);

/* No NaN when `least` is none. */
HP_INLINE num HP_NAMED(cylinders_least)(num least, num f) {
    return select(less(f, least), f, least);
}

/* f at d, of any length. NaN when d is 0. */
HP_INLINE num HP_NAMED(cylinders_overlap)(HP_NAMED(cylinders_roles) o, vec3 d) {
    num y = sub(mul(o.g, d.x), mul(o.s, d.y)), v = add(mul(o.s, d.x), mul(o.g, d.y));
    num nn = mul(d.z, d.z), qq = add(mul(d.y, d.y), nn);
    num one = add(mul(o.h1, abs(d.x)), mul(o.r1, sqrt(qq)));
    num two = add(mul(o.h2, abs(y)), mul(o.r2, sqrt(add(mul(v, v), nn))));
    num way = dot((vec3){o.along, o.across, o.height}, d);
    return div(sub(add(one, two), way), sqrt(add(mul(d.x, d.x), qq)));
}

/* The side of one against the rim of the other. Across a1 the other is an ellipse, semi-axes r2 g and r2, drawn along
 * its axis by h2 s either way; the wanted d = (0, k, n) is the normal of that ellipse nearest to c. With w, p the
 * place of c seen from the middle of the ellipse and B = r2 s^2, z = p k/n solves
 *
 *   z - w = B z / sqrt(p^2 + g^2 z^2).
 *
 * The right side is concave. Its greatest root is the wanted one; lines above the square root's tangents (`fit`: the
 * root becomes (a p + b g z), a^2 + b^2 = 1, a quadratic for z remains) or the tangent itself (`turn`, which reads:
 * look at c from the ellipse's centre of curvature) come down to it from above, from any start. */
HP_INLINE vec3 HP_NAMED(cylinders_fit)(num w, num p, num B, num g, num a, num b) {
    num zero = constant(0), gb = mul(g, b), gbw = mul(gb, w), ap = mul(a, p);
    num half = sub(add(B, gbw), ap);
    num bow = mul(constant(4), mul(ap, gbw));
    num wide = sqrt(max(add(mul(half, half), bow), zero));
    flag high = less(zero, half);
    num k = select(high, add(half, wide), mul(constant(2), mul(a, w)));
    num n = select(high, mul(constant(2), mul(gb, p)), sub(wide, half));
    flag found = less(zero, k);
    return (vec3){zero, select(found, k, constant(1)), select(found, n, zero)};
}

HP_INLINE vec3 HP_NAMED(cylinders_turn)(num w, num p, num B, num g, vec3 d) {
    num zero = constant(0), gk = mul(g, d.y), i = div(constant(1), sqrt(add(mul(gk, gk), mul(d.z, d.z))));
    num a = mul(d.z, i), b = mul(gk, i), k = mul(d.y, i);
    return (vec3){zero, max(add(w, mul(B, mul(k, mul(b, b)))), zero), max(sub(p, mul(B, mul(a, mul(a, a)))), zero)};
}

/* The way out to that side. */
HP_INLINE num HP_NAMED(cylinders_side_depth)(HP_NAMED(cylinders_roles) o, num w, vec3 d) {
    num kk = mul(d.y, d.y), nn = mul(d.z, d.z), gk = mul(o.g, d.y);
    num rim = mul(o.r2, sqrt(add(mul(gk, gk), nn)));
    return add(o.r1, div(sub(rim, add(mul(w, d.y), mul(o.height, d.z))), sqrt(add(kk, nn))));
}

HP_INLINE vec3 HP_NAMED(cylinders_side)(HP_NAMED(cylinders_roles) o, bool separation, num *depth, num *closer) {
    num one = constant(1), half = constant(0.70710678f);
    num w = sub(abs(o.across), mul(o.h2, o.s)), p = o.height, B = mul(o.r2, mul(o.s, o.s));
    vec3 d = HP_NAMED(cylinders_fit)(w, p, B, o.g, half, half);
    num gk = mul(o.g, d.y), i = div(one, sqrt(add(mul(gk, gk), mul(d.z, d.z))));
    d = HP_NAMED(cylinders_fit)(w, p, B, o.g, mul(d.z, i), mul(gk, i));
    d = HP_NAMED(cylinders_turn)(w, p, B, o.g, HP_NAMED(cylinders_turn)(w, p, B, o.g, d));
    *depth = *closer = HP_NAMED(cylinders_side_depth)(o, w, d);
    if (separation) {
        vec3 near = d;
        REPEAT(step, 8) near = HP_NAMED(cylinders_turn)(w, p, B, o.g, near);
        *closer = HP_NAMED(cylinders_side_depth)(o, w, near);
    }
    return (vec3){constant(0), select(less(o.across, constant(0)), neg(d.y), d.y), d.z};
}

/* Rim against rim. The rim of one at its upper cap lies on every sphere around a point m below the cap, of radius
 * sqrt(r1^2 + m^2), on the axis. So f is the least over m of that radius less the distance of the point to the other
 * cylinder. The direction of that distance has a tangent of latitude a1.d/|a1 x d| = T(m)/r1, and m = T(m) at
 * the least. T rises with m; so steps from far above come down to the greatest root, which is the lowest of them but
 * for cases too rare to meet; Newton's steps, but no steeper than to a tenth. */
HP_INLINE vec3 HP_NAMED(cylinders_rim_step)(HP_NAMED(cylinders_roles) o, num *m) {
    num zero = constant(0), one = constant(1);
    num x = add(sub(o.along, o.h1), *m);
    num level = sub(mul(o.g, x), mul(o.s, o.across)), beside = add(mul(o.s, x), mul(o.g, o.across));
    num far = sqrt(add(mul(beside, beside), mul(o.height, o.height)));
    num out = sub(far, o.r2), above = sub(level, clamp(level, neg(o.h2), o.h2));
    flag outside = less(zero, out), apart = less(zero, abs(above));
    num share = select(outside, out, select(apart, zero, far)), lift = mul(above, far);

    num ru = mul(share, beside);
    vec3 d = {add(mul(ru, o.s), mul(lift, o.g)), sub(mul(ru, o.g), mul(lift, o.s)), mul(share, o.height)};
    num xx = mul(d.x, d.x), qq = add(mul(d.y, d.y), mul(d.z, d.z)), q = sqrt(qq);
    num inverse = div(one, mul(q, far)), i = mul(q, inverse);

    /* T and its slope r1 (D D'' + D'^2 - D'^2) / ... of the distance D(m), D' = dx/D */
    num slant = mul(mul(o.s, beside), i), slant2 = mul(slant, slant);
    num bend = add(slant2, mul(mul(share, i), sub(mul(o.s, o.s), slant2)));
    num both = add(select(outside, bend, zero), select(apart, mul(o.g, o.g), zero));
    num j = mul(far, inverse), rj = mul(o.r1, j), T = min(max(mul(rj, d.x), zero), mul(constant(1e4f), o.r1));
    num slope = mul(mul(mul(rj, far), mul(j, j)), sub(mul(both, add(xx, qq)), xx));
    num newton = div(sub(T, mul(slope, *m)), sub(one, slope));
    *m = select(less(slope, one), max(newton, mul(constant(0.1f), min(T, *m))), T);
    return d;
}

HP_INLINE vec3 HP_NAMED(cylinders_rims)(HP_NAMED(cylinders_roles) o, bool separation, num *depth, num *closer) {
    num m = mul(constant(100), o.r1);
    for (unsigned step = 0; step < 7; step++) HP_NAMED(cylinders_rim_step)(o, &m);
    vec3 d = HP_NAMED(cylinders_rim_step)(o, &m);
    *depth = *closer = HP_NAMED(cylinders_overlap)(o, d);
    if (separation) {
        REPEAT(step, 8) HP_NAMED(cylinders_rim_step)(o, &m);
        *closer =
            HP_NAMED(cylinders_least)(*depth, HP_NAMED(cylinders_overlap)(o, HP_NAMED(cylinders_rim_step)(o, &m)));
    }
    return d;
}

/* The rim point of two that d meets, seen from the middle of one; the cap's middle when d is its normal. */
HP_INLINE vec3 HP_NAMED(cylinders_met)(HP_NAMED(cylinders_roles) o, vec3 d) {
    num zero = constant(0);
    num y = sub(mul(o.g, d.x), mul(o.s, d.y)), v = add(mul(o.s, d.x), mul(o.g, d.y));
    num q = sqrt(add(mul(v, v), mul(d.z, d.z)));
    num rim = select(less(zero, q), div(o.r2, q), zero), end = select(less(y, zero), neg(o.h2), o.h2);
    num out = mul(rim, v);
    return (vec3){sub(o.along, add(mul(end, o.g), mul(out, o.s))), add(o.across, sub(mul(end, o.s), mul(out, o.g))),
                  sub(o.height, mul(rim, d.z))};
}

/* What a direction gives: f, as without and with the distance of a miss; a point where the cylinders meet when it is
 * followed, and how far that one is from being in both: directions with the same f have different points. */
typedef struct HP_NAMED(cylinders_contact) {
    num depth, closer;
    vec3 at;
    num lack;
} HP_NAMED(cylinders_contact);

HP_INLINE HP_NAMED(cylinders_contact)
    HP_NAMED(cylinders_shallower)(HP_NAMED(cylinders_contact) a, HP_NAMED(cylinders_contact) b) {
    flag better = less(b.lack, a.lack);
    return (HP_NAMED(cylinders_contact)){HP_NAMED(cylinders_least)(a.depth, b.depth),
                                         HP_NAMED(cylinders_least)(a.closer, b.closer), select3(better, b.at, a.at),
                                         select(better, b.lack, a.lack)};
}

/* By how much a point, seen from the middle of a cylinder along x, is outside: the square. */
HP_INLINE num HP_NAMED(cylinders_outside)(vec3 q, num h, num r) {
    num zero = constant(0), across = sub(sqrt(add(mul(q.y, q.y), mul(q.z, q.z))), r), along = sub(abs(q.x), h);
    num x = max(along, zero), y = max(across, zero);
    return add(mul(x, x), mul(y, y));
}

HP_INLINE HP_NAMED(cylinders_contact)
    HP_NAMED(cylinders_contact_along)(HP_NAMED(cylinders_roles) o, vec3 d, num depth, num closer) {
    vec3 at = HP_NAMED(cylinders_met)(o, d);
    return (HP_NAMED(cylinders_contact)){depth, closer, at, HP_NAMED(cylinders_outside)(at, o.h1, o.r1)};
}

HP_INLINE HP_NAMED(cylinders_contact) HP_NAMED(cylinders_rim)(HP_NAMED(cylinders_roles) o, bool separation) {
    num depth, closer;
    vec3 d = HP_NAMED(cylinders_rims)(o, separation, &depth, &closer);
    return HP_NAMED(cylinders_contact_along)(o, d, depth, closer);
}

/* What |at + slope t| <= half leaves of low <= t <= high. */
HP_INLINE void HP_NAMED(cylinders_cut)(num at, num slope, num half, num *low, num *high) {
    *low = max(*low, div(sub(neg(half), at), slope));
    *high = min(*high, div(sub(half, at), slope));
}

/* What of a diameter lies beyond a chord's middle. */
HP_INLINE num HP_NAMED(cylinders_chord)(num r, num away) {
    return sqrt(max(mul(sub(r, away), add(r, away)), constant(0)));
}

/* The middle of what the other cuts out of the line (t, y, z), |t| <= h1, of one. */
HP_INLINE HP_NAMED(cylinders_contact)
    HP_NAMED(cylinders_along)(HP_NAMED(cylinders_roles) o, num y, num z, num f, num closer) {
    num half = constant(0.5f), dy = sub(y, o.across), dz = sub(z, o.height);
    num level = neg(mul(o.s, dy)), beside = mul(o.g, dy);
    num low = sub(neg(o.h1), o.along), high = sub(o.h1, o.along);
    HP_NAMED(cylinders_cut)(beside, o.s, HP_NAMED(cylinders_chord)(o.r2, dz), &low, &high);
    HP_NAMED(cylinders_cut)(level, o.g, o.h2, &low, &high);
    num x = clamp(add(o.along, mul(half, add(low, high))), neg(o.h1), o.h1), dx = sub(x, o.along);
    vec3 seen = {add(level, mul(o.g, dx)), add(beside, mul(o.s, dx)), dz};
    return (HP_NAMED(cylinders_contact)){f, closer, {x, y, z}, HP_NAMED(cylinders_outside)(seen, o.h2, o.r2)};
}

/* The same across the axis of one, |t| <= r1: flat through flat. The third coordinate is chosen last. */
HP_INLINE HP_NAMED(cylinders_contact) HP_NAMED(cylinders_across)(HP_NAMED(cylinders_roles) o, num f) {
    num zero = constant(0), half = constant(0.5f), r1 = add(o.r1, zero);
    num x = clamp(o.along, neg(o.h1), o.h1), dx = sub(x, o.along);
    num level = add(mul(o.g, dx), mul(o.s, o.across)), beside = sub(mul(o.s, dx), mul(o.g, o.across));
    num low = neg(r1), high = r1;
    HP_NAMED(cylinders_cut)(beside, o.g, add(o.r2, zero), &low, &high);
    HP_NAMED(cylinders_cut)(neg(level), o.s, o.h2, &low, &high);
    num y = clamp(mul(half, add(low, high)), neg(r1), r1);
    beside = add(beside, mul(o.g, y));
    num reach1 = HP_NAMED(cylinders_chord)(o.r1, y), reach2 = HP_NAMED(cylinders_chord)(o.r2, beside);
    num z = min(mul(half, add(max(sub(o.height, reach2), zero), min(o.height, reach1))), reach1);
    vec3 seen = {sub(level, mul(o.s, y)), beside, sub(z, o.height)};
    return (HP_NAMED(cylinders_contact)){f, f, {x, y, z}, HP_NAMED(cylinders_outside)(seen, o.h2, o.r2)};
}

/* f(a1). */
HP_INLINE num HP_NAMED(cylinders_cap)(HP_NAMED(cylinders_roles) o) {
    return sub(add(o.h1, add(mul(o.h2, o.g), mul(o.r2, o.s))), o.along);
}

HP_INLINE HP_NAMED(cylinders_contact) HP_NAMED(cylinders_cap_or_side)(HP_NAMED(cylinders_roles) o, bool separation) {
    num zero = constant(0), cap = HP_NAMED(cylinders_cap)(o), depth, closer;
    HP_NAMED(cylinders_contact)
    caps = HP_NAMED(cylinders_contact_along)(o, (vec3){constant(1), zero, zero}, cap, cap);
    vec3 d = HP_NAMED(cylinders_side)(o, separation, &depth, &closer);
    num i = div(o.r1, sqrt(add(mul(d.y, d.y), mul(d.z, d.z))));
    HP_NAMED(cylinders_contact) side = HP_NAMED(cylinders_contact_along)(o, d, depth, closer);
    HP_NAMED(cylinders_contact) line = HP_NAMED(cylinders_along)(o, mul(i, d.y), mul(i, d.z), depth, closer);
    return HP_NAMED(cylinders_shallower)(HP_NAMED(cylinders_shallower)(caps, side), line);
}

/* Side against side: a line along the axis of one at a third coordinate that suits both radii. */
HP_INLINE HP_NAMED(cylinders_contact) HP_NAMED(cylinders_lines)(HP_NAMED(cylinders_roles) o) {
    num zero = constant(0), f = sub(add(o.r1, o.r2), o.height);
    num below = max(sub(o.height, o.r2), zero), above = min(o.height, add(o.r1, zero));
    num z = mul(constant(0.5f), add(below, above));
    return HP_NAMED(cylinders_shallower)(HP_NAMED(cylinders_along)(o, zero, z, f, f),
                                         HP_NAMED(cylinders_across)(o, f));
}

/* Both cylinders in the frame of the bisectors e, origin in the middle of the first; and one turned frame for each.
 * `rest` is what c has across both bisectors. A turned frame is turned half round so that `along` is not negative,
 * and `across` is not when `along` is 0: swapping the cylinders changes nothing. The second's is seen in a mirror
 * too. */
typedef struct HP_NAMED(cylinders_meeting) {
    vec3 plus, minus, rest, c;
    num cos, sin; /* of half the angle between the axes */
    HP_NAMED(cylinders_roles) first, second;
    flag turned_first, turned_second;
} HP_NAMED(cylinders_meeting);

HP_INLINE HP_NAMED(cylinders_roles) HP_NAMED(cylinders_turned)(HP_NAMED(cylinders_roles) o, flag *turned) {
    num zero = constant(0);
    *turned = or (less(o.along, zero), and(at_most(o.along, zero), less(o.across, zero)));
    o.across = select(*turned, neg(o.across), o.across);
    o.along = abs(o.along);
    return o;
}

HP_INLINE HP_NAMED(cylinders_meeting) HP_NAMED(cylinders_meeting_of)(const num first[11], const num second[11]) {
    num zero = constant(0), one = constant(1), half = constant(0.5f);
    vec3 a1 = vec3_of(first, 6), a2 = vec3_of(second, 6);
    vec3 way0 = sub3(vec3_of(second, 0), vec3_of(first, 0)), way1 = sub3(vec3_of(second, 3), vec3_of(first, 3));
    vec3 c = scale3(half, add3(way0, way1));

    flag blunt = less(dot(a1, a2), zero);
    vec3 sum = add3(a1, a2), difference = sub3(a1, a2);
    vec3 plus = select3(blunt, difference, sum), minus = select3(blunt, sum, difference);
    num two_cos = length(plus);
    plus = scale3(div(one, two_cos), plus);
    minus = sub3(minus, scale3(dot(minus, plus), plus));
    num two_sin = length(minus); /* 0: parallel; then there is no e-, and none is needed */
    minus = scale3(select(less(zero, two_sin), div(one, two_sin), zero), minus);
    num cos = mul(half, two_cos), sin = mul(half, two_sin);
    num g = max(sub(mul(cos, cos), mul(sin, sin)), constant(0x1p-24f)), s = mul(two_cos, sin);

    num x = dot(c, plus), y = dot(c, minus);
    vec3 rest = sub3(sub3(c, scale3(x, plus)), scale3(y, minus));
    num z = length(rest), cx = mul(cos, x), sx = mul(sin, x), cy = mul(cos, y), sy = mul(sin, y);
    num h1 = first[9], r1 = first[10], h2 = second[9], r2 = second[10];
    HP_NAMED(cylinders_meeting)
    m = {.plus = plus, .minus = minus, .rest = rest, .c = {x, y, z}, .cos = cos, .sin = sin};
    HP_NAMED(cylinders_roles) one_two = {add(cx, sy), sub(cy, sx), z, g, s, h1, r1, h2, r2};
    HP_NAMED(cylinders_roles) two_one = {sub(cx, sy), neg(add(cy, sx)), z, g, s, h2, r2, h1, r1};
    m.first = HP_NAMED(cylinders_turned)(one_two, &m.turned_first);
    m.second = HP_NAMED(cylinders_turned)(two_one, &m.turned_second);
    return m;
}

/* Contacts in the frame of the bisectors. */
HP_INLINE HP_NAMED(cylinders_contact)
    HP_NAMED(cylinders_on_first)(HP_NAMED(cylinders_meeting) m, HP_NAMED(cylinders_contact) a) {
    num x = select(m.turned_first, neg(a.at.x), a.at.x), y = select(m.turned_first, neg(a.at.y), a.at.y);
    a.at.x = sub(mul(m.cos, x), mul(m.sin, y)), a.at.y = add(mul(m.sin, x), mul(m.cos, y));
    return a;
}

HP_INLINE HP_NAMED(cylinders_contact)
    HP_NAMED(cylinders_on_second)(HP_NAMED(cylinders_meeting) m, HP_NAMED(cylinders_contact) a) {
    num x = select(m.turned_second, neg(a.at.x), a.at.x), y = select(m.turned_second, neg(a.at.y), a.at.y);
    num plus = sub(mul(m.cos, x), mul(m.sin, y)), minus = add(mul(m.sin, x), mul(m.cos, y));
    a.at = (vec3){sub(m.c.x, plus), add(m.c.y, minus), sub(m.c.z, a.at.z)};
    return a;
}

/* The nearest point of a cylinder around the origin. */
HP_INLINE vec3 HP_NAMED(cylinders_into)(vec3 q, num cos, num sin, num h, num r) {
    num along = add(mul(cos, q.x), mul(sin, q.y)), across = sub(mul(cos, q.y), mul(sin, q.x));
    num far = sqrt(add(mul(across, across), mul(q.z, q.z)));
    num share = select(less(r, far), div(r, far), constant(1));
    along = clamp(along, neg(h), h), across = mul(share, across);
    return (vec3){sub(mul(cos, along), mul(sin, across)), add(mul(sin, along), mul(cos, across)), mul(share, q.z)};
}

/* A point of both, in the world: from near the contact into one and the other by turns. Both are made a little
 * smaller, as far as the depth allows: what these steps still lack they lack inside. Nothing is lost when the point
 * is put between the two middles in the third coordinate, for both are their own mirror images there; so the third
 * axis need not be known better than `rest`. */
HP_INLINE vec3 HP_NAMED(cylinders_common_point)(HP_NAMED(cylinders_meeting) m, HP_NAMED(cylinders_contact) contact,
                                                vec3 p0, vec3 p1) {
    num zero = constant(0), margin = mul(constant(0.125f), contact.depth);
    num h1 = max(sub(m.first.h1, margin), zero), r1 = max(sub(m.first.r1, margin), zero);
    num h2 = max(sub(m.first.h2, margin), zero), r2 = max(sub(m.first.r2, margin), zero);
    vec3 q = contact.at;
    for (unsigned turn = 0; turn < 3; turn++) {
        q = HP_NAMED(cylinders_into)(q, m.cos, m.sin, h1, r1);
        q = add3(m.c, HP_NAMED(cylinders_into)(sub3(q, m.c), m.cos, neg(m.sin), h2, r2));
    }
    vec3 seen = {add(mul(m.cos, q.x), mul(m.sin, q.y)), sub(mul(m.cos, q.y), mul(m.sin, q.x)), q.z};
    q = select3(less(HP_NAMED(cylinders_outside)(seen, m.first.h1, m.first.r1), contact.lack), q, contact.at);
    num share = select(less(zero, m.c.z), div(clamp(q.z, zero, m.c.z), m.c.z), zero);
    vec3 middle = scale3(constant(0.5f), add3(p0, p1));
    return add3(middle, add3(add3(scale3(q.x, m.plus), scale3(q.y, m.minus)), scale3(share, m.rest)));
}

/* p0, p1, unit axis, half length, radius */
HP_INLINE void HP_NAMED(cylinder_cylinder_prepare)(const num secondary[7], num prepared[11]) {
    vec3 p0 = vec3_of(secondary, 0), p1 = vec3_of(secondary, 3), way = sub3(p1, p0);
    num long_way = length(way);
    put_vec3(prepared, 0, p0);
    put_vec3(prepared, 3, p1);
    put_vec3(prepared, 6, scale3(div(constant(1), long_way), way));
    prepared[9] = mul(constant(0.5f), long_way);
    prepared[10] = secondary[6];
}

HP_INLINE answer HP_NAMED(cylinder_cylinder_test)(const num primary[7], const num prepared[11], bits index,
                                                  bool separation, num bar) {
    num zero = constant(0), infinity = constant(INFINITY);
    num first[11];
    HP_NAMED(cylinder_cylinder_prepare)(primary, first);
    HP_NAMED(cylinders_meeting) m = HP_NAMED(cylinders_meeting_of)(first, prepared);
    HP_NAMED(cylinders_roles) one = m.first, two = m.second;

    HP_NAMED(cylinders_contact) best = HP_NAMED(cylinders_on_first)(m, HP_NAMED(cylinders_lines)(one));
    num all = add(add(one.along, two.along), add(add(one.h1, one.h2), best.depth));
    flag legal = and(and(at_least(one.r1, zero), at_least(one.r2, zero)), less(abs(all), infinity));

    UNLESS_ANY(and(
        legal, could_count(min(min(HP_NAMED(cylinders_cap)(one), HP_NAMED(cylinders_cap)(two)), best.depth), bar)))
    if (!separation) return miss();

    HP_NAMED(cylinders_contact)
    more[5] = {
        HP_NAMED(cylinders_on_second)(m, HP_NAMED(cylinders_lines)(two)),
        HP_NAMED(cylinders_on_first)(m, HP_NAMED(cylinders_cap_or_side)(one, separation)),
        HP_NAMED(cylinders_on_second)(m, HP_NAMED(cylinders_cap_or_side)(two, separation)),
    };
    for (unsigned i = 0; i < 3; i++) best = HP_NAMED(cylinders_shallower)(best, more[i]);
    UNLESS_ANY(and(legal, could_count(best.depth, bar))) if (!separation) return miss();

    more[3] = HP_NAMED(cylinders_on_first)(m, HP_NAMED(cylinders_rim)(one, separation));
    more[4] = HP_NAMED(cylinders_on_second)(m, HP_NAMED(cylinders_rim)(two, separation));
    for (unsigned i = 3; i < 5; i++) best = HP_NAMED(cylinders_shallower)(best, more[i]);
    flag F = and(legal, at_least(best.depth, zero));
    UNLESS_ANY(F) if (!separation) return miss();
    vec3 CP = HP_NAMED(cylinders_common_point)(m, best, vec3_of(first, 0), vec3_of(first, 3));
    if (!separation) return answer_of(F, index, best.depth, CP);
    num distance = neg(HP_NAMED(cylinders_least)(best.depth, best.closer));
    return answer_with(F, index, best.depth, select(legal, distance, infinity), CP);
}
