/* The oracle of the ray-triangle pipe: the exact answer, in rational arithmetic.
 *
 * The pipe solves for barycentric coordinates (Moller and Trumbore 1997). The oracle does not: it cuts the ray's line
 * with the triangle's plane, N.(x - v0) = 0 with N = (v1 - v0) x (v2 - v0), and then walks round the triangle to see
 * whether the cut lies on the inner side of each edge. Nothing is rounded before the answer is turned into doubles.
 *
 * Two-sided and closed: edges, vertices and t = 0 hit. N.D = 0 (a ray parallel to the plane or in it, a zero
 * direction, a triangle of no area) misses. All 15 words must be finite. Pure functions; any thread. */
#ifndef TESTBENCH_REFERENCE_EXACT_RAY_TRIANGLE_H
#define TESTBENCH_REFERENCE_EXACT_RAY_TRIANGLE_H

#include <stdbool.h>

#define HPT_EXACT_RAY_TRIANGLE_VERSION 1 /* goes up whenever an answer changes; golden vectors name it */

typedef struct hpt_crossing {
    bool F;       /* the ray meets the triangle */
    bool crosses; /* its line meets the plane in one point: N.D != 0. Else the rest is 0 */
    double T;     /* where, in lengths of the direction; |error| <= 2^-52 |T|, infinite beyond the doubles */
    double CP[3]; /* that point; same error in each word */
} hpt_crossing;

/* ray: origin, direction; triangle: v0, v1, v2. */
hpt_crossing hpt_exact_ray_triangle(const float ray[6], const float triangle[9]);

/* How large the pair is and how close to touching: what an error is measured against. Lengths in units of the input.
 */
typedef struct hpt_ray_triangle_scale {
    double L;         /* bounding radius of the triangle about its centroid + distance from there to the ray */
    double C;         /* largest absolute coordinate of origin and vertices */
    double cosine;    /* |cos| of the angle between direction and normal; 0 when one of them is 0 */
    double direction; /* length of the direction */
} hpt_ray_triangle_scale;

hpt_ray_triangle_scale hpt_scale_ray_triangle(const float ray[6], const float triangle[9]);

/* How far the pair is from touching. Of a hit: the shortest shift of the ray that makes it miss, 0 when it only
 * touches. Of a miss: minus the distance between ray and triangle as point sets. */
double hpt_margin_ray_triangle(const float ray[6], const float triangle[9]);

/* The band in which either flag is right: |margin| <= max(1e-6 L, 2^-21 C). A length. */
double hpt_band(const hpt_ray_triangle_scale *scale);

/* Error of a hit's T: the length |T - exact| |D|, over max(L, C) and over 1/|cos|. Exact T of a miss has none:
 * crosses must hold. */
double hpt_T_error(const hpt_crossing *exact, const hpt_ray_triangle_scale *scale, float T);

/* Error of CP: its distance from the exact point, over the same. */
double hpt_CP_error(const hpt_crossing *exact, const hpt_ray_triangle_scale *scale, const float CP[3]);

#endif
