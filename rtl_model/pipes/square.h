/* Four rows of four floats, to be turned about their diagonal: how objects become lanes and lanes objects. */
#ifndef HP_PIPES_SQUARE_H
#define HP_PIPES_SQUARE_H

#include <string.h>

typedef float square_row __attribute__((vector_size(16)));

typedef struct square {
    square_row a, b, c, d;
} square;

static inline square square_load(const float *a, const float *b, const float *c, const float *d) {
    square s;
    memcpy(&s.a, a, sizeof s.a);
    memcpy(&s.b, b, sizeof s.b);
    memcpy(&s.c, c, sizeof s.c);
    memcpy(&s.d, d, sizeof s.d);
    return s;
}

static inline void square_store(square s, float *a, float *b, float *c, float *d) {
    memcpy(a, &s.a, sizeof s.a);
    memcpy(b, &s.b, sizeof s.b);
    memcpy(c, &s.c, sizeof s.c);
    memcpy(d, &s.d, sizeof s.d);
}

static inline square square_turn(square s) {
    square_row ab_low = __builtin_shufflevector(s.a, s.b, 0, 4, 1, 5),
               ab_high = __builtin_shufflevector(s.a, s.b, 2, 6, 3, 7);
    square_row cd_low = __builtin_shufflevector(s.c, s.d, 0, 4, 1, 5),
               cd_high = __builtin_shufflevector(s.c, s.d, 2, 6, 3, 7);
    return (square){
        __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5), __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7),
        __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5), __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7)};
}

#endif
