#include "cast.h"

#include <math.h>
#include <string.h>

typedef hp_quad quad;

static quad dot(const quad a[3], const quad b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static quad absolute(quad a) {
    return a < 0 ? -a : a;
}

typedef struct solid {
    quad centre[3], radius, origin[3], direction[3];
    bool capped;
    quad axis[3], half; /* of a cylinder: unit, half the height */
} solid;

static solid read_solid(const float ray[6], hp_object object, const float *words) {
    solid s = {.capped = object == HP_CYLINDER};
    hpt_body body = hpt_body_of(object, words);
    memcpy(s.centre, body.point[0], sizeof s.centre);
    s.radius = s.capped ? body.disc[0].radius : body.ball;
    if (s.capped) {
        memcpy(s.axis, body.disc[0].axis, sizeof s.axis);
        s.half = hpt_root(dot(body.segment[0], body.segment[0]));
    }
    for (int i = 0; i < 3; i++) {
        s.origin[i] = (quad)ray[i] - s.centre[i];
        s.direction[i] = ray[3 + i];
    }
    return s;
}

/* How far the point at t is outside the round side and outside the caps; and its arm from the axis or centre. */
static void outside(const solid *s, quad t, quad *side, quad *caps, quad arm[3]) {
    quad along = 0;
    for (int i = 0; i < 3; i++) arm[i] = s->origin[i] + t * s->direction[i];
    if (s->capped) along = dot(arm, s->axis);
    for (int i = 0; i < 3; i++) arm[i] -= along * s->axis[i];
    *side = hpt_root(dot(arm, arm)) - s->radius;
    *caps = s->capped ? absolute(along) - s->half : (quad)-INFINITY;
}

static quad g(const solid *s, quad t) {
    quad side, caps, arm[3];
    outside(s, t, &side, &caps, arm);
    return side > caps ? side : caps;
}

/* A t in [0, most] with g(t) <= 0, by the golden section; false when there is none to be found. */
static bool find_inside(const solid *s, quad most, quad *t) {
    const quad golden = (quad)0.61803398874989484820L;
    quad low = 0, high = most, a = high - golden * (high - low), b = low + golden * (high - low);
    quad at_a = g(s, a), at_b = g(s, b);
    for (int step = 0; step < 160; step++) {
        *t = at_a < at_b ? a : b;
        if (at_a <= 0 || at_b <= 0) return true;
        if (at_a < at_b) {
            high = b, b = a, at_b = at_a;
            a = high - golden * (high - low), at_a = g(s, a);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + golden * (high - low), at_b = g(s, b);
        }
    }
    return false;
}

static double cosine_at(const solid *s, quad t, double band) {
    quad side, caps, arm[3], length = hpt_root(dot(s->direction, s->direction));
    outside(s, t, &side, &caps, arm);
    quad radius = hpt_root(dot(arm, arm)), least = 1;
    if (side >= -band && radius > 0) least = absolute(dot(arm, s->direction)) / (radius * length);
    if (caps >= -band) {
        quad cap = absolute(dot(s->axis, s->direction)) / length;
        if (cap < least) least = cap;
    }
    return (double)least;
}

hpt_entry hpt_cast(const float ray[6], hp_object object, const float *words, quad reach, double band) {
    solid s = read_solid(ray, object, words);
    hpt_entry entry = {.cosine = 1};
    quad low = 0, high = 0, length = hpt_root(dot(s.direction, s.direction));
    entry.meets = g(&s, 0) <= 0 || find_inside(&s, reach / length, &high);
    if (!entry.meets) return entry;
    for (int step = 0; step < 100 && high > 0; step++) {
        quad middle = (low + high) / 2;
        if (g(&s, middle) <= 0)
            high = middle;
        else
            low = middle;
    }
    if (high > 0) entry.cosine = cosine_at(&s, high, band);
    entry.t = high;
    for (int i = 0; i < 3; i++) entry.CP[i] = (quad)ray[i] + high * (quad)ray[3 + i];
    return entry;
}
