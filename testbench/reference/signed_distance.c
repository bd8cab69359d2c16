#include "signed_distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "search.h"

typedef hp_quad quad;

static quad length_of(const quad a[3]) {
    return hpt_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* How far the body, but for its ball, reaches from the origin, or farther. */
static quad size_of(const hpt_body *body) {
    quad most = 0, sum = 0;
    for (unsigned i = 0; i < body->points; i++) {
        quad arm = length_of(body->point[i]);
        if (arm > most) most = arm;
    }
    for (unsigned i = 0; i < body->segments; i++) sum += length_of(body->segment[i]);
    for (unsigned i = 0; i < body->discs; i++) sum += body->disc[i].radius;
    return most + sum;
}

static int exponent_of(const hpt_body *body) {
    int exponent;
    frexp((double)size_of(body), &exponent);
    return exponent;
}

static void unit(const quad a[3], double to[3]) {
    quad length = length_of(a);
    for (int k = 0; k < 3; k++) to[k] = (double)(a[k] / length);
}

/* ---- bodies that are round about an axis near the origin ---- */

static void move(hpt_body *body, quad k, const quad by[3]) {
    for (unsigned i = 0; i < body->points; i++)
        for (int j = 0; j < 3; j++) body->point[i][j] += k * by[j];
}

/* Takes the discs off that are parallel to the first; returns the sum of their radii, less what their tilt may cost.
 */
static quad take_discs(hpt_body *body, quad axis[3]) {
    unsigned kept = 0;
    quad radius = 0;
    memcpy(axis, body->disc[0].axis, sizeof body->disc[0].axis);
    for (unsigned i = 0; i < body->discs; i++) {
        const quad *u = body->disc[i].axis;
        quad tilt[3];
        for (int k = 0; k < 3; k++) tilt[k] = u[(k + 1) % 3] * axis[(k + 2) % 3] - u[(k + 2) % 3] * axis[(k + 1) % 3];
        if (length_of(tilt) < 1e-9)
            radius += body->disc[i].radius * (1 - length_of(tilt));
        else
            body->disc[kept++] = body->disc[i];
    }
    body->discs = kept;
    return radius;
}

/* No less than how far the origin is from the body; at least 0. */
static quad distance_bound(const hpt_body *body, double scale, hpt_search *found) {
    hpt_search_in_double(body, scale, found);
    quad upper = hpt_certify(body, scale, found).upper;
    return upper > 0 ? upper / scale : 0;
}

/* Where the depth is the same all round a circle, a surface of triangles needs too many of them. But if the body
 * without its discs, of radius R, holds x + R u and x - R u to within e, u being their axis, then its support is at
 * least x.d + R |d.u| + R |d - (d.u) u| - e, and minus its signed distance at least R - |x| - e. x is the point of
 * the rest nearest to the origin. */
static quad round_bound(const hpt_body *body, double scale, hpt_search *found) {
    if (!body->discs) return INFINITY;
    hpt_body rest = *body;
    quad axis[3], x[3] = {0}, radius = take_discs(&rest, axis), away = distance_bound(&rest, scale, found), off = 0;
    quad length = length_of(found->direction);
    for (int k = 0; k < 3 && away > 0; k++) x[k] = -away * found->direction[k] / length;
    move(&rest, -1, x);
    for (int sign = -1; sign <= 1; sign += 2) {
        move(&rest, sign * radius, axis);
        quad e = distance_bound(&rest, scale, found);
        move(&rest, -sign * radius, axis);
        if (e > off) off = e;
    }
    return (length_of(x) + off - radius) * scale;
}

/* ---- both searches ---- */

hpt_distance hpt_signed_distance(const hpt_body *body) {
    quad size = size_of(body) + body->ball;
    if (size == body->ball) return (hpt_distance){-(double)body->ball, 0, (double)size, {1, 0, 0}, true, false};
    double scale = ldexp(1, -exponent_of(body)), allowed = 1e-9 * (double)(size * scale);
    hpt_search *found = malloc(sizeof *found);
    if (!found) abort();
    hpt_distance result = {.size = (double)size};
    hpt_search_in_double(body, scale, found);
    hpt_bounds b = hpt_certify(body, scale, found);
    unit(found->direction, result.direction);
    /* A hull that has run out of corners follows an arc about the origin, which more digits make no shorter. */
    if (!(b.upper - b.lower <= allowed) && found->corners == HPT_VERTICES) {
        quad round = round_bound(body, scale, found);
        if (round < b.upper) b.upper = round;
    } else if (!(b.upper - b.lower <= allowed)) {
        hpt_search_in_quad(body, scale, found);
        b = hpt_certify(body, scale, found);
        unit(found->direction, result.direction);
        result.in_quad = true;
    }
    result.value = (double)(b.lower / scale - body->ball);
    result.gap = (double)((b.upper - b.lower) / scale);
    result.certified = b.upper - b.lower <= allowed;
    free(found);
    return result;
}

double hpt_quick_distance(const hpt_body *body) {
    int exponent = exponent_of(body);
    double length = ldexp(hpt_search_nearest(body, ldexp(1, -exponent)), exponent);
    return fmax(0, length - (double)body->ball);
}
