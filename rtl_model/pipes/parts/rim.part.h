/* An edge of a polyhedron against the rims of a cylinder, in the cylinder's frame (cylinder.part.h).
 *
 * The normals of the surface that edge and rim sweep in the Minkowski difference are perpendicular to the edge. They
 * are a u + q for the upper rim and a u - q for the lower one, with u horizontal and q upwards, both perpendicular to
 * the edge: the rim seen along the edge is an ellipse with semi-axes r along u and k r along q, and the number a that
 * touches the boundary is k rho of ellipse_normal. */

typedef struct HP_NAMED(turning) {
    vec3 e, u, q; /* right-handed up to sign, of length 1, e the edge's direction; NaN where the edge has none */
    num k, g;     /* |e.z| and q.z: u.z = 0, q.x^2 + q.y^2 = k^2, k^2 + g^2 = 1 */
} HP_NAMED(turning);

HP_INLINE HP_NAMED(turning) HP_NAMED(turning_about)(vec3 edge) {
    vec3 e = scale3(div(constant(1), length(edge)), edge);
    num g = sqrt(add(mul(e.x, e.x), mul(e.y, e.y))), to_u = div(constant(1), g);
    vec3 u = {mul(e.y, to_u), neg(mul(e.x, to_u)), constant(0)};
    vec3 q = {mul(e.z, u.y), neg(mul(e.z, u.x)), g};
    return (HP_NAMED(turning)){e, u, q, abs(e.z), g};
}

HP_INLINE num HP_NAMED(along_u)(HP_NAMED(turning) t, vec3 p) {
    return add(mul(p.x, t.u.x), mul(p.y, t.u.y));
}

/* The direction a u + q, or a u - q, in which an edge through a point with coordinates u and +-q touches the upper,
 * or the lower, rim from inside or just outside. */
HP_INLINE num HP_NAMED(rim_turn)(HP_NAMED(turning) t, num h, num r, num u, num q) {
    num Y = mul(t.k, neg(add(q, mul(h, t.g)))), R = mul(r, mul(t.g, t.g));
    num a = mul(t.k, HP_NAMED(ellipse_normal)(abs(u), Y, R));
    return select(less(u, constant(0)), a, neg(a));
}

/* How deep the origin is under the plane with normal a u +- q that supports the Minkowski difference; `support` is
 * the polyhedron's, of that very vector. */
HP_INLINE num HP_NAMED(rim_depth)(HP_NAMED(turning) t, num h, num r, num a, num support) {
    num a2 = mul(a, a);
    num round = mul(r, sqrt(add(a2, mul(t.k, t.k))));
    return div(add(add(support, mul(h, t.g)), round), sqrt(add(a2, constant(1))));
}

/* A point of the edge p + t e, t from 0 to 1, as deep in the cylinder as the middle of what the cylinder's side and
 * caps leave of it, and how far it is outside (negative: inside). Where they leave nothing, for the edge passes by
 * or roundings say so, it is near to where it passes. A number that is none, for an edge parallel to the axis, bounds
 * nothing: it stands second in max and first in min. u: distance of the edge's line from the axis. */
typedef struct HP_NAMED(common) {
    vec3 p;
    num outside;
} HP_NAMED(common);

HP_INLINE num HP_NAMED(outside_cylinder)(vec3 p, num h, num r) {
    return max(sub(sqrt(add(mul(p.x, p.x), mul(p.y, p.y))), r), sub(abs(p.z), h));
}

HP_INLINE HP_NAMED(common) HP_NAMED(edge_in_cylinder)(vec3 p, vec3 e, num u, num h, num r) {
    num zero = constant(0), one = constant(1), across = add(mul(e.x, e.x), mul(e.y, e.y));
    num middle = div(neg(add(mul(p.x, e.x), mul(p.y, e.y))), across), near = abs(u);
    num half = sqrt(div(max(mul(sub(r, near), add(r, near)), zero), across));
    num floor = div(sub(neg(h), p.z), e.z), roof = div(sub(h, p.z), e.z);
    flag slants = less(zero, abs(e.z));
    num low = max(max(zero, sub(middle, half)), select(slants, min(floor, roof), zero));
    num high = min(select(slants, max(floor, roof), one), min(add(middle, half), one));
    num t = mul(constant(0.5f), add(min(low, one), max(high, zero)));
    vec3 at = add3(p, scale3(t, e));
    return (HP_NAMED(common)){at, HP_NAMED(outside_cylinder)(at, h, r)};
}

HP_INLINE HP_NAMED(common) HP_NAMED(less_outside)(HP_NAMED(common) a, HP_NAMED(common) b) {
    flag first = less(a.outside, b.outside);
    return (HP_NAMED(common)){select3(first, a.p, b.p), select(first, a.outside, b.outside)};
}

/* The cylinder's point furthest along n: it ends a chord through the middle, and n crosses the whole of it. */
HP_INLINE vec3 HP_NAMED(furthest_of_cylinder)(vec3 n, num h, num r) {
    num zero = constant(0), across = sqrt(add(mul(n.x, n.x), mul(n.y, n.y)));
    num s = select(less(zero, across), div(r, across), zero);
    return (vec3){mul(n.x, s), mul(n.y, s), select(less(n.z, zero), neg(h), h)};
}
