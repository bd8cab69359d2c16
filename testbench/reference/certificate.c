/* Bounds in binary128 from what a search has found, whatever it has found: nothing here trusts it. */
#define HPT_SEARCH_TEXT "search_vector.h"
#include "search_numbers.h"

typedef hp_quad quad;

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

hpt_bounds hpt_certify(const hpt_body *body, double scale, const hpt_search *found) {
    in_quad_body scaled;
    in_quad_read_body(body, scale, &scaled);
    quad point = point_bound(&scaled, found), ball = ball_bound(&scaled, found);
    return (hpt_bounds){lower_bound(&scaled, found->direction), ball < point ? ball : point};
}
