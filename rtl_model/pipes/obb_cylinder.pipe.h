/* Obb against solid cylinder with flat caps, in the cylinder's frame: |z| <= h, x^2 + y^2 <= r^2.
 *
 * The depth is the least of f(d) = sum e |b.d| + c.d + h |d.z| + r |d.xy| over unit directions d, and d is a normal
 * of a facet or of a curved part of the Minkowski difference (triangle_cylinder.pipe.h says why, and why any
 * direction is an upper bound):
 *
 *   the caps                 +-z
 *   the faces                +-b
 *   an edge and a generator  +-u, horizontal and perpendicular to the edge (parts/rim.part.h)
 *   a vertex and the side    the horizontal way from the vertex to the axis; only the nearest vertex can be it
 *   an edge and a rim        a u +- q
 *
 * The last for each of three directions of edges and two rims. On that half circle of directions three edges support
 * the box one after another; obb_cylinder_edge chooses the one to try. */

HP_INLINE void HP_NAMED(obb_cylinder_prepare)(const num secondary[7], num prepared[15]) {
    HP_NAMED(put_cylinder)(prepared, HP_NAMED(cylinder_of)(secondary));
}

typedef struct HP_NAMED(box_there) {
    vec3 c, b[3];
    num e[3];
    flag sound; /* no NaN, no infinity, no negative size */
} HP_NAMED(box_there);

/* The axes, of either hand, take one of Newton's steps to the orthonormal frame next to them (obb_obb.pipe.h). */
HP_INLINE HP_NAMED(box_there) HP_NAMED(obb_cylinder_box)(HP_NAMED(cylinder) c, const num words[15]) {
    num zero = constant(0), infinity = constant(INFINITY), half = constant(0.5f);
    HP_NAMED(box_there) box = {.c = HP_NAMED(move_in)(c, vec3_of(words, 0))};
    vec3 b[3];
    for (unsigned i = 0; i < 3; i++) b[i] = HP_NAMED(turn_in)(c, vec3_of(words, 6 + 3 * i));
    num hand = select(less(dot(cross(b[0], b[1]), b[2]), zero), neg(half), half);
    num size = abs(box.c.z);
    flag sound = less(zero, infinity);
    for (unsigned i = 0; i < 3; i++) {
        vec3 other = scale3(hand, cross(b[(i + 1) % 3], b[(i + 2) % 3]));
        box.b[i] = add3(scale3(half, b[i]), other);
        box.e[i] = words[3 + i];
        size = add(size, add(abs(b[i].z), box.e[i]));
        sound = i ? and(sound, at_least(box.e[i], zero)) : at_least(box.e[i], zero);
    }
    box.sound = and(sound, less(size, c.limit));
    return box;
}

HP_INLINE num HP_NAMED(obb_cylinder_face)(vec3 c, vec3 b, num e, num h, num r) {
    num reach = add(mul(h, abs(b.z)), mul(r, sqrt(add(mul(b.x, b.x), mul(b.y, b.y)))));
    return sub(add(e, reach), abs(dot(c, b)));
}

/* The depth of the corner nearest to the axis under the side: r plus the support of the box in the direction -p/|p|,
 * p where the corner is seen along the axis. */
HP_INLINE num HP_NAMED(obb_cylinder_vertex)(HP_NAMED(box_there) box, num r) {
    num x[3], y[3], best_x = constant(0), best_y = constant(0), nearest = constant(INFINITY);
    for (unsigned i = 0; i < 3; i++) x[i] = mul(box.e[i], box.b[i].x), y[i] = mul(box.e[i], box.b[i].y);
    for (unsigned corner = 0; corner < 8; corner++) {
        num px = box.c.x, py = box.c.y;
        for (unsigned i = 0; i < 3; i++) {
            px = corner >> i & 1 ? add(px, x[i]) : sub(px, x[i]);
            py = corner >> i & 1 ? add(py, y[i]) : sub(py, y[i]);
        }
        num s = add(mul(px, px), mul(py, py));
        flag nearer = less(s, nearest);
        best_x = select(nearer, px, best_x), best_y = select(nearer, py, best_y), nearest = min(s, nearest);
    }
    num support = neg(add(mul(box.c.x, best_x), mul(box.c.y, best_y)));
    for (unsigned i = 0; i < 3; i++) support = add(support, abs(add(mul(x[i], best_x), mul(y[i], best_y))));
    return add(r, div(support, sqrt(nearest)));
}

