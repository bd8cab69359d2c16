/* The board's answers: equal to a plain fold over hp_pipe_test, whatever engine, loop order, lanes or threads; and an
 * ERROR with the right status for everything a packet can have wrong. */
#include "testbench/support/board_host.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { TRIANGLES = 700, RAYS = 37 };

static float triangles[TRIANGLES * HP_TRIANGLE_WORDS], rays[RAYS * HP_RAY_WORDS];
static const float matrix[12] = {0.9f, -0.1f, 0, 0.2f, 0.1f, 0.9f, 0, -0.1f, 0, 0.3f, 1, 0.05f};

static int make_input(void **state) {
    (void)state;
    hpt_triangles(7, TRIANGLES, 1, triangles);
    hpt_rays(8, RAYS, rays);
    return 0;
}

/* ---- answers ---- */

static hp_result expected_pair(const hp_config *config, bool moved, unsigned ray, uint32_t index) {
    hp_subnormals subnormals = (hp_subnormals)config->subnormals;
    float words[HP_TRIANGLE_WORDS];
    memcpy(words, triangles + (size_t)index * HP_TRIANGLE_WORDS, sizeof words);
    if (moved)
        hp_transform_object(HP_TRIANGLE, subnormals, matrix, triangles + (size_t)index * HP_TRIANGLE_WORDS, words);
    return hp_pipe_test(HP_PAIR_RAY_TRIANGLE, subnormals, false, rays + (size_t)ray * HP_RAY_WORDS, words, index);
}

static hp_result expected_fold(const hp_config *config, bool moved, const hpt_query *query, unsigned ray) {
    hp_result best = {0, HP_NO_INDEX, INFINITY, {0, 0, 0}, 1};
    for (uint32_t k = 0; k < query->count; k++) {
        hp_result one = expected_pair(config, moved, ray, query->first + k);
        if (!one.F || one.T >= best.T) continue;
        best = one;
        if (query->mode != HP_MODE_ANY) continue;
        best.stencil = 0;
        break;
    }
    return best;
}

static void assert_same(const hp_result *got, hp_result want) {
    assert_memory_equal(got, &want, sizeof want);
}

static bool takes_part(const hpt_query *query, unsigned ray) {
    return query->stencil[ray / 32] >> ray % 32 & 1;
}

static size_t check_folds(const hp_config *config, bool moved, const hpt_query *query, const hp_result *got) {
    size_t n = 0;
    for (unsigned ray = 0; ray < query->primaries; ray++) {
        if (!takes_part(query, ray)) continue;
        bool zip = query->mode == HP_MODE_ZIP;
        assert_same(&got[n++], zip ? expected_pair(config, moved, ray, query->first + ray)
                                   : expected_fold(config, moved, query, ray));
    }
    return n;
}

/* Primary-outer: group by group, in a group secondary by secondary; secondary-outer: all groups for each secondary.
 */
static size_t check_all(const hp_config *config, bool moved, const hpt_query *query, const hp_result *got) {
    unsigned active[RAYS], actives = 0;
    size_t n = 0;
    for (unsigned ray = 0; ray < query->primaries; ray++)
        if (takes_part(query, ray)) active[actives++] = ray;
    unsigned group = config->loop_order == HP_SECONDARY_OUTER ? actives : (unsigned)config->lanes;
    for (unsigned from = 0; from < actives; from += group)
        for (uint32_t k = 0; k < query->count; k++)
            for (unsigned i = from; i < actives && i < from + group; i++)
                assert_same(&got[n++], expected_pair(config, moved, active[i], query->first + k));
    return n;
}

static hpt_query query_of(hp_mode mode) {
    hpt_query query = hpt_query_all(mode, 600, RAYS, rays);
    query.first = 50;
    query.stencil[0] &= 0xF3FFFFDD;
    if (mode == HP_MODE_ZIP) query.count = RAYS;
    return query;
}

