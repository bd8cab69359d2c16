/* The floating-point environment of a calculation: round to nearest even, nothing trapped, underflow as asked for,
 * whatever the caller has set. Reading the control register is cheap and writing it is not, so it is written only
 * when it differs.
 *
 * The calculation between enter and leave must stand in a function that is not inlined (HP_APART), else the compiler
 * may move its operations across. Per thread, like the register itself. */
#ifndef HP_NUMBER_ENVIRONMENT_H
#define HP_NUMBER_ENVIRONMENT_H

#include <float.h>
#include <stdbool.h>

_Static_assert(FLT_EVAL_METHOD == 0, "binary32 operations must round to binary32");

#define HP_APART __attribute__((noinline)) static

#if defined __x86_64__
#include <xmmintrin.h>

typedef unsigned hp_environment;

enum { HP_MXCSR_DEFAULT = 0x1F80, HP_MXCSR_FLUSH = 0x8040, HP_MXCSR_CONTROL = 0xFFC0 };

/* Returns what hp_environment_leave needs. `flush`: subnormal operands and results become zero in hardware. */
static inline hp_environment hp_environment_enter(bool flush) {
    unsigned before = _mm_getcsr(), wanted = HP_MXCSR_DEFAULT | (flush ? HP_MXCSR_FLUSH : 0);
    if ((before & HP_MXCSR_CONTROL) != wanted) _mm_setcsr(wanted);
    return before;
}

static inline void hp_environment_leave(hp_environment before) {
    if ((_mm_getcsr() ^ before) & HP_MXCSR_CONTROL) _mm_setcsr(before);
}

#elif defined __aarch64__
#include <stdint.h>

typedef uint64_t hp_environment;

/* Flushing in hardware is not used here: ARM finds a result tiny before it is rounded, hitpipe after. */
static inline hp_environment hp_environment_enter(bool flush) {
    uint64_t before;
    (void)flush;
    __asm__ volatile("mrs %0, fpcr" : "=r"(before));
    if (before != 0) __asm__ volatile("msr fpcr, %0" : : "r"((uint64_t)0));
    return before;
}

static inline void hp_environment_leave(hp_environment before) {
    if (before != 0) __asm__ volatile("msr fpcr, %0" : : "r"(before));
}

#else
#include <fenv.h>

typedef fenv_t hp_environment;

static inline hp_environment hp_environment_enter(bool flush) {
    fenv_t before;
    (void)flush;
    fegetenv(&before);
    fesetenv(FE_DFL_ENV);
    return before;
}

static inline void hp_environment_leave(hp_environment before) {
    fesetenv(&before);
}

#endif
#endif
