/* Pipes and transformer in scalar binary32: what every other meaning is measured against. */
#define HP_CALLED /* names.h: nothing here has to melt into its caller */
#include "rtl_model/number/environment.h"
#include "rtl_model/number/one_nan.h"
#include "rtl_model/pipes/wide.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <string.h>

#define HP_MEANING gradual
#define HP_SCALAR_FLUSH 0
#include "rtl_model/pipes/scalar_pipes.h"
#undef HP_MEANING
#undef HP_SCALAR_FLUSH

#define HP_MEANING flush
#define HP_SCALAR_FLUSH 1
#include "rtl_model/pipes/scalar_pipes.h"

hp_result hp_pipe_test(hp_pair pair, hp_subnormals subnormals, bool separation, const float *primary,
                       const float *secondary, uint32_t index) {
    hp_environment before = hp_environment_enter(false);
    hp_result result = subnormals == HP_FLUSH ? flush_pipe_test(pair, separation, primary, secondary, index)
                                              : gradual_pipe_test(pair, separation, primary, secondary, index);
    hp_environment_leave(before);
    return result;
}

void hp_transform_object(hp_object object, hp_subnormals subnormals, const float matrix[12], const float *in,
                         float *out) {
    hp_environment before = hp_environment_enter(false);
    (subnormals == HP_FLUSH ? flush_transform : gradual_transform)(object, matrix, in, out);
    hp_environment_leave(before);
}
