/* Hardware operators have one NaN, 0x7FC00000; processors have many, and compilers take liberties with "x == x". So
 * what leaves a pipe is looked at by its bits. */
#ifndef HP_NUMBER_ONE_NAN_H
#define HP_NUMBER_ONE_NAN_H

#include <stdint.h>
#include <string.h>

static inline float hp_one_nan(float x) {
    uint32_t word;
    memcpy(&word, &x, sizeof word);
    if ((word & 0x7FFFFFFFu) > 0x7F800000u) word = 0x7FC00000u;
    memcpy(&x, &word, sizeof word);
    return x;
}

#endif
