/* Objects as convex bodies in binary128: what the oracle measures.
 *
 * Every set of the thirteen pairs is a Minkowski sum of a few simple sets, and so is the difference A - B of two:
 *
 *   hull(points) + segments [-s, s] + discs (centre 0, normal `axis`, `radius`) + ball (centre 0, radius `ball`)
 *
 * A triangle has three points, a box one point and three segments, a cylinder a point, a segment and a disc. A
 * direction's farthest point is then a sum of farthest points, each of one line of code; nothing here knows of
 * separating axes, feature pairs or any formula of a pipe. */
#ifndef TESTBENCH_REFERENCE_BODY_H
#define TESTBENCH_REFERENCE_BODY_H

#include "rtl_model/number/quad_type.h"
#include <hitpipe/types.h>

enum { HPT_BODY_POINTS = 9, HPT_BODY_SEGMENTS = 6, HPT_BODY_DISCS = 2 };

typedef struct hpt_body {
    unsigned points, segments, discs;
    hp_quad point[HPT_BODY_POINTS][3];
    hp_quad segment[HPT_BODY_SEGMENTS][3];
    struct {
        hp_quad axis[3]; /* of length 1 */
        hp_quad radius;
    } disc[HPT_BODY_DISCS];
    hp_quad ball;
} hpt_body;

/* The square root within 2^-110; 0 of what is not positive. Same bits on every machine. For 1e-300 to 1e300. */
hp_quad hpt_root(hp_quad square);

/* A finite, legal object as a body. Not for planes and rays, which have no ends. */
hpt_body hpt_body_of(hp_object object, const float *words);

/* A point. */
hpt_body hpt_body_of_point(const hp_quad at[3]);

/* The part of a ray that a body within `reach` of its origin can be near: far end and back again 2 * reach on. */
hpt_body hpt_body_of_ray(const float ray[6], hp_quad reach);

/* {a - b}: the origin lies in it where the two meet, and is as far from its boundary as they are from touching. */
hpt_body hpt_difference(const hpt_body *a, const hpt_body *b);

/* Centre and radius of a ball about an object: a triangle's about its centroid, a plane's of radius 0 about the point
 * nearest to the origin, a ray's about its origin. */
hp_quad hpt_bounding_ball(hp_object object, const float *words, hp_quad centre[3]);

/* The orthonormal frame nearest to three axes of an obb (the orthogonal factor of the polar decomposition; N. Higham,
 * "Computing the polar decomposition - with applications", 1986: Newton's iteration). */
void hpt_nearest_frame(const float axes[9], hp_quad frame[3][3]);

#endif
