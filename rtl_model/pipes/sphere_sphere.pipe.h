/* sphere against sphere: to be written. */

HP_INLINE void HP_NAMED(sphere_sphere_prepare)(const num secondary[4], num prepared[4]) {
    for (unsigned i = 0; i < 4; i++) prepared[i] = secondary[i];
}

HP_INLINE answer HP_NAMED(sphere_sphere_test)(const num primary[4], const num prepared[4], bits index,
                                              bool separation) {
    (void)separation;
    flag F = less(add(primary[0], prepared[0]), sub(primary[0], primary[0]));
    return answer_of(F, index, mul(primary[0], prepared[0]), vec3_of(primary, 0));
}
