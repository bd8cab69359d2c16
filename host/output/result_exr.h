/* Results of a picture's rays as an EXR image: channels T, CP.X, CP.Y, CP.Z (float), index and F (unsigned), bit for
 * bit. */
#ifndef HITPIPE_HOST_RESULT_EXR_H
#define HITPIPE_HOST_RESULT_EXR_H

#include "host/import/exr.h"

/* results[y * width + x], y from the top. Writes `path`. `texts`: header attributes, may be NULL.
 * HP_ERROR_IO, HP_ERROR_MEMORY. */
hp_status hp_result_exr_write(const char *path, const hp_result *results, size_t width, size_t height,
                              const hp_exr_text *texts, hp_fault *fault);

#endif
