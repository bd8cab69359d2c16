#include "pair_cases.h"

#include "ray_triangle_cases.h"
#include "testbench/reference/truth.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const char *const class_names[HPT_CLASSES] = {"random", "grazing", "degenerate", "offset"};

const char *hpt_class_name(hpt_class class) {
    return class_names[class];
}

/* ---- small vectors and frames ---- */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* to = to + k a */
static void add_scaled(double to[3], double k, const double a[3]) {
    for (int i = 0; i < 3; i++) to[i] += k * a[i];
}

static void draw_direction(hpt_random *random, double to[3]) {
    double square;
    do {
        for (int i = 0; i < 3; i++) to[i] = hpt_random_between(random, -1, 1);
        square = dot(to, to);
    } while (square > 1 || square < 0.01);
    for (int i = 0; i < 3; i++) to[i] /= sqrt(square);
}

/* Turns three rows that are independent into an orthonormal frame. */
static void make_orthonormal(double axis[3][3]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < i; j++) add_scaled(axis[i], -dot(axis[i], axis[j]), axis[j]);
        double length = sqrt(dot(axis[i], axis[i]));
        for (int k = 0; k < 3; k++) axis[i][k] /= length;
    }
}

static void no_turn(double axis[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) axis[i][k] = i == k;
}

static void draw_frame(hpt_random *random, double axis[3][3]) {
    double volume;
    do {
        for (int i = 0; i < 3; i++) draw_direction(random, axis[i]);
        double *a = axis[0], *b = axis[1], *c = axis[2];
        volume = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                 a[2] * (b[0] * c[1] - b[1] * c[0]);
    } while (fabs(volume) < 0.05);
    make_orthonormal(axis);
}

/* 2^least to 2^most, even in the exponent. Two draws never stand in one expression: compilers differ on which is
 * first. */
static double draw_power(hpt_random *random, int least, int most) {
    int exponent = least + (int)hpt_random_below(random, (unsigned)(most - least));
    return ldexp(1 + hpt_random_unit(random), exponent);
}

/* ---- shapes: every type as half extents in a frame ---- */

typedef struct shape {
    hp_object type;
    double centre[3], axis[3][3];
    double half[3];      /* sphere: [0]; cylinder: radius [0], half its height [2]; plane, ray: none */
    double corner[3][2]; /* triangle: in units of half[0], half[1] along axes 0 and 1 */
    double direction[3]; /* ray */
} shape;

static bool is_volume(hp_object type) {
    return type != HP_RAY && type != HP_PLANE;
}

/* Radius about the centre; 0 of rays and planes. */
static double radius_of(const shape *s) {
    if (s->type == HP_SPHERE) return s->half[0];
    if (s->type == HP_CYLINDER) return sqrt(s->half[0] * s->half[0] + s->half[2] * s->half[2]);
    return is_volume(s->type) ? sqrt(dot(s->half, s->half)) : 0;
}

static void draw_corners(hpt_random *random, shape *s) {
    double area;
    do {
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 2; k++) s->corner[i][k] = hpt_random_between(random, -1, 1);
        area = (s->corner[1][0] - s->corner[0][0]) * (s->corner[2][1] - s->corner[0][1]) -
               (s->corner[1][1] - s->corner[0][1]) * (s->corner[2][0] - s->corner[0][0]);
    } while (fabs(area) < 0.25);
}

static void draw_plain(hpt_random *random, hp_object type, shape *s) {
    *s = (shape){.type = type};
    draw_frame(random, s->axis);
    for (int i = 0; i < 3; i++) s->half[i] = is_volume(type) ? hpt_random_between(random, 0.2, 1) : 0;
    if (type == HP_AABB) no_turn(s->axis);
    if (type == HP_TRIANGLE) {
        s->half[2] = 0;
        draw_corners(random, s);
    }
}

