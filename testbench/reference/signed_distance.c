#include "signed_distance.h"

#include <math.h>
#include <stdlib.h>

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

hpt_distance hpt_signed_distance(const hpt_body *body) {
    quad size = size_of(body) + body->ball;
    if (size == body->ball) return (hpt_distance){-(double)body->ball, 0, (double)size, {1, 0, 0}, true, false};
    double scale = ldexp(1, -exponent_of(body)), allowed = 1e-9 * (double)(size * scale);
    hpt_search *found = malloc(sizeof *found);
    if (!found) abort();
    hpt_distance result = {.size = (double)size};
    hpt_search_in_double(body, scale, found);
    hpt_bounds b = hpt_certify(body, scale, found);
    /* A hull that has run out of corners follows an arc about the origin, which more digits make no shorter. */
    if (!(b.upper - b.lower <= allowed) && found->corners < HPT_VERTICES) {
        hpt_search_in_quad(body, scale, found);
        b = hpt_certify(body, scale, found);
        result.in_quad = true;
    }
    result.value = (double)(b.lower / scale - body->ball);
    result.gap = (double)((b.upper - b.lower) / scale);
    result.certified = b.upper - b.lower <= allowed;
    unit(found->direction, result.direction);
    free(found);
    return result;
}

double hpt_quick_distance(const hpt_body *body) {
    int exponent = exponent_of(body);
    double length = ldexp(hpt_search_nearest(body, ldexp(1, -exponent)), exponent);
    return fmax(0, length - (double)body->ball);
}
