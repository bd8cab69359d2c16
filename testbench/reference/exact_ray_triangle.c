#include "exact_ray_triangle.h"

#include <math.h>

#include "exact_vector.h"

/* Ray and triangle as rationals, with what both questions need. */
typedef struct pair {
    hpt_q3 O, D;    /* the ray */
    hpt_q3 v[3];    /* the triangle */
    hpt_q3 edge[3]; /* v[i+1] - v[i] */
    hpt_q3 N;       /* edge[0] x edge[1] = (v1 - v0) x (v2 - v0) */
    mpq_t slope;    /* N.D */
    mpq_t height;   /* N.(v0 - O) */
} pair;

static void pair_read(pair *p, const float ray[6], const float triangle[9]) {
    hpt_q3 to_plane;
    hpt_q3_init(&p->O), hpt_q3_init(&p->D), hpt_q3_init(&p->N), hpt_q3_init(&to_plane);
    hpt_q3_read(&p->O, ray), hpt_q3_read(&p->D, ray + 3);
    for (int i = 0; i < 3; i++) {
        hpt_q3_init(&p->v[i]), hpt_q3_init(&p->edge[i]);
        hpt_q3_read(&p->v[i], triangle + 3 * i);
    }
    for (int i = 0; i < 3; i++) hpt_q3_sub(&p->edge[i], &p->v[(i + 1) % 3], &p->v[i]);
    hpt_q3_cross(&p->N, &p->edge[0], &p->edge[1]);
    mpq_inits(p->slope, p->height, NULL);
    hpt_q3_dot(p->slope, &p->N, &p->D);
    hpt_q3_sub(&to_plane, &p->v[0], &p->O);
    hpt_q3_dot(p->height, &p->N, &to_plane);
    hpt_q3_clear(&to_plane);
}

static void pair_clear(pair *p) {
    hpt_q3_clear(&p->O), hpt_q3_clear(&p->D), hpt_q3_clear(&p->N);
    for (int i = 0; i < 3; i++) hpt_q3_clear(&p->v[i]), hpt_q3_clear(&p->edge[i]);
    mpq_clears(p->slope, p->height, NULL);
}

/* Whether the foot of x on the plane lies in the triangle: on the inner side of each edge, or on it. N is not 0. */
static bool over_face(const pair *p, const hpt_q3 *x) {
    hpt_q3 from, side;
    mpq_t inner;
    hpt_q3_init(&from), hpt_q3_init(&side), mpq_init(inner);
    bool inside = true;
    for (int i = 0; i < 3 && inside; i++) {
        hpt_q3_sub(&from, x, &p->v[i]);
        hpt_q3_cross(&side, &p->edge[i], &from);
        hpt_q3_dot(inner, &p->N, &side);
        inside = mpq_sgn(inner) >= 0;
    }
    hpt_q3_clear(&from), hpt_q3_clear(&side), mpq_clear(inner);
    return inside;
}

static hpt_crossing cross(const pair *p) {
    hpt_crossing answer = {0};
    if (mpq_sgn(p->slope) == 0) return answer;
    mpq_t t;
    hpt_q3 point;
    mpq_init(t), hpt_q3_init(&point);
    mpq_div(t, p->height, p->slope);
    hpt_q3_add_scaled(&point, &p->O, t, &p->D);
    answer.crosses = true;
    answer.F = mpq_sgn(t) >= 0 && over_face(p, &point);
    answer.T = mpq_get_d(t);
    for (int i = 0; i < 3; i++) answer.CP[i] = mpq_get_d(point.of[i]);
    mpq_clear(t), hpt_q3_clear(&point);
    return answer;
}

hpt_crossing hpt_exact_ray_triangle(const float ray[6], const float triangle[9]) {
    pair p;
    pair_read(&p, ray, triangle);
    hpt_crossing answer = cross(&p);
    pair_clear(&p);
    return answer;
}

/* ---- distances, squared
 * ---------------------------------------------------------------------------------------------- */

static void keep_least(mpq_t least, const mpq_t candidate) {
    if (mpq_cmp(candidate, least) < 0) mpq_set(least, candidate);
}

/* to = |x - (a + k b)|^2 with the k that makes it least: any k on a line, k >= 0 on a ray, k in [0, 1] on a segment.
 */
static void point_to_span(mpq_t to, const hpt_q3 *x, const hpt_q3 *a, const hpt_q3 *b, bool line, bool segment) {
    hpt_q3 from;
    mpq_t k, bb;
    hpt_q3_init(&from), mpq_inits(k, bb, NULL);
    hpt_q3_sub(&from, x, a);
    hpt_q3_dot(k, &from, b);
    hpt_q3_dot(bb, b, b);
    if (mpq_sgn(bb) != 0) mpq_div(k, k, bb);
    if (!line && mpq_sgn(k) < 0) mpq_set_ui(k, 0, 1);
    if (segment && mpq_cmp_ui(k, 1, 1) > 0) mpq_set_ui(k, 1, 1);
    mpq_neg(k, k);
    hpt_q3_add_scaled(&from, &from, k, b);
    hpt_q3_dot(to, &from, &from);
    hpt_q3_clear(&from), mpq_clears(k, bb, NULL);
}

/* Lowers *least to the squared distance between the inside of edge i and the inside of the ray (or its whole line),
 * where the common perpendicular of the two ends in both. Ends of either are another candidate's business. */
