/* The point of a triangle that is nearest to the origin of its coordinates. Zero area is no special case: the edges
 * answer for a segment or a point.
 *
 * After C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5, but the seven regions are four candidates,
 * all of them computed, the nearest wins: three edges, and the foot of the perpendicular if it is within. Each
 * candidate is a point of the triangle up to rounding, however thin that is; so none can come out nearer than there
 * is any. And the foot is found along an edge first and then at right angles to it, by m: in a sliver the direction
 * of m is uncertain, but its length is no more than the sliver's width, and the way along the edge, the long one, is
 * not affected. */

typedef struct HP_NAMED(nearest) {
    vec3 point;
    num squared; /* of its distance */
} HP_NAMED(nearest);

HP_INLINE HP_NAMED(nearest) HP_NAMED(nearest_at)(vec3 point) {
    return (HP_NAMED(nearest)){point, dot(point, point)};
}

HP_INLINE HP_NAMED(nearest) HP_NAMED(nearer)(HP_NAMED(nearest) a, HP_NAMED(nearest) b) {
    flag first = less(a.squared, b.squared);
    return (HP_NAMED(nearest)){select3(first, a.point, b.point), select(first, a.squared, b.squared)};
}

/* The point a + t way of an edge, with t put between 0 and 1. An edge of no length has t = 0/0, which clamp makes 1.
 */
HP_INLINE HP_NAMED(nearest) HP_NAMED(nearest_on)(vec3 a, vec3 way, num t) {
    return HP_NAMED(nearest_at)(add3(a, scale3(clamp(t, constant(0), constant(1)), way)));
}

/* Where the line a + t way passes the origin. */
HP_INLINE num HP_NAMED(passing)(vec3 a, vec3 way) {
    return div(neg(dot(a, way)), dot(way, way));
}

/* a, b: vertices; ab, ac, bc: edges. *finite: no word was a NaN or an infinity. An edge that starts from one or ends
 * in one has it in its square; the nearest of them need not. */
HP_INLINE HP_NAMED(nearest) HP_NAMED(nearest_of_triangle)(vec3 a, vec3 b, vec3 ab, vec3 ac, vec3 bc, flag *finite) {
    num zero = constant(0), one = constant(1), infinity = constant(INFINITY);
    num squared = dot(ab, ab), along = div(neg(dot(a, ab)), squared), shift = div(dot(ac, ab), squared);
    HP_NAMED(nearest) on_ab = HP_NAMED(nearest_on)(a, ab, along);
    HP_NAMED(nearest) on_ac = HP_NAMED(nearest_on)(a, ac, HP_NAMED(passing)(a, ac));
    HP_NAMED(nearest) on_bc = HP_NAMED(nearest_on)(b, bc, HP_NAMED(passing)(b, bc));
    *finite = less(add(add(on_ab.squared, on_ac.squared), on_bc.squared), infinity);

    vec3 foot = add3(a, scale3(along, ab)), m = sub3(ac, scale3(shift, ab));
    num across = HP_NAMED(passing)(foot, m), rest = sub(along, mul(across, shift));
    flag within = and(and(at_least(across, zero), at_least(rest, zero)), at_most(add(across, rest), one));
    HP_NAMED(nearest) inner = HP_NAMED(nearest_at)(add3(foot, scale3(across, m)));
    inner.squared = select(within, inner.squared, infinity);
    return HP_NAMED(nearer)(inner, HP_NAMED(nearer)(on_ab, HP_NAMED(nearer)(on_ac, on_bc)));
}