static void check_answers(const hp_board_def *def, bool moved) {
    for (hp_mode mode = HP_MODE_CLOSEST; mode <= HP_MODE_ZIP; mode++) {
        hpt_script script = {0};
        hpt_query query = query_of(mode);
        size_t n;
        hpt_hello(&script);
        hpt_upload(&script, HP_TRIANGLE, 0, 400, triangles);
        hpt_upload(&script, HP_TRIANGLE, 400, TRIANGLES - 400, triangles + 400 * HP_TRIANGLE_WORDS);
        hpt_transform(&script, moved ? matrix : NULL);
        hpt_ask(&script, &query);
        hpt_log log = hpt_play(def, &script, 1);
        hp_result *got = hpt_records(&log, script.tag, &n);
        assert_non_null(got);
        size_t want = mode == HP_MODE_ALL ? check_all(&def->config, moved, &query, got)
                                          : check_folds(&def->config, moved, &query, got);
        assert_int_equal(n, want);
        free(got);
        hpt_log_free(&log);
        hpt_script_free(&script);
    }
}

static void answers_are_folds_over_the_scalar_pipe(void **state) {
    (void)state;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++)
        for (unsigned variant = 0; variant < 8; variant++) {
            hp_board_def def = hpt_board("ideal", engine);
            def.config.loop_order = variant & 1;
            def.config.lanes = variant & 2 ? 5 : 1;
            def.config.subnormals = variant & 1;
            def.config.packet_results = 1000;
            check_answers(&def, variant & 4);
        }
}

/* Enough work for every thread: the same bits from one thread and from many. Every triangle is there twice, so that
 * threads find equal keys and the lower index must win. */
static void threads_do_not_change_answers(void **state) {
    (void)state;
    enum { MANY = 20000, PACKET = 250 };
    float *scene = malloc(MANY * HP_TRIANGLE_WORDS * sizeof *scene), packet[PACKET * HP_RAY_WORDS];
    assert_non_null(scene);
    hpt_triangles(9, MANY / 2, 1, scene);
    memcpy(scene + MANY / 2 * HP_TRIANGLE_WORDS, scene, MANY / 2 * HP_TRIANGLE_WORDS * sizeof *scene);
    hpt_rays(10, PACKET, packet);
    for (hp_mode mode = HP_MODE_CLOSEST; mode <= HP_MODE_ANY; mode++) {
        hpt_script script = {0};
        hpt_query query = hpt_query_all(mode, MANY, PACKET, packet);
        hpt_hello(&script);
        hpt_upload(&script, HP_TRIANGLE, 0, MANY / 2, scene);
        hpt_upload(&script, HP_TRIANGLE, MANY / 2, MANY / 2, scene + MANY / 2 * HP_TRIANGLE_WORDS);
        hpt_ask(&script, &query);
        hp_result *first = NULL;
        for (unsigned threads = 1; threads <= 7; threads += 2) {
            hp_board_def def = hpt_board("ideal", HP_ENGINE_QUICK);
            size_t n;
            def.threads = threads;
            hpt_log log = hpt_play(&def, &script, 1);
            hp_result *got = hpt_records(&log, script.tag, &n);
            assert_int_equal(n, PACKET);
            if (first) assert_memory_equal(got, first, n * sizeof *got);
            if (first) free(got);
            first = first ? first : got;
            hpt_log_free(&log);
        }
        free(first);
        hpt_script_free(&script);
    }
    free(scene);
}

/* The most lanes there can be: the last one, too, stops its primary alone. */
static void sixty_four_lanes_answer_as_one(void **state) {
    (void)state;
    enum { MANY = 50, PACKET = 128 };
    float scene[MANY * HP_TRIANGLE_WORDS], packet[PACKET * HP_RAY_WORDS];
    hpt_script script = {0};
    hpt_triangles(2, MANY, 3, scene);
    hpt_rays(1, PACKET, packet);
    hpt_query query = hpt_query_all(HP_MODE_ANY, MANY, PACKET, packet);
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, MANY, scene);
    hpt_ask(&script, &query);
    hp_result *one = NULL;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++)
        for (unsigned lanes = 1; lanes <= 64; lanes += 63) {
            hp_board_def def = hpt_board("ideal", engine);
            size_t n;
            def.config.lanes = lanes;
            hpt_log log = hpt_play(&def, &script, 1);
            hp_result *got = hpt_records(&log, script.tag, &n);
            assert_int_equal(n, PACKET);
            assert_int_equal(got[63].F, 1); /* or the last lane has nothing to stop */
            if (one) assert_memory_equal(got, one, n * sizeof *got);
            if (one) free(got);
            one = one ? one : got;
            hpt_log_free(&log);
        }
    free(one);
    hpt_script_free(&script);
}

