/* Floats and results as words on the wire: binary32, little endian. */
#ifndef HITPIPE_WORDS_H
#define HITPIPE_WORDS_H

#include <hitpipe/packet.h>
#include <string.h>

static inline void hp_put_words(uint8_t *to, const float *words, size_t n) {
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    if (n) memcpy(to, words, 4 * n);
    return;
#endif
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &words[i], 4);
        hp_put32(to + 4 * i, bits);
    }
}

static inline float hp_get_float(const uint8_t *from) {
    uint32_t bits = hp_get32(from);
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static inline hp_result hp_get_result(const uint8_t *from) {
    return (hp_result){
        .F = hp_get32(from),
        .index = hp_get32(from + 4),
        .T = hp_get_float(from + 8),
        .CP = {hp_get_float(from + 12), hp_get_float(from + 16), hp_get_float(from + 20)},
        .stencil = hp_get32(from + 24),
    };
}

#endif
