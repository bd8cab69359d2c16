/* Packets: bytes, CRC-32C, damage; and that docs/protocol.md says what packets.def and the other tables say. */
#include "rtl_model/link/crc32c.h"
#include "testbench/support/page.h"
#include "testbench/support/random.h"
#include <hitpipe/board.h>
#include <hitpipe/packet.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- CRC-32C ---- */

/* The definition, a bit a step. */
static uint32_t crc_by_bits(uint32_t crc, const uint8_t *bytes, size_t n) {
    crc = ~crc;
    for (size_t i = 0; i < n; i++) {
        crc ^= bytes[i];
        for (unsigned bit = 0; bit < 8; bit++) crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78u : 0);
    }
    return ~crc;
}

static void crc_of_known_messages(void **state) {
    (void)state;
    /* RFC 3720 appendix B.4 */
    uint8_t bytes[32];
    memset(bytes, 0, sizeof bytes);
    assert_int_equal(hp_crc32c(0, bytes, 32), 0x8A9136AAu);
    memset(bytes, 0xFF, sizeof bytes);
    assert_int_equal(hp_crc32c(0, bytes, 32), 0x62A8AB43u);
    for (unsigned i = 0; i < 32; i++) bytes[i] = (uint8_t)i;
    assert_int_equal(hp_crc32c(0, bytes, 32), 0x46DD794Eu);
    for (unsigned i = 0; i < 32; i++) bytes[i] = (uint8_t)(31 - i);
    assert_int_equal(hp_crc32c(0, bytes, 32), 0x113FDB5Cu);
    const uint8_t read10[48] = {
        0x01, 0xC0, [16] = 0x14, [22] = 0x04, [27] = 0x14, [31] = 0x18, [32] = 0x28, [40] = 0x02};
    assert_int_equal(hp_crc32c(0, read10, 48), 0xD9963A56u);
    assert_int_equal(hp_crc32c(0, "123456789", 9), 0xE3069283u);
}

static void crc_is_the_same_by_every_way(void **state) {
    (void)state;
    uint8_t bytes[200];
    for (unsigned i = 0; i < sizeof bytes; i++) bytes[i] = (uint8_t)(i * 167 + 13);
    for (size_t from = 0; from < 9; from++) {
        for (size_t n = 0; from + n <= sizeof bytes; n++) {
            uint32_t crc = crc_by_bits(0x1234567, bytes + from, n);
            assert_int_equal(hp_crc32c_table(0x1234567, bytes + from, n), crc);
            assert_int_equal(hp_crc32c(0x1234567, bytes + from, n), crc);
            if (hp_crc32c_has_instruction()) assert_int_equal(hp_crc32c_instruction(0x1234567, bytes + from, n), crc);
        }
    }
}

/* Long packets are computed in lanes: on both sides of where these begin. */
static void crc_of_long_messages(void **state) {
    (void)state;
    static uint8_t bytes[100000];
    hpt_random random = hpt_random_seed(1);
    for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (uint8_t)hpt_random_below(&random, 256);
    for (size_t middle = 0; middle <= 8 * 12288; middle += 4096) {
        for (size_t n = middle < 9 ? 0 : middle - 9; n < middle + 9; n++) {
            size_t from = n % 8;
            uint32_t crc = hp_crc32c_table((uint32_t)n, bytes + from, n);
            assert_int_equal(hp_crc32c((uint32_t)n, bytes + from, n), crc);
            if (hp_crc32c_has_instruction())
                assert_int_equal(hp_crc32c_instruction((uint32_t)n, bytes + from, n), crc);
        }
    }
}

static void crc_goes_on(void **state) {
    (void)state;
    assert_int_equal(hp_crc32c(hp_crc32c(0, "1234", 4), "56789", 5), 0xE3069283u);
}

/* ---- sealing and opening ---- */

static const hp_header some_header = {
    .version = HP_PROTOCOL_VERSION,
    .opcode = HP_OPCODE_RESULT,
    .flags = HP_FLAG_LAST,
    .tag = 0x12345678,
    .length = 100,
    .sequence = 0xCAFE0001,
    .limit = 0xCAFE0003,
    .status = 0x4321,
};

static size_t make_packet(uint8_t *packet) {
    for (unsigned i = 0; i < 100; i++) packet[HP_HEADER_BYTES + i] = (uint8_t)(i * 7);
    return hp_packet_seal(packet, &some_header);
}

static void what_is_sealed_opens(void **state) {
    (void)state;
    uint8_t packet[200];
    hp_header header;
    const uint8_t *payload;
    size_t n = make_packet(packet);
    assert_int_equal(n, 32 + 100 + 4);
    assert_int_equal(hp_packet_open(packet, n, &header, &payload), HP_OK);
    assert_memory_equal(&header, &some_header, sizeof header);
    assert_ptr_equal(payload, packet + 32);
    assert_memory_equal(packet, "HITP", 4);
    assert_int_equal(hp_get32(packet + 8), 0x12345678);
}