/* A point of the object, in the frame's coordinates times `stretch`. */
static void draw_point(hpt_random *random, const shape *s, double stretch, double to[3]) {
    double local[3] = {0}, a, b;
    memcpy(to, s->centre, sizeof s->centre);
    do {
        a = hpt_random_unit(random);
        b = hpt_random_unit(random);
    } while (a + b > 1);
    if (s->type == HP_TRIANGLE) {
        for (int k = 0; k < 2; k++)
            local[k] = ((1 - a - b) * s->corner[0][k] + a * s->corner[1][k] + b * s->corner[2][k]) * s->half[k];
    } else if (s->type == HP_SPHERE) {
        draw_direction(random, local);
        for (int k = 0; k < 3; k++) local[k] *= s->half[0] * hpt_random_unit(random);
    } else {
        for (int k = 0; k < 3; k++) local[k] = hpt_random_between(random, -s->half[k], s->half[k]);
        if (s->type == HP_CYLINDER) {
            local[0] = s->half[0] * hpt_random_between(random, -0.7, 0.7);
            local[1] = s->half[0] * hpt_random_between(random, -0.7, 0.7);
        }
    }
    if (s->type == HP_PLANE)
        for (int k = 0; k < 2; k++) local[k] = hpt_random_between(random, -1, 1);
    for (int i = 0; i < 3; i++) add_scaled(to, stretch * local[i], s->axis[i]);
}

static void put3(float *words, const double a[3]) {
    for (int i = 0; i < 3; i++) words[i] = hpt_to_float(a[i]);
}

static void put_box(const shape *s, float *words) {
    put3(words, s->centre);
    put3(words + 3, s->half);
    for (int i = 0; i < 3; i++) put3(words + 6 + 3 * i, s->axis[i]);
}

static void put_triangle(const shape *s, float *words) {
    for (int i = 0; i < 3; i++) {
        double v[3];
        memcpy(v, s->centre, sizeof v);
        for (int k = 0; k < 2; k++) add_scaled(v, s->corner[i][k] * s->half[k], s->axis[k]);
        put3(words + 3 * i, v);
    }
}

static void put_shape(const shape *s, float *words) {
    double low[3], high[3];
    switch (s->type) {
    case HP_RAY:
        put3(words, s->centre);
        put3(words + 3, s->direction);
        break;
    case HP_TRIANGLE:
        put_triangle(s, words);
        break;
    case HP_SPHERE:
        put3(words, s->centre);
        words[3] = hpt_to_float(s->half[0]);
        break;
    case HP_AABB:
        for (int i = 0; i < 3; i++) {
            low[i] = s->centre[i] - s->half[i];
            high[i] = s->centre[i] + s->half[i];
        }
        put3(words, low);
        put3(words + 3, high);
        break;
    case HP_OBB:
        put_box(s, words);
        break;
    case HP_CYLINDER:
        for (int i = 0; i < 3; i++) {
            low[i] = s->centre[i] - s->half[2] * s->axis[2][i];
            high[i] = s->centre[i] + s->half[2] * s->axis[2][i];
        }
        put3(words, low);
        put3(words + 3, high);
        words[6] = hpt_to_float(s->half[0]);
        break;
    case HP_PLANE:
        put3(words, s->axis[2]);
        words[3] = hpt_to_float(dot(s->axis[2], s->centre));
        break;
    }
}

/* ---- where the first stands beside the second ---- */

/* From a point about the other object to a point of it, or past it. */
static void aim(hpt_random *random, unsigned i, shape *ray, const shape *at) {
    double target[3], size = radius_of(at);
    draw_point(random, at, i % 2 ? 1 : 1.8, target);
    draw_direction(random, ray->direction);
    memcpy(ray->centre, target, sizeof target);
    double reach = size * hpt_random_between(random, 0, i % 8 < 2 ? 1 : 4);
    add_scaled(ray->centre, -reach, ray->direction);
    double stretch = hpt_random_between(random, 0.25, 4) * (i % 8 == 6 ? -1 : 1);
    for (int k = 0; k < 3; k++) ray->direction[k] *= stretch;
}

/* How many sums of both radii apart, at most: so that about half of all pairs collide. */
static double farthest(hp_object a, hp_object b) {
    if (b == HP_PLANE) return 5;
    return a == HP_SPHERE && b == HP_SPHERE ? 2.2 : a == HP_SPHERE || b == HP_SPHERE ? 1.4 : 1.2;
}

/* Centres apart in a random direction, or a point of one onto a point of the other. */
static void place(hpt_random *random, unsigned i, shape *a, const shape *b) {
    double from[3], to[3], away[3];
    if (a->type == HP_RAY) {
        aim(random, i, a, b);
        return;
    }
    if (i % 6 == 5) {
        draw_point(random, a, 1, from);
        draw_point(random, b, 1, to);
        for (int k = 0; k < 3; k++) a->centre[k] += to[k] - from[k];
        return;
    }
    draw_direction(random, away);
    memcpy(a->centre, b->centre, sizeof a->centre);
    double most = farthest(a->type, b->type) * (radius_of(a) + radius_of(b));
    add_scaled(a->centre, most * hpt_random_between(random, 0.02, 1), away);
}

