/* Triangle against box, in the frame of the box and about its centre: the pipes triangle-aabb and triangle-obb are
 * this text once they have brought the triangle there. No include guard: it stands once per number system.
 *
 * Decision and depth. The Minkowski difference of triangle and box is a polytope whose facets have the normals
 *
 *   x, y, z      faces of the box
 *   n            the triangle
 *   e_i x axis   an edge of each, nine
 *
 * S. Gottschalk, M. Lin, D. Manocha, "OBBTree", 1996, section 5; T. Akenine-Moller, "Fast 3D Triangle-Box Overlap
 * Testing", 2001. The sets meet when on none of these lines their shadows part, and the depth is the least overlap of
 * shadows, to the nearer side, over the length of the direction. What is left of the list when some of it vanishes
 * (a segment, a point, a slab, an edge along an axis) still decides: class degenerate of docs/accuracy.md.
 *
 * Rounding. Everything is projected on the one rounded vector that stands for a direction. A shadow on any direction
 * bounds the depth from above, so a direction that is off can only fail to be the least; and an edge is off by no
 * more than if its triangle had moved by a rounding error. The normal of a sliver is off by more: e x e' loses what
 * the sliver's height is below its length, in the turn about the long edge, where the height is the lever, and in the
 * turn of the long edge itself, where its length is. triangle_box_normal takes the second back.
 *
 * Nearest points. Of two sets that are apart, the nearest points lie on an edge of the triangle and the solid box, or
 * in the inside of the triangle and on the corner of the box that is farthest towards it. Of two that meet, either an
 * edge of the triangle enters the box or every point of the box that lies in the plane lies in the triangle. Both are
 * one search: three edges against the solid box, and the point of one diagonal that is nearest to the plane. It gives
 * the contact position of a hit and the distance of a miss. */

/* The triangle and the half extents, in the frame of the box. */
typedef struct HP_NAMED(triangle_box) {
    vec3 corner[3], edge[3]; /* edge i from corner i to corner i + 1 */
    vec3 normal;             /* of any length */
    num per_normal;          /* 1 / |normal|; no number where the triangle has no area */
    vec3 half;               /* NaN: not a box */
    flag finite;             /* the triangle's words are */
} HP_NAMED(triangle_box);

/* Overlaps of the shadows, not yet over the length of the direction. */
typedef struct HP_NAMED(triangle_box_overlaps) {
    num face[3], normal, edges[3][3]; /* edge of the triangle, axis of the box */
} HP_NAMED(triangle_box_overlaps);

/* ---- what depends on one of the two alone ---- */

/* Half extents of a box whose flag says whether it is one; a NaN in their place parts it from everything. */
HP_INLINE vec3 HP_NAMED(triangle_box_half)(flag is_box, vec3 half) {
    num none = constant(NAN);
    return (vec3){select(is_box, half.x, none), select(is_box, half.y, none), select(is_box, half.z, none)};
}

/* Whether three half extents are numbers from 0 on. */
HP_INLINE flag HP_NAMED(triangle_box_is_size)(vec3 half) {
    num zero = constant(0);
    flag from_zero = and(and(at_least(half.x, zero), at_least(half.y, zero)), at_least(half.z, zero));
    return and(from_zero, less(add(add(half.x, half.y), half.z), constant(INFINITY)));
}

HP_INLINE flag HP_NAMED(triangle_box_is_finite)(vec3 a) {
    vec3 none = sub3(a, a);
    return at_least(add(add(none.x, none.y), none.z), constant(0));
}

HP_INLINE void HP_NAMED(triangle_box_edges)(const vec3 corner[3], vec3 edge[3]) {
    for (unsigned i = 0; i < 3; i++) edge[i] = sub3(corner[(i + 1) % 3], corner[i]);
}

/* The triangle's normal, square to its longest edge but for the rounding of one step; and 1 over its length, which is
 * no number for less than 2^-35 of that edge's square: far below rounding, and close to underflow. */
