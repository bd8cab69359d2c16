/* Golden vectors: what the reader takes, what it refuses and where, and that the writer's text reads back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "host/import/vectors.h"

#define HEADER                                                                                                       \
    "// hitpipe vectors 1\n// pair: ray-triangle\n// numerics: flush\n// generator: by hand\n// oracle: none\n"      \
    "// count: 2\n"
#define GROUP "// group: odd words\n// why: to see them kept\n"
#define PAIR                                                                                                         \
    "7fc12345 FF800000 7f800001 00000001 80000000 ffffffff  00000001 00000002 00000003 00000004 00000005 00000006 "  \
    "00000007 00000008 00000009  "
#define RECORD PAIR "00000001 00000000 3f800000 40000000 40400000 40800000\n"
#define WHOLE HEADER GROUP RECORD "// group: more\n// why: groups have names\n// checked: yes\n" RECORD

static hp_status parse(const char *text, hp_vectors *vectors, hp_fault *fault) {
    hp_bytes bytes;
    assert_int_equal(hp_bytes_copy("f.hex", text, strlen(text), &bytes, fault), HP_OK);
    hp_status status = hp_vectors_parse(&bytes, vectors, fault);
    hp_bytes_free(&bytes);
    return status;
}

/* The text is refused with exactly this message, and leaves nothing behind. */
static void refused(const char *text, const char *message) {
    hp_vectors vectors;
    hp_fault fault = {0};
    assert_int_equal(parse(text, &vectors, &fault), HP_ERROR_INPUT);
    assert_string_equal(fault.message, message);
    assert_null(vectors.primaries);
    assert_int_equal(vectors.count, 0);
}

static uint32_t bits(float x) {
    uint32_t word;
    memcpy(&word, &x, sizeof word);
    return word;
}

static void whole_file_is_read(void **state) {
    (void)state;
    hp_vectors vectors;
    hp_fault fault;
    assert_int_equal(parse(WHOLE, &vectors, &fault), HP_OK);
    assert_int_equal(vectors.pair, HP_PAIR_RAY_TRIANGLE);
    assert_int_equal(vectors.numerics, HP_NUMERICS_FLUSH);
    assert_string_equal(vectors.generator, "by hand");
    assert_string_equal(vectors.oracle, "none");
    assert_int_equal(vectors.count, 2);
    assert_int_equal(vectors.lines[0], 9);
    assert_int_equal(vectors.lines[1], 13);
    assert_string_equal(hp_vectors_group_of(&vectors, 0)->name, "odd words");
    assert_null(hp_vectors_group_of(&vectors, 0)->checked);
    assert_string_equal(hp_vectors_group_of(&vectors, 1)->why, "groups have names");
    assert_string_equal(hp_vectors_group_of(&vectors, 1)->checked, "yes");
    hp_vectors_free(&vectors);
}

static void separation_is_off_unless_said(void **state) {
    (void)state;
    static const char *const files[] = {WHOLE, HEADER "// separation: off\n" GROUP RECORD RECORD,
                                        HEADER "// separation: on\n" GROUP RECORD RECORD};
    for (unsigned i = 0; i < 3; i++) {
        hp_vectors vectors;
        hp_fault fault;
        char *text;
        size_t n;
        assert_int_equal(parse(files[i], &vectors, &fault), HP_OK);
        assert_int_equal(vectors.separation, i == 2);
        FILE *file = open_memstream(&text, &n);
        assert_int_equal(hp_vectors_write(&vectors, file, &fault), HP_OK);
        fclose(file);
        assert_int_equal(strstr(text, "// separation: on\n") != NULL, i == 2);
        free(text);
        hp_vectors_free(&vectors);
    }
}

static void words_keep_every_bit(void **state) {
    (void)state;
    static const uint32_t ray[6] = {0x7FC12345, 0xFF800000, 0x7F800001, 1, 0x80000000, 0xFFFFFFFF};
    hp_vectors vectors;
    hp_fault fault;
    assert_int_equal(parse(WHOLE, &vectors, &fault), HP_OK);
    for (size_t record = 0; record < 2; record++) {
        assert_memory_equal(vectors.primaries + 6 * record, ray, sizeof ray);
        for (uint32_t i = 0; i < 9; i++) assert_int_equal(bits(vectors.secondaries[9 * record + i]), i + 1);
        assert_int_equal(vectors.answers[6 * record], 1);
        assert_int_equal(vectors.answers[6 * record + 5], 0x40800000);
    }
    hp_vectors_free(&vectors);
}

