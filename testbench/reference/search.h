/* What a search for the signed distance finds: names of points and directions, not their coordinates, so that the
 * certificate computes those itself. Private to the reference. */
#ifndef TESTBENCH_REFERENCE_SEARCH_H
#define TESTBENCH_REFERENCE_SEARCH_H

#include "body.h"

enum { HPT_VERTICES = 2000, HPT_FACES = 2 * HPT_VERTICES };

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

/* Searches, of a body times `scale`, a power of two that brings its size to between 1/2 and 1; its ball is left out.
 */
void hpt_search_in_double(const hpt_body *body, double scale, hpt_search *found);
void hpt_search_in_quad(const hpt_body *body, double scale, hpt_search *found);
/* The distance of the origin from that body, 0 inside, by the search in double alone. */
double hpt_search_nearest(const hpt_body *body, double scale);

/* The signed distance of that body is no less than `lower` and no greater than `upper`: true of any search's result,
 * a wrong one too, if its weights are none of them negative and its corners name points, ends and discs of the body.
 */
typedef struct hpt_bounds {
    hp_quad lower, upper;
} hpt_bounds;

hpt_bounds hpt_certify(const hpt_body *body, double scale, const hpt_search *found);

#endif