/* Records wait for a slow link while the next packet changes the scene: they must not see it. */
static void answers_keep_the_scene_they_were_asked_of(void **state) {
    (void)state;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++) {
        hp_board_def def = hpt_board("ideal", engine);
        hpt_script script = {0};
        hpt_query query = hpt_query_all(HP_MODE_ALL, 600, RAYS, rays);
        float elsewhere[50 * HP_TRIANGLE_WORDS] = {0};
        size_t n;
        def.config.packet_results = 1000;
        def.config.packet_buffers = 4;
        def.config.link_to_host_rate = 10000000;
        hpt_hello(&script);
        hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
        hpt_ask(&script, &query);
        uint32_t tag = script.tag;
        hpt_upload(&script, HP_TRIANGLE, 0, 50, elsewhere);
        hpt_log log = hpt_play(&def, &script, 4);
        hp_result *got = hpt_records(&log, tag, &n);
        assert_int_equal(n, check_all(&def.config, false, &query, got));
        free(got);
        hpt_log_free(&log);
        hpt_script_free(&script);
    }
}

/* ---- refusals ---- */

typedef struct fault {
    hp_opcode opcode; /* of a packet that would be right */
    unsigned at;      /* what is changed: a byte offset into the packet ... */
    unsigned bytes;   /* ... so many there (0: none; the length below) ... */
    uint32_t value;   /* ... to this */
    bool reseal;      /* with CRCs that fit */
    int cut;          /* bytes taken off the end, or put on */
    hp_status status;
    bool advances;
    bool no_tag;
} fault;

#define PAYLOAD(PACKET, name) (HP_HEADER_BYTES + HP_AT_##PACKET##_##name)

static const fault faults[] = {
    {HP_OPCODE_QUERY, HP_AT_HEADER_magic, 1, 0x11, false, 0, HP_ERROR_MAGIC, false, true},
    {HP_OPCODE_QUERY, HP_AT_HEADER_tag, 1, 0x11, false, 0, HP_ERROR_CRC, false, true},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, stencil), 1, 0x11, false, 0, HP_ERROR_CRC, false, false},
    {HP_OPCODE_QUERY, 0, 0, 0, false, 1, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_QUERY, 0, 0, 0, false, -1, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_version, 1, 2, true, 0, HP_ERROR_VERSION, false, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_opcode, 1, 99, true, 0, HP_ERROR_OPCODE, false, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_opcode, 1, HP_OPCODE_RESULT, true, 0, HP_ERROR_OPCODE, false, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_sequence, 4, 7, true, 0, HP_ERROR_SEQUENCE, false, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_flags, 2, 1, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_limit, 4, 1, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, HP_AT_HEADER_status, 2, 1, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, pair), 4, 31, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, mode), 4, 0, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, mode), 4, 5, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, options), 4, 4, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, first), 4, 701, true, 0, HP_ERROR_CAPACITY, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, count), 4, 701, true, 0, HP_ERROR_CAPACITY, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, count), 4, 0xFFFFFFFF, true, 0, HP_ERROR_CAPACITY, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, primaries), 4, RAYS + 1, true, 0, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, primaries), 4, 0xFFFFFFFF, true, 0, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, reserved), 4, 1, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, reserved) + 4, 4, 1, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_QUERY, PAYLOAD(QUERY, stencil) + 31, 1, 0x80, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_UPLOAD, PAYLOAD(UPLOAD, object), 4, 0, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_UPLOAD, PAYLOAD(UPLOAD, object), 4, HP_SPHERE, true, 0, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_UPLOAD, PAYLOAD(UPLOAD, first), 4, 701, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_UPLOAD, PAYLOAD(UPLOAD, count), 4, 3, true, 0, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_UPLOAD, PAYLOAD(UPLOAD, count), 4, 0xFFFFFFFF, true, 0, HP_ERROR_LENGTH, false, false},
    {HP_OPCODE_UPLOAD, PAYLOAD(UPLOAD, reserved), 4, 1, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_TRANSFORM, PAYLOAD(TRANSFORM, enable), 4, 2, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_COUNTERS, PAYLOAD(COUNTERS, clear), 4, 2, true, 0, HP_ERROR_FIELD, true, false},
    {HP_OPCODE_HELLO, PAYLOAD(HELLO, version_min), 2, 2, true, 0, HP_ERROR_VERSION, false, false},
    {HP_OPCODE_HELLO, PAYLOAD(HELLO, version_max), 2, 0, true, 0, HP_ERROR_VERSION, false, false},
    {HP_OPCODE_HELLO, HP_AT_HEADER_sequence, 4, 3, true, 0, HP_ERROR_SEQUENCE, false, false},
};