/* A kink of the box's support on the circle: the direction b u + q, where it passes from one edge to the next. */
typedef struct HP_NAMED(kink) {
    num b, away, rise, fall; /* b, |b|, and R |b|/s, -R k^2/s^3 with s^2 = b^2 + k^2 */
} HP_NAMED(kink);

HP_INLINE HP_NAMED(kink) HP_NAMED(kink_at)(HP_NAMED(turning) t, num r, num b) {
    num R = mul(r, mul(t.g, t.g)), k2 = mul(t.k, t.k), away = abs(b), s2 = add(mul(b, b), k2), s = sqrt(s2);
    num part = div(R, s);
    return (HP_NAMED(kink)){b, away, mul(part, away), neg(mul(part, div(k2, s2)))};
}

/* Whether the ellipse around (-x, -y) has its normal to the origin, a u + q, at a > b. With x not negative it has it
 * at a > 0 if anywhere, right of |b| when the left side of ellipse_normal's equation is positive and falls there. */
HP_INLINE flag HP_NAMED(turns_after)(HP_NAMED(turning) t, HP_NAMED(kink) at, num b, num r, num x, num y) {
    num zero = constant(0);
    flag right = at_least(x, zero), front = less(zero, b);
    flag after = and(at_least(abs(x), add(mul(y, at.away), at.rise)), less(at.fall, y));
    flag at_all = less(neg(mul(r, mul(t.g, t.g))), mul(t.k, y));
    return or (and(front, and(right, after)), and(not(front), and(at_all, or (right, not(after)))));
}

/* One direction of edges: the box as seen along it. */
typedef struct HP_NAMED(side_view) {
    HP_NAMED(turning) t;
    num u[2], q[2];                         /* half extents of the other two axes along u, not negative, and q */
    num c_u, c_q;                           /* the centre */
    num wide_u, wide_q, middle_u, middle_q; /* where the last, and the middle, edge are from the centre */
    HP_NAMED(kink) first, last;
} HP_NAMED(side_view);

HP_INLINE HP_NAMED(side_view) HP_NAMED(obb_cylinder_view)(HP_NAMED(box_there) box, unsigned k, num r) {
    HP_NAMED(side_view) v = {.t = HP_NAMED(turning_about)(box.b[k])};
    num turn[2], zero = constant(0);
    for (unsigned i = 0; i < 2; i++) {
        vec3 b = box.b[(k + 1 + i) % 3];
        num u = HP_NAMED(along_u)(v.t, b), q = dot(b, v.t.q), e = box.e[(k + 1 + i) % 3];
        q = select(less(u, zero), neg(q), q), u = abs(u);
        turn[i] = neg(div(q, u));
        v.u[i] = mul(u, e), v.q[i] = mul(q, e);
    }
    v.c_u = HP_NAMED(along_u)(v.t, box.c), v.c_q = dot(box.c, v.t.q);
    v.wide_u = add(v.u[0], v.u[1]), v.wide_q = add(v.q[0], v.q[1]);
    num apart_u = sub(v.u[0], v.u[1]), apart_q = sub(v.q[0], v.q[1]);
    flag swap = less(turn[1], turn[0]);
    v.middle_u = select(swap, neg(apart_u), apart_u), v.middle_q = select(swap, neg(apart_q), apart_q);
    v.first = HP_NAMED(kink_at)(v.t, r, select(swap, turn[1], turn[0]));
    v.last = HP_NAMED(kink_at)(v.t, r, select(swap, turn[0], turn[1]));
    return v;
}

/* The rim's depth on the half circle of directions s (a u + q), s = +-1, from a = -infinity up. The outer edges come
 * first where one can touch the rim: the middle one was never nearer then, in 250,000 hits of all classes, and every
 * arc without a normal of its own has its least at a kink, which is a face, or at its end, which is +-u. */
