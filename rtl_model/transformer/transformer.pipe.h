/* The transformer: a 3x4 row-major matrix m moves every point of a secondary,
 *
 *   x' = (m0 x + m1 y) + (m2 z + t),   t in the last column
 *
 * and every direction by m without t. Sizes pass through: what a type cannot carry (a scale, a shear, an aabb's
 * rotation) the host refuses, hp_transform_fault. A moved plane is n' = M n, d' = d + n'.t, since M is rigid.
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

HP_INLINE vec3 HP_NAMED(transform_direction)(const num m[12], vec3 d) {
    return (vec3){add(add(mul(m[0], d.x), mul(m[1], d.y)), mul(m[2], d.z)),
                  add(add(mul(m[4], d.x), mul(m[5], d.y)), mul(m[6], d.z)),
                  add(add(mul(m[8], d.x), mul(m[9], d.y)), mul(m[10], d.z))};
}

HP_INLINE void HP_NAMED(transform_SPHERE)(const num m[12], const num in[4], num out[4]) {
    put_vec3(out, 0, HP_NAMED(transform_point)(m, vec3_of(in, 0)));
    out[3] = in[3];
}

/* With a matrix that moves and stretches along the axes: the corners stay corners. */
HP_INLINE void HP_NAMED(transform_AABB)(const num m[12], const num in[6], num out[6]) {
    put_vec3(out, 0, HP_NAMED(transform_point)(m, vec3_of(in, 0)));
    put_vec3(out, 3, HP_NAMED(transform_point)(m, vec3_of(in, 3)));
}

HP_INLINE void HP_NAMED(transform_OBB)(const num m[12], const num in[15], num out[15]) {
    put_vec3(out, 0, HP_NAMED(transform_point)(m, vec3_of(in, 0)));
    for (unsigned i = 3; i < 6; i++) out[i] = in[i];
    for (unsigned axis = 6; axis < 15; axis += 3)
        put_vec3(out, axis, HP_NAMED(transform_direction)(m, vec3_of(in, axis)));
}

HP_INLINE void HP_NAMED(transform_CYLINDER)(const num m[12], const num in[7], num out[7]) {
    put_vec3(out, 0, HP_NAMED(transform_point)(m, vec3_of(in, 0)));
    put_vec3(out, 3, HP_NAMED(transform_point)(m, vec3_of(in, 3)));
    out[6] = in[6];
}

HP_INLINE void HP_NAMED(transform_PLANE)(const num m[12], const num in[4], num out[4]) {
    vec3 n = HP_NAMED(transform_direction)(m, vec3_of(in, 0)), t = {m[3], m[7], m[11]};
    put_vec3(out, 0, n);
    out[3] = add(in[3], dot(n, t));
}
