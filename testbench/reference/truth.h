/* The right answer to any pair, from oracles that share no algorithm with the pipes, and the scales to measure errors
 * by. Ray against triangle is exact, in rationals; where a ray enters a solid is enclosed in binary128; all distances
 * and depths carry a certificate (signed_distance.h). Objects must be finite and legal. Pure; any thread. */
#ifndef TESTBENCH_REFERENCE_TRUTH_H
#define TESTBENCH_REFERENCE_TRUTH_H

#include <hitpipe/types.h>

#define HPT_TRUTH_VERSION 1 /* goes up whenever an answer changes; golden vectors name it */

typedef struct hpt_truth {
    bool F;                 /* signed_distance <= 0; a ray in the plane of a triangle misses it none the less */
    double signed_distance; /* how far from touching: +distance of a miss, -depth of a hit. Of a ray too: -depth is
                               the shortest shift that makes it miss */
    double gap;             /* of its certificate: it is at least signed_distance and at most that + gap */
    bool certified;         /* gap <= 1e-9 of the pair's size */
    double direction[3]; /* moving the primary by -k * direction makes signed_distance grow by k. 0 of ray-triangle */
    double L, C, band;   /* design's scales; either flag is right within band = max(1e-6 L, 2^-21 C) of touching */
    bool crosses;        /* ray pairs: the following are. Also for misses of ray-triangle, of the triangle's plane */
    double t, CP[3];     /* smallest t >= 0 in the object and origin + t direction */
    double cosine;       /* |cos| of the incidence there; 1 where t = 0 inside a solid */
    double length;       /* of the direction */
} hpt_truth;

hpt_truth hpt_truth_of(hp_pair pair, const float *primary, const float *secondary);

/* The same for types that may have no pipe yet. */
hpt_truth hpt_truth_between(hp_object primary, hp_object secondary, const float *p, const float *s);

/* Distance of a point from an object, 0 inside: within 1e-10 of their size. Not for rays. */
double hpt_distance_to(hp_object object, const float *words, const double point[3]);

#endif
