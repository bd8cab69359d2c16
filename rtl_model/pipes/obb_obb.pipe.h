/* Obb against obb, a box A (primary) and a box B (secondary).
 *
 * Hits: the fifteen separating axes of S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", 1996, section 5. They are all
 * the facet normals that the Minkowski difference of two boxes can have, so the least overlap among them is the
 * depth.
 *
 * The rotation from B's axes to A's, R = A^T B, has entries right to an ulp of 1. Where edges i and j are parallel
 * but for an angle, the cross product of the two is as short as the angle, its components are small entries of R, and
 * those of its row must agree with those of its column to an ulp of themselves, else the overlap along it is wrong by
 * ulp/angle. So R takes one step of Newton's iteration towards the orthogonal matrix next to it, R + R^-T (N. J.
 * Higham, "Computing the Polar Decomposition", 1986, equation 3.1): for a rotation R^-T is the matrix of cofactors. A
 * cofactor of such a row is a sum of products with small entries, so the step mends small entries to ulps of
 * themselves. Half of it all is left out: r below is twice a rotation. What the step leaves is the square of the
 * error: edges at an angle below 2^-24 count as parallel. The facet they span is no wider than that angle.
 *
 * Swapping A and B swaps the subscripts of r and takes (c, t, u) to (-c, -u, -t). What is written here is the same
 * sums of the same products then, so F and T are the same bits. */

/* The pair in both frames. */
typedef struct HP_NAMED(two_boxes) {
    num a[3], b[3], half_a[3], half_b[3];
    num r[3][3], m[3][3]; /* twice the rotation, and its absolute values */
    num t[3], u[3];       /* from centre to centre in A's axes and in B's */
} HP_NAMED(two_boxes);

/* The axes behind axis i in cyclic order. */
#define HP_NEXT(i) (((i) + 1) % 3)
#define HP_LAST(i) (((i) + 2) % 3)

/* Axes of a box, the third turned round if they are left-handed: the box is the same. */
HP_INLINE void HP_NAMED(obb_obb_axes)(const num box[15], vec3 axis[3]) {
    vec3 u = vec3_of(box, 6), v = vec3_of(box, 9), w = vec3_of(box, 12);
    num hand = select(less(dot(cross(u, v), w), constant(0)), constant(-1), constant(1));
    axis[0] = u;
    axis[1] = v;
    axis[2] = scale3(hand, w);
}

/* Half of each half extent; NaN, which hits nothing, where one is negative. */
HP_INLINE void HP_NAMED(obb_obb_halves)(const num extent[3], num half[3]) {
    num zero = constant(0);
    flag solid = and(and(at_least(extent[0], zero), at_least(extent[1], zero)), at_least(extent[2], zero));
    HP_EACH (i, 0, 3) half[i] = mul(constant(0.5f), extent[i]);
    half[0] = select(solid, half[0], constant(NAN));
}

/* Centre, axes, half extents, halves of them. */
HP_INLINE void HP_NAMED(obb_obb_prepare)(const num secondary[15], num prepared[18]) {
    vec3 axis[3];
    HP_NAMED(obb_obb_axes)(secondary, axis);
    HP_EACH (i, 0, 3) prepared[i] = secondary[i];
    HP_EACH (i, 0, 3) put_vec3(prepared, 3 + 3 * i, axis[i]);
    HP_EACH (i, 0, 3) prepared[12 + i] = secondary[3 + i];
    HP_NAMED(obb_obb_halves)(secondary + 3, prepared + 15);
}

HP_INLINE num HP_NAMED(cofactor)(num r[3][3], unsigned i, unsigned j) {
    unsigned k = HP_NEXT(i), l = HP_LAST(i), m = HP_NEXT(j), n = HP_LAST(j);
    return sub(mul(r[k][m], r[l][n]), mul(r[k][n], r[l][m]));
}

HP_INLINE void HP_NAMED(obb_obb_rotation)(const vec3 a[3], const vec3 b[3], HP_NAMED(two_boxes) * p) {
    num r[3][3];
    HP_EACH (i, 0, 3)
        HP_EACH (j, 0, 3) r[i][j] = dot(a[i], b[j]);
    HP_EACH (i, 0, 3)
        HP_EACH (j, 0, 3) {
            p->r[i][j] = add(r[i][j], HP_NAMED(cofactor)(r, i, j));
            p->m[i][j] = abs(p->r[i][j]);
        }
}