HP_INLINE vec3 HP_NAMED(triangle_box_normal)(const vec3 edge[3], num *per_normal, flag *finite) {
    num zero = constant(0);
    vec3 n = cross(edge[0], edge[1]), longest = edge[0];
    num squared = dot(edge[0], edge[0]);
    for (unsigned i = 1; i < 3; i++) {
        num other = dot(edge[i], edge[i]);
        longest = select3(less(squared, other), edge[i], longest);
        squared = max(squared, other);
    }
    num lean = select(less(zero, squared), div(dot(n, longest), squared), zero);
    n = sub3(n, scale3(lean, longest));
    num nn = dot(n, n);
    *finite = less(nn, constant(INFINITY));
    num least = mul(constant(0x1p-35f), squared);
    *per_normal = div(constant(1), sqrt(sub(nn, mul(least, least))));
    return n;
}

/* ---- decision and depth ---- */

/* How far two shadows overlap to the nearer side: the box's from -radius to radius, the triangle's from low to high.
 */
HP_INLINE num HP_NAMED(triangle_box_overlap)(num radius, num low, num high) {
    return add(radius, min(high, neg(low)));
}

HP_INLINE num HP_NAMED(triangle_box_overlap3)(num radius, num a, num b, num c) {
    return HP_NAMED(triangle_box_overlap)(radius, min(min(a, b), c), max(max(a, b), c));
}

/* On the direction (0, e.z, -e.y), an edge crossed with the first axis; y and z are the axes that follow it. Both
 * ends of the edge cast one shadow: a is one of them, c the third corner. */
HP_INLINE num HP_NAMED(triangle_box_across)(num ey, num ez, num ay, num az, num cy, num cz, num hy, num hz) {
    num a = sub(mul(ez, ay), mul(ey, az)), c = sub(mul(ez, cy), mul(ey, cz));
    num radius = add(mul(hy, abs(ez)), mul(hz, abs(ey)));
    return HP_NAMED(triangle_box_overlap)(radius, min(a, c), max(a, c));
}

HP_INLINE HP_NAMED(triangle_box_overlaps) HP_NAMED(triangle_box_shadows)(const HP_NAMED(triangle_box) * both) {
    const vec3 *p = both->corner;
    vec3 h = both->half, n = both->normal;
    num radius = add(add(mul(h.x, abs(n.x)), mul(h.y, abs(n.y))), mul(h.z, abs(n.z)));
    HP_NAMED(triangle_box_overlaps)
    o = {.face = {HP_NAMED(triangle_box_overlap3)(h.x, p[0].x, p[1].x, p[2].x),
                  HP_NAMED(triangle_box_overlap3)(h.y, p[0].y, p[1].y, p[2].y),
                  HP_NAMED(triangle_box_overlap3)(h.z, p[0].z, p[1].z, p[2].z)},
         .normal = HP_NAMED(triangle_box_overlap3)(radius, dot(n, p[0]), dot(n, p[1]), dot(n, p[2]))};
    for (unsigned i = 0; i < 3; i++) {
        vec3 e = both->edge[i], a = p[i], c = p[(i + 2) % 3];
        o.edges[i][0] = HP_NAMED(triangle_box_across)(e.y, e.z, a.y, a.z, c.y, c.z, h.y, h.z);
        o.edges[i][1] = HP_NAMED(triangle_box_across)(e.z, e.x, a.z, a.x, c.z, c.x, h.z, h.x);
        o.edges[i][2] = HP_NAMED(triangle_box_across)(e.x, e.y, a.x, a.y, c.x, c.y, h.x, h.y);
    }
    return o;
}

/* No shadows part. A direction of length zero has overlap 0; a NaN parts. */
HP_INLINE flag HP_NAMED(triangle_box_meets)(const HP_NAMED(triangle_box) * both,
                                            const HP_NAMED(triangle_box_overlaps) * o) {
    num zero = constant(0);
    flag F = and(both->finite, at_least(o->normal, zero));
    for (unsigned i = 0; i < 3; i++) F = and(F, at_least(o->face[i], zero));
    for (unsigned i = 0; i < 3; i++)
        for (unsigned axis = 0; axis < 3; axis++) F = and(F, at_least(o->edges[i][axis], zero));
    return F;
}

/* The depth is no greater. */
HP_INLINE num HP_NAMED(triangle_box_bound)(const HP_NAMED(triangle_box_overlaps) * o) {
    return min(min(o->face[0], o->face[1]), o->face[2]);
}

/* The least overlap over the length of its direction. An edge within 2^-35 of an axis has no direction with it: its
 * length is no number, nor is 0/0, and min(NaN, T) is T. */