static void a_packet_without_payload_is_its_header(void **state) {
    (void)state;
    uint8_t packet[32];
    hp_header header = {.version = 1, .opcode = HP_OPCODE_ACK, .tag = 5};
    const uint8_t *payload;
    assert_int_equal(hp_packet_seal(packet, &header), 32);
    assert_int_equal(hp_packet_open(packet, 32, &header, &payload), HP_OK);
    assert_int_equal(header.tag, 5);
}

static void every_flipped_bit_is_found(void **state) {
    (void)state;
    uint8_t packet[200];
    hp_header header;
    const uint8_t *payload;
    size_t n = make_packet(packet);
    for (size_t bit = 0; bit < 8 * n; bit++) {
        packet[bit / 8] ^= (uint8_t)(1 << bit % 8);
        hp_status status = hp_packet_open(packet, n, &header, &payload);
        assert_int_equal(status, bit < 32 ? HP_ERROR_MAGIC : HP_ERROR_CRC);
        assert_int_equal(header.tag, bit < 8 * 32 ? HP_NO_TAG : some_header.tag);
        packet[bit / 8] ^= (uint8_t)(1 << bit % 8);
    }
}

static void every_wrong_length_is_found(void **state) {
    (void)state;
    hp_header header;
    const uint8_t *payload;
    for (size_t n = 0; n < 140; n++) {
        uint8_t *packet = malloc(200);
        size_t whole = make_packet(packet);
        uint8_t *cut = malloc(n + 1); /* so that a sanitizer sees a read past the end */
        memcpy(cut, packet, n);
        assert_int_equal(hp_packet_open(cut, n, &header, &payload), n == whole ? HP_OK : HP_ERROR_LENGTH);
        assert_int_equal(header.tag, n < 32 ? HP_NO_TAG : some_header.tag);
        free(cut);
        free(packet);
    }
}

static void a_length_past_the_most_is_refused(void **state) {
    (void)state;
    uint8_t *packet = calloc(1, hp_packet_bytes(HP_PAYLOAD_MAX + 1));
    hp_header header = some_header;
    const uint8_t *payload;
    header.length = HP_PAYLOAD_MAX;
    size_t n = hp_packet_seal(packet, &header);
    assert_int_equal(n, 512 * 1024);
    assert_int_equal(hp_packet_open(packet, n, &header, &payload), HP_OK);
    header.length = HP_PAYLOAD_MAX + 1;
    n = hp_packet_seal(packet, &header);
    assert_int_equal(hp_packet_open(packet, n, &header, &payload), HP_ERROR_LENGTH);
    free(packet);
}

static void another_version_is_opened_only_for_hello(void **state) {
    (void)state;
    uint8_t packet[32];
    hp_header header = {.version = 2, .opcode = HP_OPCODE_ACK, .tag = 5};
    const uint8_t *payload;
    hp_packet_seal(packet, &header);
    assert_int_equal(hp_packet_open(packet, 32, &header, &payload), HP_ERROR_VERSION);
    assert_int_equal(header.tag, 5);
    header.opcode = HP_OPCODE_HELLO;
    hp_packet_seal(packet, &header);
    assert_int_equal(hp_packet_open(packet, 32, &header, &payload), HP_OK);
}

static void opcodes_look_up(void **state) {
    (void)state;
    assert_string_equal(hp_opcode_name(HP_OPCODE_QUERY), "QUERY");
    assert_null(hp_opcode_name(0));
    assert_true(hp_opcode_to_board(HP_OPCODE_QUERY));
    assert_false(hp_opcode_to_board(HP_OPCODE_RESULT));
    assert_false(hp_opcode_to_board(77));
    assert_int_equal(hp_opcode_fixed(HP_OPCODE_QUERY), 64);
    assert_int_equal(hp_opcode_fixed(77), 0);
}

/* ---- docs/protocol.md ---- */