/* How far the boxes overlap along A's axis i, and along B's axis j. */
HP_INLINE num HP_NAMED(overlap_a)(const HP_NAMED(two_boxes) * p, unsigned i) {
    vec3 m = {p->m[i][0], p->m[i][1], p->m[i][2]};
    return sub(add(p->a[i], dot(m, vec3_of(p->half_b, 0))), abs(p->t[i]));
}

HP_INLINE num HP_NAMED(overlap_b)(const HP_NAMED(two_boxes) * p, unsigned j) {
    vec3 m = {p->m[0][j], p->m[1][j], p->m[2][j]};
    return sub(add(p->b[j], dot(m, vec3_of(p->half_a, 0))), abs(p->u[j]));
}

/* The distance of the centres along A's axis i x B's axis j, in A's axes or in B's. */
HP_INLINE num HP_NAMED(along_a)(const HP_NAMED(two_boxes) * p, unsigned i, unsigned j) {
    unsigned k = HP_NEXT(i), l = HP_LAST(i);
    return sub(mul(p->t[l], p->r[k][j]), mul(p->t[k], p->r[l][j]));
}

HP_INLINE num HP_NAMED(along_b)(const HP_NAMED(two_boxes) * p, unsigned i, unsigned j) {
    unsigned m = HP_NEXT(j), n = HP_LAST(j);
    return sub(mul(p->u[m], p->r[i][n]), mul(p->u[n], p->r[i][m]));
}

/* The overlap along that axis, whose length is left in. Swapping the boxes turns (i, j) into (j, i). */
HP_INLINE num HP_NAMED(overlap_ab)(const HP_NAMED(two_boxes) * p, unsigned i, unsigned j) {
    unsigned k = HP_NEXT(i), l = HP_LAST(i), m = HP_NEXT(j), n = HP_LAST(j);
    num of_a = add(mul(p->a[k], p->m[l][j]), mul(p->a[l], p->m[k][j]));
    num of_b = add(mul(p->b[m], p->m[i][n]), mul(p->b[n], p->m[i][m]));
    num along = i < j   ? HP_NAMED(along_a)(p, i, j)
                : i > j ? HP_NAMED(along_b)(p, i, j)
                        : mul(constant(0.5f), add(HP_NAMED(along_a)(p, i, j), HP_NAMED(along_b)(p, i, j)));
    return sub(add(of_a, of_b), abs(along));
}

/* The square of the length. */
HP_INLINE num HP_NAMED(square_ab)(num squares[3][3], unsigned i, unsigned j) {
    unsigned k = HP_NEXT(i), l = HP_LAST(i), m = HP_NEXT(j), n = HP_LAST(j);
    num column = add(squares[k][j], squares[l][j]), row = add(squares[i][m], squares[i][n]);
    return i < j ? column : i > j ? row : mul(constant(0.5f), add(column, row));
}

/* ---- a point of both boxes ----
 *
 * Fourier and Motzkin's elimination, in B's axes from B's centre: x2 may be whatever leaves room for x1 and x0, then
 * x1 whatever leaves room for x0. The inequalities are |x| <= b and A's, |r x + 2 t| <= 2 a row by row. Those that
 * eliminating x0 and x1 leads to are the separating axes again, which also says which of them are idle. Of each
 * interval the middle is taken.
 *
 * Both boxes are taken a little larger, by 2^-22 of their extents, so that what rounding does cannot close an
 * interval of boxes that touch. A coefficient that is almost zero is taken as 2^-60. The inequality of parallel edges
 * is 0 x <= 0, of edges almost parallel no more exact than their cross product: 2^-45 is added to its right side. */

typedef struct HP_NAMED(interval) {
    num low, high;
} HP_NAMED(interval);

/* |x - middle| <= half */
HP_INLINE void HP_NAMED(meet)(HP_NAMED(interval) * x, num middle, num half) {
    x->low = max(x->low, sub(middle, half));
    x->high = min(x->high, add(middle, half));
}

/* |offset + x / inverse| <= room */
HP_INLINE void HP_NAMED(narrow)(HP_NAMED(interval) * x, num inverse, num offset, num room) {
    HP_NAMED(meet)(x, mul(neg(offset), inverse), mul(room, abs(inverse)));
}

HP_INLINE num HP_NAMED(middle)(HP_NAMED(interval) x, num limit) {
    return clamp(mul(constant(0.5f), add(x.low, x.high)), neg(limit), limit);
}