static void append_right(hpt_script *script, hp_opcode opcode) {
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, TRIANGLES, RAYS, rays);
    switch (opcode) {
    case HP_OPCODE_QUERY:
        hpt_ask(script, &query);
        break;
    case HP_OPCODE_UPLOAD:
        hpt_upload(script, HP_TRIANGLE, 10, 2, triangles);
        break;
    case HP_OPCODE_TRANSFORM:
        hpt_transform(script, matrix);
        break;
    case HP_OPCODE_HELLO:
        hpt_hello(script);
        break;
    default:
        hpt_counters(script, false);
        break;
    }
}

static void put_fault(hpt_script *script, const fault *f) {
    hpt_packet *packet = &script->packets[script->count - 1];
    uint32_t length = hp_get32(packet->bytes + HP_AT_HEADER_length);
    for (unsigned i = 0; i < f->bytes; i++) packet->bytes[f->at + i] = (uint8_t)(f->value >> 8 * i);
    if (f->reseal) {
        hp_put32(packet->bytes + HP_AT_HEADER_header_crc, hp_crc32c(0, packet->bytes, HP_AT_HEADER_header_crc));
        hp_put32(packet->bytes + HP_HEADER_BYTES + length, hp_crc32c(0, packet->bytes + HP_HEADER_BYTES, length));
    }
    packet->bytes = realloc(packet->bytes, packet->n + 1);
    assert_non_null(packet->bytes);
    packet->n = (size_t)((long)packet->n + f->cut);
}

/* The packet is refused for what is wrong with it, and the next one in sequence is carried out. */
static void check_refused(const fault *f, hp_engine_kind engine) {
    hp_board_def def = hpt_board("usb3", engine);
    hpt_script script = {0};
    hp_header header;
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
    uint32_t sequence = script.sequence;
    append_right(&script, f->opcode);
    put_fault(&script, f);
    uint32_t tag = script.tag;
    script.sequence = sequence + f->advances;
    hpt_counters(&script, false);
    hpt_log log = hpt_play(&def, &script, 1);
    assert_non_null(hpt_answer(&log, HP_OPCODE_ERROR, 0, &header));
    assert_int_equal(header.status, f->status);
    assert_int_equal(header.tag, f->no_tag ? HP_NO_TAG : tag);
    assert_int_equal(header.flags, HP_FLAG_LAST);
    assert_int_equal(header.sequence, sequence + 1 + f->advances);
    assert_int_equal(header.limit, header.sequence + def.config.packet_buffers);
    assert_null(hpt_answer(&log, HP_OPCODE_ERROR, 1, &header));
    assert_non_null(hpt_answer(&log, HP_OPCODE_COUNTERS_REPLY, 0, &header));
    assert_true(hpt_clocks_add_up(&log.counters));
    hpt_log_free(&log);
    hpt_script_free(&script);
}

static void faulty_packets_are_refused_by_name(void **state) {
    (void)state;
    for (unsigned i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        check_refused(&faults[i], HP_ENGINE_QUICK);
        check_refused(&faults[i], HP_ENGINE_CLOCKED);
    }
}

/* Payload length that a fault's object and counts call for. */
static uint32_t length_called_for(const fault *f) {
    if (f->value == UINT32_MAX) return UINT32_MAX;
    if (f->opcode == HP_OPCODE_QUERY) return HP_QUERY_FIXED + 4 * HP_RAY_WORDS * f->value;
    if (f->at == PAYLOAD(UPLOAD, object)) return HP_UPLOAD_FIXED + 4 * HP_SPHERE_WORDS * 2;
    return HP_UPLOAD_FIXED + 4 * HP_TRIANGLE_WORDS * f->value;
}

