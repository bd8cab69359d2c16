/* obb against obb: to be written. */

HP_INLINE void HP_NAMED(obb_obb_prepare)(const num secondary[15], num prepared[15]) {
    for (unsigned i = 0; i < 15; i++) prepared[i] = secondary[i];
}

HP_INLINE answer HP_NAMED(obb_obb_test)(const num primary[15], const num prepared[15], bits index, bool separation) {
    (void)separation;
    flag F = less(add(primary[0], prepared[0]), sub(primary[0], primary[0]));
    return answer_of(F, index, mul(primary[0], prepared[0]), vec3_of(primary, 0));
}