static void what_is_written_reads_back(void **state) {
    (void)state;
    hp_vectors vectors, again;
    hp_fault fault;
    char *text, *text_again;
    size_t n, n_again;
    assert_int_equal(parse(WHOLE, &vectors, &fault), HP_OK);
    FILE *file = open_memstream(&text, &n);
    assert_int_equal(hp_vectors_write(&vectors, file, &fault), HP_OK);
    fclose(file);
    assert_int_equal(parse(text, &again, &fault), HP_OK);
    file = open_memstream(&text_again, &n_again);
    assert_int_equal(hp_vectors_write(&again, file, &fault), HP_OK);
    fclose(file);
    assert_string_equal(text, text_again);
    assert_memory_equal(again.primaries, vectors.primaries, 2 * 6 * 4);
    assert_memory_equal(again.answers, vectors.answers, 2 * 6 * 4);
    free(text);
    free(text_again);
    hp_vectors_free(&vectors);
    hp_vectors_free(&again);
}

static void layout_is_free(void **state) {
    (void)state;
    hp_vectors vectors;
    hp_fault fault;
    assert_int_equal(parse("// hitpipe vectors 1 \r\n// count: 1\r\n//a remark\n// count of nothing\n\n\t\n"
                           "// oracle: o\n// generator: g\n// pair: ray-triangle\n// numerics:any\n// numerics: any\n"
                           "// group: g\n// why: w\n  " PAIR
                           "\t0000000A 0000000b 00000000 00000000\t00000000 FFFFFFFF\r\n",
                           &vectors, &fault),
                     HP_OK);
    assert_int_equal(vectors.numerics, HP_NUMERICS_ANY);
    assert_int_equal(vectors.answers[0], 10);
    assert_int_equal(vectors.answers[5], 0xFFFFFFFF);
    hp_vectors_free(&vectors);
}

static void last_line_needs_no_newline(void **state) {
    (void)state;
    char *text = strdup(WHOLE);
    text[strlen(text) - 1] = 0;
    hp_vectors vectors;
    hp_fault fault;
    assert_int_equal(parse(text, &vectors, &fault), HP_OK);
    assert_int_equal(vectors.count, 2);
    hp_vectors_free(&vectors);
    free(text);
}

static void headers_are_checked(void **state) {
    (void)state;
    refused("", "f.hex:1:1: not a file of golden vectors: it does not begin with '// hitpipe vectors 1'");
    refused("// hitpipe vec",
            "f.hex:1:1: not a file of golden vectors: it does not begin with '// hitpipe vectors 1'");
    refused("// hitpipe vectors 2\n", "f.hex:1:21: format version is not 1, the one this program reads");
    refused("// hitpipe vectors\n", "f.hex:1:19: format version is not 1, the one this program reads");
    refused("// hitpipe vectors 1 1\n", "f.hex:1:22: format version is not 1, the one this program reads");
    refused("// hitpipe vectors 1\n" RECORD, "f.hex:2:1: no line '// pair: ...' before the first record");
    refused("// hitpipe vectors 1\n// pair: ray-triangle\n// numerics: any\n// generator: g\n// oracle: o\n" RECORD,
            "f.hex:6:1: no line '// count: ...' before the first record");
    refused("// hitpipe vectors 1\n// pair: ray-square\n// numerics: any\n// generator: g\n// oracle: o\n// count: "
            "1\n" GROUP RECORD,
            "f.hex:9:1: no pair is called 'ray-square'");
    refused("// hitpipe vectors 1\n// pair: ray-triangle\n// numerics: some\n// generator: g\n// oracle: o\n"
            "// count: 1\n" GROUP RECORD,
            "f.hex:9:1: numerics are gradual, flush or any, not 'some'");
    refused("// hitpipe vectors 1\n// pair: ray-triangle\n// numerics: any\n// generator: g\n// oracle: o\n"
            "// count: -1\n" GROUP RECORD,
            "f.hex:9:1: count is no whole number: '-1'");
    refused("// hitpipe vectors 1\n// pair: ray-triangle\n// numerics: any\n// generator: g\n// oracle: o\n"
            "// count: 99999999999999999999\n" GROUP RECORD,
            "f.hex:9:1: count is no whole number: '99999999999999999999'");
    refused(HEADER "// separation: perhaps\n" GROUP RECORD, "f.hex:10:1: separation is on or off, not 'perhaps'");
    refused(HEADER "// count: 2\n", "f.hex:7:1: 'count' a second time");
    refused("// hitpipe vectors 1\n// pair:\n", "f.hex:2:1: 'pair' says nothing");
    refused(HEADER GROUP RECORD "// oracle: another\n", "f.hex:10:1: 'oracle' after the first group");
}

