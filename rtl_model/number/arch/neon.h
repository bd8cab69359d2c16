/* Wide lanes on NEON (aarch64). A flag is all ones or all zeros in each lane. ARM could flush in hardware, but finds
 * a result tiny before it is rounded, hitpipe after; so flushing is done by hand. */
#ifndef HP_ARCH_NEON_H
#define HP_ARCH_NEON_H

#include <arm_neon.h>

#define HP_FLUSH_IN_HARDWARE 0
#define HP_VECTORS 2

enum { HP_LANES = 4 };

typedef float32x4_t v_num;
typedef uint32x4_t v_flag;
typedef uint32x4_t v_bits;

static inline v_num v_constant(float c) {
    return vdupq_n_f32(c);
}
static inline v_bits v_constant_bits(uint32_t c) {
    return vdupq_n_u32(c);
}
static inline v_num v_load(const float *from) {
    return vld1q_f32(from);
}
static inline v_bits v_load_bits(const uint32_t *from) {
    return vld1q_u32(from);
}
static inline void v_store(float *to, v_num x) {
    vst1q_f32(to, x);
}
static inline void v_store_bits(uint32_t *to, v_bits x) {
    vst1q_u32(to, x);
}
static inline v_flag v_less(v_num a, v_num b) {
    return vcltq_f32(a, b);
}
static inline v_flag v_at_most(v_num a, v_num b) {
    return vcleq_f32(a, b);
}
static inline v_flag v_same_bits(v_bits a, v_bits b) {
    return vceqq_u32(a, b);
}
static inline v_flag v_and(v_flag a, v_flag b) {
    return vandq_u32(a, b);
}
static inline v_flag v_or(v_flag a, v_flag b) {
    return vorrq_u32(a, b);
}
static inline v_flag v_not(v_flag a) {
    return vmvnq_u32(a);
}
static inline v_bits v_select_bits(v_flag f, v_bits a, v_bits b) {
    return vbslq_u32(f, a, b);
}
static inline v_num v_select(v_flag f, v_num a, v_num b) {
    return vbslq_f32(f, a, b);
}
static inline v_num v_min(v_num a, v_num b) {
    return vbslq_f32(vcltq_f32(a, b), a, b);
}
static inline v_num v_max(v_num a, v_num b) {
    return vbslq_f32(vcltq_f32(a, b), b, a);
}
static inline v_num v_neg(v_num a) {
    return vnegq_f32(a);
}
static inline v_num v_abs(v_num a) {
    return vabsq_f32(a);
}
static inline v_num v_sqrt(v_num a) {
    return vsqrtq_f32(a);
}
static inline bool v_any(v_flag f) {
    return vmaxvq_u32(f) != 0;
}

/* result, but zero of its sign in lanes where |measure| < least. */
static inline v_num v_settle(v_num result, v_num measure, float least) {
    v_flag tiny = vcaltq_f32(measure, vdupq_n_f32(least));
    return vreinterpretq_f32_u32(vbicq_u32(vreinterpretq_u32_f32(result), vandq_u32(tiny, vdupq_n_u32(0x7FFFFFFF))));
}

#endif
