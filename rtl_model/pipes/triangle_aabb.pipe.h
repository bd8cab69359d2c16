/* Triangle against axis-aligned box: depth, distance, contact position. parts/triangle_box.part.h is the method; here
 * the triangle moves to the centre of the box. Edges and normal come from the triangle's own corners: a program
 * computes them once for all boxes. */

HP_INLINE void HP_NAMED(triangle_aabb_prepare)(const num box[6], num prepared[6]) {
    vec3 low = vec3_of(box, 0), high = vec3_of(box, 3);
    num a_half = constant(0.5f);
    vec3 centre = scale3(a_half, add3(low, high)), half = scale3(a_half, sub3(high, low));
    flag is_box = and(HP_NAMED(triangle_box_is_size)(half), HP_NAMED(triangle_box_is_finite)(centre));
    put_vec3(prepared, 0, centre);
    put_vec3(prepared, 3, HP_NAMED(triangle_box_half)(is_box, half));
}

HP_INLINE answer HP_NAMED(triangle_aabb_test)(const num triangle[9], const num prepared[6], bits index,
                                              bool separation, num bar) {
    vec3 centre = vec3_of(prepared, 0), corner[3];
    HP_NAMED(triangle_box) both = {.half = vec3_of(prepared, 3)};
    for (unsigned i = 0; i < 3; i++) {
        corner[i] = vec3_of(triangle, 3 * i);
        both.corner[i] = sub3(corner[i], centre);
    }
    HP_NAMED(triangle_box_edges)(corner, both.edge);
    both.normal = HP_NAMED(triangle_box_normal)(both.edge, &both.per_normal, &both.finite);

    HP_NAMED(triangle_box_overlaps) overlaps = HP_NAMED(triangle_box_shadows)(&both);
    flag F = HP_NAMED(triangle_box_meets)(&both, &overlaps);
    UNLESS_ANY(and(F, less(bar, HP_NAMED(triangle_box_bound)(&overlaps)))) if (!separation) return miss();

    num T = HP_NAMED(triangle_box_depth)(&both, &overlaps);
    HP_NAMED(triangle_box_near) near = HP_NAMED(triangle_box_nearest)(&both, &overlaps);
    vec3 CP = add3(centre, near.point);
    if (separation) return answer_with(F, index, T, HP_NAMED(triangle_box_distance)(&both, &near), CP);
    return answer_of(F, index, T, CP);
}
