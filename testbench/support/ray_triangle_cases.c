#include "ray_triangle_cases.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* ---- points
 * ---------------------------------------------------------------------------------------------------------- */

static void draw(hpt_random *random, double size, float *words, unsigned n) {
    for (unsigned i = 0; i < n; i++) words[i] = hpt_to_float(hpt_random_between(random, -size, size));
}

/* 2^-k with k drawn from [least, most). */
static double draw_power(hpt_random *random, unsigned least, unsigned most) {
    return ldexp(1, -(int)(least + hpt_random_below(random, most - least)));
}

/* v0 + u (v1 - v0) + v (v2 - v0) */
static void point_at(const float triangle[9], double u, double v, double point[3]) {
    for (int i = 0; i < 3; i++) point[i] = (1 - u - v) * triangle[i] + u * triangle[3 + i] + v * triangle[6 + i];
}

/* Barycentric coordinates inside. */
static void draw_inside(hpt_random *random, double *u, double *v) {
    *u = hpt_random_unit(random);
    *v = hpt_random_unit(random);
    if (*u + *v <= 1) return;
    *u = 1 - *u;
    *v = 1 - *v;
}

/* Turns the ray from its origin to a point, which it reaches at T = 1 / stretch. */
static void aim(float ray[6], const double point[3], double stretch) {
    for (int i = 0; i < 3; i++) ray[3 + i] = hpt_to_float((point[i] - ray[i]) * stretch);
}

static void move(float *points, unsigned n, const double by[3]) {
    for (unsigned i = 0; i < 3 * n; i++) points[i] = hpt_to_float(points[i] + by[i % 3]);
}

static void normal_of(const float triangle[9], double normal[3]) {
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
        a[i] = (double)triangle[3 + i] - triangle[i];
        b[i] = (double)triangle[6 + i] - triangle[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- coordinates about 1
 * --------------------------------------------------------------------------------------------- */

static void aim_near(hpt_random *random, unsigned i, float ray[6], const float triangle[9]) {
    double u, v, point[3];
    draw_inside(random, &u, &v);
    if (i % 2) {
        u = hpt_random_between(random, -0.5, 1.5);
        v = hpt_random_between(random, -0.5, 1.5);
    }
    point_at(triangle, u, v, point);
    aim(ray, point, hpt_random_between(random, 0.25, 4) * (i % 8 == 7 ? -1 : 1));
}

void hpt_random_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw(random, 1, triangle, 9);
    draw(random, 2, ray, 3);
    aim_near(random, i, ray, triangle);
}

static void start_near_surface(hpt_random *random, float ray[6], const float triangle[9]) {
    double u, v, point[3], normal[3];
    draw_inside(random, &u, &v);
    point_at(triangle, u, v, point);
    normal_of(triangle, normal);
    double height = draw_power(random, 8, 27);
    for (int i = 0; i < 3; i++) ray[i] = hpt_to_float(point[i] + height * normal[i]);
    draw(random, 1, ray + 3, 3);
}

void hpt_grazing_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw(random, 1, triangle, 9);
    draw(random, 2, ray, 3);
    if (i % 8 == 0) {
        start_near_surface(random, ray, triangle);
        return;
    }
    double s = i % 4 == 3 ? 0 : hpt_random_unit(random), step = draw_power(random, 8, 27) * (i % 2 ? 1 : -1);
    double corner[3] = {0}, point[3];
    corner[i % 3] = 1 - s;
    corner[(i + 1) % 3] = s;
    for (int k = 0; k < 3; k++) corner[k] += step * (1.0 / 3 - corner[k]);
    point_at(triangle, corner[1], corner[2], point);
    aim(ray, point, hpt_random_between(random, 0.25, 4));
}