static void draw_random(hpt_random *random, unsigned i, shape *a, shape *b) {
    draw_plain(random, a->type, a);
    draw_plain(random, b->type, b);
    draw_point(random, b, 0.5, b->centre);
    place(random, i, a, b);
}

/* ---- degenerate objects ---- */

/* One or two of the three extents 1e-3 to 1e-5 of what they were, or zero. A cylinder keeps a height: one of none is
 * not legal. */
static void make_thin(hpt_random *random, shape *s) {
    bool zero = hpt_random_below(random, 3) == 0;
    unsigned first = (unsigned)hpt_random_below(random, 3), thin = 1 + (unsigned)hpt_random_below(random, 2);
    if (zero && hpt_random_below(random, 4) == 0) thin = 3;
    for (unsigned k = 0; k < thin; k++) s->half[(first + k) % 3] *= zero ? 0 : draw_power(random, -17, -10);
    if (s->type == HP_CYLINDER && s->half[2] == 0) s->half[2] = 0.5;
}

static void resize(hpt_random *random, shape *s) {
    double size = draw_power(random, -9, 12);
    for (int k = 0; k < 3; k++) s->half[k] *= size;
}

/* Axes of the other, in another order; every second time not quite. */
static void make_parallel(hpt_random *random, const shape *to, shape *s) {
    if (s->type == HP_AABB) return;
    unsigned first = (unsigned)hpt_random_below(random, 3);
    for (unsigned i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) s->axis[i][k] = to->axis[(first + i) % 3][k] * (i == 1 && first == 1 ? -1 : 1);
    if (hpt_random_below(random, 2)) return;
    double tilt = draw_power(random, -30, -8), aside[3];
    for (int i = 0; i < 3; i++) {
        draw_direction(random, aside);
        add_scaled(s->axis[i], tilt, aside);
    }
    make_orthonormal(s->axis);
}

static void round_to_eighths(shape *s) {
    for (int k = 0; k < 3; k++) {
        bool flat = !is_volume(s->type) || (s->type == HP_TRIANGLE && k == 2);
        s->half[k] = flat ? 0 : fmax(0.125, rint(8 * s->half[k]) / 8);
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) s->corner[i][k] = rint(4 * s->corner[i][k]) / 4;
}

/* Faces in the same plane and edges on the same line: coordinates are multiples of an eighth. */
static void make_coincident(hpt_random *random, shape *a, shape *b) {
    unsigned along = (unsigned)hpt_random_below(random, 3);
    bool inside = hpt_random_below(random, 2);
    no_turn(a->axis);
    no_turn(b->axis);
    round_to_eighths(a);
    round_to_eighths(b);
    for (unsigned k = 0; k < 3; k++) {
        b->centre[k] = (double)hpt_random_below(random, 9) / 8;
        a->centre[k] = b->centre[k] + ((double)hpt_random_below(random, 9) - 4) / 8;
    }
    a->centre[along] = b->centre[along] + a->half[along] * (inside ? -1 : 1) + b->half[along];
    if (a->type == HP_RAY)
        for (unsigned k = 0; k < 3; k++) a->direction[k] = k == (along + inside) % 3;
}

/* Along an axis of the object, through a point near it. */
static void make_ray_parallel(hpt_random *random, shape *ray, const shape *to) {
    const double *axis = to->axis[hpt_random_below(random, 3)];
    double sign = hpt_random_below(random, 2) ? 1 : -1;
    draw_point(random, to, 1.5, ray->centre);
    add_scaled(ray->centre, -sign * 2 * radius_of(to), axis);
    for (int k = 0; k < 3; k++) ray->direction[k] = sign * axis[k];
    if (hpt_random_below(random, 2)) return;
    double aside[3];
    draw_direction(random, aside);
    add_scaled(ray->direction, draw_power(random, -24, -6), aside);
}

