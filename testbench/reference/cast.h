/* Where a ray enters a sphere or a cylinder, in binary128.
 *
 * A solid is where a convex function g of the point is at most 0; along a ray g stays convex. So one t with g <= 0 is
 * looked for by narrowing down on the least g, and the first root is then enclosed by halving between there and t =
 * 0. No quadratic equation, nothing to cancel. Pure; any thread; the same bits on every machine. */
#ifndef TESTBENCH_REFERENCE_CAST_H
#define TESTBENCH_REFERENCE_CAST_H

#include "body.h"
#include <stdbool.h>

typedef struct hpt_entry {
    bool meets;
    hp_quad t;     /* first t >= 0 in the solid, in lengths of the direction; within 2^-100 of the search's reach */
    hp_quad CP[3]; /* there */
    double cosine; /* |cos| between direction and the surface's normal there; the least of those of the two surfaces
                      of a rim within `band` of it; 1 where the ray begins inside */
} hpt_entry;

/* `solid`: HP_SPHERE or HP_CYLINDER. `reach`: the whole solid is nearer to the origin of the ray. */
hpt_entry hpt_cast(const float ray[6], hp_object solid, const float *words, hp_quad reach, double band);

#endif
