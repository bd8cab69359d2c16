/* The transformer: a 3x4 row-major matrix m moves every point of a secondary,
 *
 *   x' = (m0 x + m1 y) + (m2 z + t),   t in the last column
 *
 * One function an object type of transformer.def; the sums are trees, so that the latency is mul, add, add. */

HP_INLINE num HP_NAMED(transform_row)(const num row[4], vec3 p) {
    return add(add(mul(row[0], p.x), mul(row[1], p.y)), add(mul(row[2], p.z), row[3]));
}

HP_INLINE vec3 HP_NAMED(transform_point)(const num m[12], vec3 p) {
    return (vec3){HP_NAMED(transform_row)(m, p), HP_NAMED(transform_row)(m + 4, p),
                  HP_NAMED(transform_row)(m + 8, p)};
}

HP_INLINE void HP_NAMED(transform_TRIANGLE)(const num m[12], const num in[9], num out[9]) {
    put_vec3(out, 0, HP_NAMED(transform_point)(m, vec3_of(in, 0)));
    put_vec3(out, 3, HP_NAMED(transform_point)(m, vec3_of(in, 3)));
    put_vec3(out, 6, HP_NAMED(transform_point)(m, vec3_of(in, 6)));
}
