#include "host/rays/flight.h"

#include "host/rays/angle.h"
#include "host/rays/vector.h"

/* Points of the curve: x and y as shares of the scene's width and depth from its middle, z as a share of its height
 * (and of a twentieth of its diagonal, for flat scenes) above the top. */
static const double knots[8][3] = {
    {-0.40, -0.30, 0.6}, {-0.05, -0.42, 0.3}, {0.35, -0.28, 0.8}, {0.18, 0.02, 0.4},
    {0.38, 0.34, 0.7},   {-0.02, 0.22, 0.2},  {-0.36, 0.38, 0.9}, {-0.22, 0.02, 0.3},
};

/* Catmull and Rom, "A class of local interpolating splines" (1974), the uniform cubic through b and c. */
static double spline(double a, double b, double c, double d, double s) {
    return b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)));
}

static double knot_share(size_t i, size_t n, int axis) {
    double place = (double)(i % n) * 8 / (double)n;
    size_t k = (size_t)place;
    return spline(knots[(k + 7) % 8][axis], knots[k % 8][axis], knots[(k + 1) % 8][axis], knots[(k + 2) % 8][axis],
                  place - (double)k);
}

static double diagonal(const hp_bounds *bounds) {
    hp_vector across = hp_vector_sub(hp_vector_of(bounds->high), hp_vector_of(bounds->low));
    return sqrt(hp_vector_dot(across, across));
}

/* Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014). */
static uint64_t splitmix64(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9;
    z = (z ^ z >> 27) * 0x94D049BB133111EB;
    return z ^ z >> 31;
}

/* Uniform over the sphere: points of a cube until one is in the ball. */
static hp_vector random_direction(uint64_t seed) {
    for (;;) {
        double c[3];
        for (int i = 0; i < 3; i++) c[i] = (double)(splitmix64(&seed) >> 11) * 0x1p-52 - 1;
        hp_vector v = hp_vector_of(c);
        double square = hp_vector_dot(v, v);
        if (square <= 1 && square > 1e-6) return hp_vector_unit(v);
    }
}

void hp_flight_ray(const hp_bounds *bounds, size_t i, size_t n, float ray[HP_RAY_WORDS]) {
    for (int axis = 0; axis < 2; axis++) {
        double middle = (bounds->low[axis] + bounds->high[axis]) / 2;
        ray[axis] = (float)(middle + knot_share(i, n, axis) * (bounds->high[axis] - bounds->low[axis]));
    }
    double unit = (bounds->high[2] - bounds->low[2]) / 2 + diagonal(bounds) / 20;
    ray[2] = (float)(bounds->high[2] + knot_share(i, n, 2) * unit);
    hp_vector direction = random_direction(i);
    ray[3] = (float)direction.x;
    ray[4] = (float)direction.y;
    ray[5] = (float)direction.z;
}

void hp_flight_motion(const hp_bounds *bounds, size_t i, size_t n, float matrix[12]) {
    double turn = 360 * (double)(i % n) / (double)n, angle = 10 * hp_sine(turn);
    double c = hp_cosine(angle), s = hp_sine(angle), rise = (1 - hp_cosine(turn)) / 2 * diagonal(bounds) / 20;
    double x = (bounds->low[0] + bounds->high[0]) / 2, y = (bounds->low[1] + bounds->high[1]) / 2;
    const double rows[12] = {c, -s, 0, x - c * x + s * y, s, c, 0, y - s * x - c * y, 0, 0, 1, rise};
    for (int k = 0; k < 12; k++) matrix[k] = (float)rows[k];
}
