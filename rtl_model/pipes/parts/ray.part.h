/* The point of a ray's line that is nearest to the point s away from the ray's origin. */

typedef struct HP_NAMED(approach) {
    num t;       /* its parameter, in units of the direction d */
    vec3 offset; /* from it to the point */
    num squared; /* d.d, and */
    num inverse; /* 1/(d.d): an infinity for the direction zero, 0 for one that is too long */
} HP_NAMED(approach);

/* However far the origin is, the offset is wrong by no more than two roundings of s across the ray: the error of t
 * only moves the point along the ray. Hence what follows need not know of the distance of the origin. */
HP_INLINE HP_NAMED(approach) HP_NAMED(approach_of)(vec3 s, vec3 d) {
    num squared = dot(d, d), inverse = div(constant(1), squared);
    num t = mul(dot(s, d), inverse);
    return (HP_NAMED(approach)){t, sub3(s, scale3(t, d)), squared, inverse};
}
