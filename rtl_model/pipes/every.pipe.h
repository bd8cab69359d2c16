/* Every pipe of pairs.def, under the number system in force. No include guard: it stands once per number system.
 * HP_BEHIND_EACH_PIPE, when defined, is a file to include behind each, with HP_PIPE naming the pipe. */

#define HP_PIPE ray_triangle
#include "rtl_model/pipes/ray_triangle.pipe.h"
#ifdef HP_BEHIND_EACH_PIPE
#include HP_BEHIND_EACH_PIPE
#endif
#undef HP_PIPE
