/* Sine, cosine and tangent that are the same bits on every machine: the C library's may differ in the last place
 * between versions and processors, and rays must not. Series in double, error below 1e-15. Pure; any thread. */
#ifndef HITPIPE_HOST_ANGLE_H
#define HITPIPE_HOST_ANGLE_H

/* `degrees` from -360 to 360. */
double hp_sine(double degrees);
double hp_cosine(double degrees);
double hp_tangent(double degrees);

#endif
