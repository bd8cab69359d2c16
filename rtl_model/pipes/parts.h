/* What several pipes are made of, under the number system in force. No include guard: it stands once per number
 * system, before the pipes. */

#include "rtl_model/pipes/parts/cylinder.part.h"
#include "rtl_model/pipes/parts/cylinder_distance.part.h"
#include "rtl_model/pipes/parts/legal.part.h"
#include "rtl_model/pipes/parts/ray.part.h"
#include "rtl_model/pipes/parts/rim.part.h"
#include "rtl_model/pipes/parts/triangle.part.h"
#include "rtl_model/pipes/parts/triangle_box.part.h"
