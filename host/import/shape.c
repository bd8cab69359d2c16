#include "host/import/shape.h"

#include "host/rays/vector.h"

static hp_vector vector_at(const float *words) {
    return (hp_vector){words[0], words[1], words[2]};
}

hp_bounds hp_bounds_none(void) {
    return (hp_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void hp_bounds_add(hp_bounds *bounds, const hp_bounds *inner) {
    for (int i = 0; i < 3; i++) {
        bounds->low[i] = fmin(bounds->low[i], inner->low[i]);
        bounds->high[i] = fmax(bounds->high[i], inner->high[i]);
    }
}

/* Around n points, xyz each. */
static hp_bounds around_points(const float *words, unsigned n) {
    hp_bounds bounds = hp_bounds_none();
    for (unsigned i = 0; i < n; i++) {
        const double point[3] = {words[3 * i], words[3 * i + 1], words[3 * i + 2]};
        for (int axis = 0; axis < 3; axis++) {
            bounds.low[axis] = fmin(bounds.low[axis], point[axis]);
            bounds.high[axis] = fmax(bounds.high[axis], point[axis]);
        }
    }
    return bounds;
}

static hp_bounds grown(hp_bounds bounds, const double by[3]) {
    for (int axis = 0; axis < 3; axis++) {
        bounds.low[axis] -= by[axis];
        bounds.high[axis] += by[axis];
    }
    return bounds;
}

static hp_bounds around_obb(const float *words) {
    double reach[3] = {0, 0, 0};
    for (int side = 0; side < 3; side++)
        for (int axis = 0; axis < 3; axis++)
            reach[axis] += fabs((double)words[3 + side] * (double)words[6 + 3 * side + axis]);
    return grown(around_points(words, 1), reach);
}

/* A cap's disc reaches radius * the sine of the angle between the cylinder's axis and the coordinate's. */
static hp_bounds around_cylinder(const float *words) {
    hp_vector axis = hp_vector_unit(hp_vector_sub(vector_at(words + 3), vector_at(words)));
    const double along[3] = {axis.x, axis.y, axis.z};
    double reach[3];
    for (int i = 0; i < 3; i++) reach[i] = (double)words[6] * sqrt(fmax(0, 1 - along[i] * along[i]));
    return grown(around_points(words, 2), reach);
}

hp_bounds hp_shape_bounds(hp_object object, const float *words) {
    switch (object) {
    case HP_RAY:
        return around_points(words, 1);
    case HP_TRIANGLE:
        return around_points(words, 3);
    case HP_SPHERE:
        return grown(around_points(words, 1), (const double[3]){words[3], words[3], words[3]});
    case HP_AABB:
        return around_points(words, 2);
    case HP_OBB:
        return around_obb(words);
    case HP_CYLINDER:
        return around_cylinder(words);
    case HP_PLANE:
        return around_points((const float[3]){words[0] * words[3], words[1] * words[3], words[2] * words[3]}, 1);
    }
    return hp_bounds_none();
}

/* The cap or the side, whichever surface is nearer to the point. */
static hp_vector cylinder_normal(const float *words, hp_vector point) {
    hp_vector p0 = vector_at(words), whole = hp_vector_sub(vector_at(words + 3), p0), axis = hp_vector_unit(whole);
    hp_vector from = hp_vector_sub(point, p0);
    double height = hp_vector_dot(from, axis), length = hp_vector_dot(whole, axis);
    hp_vector out = hp_vector_along(from, -height, axis);
    double side = fabs(sqrt(hp_vector_dot(out, out)) - (double)words[6]);
    if (fabs(height) < side && fabs(height) <= fabs(height - length))
        return hp_vector_along((hp_vector){0}, -1, axis);
    if (fabs(height - length) < side) return axis;
    return hp_vector_unit(out);
}

void hp_shape_normal(hp_object object, const float *words, const float point[3], double normal[3]) {
    hp_vector n = {0}, v0 = vector_at(words);
    if (object == HP_TRIANGLE)
        n = hp_vector_unit(
            hp_vector_cross(hp_vector_sub(vector_at(words + 3), v0), hp_vector_sub(vector_at(words + 6), v0)));
    if (object == HP_SPHERE) n = hp_vector_unit(hp_vector_sub(vector_at(point), v0));
    if (object == HP_CYLINDER) n = cylinder_normal(words, vector_at(point));
    normal[0] = n.x;
    normal[1] = n.y;
    normal[2] = n.z;
}

hp_product hp_worst_product(const float *vectors, unsigned n) {
    hp_product worst = {0, 0, 1};
    for (unsigned i = 0; i < n; i++)
        for (unsigned k = i; k < n; k++) {
            double value = hp_vector_dot(vector_at(vectors + 3 * i), vector_at(vectors + 3 * k));
            bool worse = fabs(value - (i == k)) > fabs(worst.value - (worst.i == worst.k));
            if (worse) worst = (hp_product){i, k, value};
        }
    return worst;
}
