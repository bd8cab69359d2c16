/* Number system: scalar binary32 in portable C, the reference for every bit. No include guard; define HP_MEANING and
 * HP_SCALAR_FLUSH (0 gradual, 1 flush) first.
 *
 * Flushing is done by hand (types.h: hp_subnormals). A result is tiny when, rounded to 24 bits as if the exponent had
 * no bounds, it is below 2^-126. Sums and differences that small are exact. A product or quotient is computed a
 * second time 2^64 times as large, where the exponent range does not disturb the rounding, and compared with 2^-62.
 * The factor goes to an operand that is at most 1 whenever the result is near 2^-126, since no num is subnormal. */
#include "rtl_model/number/names.h"

typedef float num;
typedef bool flag;
typedef uint32_t bits;

#define UNLESS_ANY(f) if (!(f))

#if HP_SCALAR_FLUSH
#define HP_SETTLE(result, measure, least)                                                                            \
    (__builtin_expect(__builtin_fabsf(measure) < (least), 0) ? __builtin_copysignf(0, result) : (result))
#define HP_IS_SMALL(result) __builtin_expect(__builtin_fabsf(result) <= 0x1p-126f, 0)
#else
#define HP_SETTLE(result, measure, least) (result)
#define HP_IS_SMALL(result) false
#endif

/* A word from outside. */
HP_INLINE num HP_NAMED(load)(float x) {
    return HP_SETTLE(x, x, 0x1p-126f);
}

HP_INLINE num constant(float c) {
    return c;
}
HP_INLINE bits constant_bits(uint32_t c) {
    return c;
}

HP_INLINE num add(num a, num b) {
    num sum = a + b;
    return HP_SETTLE(sum, sum, 0x1p-126f);
}

HP_INLINE num sub(num a, num b) {
    num difference = a - b;
    return HP_SETTLE(difference, difference, 0x1p-126f);
}

HP_INLINE num mul(num a, num b) {
    num product = a * b;
    return HP_IS_SMALL(product) ? HP_SETTLE(product, a * 0x1p64f * b, 0x1p-62f) : product;
}

HP_INLINE num div(num a, num b) {
    num quotient = a / b;
    return HP_IS_SMALL(quotient) ? HP_SETTLE(quotient, a * 0x1p64f / b, 0x1p-62f) : quotient;
}

HP_INLINE num sqrt(num a) {
    return __builtin_sqrtf(a);
}
#include "rtl_model/number/one_lane.h"

HP_INLINE num abs(num a) {
    return __builtin_fabsf(a);
}

#undef HP_SETTLE
#undef HP_IS_SMALL

#include "rtl_model/number/vocabulary.h"
