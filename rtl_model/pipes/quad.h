/* The pipes in binary128: the same operations, 60 bits more. What is left of an error here is the method's, the rest
 * is rounding's. For tests and accuracy tables; slow. Pure; any thread. */
#ifndef HITPIPE_PIPES_QUAD_H
#define HITPIPE_PIPES_QUAD_H

#include "rtl_model/number/quad_type.h"
#include <hitpipe/types.h>

typedef struct hp_quad_result {
    bool F;
    hp_quad T;     /* a miss: +inf, or its distance */
    hp_quad CP[3]; /* a miss: 0 */
} hp_quad_result;

/* One pair, objects in binary32 words as for hp_pipe_test. */
hp_quad_result hp_quad_pipe_test(hp_pair pair, bool separation, const float *primary, const float *secondary);

#endif
