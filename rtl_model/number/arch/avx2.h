/* Wide lanes on AVX2. A flag is all ones or all zeros in each lane. MXCSR flushes. */
#ifndef HP_ARCH_AVX2_H
#define HP_ARCH_AVX2_H

#include <immintrin.h>

#define HP_FLUSH_IN_HARDWARE 1
#define HP_VECTORS 2

enum { HP_LANES = 8 };

typedef __m256 v_num;
typedef __m256 v_flag;
typedef __m256i v_bits;

static inline v_num v_constant(float c) {
    return _mm256_set1_ps(c);
}
static inline v_bits v_constant_bits(uint32_t c) {
    return _mm256_set1_epi32((int)c);
}
static inline v_num v_load(const float *from) {
    return _mm256_loadu_ps(from);
}
static inline v_bits v_load_bits(const uint32_t *from) {
    return _mm256_loadu_si256((const __m256i *)from);
}
static inline void v_store(float *to, v_num x) {
    _mm256_storeu_ps(to, x);
}
static inline void v_store_bits(uint32_t *to, v_bits x) {
    _mm256_storeu_si256((__m256i *)to, x);
}
static inline v_flag v_less(v_num a, v_num b) {
    return _mm256_cmp_ps(a, b, _CMP_LT_OQ);
}
static inline v_flag v_at_most(v_num a, v_num b) {
    return _mm256_cmp_ps(a, b, _CMP_LE_OQ);
}
static inline v_flag v_same_bits(v_bits a, v_bits b) {
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b));
}
static inline v_flag v_and(v_flag a, v_flag b) {
    return _mm256_and_ps(a, b);
}
static inline v_flag v_or(v_flag a, v_flag b) {
    return _mm256_or_ps(a, b);
}
static inline v_flag v_not(v_flag a) {
    return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
}
static inline v_num v_select(v_flag f, v_num a, v_num b) {
    return _mm256_blendv_ps(b, a, f);
}
static inline v_bits v_select_bits(v_flag f, v_bits a, v_bits b) {
    return _mm256_castps_si256(v_select(f, _mm256_castsi256_ps(a), _mm256_castsi256_ps(b)));
}
static inline v_num v_min(v_num a, v_num b) {
    return _mm256_min_ps(a, b);
} /* a < b ? a : b */
static inline v_num v_max(v_num a, v_num b) {
    return _mm256_max_ps(b, a);
} /* b > a ? b : a */
static inline v_num v_neg(v_num a) {
    return _mm256_xor_ps(a, _mm256_set1_ps(-0.0f));
}
static inline v_num v_abs(v_num a) {
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
}
static inline v_num v_sqrt(v_num a) {
    return _mm256_sqrt_ps(a);
}
static inline bool v_any(v_flag f) {
    return _mm256_movemask_ps(f) != 0;
}

#endif
