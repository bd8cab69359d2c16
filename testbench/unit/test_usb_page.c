/* docs/usb.md and the udev rule say what usb.def says; and usb.def itself: fields within their reports, no number
 * twice. */
#include "testbench/support/page.h"
#include <ctype.h>
#include <hitpipe/usb.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int open_page(void **state) {
    *state = page_open("docs/usb.md");
    return *state ? 0 : -1;
}

static int close_page(void **state) {
    page_close(*state);
    return 0;
}

static void the_page_has_the_device(void **state) {
    page_rows rows = page_table(*state, "## The device");
#define HP_USB_NUMBER(NAME, value, meaning) page_expect(&rows, "| %s | %s | %s |", #NAME, #value, meaning);
#include <hitpipe/usb.def>
    page_end(&rows);
}

/* "what the board is" begins a sentence there: "What the board is." */
static void expect_sentence(const test_page *page, const char *meaning) {
    char line[200];
    snprintf(line, sizeof line, "%c%s.", toupper((unsigned char)meaning[0]), meaning + 1);
    assert_int_equal(page_count(page, line), 1);
}

static void expect_fields(page_rows *rows, int report) {
#define HP_USB_FIELD(REPORT, name, offset, bits, meaning)                                                            \
    if (report == HP_USB_REPORT_##REPORT) page_expect(rows, "| %d | %d | %s | %s |", offset, bits, #name, meaning);
#include <hitpipe/usb.def>
}

static void the_page_has_every_report(void **state) {
    size_t reports = 0;
    char heading[80], kind[16];
#define HP_USB_REPORT(NAME, id, KIND, bytes, meaning)                                                                \
    {                                                                                                                \
        for (size_t i = 0; i < sizeof #KIND; i++) kind[i] = (char)tolower(#KIND[i]);                                 \
        snprintf(heading, sizeof heading, "### %s: report %d, %s, %d bytes", #NAME, id, kind, bytes);                \
        page_rows rows = page_table(*state, heading);                                                                \
        expect_fields(&rows, id);                                                                                    \
        page_end(&rows);                                                                                             \
        expect_sentence(*state, meaning);                                                                            \
        reports++;                                                                                                   \
    }
#include <hitpipe/usb.def>
    assert_int_equal(page_count(*state, ": report "), reports);
}

static void the_page_has_commands_and_events(void **state) {
    page_rows rows = page_table(*state, "| code | command | since | meaning |");
#define HP_USB_CONTROL(NAME, code, since, meaning)                                                                   \
    page_expect(&rows, "| %d | %s | %d | %s |", code, #NAME, since, meaning);
#include <hitpipe/usb.def>
    page_end(&rows);
    rows = page_table(*state, "| code | event | meaning |");
#define HP_USB_EVENT(NAME, code, meaning) page_expect(&rows, "| %d | %s | %s |", code, #NAME, meaning);
#include <hitpipe/usb.def>
    page_end(&rows);
}

/* Fields lie one behind the other and fill their report, which fits into the interrupt endpoint's packet with its ID.
 */
static void fields_fill_their_reports(void **state) {
    (void)state;
    int bytes_of_report = 0, left = 0;
#define HP_USB_REPORT(NAME, id, KIND, bytes, meaning)                                                                \
    assert_int_equal(left, 0);                                                                                       \
    assert_true(bytes < HP_USB_REPORT_PACKET);                                                                       \
    bytes_of_report = left = bytes;
#define HP_USB_FIELD(REPORT, name, offset, bits, meaning)                                                            \
    assert_int_equal(offset, bytes_of_report - left);                                                                \
    assert_int_equal(bits % 8, 0);                                                                                   \
    left -= bits / 8;
#include <hitpipe/usb.def>
    assert_int_equal(left, 0);
}

/* Every rule of the file is for these identifiers, one for the data interface, one for the HID. */
static void the_udev_rule_has_the_identifiers(void **state) {
    test_page *rule = page_open("mk/60-hitpipe.rules");
    assert_non_null(rule);
    char text[80];
    size_t lines = page_count(rule, "SUBSYSTEM==");
    assert_int_equal(lines, 2);
    snprintf(text, sizeof text, "{idVendor}==\"%04x\"", HP_USB_VENDOR);
    assert_int_equal(page_count(rule, text), lines);
    snprintf(text, sizeof text, "{idProduct}==\"%04x\"", HP_USB_PRODUCT);
    assert_int_equal(page_count(rule, text), lines);
    assert_int_equal(page_count(rule, "SUBSYSTEM==\"usb\""), 1);
    assert_int_equal(page_count(rule, "SUBSYSTEM==\"hidraw\""), 1);
    page_close(rule);
    (void)state;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_page_has_the_device),           cmocka_unit_test(the_page_has_every_report),
        cmocka_unit_test(the_page_has_commands_and_events),  cmocka_unit_test(fields_fill_their_reports),
        cmocka_unit_test(the_udev_rule_has_the_identifiers),
    };
    return cmocka_run_group_tests(tests, open_page, close_page);
}
