#include "signed_distance.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "search.h"

/* In units of the body's size: what a search is content with, what it takes for flat, what rounding can do. */
#define HPT_TOLERANCE ((REAL)2e-10)
#define HPT_THIN ((REAL)1e-10)

#define HPT_PASTE_(a, b) a##_##b
#define HPT_PASTE(a, b) HPT_PASTE_(a, b)
#define HPT_NAMED(word) HPT_PASTE(HPT_TYPE, word)

static double in_double_root(double square) {
    return sqrt(square);
}
#define HPT_TYPE in_double
#define REAL double
#define HPT_EPSILON 2e-15
#include "search_body.h"
#undef HPT_TYPE
#undef REAL
#undef HPT_EPSILON

static hp_quad in_quad_root(hp_quad square) {
    return hpt_root(square);
}
#define HPT_TYPE in_quad
#define REAL hp_quad
#define HPT_EPSILON ((hp_quad)1e-31)
#include "search_body.h"

typedef hp_quad quad;

/* ---- the certificate, in binary128 ---- */

/* -h(d) of the unit vector along d. */
static quad lower_bound(const in_quad_body *body, const quad direction[3]) {
    in_quad_vertex w;
    quad length = hpt_root(in_quad_dot(direction, direction));
    return length > 0 ? -in_quad_support(body, direction, &w) / length : -INFINITY;
}

/* Distance of the weighted point, its weights made to add up to 1. */
static quad point_bound(const in_quad_body *body, const hpt_search *found) {
    quad sum = 0, point[3] = {0}, corner[3];
    for (unsigned i = 0; i < found->members; i++) sum += found->weight[i];
    for (unsigned i = 0; i < found->members; i++) {
        in_quad_find_corner(body, &found->member[i], corner);
        in_quad_add_scaled(point, found->weight[i] / sum, corner);
    }
    return hpt_root(in_quad_dot(point, point));
}

typedef struct surface {
    unsigned corners, faces;
    quad (*at)[3];
    const unsigned (*face)[3];
} surface;

static void triangle_of(const surface *s, unsigned f, const quad *p[3]) {
    for (int i = 0; i < 3; i++) p[i] = s->at[s->face[f][i]];
}

static int by_edge(const void *a, const void *b) {
    return memcmp(a, b, 2 * sizeof(unsigned));
}

/* Whether each edge is passed once in each direction. */
static bool is_closed(const surface *s) {
    typedef unsigned edge[2];
    unsigned n = 3 * s->faces;
    edge *forth = malloc(n * sizeof *forth), *back = malloc(n * sizeof *back);
    if (!forth || !back) abort();
    for (unsigned f = 0; f < s->faces; f++)
        for (unsigned i = 0; i < 3; i++) {
            unsigned a = s->face[f][i], b = s->face[f][(i + 1) % 3];
            forth[3 * f + i][0] = back[3 * f + i][1] = a;
            forth[3 * f + i][1] = back[3 * f + i][0] = b;
        }
    qsort(forth, n, sizeof *forth, by_edge);
    qsort(back, n, sizeof *back, by_edge);
    bool closed = memcmp(forth, back, n * sizeof *forth) == 0;
    free(forth), free(back);
    return closed;
}

/* How often the surface goes round the origin: its crossings with a ray from there that, but for ill luck, meets no
 * edge: with it the answer is 99. */
static int turns(const surface *s) {
    const quad ray[3] = {(quad)0.36180339887, (quad)0.57721566490, (quad)0.73205080757};
    int crossings = 0;
    for (unsigned f = 0; f < s->faces; f++) {
        const quad *p[3];
        quad n[3], ab[3], ac[3];
        int left = 0, right = 0;
        triangle_of(s, f, p);
        for (int i = 0; i < 3; i++) {
            in_quad_cross(p[i], p[(i + 1) % 3], n);
            quad side = in_quad_dot(n, ray);
            left += side > 0;
            right += side < 0;
        }
        if (left && right) continue;
        in_quad_sub(p[1], p[0], ab);
        in_quad_sub(p[2], p[0], ac);
        in_quad_cross(ab, ac, n);
        if (in_quad_dot(n, p[0]) * in_quad_dot(n, ray) <= 0) continue;
        if (left + right < 3) return 99;
        crossings += left ? 1 : -1;
    }
    return crossings;
}

