/* CRC-32C by table and by the processor's instruction. */
#include "crc32c.h"
#include <hitpipe/packet.h>
#include <string.h>

/* The table is linear over its index's bits, so eight words make all 256: entry 2^k, from bit 7 (the polynomial)
 * down. */
#define BIT(i, k, word) (((i) >> (k)&1) * word)
#define ENTRY(i)                                                                                                     \
    (BIT(i, 7, 0x82F63B78u) ^ BIT(i, 6, 0x417B1DBCu) ^ BIT(i, 5, 0x20BD8EDEu) ^ BIT(i, 4, 0x105EC76Fu) ^             \
     BIT(i, 3, 0x8AD958CFu) ^ BIT(i, 2, 0xC79A971Fu) ^ BIT(i, 1, 0xE13B70F7u) ^ BIT(i, 0, 0xF26B8303u))
#define ROW4(i) ENTRY(i), ENTRY(i + 1), ENTRY(i + 2), ENTRY(i + 3)
#define ROW16(i) ROW4(i), ROW4(i + 4), ROW4(i + 8), ROW4(i + 12)
#define ROW64(i) ROW16(i), ROW16(i + 16), ROW16(i + 32), ROW16(i + 48)

static const uint32_t table[256] = {ROW64(0u), ROW64(64u), ROW64(128u), ROW64(192u)};

uint32_t hp_crc32c_table(uint32_t crc, const void *bytes, size_t n) {
    const uint8_t *at = bytes;
    crc = ~crc;
    for (size_t i = 0; i < n; i++) crc = crc >> 8 ^ table[(crc ^ at[i]) & 0xFF];
    return ~crc;
}

#if defined(__x86_64__)

#define CRC_TARGET __attribute__((target("sse4.2")))
#define CRC_WORD(crc, word) __builtin_ia32_crc32di(crc, word)
#define CRC_BYTE(crc, byte) __builtin_ia32_crc32qi(crc, byte)

bool hp_crc32c_has_instruction(void) {
    return __builtin_cpu_supports("sse4.2");
}

#elif defined(__aarch64__) && defined(__GNUC__) && !defined(__clang__) && defined(__linux__)

#include <sys/auxv.h>

#define CRC_TARGET __attribute__((target("+crc")))
#define CRC_WORD(crc, word) __builtin_aarch64_crc32cx(crc, word)
#define CRC_BYTE(crc, byte) __builtin_aarch64_crc32cb(crc, byte)
#define HWCAP_CRC32_BIT (1ul << 7) /* <asm/hwcap.h> of arm64 */

bool hp_crc32c_has_instruction(void) {
    return getauxval(AT_HWCAP) & HWCAP_CRC32_BIT;
}

#endif

#ifdef CRC_TARGET

/* The instruction answers after three clocks and can be given another at each, so long packets are computed in three
 * lanes at a time. A CRC is a polynomial modulo the CRC's own, bit 31 the coefficient of x^0: the lanes are put
 * together by multiplying the first by x^(8 * 2 * LANE), the second by x^(8 * LANE). */
enum { LANE = 4096 };
#define PAST_ONE_LANE 0x35D73A62u
#define PAST_TWO_LANES 0x28461564u

/* a * b modulo the polynomial. */
static uint32_t multiply(uint32_t a, uint32_t b) {
    uint32_t product = 0;
    for (unsigned k = 32; k-- > 0; b = b >> 1 ^ (0x82F63B78u & -(b & 1))) product ^= b & -(a >> k & 1);
    return product;
}

static uint64_t word_at(const uint8_t *at) {
    uint64_t word;
    memcpy(&word, at, sizeof word);
    return word;
}

CRC_TARGET static uint32_t three_lanes(uint32_t crc, const uint8_t *at) {
    uint32_t second = 0, third = 0;
    for (const uint8_t *end = at + LANE; at < end; at += 8) {
        crc = (uint32_t)CRC_WORD(crc, word_at(at));
        second = (uint32_t)CRC_WORD(second, word_at(at + LANE));
        third = (uint32_t)CRC_WORD(third, word_at(at + 2 * LANE));
    }
    return multiply(crc, PAST_TWO_LANES) ^ multiply(second, PAST_ONE_LANE) ^ third;
}

CRC_TARGET uint32_t hp_crc32c_instruction(uint32_t crc, const void *bytes, size_t n) {
    const uint8_t *at = bytes;
    crc = ~crc;
    for (; n >= 3 * LANE; n -= 3 * LANE, at += 3 * LANE) crc = three_lanes(crc, at);
    for (; n >= 8; n -= 8, at += 8) crc = (uint32_t)CRC_WORD(crc, word_at(at));
    for (; n > 0; n--, at++) crc = CRC_BYTE(crc, *at);
    return ~crc;
}

#else

bool hp_crc32c_has_instruction(void) {
    return false;
}

uint32_t hp_crc32c_instruction(uint32_t crc, const void *bytes, size_t n) {
    return hp_crc32c_table(crc, bytes, n);
}

#endif

uint32_t hp_crc32c(uint32_t crc, const void *bytes, size_t n) {
    return hp_crc32c_has_instruction() ? hp_crc32c_instruction(crc, bytes, n) : hp_crc32c_table(crc, bytes, n);
}