void hpt_slanting_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    draw(random, 1, triangle, 9);
    double u, v, from[3], to[3], normal[3], rise = draw_power(random, 2, 15);
    draw_inside(random, &u, &v);
    point_at(triangle, u, v, to);
    u = hpt_random_between(random, -2, 3);
    v = hpt_random_between(random, -2, 3);
    point_at(triangle, u, v, from);
    normal_of(triangle, normal);
    for (int k = 0; k < 3; k++) ray[k] = hpt_to_float(from[k] + rise * normal[k]);
    aim(ray, to, i % 2 ? 1 : hpt_random_between(random, 0.25, 4));
}

void hpt_sliver_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    float line[6], aside[3];
    draw(random, 1, line, 6);
    draw(random, 1, aside, 3);
    double s = i % 2 ? hpt_random_unit(random) : 0, width = draw_power(random, 10, 18);
    for (unsigned k = 0; k < 3; k++) {
        double third = line[k] + s * ((double)line[3 + k] - line[k]) + width * aside[k];
        triangle[3 * (i % 3) + k] = line[k];
        triangle[3 * ((i + 1) % 3) + k] = line[3 + k];
        triangle[3 * ((i + 2) % 3) + k] = hpt_to_float(third);
    }
    draw(random, 2, ray, 3);
    aim_near(random, i / 2, ray, triangle);
}

static void move_away(hpt_random *random, double least, double most, float ray[6], float triangle[9]) {
    double by[3];
    for (int k = 0; k < 3; k++) {
        by[k] = hpt_random_between(random, least, most);
        if (hpt_random_below(random, 2)) by[k] = -by[k];
    }
    move(triangle, 3, by);
    move(ray, 1, by);
}

void hpt_offset_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    hpt_random_pair(random, i, ray, triangle);
    move_away(random, 1e3, 1e4, ray, triangle);
}

void hpt_far_offset_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    hpt_random_pair(random, i, ray, triangle);
    move_away(random, 1e5, 1e6, ray, triangle);
}

/* ---- whole numbers
 * --------------------------------------------------------------------------------------------------- */

static void draw_whole(hpt_random *random, int most, int factor, float *words, unsigned n) {
    for (unsigned i = 0; i < n; i++)
        words[i] = hpt_to_float(factor * ((int)hpt_random_below(random, 2 * (unsigned)most + 1) - most));
}

/* A triangle of area and a direction that crosses its plane; vertices are multiples of 8. */
static void draw_crossing(hpt_random *random, float ray[6], float triangle[9]) {
    double normal[3], direction[3];
    do {
        draw_whole(random, 7, 8, triangle, 9);
        draw_whole(random, 9, 1, ray + 3, 3);
        normal_of(triangle, normal);
        for (int i = 0; i < 3; i++) direction[i] = ray[3 + i];
    } while (dot(normal, direction) == 0);
}

typedef enum place { VERTEX, EDGE, INSIDE } place;

/* A whole-numbered point of the triangle, in eighths of its edges; i goes through vertices and edges. */
static void draw_place(hpt_random *random, place where, unsigned i, const float triangle[9], double point[3]) {
    double weight[3] = {0};
    weight[i % 3] = 1;
    if (where != VERTEX) {
        double s = (double)(1 + hpt_random_below(random, 6)) / 8;
        weight[i % 3] = where == INSIDE ? 0.875 - s : 1 - s;
        weight[(i + 1) % 3] = s;
        weight[(i + 2) % 3] = where == INSIDE ? 0.125 : 0;
    }
    point_at(triangle, weight[1], weight[2], point);
}

/* A ray that meets the place at T = t. */
static void meet(hpt_random *random, place where, unsigned i, double t, float ray[6], float triangle[9]) {
    double point[3];
    draw_crossing(random, ray, triangle);
    draw_place(random, where, i, triangle, point);
    for (int k = 0; k < 3; k++) ray[k] = hpt_to_float(point[k] - t * ray[3 + k]);
}

static double draw_t(hpt_random *random) {
    return (double)(1 + hpt_random_below(random, 16));
}

