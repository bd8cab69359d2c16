#include "body.h"

#include <math.h>
#include <string.h>

typedef hp_quad quad;

quad hpt_root(quad square) {
    if (!(square > 0)) return 0;
    quad root = sqrt((double)square);
    if (root == 0) return 0;
    for (int i = 0; i < 3; i++) root = (root + square / root) / 2;
    return root;
}

static quad dot(const quad a[3], const quad b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const quad a[3], const quad b[3], quad to[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        to[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static void read3(const float *words, quad to[3]) {
    for (int i = 0; i < 3; i++) to[i] = words[i];
}

static quad half(quad a) {
    return a / 2;
}

/* X becomes (X + X^-T) / 2; returns the largest change. Rows of X^-T are the cofactors over the determinant. */
static quad newton_step(quad x[3][3]) {
    quad cofactor[3][3], most = 0;
    for (int i = 0; i < 3; i++) cross(x[(i + 1) % 3], x[(i + 2) % 3], cofactor[i]);
    quad det = dot(x[0], cofactor[0]);
    if (det == 0) return 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            quad next = half(x[i][k] + cofactor[i][k] / det), change = next - x[i][k];
            if (change < 0) change = -change;
            if (change > most) most = change;
            x[i][k] = next;
        }
    return most;
}

void hpt_nearest_frame(const float axes[9], quad frame[3][3]) {
    for (int i = 0; i < 3; i++) read3(axes + 3 * i, frame[i]);
    for (int step = 0; step < 100; step++)
        if (newton_step(frame) < 1e-30) return;
}

static void add_box(hpt_body *body, const quad centre[3], const quad extent[3], quad frame[3][3]) {
    body->points = 1;
    body->segments = 3;
    memcpy(body->point[0], centre, 3 * sizeof *centre);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) body->segment[i][k] = extent[i] * frame[i][k];
}

static void add_aabb(hpt_body *body, const float *words) {
    quad centre[3], extent[3], frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; i++) {
        centre[i] = half((quad)words[i] + words[3 + i]);
        extent[i] = half((quad)words[3 + i] - words[i]);
    }
    add_box(body, centre, extent, frame);
}

static void add_obb(hpt_body *body, const float *words) {
    quad centre[3], extent[3], frame[3][3];
    read3(words, centre);
    read3(words + 3, extent);
    hpt_nearest_frame(words + 6, frame);
    add_box(body, centre, extent, frame);
}

static void add_cylinder(hpt_body *body, const float *words) {
    body->points = body->segments = body->discs = 1;
    for (int i = 0; i < 3; i++) {
        body->point[0][i] = half((quad)words[i] + words[3 + i]);
        body->segment[0][i] = half((quad)words[3 + i] - words[i]);
    }
    quad length = hpt_root(dot(body->segment[0], body->segment[0]));
    for (int i = 0; i < 3; i++) body->disc[0].axis[i] = body->segment[0][i] / length;
    body->disc[0].radius = words[6];
}

hpt_body hpt_body_of_point(const quad at[3]) {
    hpt_body body = {.points = 1};
    memcpy(body.point[0], at, sizeof body.point[0]);
    return body;
}

hpt_body hpt_body_of(hp_object object, const float *words) {
    hpt_body body = {0};
    switch (object) {
    case HP_TRIANGLE:
        body.points = 3;
        for (int i = 0; i < 3; i++) read3(words + 3 * i, body.point[i]);
        break;
    case HP_SPHERE:
        body.points = 1;
        read3(words, body.point[0]);
        body.ball = words[3];
        break;
    case HP_AABB:
        add_aabb(&body, words);
        break;
    case HP_OBB:
        add_obb(&body, words);
        break;
    case HP_CYLINDER:
        add_cylinder(&body, words);
        break;
    case HP_RAY:
    case HP_PLANE:
        break;
    }
    return body;
}

hpt_body hpt_body_of_ray(const float ray[6], quad reach) {
    hpt_body body = {.points = 2};
    quad direction[3];
    read3(ray, body.point[0]);
    read3(ray + 3, direction);
    quad length = hpt_root(dot(direction, direction));
    for (int i = 0; i < 3; i++) body.point[1][i] = body.point[0][i] + 2 * reach * direction[i] / length;
    return body;
}

hpt_body hpt_difference(const hpt_body *a, const hpt_body *b) {
    hpt_body d = *a;
    d.points = 0;
    for (unsigned i = 0; i < a->points; i++)
        for (unsigned j = 0; j < b->points; j++, d.points++)
            for (int k = 0; k < 3; k++) d.point[d.points][k] = a->point[i][k] - b->point[j][k];
    for (unsigned i = 0; i < b->segments; i++) memcpy(d.segment[d.segments++], b->segment[i], sizeof b->segment[i]);
    for (unsigned i = 0; i < b->discs; i++) d.disc[d.discs++] = b->disc[i];
    d.ball += b->ball;
    return d;
}

static quad distance(const quad a[3], const quad b[3]) {
    quad between[3];
    for (int i = 0; i < 3; i++) between[i] = a[i] - b[i];
    return hpt_root(dot(between, between));
}

static quad triangle_ball(const float *words, quad centre[3]) {
    quad radius = 0;
    for (int k = 0; k < 3; k++) centre[k] = ((quad)words[k] + words[3 + k] + words[6 + k]) / 3;
    for (int i = 0; i < 3; i++) {
        quad v[3];
        read3(words + 3 * i, v);
        quad arm = distance(v, centre);
        if (arm > radius) radius = arm;
    }
    return radius;
}

quad hpt_bounding_ball(hp_object object, const float *words, quad centre[3]) {
    if (object == HP_TRIANGLE) return triangle_ball(words, centre);
    read3(words, centre);
    if (object == HP_RAY) return 0;
    if (object == HP_PLANE) {
        for (int i = 0; i < 3; i++) centre[i] *= words[3];
        return 0;
    }
    hpt_body body = hpt_body_of(object, words);
    memcpy(centre, body.point[0], sizeof body.point[0]);
    quad square = body.ball * body.ball;
    for (unsigned i = 0; i < body.segments; i++) square += dot(body.segment[i], body.segment[i]);
    for (unsigned i = 0; i < body.discs; i++) square += body.disc[i].radius * body.disc[i].radius;
    return hpt_root(square);
}
