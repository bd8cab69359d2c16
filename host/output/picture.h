/* A shaded picture of what a camera's rays hit: tints by elevation, or of solids by their radius, a low sun, the
 * sky's own light, haze in the distance and, when asked for, the shadows that the board computed. */
#ifndef HITPIPE_HOST_PICTURE_H
#define HITPIPE_HOST_PICTURE_H

#include "host/import/scene.h"

/* What is to be shown. The caller owns everything. */
typedef struct hp_picture {
    size_t width, height;
    const float *rays;        /* width * height, of unit length */
    const hp_result *results; /* one a ray, mode closest */
    const hp_scene *scene;
    const uint8_t *shadows; /* 1: the sun does not reach this pixel; NULL: no shadows */
} hp_picture;

/* The rays that find shadows: from each hit towards the sun, lifted off the surface. Writes at most width * height
 * rays to `rays` and the pixel of each to `pixels`; returns how many. */
size_t hp_picture_shadow_rays(const hp_picture *picture, float *rays, uint32_t *pixels);

/* Writes width * height * 3 bytes, sRGB, row by row from the top. */
void hp_picture_shade(const hp_picture *picture, uint8_t *rgb);

/* Writes a PNG file of 8-bit sRGB. HP_ERROR_IO, HP_ERROR_MEMORY. */
hp_status hp_png_write(const char *path, const uint8_t *rgb, size_t width, size_t height, hp_fault *fault);

#endif
