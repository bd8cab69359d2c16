/* triangle against aabb: to be written. */

HP_INLINE void HP_NAMED(triangle_aabb_prepare)(const num secondary[6], num prepared[6]) {
    for (unsigned i = 0; i < 6; i++) prepared[i] = secondary[i];
}

HP_INLINE answer HP_NAMED(triangle_aabb_test)(const num primary[9], const num prepared[6], bits index,
                                              bool separation) {
    (void)separation;
    flag F = less(add(primary[0], prepared[0]), sub(primary[0], primary[0]));
    return answer_of(F, index, mul(primary[0], prepared[0]), vec3_of(primary, 0));
}