HP_INLINE num HP_NAMED(triangle_box_depth)(const HP_NAMED(triangle_box) * both,
                                           const HP_NAMED(triangle_box_overlaps) * o) {
    num T = HP_NAMED(triangle_box_bound)(o);
    T = min(mul(o->normal, both->per_normal), T);
    for (unsigned i = 0; i < 3; i++) {
        vec3 e = both->edge[i];
        num xx = mul(e.x, e.x), yy = mul(e.y, e.y), zz = mul(e.z, e.z);
        num least = mul(constant(0x1p-70f), add(add(xx, yy), zz));
        T = min(div(o->edges[i][0], sqrt(sub(add(yy, zz), least))), T);
        T = min(div(o->edges[i][1], sqrt(sub(add(zz, xx), least))), T);
        T = min(div(o->edges[i][2], sqrt(sub(add(xx, yy), least))), T);
    }
    return T;
}

/* ---- nearest points ---- */

typedef struct HP_NAMED(triangle_box_near) {
    vec3 point;       /* of the box */
    num squared;      /* of its distance from the triangle's edges */
    num plane;        /* distance of the diagonal from the triangle's plane ... */
    flag over_inside; /* ... which counts where this holds */
} HP_NAMED(triangle_box_near);

HP_INLINE num HP_NAMED(triangle_box_inside)(num x, num h) {
    return clamp(x, neg(h), h);
}

HP_INLINE vec3 HP_NAMED(triangle_box_inside3)(vec3 a, vec3 h) {
    return (vec3){HP_NAMED(triangle_box_inside)(a.x, h.x), HP_NAMED(triangle_box_inside)(a.y, h.y),
                  HP_NAMED(triangle_box_inside)(a.z, h.z)};
}

/* What one coordinate adds to half the derivative of the squared distance from the box, t along the edge. */
HP_INLINE num HP_NAMED(triangle_box_pull)(num from, num along, num h, num t) {
    num x = add(from, mul(t, along));
    return mul(along, sub(x, HP_NAMED(triangle_box_inside)(x, h)));
}

/* A part of an edge in which the squared distance from the box is least; half its derivative at both ends. */
typedef struct HP_NAMED(triangle_box_part) {
    num from, to, pull_from, pull_to;
} HP_NAMED(triangle_box_part);

/* Cuts the part at t, where the derivative is `pull`, unless t is not in it. */
HP_INLINE void HP_NAMED(triangle_box_cut)(HP_NAMED(triangle_box_part) * part, num t, num pull) {
    flag within = and(less(part->from, t), less(t, part->to));
    flag falls = less(pull, constant(0));
    flag after = and(within, falls), before = and(within, not(falls));
    part->from = select(after, t, part->from);
    part->pull_from = select(after, pull, part->pull_from);
    part->to = select(before, t, part->to);
    part->pull_to = select(before, pull, part->pull_to);
}

/* Cuts at the two faces across the first axis. There this axis pulls nothing, exactly: only the other two, y and z,
 * are asked. An edge along the face never crosses it; t is then infinite or no number, and cuts nothing. */
HP_INLINE void HP_NAMED(triangle_box_cut_faces)(HP_NAMED(triangle_box_part) * part, num x, num y, num z, num ex,
                                                num ey, num ez, num hx, num hy, num hz) {
    num per_x = div(constant(1), ex);
    for (unsigned side = 0; side < 2; side++) {
        num t = mul(sub(side ? hx : neg(hx), x), per_x);
        num pull = add(HP_NAMED(triangle_box_pull)(y, ey, hy, t), HP_NAMED(triangle_box_pull)(z, ez, hz, t));
        HP_NAMED(triangle_box_cut)(part, t, pull);
    }
}

/* Where on the edge a + t e, t from 0 to 1, the distance from the box is least. The squared distance is convex and
 * made of parabolas that meet where the edge crosses the planes of the six faces; its derivative is a rising chain of
 * straight pieces. Cutting at the six crossings leaves one piece, with its zero between the ends, or at one end when
 * the derivative has one sign. 0/0, where the derivative is zero all along, is any t: clamp makes it 1. */
