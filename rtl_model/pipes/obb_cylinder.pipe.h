/* obb against cylinder: to be written. */

HP_INLINE void HP_NAMED(obb_cylinder_prepare)(const num secondary[7], num prepared[15]) {
    HP_NAMED(put_cylinder)(prepared, HP_NAMED(cylinder_of)(secondary));
}

HP_INLINE answer HP_NAMED(obb_cylinder_test)(const num primary[15], const num prepared[15], bits index,
                                             bool separation) {
    (void)separation;
    flag F = less(add(primary[0], prepared[0]), sub(primary[0], primary[0]));
    return answer_of(F, index, mul(primary[0], prepared[0]), vec3_of(primary, 0));
}
