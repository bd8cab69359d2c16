/* What a search for the signed distance finds: names of points and directions, not their coordinates, so that the
 * certificate computes those itself. Private to the reference. */
#ifndef TESTBENCH_REFERENCE_SEARCH_H
#define TESTBENCH_REFERENCE_SEARCH_H

#include "body.h"

enum { HPT_VERTICES = 3000, HPT_FACES = 2 * HPT_VERTICES };

/* A point of a body: one point of its hull, one end of each segment, one rim point of each disc. */
typedef struct hpt_corner {
    unsigned point, ends;           /* bit i of ends: the positive end of segment i */
    hp_quad rim[HPT_BODY_DISCS][3]; /* any vector: the rim point is where its part in the disc's plane points */
} hpt_corner;

/* Points and directions that bound the signed distance, if the search was right about them. */
typedef struct hpt_search {
    hp_quad direction[3]; /* the best lower bound; not of length 1 */
    unsigned members;     /* corners whose weighted sum is near to the origin: an upper bound outside */
    hpt_corner member[4];
    hp_quad weight[4];
    unsigned corners, faces; /* a closed surface round the origin: an upper bound inside. 0 faces: none */
    hpt_corner corner[HPT_VERTICES];
    unsigned face[HPT_FACES][3];
} hpt_search;

#endif
