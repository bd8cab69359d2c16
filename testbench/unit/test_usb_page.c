/* docs/usb.md and the udev rule say what usb.def and the device itself say; and usb.def: fields fill their reports.
 */
#include "driver/gadget/gadget.h"
#include "testbench/support/board_host.h"
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

/* ---- the bytes shown ---- */

static void ignore(hp_urb *urb) {
    (void)urb;
}

/* Bytes of the answer to GET_DESCRIPTOR for the device or, with `interface`, for the HID. */
static size_t descriptor(hp_gadget *gadget, bool interface, unsigned type, uint8_t *bytes, size_t room) {
    hp_urb urb = {.bytes = bytes, .length = room, .done = ignore};
    const uint8_t setup[8] = {
        interface ? 0x81 : 0x80, 6, 0, (uint8_t)type, interface ? HP_USB_HID_INTERFACE : 0, 0, (uint8_t)room,
        (uint8_t)(room >> 8)};
    memcpy(urb.setup, setup, sizeof setup);
    hp_gadget_submit(gadget, &urb);
    while (hp_gadget_run(gadget)) {
    }
    assert_int_equal(urb.status, HP_URB_OK);
    return urb.moved;
}

/* Each block is a descriptor that the device side sends. */
static void the_page_shows_the_descriptors(void **state) {
    static const struct {
        const char *title;
        hp_usb_speed speed;
        bool interface;
        unsigned type;
    } shown[] = {
        {"device-high", HP_USB_HIGH, false, 1},          {"device-super", HP_USB_SUPER, false, 1},
        {"configuration-high", HP_USB_HIGH, false, 2},   {"configuration-super", HP_USB_SUPER, false, 2},
        {"object-store-super", HP_USB_SUPER, false, 15}, {"report", HP_USB_HIGH, true, 0x22},
    };
    enum { SHOWN = sizeof shown / sizeof shown[0], ROOM = 512 };
    uint8_t of_page[ROOM], of_device[ROOM];
    const char *title;
    for (unsigned i = 0; i < SHOWN; i++) {
        hp_gadget_def def = {
            .board = hpt_board("usb3", HP_ENGINE_QUICK), .serial = "HP-000001", .speed = shown[i].speed};
        hp_gadget *gadget;
        assert_int_equal(hp_gadget_create(&def, &gadget), HP_OK);
        size_t n = page_bytes(*state, i, of_page, ROOM, &title);
        assert_string_equal(title, shown[i].title);
        assert_int_equal(n, descriptor(gadget, shown[i].interface, shown[i].type, of_device, ROOM));
        assert_memory_equal(of_page, of_device, n);
        hp_gadget_destroy(gadget);
    }
    assert_int_equal(page_bytes(*state, SHOWN, of_page, ROOM, &title), 0);
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
        cmocka_unit_test(the_udev_rule_has_the_identifiers), cmocka_unit_test(the_page_shows_the_descriptors),
    };
    return cmocka_run_group_tests(tests, open_page, close_page);
}