HP_INLINE num HP_NAMED(obb_cylinder_edge)(HP_NAMED(side_view) v, num s, num h, num r) {
    num c_u = mul(s, v.c_u), c_q = mul(s, v.c_q), lift = mul(h, v.t.g);
    num u0 = sub(c_u, v.wide_u), q0 = sub(c_q, v.wide_q), u2 = add(c_u, v.wide_u), q2 = add(c_q, v.wide_q);
    flag before = HP_NAMED(turns_after)(v.t, v.first, neg(v.first.b), r, u0, neg(add(q0, lift)));
    flag after = HP_NAMED(turns_after)(v.t, v.last, v.last.b, r, neg(u2), neg(add(q2, lift)));
    num u = select(before, u0, select(after, u2, add(c_u, v.middle_u)));
    num q = select(before, q0, select(after, q2, add(c_q, v.middle_q)));
    num a = HP_NAMED(rim_turn)(v.t, h, r, u, q), support = add(mul(a, c_u), c_q);
    for (unsigned i = 0; i < 2; i++) support = add(support, abs(add(mul(a, v.u[i]), v.q[i])));
    return HP_NAMED(rim_depth)(v.t, h, r, a, support);
}

/* The start and the way of edge j of the four along axis k. */
typedef struct HP_NAMED(box_edge) {
    vec3 start, way;
} HP_NAMED(box_edge);

HP_INLINE HP_NAMED(box_edge) HP_NAMED(edge_of_box)(HP_NAMED(box_there) box, unsigned k, unsigned j) {
    unsigned i = (k + 1) % 3, l = (k + 2) % 3;
    vec3 half = scale3(box.e[k], box.b[k]), one = scale3(box.e[i], box.b[i]), other = scale3(box.e[l], box.b[l]);
    vec3 middle = j & 1 ? add3(box.c, one) : sub3(box.c, one);
    middle = j & 2 ? add3(middle, other) : sub3(middle, other);
    return (HP_NAMED(box_edge)){sub3(middle, half), add3(half, half)};
}

/* How far p is outside of the box; negative inside. */
HP_INLINE num HP_NAMED(outside_box)(HP_NAMED(box_there) box, vec3 p) {
    vec3 to = sub3(p, box.c);
    num far = constant(-INFINITY);
    for (unsigned i = 0; i < 3; i++) far = max(sub(abs(dot(to, box.b[i])), box.e[i]), far);
    return far;
}

/* The middle of what the box leaves of the cylinder's axis. */
HP_INLINE HP_NAMED(common) HP_NAMED(axis_in_box)(HP_NAMED(box_there) box, num h) {
    num low = neg(h), high = h, zero = constant(0);
    for (unsigned i = 0; i < 3; i++) {
        num at = dot(box.c, box.b[i]), one = div(sub(at, box.e[i]), box.b[i].z),
            other = div(add(at, box.e[i]), box.b[i].z);
        flag slants = less(zero, abs(box.b[i].z));
        low = max(select(slants, min(one, other), low), low);
        high = min(select(slants, max(one, other), high), high);
    }
    num z = mul(constant(0.5f), add(min(low, h), max(high, neg(h))));
    vec3 p = {zero, zero, z};
    return (HP_NAMED(common)){p, HP_NAMED(outside_box)(box, p)};
}

/* The point of a chord through the cylinder's middle, the one that a face's normal crosses all of, that comes nearest
 * to the box's middle plane. */
HP_INLINE HP_NAMED(common) HP_NAMED(chord_in_box)(HP_NAMED(box_there) box, unsigned k, num h, num r) {
    vec3 end = HP_NAMED(furthest_of_cylinder)(box.b[k], h, r);
    num part = div(dot(box.c, box.b[k]), dot(end, box.b[k]));
    vec3 p = scale3(clamp(part, constant(-1), constant(1)), end);
    return (HP_NAMED(common)){p, HP_NAMED(outside_box)(box, p)};
}