static void edge_perpendicular(mpq_t least, const pair *p, int i, bool line) {
    hpt_q3 n, w, c;
    mpq_t nn, t, s, d;
    hpt_q3_init(&n), hpt_q3_init(&w), hpt_q3_init(&c), mpq_inits(nn, t, s, d, NULL);
    hpt_q3_cross(&n, &p->D, &p->edge[i]);
    hpt_q3_dot(nn, &n, &n);
    hpt_q3_sub(&w, &p->v[i], &p->O);
    hpt_q3_cross(&c, &w, &p->edge[i]);
    hpt_q3_dot(t, &c, &n);
    hpt_q3_cross(&c, &w, &p->D);
    hpt_q3_dot(s, &c, &n); /* t and s times n.n: where the perpendicular meets line and edge */
    bool meets = mpq_sgn(nn) != 0 && (line || mpq_sgn(t) >= 0) && mpq_sgn(s) >= 0 && mpq_cmp(s, nn) <= 0;
    if (meets) {
        hpt_q3_dot(d, &w, &n);
        mpq_mul(d, d, d);
        mpq_div(d, d, nn);
        keep_least(least, d);
    }
    hpt_q3_clear(&n), hpt_q3_clear(&w), hpt_q3_clear(&c), mpq_clears(nn, t, s, d, NULL);
}

/* Lowers *least to the squared distance of the ray (or its line) from the triangle's three edges. */
static void outline(mpq_t least, const pair *p, bool line) {
    mpq_t d;
    mpq_init(d);
    for (int i = 0; i < 3; i++) {
        point_to_span(d, &p->v[i], &p->O, &p->D, line, false);
        keep_least(least, d);
        edge_perpendicular(least, p, i, line);
        if (line) continue;
        point_to_span(d, &p->O, &p->v[i], &p->edge[i], false, true);
        keep_least(least, d);
    }
    mpq_clear(d);
}

/* The margin, squared. A hit ends at an edge, or at t = 0; a miss is as far as the nearest of the edges, or as the
 * origin is from the face below it. Where the origin is not over the face, an edge is nearer than the plane in both
 * cases. */
static void square_margin(mpq_t least, const pair *p, bool hit) {
    mpq_t d, nn;
    mpq_inits(d, nn, NULL);
    point_to_span(least, &p->v[0], &p->O, &p->D, hit, false);
    outline(least, p, hit);
    hpt_q3_dot(nn, &p->N, &p->N);
    if (mpq_sgn(nn) != 0 && over_face(p, &p->O)) {
        mpq_mul(d, p->height, p->height);
        mpq_div(d, d, nn);
        keep_least(least, d);
    }
    mpq_clears(d, nn, NULL);
}

/* ---- scales
 * ---------------------------------------------------------------------------------------------------------- */

static double root(const mpq_t square) {
    return sqrt(mpq_get_d(square));
}

/* |N.D| / (|N| |D|) */
static double cosine(const pair *p) {
    mpq_t nn, dd, square;
    mpq_inits(nn, dd, square, NULL);
    hpt_q3_dot(nn, &p->N, &p->N);
    hpt_q3_dot(dd, &p->D, &p->D);
    mpq_mul(nn, nn, dd);
    mpq_mul(square, p->slope, p->slope);
    if (mpq_sgn(nn) != 0) mpq_div(square, square, nn);
    double result = root(square);
    mpq_clears(nn, dd, square, NULL);
    return result;
}

/* Radius about the centroid, and from there to the ray. */
static double extent(const pair *p) {
    hpt_q3 centre, arm;
    mpq_t third, d, radius;
    hpt_q3_init(&centre), hpt_q3_init(&arm), mpq_inits(third, d, radius, NULL);
    mpq_set_ui(third, 1, 3);
    for (int i = 0; i < 3; i++) hpt_q3_add_scaled(&centre, &centre, third, &p->v[i]);
    for (int i = 0; i < 3; i++) {
        hpt_q3_sub(&arm, &p->v[i], &centre);
        hpt_q3_dot(d, &arm, &arm);
        if (mpq_cmp(d, radius) > 0) mpq_set(radius, d);
    }
    point_to_span(d, &centre, &p->O, &p->D, false, false);
    double result = root(radius) + root(d);
    hpt_q3_clear(&centre), hpt_q3_clear(&arm), mpq_clears(third, d, radius, NULL);
    return result;
}

hpt_ray_triangle_scale hpt_scale_ray_triangle(const float ray[6], const float triangle[9]) {
    pair p;
    mpq_t square;
    pair_read(&p, ray, triangle);
    mpq_init(square);
    hpt_ray_triangle_scale scale = {.L = extent(&p), .cosine = cosine(&p)};
    hpt_q3_dot(square, &p.D, &p.D);
    scale.direction = root(square);
    for (int i = 0; i < 3; i++) scale.C = fmax(scale.C, fabs(ray[i]));
    for (int i = 0; i < 9; i++) scale.C = fmax(scale.C, fabs(triangle[i]));
    mpq_clear(square);
    pair_clear(&p);
    return scale;
}

double hpt_margin_ray_triangle(const float ray[6], const float triangle[9]) {
    pair p;
    mpq_t square;
    pair_read(&p, ray, triangle);
    mpq_init(square);
    bool hit = cross(&p).F;
    square_margin(square, &p, hit);
    double margin = hit ? root(square) : -root(square);
    mpq_clear(square);
    pair_clear(&p);
    return margin;
}

double hpt_band(const hpt_ray_triangle_scale *scale) {
    return fmax(1e-6 * scale->L, 0x1p-21 * scale->C);
}

double hpt_T_error(const hpt_crossing *exact, const hpt_ray_triangle_scale *scale, float T) {
    return fabs(T - exact->T) * scale->direction * scale->cosine / fmax(scale->L, scale->C);
}

double hpt_CP_error(const hpt_crossing *exact, const hpt_ray_triangle_scale *scale, const float CP[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++) square += (CP[i] - exact->CP[i]) * (CP[i] - exact->CP[i]);
    return sqrt(square) * scale->cosine / fmax(scale->L, scale->C);
}
