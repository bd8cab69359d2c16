/* Wide lanes on SSE2. A flag is all ones or all zeros in each lane. MXCSR flushes. */
#ifndef HP_ARCH_SSE2_H
#define HP_ARCH_SSE2_H

#include <emmintrin.h>

#define HP_FLUSH_IN_HARDWARE 1
#define HP_VECTORS 1

enum { HP_LANES = 4 };

typedef __m128 v_num;
typedef __m128 v_flag;
typedef __m128i v_bits;

static inline v_num v_constant(float c) {
    return _mm_set1_ps(c);
}
static inline v_bits v_constant_bits(uint32_t c) {
    return _mm_set1_epi32((int)c);
}
static inline v_num v_load(const float *from) {
    return _mm_loadu_ps(from);
}
static inline v_bits v_load_bits(const uint32_t *from) {
    return _mm_loadu_si128((const __m128i *)from);
}
static inline void v_store(float *to, v_num x) {
    _mm_storeu_ps(to, x);
}
static inline void v_store_bits(uint32_t *to, v_bits x) {
    _mm_storeu_si128((__m128i *)to, x);
}
static inline v_flag v_less(v_num a, v_num b) {
    return _mm_cmplt_ps(a, b);
}
static inline v_flag v_at_most(v_num a, v_num b) {
    return _mm_cmple_ps(a, b);
}
static inline v_flag v_same_bits(v_bits a, v_bits b) {
    return _mm_castsi128_ps(_mm_cmpeq_epi32(a, b));
}
static inline v_flag v_and(v_flag a, v_flag b) {
    return _mm_and_ps(a, b);
}
static inline v_flag v_or(v_flag a, v_flag b) {
    return _mm_or_ps(a, b);
}
static inline v_flag v_not(v_flag a) {
    return _mm_xor_ps(a, _mm_castsi128_ps(_mm_set1_epi32(-1)));
}
static inline v_num v_select(v_flag f, v_num a, v_num b) {
    return _mm_or_ps(_mm_and_ps(f, a), _mm_andnot_ps(f, b));
}
static inline v_bits v_select_bits(v_flag f, v_bits a, v_bits b) {
    return _mm_castps_si128(v_select(f, _mm_castsi128_ps(a), _mm_castsi128_ps(b)));
}
static inline v_num v_min(v_num a, v_num b) {
    return _mm_min_ps(a, b);
} /* a < b ? a : b */
static inline v_num v_max(v_num a, v_num b) {
    return _mm_max_ps(b, a);
} /* b > a ? b : a */
static inline v_num v_neg(v_num a) {
    return _mm_xor_ps(a, _mm_set1_ps(-0.0f));
}
static inline v_num v_abs(v_num a) {
    return _mm_andnot_ps(_mm_set1_ps(-0.0f), a);
}
static inline v_num v_sqrt(v_num a) {
    return _mm_sqrt_ps(a);
}
static inline bool v_any(v_flag f) {
    return _mm_movemask_ps(f) != 0;
}

#endif