/* 1 / r; almost parallel is not parallel. */
HP_INLINE void HP_NAMED(obb_obb_inverse)(num r[3][3], num m[3][3], num inverse[3][3]) {
    num least = constant(0x1p-60f);
    HP_EACH (i, 0, 3)
        HP_EACH (j, 0, 3) inverse[i][j] = div(constant(1), select(less(m[i][j], least), least, r[i][j]));
}

HP_INLINE vec3 HP_NAMED(obb_obb_common)(const HP_NAMED(two_boxes) * p, num inverse[3][3]) {
    num a[3], b[3], row[3], room[3], cross_room[3][2];
    num extents = add(add(add(p->a[0], p->a[1]), p->a[2]), add(add(p->b[0], p->b[1]), p->b[2]));
    num slack = mul(constant(0x1p-22f), extents), parallel = mul(constant(0x1p-45f), extents);
    HP_EACH (i, 0, 3) {
        a[i] = add(p->a[i], slack);
        b[i] = add(p->b[i], slack);
        row[i] = add(p->t[i], p->t[i]);
    }
    HP_EACH (i, 0, 3) {
        unsigned k = HP_NEXT(i), l = HP_LAST(i);
        room[i] = add(add(a[i], a[i]), mul(b[0], p->m[i][0]));
        HP_EACH (j, 0, 2) cross_room[i][j] = add(add(mul(a[k], p->m[l][j]), mul(a[l], p->m[k][j])), parallel);
    }

    HP_NAMED(interval) x2 = {neg(b[2]), b[2]}, x1 = {neg(b[1]), b[1]}, x0 = {neg(b[0]), b[0]};
    num shadow = add(add(mul(a[0], p->m[0][2]), mul(a[1], p->m[1][2])), mul(a[2], p->m[2][2]));
    HP_NAMED(meet)(&x2, neg(p->u[2]), mul(constant(0.5f), shadow));
    HP_EACH (i, 0, 3) {
        HP_NAMED(narrow)(&x2, inverse[i][2], row[i], add(room[i], mul(b[1], p->m[i][1])));
        HP_NAMED(narrow)
        (&x2, inverse[i][1], neg(HP_NAMED(along_b)(p, i, 0)), add(cross_room[i][0], mul(b[1], p->m[i][2])));
        HP_NAMED(narrow)
        (&x2, inverse[i][0], HP_NAMED(along_b)(p, i, 1), add(cross_room[i][1], mul(b[0], p->m[i][2])));
    }
    num z = HP_NAMED(middle)(x2, b[2]);
    HP_EACH (i, 0, 3) {
        row[i] = add(row[i], mul(p->r[i][2], z));
        HP_NAMED(narrow)(&x1, inverse[i][1], row[i], room[i]);
        HP_NAMED(narrow)
        (&x1, inverse[i][2], sub(HP_NAMED(along_b)(p, i, 0), mul(p->r[i][1], z)), cross_room[i][0]);
    }
    num y = HP_NAMED(middle)(x1, b[1]);
    HP_EACH (i, 0, 3) HP_NAMED(narrow)(&x0, inverse[i][0], add(row[i], mul(p->r[i][1], y)), add(a[i], a[i]));
    return (vec3){HP_NAMED(middle)(x0, b[0]), y, z};
}

/* From B's axes to the world. */
HP_INLINE vec3 HP_NAMED(obb_obb_place)(const num prepared[18], vec3 x) {
    vec3 u = vec3_of(prepared, 3), v = vec3_of(prepared, 6), w = vec3_of(prepared, 9);
    return add3(vec3_of(prepared, 0), add3(add3(scale3(x.x, u), scale3(x.y, v)), scale3(x.z, w)));
}

/* ---- the distance of two boxes ----
 *
 * One of the two nearest points lies on an edge of B, or the other is a corner of A. So it is the least distance of
 * the twelve edges of B from A and the eight corners of A from B. Which box is B is decided by the first number in
 * which the pair differs from the pair swapped.
 *
 * A point m + s r of an edge, s from -h to h, is past the faces of A by e(s) = m + s r - clamp(m + s r, -a, a). The
 * square of that is convex in s; its derivative is 0 where
 *
 *   s = sum_k r_k^2 clamp(s, low_k, high_k) / sum_k r_k^2,     [low_k, high_k]: within the slab k,
 *
 * the sum below being 4. When the slabs have no s in common, s lies between the least high, of slab q, and the
 * greatest low, of slab p. There p and q are outside, and slab o, the other one, may be. Without o the mean of low_p
 * and high_q, with weights r_p^2 and r_q^2, is s; if that is within o, it is s. If it is not, s lies on the same side
 * of o: so clamping the mean to all three slabs instead of s gives s. */

