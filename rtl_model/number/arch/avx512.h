/* Wide lanes on AVX-512 (F, DQ, VL, BW). A flag is a bit of a mask register: compares write it, `and` and `or` are
 * mask operations, `any` is one kortest. MXCSR flushes. One vector: two keep the ports no busier, and spill. */
#ifndef HP_ARCH_AVX512_H
#define HP_ARCH_AVX512_H

#include <immintrin.h>

#define HP_FLUSH_IN_HARDWARE 1
#define HP_VECTORS 1

enum { HP_LANES = 16 };

typedef __m512 v_num;
typedef __mmask16 v_flag;
typedef __m512i v_bits;

static inline v_num v_constant(float c) {
    return _mm512_set1_ps(c);
}
static inline v_bits v_constant_bits(uint32_t c) {
    return _mm512_set1_epi32((int)c);
}
static inline v_num v_load(const float *from) {
    return _mm512_loadu_ps(from);
}
static inline v_bits v_load_bits(const uint32_t *from) {
    return _mm512_loadu_si512(from);
}
static inline void v_store(float *to, v_num x) {
    _mm512_storeu_ps(to, x);
}
static inline void v_store_bits(uint32_t *to, v_bits x) {
    _mm512_storeu_si512(to, x);
}
static inline v_flag v_less(v_num a, v_num b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
static inline v_flag v_at_most(v_num a, v_num b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline v_flag v_same_bits(v_bits a, v_bits b) {
    return _mm512_cmpeq_epi32_mask(a, b);
}
static inline v_flag v_and(v_flag a, v_flag b) {
    return (v_flag)(a & b);
}
static inline v_flag v_or(v_flag a, v_flag b) {
    return (v_flag)(a | b);
}
static inline v_flag v_not(v_flag a) {
    return (v_flag)~a;
}
static inline v_num v_select(v_flag f, v_num a, v_num b) {
    return _mm512_mask_blend_ps(f, b, a);
}
static inline v_bits v_select_bits(v_flag f, v_bits a, v_bits b) {
    return _mm512_mask_blend_epi32(f, b, a);
}
static inline v_num v_min(v_num a, v_num b) {
    return _mm512_min_ps(a, b);
} /* a < b ? a : b */
static inline v_num v_max(v_num a, v_num b) {
    return _mm512_max_ps(b, a);
} /* b > a ? b : a */
static inline v_num v_neg(v_num a) {
    return _mm512_xor_ps(a, _mm512_set1_ps(-0.0f));
}
static inline v_num v_abs(v_num a) {
    return _mm512_abs_ps(a);
}
static inline v_num v_sqrt(v_num a) {
    return _mm512_sqrt_ps(a);
}
static inline bool v_any(v_flag f) {
    return f != 0;
}

#endif
