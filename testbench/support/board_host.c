#include "board_host.h"
#include "random.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

static void *grown(void *array, size_t count, size_t *room, size_t size) {
    if (count < *room) return array;
    *room = *room ? 2 * *room : 16;
    array = realloc(array, *room * size);
    assert_non_null(array);
    return array;
}

void hpt_script_free(hpt_script *script) {
    for (size_t i = 0; i < script->count; i++) free(script->packets[i].bytes);
    free(script->packets);
    *script = (hpt_script){0};
}

hp_header hpt_header(const hpt_script *script, unsigned opcode, uint32_t length) {
    return (hp_header){.version = HP_PROTOCOL_VERSION,
                       .opcode = (uint8_t)opcode,
                       .tag = script->tag,
                       .length = length,
                       .sequence = script->sequence};
}

void hpt_reseal(hpt_script *script, const hp_header *header) {
    hpt_packet *packet = &script->packets[script->count - 1];
    packet->n = hp_packet_seal(packet->bytes, header);
}

/* The payload is zero and not sealed yet. */
uint8_t *hpt_append(hpt_script *script, unsigned opcode, uint32_t length) {
    script->packets = grown(script->packets, script->count, &script->room, sizeof *script->packets);
    hpt_packet *packet = &script->packets[script->count++];
    *packet = (hpt_packet){calloc(1, hp_packet_bytes(length)), hp_packet_bytes(length)};
    assert_non_null(packet->bytes);
    script->sequence = opcode == HP_OPCODE_HELLO ? 0 : script->sequence + 1;
    script->tag++;
    return packet->bytes + HP_HEADER_BYTES;
}

static void seal(hpt_script *script, unsigned opcode, uint32_t length) {
    hp_header header = hpt_header(script, opcode, length);
    hpt_reseal(script, &header);
}

void hpt_hello(hpt_script *script) {
    uint8_t *payload = hpt_append(script, HP_OPCODE_HELLO, HP_HELLO_FIXED);
    hp_put16(payload + HP_AT_HELLO_version_min, HP_PROTOCOL_VERSION);
    hp_put16(payload + HP_AT_HELLO_version_max, HP_PROTOCOL_VERSION);
    seal(script, HP_OPCODE_HELLO, HP_HELLO_FIXED);
}

void hpt_upload(hpt_script *script, hp_object object, uint32_t first, uint32_t count, const float *words) {
    uint32_t bytes = 4 * hp_object_words(object) * count, length = HP_UPLOAD_FIXED + bytes;
    uint8_t *payload = hpt_append(script, HP_OPCODE_UPLOAD, length);
    hp_put32(payload + HP_AT_UPLOAD_object, object);
    hp_put32(payload + HP_AT_UPLOAD_first, first);
    hp_put32(payload + HP_AT_UPLOAD_count, count);
    if (bytes) memcpy(payload + HP_UPLOAD_FIXED, words, bytes);
    seal(script, HP_OPCODE_UPLOAD, length);
}

void hpt_transform(hpt_script *script, const float matrix[12]) {
    uint8_t *payload = hpt_append(script, HP_OPCODE_TRANSFORM, HP_TRANSFORM_FIXED);
    hp_put32(payload + HP_AT_TRANSFORM_enable, matrix != NULL);
    if (matrix) memcpy(payload + HP_AT_TRANSFORM_matrix, matrix, 48);
    seal(script, HP_OPCODE_TRANSFORM, HP_TRANSFORM_FIXED);
}

void hpt_counters(hpt_script *script, bool clear) {
    uint8_t *payload = hpt_append(script, HP_OPCODE_COUNTERS, HP_COUNTERS_FIXED);
    hp_put32(payload + HP_AT_COUNTERS_clear, clear);
    seal(script, HP_OPCODE_COUNTERS, HP_COUNTERS_FIXED);
}

hpt_query hpt_query_all(hp_mode mode, uint32_t count, uint32_t primaries, const float *rays) {
    hpt_query query = {
        .pair = HP_PAIR_RAY_TRIANGLE, .mode = mode, .count = count, .primaries = primaries, .words = rays};
    for (unsigned i = 0; i < primaries; i++) query.stencil[i / 32] |= 1u << i % 32;
    return query;
}

void hpt_ask(hpt_script *script, const hpt_query *query) {
    uint32_t bytes = 4 * hp_object_words(hp_pair_primary(query->pair)) * query->primaries,
             length = HP_QUERY_FIXED + bytes;
    uint8_t *payload = hpt_append(script, HP_OPCODE_QUERY, length);
    hp_put32(payload + HP_AT_QUERY_pair, query->pair);
    hp_put32(payload + HP_AT_QUERY_mode, query->mode);
    hp_put32(payload + HP_AT_QUERY_options, query->options);
    hp_put32(payload + HP_AT_QUERY_first, query->first);
    hp_put32(payload + HP_AT_QUERY_count, query->count);
    hp_put32(payload + HP_AT_QUERY_primaries, query->primaries);
    for (unsigned i = 0; i < 8; i++) hp_put32(payload + HP_AT_QUERY_stencil + 4 * i, query->stencil[i]);
    if (bytes) memcpy(payload + HP_QUERY_FIXED, query->words, bytes);
    seal(script, HP_OPCODE_QUERY, length);
}

