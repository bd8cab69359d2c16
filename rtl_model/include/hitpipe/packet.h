/* Packets of docs/protocol.md: sizes, headers, CRC-32C. Pure functions over bytes; any thread.
 *
 * Both sides of the link use these, and nothing else knows where a field lies. */
#ifndef HITPIPE_PACKET_H
#define HITPIPE_PACKET_H

#include <hitpipe/types.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    HP_HEADER_BYTES = 32,
    HP_CRC_BYTES = 4,
    HP_PROTOCOL_VERSION = 1,
    HP_PAYLOAD_MAX = 512 * 1024 - HP_HEADER_BYTES - HP_CRC_BYTES, /* a packet is at most 512 KiB */
    HP_FLAG_LAST = 1,
    HP_RESULT_BYTES = 4 * HP_RESULT_WORDS
};
#define HP_MAGIC 0x50544948u
#define HP_NO_TAG 0xFFFFFFFFu

typedef enum hp_opcode {
#define HP_PACKET(NAME, opcode, direction, fixed, meaning) HP_OPCODE_##NAME = opcode,
#include <hitpipe/packets.def>
} hp_opcode;

/* Bytes of the fixed part of each payload: HP_QUERY_FIXED is 64. */
enum {
#define HP_PACKET(NAME, opcode, direction, fixed, meaning) HP_##NAME##_FIXED = fixed,
#include <hitpipe/packets.def>
};

/* Byte offset of each payload field: HP_AT_QUERY_mode is 4. */
enum {
#define HP_FIELD(PACKET, name, offset, bits, meaning) HP_AT_##PACKET##_##name = offset,
#include <hitpipe/packets.def>
};

/* Byte offset of each header field: HP_AT_HEADER_tag is 8. */
enum {
#define HP_HEADER_FIELD(name, offset, bits, meaning) HP_AT_HEADER_##name = offset,
#include <hitpipe/packets.def>
};

/* A header in host order. magic and header_crc are implied. */
typedef struct hp_header {
    uint8_t version;
    uint8_t opcode;
    uint16_t flags;
    uint32_t tag;
    uint32_t length;
    uint32_t sequence;
    uint32_t limit;
    uint16_t status;
} hp_header;

/* Little-endian access at any alignment. Inline, since every word of every packet goes through these. */
static inline uint16_t hp_get16(const void *at) {
    const uint8_t *byte = (const uint8_t *)at;
    return (uint16_t)(byte[0] | byte[1] << 8);
}

static inline uint32_t hp_get32(const void *at) {
    const uint8_t *byte = (const uint8_t *)at;
    return byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

static inline uint64_t hp_get64(const void *at) {
    return hp_get32(at) | (uint64_t)hp_get32((const uint8_t *)at + 4) << 32;
}

static inline void hp_put16(void *at, uint16_t value) {
    uint8_t *byte = (uint8_t *)at;
    byte[0] = (uint8_t)value;
    byte[1] = (uint8_t)(value >> 8);
}

static inline void hp_put32(void *at, uint32_t value) {
    uint8_t *byte = (uint8_t *)at;
    byte[0] = (uint8_t)value;
    byte[1] = (uint8_t)(value >> 8);
    byte[2] = (uint8_t)(value >> 16);
    byte[3] = (uint8_t)(value >> 24);
}

static inline void hp_put64(void *at, uint64_t value) {
    hp_put32(at, (uint32_t)value);
    hp_put32((uint8_t *)at + 4, (uint32_t)(value >> 32));
}

/* CRC-32C (Castagnoli, reflected, as in iSCSI, RFC 3720) of n bytes, continued from `crc` (0 to begin).
 * hp_crc32c(0, "123456789", 9) is 0xE3069283. Uses the processor's instruction where there is one. */
uint32_t hp_crc32c(uint32_t crc, const void *bytes, size_t n);

/* Bytes of a whole packet with `length` bytes of payload. */
size_t hp_packet_bytes(size_t length);

/* Writes header and payload CRC around a payload that already stands at packet + HP_HEADER_BYTES. `packet` has room
 * for hp_packet_bytes(header->length). Returns the bytes of the packet. */
size_t hp_packet_seal(void *packet, const hp_header *header);

/* Reads the packet that fills the n bytes at `packet`. On HP_OK *header holds it and *payload points into `packet`.
 * HP_ERROR_LENGTH: fewer than 32 bytes, or n is not what the header's length makes it, or length > HP_PAYLOAD_MAX.
 * HP_ERROR_MAGIC, HP_ERROR_CRC (header or payload). HP_ERROR_VERSION: not HP_PROTOCOL_VERSION and not HELLO.
 * *header is filled, for its tag, whenever the header's own CRC is right; else its tag is HP_NO_TAG. Never reads past
 * n. */
hp_status hp_packet_open(const void *packet, size_t n, hp_header *header, const uint8_t **payload);

/* Table look-ups; NULL / 0 for an unknown opcode. */
const char *hp_opcode_name(unsigned opcode); /* "QUERY" */
bool hp_opcode_to_board(unsigned opcode);
unsigned hp_opcode_fixed(unsigned opcode);

#ifdef __cplusplus
}
#endif
#endif
