#include "host/output/figure.h"

/* The s for which at + s * toward is in a set; none: low > high. */
typedef struct span {
    double low, high;
} span;

static const span none = {INFINITY, -INFINITY}, all = {-INFINITY, INFINITY};

static hp_vector vector_at(const float *words) {
    return (hp_vector){words[0], words[1], words[2]};
}

static span common(span a, span b) {
    return (span){fmax(a.low, b.low), fmin(a.high, b.high)};
}

/* |axis . (at + s toward)| <= half, of a unit axis */
static span in_slab(hp_vector at, hp_vector toward, hp_vector axis, double half) {
    double from = hp_vector_dot(at, axis), slope = hp_vector_dot(toward, axis);
    if (fabs(slope) < 1e-12) return fabs(from) <= half ? all : none;
    double a = (-half - from) / slope, b = (half - from) / slope;
    return (span){fmin(a, b), fmax(a, b)};
}

/* |at + s toward| <= radius */
static span in_ball(hp_vector at, hp_vector toward, double radius) {
    double a = hp_vector_dot(toward, toward), b = hp_vector_dot(at, toward);
    double c = hp_vector_dot(at, at) - radius * radius, root = b * b - a * c;
    if (a < 1e-12) return c <= 0 ? all : none;
    if (root < 0) return none;
    return (span){(-b - sqrt(root)) / a, (-b + sqrt(root)) / a};
}

static span in_box(hp_vector at, hp_vector toward, hp_vector centre, const double half[3], const hp_vector axes[3]) {
    span inside = all;
    hp_vector from = hp_vector_sub(at, centre);
    for (int i = 0; i < 3; i++) inside = common(inside, in_slab(from, toward, axes[i], half[i]));
    return inside;
}

static span in_aabb(const float *words, hp_vector at, hp_vector toward) {
    static const hp_vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double half[3], centre[3];
    for (int i = 0; i < 3; i++) {
        half[i] = ((double)words[3 + i] - (double)words[i]) / 2;
        centre[i] = ((double)words[3 + i] + (double)words[i]) / 2;
    }
    return in_box(at, toward, hp_vector_of(centre), half, axes);
}

static span in_obb(const float *words, hp_vector at, hp_vector toward) {
    const hp_vector axes[] = {vector_at(words + 6), vector_at(words + 9), vector_at(words + 12)};
    return in_box(at, toward, vector_at(words), (const double[]){words[3], words[4], words[5]}, axes);
}

static span in_cylinder(const float *words, hp_vector at, hp_vector toward) {
    hp_vector p0 = vector_at(words), whole = hp_vector_sub(vector_at(words + 3), p0), axis = hp_vector_unit(whole);
    hp_vector from = hp_vector_sub(at, hp_vector_along(p0, 0.5, whole));
    hp_vector out = hp_vector_along(from, -hp_vector_dot(from, axis), axis);
    hp_vector outward = hp_vector_along(toward, -hp_vector_dot(toward, axis), axis);
    return common(in_ball(out, outward, (double)words[6]),
                  in_slab(from, toward, axis, hp_vector_dot(whole, axis) / 2));
}

/* The one s, if any, at which the line meets the plane through `point` at right angles to `normal`. */
static span in_plane(hp_vector at, hp_vector toward, hp_vector point, hp_vector normal) {
    double slope = hp_vector_dot(toward, normal);
    if (fabs(slope) < 1e-12) return none;
    double s = hp_vector_dot(hp_vector_sub(point, at), normal) / slope;
    return (span){s, s};
}

static span in_triangle(const float *words, hp_vector at, hp_vector toward) {
    const hp_vector v[] = {vector_at(words), vector_at(words + 3), vector_at(words + 6)};
    hp_vector n = hp_vector_unit(hp_vector_cross(hp_vector_sub(v[1], v[0]), hp_vector_sub(v[2], v[0])));
    span cut = in_plane(at, toward, v[0], n);
    if (cut.low > cut.high) return none;
    hp_vector point = hp_vector_along(at, cut.low, toward);
    for (int i = 0; i < 3; i++) {
        hp_vector edge = hp_vector_sub(v[(i + 1) % 3], v[i]);
        if (hp_vector_dot(hp_vector_cross(edge, hp_vector_sub(point, v[i])), n) < 0) return none;
    }
    return cut;
}

static span in_patch(const hp_figure *figure, hp_vector at, hp_vector toward) {
    hp_patch patch = hp_figure_patch(figure);
    span cut = in_plane(at, toward, patch.middle, hp_vector_cross(patch.u, patch.v));
    if (cut.low > cut.high) return none;
    hp_vector from = hp_vector_sub(hp_vector_along(at, cut.low, toward), patch.middle);
    bool within =
        fabs(hp_vector_dot(from, patch.u)) <= figure->reach && fabs(hp_vector_dot(from, patch.v)) <= figure->reach;
    return within ? cut : none;
}

static span inside(const hp_figure *figure, hp_vector at, hp_vector toward) {
    const float *words = figure->words;
    switch (figure->object) {
    case HP_RAY:
        return none;
    case HP_TRIANGLE:
        return in_triangle(words, at, toward);
    case HP_SPHERE:
        return in_ball(hp_vector_sub(at, vector_at(words)), toward, (double)words[3]);
    case HP_AABB:
        return in_aabb(words, at, toward);
    case HP_OBB:
        return in_obb(words, at, toward);
    case HP_CYLINDER:
        return in_cylinder(words, at, toward);
    case HP_PLANE:
        return in_patch(figure, at, toward);
    }
    return none;
}

double hp_figure_end(const hp_figure *figure, hp_vector at, hp_vector toward) {
    span s = inside(figure, at, toward);
    return s.low <= s.high ? s.high : -INFINITY;
}

void hp_figure_across(hp_vector axis, hp_vector *u, hp_vector *v) {
    hp_vector other = fabs(axis.z) < 0.9999 ? (hp_vector){0, 0, 1} : (hp_vector){1, 0, 0};
    *u = hp_vector_unit(hp_vector_cross(other, axis));
    *v = hp_vector_cross(axis, *u);
}

hp_patch hp_figure_patch(const hp_figure *plane) {
    hp_vector n = vector_at(plane->words);
    double above = (hp_vector_dot(n, plane->around) - (double)plane->words[3]) / hp_vector_dot(n, n);
    hp_patch patch = {.middle = hp_vector_along(plane->around, -above, n)};
    hp_figure_across(hp_vector_unit(n), &patch.u, &patch.v);
    return patch;
}
