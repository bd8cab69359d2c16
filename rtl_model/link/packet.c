/* Packets as bytes: headers, seals, look-ups in packets.def. */
#include <hitpipe/packet.h>
#include <string.h>

size_t hp_packet_bytes(size_t length) {
    return HP_HEADER_BYTES + (length ? length + HP_CRC_BYTES : 0);
}

size_t hp_packet_seal(void *packet, const hp_header *header) {
    uint8_t *at = packet;
    hp_put32(at + HP_AT_HEADER_magic, HP_MAGIC);
    at[HP_AT_HEADER_version] = header->version;
    at[HP_AT_HEADER_opcode] = header->opcode;
    hp_put16(at + HP_AT_HEADER_flags, header->flags);
    hp_put32(at + HP_AT_HEADER_tag, header->tag);
    hp_put32(at + HP_AT_HEADER_length, header->length);
    hp_put32(at + HP_AT_HEADER_sequence, header->sequence);
    hp_put32(at + HP_AT_HEADER_limit, header->limit);
    hp_put16(at + HP_AT_HEADER_status, header->status);
    hp_put16(at + HP_AT_HEADER_reserved, 0);
    hp_put32(at + HP_AT_HEADER_header_crc, hp_crc32c(0, at, HP_AT_HEADER_header_crc));
    if (header->length) {
        uint8_t *payload = at + HP_HEADER_BYTES;
        hp_put32(payload + header->length, hp_crc32c(0, payload, header->length));
    }
    return hp_packet_bytes(header->length);
}

static void read_header(const uint8_t *at, hp_header *header) {
    header->version = at[HP_AT_HEADER_version];
    header->opcode = at[HP_AT_HEADER_opcode];
    header->flags = hp_get16(at + HP_AT_HEADER_flags);
    header->tag = hp_get32(at + HP_AT_HEADER_tag);
    header->length = hp_get32(at + HP_AT_HEADER_length);
    header->sequence = hp_get32(at + HP_AT_HEADER_sequence);
    header->limit = hp_get32(at + HP_AT_HEADER_limit);
    header->status = hp_get16(at + HP_AT_HEADER_status);
}

hp_status hp_packet_open(const void *packet, size_t n, hp_header *header, const uint8_t **payload) {
    const uint8_t *at = packet;
    memset(header, 0, sizeof *header);
    header->tag = HP_NO_TAG;
    *payload = NULL;
    if (n < HP_HEADER_BYTES) return HP_ERROR_LENGTH;
    if (hp_get32(at + HP_AT_HEADER_magic) != HP_MAGIC) return HP_ERROR_MAGIC;
    if (hp_get32(at + HP_AT_HEADER_header_crc) != hp_crc32c(0, at, HP_AT_HEADER_header_crc)) return HP_ERROR_CRC;
    read_header(at, header);
    if (header->length > HP_PAYLOAD_MAX || n != hp_packet_bytes(header->length)) return HP_ERROR_LENGTH;
    *payload = at + HP_HEADER_BYTES;
    if (header->length && hp_get32(*payload + header->length) != hp_crc32c(0, *payload, header->length))
        return HP_ERROR_CRC;
    if (header->version != HP_PROTOCOL_VERSION && header->opcode != HP_OPCODE_HELLO) return HP_ERROR_VERSION;
    return HP_OK;
}

const char *hp_opcode_name(unsigned opcode) {
    switch (opcode) {
#define HP_PACKET(NAME, code, direction, fixed, meaning)                                                             \
    case code:                                                                                                       \
        return #NAME;
#include <hitpipe/packets.def>
    }
    return NULL;
}

enum direction { TO_HOST, TO_BOARD };

bool hp_opcode_to_board(unsigned opcode) {
    switch (opcode) {
#define HP_PACKET(NAME, code, direction, fixed, meaning)                                                             \
    case code:                                                                                                       \
        return direction == TO_BOARD;
#include <hitpipe/packets.def>
    }
    return false;
}

unsigned hp_opcode_fixed(unsigned opcode) {
    switch (opcode) {
#define HP_PACKET(NAME, code, direction, fixed, meaning)                                                             \
    case code:                                                                                                       \
        return fixed;
#include <hitpipe/packets.def>
    }
    return 0;
}