/* The least distance of a face from the origin. In double first: what lies 1e-6 above the least is not it. */
static quad least_distance(const surface *s) {
    double(*at)[3] = malloc(s->corners * sizeof *at), *distance = malloc(s->faces * sizeof *distance), least = 4;
    if (!at || !distance) abort();
    for (unsigned i = 0; i < s->corners; i++)
        for (int k = 0; k < 3; k++) at[i][k] = (double)s->at[i][k];
    for (unsigned f = 0; f < s->faces; f++) {
        const double *p[3] = {at[s->face[f][0]], at[s->face[f][1]], at[s->face[f][2]]};
        double weight[4], nearest[3];
        unsigned used;
        distance[f] = sqrt(in_double_nearest_of(p, 3, weight, &used, nearest));
        least = fmin(least, distance[f]);
    }
    quad result = 4;
    for (unsigned f = 0; f < s->faces; f++) {
        const quad *p[3];
        quad weight[4], nearest[3];
        unsigned used;
        if (distance[f] > least + 1e-6) continue;
        triangle_of(s, f, p);
        quad exact = hpt_root(in_quad_nearest_of(p, 3, weight, &used, nearest));
        if (exact < result) result = exact;
    }
    free(at), free(distance);
    return result;
}

/* Minus the radius of a ball about the origin that the surface goes round, or +inf. */
static quad ball_bound(const in_quad_body *body, const hpt_search *found) {
    if (!found->faces) return INFINITY;
    surface s = {.corners = found->corners, .faces = found->faces, .face = found->face};
    s.at = malloc(s.corners * sizeof *s.at);
    if (!s.at) abort();
    for (unsigned i = 0; i < s.corners; i++) in_quad_find_corner(body, &found->corner[i], s.at[i]);
    quad bound = is_closed(&s) && turns(&s) == 1 ? -least_distance(&s) : (quad)INFINITY;
    free(s.at);
    return bound;
}

typedef struct bounds {
    quad lower, upper;
} bounds;

static bounds certify(const in_quad_body *body, const hpt_search *found) {
    quad point = point_bound(body, found), ball = ball_bound(body, found);
    return (bounds){lower_bound(body, found->direction), ball < point ? ball : point};
}

/* ---- both searches ---- */

/* How far the body reaches from the origin, or farther. */
static quad size_of(const hpt_body *body) {
    quad most = 0, sum = 0;
    for (unsigned i = 0; i < body->points; i++) {
        quad arm = hpt_root(in_quad_dot(body->point[i], body->point[i]));
        if (arm > most) most = arm;
    }
    for (unsigned i = 0; i < body->segments; i++) sum += hpt_root(in_quad_dot(body->segment[i], body->segment[i]));
    for (unsigned i = 0; i < body->discs; i++) sum += body->disc[i].radius;
    return most + sum;
}

static void unit(const quad a[3], double to[3]) {
    quad length = hpt_root(in_quad_dot(a, a));
    for (int k = 0; k < 3; k++) to[k] = (double)(a[k] / length);
}

hpt_distance hpt_signed_distance(const hpt_body *body) {
    quad size = size_of(body), whole = size + body->ball;
    if (size == 0) return (hpt_distance){-(double)body->ball, 0, (double)whole, {1, 0, 0}, true, false};
    int exponent;
    frexp((double)size, &exponent);
    quad scale = ldexp(1, -exponent);
    hpt_search *found = malloc(sizeof *found);
    in_quad_body scaled;
    if (!found) abort();
    in_quad_read_body(body, scale, &scaled);
    hpt_distance result = {.size = (double)whole};
    double allowed = 1e-9 * (double)(whole * scale);
    in_double_search(body, scale, found);
    bounds b = certify(&scaled, found);
    if (!(b.upper - b.lower <= allowed)) {
        in_quad_search(body, scale, found);
        b = certify(&scaled, found);
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
    in_double_body d;
    in_double_simplex simplex;
    double direction[3];
    int exponent;
    frexp((double)size_of(body), &exponent);
    in_double_read_body(body, ldexp(1, -exponent), &d);
    in_double_find_nearest(&d, &simplex, direction);
    return fmax(0, ldexp(simplex.length, exponent) - (double)body->ball);
}
