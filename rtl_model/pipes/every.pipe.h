/* Every pipe of pairs.def, under the number system in force. No include guard: it stands once per number system. */
#include "rtl_model/pipes/ray_triangle.pipe.h"
