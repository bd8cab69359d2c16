/* The type with the bits of IEEE 754 binary128. */
#ifndef HP_NUMBER_QUAD_TYPE_H
#define HP_NUMBER_QUAD_TYPE_H

#include <float.h>

#if LDBL_MANT_DIG == 113
typedef long double hp_quad;
#else
typedef __float128 hp_quad;
#endif

#endif
