/* The packet decoder. docs/protocol.md: a packet that is damaged or out of order leaves the expected sequence number
 * as it is; one that is whole but asks for what the board cannot do is taken and answered. */
#include "command.h"
#include "rtl_model/memory/ddr.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "objects go from the wire to memory as they are");

/* Where a field lies in its packet: the detail of HP_ERROR_FIELD. */
#define AT(PACKET, name) (HP_HEADER_BYTES + HP_AT_##PACKET##_##name)

typedef struct verdict {
    hp_status status;
    uint32_t detail;
} verdict;

static const verdict fine = {HP_OK, 0};

static verdict field(uint32_t at) {
    return (verdict){HP_ERROR_FIELD, at};
}

static bool any_byte(const uint8_t *bytes, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (bytes[i]) return true;
    return false;
}

static verdict check_hello(const uint8_t *payload) {
    if (hp_get16(payload + HP_AT_HELLO_version_min) > HP_PROTOCOL_VERSION ||
        hp_get16(payload + HP_AT_HELLO_version_max) < HP_PROTOCOL_VERSION)
        return (verdict){HP_ERROR_VERSION, HP_PROTOCOL_VERSION};
    return fine;
}

static verdict check_upload(const hp_config *config, const hp_session *session, const uint8_t *payload) {
    hp_object object = (hp_object)hp_get32(payload + HP_AT_UPLOAD_object);
    uint64_t first = hp_get32(payload + HP_AT_UPLOAD_first), count = hp_get32(payload + HP_AT_UPLOAD_count);
    if (first > 0 && object != session->object) return field(AT(UPLOAD, object));
    if (first > session->present) return field(AT(UPLOAD, first));
    if (any_byte(payload + HP_AT_UPLOAD_reserved, 4)) return field(AT(UPLOAD, reserved));
    uint64_t most = hp_ddr_capacity(config, object);
    if (most >= HP_NO_INDEX) most = HP_NO_INDEX;
    if (first + count > most) return (verdict){HP_ERROR_CAPACITY, (uint32_t)most};
    return fine;
}

static verdict check_transform(const uint8_t *payload) {
    return hp_get32(payload + HP_AT_TRANSFORM_enable) > 1 ? field(AT(TRANSFORM, enable)) : fine;
}

static verdict check_counters(const uint8_t *payload) {
    return hp_get32(payload + HP_AT_COUNTERS_clear) > 1 ? field(AT(COUNTERS, clear)) : fine;
}

static bool stencil_runs_over(const uint8_t *stencil, unsigned primaries) {
    for (unsigned i = primaries; i < HP_PACKET_PRIMARIES; i++)
        if (stencil[i / 8] >> i % 8 & 1) return true;
    return false;
}

/* Nearest is a way of keeping one result, so only mode closest has it. */
static bool options_fit(uint32_t mode, uint32_t options) {
    return !(options & ~(uint32_t)HP_OPTIONS_ALL) && (!(options & HP_OPTION_NEAREST) || mode == HP_MODE_CLOSEST);
}

static verdict check_query(const hp_config *config, const hp_session *session, const uint8_t *payload) {
    uint32_t pair = hp_get32(payload + HP_AT_QUERY_pair), mode = hp_get32(payload + HP_AT_QUERY_mode);
    uint64_t first = hp_get32(payload + HP_AT_QUERY_first), count = hp_get32(payload + HP_AT_QUERY_count);
    uint32_t primaries = hp_get32(payload + HP_AT_QUERY_primaries);
    if (!hp_mode_name((hp_mode)mode)) return field(AT(QUERY, mode));
    if (!options_fit(mode, hp_get32(payload + HP_AT_QUERY_options))) return field(AT(QUERY, options));
    if (primaries < 1 || primaries > config->packet_primaries) return field(AT(QUERY, primaries));
    if (mode == HP_MODE_ZIP && count != primaries) return field(AT(QUERY, count));
    if (any_byte(payload + HP_AT_QUERY_reserved, 8)) return field(AT(QUERY, reserved));
    if (stencil_runs_over(payload + HP_AT_QUERY_stencil, primaries)) return field(AT(QUERY, stencil));
    if (!(config->pipes >> pair & 1)) return (verdict){HP_ERROR_NOT_RESIDENT, pair};
    if (count > 0 && hp_pair_secondary((hp_pair)pair) != session->object) return field(AT(QUERY, pair));
    if (first + count > session->present) return (verdict){HP_ERROR_CAPACITY, session->present};
    return fine;
}