/* What docs/protocol.md has the detail of a refusal say; of a field, a place in it. */
static uint32_t detail_called_for(const fault *f) {
    switch (f->status) {
    case HP_ERROR_FIELD:
        return f->at;
    case HP_ERROR_OPCODE:
        return HP_AT_HEADER_opcode;
    case HP_ERROR_SEQUENCE:
        return f->opcode == HP_OPCODE_HELLO ? 0 : 2;
    case HP_ERROR_VERSION:
        return HP_PROTOCOL_VERSION;
    case HP_ERROR_CAPACITY:
        return TRIANGLES;
    case HP_ERROR_LENGTH:
        return f->cut ? 0 : length_called_for(f);
    default:
        return 0;
    }
}

static void the_detail_says_more(void **state) {
    (void)state;
    for (unsigned i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        const fault *f = &faults[i];
        hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
        hpt_script script = {0};
        hp_header header;
        hpt_hello(&script);
        hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
        append_right(&script, f->opcode);
        put_fault(&script, f);
        hpt_log log = hpt_play(&def, &script, 1);
        uint32_t detail = hp_get32(hpt_answer(&log, HP_OPCODE_ERROR, 0, &header) + HP_AT_ERROR_detail);
        uint32_t rest = f->status == HP_ERROR_FIELD ? 31 : 0; /* a field may be hurt anywhere in it */
        assert_in_range(detail_called_for(f) - detail, 0, rest);
        hpt_log_free(&log);
        hpt_script_free(&script);
    }
}

static hp_status first_error(const hp_board_def *def, const hpt_script *script, unsigned in_flight) {
    hp_header header;
    hpt_log log = hpt_play(def, script, in_flight);
    hp_status status = hpt_answer(&log, HP_OPCODE_ERROR, 0, &header) ? (hp_status)header.status : HP_OK;
    hpt_log_free(&log);
    return status;
}

static void limits_of_the_board_are_kept(void **state) {
    (void)state;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
    hpt_script fits = {0}, over = {0}, many = {0}, early = {0};
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, 10, RAYS, rays);
    def.config.ddr_bytes = 36 * 100 + 35;
    def.config.packet_primaries = RAYS - 1;
    hpt_hello(&fits), hpt_upload(&fits, HP_TRIANGLE, 0, 100, triangles);
    hpt_hello(&over), hpt_upload(&over, HP_TRIANGLE, 0, 101, triangles);
    hpt_hello(&many), hpt_upload(&many, HP_TRIANGLE, 0, 10, triangles), hpt_ask(&many, &query);
    hpt_upload(&early, HP_TRIANGLE, 0, 10, triangles);
    assert_int_equal(first_error(&def, &fits, 1), HP_OK);
    assert_int_equal(first_error(&def, &over, 1), HP_ERROR_CAPACITY);
    assert_int_equal(first_error(&def, &many, 1), HP_ERROR_FIELD);
    assert_int_equal(first_error(&def, &early, 1), HP_ERROR_SEQUENCE); /* no HELLO yet */
    hpt_script_free(&fits), hpt_script_free(&over), hpt_script_free(&many), hpt_script_free(&early);
}

/* One query, wrong in three ways: what is told first is what docs/protocol.md has first. */
static void a_query_is_refused_for_the_first_cause(void **state) {
    (void)state;
    static const struct {
        bool pipe;
        hp_object scene;
        hp_status status;
        uint32_t detail;
    } causes[] = {{false, HP_SPHERE, HP_ERROR_NOT_RESIDENT, HP_PAIR_RAY_TRIANGLE},
                  {true, HP_SPHERE, HP_ERROR_FIELD, PAYLOAD(QUERY, pair)},
                  {true, HP_TRIANGLE, HP_ERROR_CAPACITY, 1}};
    for (unsigned i = 0; i < 3; i++) {
        hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
        hpt_script script = {0};
        hpt_query query = hpt_query_all(HP_MODE_CLOSEST, 10, RAYS, rays);
        hp_header header;
        if (!causes[i].pipe) def.config.pipes = 0;
        hpt_hello(&script);
        hpt_upload(&script, causes[i].scene, 0, 1, triangles);
        hpt_ask(&script, &query);
        hpt_log log = hpt_play(&def, &script, 1);
        const uint8_t *payload = hpt_answer(&log, HP_OPCODE_ERROR, 0, &header);
        assert_non_null(payload);
        assert_int_equal(header.status, causes[i].status);
        assert_int_equal(hp_get32(payload + HP_AT_ERROR_detail), causes[i].detail);
        hpt_log_free(&log);
        hpt_script_free(&script);
    }
}

