/* The signed distance of the origin from a convex body, with a certificate: positive outside, negative inside.
 *
 * Outside it is the distance to the nearest point; inside, minus the distance to the boundary. Either is the largest
 * value of -h(d) over all unit directions d, h being the support function: so any direction is a lower bound. An
 * upper bound is, outside, any point of the body; inside, minus the radius of a ball about the origin that fits into
 * a closed surface of triangles between points of the body which goes round the origin once.
 *
 * Candidates for both come from a search in double (E. Gilbert, D. Johnson and S. Keerthi's for the distance, 1988,
 * and a polytope that grows from inside for the depth, after G. van den Bergen, 2001), and from the same search in
 * binary128 if those leave too wide a gap. Whatever the search did, the bounds are computed afterwards in binary128
 * from nothing but the body's definition. Pure; any thread; the same bits on every machine. */
#ifndef TESTBENCH_REFERENCE_SIGNED_DISTANCE_H
#define TESTBENCH_REFERENCE_SIGNED_DISTANCE_H

#include "body.h"

typedef struct hpt_distance {
    double value;        /* the lower bound: second-order right in the direction it comes from */
    double gap;          /* upper bound less lower bound */
    double size;         /* of the body as seen from the origin: what gap is to be compared with */
    double direction[3]; /* unit; moving the body by -k * direction makes the value grow by k */
    bool certified;      /* gap <= 1e-9 * size */
    bool in_quad;        /* the search in double was not enough */
} hpt_distance;

hpt_distance hpt_signed_distance(const hpt_body *body);

/* Distance of the origin from a body, 0 inside, without certificate: within 1e-10 of the body's size or so. */
double hpt_quick_distance(const hpt_body *body);

#endif
