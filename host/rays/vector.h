/* Vectors of three doubles, for the host's own geometry. */
#ifndef HITPIPE_HOST_VECTOR_H
#define HITPIPE_HOST_VECTOR_H

#include <math.h>
#include <stdbool.h>

typedef struct hp_vector {
    double x, y, z;
} hp_vector;

static inline hp_vector hp_vector_of(const double xyz[3]) {
    return (hp_vector){xyz[0], xyz[1], xyz[2]};
}

static inline hp_vector hp_vector_sub(hp_vector a, hp_vector b) {
    return (hp_vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* a + s b */
static inline hp_vector hp_vector_along(hp_vector a, double s, hp_vector b) {
    return (hp_vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double hp_vector_dot(hp_vector a, hp_vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline hp_vector hp_vector_cross(hp_vector a, hp_vector b) {
    return (hp_vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Unit length; the zero vector stays. */
static inline hp_vector hp_vector_unit(hp_vector a) {
    double length = sqrt(hp_vector_dot(a, a));
    return length > 0 ? (hp_vector){a.x / length, a.y / length, a.z / length} : a;
}

#endif
