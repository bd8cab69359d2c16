/* OpenEXR images of 32-bit channels, in and out, through OpenEXRCore.
 *
 * Lossless: a word that is written is read back with the same bits, NaNs included. Plain values; any thread. */
#ifndef HITPIPE_HOST_EXR_H
#define HITPIPE_HOST_EXR_H

#include "host/import/bytes.h"

typedef enum hp_exr_type { HP_EXR_FLOAT, HP_EXR_UINT } hp_exr_type;

typedef struct hp_exr_channel {
    char name[32];
    hp_exr_type type;
    uint32_t *words; /* width * height, row by row from the top; binary32 bits or unsigned integers */
} hp_exr_channel;

typedef struct hp_exr_text { /* a string attribute of the header */
    const char *name, *value;
} hp_exr_text;

enum { HP_EXR_CHANNELS = 16 }; /* most in an image */

typedef struct hp_exr {
    size_t width, height, channel_count;
    hp_exr_channel channels[HP_EXR_CHANNELS];
    float spacing[2];         /* attribute "spacing": lengths between columns and between rows; 0, 0: not given */
    const hp_exr_text *texts; /* written, not read; may be NULL; ended by a NULL name */
} hp_exr;

/* Reads a single-part scanline image; half channels become float. The caller frees with hp_exr_free.
 * HP_ERROR_INPUT: truncated or corrupt, tiled, deep or multi-part, more than HP_EXR_CHANNELS channels, subsampled, or
 * larger than its file can hold. HP_ERROR_MEMORY. On error *image is empty. */
hp_status hp_exr_read(const hp_bytes *bytes, hp_exr *image, hp_fault *fault);

/* The file that holds an image (ZIP compression) as bytes, which the caller frees. HP_ERROR_MEMORY,
 * HP_ERROR_INTERNAL. */
hp_status hp_exr_write(const hp_exr *image, const char *name, hp_bytes *bytes, hp_fault *fault);

/* An image without channels, and one channel more, zeroed. */
void hp_exr_create(hp_exr *image, size_t width, size_t height);
uint32_t *hp_exr_add_channel(hp_exr *image, const char *name, hp_exr_type type); /* NULL: no room */
void hp_exr_free(hp_exr *image);

#endif
