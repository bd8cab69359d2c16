#include "answer.h"
#include <stdlib.h>
#include <string.h>

hp_answer *hp_answer_create(const hp_config *config, const hp_session *session, hp_opcode opcode, uint32_t tag,
                            bool last) {
    hp_answer *answer = calloc(1, sizeof *answer);
    if (!answer) return NULL;
    answer->header = (hp_header){.version = HP_PROTOCOL_VERSION,
                                 .opcode = (uint8_t)opcode,
                                 .flags = last ? HP_FLAG_LAST : 0,
                                 .tag = tag,
                                 .length = hp_opcode_fixed(opcode),
                                 .sequence = session->expected,
                                 .limit = session->expected + (uint32_t)config->packet_buffers - (last ? 0 : 1)};
    return answer;
}

void hp_answer_free(hp_answer *answer) {
    free(answer->counters);
    free(answer->records);
    hp_query_release(answer->query);
    free(answer);
}

size_t hp_answer_bytes(const hp_answer *answer) {
    return hp_packet_bytes(answer->header.length);
}

static void encode_hello(const hp_config *config, uint8_t *payload) {
    memset(payload, 0, HP_HELLO_REPLY_FIXED);
    hp_put16(payload + HP_AT_HELLO_REPLY_version, HP_PROTOCOL_VERSION);
    hp_put16(payload + HP_AT_HELLO_REPLY_lanes, (uint16_t)config->lanes);
    hp_put64(payload + HP_AT_HELLO_REPLY_clock_hz, config->clock_hz);
    hp_put64(payload + HP_AT_HELLO_REPLY_ddr_bytes, config->ddr_bytes);
    hp_put32(payload + HP_AT_HELLO_REPLY_pairs, config->pipes);
    hp_put32(payload + HP_AT_HELLO_REPLY_packet_size, (uint32_t)config->packet_primaries);
    hp_put32(payload + HP_AT_HELLO_REPLY_packet_buffers, (uint32_t)config->packet_buffers);
    hp_put32(payload + HP_AT_HELLO_REPLY_payload_max, HP_PAYLOAD_MAX);
    hp_put32(payload + HP_AT_HELLO_REPLY_loop_order, (uint32_t)config->loop_order);
    hp_put32(payload + HP_AT_HELLO_REPLY_subnormals, (uint32_t)config->subnormals);
    memcpy(payload + HP_AT_HELLO_REPLY_name, config->name, strnlen(config->name, sizeof config->name));
}

static void encode_counters(const hp_counters *counters, uint8_t *payload) {
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) hp_put64(payload + 8 * i, hp_register_value(counters, i));
}

static void encode_result(const hp_answer *answer, uint8_t *payload) {
    hp_put64(payload + HP_AT_RESULT_first, answer->first);
    hp_put32(payload + HP_AT_RESULT_count, answer->count);
    hp_put32(payload + HP_AT_RESULT_reserved, 0);
}

void hp_answer_encode(const hp_config *config, const hp_answer *answer, uint8_t *packet) {
    uint8_t *payload = packet + HP_HEADER_BYTES;
    switch (answer->header.opcode) {
    case HP_OPCODE_HELLO_REPLY:
        encode_hello(config, payload);
        break;
    case HP_OPCODE_COUNTERS_REPLY:
        encode_counters(answer->counters, payload);
        break;
    case HP_OPCODE_ERROR:
        hp_put32(payload + HP_AT_ERROR_detail, answer->detail);
        break;
    case HP_OPCODE_RESULT:
        encode_result(answer, payload);
        break;
    default:
        break;
    }
    hp_packet_seal(packet, &answer->header);
}

void hp_record_encode(const hp_result *record, uint8_t *bytes) {
    uint32_t words[HP_RESULT_WORDS] = {record->F, record->index, 0, 0, 0, 0, record->stencil};
    memcpy(words + 2, &record->T, 4);
    memcpy(words + 3, record->CP, 12);
    for (unsigned i = 0; i < HP_RESULT_WORDS; i++) hp_put32(bytes + 4 * i, words[i]);
}
