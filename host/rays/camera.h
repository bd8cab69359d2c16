/* A look-at camera: one ray through the centre of each pixel.
 *
 * Directions have unit length (computed in double, rounded to binary32), so that T is the distance from the eye. The
 * arithmetic is the same on every machine. Plain values; any thread. */
#ifndef HITPIPE_HOST_CAMERA_H
#define HITPIPE_HOST_CAMERA_H

#include "host/import/fault.h"
#include "host/import/scene.h"

typedef struct hp_camera {
    double eye[3], at[3], up[3];
    double fov; /* vertical field of view in degrees, 0 to 180 exclusive */
    size_t width, height;
} hp_camera;

/* The whole scene seen obliquely from the south (-y) and above (+z), filling the picture. */
hp_camera hp_camera_for(const hp_bounds *bounds, size_t width, size_t height);

/* Writes width * height rays of HP_RAY_WORDS, row by row from the top. HP_ERROR_USAGE: eye on the target, up along
 * the view, no pixels, a field of view out of its range, a number that is not finite. */
hp_status hp_camera_rays(const hp_camera *camera, float *rays, hp_fault *fault);

#endif