typedef struct HP_NAMED(edge_box) {
    num a[3], h[3], r[3][3], inverse[3][3], weight[3][3], t[3];
} HP_NAMED(edge_box);

HP_INLINE num HP_NAMED(square_past)(const num point[3], const num extent[3]) {
    vec3 e = {max(sub(abs(point[0]), extent[0]), constant(0)), max(sub(abs(point[1]), extent[1]), constant(0)),
              max(sub(abs(point[2]), extent[2]), constant(0))};
    return dot(e, e);
}

/* The edge along B's axis j through the point `from` in A's axes. */
HP_INLINE num HP_NAMED(edge_distance)(const HP_NAMED(edge_box) * p, unsigned j, const num from[3]) {
    num low[3], high[3], point[3];
    HP_EACH (k, 0, 3) {
        num middle = mul(neg(from[k]), p->inverse[k][j]), half = mul(p->a[k], abs(p->inverse[k][j]));
        low[k] = sub(middle, half);
        high[k] = add(middle, half);
    }
    num last = low[0], first = high[0], last_weight = p->weight[0][j], first_weight = last_weight;
    HP_EACH (k, 1, 3) {
        flag later = less(last, low[k]), sooner = less(high[k], first);
        last = select(later, low[k], last);
        last_weight = select(later, p->weight[k][j], last_weight);
        first = select(sooner, high[k], first);
        first_weight = select(sooner, p->weight[k][j], first_weight);
    }
    num mean = div(add(mul(last_weight, last), mul(first_weight, first)), add(last_weight, first_weight));
    HP_EACH (k, 0, 3) low[k] = mul(p->weight[k][j], clamp(mean, low[k], high[k]));
    num s = clamp(mul(constant(0.25f), add(add(low[0], low[1]), low[2])), neg(p->h[j]), p->h[j]);
    HP_EACH (k, 0, 3) point[k] = add(from[k], mul(s, p->r[k][j]));
    return HP_NAMED(square_past)(point, p->a);
}

/* Whether A is to be called B. */
HP_INLINE flag HP_NAMED(obb_obb_swaps)(const HP_NAMED(two_boxes) * p) {
    flag swaps = less(p->r[2][0], p->r[0][2]);
#define HP_BEFORE(x, y) swaps = or (less(x, y), and(at_most(x, y), swaps))
    HP_BEFORE(p->r[1][2], p->r[2][1]);
    HP_BEFORE(p->r[0][1], p->r[1][0]);
    HP_EACH (i, 0, 3) HP_BEFORE(p->t[i], neg(p->u[i]));
    HP_EACH (i, 0, 3) HP_BEFORE(p->a[i], p->b[i]);
#undef HP_BEFORE
    return swaps;
}

HP_INLINE num HP_NAMED(obb_obb_distance)(const HP_NAMED(two_boxes) * p, num inverse[3][3]) {
    flag swaps = HP_NAMED(obb_obb_swaps)(p);
    HP_NAMED(edge_box) e;
    num b[3], g[3], u[3];
    HP_EACH (i, 0, 3) {
        e.a[i] = select(swaps, p->b[i], p->a[i]);
        b[i] = select(swaps, p->a[i], p->b[i]);
        e.h[i] = select(swaps, p->half_a[i], p->half_b[i]);
        g[i] = select(swaps, p->half_b[i], p->half_a[i]);
        e.t[i] = select(swaps, neg(p->u[i]), p->t[i]);
        u[i] = select(swaps, neg(p->t[i]), p->u[i]);
        HP_EACH (j, 0, 3) {
            e.r[i][j] = i == j ? p->r[i][j] : select(swaps, p->r[j][i], p->r[i][j]);
            e.inverse[i][j] = i == j ? inverse[i][j] : select(swaps, inverse[j][i], inverse[i][j]);
            num guarded = max(abs(e.r[i][j]), constant(0x1p-60f));
            e.weight[i][j] = mul(guarded, guarded);
        }
    }
    num least = constant(INFINITY);
    REPEAT(side, 4) {
        num up = constant(side & 1 ? 1 : -1), aside = constant(side & 2 ? 1 : -1), corner[2][3];
        HP_EACH (j, 0, 3) {
            num from[3], m = mul(up, e.h[HP_NEXT(j)]), n = mul(aside, e.h[HP_LAST(j)]);
            HP_EACH (k, 0, 3) from[k] = add(e.t[k], add(mul(m, e.r[k][HP_NEXT(j)]), mul(n, e.r[k][HP_LAST(j)])));
            least = min(HP_NAMED(edge_distance)(&e, j, from), least);
        }
        num m = mul(up, g[1]), n = mul(aside, g[2]);
        HP_EACH (j, 0, 3) {
            num from = add(u[j], add(mul(m, e.r[1][j]), mul(n, e.r[2][j]))), step = mul(g[0], e.r[0][j]);
            corner[0][j] = sub(from, step);
            corner[1][j] = add(from, step);
        }
        least = min(HP_NAMED(square_past)(corner[0], b), least);
        least = min(HP_NAMED(square_past)(corner[1], b), least);
    }
    return sqrt(least);
}