/* A point of both: where an edge comes in, or the cylinder's axis or a chord does. */
HP_INLINE vec3 HP_NAMED(obb_cylinder_common)(HP_NAMED(box_there) box, const HP_NAMED(side_view) v[3], num h, num r) {
    HP_NAMED(common) best = HP_NAMED(axis_in_box)(box, h);
    for (unsigned k = 0; k < 3; k++) {
        best = HP_NAMED(less_outside)(HP_NAMED(chord_in_box)(box, k, h, r), best);
        for (unsigned j = 0; j < 4; j++) {
            HP_NAMED(box_edge) edge = HP_NAMED(edge_of_box)(box, k, j);
            num u = HP_NAMED(along_u)(v[k].t, edge.start);
            best = HP_NAMED(less_outside)(HP_NAMED(edge_in_cylinder)(edge.start, edge.way, u, h, r), best);
        }
    }
    return best.p;
}

/* The distance of a miss. The nearest point of the box is on an edge, or within a face; then the cylinder's is the
 * one furthest against the face. */
HP_INLINE num HP_NAMED(obb_cylinder_distance)(HP_NAMED(box_there) box, num h, num r) {
    num least = HP_NAMED(point_to_cylinder)(box.c, h, r);
    REPEAT(k, 3) {
        REPEAT(j, 4) {
            HP_NAMED(box_edge) edge = HP_NAMED(edge_of_box)(box, k, j);
            least = min(HP_NAMED(edge_to_cylinder)(edge.start, edge.way, h, r), least);
        }
        vec3 end = HP_NAMED(furthest_of_cylinder)(box.b[k], h, r);
        REPEAT(j, 2) {
            vec3 to = sub3(j ? end : neg3(end), box.c);
            num squared = constant(0);
            for (unsigned i = 0; i < 3; i++) {
                num beyond = max(sub(abs(dot(to, box.b[i])), box.e[i]), constant(0));
                squared = add(squared, mul(beyond, beyond));
            }
            least = min(sqrt(squared), least);
        }
    }
    return least;
}

HP_INLINE answer HP_NAMED(obb_cylinder_test)(const num primary[15], const num prepared[15], bits index,
                                             bool separation, num bar) {
    HP_NAMED(cylinder) c = HP_NAMED(get_cylinder)(prepared);
    num h = c.h, r = c.r, zero = constant(0), one = constant(1);
    HP_NAMED(box_there) box = HP_NAMED(obb_cylinder_box)(c, primary);

    num depth = sub(h, abs(box.c.z));
    for (unsigned i = 0; i < 3; i++) depth = add(depth, mul(box.e[i], abs(box.b[i].z)));
    REPEAT(k, 3) depth = min(HP_NAMED(obb_cylinder_face)(box.c, box.b[k], box.e[k], h, r), depth);
    UNLESS_ANY(and(box.sound, could_count(depth, bar))) if (!separation) return miss();

    depth = min(HP_NAMED(obb_cylinder_vertex)(box, r), depth);
    HP_NAMED(side_view) v[3];
    REPEAT(k, 3) {
        v[k] = HP_NAMED(obb_cylinder_view)(box, k, r);
        depth = min(sub(add(r, v[k].wide_u), abs(v[k].c_u)), depth);
    }
    UNLESS_ANY(and(box.sound, could_count(depth, bar))) if (!separation) return miss();

    REPEAT(k, 3) {
        depth = min(HP_NAMED(obb_cylinder_edge)(v[k], one, h, r), depth);
        depth = min(HP_NAMED(obb_cylinder_edge)(v[k], neg(one), h, r), depth);
    }
    flag F = and(box.sound, at_least(depth, zero));
    UNLESS_ANY(F) if (!separation) return miss();
    vec3 CP = HP_NAMED(move_out)(c, HP_NAMED(obb_cylinder_common)(box, v, h, r));
    if (!separation) return answer_of(F, index, abs(depth), CP);
    num distance = HP_NAMED(obb_cylinder_distance)(box, h, r);
    return answer_with(F, index, abs(depth), select(box.sound, distance, constant(INFINITY)), CP);
}