/* A packet that comes without credit finds no buffer; a HELLO always does. */
static void packets_without_credit_are_refused(void **state) {
    (void)state;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++) {
        hp_board_def def = hpt_board("usb3", engine);
        hpt_script script = {0}, hello = {0};
        def.config.decoder_clocks = 60000;
        def.config.link_turnaround_ns = 0;
        hpt_hello(&script);
        for (unsigned i = 0; i < 2; i++) hpt_counters(&script, false);
        assert_int_equal(first_error(&def, &script, 2), HP_OK);
        assert_int_equal(first_error(&def, &script, 3), HP_ERROR_SEQUENCE);
        for (unsigned i = 0; i < 3; i++) hpt_hello(&hello);
        assert_int_equal(first_error(&def, &hello, 3), HP_OK);
        hpt_script_free(&script);
        hpt_script_free(&hello);
    }
}

/* What had no buffer takes none: behind it there is room for a packet that has credit. */
static void a_lost_packet_takes_no_buffer(void **state) {
    (void)state;
    for (hp_engine_kind engine = HP_ENGINE_QUICK; engine <= HP_ENGINE_CLOCKED; engine++) {
        hp_board_def def = hpt_board("usb3", engine);
        hpt_script script = {0};
        hp_header header;
        def.config.packet_buffers = 1;
        def.config.decoder_clocks = 1000;
        def.config.link_turnaround_ns = 0;
        hpt_hello(&script);
        hpt_counters(&script, false); /* the buffer is HELLO's still */
        script.sequence = 0;
        hpt_counters(&script, false); /* HELLO_REPLY gave credit for this one */
        hpt_log log = hpt_play(&def, &script, 2);
        assert_non_null(hpt_answer(&log, HP_OPCODE_ERROR, 0, &header));
        assert_int_equal(header.status, HP_ERROR_SEQUENCE);
        assert_int_equal(header.tag, 2);
        assert_null(hpt_answer(&log, HP_OPCODE_ERROR, 1, &header));
        assert_non_null(hpt_answer(&log, HP_OPCODE_COUNTERS_REPLY, 0, &header));
        assert_int_equal(header.tag, 3);
        hpt_log_free(&log);
        hpt_script_free(&script);
    }
}

/* More bytes than a packet has are of a wrong length, also when the header says that it has none behind it. */
static void more_than_a_packet_is_of_a_wrong_length(void **state) {
    (void)state;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
    hpt_script script = {0};
    hpt_hello(&script);
    hpt_append(&script, 99, HP_PAYLOAD_MAX + 1);
    size_t n = script.packets[1].n;
    hp_header header = hpt_header(&script, 99, 0);
    hpt_reseal(&script, &header);
    script.packets[1].n = n;
    assert_int_equal(first_error(&def, &script, 1), HP_ERROR_LENGTH);
    hpt_script_free(&script);
}

static void a_board_that_cannot_be_is_refused(void **state) {
    (void)state;
    hp_board *board;
    hp_board_def def = hpt_board("usb3", HP_ENGINE_QUICK);
    def.isa = "vax";
    assert_int_equal(hp_board_create(&def, &board), HP_ERROR_USAGE);
    def.isa = NULL;
    def.config.lanes = 65;
    assert_int_equal(hp_board_create(&def, &board), HP_ERROR_CONFIG);
    hp_board_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(answers_are_folds_over_the_scalar_pipe),
                                       cmocka_unit_test(threads_do_not_change_answers),
                                       cmocka_unit_test(sixty_four_lanes_answer_as_one),
                                       cmocka_unit_test(answers_keep_the_scene_they_were_asked_of),
                                       cmocka_unit_test(faulty_packets_are_refused_by_name),
                                       cmocka_unit_test(the_detail_says_more),
                                       cmocka_unit_test(limits_of_the_board_are_kept),
                                       cmocka_unit_test(a_query_is_refused_for_the_first_cause),
                                       cmocka_unit_test(packets_without_credit_are_refused),
                                       cmocka_unit_test(a_lost_packet_takes_no_buffer),
                                       cmocka_unit_test(more_than_a_packet_is_of_a_wrong_length),
                                       cmocka_unit_test(a_board_that_cannot_be_is_refused)};
    return cmocka_run_group_tests(tests, make_input, NULL);
}