static void draw_degenerate(hpt_random *random, unsigned i, shape *a, shape *b) {
    draw_plain(random, a->type, a);
    draw_plain(random, b->type, b);
    if (i % 8 == 0) {
        make_coincident(random, a, b);
        return;
    }
    bool parallel = i % 4 == 1, thin = i % 4 != 1 || i % 8 == 5, mixed = i % 4 == 3;
    if (thin && i % 3 != 0 && is_volume(a->type)) make_thin(random, a);
    if (thin && (i % 3 != 1 || !is_volume(a->type))) make_thin(random, b);
    if (mixed && is_volume(a->type)) resize(random, a);
    if (mixed) resize(random, b);
    if (parallel && b->type == HP_AABB)
        make_parallel(random, b, a);
    else if (parallel)
        make_parallel(random, a, b);
    draw_point(random, b, 0.5, b->centre);
    if (parallel && a->type == HP_RAY)
        make_ray_parallel(random, a, b);
    else
        place(random, i / 8 + i, a, b);
}

/* ---- whole pairs ---- */

void hpt_move_object(hp_object object, float *words, const double by[3]) {
    unsigned points = object == HP_TRIANGLE ? 3 : object == HP_AABB || object == HP_CYLINDER ? 2 : 1;
    if (object == HP_PLANE) {
        double n[3] = {words[0], words[1], words[2]};
        words[3] = hpt_to_float(words[3] + dot(n, by));
        return;
    }
    for (unsigned i = 0; i < 3 * points; i++) words[i] = hpt_to_float(words[i] + by[i % 3]);
}

static void draw_offset(hpt_random *random, double by[3]) {
    for (int k = 0; k < 3; k++) {
        by[k] = hpt_random_between(random, 1e3, 1e4);
        if (hpt_random_below(random, 2)) by[k] = -by[k];
    }
}

/* Moves the first, by the oracle's word, to where the two are a small number of bands from touching. */
static void graze(hpt_random *random, hp_object a, hp_object b, float *first, const float *second) {
    hpt_truth truth = hpt_truth_between(a, b, first, second);
    double by[3], bands = draw_power(random, -5, 10);
    double apart = bands * truth.band * (hpt_random_below(random, 2) ? 1 : -1);
    for (int k = 0; k < 3; k++) by[k] = -(apart - truth.signed_distance) * truth.direction[k];
    hpt_move_object(a, first, by);
}

static bool legal(hp_object a, hp_object b, const float *first, const float *second) {
    return !hp_object_fault(a, first) && !hp_object_fault(b, second);
}

void hpt_draw_objects(hpt_random *random, hp_object a, hp_object b, hpt_class class, unsigned i, float *first,
                      float *second) {
    do {
        shape s = {.type = a}, t = {.type = b};
        if (class == HPT_DEGENERATE)
            draw_degenerate(random, i, &s, &t);
        else
            draw_random(random, i, &s, &t);
        if (class == HPT_OFFSET) {
            double by[3];
            draw_offset(random, by);
            add_scaled(s.centre, 1, by);
            add_scaled(t.centre, 1, by);
        }
        put_shape(&s, first);
        put_shape(&t, second);
        if (class == HPT_GRAZING) graze(random, a, b, first, second);
    } while (!legal(a, b, first, second));
}

static void draw_ray_triangle(hpt_random *random, hpt_class class, unsigned i, float ray[6], float triangle[9]) {
    switch (class) {
    case HPT_RANDOM:
        hpt_random_pair(random, i, ray, triangle);
        break;
    case HPT_GRAZING:
        hpt_grazing_pair(random, i, ray, triangle);
        break;
    case HPT_OFFSET:
        hpt_offset_pair(random, i, ray, triangle);
        break;
    default:
        if (i % 4 == 0)
            hpt_sliver_pair(random, i / 4, ray, triangle);
        else if (i % 4 == 1)
            hpt_slanting_pair(random, i / 4, ray, triangle);
        else
            hpt_draw_objects(random, HP_RAY, HP_TRIANGLE, class, i, ray, triangle);
    }
}

void hpt_draw_pair(hpt_random *random, hp_pair pair, hpt_class class, unsigned i, float *primary, float *secondary) {
    hp_object a = hp_pair_primary(pair), b = hp_pair_secondary(pair);
    if (a == HP_RAY && b == HP_TRIANGLE)
        draw_ray_triangle(random, class, i, primary, secondary);
    else
        hpt_draw_objects(random, a, b, class, i, primary, secondary);
}
