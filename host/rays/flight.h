/* The flight of the paper's experiment: one ray a frame, from a point that moves along a smooth closed curve above
 * the scene, in a random direction; and a terrain that moves as well.
 *
 * Wholly determined by bounds, frame and count of frames: the curve is a periodic Catmull-Rom spline through eight
 * fixed points, directions come from splitmix64 seeded with the frame's number. The same bits on every machine. */
#ifndef HITPIPE_HOST_FLIGHT_H
#define HITPIPE_HOST_FLIGHT_H

#include "host/import/scene.h"

/* The ray of frame `i` of `n`: origin and a direction of unit length, uniform over the sphere. */
void hp_flight_ray(const hp_bounds *bounds, size_t i, size_t n, float ray[HP_RAY_WORDS]);

/* The rigid motion of frame i of n: the scene rocks by up to 10 degrees about the vertical through its middle and
 * rises by up to a twentieth of its diagonal, and is back where it began after the last frame. Row-major 3x4. */
void hp_flight_motion(const hp_bounds *bounds, size_t i, size_t n, float matrix[12]);

#endif
