/* Triangle against oriented box: depth, distance, contact position. parts/triangle_box.part.h is the method; here the
 * triangle moves to the centre of the box and turns into its frame. The normal turns too: that of the turned corners
 * would be of corners already rounded. */

HP_INLINE void HP_NAMED(triangle_obb_prepare)(const num box[15], num prepared[15]) {
    vec3 centre = vec3_of(box, 0), half = vec3_of(box, 3);
    num zero = constant(0), infinity = constant(INFINITY);
    half = (vec3){add(half.x, zero), add(half.y, zero), add(half.z, zero)};
    flag is_box = and(HP_NAMED(triangle_box_is_size)(half), HP_NAMED(triangle_box_is_finite)(centre));
    for (unsigned i = 0; i < 3; i++) {
        vec3 axis = vec3_of(box, 6 + 3 * i);
        num squared = dot(axis, axis);
        is_box = and(is_box, and(less(zero, squared), less(squared, infinity)));
        put_vec3(prepared, 6 + 3 * i, axis);
    }
    put_vec3(prepared, 0, centre);
    put_vec3(prepared, 3, HP_NAMED(triangle_box_half)(is_box, half));
}

HP_INLINE answer HP_NAMED(triangle_obb_test)(const num triangle[9], const num prepared[15], bits index,
                                             bool separation, num bar) {
    vec3 centre = vec3_of(prepared, 0), u = vec3_of(prepared, 6), v = vec3_of(prepared, 9), w = vec3_of(prepared, 12);
    HP_NAMED(triangle_box) both = {.half = vec3_of(prepared, 3)};
    vec3 corner[3], edge[3];
    for (unsigned i = 0; i < 3; i++) {
        corner[i] = vec3_of(triangle, 3 * i);
        vec3 moved = sub3(corner[i], centre);
        both.corner[i] = (vec3){dot(u, moved), dot(v, moved), dot(w, moved)};
    }
    HP_NAMED(triangle_box_edges)(corner, edge);
    vec3 n = HP_NAMED(triangle_box_normal)(edge, &both.per_normal, &both.finite);
    both.normal = (vec3){dot(u, n), dot(v, n), dot(w, n)};
    HP_NAMED(triangle_box_edges)(both.corner, both.edge);

    HP_NAMED(triangle_box_overlaps) overlaps = HP_NAMED(triangle_box_shadows)(&both);
    flag F = HP_NAMED(triangle_box_meets)(&both, &overlaps);
    UNLESS_ANY(and(F, less(bar, HP_NAMED(triangle_box_bound)(&overlaps)))) if (!separation) return miss();

    num T = HP_NAMED(triangle_box_depth)(&both, &overlaps);
    HP_NAMED(triangle_box_near) near = HP_NAMED(triangle_box_nearest)(&both, &overlaps);
    vec3 q = near.point;
    vec3 CP = add3(centre, add3(add3(scale3(q.x, u), scale3(q.y, v)), scale3(q.z, w)));
    if (separation) return answer_with(F, index, T, HP_NAMED(triangle_box_distance)(&both, &near), CP);
    return answer_of(F, index, T, CP);
}
