#include "truth.h"

#include <math.h>
#include <string.h>

#include "cast.h"
#include "exact_ray_triangle.h"
#include "signed_distance.h"

typedef hp_quad quad;

static quad dot(const quad a[3], const quad b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void sub(const quad a[3], const quad b[3], quad to[3]) {
    for (int i = 0; i < 3; i++) to[i] = a[i] - b[i];
}

/* ---- scales ---- */

/* The largest absolute coordinate of an object's points. */
static double coordinate_of(hp_object object, const float *words) {
    static const unsigned points[] = {
        [HP_RAY] = 1, [HP_TRIANGLE] = 3, [HP_SPHERE] = 1, [HP_AABB] = 2, [HP_OBB] = 1, [HP_CYLINDER] = 2};
    if (object == HP_PLANE) return fabs((double)words[3]);
    double most = 0;
    for (unsigned i = 0; i < 3 * points[object]; i++) most = fmax(most, fabs((double)words[i]));
    return most;
}

/* How far a ray passes from a point. */
static quad approach(const float ray[6], const quad point[3]) {
    quad from[3], along[3];
    for (int i = 0; i < 3; i++) {
        from[i] = point[i] - ray[i];
        along[i] = ray[3 + i];
    }
    quad t = dot(from, along) / dot(along, along);
    for (int i = 0; i < 3; i++) from[i] -= t > 0 ? t * along[i] : 0;
    return hpt_root(dot(from, from));
}

/* n.x - d of a point, over |n|. */
static quad height_over(const float plane[4], const quad point[3]) {
    quad n[3] = {plane[0], plane[1], plane[2]};
    return (dot(n, point) - plane[3]) / hpt_root(dot(n, n));
}

static double extent_of(hp_object a, hp_object b, const float *p, const float *s) {
    quad centre[3], other[3], between[3];
    quad radius = hpt_bounding_ball(a, p, centre), more = hpt_bounding_ball(b, s, other);
    if (a == HP_RAY) return (double)(more + approach(p, other));
    if (b == HP_PLANE) {
        quad height = height_over(s, centre);
        return (double)(radius + (height < 0 ? -height : height));
    }
    sub(centre, other, between);
    return (double)(radius + more + hpt_root(dot(between, between)));
}

/* ---- answers ---- */

static void keep_distance(hpt_truth *truth, const hpt_distance *distance) {
    truth->signed_distance = distance->value;
    truth->gap = distance->gap;
    truth->certified = distance->certified;
    truth->F = distance->value <= 0;
    memcpy(truth->direction, distance->direction, sizeof truth->direction);
}

static void between_bodies(hpt_truth *truth, hp_object a, hp_object b, const float *p, const float *s) {
    hpt_body first = hpt_body_of(a, p), second = hpt_body_of(b, s), difference = hpt_difference(&first, &second);
    hpt_distance distance = hpt_signed_distance(&difference);
    keep_distance(truth, &distance);
}

/* A plane is infinite, so only its normal can lead apart: h of the body along it, less the height of its centre. */
static void body_and_plane(hpt_truth *truth, hp_object a, const float *p, const float plane[4]) {
    hpt_body body = hpt_body_of(a, p);
    quad n[3] = {plane[0], plane[1], plane[2]}, length = hpt_root(dot(n, n)), most = -INFINITY, least = INFINITY;
    quad reach = body.ball;
    for (unsigned i = 0; i < body.segments; i++) {
        quad along = dot(n, body.segment[i]) / length;
        reach += along < 0 ? -along : along;
    }
    for (unsigned i = 0; i < body.points; i++) {
        quad height = height_over(plane, body.point[i]);
        if (height > most) most = height;
        if (height < least) least = height;
    }
    bool above = least + most > 0;
    quad value = above ? least - reach : -most - reach;
    hpt_distance distance = {.value = (double)value, .certified = true};
    for (int k = 0; k < 3; k++) distance.direction[k] = (double)(n[k] / length) * (above ? -1 : 1);
    keep_distance(truth, &distance);
}

static void ray_and_solid(hpt_truth *truth, hp_object solid, const float *ray, const float *s) {
    quad centre[3], from[3], origin[3] = {ray[0], ray[1], ray[2]};
    quad radius = hpt_bounding_ball(solid, s, centre);
    sub(centre, origin, from);
    quad reach = hpt_root(dot(from, from)) + radius;
    hpt_body first = hpt_body_of_ray(ray, reach), second = hpt_body_of(solid, s);
    hpt_body difference = hpt_difference(&first, &second);
    hpt_distance distance = hpt_signed_distance(&difference);
    keep_distance(truth, &distance);
    if (truth->signed_distance > truth->gap + 1e-9 * truth->L) return;
    hpt_entry entry = hpt_cast(ray, solid, s, reach, truth->band);
    truth->F = truth->crosses = entry.meets;
    truth->t = (double)entry.t;
    truth->cosine = entry.cosine;
    for (int i = 0; i < 3; i++) truth->CP[i] = (double)entry.CP[i];
}

static void ray_and_triangle(hpt_truth *truth, const float *ray, const float *triangle) {
    hpt_crossing exact = hpt_exact_ray_triangle(ray, triangle);
    truth->F = exact.F;
    truth->crosses = exact.crosses;
    truth->t = exact.T;
    memcpy(truth->CP, exact.CP, sizeof truth->CP);
    truth->cosine = hpt_scale_ray_triangle(ray, triangle).cosine;
    truth->signed_distance = -hpt_margin_ray_triangle(ray, triangle);
    truth->certified = true;
}

hpt_truth hpt_truth_between(hp_object a, hp_object b, const float *p, const float *s) {
    hpt_truth truth = {.cosine = 1, .length = 1};
    truth.C = fmax(coordinate_of(a, p), coordinate_of(b, s));
    truth.L = extent_of(a, b, p, s);
    truth.band = fmax(1e-6 * truth.L, 0x1p-21 * truth.C);
    if (a == HP_RAY) {
        quad direction[3] = {p[3], p[4], p[5]};
        truth.length = (double)hpt_root(dot(direction, direction));
    }
    if (a == HP_RAY && b == HP_TRIANGLE)
        ray_and_triangle(&truth, p, s);
    else if (a == HP_RAY)
        ray_and_solid(&truth, b, p, s);
    else if (b == HP_PLANE)
        body_and_plane(&truth, a, p, s);
    else
        between_bodies(&truth, a, b, p, s);
    return truth;
}

hpt_truth hpt_truth_of(hp_pair pair, const float *primary, const float *secondary) {
    return hpt_truth_between(hp_pair_primary(pair), hp_pair_secondary(pair), primary, secondary);
}

double hpt_distance_to(hp_object object, const float *words, const double point[3]) {
    quad at[3] = {point[0], point[1], point[2]};
    if (object == HP_PLANE) return fabs((double)height_over(words, at));
    hpt_body body = hpt_body_of(object, words), here = hpt_body_of_point(at),
             difference = hpt_difference(&here, &body);
    return hpt_quick_distance(&difference);
}