static verdict check_fields(const hp_config *config, const hp_session *session, hp_opcode opcode,
                            const uint8_t *payload) {
    switch (opcode) {
    case HP_OPCODE_HELLO:
        return check_hello(payload);
    case HP_OPCODE_UPLOAD:
        return check_upload(config, session, payload);
    case HP_OPCODE_TRANSFORM:
        return check_transform(payload);
    case HP_OPCODE_QUERY:
        return check_query(config, session, payload);
    default:
        return check_counters(payload);
    }
}

static verdict check_header(const hp_header *header, const uint8_t *packet) {
    if (header->flags) return field(HP_AT_HEADER_flags);
    if (header->limit) return field(HP_AT_HEADER_limit);
    if (header->status) return field(HP_AT_HEADER_status);
    if (hp_get16(packet + HP_AT_HEADER_reserved)) return field(HP_AT_HEADER_reserved);
    return fine;
}

/* Length of the payload that the fixed part of it calls for. A type or pair that is unknown has no length: FIELD. */
static verdict check_length(const hp_header *header, const uint8_t *payload) {
    uint64_t need = hp_opcode_fixed(header->opcode), objects = 0;
    unsigned words = 0;
    if (header->length < need) return (verdict){HP_ERROR_LENGTH, (uint32_t)need};
    if (header->opcode == HP_OPCODE_UPLOAD) {
        objects = hp_get32(payload + HP_AT_UPLOAD_count);
        words = hp_object_words((hp_object)hp_get32(payload + HP_AT_UPLOAD_object));
        if (!words) return field(AT(UPLOAD, object));
    } else if (header->opcode == HP_OPCODE_QUERY) {
        objects = hp_get32(payload + HP_AT_QUERY_primaries);
        words = hp_object_words(hp_pair_primary((hp_pair)hp_get32(payload + HP_AT_QUERY_pair)));
        if (!words) return field(AT(QUERY, pair));
    }
    need += objects * words * 4;
    if (header->length != need) return (verdict){HP_ERROR_LENGTH, need > UINT32_MAX ? UINT32_MAX : (uint32_t)need};
    return fine;
}

static hp_command refuse(uint32_t tag, verdict why, bool advances) {
    return (hp_command){HP_OPCODE_ERROR, tag, why.status, why.detail, advances, NULL};
}

static hp_command decode_whole(const hp_config *config, const hp_session *session, const hp_header *header,
                               const uint8_t *packet, const uint8_t *payload) {
    uint32_t tag = header->tag;
    if (!hp_opcode_name(header->opcode) || !hp_opcode_to_board(header->opcode))
        return refuse(tag, (verdict){HP_ERROR_OPCODE, HP_AT_HEADER_opcode}, false);
    bool hello = header->opcode == HP_OPCODE_HELLO;
    uint32_t expected = hello ? 0 : session->expected;
    if (header->sequence != expected || !(hello || session->open))
        return refuse(tag, (verdict){HP_ERROR_SEQUENCE, expected}, false);
    verdict found = check_length(header, payload);
    if (found.status == HP_ERROR_LENGTH) return refuse(tag, found, false);
    if (found.status == HP_OK) found = check_header(header, packet);
    if (found.status == HP_OK) found = check_fields(config, session, (hp_opcode)header->opcode, payload);
    if (found.status != HP_OK) return refuse(tag, found, !hello);
    return (hp_command){(hp_opcode)header->opcode, tag, HP_OK, 0, true, payload};
}

hp_command hp_decode(const hp_config *config, const hp_session *session, const uint8_t *packet, size_t n, bool lost) {
    hp_header header;
    const uint8_t *payload;
    hp_status status = hp_packet_open(packet, n, &header, &payload);
    if (lost) return refuse(header.tag, (verdict){HP_ERROR_SEQUENCE, session->expected}, false);
    if (status == HP_ERROR_VERSION) return refuse(header.tag, (verdict){status, HP_PROTOCOL_VERSION}, false);
    if (status != HP_OK) return refuse(header.tag, (verdict){status, 0}, false);
    return decode_whole(config, session, &header, packet, payload);
}