void hpt_vertex_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    meet(random, VERTEX, i, draw_t(random), ray, triangle);
}

void hpt_edge_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    meet(random, EDGE, i, draw_t(random), ray, triangle);
}

void hpt_start_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    meet(random, (place)(i / 3 % 3), i, 0, ray, triangle);
}

void hpt_behind_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    meet(random, (place)(i / 3 % 3), i, -draw_t(random), ray, triangle);
}

/* The next number up or down; from 0 a small one, but not so small that it would be subnormal. */
static float one_bit(float x, bool up) {
    float sign = up ? 1 : -1;
    return x == 0 ? sign * 0x1p-24F : nextafterf(x, sign * INFINITY);
}

void hpt_one_bit_off_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    meet(random, (place)(i / 3 % 2), i, draw_t(random), ray, triangle);
    unsigned word = (unsigned)hpt_random_below(random, 15);
    float *at = word < 6 ? ray + word : triangle + (word - 6);
    *at = one_bit(*at, i % 2);
}

void hpt_parallel_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    double normal[3];
    do {
        draw_whole(random, 7, 8, triangle, 9);
        normal_of(triangle, normal);
    } while (dot(normal, normal) == 0);
    double point[3];
    int along = (int)hpt_random_below(random, 5) - 2, across = 1 + (int)hpt_random_below(random, 2);
    draw_place(random, (place)(i % 3), i, triangle, point);
    for (int k = 0; k < 3; k++) {
        ray[3 + k] = hpt_to_float(along * (triangle[3 + k] - triangle[k]) + across * (triangle[6 + k] - triangle[k]));
        ray[k] = hpt_to_float(point[k] - ray[3 + k]);
    }
    if (i % 2) ray[hpt_random_below(random, 3)] += 8;
}

void hpt_flat_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    double point[3];
    draw_whole(random, 3, 16, triangle, 9);
    unsigned same = i % 5;
    for (unsigned k = 0; k < 3; k++) {
        if (same == 0) triangle[3 + k] = triangle[6 + k] = triangle[k];
        if (same == 1) triangle[3 + k] = triangle[k];
        if (same == 2) triangle[6 + k] = triangle[k];
        if (same == 3) triangle[6 + k] = triangle[3 + k];
        if (same == 4) triangle[6 + k] = (triangle[k] + triangle[3 + k]) / 2;
    }
    point_at(triangle, 0.25, 0.25, point);
    draw_whole(random, 9, 1, ray + 3, 3);
    for (int k = 0; k < 3; k++) ray[k] = hpt_to_float(point[k] - 4 * ray[3 + k]);
}

void hpt_still_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    double point[3];
    draw_crossing(random, ray, triangle);
    draw_place(random, (place)(i % 3), i, triangle, point);
    for (int k = 0; k < 3; k++) {
        ray[k] = hpt_to_float(point[k] + (i % 2 ? ray[3 + k] : 0));
        ray[3 + k] = i / 2 % 2 ? -0.0F : 0.0F;
    }
}

void hpt_signed_zero_pair(hpt_random *random, unsigned i, float ray[6], float triangle[9]) {
    static const float pool[] = {0.0F, -0.0F, 1, -1, 0.0F, -0.0F};
    static const float front[15] = {0, 0, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    float words[15];
    memcpy(words, front, sizeof words); /* through v0, head on */
    for (unsigned k = 0; k < 15; k++) {
        if (i % 2)
            words[k] = pool[hpt_random_below(random, 6)];
        else if (words[k] == 0 && hpt_random_below(random, 2))
            words[k] = -0.0F;
    }
    if (i % 4 == 2) words[2] = hpt_random_below(random, 2) ? 0.0F : -0.0F; /* t = 0 */
    memcpy(ray, words, 6 * sizeof *ray);
    memcpy(triangle, words + 6, 9 * sizeof *triangle);
}
