/* Random numbers for tests, benches and golden vectors: the same sequence for the same seed on every machine.
 *
 * xoshiro256** 1.0, seeded by splitmix64, as their authors advise: D. Blackman and S. Vigna, "Scrambled linear
 * pseudorandom number generators", ACM TOMS 47 (2021), section 6 and appendix; G. Steele, D. Lea and C. Flood, "Fast
 * splittable pseudorandom number generators", OOPSLA 2014. Only integer arithmetic, and floating-point operations
 * that round exactly. A generator is a plain value: copy it to fork a sequence; one thread at a time on one value. */
#ifndef TESTBENCH_SUPPORT_RANDOM_H
#define TESTBENCH_SUPPORT_RANDOM_H

#include <stdint.h>

typedef struct hpt_random {
    uint64_t s[4];
} hpt_random;

static inline uint64_t hpt_splitmix64(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

/* The sequence of that seed. Any seed will do, 0 too. */
static inline hpt_random hpt_random_seed(uint64_t seed) {
    hpt_random random;
    for (int i = 0; i < 4; i++) random.s[i] = hpt_splitmix64(&seed);
    return random;
}

static inline uint64_t hpt_rotate_left(uint64_t x, int k) {
    return x << k | x >> (64 - k);
}

/* 64 random bits. */
static inline uint64_t hpt_random_bits(hpt_random *random) {
    uint64_t *s = random->s, result = hpt_rotate_left(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = hpt_rotate_left(s[3], 45);
    return result;
}

/* Evenly from 0 to n - 1; n is 1 to 2^32 (the bias is below n / 2^64). */
static inline uint64_t hpt_random_below(hpt_random *random, uint64_t n) {
    return (uint64_t)((unsigned __int128)hpt_random_bits(random) * n >> 64);
}

/* Evenly in [0, 1), a multiple of 2^-53. */
static inline double hpt_random_unit(hpt_random *random) {
    return (double)(hpt_random_bits(random) >> 11) * 0x1p-53;
}

/* Evenly in [least, most). */
static inline double hpt_random_between(hpt_random *random, double least, double most) {
    return least + (most - least) * hpt_random_unit(random);
}

/* x rounded to binary32, for good: where gcc 12 vectorises at -O3 (SLP) it may otherwise go on with the unrounded x
 * when the float becomes a double again. */
static inline float hpt_to_float(double x) {
    volatile float rounded = (float)x;
    return rounded;
}

#endif
