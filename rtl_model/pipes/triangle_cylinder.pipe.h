/* Triangle against solid cylinder with flat caps, in the cylinder's frame: |z| <= h, x^2 + y^2 <= r^2.
 *
 * The depth is the least over unit directions d of f(d) = max v.d + h |d.z| + r |d.xy|, the support function of the
 * Minkowski difference: the distance of the origin to its boundary. A ball touches a convex body's boundary from
 * inside only where that is smooth, so d is a normal of one of its facets or curved parts:
 *
 *   the caps                 +-z
 *   the triangle             +-n
 *   an edge and a generator  +-u, horizontal and perpendicular to the edge (parts/rim.part.h)
 *   a vertex and the side    the horizontal way from the vertex to the axis; only the nearest vertex can be it
 *   an edge and a rim        a u +- q
 *
 * Each direction, right or not, gives an upper bound of the depth, and a negative one separates: f is evaluated on
 * the very vector found, with all its roundings. Candidates without a direction (an edge of length 0) are NaN, which
 * min leaves out when it stands first. */

HP_INLINE void HP_NAMED(triangle_cylinder_prepare)(const num secondary[7], num prepared[15]) {
    HP_NAMED(put_cylinder)(prepared, HP_NAMED(cylinder_of)(secondary));
}

/* The depth under both sides of the triangle. n is made of a unit edge and the height over it, so that it is
 * perpendicular to the edge in a sliver too. */
HP_INLINE vec3 HP_NAMED(triangle_cylinder_normal)(vec3 along, vec3 other) {
    vec3 height = sub3(other, scale3(dot(other, along), along));
    return cross(along, height);
}

HP_INLINE num HP_NAMED(triangle_cylinder_face)(vec3 n, vec3 v0, vec3 v2, num h, num r) {
    num across = add(mul(n.x, n.x), mul(n.y, n.y)), at0 = dot(v0, n), at2 = dot(v2, n);
    num reach = add(mul(h, abs(n.z)), mul(r, sqrt(across)));
    num side = min(max(at0, at2), neg(min(at0, at2)));
    return div(add(side, reach), sqrt(add(across, mul(n.z, n.z))));
}

/* The depth of the vertex nearest to the axis under the side. s: squared distances from the axis. From the axis
 * itself all ways are as good; one must be tried, for a triangle that is a point has no edge to give another. */
HP_INLINE num HP_NAMED(triangle_cylinder_vertex)(const vec3 v[3], const num s[3], num r) {
    flag first = less(s[0], s[1]), last = less(s[2], min(s[0], s[1]));
    num x = select(last, v[2].x, select(first, v[0].x, v[1].x));
    num y = select(last, v[2].y, select(first, v[0].y, v[1].y));
    num nearest = min(min(s[0], s[1]), s[2]), one = constant(1);
    flag apart = less(constant(0), nearest);
    x = select(apart, x, one), nearest = select(apart, nearest, one);
    num a = add(mul(x, v[0].x), mul(y, v[0].y)), b = add(mul(x, v[1].x), mul(y, v[1].y));
    num c = add(mul(x, v[2].x), mul(y, v[2].y));
    return sub(r, div(min(min(a, b), c), sqrt(nearest)));
}

/* An edge against the rims; u and q: coordinates of a vertex on the edge and of the opposite one. */
HP_INLINE num HP_NAMED(triangle_cylinder_rims)(HP_NAMED(turning) t, num h, num r, const num u[2], const num q[2]) {
    num up = HP_NAMED(rim_turn)(t, h, r, u[0], q[0]), down = HP_NAMED(rim_turn)(t, h, r, u[0], neg(q[0]));
    num above = max(add(mul(up, u[0]), q[0]), add(mul(up, u[1]), q[1]));
    num below = max(sub(mul(down, u[0]), q[0]), sub(mul(down, u[1]), q[1]));
    return min(HP_NAMED(rim_depth)(t, h, r, up, above), HP_NAMED(rim_depth)(t, h, r, down, below));
}

/* The point of the plane on the chord through the cylinder's middle that n crosses, and how far it is outside of the
 * triangle; NaN without a plane. */
HP_INLINE HP_NAMED(common)
    HP_NAMED(triangle_cylinder_pierced)(const vec3 v[3], const HP_NAMED(turning) t[3], vec3 n, num h, num r) {
    vec3 end = HP_NAMED(furthest_of_cylinder)(n, h, r);
    num part = div(dot(v[0], n), dot(end, n));
    vec3 p = scale3(clamp(part, constant(-1), constant(1)), end);
    num inside = constant(INFINITY);
    REPEAT(i, 3) inside = min(dot(cross(t[i].e, sub3(p, v[i])), n), inside);
    return (HP_NAMED(common)){p, neg(div(inside, length(n)))};
}

