/* Objects as shapes in space: the box around one, which way its surface faces, and how far axes are from a frame.
 * Pure functions; any thread. */
#ifndef HITPIPE_HOST_SHAPE_H
#define HITPIPE_HOST_SHAPE_H

#include <hitpipe/types.h>

typedef struct hp_bounds {
    double low[3], high[3];
} hp_bounds;

/* Around nothing; and made to hold `inner` too. */
hp_bounds hp_bounds_none(void);
void hp_bounds_add(hp_bounds *bounds, const hp_bounds *inner);

/* The smallest box along the axes around a triangle, sphere, aabb, obb or cylinder; around a ray's origin; for a
 * plane its point nearest to 0,0,0. */
hp_bounds hp_shape_bounds(hp_object object, const float *words);

/* Writes the unit normal, outwards, of a triangle (towards the side on which it is anticlockwise), sphere or cylinder
 * at a point of its surface. Zeros where there is none: a triangle without area, the centre of a sphere. */
void hp_shape_normal(hp_object object, const float *words, const float point[3], double normal[3]);

/* Of n vectors that should be unit vectors at right angles, one after another: the scalar product that is furthest
 * from what it then is, 1 of a vector with itself (i = k) and 0 of others. */
typedef struct hp_product {
    unsigned i, k;
    double value;
} hp_product;
hp_product hp_worst_product(const float *vectors, unsigned n);

#endif
