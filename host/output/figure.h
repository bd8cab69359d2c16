/* An object as it is shown: all of it, but of rays and planes, which have no end, a part; and what it hides.
 *
 * Pure functions; any thread. */
#ifndef HITPIPE_HOST_FIGURE_H
#define HITPIPE_HOST_FIGURE_H

#include "host/rays/vector.h"

#include <hitpipe/types.h>

typedef struct hp_figure {
    hp_object object;
    const float *words; /* the caller's */
    hp_vector around;   /* of a plane a square about the foot of this point is shown */
    double reach;       /* how much is shown of a ray from its origin, of a plane from that foot */
} hp_figure;

/* The square of a plane that is shown: its middle, and unit vectors along its sides, which are 2 reach long. */
typedef struct hp_patch {
    hp_vector middle, u, v;
} hp_patch;
hp_patch hp_figure_patch(const hp_figure *plane);

/* Two unit vectors at right angles to a unit vector and to each other, the first level. */
void hp_figure_across(hp_vector axis, hp_vector *u, hp_vector *v);

/* Where the figure ends that is seen from afar: the greatest s for which at + s * toward, a unit vector, is a point
 * of it. -INFINITY: there is none. A ray has none. So it hides `at` from that side if s > 0. */
double hp_figure_end(const hp_figure *figure, hp_vector at, hp_vector toward);

#endif
