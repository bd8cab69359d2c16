/* Number system: binary128, to tell the error of a method from the error of rounding to binary32. No include guard;
 * define HP_MEANING first. Underflow is gradual, and far below that of binary32. */
#include "rtl_model/number/names.h"
#include "rtl_model/number/quad_type.h"

typedef hp_quad num;
typedef bool flag;
typedef uint32_t bits;

#define UNLESS_ANY(f) if (!(f))

HP_INLINE num constant(float c) {
    return c;
}
HP_INLINE bits constant_bits(uint32_t c) {
    return c;
}
HP_INLINE num add(num a, num b) {
    return a + b;
}
HP_INLINE num sub(num a, num b) {
    return a - b;
}
HP_INLINE num mul(num a, num b) {
    return a * b;
}
HP_INLINE num div(num a, num b) {
    return a / b;
}

/* Within an ulp: long double has the exponents of binary128 and at least 64 of its 113 bits, a Newton step doubles
 * them. */
HP_INLINE num sqrt(num a) {
    num root = sqrtl((long double)a);
    return root > 0 && root < (num)INFINITY ? (root + a / root) / 2 : root;
}

#include "rtl_model/number/one_lane.h"

HP_INLINE num abs(num a) {
    return __builtin_signbit((long double)a) ? -a : a;
}

#include "rtl_model/number/vocabulary.h"
