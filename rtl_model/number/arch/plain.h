/* Wide lanes in portable C: GCC vectors of four, no intrinsics. A flag is all ones or all zeros in each lane. */
#ifndef HP_ARCH_PLAIN_H
#define HP_ARCH_PLAIN_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#define HP_FLUSH_IN_HARDWARE 0
#define HP_VECTORS 1

enum { HP_LANES = 4 };

typedef float v_num __attribute__((vector_size(16)));
typedef int32_t v_flag __attribute__((vector_size(16)));
typedef int32_t v_bits __attribute__((vector_size(16)));

static inline v_num v_constant(float c) {
    return (v_num){c, c, c, c};
}
static inline v_bits v_constant_bits(uint32_t c) {
    return (v_bits){(int)c, (int)c, (int)c, (int)c};
}

static inline v_num v_load(const float *from) {
    v_num x;
    memcpy(&x, from, sizeof x);
    return x;
}

static inline v_bits v_load_bits(const uint32_t *from) {
    v_bits x;
    memcpy(&x, from, sizeof x);
    return x;
}

static inline void v_store(float *to, v_num x) {
    memcpy(to, &x, sizeof x);
}
static inline void v_store_bits(uint32_t *to, v_bits x) {
    memcpy(to, &x, sizeof x);
}

static inline v_flag v_less(v_num a, v_num b) {
    return a < b;
}
static inline v_flag v_at_most(v_num a, v_num b) {
    return a <= b;
}
static inline v_flag v_same_bits(v_bits a, v_bits b) {
    return a == b;
}
static inline v_flag v_and(v_flag a, v_flag b) {
    return a & b;
}
static inline v_flag v_or(v_flag a, v_flag b) {
    return a | b;
}
static inline v_flag v_not(v_flag a) {
    return ~a;
}
static inline v_bits v_select_bits(v_flag f, v_bits a, v_bits b) {
    return (f & a) | (~f & b);
}
static inline v_num v_select(v_flag f, v_num a, v_num b) {
    return (v_num)v_select_bits(f, (v_bits)a, (v_bits)b);
}
static inline v_num v_min(v_num a, v_num b) {
    return v_select(a < b, a, b);
}
static inline v_num v_max(v_num a, v_num b) {
    return v_select(a < b, b, a);
}
static inline v_num v_neg(v_num a) {
    return -a;
}
static inline v_num v_abs(v_num a) {
    return (v_num)((v_bits)a & v_constant_bits(0x7FFFFFFF));
}

static inline v_num v_sqrt(v_num a) {
    return (v_num){__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]), __builtin_sqrtf(a[3])};
}

/* result, but zero of its sign in lanes where |measure| < least. */
static inline v_num v_settle(v_num result, v_num measure, float least) {
    v_flag tiny = v_abs(measure) < v_constant(least);
    return (v_num)((v_bits)result & ~(tiny & v_constant_bits(0x7FFFFFFF)));
}

static inline bool v_any(v_flag f) {
    uint64_t half[2];
    memcpy(half, &f, sizeof half);
    return (half[0] | half[1]) != 0;
}

#endif