void hpt_log_free(hpt_log *log) {
    for (size_t i = 0; i < log->count; i++) free(log->events[i].bytes);
    free(log->events);
    *log = (hpt_log){0};
}

static void record(hpt_log *log, const hp_board *board, const hp_board_event *event) {
    log->events = grown(log->events, log->count, &log->room, sizeof *log->events);
    hpt_event *kept = &log->events[log->count++];
    *kept = (hpt_event){event->kind, event->clock, NULL, event->n, hp_board_counters(board)};
    if (event->kind != HP_BOARD_SENT) return;
    kept->bytes = malloc(event->n);
    assert_non_null(kept->bytes);
    memcpy(kept->bytes, event->bytes, event->n);
}

static bool is_last(const hp_board_event *event) {
    hp_header header;
    const uint8_t *payload;
    assert_int_equal(hp_packet_open(event->bytes, event->n, &header, &payload), HP_OK);
    return header.flags & HP_FLAG_LAST;
}

hpt_log hpt_play(const hp_board_def *def, const hpt_script *script, unsigned in_flight) {
    hpt_log log = {0};
    hp_board *board;
    size_t sent = 0, waits = 0;
    assert_int_equal(hp_board_create(def, &board), HP_OK);
    for (;;) {
        for (; sent < script->count && waits < in_flight; sent++, waits++)
            assert_int_equal(hp_board_send(board, script->packets[sent].bytes, script->packets[sent].n), HP_OK);
        hp_board_event event = hp_board_step(board);
        log.clock = event.clock;
        log.counters = hp_board_counters(board);
        if (event.kind == HP_BOARD_IDLE) break;
        record(&log, board, &event);
        if (event.kind == HP_BOARD_SENT && is_last(&event)) waits--;
    }
    assert_int_equal(sent, script->count);
    assert_int_equal(waits, 0);
    hp_board_destroy(board);
    return log;
}

hp_board_def hpt_board(const char *preset, hp_engine_kind engine) {
    hp_board_def def = {.engine = engine, .threads = 1};
    assert_int_equal(hp_config_preset(&def.config, preset), HP_OK);
    return def;
}

const uint8_t *hpt_answer(const hpt_log *log, unsigned opcode, unsigned n, hp_header *header) {
    for (size_t i = 0; i < log->count; i++) {
        const uint8_t *payload;
        if (log->events[i].kind != HP_BOARD_SENT) continue;
        assert_int_equal(hp_packet_open(log->events[i].bytes, log->events[i].n, header, &payload), HP_OK);
        if (header->opcode == opcode && n-- == 0) return payload;
    }
    return NULL;
}

static hp_result read_record(const uint8_t *bytes) {
    hp_result record = {.F = hp_get32(bytes), .index = hp_get32(bytes + 4), .stencil = hp_get32(bytes + 24)};
    memcpy(&record.T, bytes + 8, 4);
    memcpy(record.CP, bytes + 12, 12);
    return record;
}

hp_result *hpt_records(const hpt_log *log, uint32_t tag, size_t *n) {
    hp_result *records = NULL;
    size_t room = 0;
    hp_header header;
    const uint8_t *payload;
    *n = 0;
    for (unsigned i = 0; (payload = hpt_answer(log, HP_OPCODE_RESULT, i, &header)); i++) {
        if (header.tag != tag) continue;
        assert_int_equal(hp_get64(payload + HP_AT_RESULT_first), *n);
        for (uint32_t k = 0; k < hp_get32(payload + HP_AT_RESULT_count); k++) {
            records = grown(records, *n, &room, sizeof *records);
            records[(*n)++] = read_record(payload + HP_RESULT_FIXED + k * HP_RESULT_BYTES);
        }
    }
    return records;
}

bool hpt_clocks_add_up(const hp_counters *counters) {
    uint64_t stalls = counters->clocks_issue, phases = 0;
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) {
        if (strncmp(hp_register_name(i), "stalls.", 7) == 0) stalls += hp_register_value(counters, i);
        if (strncmp(hp_register_name(i), "phase.", 6) == 0) phases += hp_register_value(counters, i);
    }
    return stalls == counters->clocks_total && phases == counters->clocks_total;
}

void hpt_rays(uint64_t seed, unsigned n, float *rays) {
    hpt_random random = hpt_random_seed(seed);
    for (unsigned i = 0; i < n; i++, rays += HP_RAY_WORDS)
        for (unsigned k = 0; k < 3; k++) {
            rays[k] = (float)hpt_random_between(&random, -3, 3);
            rays[3 + k] = (float)hpt_random_between(&random, -1, 1) - rays[k];
        }
}

void hpt_triangles(uint64_t seed, unsigned n, float size, float *triangles) {
    hpt_random random = hpt_random_seed(seed);
    for (unsigned i = 0; i < n; i++, triangles += HP_TRIANGLE_WORDS) {
        for (unsigned k = 0; k < HP_TRIANGLE_WORDS; k++)
            triangles[k] = (float)hpt_random_between(&random, -size, size);
        if (i % 8 == 5) memcpy(triangles, triangles - HP_TRIANGLE_WORDS, 4 * HP_TRIANGLE_WORDS);
        if (i % 16 == 11) memcpy(triangles + 6, triangles, 12);
        if (i % 32 == 21) triangles[4] = NAN;
        if (i % 32 == 22) triangles[0] = INFINITY;
    }
}
