/* The .def tables themselves: no code twice, no field over another or past its part, nothing out of its range. */
#include <hitpipe/counters.h>
#include <hitpipe/packet.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* A row's code and name; names and codes of one list must each be unique. */
typedef struct row {
    unsigned code;
    const char *name;
} row;

static void unique(const row *rows, size_t n, unsigned least, unsigned most) {
    for (size_t i = 0; i < n; i++) {
        if (rows[i].code < least || rows[i].code > most) fail_msg("%s: code %u", rows[i].name, rows[i].code);
        for (size_t k = 0; k < i; k++) {
            if (rows[i].code == rows[k].code) fail_msg("%s and %s have the same code", rows[i].name, rows[k].name);
            assert_string_not_equal(rows[i].name, rows[k].name);
        }
    }
}

#define UNIQUE(rows, least, most) unique(rows, sizeof rows / sizeof rows[0], least, most)

static void codes_are_unique(void **state) {
    (void)state;
    static const row objects[] = {
#define HP_OBJECT(name, NAME, code, words, layout) {code, #name},
#include <hitpipe/objects.def>
#undef HP_OBJECT
    };
    static const row pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) {code, typed},
#include <hitpipe/pairs.def>
#undef HP_PAIR
    };
    static const row modes[] = {
#define HP_MODE(name, NAME, code, meaning) {code, #name},
#include <hitpipe/modes.def>
#undef HP_MODE
    };
    static const row statuses[] = {
#define HP_STATUS(NAME, code, exit, text, cause) {code, #NAME}, {1000 + code, text}, {2000 + code, cause},
#include <hitpipe/status.def>
#undef HP_STATUS
    };
    static const row packets[] = {
#define HP_PACKET(NAME, opcode, direction, fixed, meaning) {opcode, #NAME},
#include <hitpipe/packets.def>
    };
    UNIQUE(objects, 1, 255);
    UNIQUE(pairs, 1, 31); /* a bit of the resident mask */
    UNIQUE(modes, 1, 255);
    UNIQUE(statuses, 0, 2999);
    UNIQUE(packets, 1, 255);
}

/* ---- fields ---- */

typedef struct field {
    unsigned packet, offset, bits;
    const char *name;
} field;

static const field fields[] = {
#define HP_FIELD(PACKET, name, offset, bits, meaning) {HP_OPCODE_##PACKET, offset, bits, #PACKET "." #name},
#include <hitpipe/packets.def>
#define HP_HEADER_FIELD(name, offset, bits, meaning) {0, offset, bits, "header." #name},
#include <hitpipe/packets.def>
};

enum { FIELDS = sizeof fields / sizeof fields[0] };

/* The fields of a fixed part cover it byte by byte, each byte once, so nothing is left to chance on the wire. */
static void covers(unsigned packet, unsigned bytes, const char *name) {
    const char *owner[256] = {NULL};
    for (unsigned i = 0; i < FIELDS; i++) {
        if (fields[i].packet != packet) continue;
        assert_int_equal(fields[i].bits % 8, 0);
        for (unsigned at = fields[i].offset; at < fields[i].offset + fields[i].bits / 8; at++) {
            if (at >= bytes) fail_msg("%s goes past the %u bytes of its part", fields[i].name, bytes);
            if (owner[at]) fail_msg("%s lies over %s", fields[i].name, owner[at]);
            owner[at] = fields[i].name;
        }
    }
    for (unsigned at = 0; at < bytes; at++)
        if (!owner[at]) fail_msg("byte %u of %s belongs to no field", at, name);
}

static void fields_cover_their_packets(void **state) {
    (void)state;
    covers(0, HP_HEADER_BYTES, "the header");
#define HP_PACKET(NAME, opcode, direction, fixed, meaning) covers(opcode, fixed, #NAME);
#include <hitpipe/packets.def>
}

static void fields_are_aligned(void **state) {
    (void)state;
    for (unsigned i = 0; i < FIELDS; i++) {
        unsigned bytes = fields[i].bits / 8, unit = bytes >= 4 ? 4 : bytes;
        assert_int_equal(fields[i].offset % unit, 0);
    }
}

/* ---- the rest ---- */

static void registers_are_unique_and_named(void **state) {
    (void)state;
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) {
        assert_non_null(strchr(hp_register_name(i), '.'));
        assert_true(strlen(hp_register_meaning(i)) > 3);
        for (unsigned k = 0; k < i; k++) assert_string_not_equal(hp_register_name(i), hp_register_name(k));
    }
    assert_null(hp_register_name(HP_REGISTER_COUNT));
}

static void registers_are_set_one_by_one(void **state) {
    (void)state;
    hp_counters counters = {0};
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) hp_register_set(&counters, i, 1000 + i);
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) assert_int_equal(hp_register_value(&counters, i), 1000 + i);
    assert_int_equal(counters.clocks_total, 1000);
    assert_int_equal(counters.tests_skipped, 1000 + HP_REGISTER_COUNT - 1);
}

static void exit_statuses_are_those_of_the_command_line(void **state) {
    (void)state;
#define HP_STATUS(NAME, code, exit, text, cause) assert_true(code == 0 ? exit == 0 : exit >= 1 && exit <= 5);
#include <hitpipe/status.def>
#undef HP_STATUS
}

static void objects_fit(void **state) {
    (void)state;
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    assert_true(words <= HP_OBJECT_WORDS_MAX && hp_object_words(HP_##NAME) == words);                                \
    assert_int_equal(hp_object_beats(HP_##NAME), words > 9 ? 2 : 1);
#include <hitpipe/objects.def>
#undef HP_OBJECT
}

/* The largest packets that the ranges of config.def allow fit in a packet. */
static void the_largest_packets_fit(void **state) {
    (void)state;
    assert_true(HP_QUERY_FIXED + 256 * 4 * HP_OBJECT_WORDS_MAX <= HP_PAYLOAD_MAX);
    assert_true(HP_RESULT_FIXED + 16384 * HP_RESULT_BYTES <= HP_PAYLOAD_MAX);
    assert_true(8 * HP_REGISTER_COUNT <= HP_PAYLOAD_MAX);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_are_unique),
        cmocka_unit_test(fields_cover_their_packets),
        cmocka_unit_test(fields_are_aligned),
        cmocka_unit_test(registers_are_unique_and_named),
        cmocka_unit_test(registers_are_set_one_by_one),
        cmocka_unit_test(exit_statuses_are_those_of_the_command_line),
        cmocka_unit_test(objects_fit),
        cmocka_unit_test(the_largest_packets_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