HP_INLINE num HP_NAMED(triangle_box_nearest_on)(vec3 a, vec3 e, vec3 h, num pull_from, num pull_to) {
    HP_NAMED(triangle_box_part) part = {constant(0), constant(1), pull_from, pull_to};
    HP_NAMED(triangle_box_cut_faces)(&part, a.x, a.y, a.z, e.x, e.y, e.z, h.x, h.y, h.z);
    HP_NAMED(triangle_box_cut_faces)(&part, a.y, a.z, a.x, e.y, e.z, e.x, h.y, h.z, h.x);
    HP_NAMED(triangle_box_cut_faces)(&part, a.z, a.x, a.y, e.z, e.x, e.y, h.z, h.x, h.y);
    num share = div(part.pull_from, sub(part.pull_from, part.pull_to));
    share = clamp(share, constant(0), constant(1));
    return add(part.from, mul(share, sub(part.to, part.from)));
}

/* The three edges: nearest point of the box and its squared distance. */
HP_INLINE void HP_NAMED(triangle_box_near_edges)(const HP_NAMED(triangle_box) * both,
                                                 HP_NAMED(triangle_box_near) * near) {
    vec3 h = both->half, outside[3];
    for (unsigned i = 0; i < 3; i++)
        outside[i] = sub3(both->corner[i], HP_NAMED(triangle_box_inside3)(both->corner[i], h));
    for (unsigned i = 0; i < 3; i++) {
        vec3 a = both->corner[i], e = both->edge[i];
        num t = HP_NAMED(triangle_box_nearest_on)(a, e, h, dot(e, outside[i]), dot(e, outside[(i + 1) % 3]));
        vec3 on_edge = add3(a, scale3(t, e)), point = HP_NAMED(triangle_box_inside3)(on_edge, h);
        vec3 apart = sub3(on_edge, point);
        num squared = dot(apart, apart);
        flag nearer = i ? less(squared, near->squared) : less(squared, constant(INFINITY));
        near->point = i ? select3(nearer, point, near->point) : point;
        near->squared = i ? select(nearer, squared, near->squared) : squared;
    }
}

/* The diagonal of the box that goes farthest along the normal, and its point nearest to the plane: where it passes
 * through the plane, or the corner before it. Over the inside of the triangle it is nearer than any edge; it is
 * there when it lies on one side of all three. Which side depends on the hand of the box's frame. */
HP_INLINE void HP_NAMED(triangle_box_near_inside)(const HP_NAMED(triangle_box) * both, num normal_overlap,
                                                  HP_NAMED(triangle_box_near) * near) {
    num zero = constant(0), one = constant(1);
    vec3 n = both->normal, h = both->half;
    vec3 diagonal = {select(less(n.x, zero), neg(h.x), h.x), select(less(n.y, zero), neg(h.y), h.y),
                     select(less(n.z, zero), neg(h.z), h.z)};
    num t = div(dot(n, both->corner[0]), dot(n, diagonal));
    vec3 q = scale3(clamp(t, neg(one), one), diagonal);
    num left[3];
    for (unsigned i = 0; i < 3; i++) left[i] = dot(cross(both->edge[i], sub3(q, both->corner[i])), n);
    flag all_left = less(zero, min(min(left[0], left[1]), left[2]));
    flag all_right = less(max(max(left[0], left[1]), left[2]), zero);
    flag inside = and(or (all_left, all_right), less(zero, near->squared));
    near->over_inside = inside;
    near->plane = max(neg(mul(normal_overlap, both->per_normal)), zero);
    near->point = select3(inside, q, near->point);
}

HP_INLINE HP_NAMED(triangle_box_near)
    HP_NAMED(triangle_box_nearest)(const HP_NAMED(triangle_box) * both, const HP_NAMED(triangle_box_overlaps) * o) {
    HP_NAMED(triangle_box_near) near;
    HP_NAMED(triangle_box_near_edges)(both, &near);
    HP_NAMED(triangle_box_near_inside)(both, o->normal, &near);
    return near;
}

/* The distance of two sets that do not meet; infinite when one of them is not a triangle or not a box. */
HP_INLINE num HP_NAMED(triangle_box_distance)(const HP_NAMED(triangle_box) * both,
                                              const HP_NAMED(triangle_box_near) * near) {
    num infinity = constant(INFINITY);
    num distance = sqrt(near->squared);
    distance = select(and(near->over_inside, less(near->plane, distance)), near->plane, distance);
    flag sound = and(both->finite, at_least(both->half.x, constant(0)));
    return select(and(sound, less(distance, infinity)), distance, infinity);
}