/* A point of both: the middle of what the cylinder leaves of an edge; where no edge comes in, the cylinder sticks
 * through the face. */
HP_INLINE vec3 HP_NAMED(triangle_cylinder_common)(const vec3 v[3], const HP_NAMED(turning) t[3], const num u[3][2],
                                                  vec3 n, num h, num r) {
    HP_NAMED(common) best = {v[0], HP_NAMED(outside_cylinder)(v[0], h, r)};
    REPEAT(i, 3) {
        vec3 e = sub3(v[(i + 1) % 3], v[i]);
        best = HP_NAMED(less_outside)(HP_NAMED(edge_in_cylinder)(v[i], e, u[i][0], h, r), best);
    }
    return HP_NAMED(less_outside)(HP_NAMED(triangle_cylinder_pierced)(v, t, n, h, r), best).p;
}

/* The distance of a miss. The nearest point of the triangle is on an edge, or within the face; then the cylinder's is
 * the one furthest along -n or n. */
HP_INLINE num HP_NAMED(triangle_cylinder_distance)(const vec3 v[3], vec3 n, num h, num r) {
    num least = constant(INFINITY);
    REPEAT(i, 3) {
        least = min(HP_NAMED(edge_to_cylinder)(v[i], sub3(v[(i + 1) % 3], v[i]), h, r), least);
    }
    vec3 end = HP_NAMED(furthest_of_cylinder)(n, h, r), ab = sub3(v[1], v[0]), ac = sub3(v[2], v[0]);
    REPEAT(i, 2) {
        flag finite;
        vec3 p = i ? end : neg3(end), a = sub3(v[0], p), b = sub3(v[1], p);
        num squared = HP_NAMED(nearest_of_triangle)(a, b, ab, ac, sub3(ac, ab), &finite).squared;
        least = min(sqrt(squared), least);
    }
    return least;
}

HP_INLINE answer HP_NAMED(triangle_cylinder_test)(const num primary[9], const num prepared[15], bits index,
                                                  bool separation, num bar) {
    HP_NAMED(cylinder) c = HP_NAMED(get_cylinder)(prepared);
    num h = c.h, r = c.r, zero = constant(0);
    vec3 v[3];
    num s[3];
    for (unsigned i = 0; i < 3; i++) {
        v[i] = HP_NAMED(move_in)(c, vec3_of(primary, 3 * i));
        s[i] = add(mul(v[i].x, v[i].x), mul(v[i].y, v[i].y));
    }
    num size = add(add(add(s[0], s[1]), s[2]), add(add(abs(v[0].z), abs(v[1].z)), abs(v[2].z)));
    flag sound = less(size, c.limit);

    num top = max(max(v[0].z, v[1].z), v[2].z), bottom = min(min(v[0].z, v[1].z), v[2].z);
    num depth = add(min(top, neg(bottom)), h);
    depth = min(HP_NAMED(triangle_cylinder_vertex)(v, s, r), depth);
    HP_NAMED(turning) t[3];
    num u[3][2], q[3][2];
    REPEAT(i, 3) {
        vec3 start = v[i], opposite = v[(i + 2) % 3];
        t[i] = HP_NAMED(turning_about)(sub3(v[(i + 1) % 3], start));
        u[i][0] = HP_NAMED(along_u)(t[i], start), u[i][1] = HP_NAMED(along_u)(t[i], opposite);
        q[i][0] = dot(start, t[i].q), q[i][1] = dot(opposite, t[i].q);
        num side = min(max(u[i][0], u[i][1]), neg(min(u[i][0], u[i][1])));
        depth = min(add(side, r), depth);
    }
    vec3 n = HP_NAMED(triangle_cylinder_normal)(t[0].e, sub3(v[2], v[0]));
    depth = min(HP_NAMED(triangle_cylinder_face)(n, v[0], v[2], h, r), depth);
    UNLESS_ANY(and(sound, could_count(depth, bar))) if (!separation) return miss();

    REPEAT(i, 3) depth = min(HP_NAMED(triangle_cylinder_rims)(t[i], h, r, u[i], q[i]), depth);
    flag F = and(sound, at_least(depth, zero));
    UNLESS_ANY(F) if (!separation) return miss();
    vec3 CP = HP_NAMED(move_out)(c, HP_NAMED(triangle_cylinder_common)(v, t, u, n, h, r));
    if (!separation) return answer_of(F, index, abs(depth), CP);
    num distance = HP_NAMED(triangle_cylinder_distance)(v, n, h, r);
    return answer_with(F, index, abs(depth), select(sound, distance, constant(INFINITY)), CP);
}