static void groups_are_checked(void **state) {
    (void)state;
    refused(HEADER RECORD, "f.hex:7:1: a record before the first line '// group: ...'");
    refused(HEADER "// why: no reason\n", "f.hex:7:1: 'why' outside a group's heading");
    refused(HEADER "// group: a\n" RECORD, "f.hex:8:1: group 'a' does not say why it exists");
    refused(HEADER "// group: a\n// group: b\n", "f.hex:8:1: 'group' a second time");
}

static void records_are_checked(void **state) {
    (void)state;
    refused(HEADER, "f.hex:7:1: no record: the file is empty or cut off");
    refused(HEADER GROUP RECORD, "f.hex:10:1: the file ends after 1 of the 2 records its header promises");
    refused(HEADER GROUP RECORD RECORD RECORD, "f.hex:11:1: more records than the 2 the header promises");
    refused(HEADER GROUP "7fc12345 FF80000\n", "f.hex:9:10: word 2 of the record is not eight hex digits");
    refused(HEADER GROUP "7fc12345 FF8000000\n", "f.hex:9:10: word 2 of the record is not eight hex digits");
    refused(HEADER GROUP "7fc12345 FF80000g\n", "f.hex:9:10: word 2 of the record is not eight hex digits");
    refused(HEADER GROUP "7fc12345\n", "f.hex:9:9: the record ends after 1 of its 21 words");
    refused(HEADER GROUP PAIR "00000001", "f.hex:9:146: the record ends after 16 of its 21 words");
    refused(HEADER GROUP PAIR "00000001 00000000 3f800000 40000000 40400000 40800000 0\n",
            "f.hex:9:192: the record goes on after its 21 words");
}

static void zero_bytes_are_no_words(void **state) {
    (void)state;
    hp_bytes bytes;
    hp_vectors vectors;
    hp_fault fault;
    static const char text[] = HEADER GROUP "7fc12345\0FF800000\n";
    assert_int_equal(hp_bytes_copy("f.hex", text, sizeof text - 1, &bytes, &fault), HP_OK);
    assert_int_equal(hp_vectors_parse(&bytes, &vectors, &fault), HP_ERROR_INPUT);
    assert_string_equal(fault.message, "f.hex:9:1: word 1 of the record is not eight hex digits");
    hp_bytes_free(&bytes);
}

static void absent_file_is_named(void **state) {
    (void)state;
    hp_vectors vectors;
    hp_fault fault;
    assert_int_equal(hp_vectors_read("no/such.hex", &vectors, &fault), HP_ERROR_INPUT);
    assert_string_equal(fault.message, "no/such.hex: No such file or directory");
}

static void full_disk_shows(void **state) {
    (void)state;
    FILE *full = fopen("/dev/full", "w");
    if (!full) skip();
    hp_vectors vectors;
    hp_fault fault;
    assert_int_equal(parse(WHOLE, &vectors, &fault), HP_OK);
    assert_int_equal(hp_vectors_write(&vectors, full, &fault), HP_ERROR_IO);
    fclose(full);
    hp_vectors_free(&vectors);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_file_is_read),   cmocka_unit_test(words_keep_every_bit),
        cmocka_unit_test(layout_is_free),       cmocka_unit_test(what_is_written_reads_back),
        cmocka_unit_test(headers_are_checked),  cmocka_unit_test(last_line_needs_no_newline),
        cmocka_unit_test(groups_are_checked),   cmocka_unit_test(records_are_checked),
        cmocka_unit_test(absent_file_is_named), cmocka_unit_test(zero_bytes_are_no_words),
        cmocka_unit_test(full_disk_shows),      cmocka_unit_test(separation_is_off_unless_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