/* ---- the test ---- */

HP_INLINE HP_NAMED(two_boxes) HP_NAMED(obb_obb_pair)(const num primary[15], const num prepared[18]) {
    HP_NAMED(two_boxes) p;
    vec3 a[3], b[3], c = sub3(vec3_of(prepared, 0), vec3_of(primary, 0));
    HP_NAMED(obb_obb_axes)(primary, a);
    HP_NAMED(obb_obb_halves)(primary + 3, p.half_a);
    HP_EACH (i, 0, 3) {
        b[i] = vec3_of(prepared, 3 + 3 * i);
        p.a[i] = primary[3 + i];
        p.b[i] = prepared[12 + i];
        p.half_b[i] = prepared[15 + i];
        p.t[i] = dot(a[i], c);
        p.u[i] = dot(b[i], c);
    }
    HP_NAMED(obb_obb_rotation)(a, b, &p);
    return p;
}

HP_INLINE answer HP_NAMED(obb_obb_test)(const num primary[15], const num prepared[18], bits index, bool separation,
                                        num bar) {
    HP_NAMED(two_boxes) p = HP_NAMED(obb_obb_pair)(primary, prepared);
    num zero = constant(0), infinity = constant(INFINITY), squares[3][3], overlap[3][3], length2[3][3];
    flag parallel[3][3];

    num first_a = HP_NAMED(overlap_a)(&p, 0), first_b = HP_NAMED(overlap_b)(&p, 0);
    flag whole = less(add(first_a, first_b), infinity);
    flag F = and(whole, and(at_least(first_a, zero), at_least(first_b, zero)));
    num faces = min(first_a, first_b);
    HP_EACH (i, 1, 3) {
        num of_a = HP_NAMED(overlap_a)(&p, i), of_b = HP_NAMED(overlap_b)(&p, i);
        F = and(F, and(at_least(of_a, zero), at_least(of_b, zero)));
        faces = min(faces, min(of_a, of_b));
    }
    UNLESS_ANY(and(F, less(bar, faces))) if (!separation) return miss();

    num edges = infinity;
    HP_EACH (i, 0, 3)
        HP_EACH (j, 0, 3) squares[i][j] = mul(p.r[i][j], p.r[i][j]);
    HP_EACH (i, 0, 3)
        HP_EACH (j, 0, 3) {
            overlap[i][j] = HP_NAMED(overlap_ab)(&p, i, j);
            length2[i][j] = HP_NAMED(square_ab)(squares, i, j);
            parallel[i][j] = less(length2[i][j], constant(0x1p-46f));
            F = and(F, or (parallel[i][j], at_least(overlap[i][j], zero)));
        }
    UNLESS_ANY(and(F, less(bar, faces))) if (!separation) return miss();

    HP_EACH (i, 0, 3)
        HP_EACH (j, 0, 3) {
            num overlap2 = div(mul(overlap[i][j], overlap[i][j]), length2[i][j]);
            edges = min(select(parallel[i][j], infinity, overlap2), edges);
        }
    num T = min(faces, sqrt(edges));

    num inverse[3][3];
    HP_NAMED(obb_obb_inverse)(p.r, p.m, inverse);
    vec3 CP = HP_NAMED(obb_obb_place)(prepared, HP_NAMED(obb_obb_common)(&p, inverse));
    if (!separation) return answer_of(F, index, T, CP);
    num distance = HP_NAMED(obb_obb_distance)(&p, inverse);
    return answer_with(F, index, T, select(whole, distance, infinity), CP);
}
#undef HP_NEXT
#undef HP_LAST