static void the_page_has_the_header(void **state) {
    page_rows rows = page_table(*state, "### Header");
#define HP_HEADER_FIELD(name, offset, bits, meaning)                                                                 \
    page_expect(&rows, "| %d | %d | %s | %s |", offset, bits, #name, meaning);
#include <hitpipe/packets.def>
    page_end(&rows);
}

enum { TO_BOARD, TO_HOST };
static const char *const directions[] = {"to board", "to host"};

static void expect_fields(page_rows *rows, unsigned opcode) {
#define HP_FIELD(PACKET, name, offset, bits, meaning)                                                                \
    if (opcode == HP_OPCODE_##PACKET) page_expect(rows, "| %d | %d | %s | %s |", offset, bits, #name, meaning);
#include <hitpipe/packets.def>
}

static void the_page_has_every_packet(void **state) {
    unsigned packets = 0;
    char heading[100];
#define HP_PACKET(NAME, opcode, direction, fixed, meaning)                                                           \
    {                                                                                                                \
        snprintf(heading, sizeof heading, "### %s: opcode %d, %s, fixed part %d bytes", #NAME, opcode,               \
                 directions[direction], fixed);                                                                      \
        page_rows rows = page_table(*state, heading);                                                                \
        expect_fields(&rows, opcode);                                                                                \
        page_end(&rows);                                                                                             \
        packets++;                                                                                                   \
    }
#include <hitpipe/packets.def>
    assert_int_equal(page_count(*state, ": opcode "), packets);
}

static void the_page_has_objects_pairs_modes_and_errors(void **state) {
    page_rows rows = page_table(*state, "| code | object | words | layout |");
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    page_expect(&rows, "| %d | %s | %d | %s |", code, #name, words, layout);
#include <hitpipe/objects.def>
#undef HP_OBJECT
    page_end(&rows);
    rows = page_table(*state, "| code | pair | primary | secondary |");
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    page_expect(&rows, "| %d | %s | %s | %s |", code, typed, hp_object_name(HP_##PRIMARY),                           \
                hp_object_name(HP_##SECONDARY));
#include <hitpipe/pairs.def>
#undef HP_PAIR
    page_end(&rows);
    rows = page_table(*state, "| code | mode | meaning |");
#define HP_MODE(name, NAME, code, meaning) page_expect(&rows, "| %d | %s | %s |", code, #name, meaning);
#include <hitpipe/modes.def>
#undef HP_MODE
    page_end(&rows);
    rows = page_table(*state, "| bit | option | meaning |");
#define HP_OPTION(name, NAME, bit, meaning) page_expect(&rows, "| %d | %s | %s |", bit, #name, meaning);
#include <hitpipe/options.def>
#undef HP_OPTION
    page_end(&rows);
    rows = page_table(*state, "| code | name | text | cause |");
#define HP_STATUS(NAME, code, exit, text, cause)                                                                     \
    page_expect(&rows, "| %d | %s | %s | %s |", code, #NAME, text, cause);
#include <hitpipe/status.def>
#undef HP_STATUS
    page_end(&rows);
}

/* ---- the example of the page, against the simulated board ---- */

/* What the board answers next; *n is 0 when it waits for the host. */
static const uint8_t *next_answer(hp_board *board, size_t *n) {
    hp_board_event event;
    do event = hp_board_step(board);
    while (event.kind == HP_BOARD_RECEIVED);
    *n = event.kind == HP_BOARD_SENT ? event.n : 0;
    return event.bytes;
}

static void the_board_answers_as_the_page_says(void **state) {
    hp_board_def def = {.isa = "plain", .threads = 1};
    hp_board *board;
    uint8_t bytes[256], said[256];
    const char *direction;
    const uint8_t *answer = NULL;
    size_t n, answered = 0;
    unsigned blocks = 0, answers = 0;
    hp_config_preset(&def.config, "usb3"); /* two packet buffers, as the page says */
    assert_int_equal(hp_board_create(&def, &board), HP_OK);
    for (; (n = page_bytes(*state, blocks, bytes, sizeof bytes, &direction)) > 0; blocks++) {
        if (strcmp(direction, "to-board") == 0) {
            assert_int_equal(hp_board_send(board, bytes, n), HP_OK);
            answer = next_answer(board, &answered);
            assert_true(answered >= HP_HEADER_BYTES && answered <= sizeof said);
            memcpy(said, answer, answered);
        } else {
            assert_int_equal(answered, n);
            assert_memory_equal(said, bytes, n);
            answers++;
        }
    }
    assert_int_equal(blocks, 7);
    assert_int_equal(answers, 3);
    hp_board_destroy(board);
}

static int open_page(void **state) {
    *state = page_open("docs/protocol.md");
    return *state ? 0 : -1;
}

static int close_page(void **state) {
    page_close(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crc_of_known_messages),
        cmocka_unit_test(crc_is_the_same_by_every_way),
        cmocka_unit_test(crc_of_long_messages),
        cmocka_unit_test(crc_goes_on),
        cmocka_unit_test(what_is_sealed_opens),
        cmocka_unit_test(a_packet_without_payload_is_its_header),
        cmocka_unit_test(every_flipped_bit_is_found),
        cmocka_unit_test(every_wrong_length_is_found),
        cmocka_unit_test(a_length_past_the_most_is_refused),
        cmocka_unit_test(another_version_is_opened_only_for_hello),
        cmocka_unit_test(opcodes_look_up),
        cmocka_unit_test(the_page_has_the_header),
        cmocka_unit_test(the_page_has_every_packet),
        cmocka_unit_test(the_page_has_objects_pairs_modes_and_errors),
        cmocka_unit_test(the_board_answers_as_the_page_says),
    };
    return cmocka_run_group_tests(tests, open_page, close_page);
}
