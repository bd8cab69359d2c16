/* The board as a USB device: what a host reads of it, byte by byte, and what goes through its endpoints. */
#include "driver/gadget/gadget.h"
#include "testbench/support/board_host.h"
#include "testbench/support/random.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { IN = 0x80, OUT = 0x00, DEVICE = 0, INTERFACE = 1, ENDPOINT = 2, CLASS = 0x20 };
enum { TRIANGLES = 27, RAYS = 200, ROOM = 600 * 1024 };

static float triangles[TRIANGLES * HP_TRIANGLE_WORDS], rays[RAYS * HP_RAY_WORDS];
static uint8_t buffer[ROOM];

static int make_input(void **state) {
    (void)state;
    hpt_triangles(7, TRIANGLES, 1, triangles);
    hpt_rays(8, RAYS, rays);
    return 0;
}

/* ---- a host ---- */

static const hp_usb_speed speeds[] = {HP_USB_HIGH, HP_USB_SUPER};

static hp_gadget_def def_of(hp_usb_speed speed) {
    return (hp_gadget_def){.board = hpt_board("usb3", HP_ENGINE_QUICK), .serial = "HP-000001", .speed = speed};
}

static void mark_done(hp_urb *urb) {
    assert_ptr_equal(urb->owner, NULL); /* once */
    urb->owner = urb;
}

static void submit(hp_gadget *gadget, hp_urb *urb) {
    urb->done = mark_done;
    urb->owner = NULL;
    hp_gadget_submit(gadget, urb);
    assert_null(urb->owner); /* never in submit */
}

static void run(hp_gadget *gadget) {
    unsigned rounds = 0;
    while (hp_gadget_run(gadget)) assert_true(++rounds < 100000);
}

/* Bytes of a control transfer, or -1 for a stall. */
static int control(hp_gadget *gadget, unsigned type, unsigned request, unsigned value, unsigned index, size_t length,
                   uint8_t *bytes) {
    hp_urb urb = {.bytes = bytes, .length = length};
    const uint8_t setup[8] = {(uint8_t)type,  (uint8_t)request,      (uint8_t)value,  (uint8_t)(value >> 8),
                              (uint8_t)index, (uint8_t)(index >> 8), (uint8_t)length, (uint8_t)(length >> 8)};
    memcpy(urb.setup, setup, 8);
    submit(gadget, &urb);
    run(gadget);
    assert_non_null(urb.owner);
    if (urb.status == HP_URB_OK) return (int)urb.moved;
    assert_int_equal(urb.status, HP_URB_STALL);
    assert_int_equal(urb.moved, 0);
    return -1;
}

static int get_descriptor(hp_gadget *gadget, unsigned type, unsigned index, size_t length, uint8_t *bytes) {
    return control(gadget, IN | DEVICE, 6, type << 8 | index, type == 3 ? 0x0409 : 0, length, bytes);
}

static hp_gadget *plugged(const hp_gadget_def *def) {
    hp_gadget *gadget;
    assert_int_equal(hp_gadget_create(def, &gadget), HP_OK);
    return gadget;
}

static void configure(hp_gadget *gadget) {
    assert_int_equal(control(gadget, OUT | DEVICE, 9, 1, 0, 0, NULL), 0);
}

static hp_gadget *configured(hp_usb_speed speed) {
    hp_gadget_def def = def_of(speed);
    hp_gadget *gadget = plugged(&def);
    configure(gadget);
    return gadget;
}

static size_t packet_size(const hp_gadget *gadget) {
    return hp_gadget_speed(gadget) == HP_USB_SUPER ? 1024 : 512;
}

static hp_urb out_urb(const uint8_t *bytes, size_t n, bool zero_packet) {
    return (hp_urb){.endpoint = 0x01, .bytes = (uint8_t *)bytes, .length = n, .zero_packet = zero_packet};
}

static hp_urb in_urb(uint8_t *bytes, size_t room) {
    return (hp_urb){.endpoint = 0x81, .bytes = bytes, .length = room};
}

static void send(hp_gadget *gadget, const uint8_t *bytes, size_t n, bool zero_packet) {
    hp_urb urb = out_urb(bytes, n, zero_packet);
    submit(gadget, &urb);
    run(gadget);
    assert_non_null(urb.owner);
    assert_int_equal(urb.status, HP_URB_OK);
    assert_int_equal(urb.moved, n);
}

static void send_packet(hp_gadget *gadget, const hpt_packet *packet) {
    send(gadget, packet->bytes, packet->n, true);
}

/* One IN urb; SIZE_MAX when it stays without an answer, and is taken back. */
static size_t receive(hp_gadget *gadget, uint8_t *bytes, size_t room) {
    hp_urb urb = in_urb(bytes, room);
    submit(gadget, &urb);
    run(gadget);
    bool silent = !urb.owner;
    if (silent) hp_gadget_unlink(gadget, &urb);
    assert_int_equal(urb.status, silent ? HP_URB_CANCELLED : HP_URB_OK);
    return silent ? SIZE_MAX : urb.moved;
}

static hp_header receive_packet(hp_gadget *gadget) {
    hp_header header;
    const uint8_t *payload;
    size_t n = receive(gadget, buffer, ROOM);
    assert_true(n <= ROOM);
    assert_int_equal(hp_packet_open(buffer, n, &header, &payload), HP_OK);
    return header;
}

/* HELLO, the scene of 27 triangles (1024 bytes), and a query of so many rays. */
static hpt_script script_of(unsigned queries, unsigned primaries) {
    hpt_script script = {0};
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, TRIANGLES, primaries, rays);
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
    for (unsigned i = 0; i < queries; i++) hpt_ask(&script, &query);
    return script;
}

static void open_session(hp_gadget *gadget, const hpt_script *script) {
    for (unsigned i = 0; i < 2; i++) {
        send_packet(gadget, &script->packets[i]);
        assert_int_equal(receive_packet(gadget).status, HP_OK);
    }
}

/* ---- descriptors ---- */

static const uint8_t high_device[] = {0x12, 0x01, 0x00, 0x02, 0x00, 0x00, 0x00, 0x40, 0x09,
                                      0x12, 0x01, 0x00, 0x00, 0x01, 0x01, 0x02, 0x03, 0x01};
static const uint8_t super_device[] = {0x12, 0x01, 0x20, 0x03, 0x00, 0x00, 0x00, 0x09, 0x09,
                                       0x12, 0x01, 0x00, 0x00, 0x01, 0x01, 0x02, 0x03, 0x01};
static const uint8_t qualifier[] = {0x0A, 0x06, 0x00, 0x02, 0x00, 0x00, 0x00, 0x40, 0x01, 0x00};
static const uint8_t bos[] = {0x05, 0x0F, 0x16, 0x00, 0x02, 0x07, 0x10, 0x02, 0x02, 0x00, 0x00,
                              0x00, 0x0A, 0x10, 0x03, 0x00, 0x0E, 0x00, 0x01, 0x0A, 0xFF, 0x07};
static const uint8_t high_configuration[] = {0x09, 0x02, 0x39, 0x00, 0x02, 0x01, 0x00, 0xC0, 0x00, /* configuration */
                                             0x09, 0x04, 0x00, 0x00, 0x02, 0xFF, 0x48, 0x00, 0x04, /* interface 0 */
                                             0x07, 0x05, 0x01, 0x02, 0x00, 0x02, 0x00,             /* bulk OUT */
                                             0x07, 0x05, 0x81, 0x02, 0x00, 0x02, 0x00,             /* bulk IN */
                                             0x09, 0x04, 0x01, 0x00, 0x01, 0x03, 0x00, 0x00, 0x05, /* interface 1 */
                                             0x09, 0x21, 0x11, 0x01, 0x00, 0x01, 0x22, 0x32, 0x00, /* HID */
                                             0x07, 0x05, 0x82, 0x03, 0x40, 0x00, 0x04};            /* interrupt IN */
static const uint8_t other_speed[] = {
    0x09, 0x07, 0x39, 0x00, 0x02, 0x01, 0x00, 0xC0, 0x00, 0x09, 0x04, 0x00, 0x00, 0x02, 0xFF, 0x48, 0x00, 0x04, 0x07,
    0x05, 0x01, 0x02, 0x40, 0x00, 0x00, 0x07, 0x05, 0x81, 0x02, 0x40, 0x00, 0x00, 0x09, 0x04, 0x01, 0x00, 0x01, 0x03,
    0x00, 0x00, 0x05, 0x09, 0x21, 0x11, 0x01, 0x00, 0x01, 0x22, 0x32, 0x00, 0x07, 0x05, 0x82, 0x03, 0x40, 0x00, 0x01};
static const uint8_t super_configuration[] = {
    0x09, 0x02, 0x4B, 0x00, 0x02, 0x01, 0x00, 0xC0, 0x00, 0x09, 0x04, 0x00, 0x00, 0x02, 0xFF, 0x48,
    0x00, 0x04, 0x07, 0x05, 0x01, 0x02, 0x00, 0x04, 0x00, 0x06, 0x30, 0x0F, 0x00, 0x00, 0x00, /* bulk OUT and its
                                                                                                 companion */
    0x07, 0x05, 0x81, 0x02, 0x00, 0x04, 0x00, 0x06, 0x30, 0x0F, 0x00, 0x00, 0x00,             /* bulk IN */
    0x09, 0x04, 0x01, 0x00, 0x01, 0x03, 0x00, 0x00, 0x05, 0x09, 0x21, 0x11, 0x01, 0x00, 0x01, 0x22,
    0x32, 0x00, 0x07, 0x05, 0x82, 0x03, 0x40, 0x00, 0x04, 0x06, 0x30, 0x00, 0x00, 0x40, 0x00}; /* interrupt IN */
static const uint8_t languages[] = {0x04, 0x03, 0x09, 0x04};
static const uint8_t serial_number[] = {20,  3, 'H', 0, 'P', 0, '-', 0, '0', 0,
                                        '0', 0, '0', 0, '0', 0, '0', 0, '1', 0};

static void expect_descriptor(hp_gadget *gadget, unsigned type, unsigned index, const uint8_t *bytes, size_t n) {
    uint8_t got[256];
    if (!bytes) {
        assert_int_equal(get_descriptor(gadget, type, index, 255, got), -1);
        return;
    }
    for (size_t length = 0; length < n + 5; length++) { /* cut to what is asked for, and nothing behind it written */
        memset(got, 0xEE, sizeof got);
        size_t want = length < n ? length : n;
        assert_int_equal(get_descriptor(gadget, type, index, length, got), want);
        assert_memory_equal(got, bytes, want);
        assert_int_equal(got[want], 0xEE);
    }
}

#define EXPECT(type, index, bytes) expect_descriptor(gadget, type, index, bytes, sizeof bytes)

static void descriptors_at_high_speed_are_these_bytes(void **state) {
    (void)state;
    hp_gadget_def def = def_of(HP_USB_HIGH);
    hp_gadget *gadget = plugged(&def);
    EXPECT(1, 0, high_device);
    EXPECT(2, 0, high_configuration);
    EXPECT(6, 0, qualifier);
    EXPECT(7, 0, other_speed);
    EXPECT(3, 0, languages);
    EXPECT(3, 3, serial_number);
    expect_descriptor(gadget, 15, 0, NULL, 0);
    expect_descriptor(gadget, 2, 1, NULL, 0);
    expect_descriptor(gadget, 3, 6, NULL, 0);
    assert_memory_equal(hp_gadget_device_descriptor(gadget), high_device, sizeof high_device);
    size_t n;
    const uint8_t *configuration = hp_gadget_configuration(gadget, &n);
    assert_int_equal(n, sizeof high_configuration);
    assert_memory_equal(configuration, high_configuration, n);
    hp_gadget_destroy(gadget);
}

static void descriptors_at_superspeed_are_these_bytes(void **state) {
    (void)state;
    hp_gadget_def def = def_of(HP_USB_SUPER);
    hp_gadget *gadget = plugged(&def);
    EXPECT(1, 0, super_device);
    EXPECT(2, 0, super_configuration);
    EXPECT(15, 0, bos);
    EXPECT(3, 3, serial_number);
    expect_descriptor(gadget, 6, 0, NULL, 0);
    expect_descriptor(gadget, 7, 0, NULL, 0);
    hp_gadget_destroy(gadget);
}

static void names_are_strings(void **state) {
    (void)state;
    static const char *const names[] = {"hitpipe", "collision board", "HP-000001", "packets", "reports"};
    hp_gadget_def def = def_of(HP_USB_HIGH);
    hp_gadget *gadget = plugged(&def);
    for (unsigned i = 0; i < 5; i++) {
        uint8_t got[255];
        int n = get_descriptor(gadget, 3, i + 1, sizeof got, got);
        assert_int_equal(n, 2 + 2 * strlen(names[i]));
        assert_int_equal(got[0], n);
        assert_int_equal(got[1], 3);
        for (size_t c = 0; names[i][c]; c++) assert_int_equal(hp_get16(got + 2 + 2 * c), names[i][c]);
    }
    hp_gadget_destroy(gadget);
}

static void identifiers_are_settable(void **state) {
    (void)state;
    hp_gadget_def def = def_of(HP_USB_HIGH);
    def.vendor = 0x16D0;
    def.product = 0xBEEF;
    hp_gadget *gadget = plugged(&def);
    assert_int_equal(hp_get16(hp_gadget_device_descriptor(gadget) + 8), 0x16D0);
    assert_int_equal(hp_get16(hp_gadget_device_descriptor(gadget) + 10), 0xBEEF);
    hp_gadget_destroy(gadget);
}

/* ---- what holds of any configuration ---- */

typedef struct walk {
    const uint8_t *at;
    unsigned interfaces, endpoints, missing; /* missing: endpoints that the interface still owes */
    bool companion;                          /* the next descriptor is one */
} walk;

static void walk_endpoint(walk *w, hp_usb_speed speed) {
    unsigned address = w->at[2], type = w->at[3], size = hp_get16(w->at + 4);
    assert_int_equal(w->at[0], 7);
    assert_true(w->missing-- > 0);
    if (type == 2) {
        assert_true(address == HP_USB_OUT_ENDPOINT || address == HP_USB_IN_ENDPOINT);
        assert_int_equal(size, speed == HP_USB_SUPER ? HP_USB_SUPER_PACKET : HP_USB_HIGH_PACKET);
    } else {
        assert_int_equal(type, 3);
        assert_int_equal(address, HP_USB_EVENT_ENDPOINT);
        assert_int_equal(size, HP_USB_REPORT_PACKET);
        assert_in_range(w->at[6], 1, 16); /* 2^(n-1) microframes */
    }
    w->endpoints++;
    w->companion = speed == HP_USB_SUPER;
}

static void walk_interface(walk *w) {
    bool data = w->interfaces == HP_USB_DATA_INTERFACE;
    assert_int_equal(w->at[0], 9);
    assert_int_equal(w->missing, 0);
    assert_int_equal(w->at[2], w->interfaces++);
    assert_int_equal(w->at[5], data ? 0xFF : 3);
    assert_int_equal(w->at[6], data ? HP_USB_DATA_SUBCLASS : 0);
    w->missing = w->at[4];
}

static void configurations_keep_the_rules(void **state) {
    (void)state;
    for (unsigned i = 0; i < 2; i++) {
        hp_gadget_def def = def_of(speeds[i]);
        hp_gadget *gadget = plugged(&def);
        size_t n;
        const uint8_t *bytes = hp_gadget_configuration(gadget, &n);
        assert_int_equal(hp_get16(bytes + 2), n);
        walk w = {.at = bytes + bytes[0]};
        for (; w.at < bytes + n; w.at += w.at[0]) {
            assert_true(w.at[0] >= 2 && w.at + w.at[0] <= bytes + n);
            assert_int_equal(w.companion, w.at[1] == 48);
            w.companion = false;
            if (w.at[1] == 4) walk_interface(&w);
            if (w.at[1] == 5) walk_endpoint(&w, speeds[i]);
            if (w.at[1] == 48) assert_int_equal(w.at[0], 6);
        }
        assert_ptr_equal(w.at, bytes + n);
        assert_int_equal(w.interfaces, bytes[4]);
        assert_int_equal(w.endpoints, 3);
        assert_false(w.companion);
        hp_gadget_destroy(gadget);
    }
}

/* ---- report descriptor ---- */

typedef struct hid_report {
    unsigned id, kind, bits; /* kind: as GET_REPORT has it */
} hid_report;

/* Reads the items that a report descriptor may have, as HID 1.11 section 6.2.2 has them. */
static unsigned read_reports(const uint8_t *bytes, size_t n, hid_report reports[8], unsigned *page) {
    unsigned id = 0, size = 0, count = 0, depth = 0, found = 0;
    for (size_t i = 0; i < n;) {
        unsigned item = bytes[i] & 0xFC, data = bytes[i] & 3, value = 0;
        data = data == 3 ? 4 : data;
        for (unsigned k = 0; k < data; k++) value |= (unsigned)bytes[i + 1 + k] << 8 * k;
        i += 1 + data;
        assert_true(i <= n);
        if (item == 0x04) *page = value;
        if (item == 0x74) size = value;
        if (item == 0x94) count = value;
        if (item == 0x84) id = value;
        if (item == 0xA0) depth++;
        if (item == 0xC0) depth--;
        if (item == 0x80 || item == 0xB0) {
            assert_int_equal(depth, 1);
            reports[found++] = (hid_report){id, item == 0x80 ? 1 : 3, size * count};
        }
    }
    assert_int_equal(depth, 0);
    return found;
}

enum { INPUT = 1, FEATURE = 3 };

static void the_report_descriptor_is_of_usb_def(void **state) {
    (void)state;
    hid_report reports[8];
    uint8_t bytes[256], hid[9];
    unsigned page = 0, at = 0;
    for (unsigned i = 0; i < 2; i++) {
        hp_gadget *gadget = configured(speeds[i]);
        int n = control(gadget, IN | INTERFACE, 6, 0x2200, HP_USB_HID_INTERFACE, 256, bytes);
        assert_true(n > 0);
        assert_int_equal(control(gadget, IN | INTERFACE, 6, 0x2100, HP_USB_HID_INTERFACE, 9, hid), 9);
        assert_memory_equal(hid, high_configuration + 41, 9);
        assert_int_equal(hp_get16(hid + 7), n);
        unsigned found = read_reports(bytes, (size_t)n, reports, &page);
        assert_int_equal(page, HP_USB_USAGE_PAGE);
        at = 0;
#define HP_USB_REPORT(NAME, number, KIND, length, meaning)                                                           \
    assert_true(at < found);                                                                                         \
    assert_int_equal(reports[at].id, number);                                                                        \
    assert_int_equal(reports[at].kind, KIND);                                                                        \
    assert_int_equal(reports[at].bits, 8 * (length));                                                                \
    at++;
#include <hitpipe/usb.def>
        assert_int_equal(at, found);
        assert_int_equal(control(gadget, IN | INTERFACE, 6, 0x2200, HP_USB_DATA_INTERFACE, 256, bytes), -1);
        assert_int_equal(control(gadget, IN | INTERFACE, 6, 0x2300, HP_USB_HID_INTERFACE, 256, bytes), -1);
        assert_int_equal(control(gadget, IN | INTERFACE, 6, 0x2201, HP_USB_HID_INTERFACE, 256, bytes), -1);
        hp_gadget_destroy(gadget);
    }
}

/* ---- usb.def itself ---- */

static void fields_fill_their_reports(void **state) {
    (void)state;
    unsigned filled[256] = {0};
#define HP_USB_FIELD(REPORT, name, offset, bits, meaning)                                                            \
    assert_int_equal(filled[HP_USB_REPORT_##REPORT], offset);                                                        \
    filled[HP_USB_REPORT_##REPORT] += (bits) / 8;
#include <hitpipe/usb.def>
#define HP_USB_REPORT(NAME, id, KIND, bytes, meaning)                                                                \
    assert_in_range(id, 1, 255);                                                                                     \
    assert_int_equal(filled[id], bytes);                                                                             \
    filled[id] = 0; /* so that the same ID twice is found */
#include <hitpipe/usb.def>
    unsigned controls = 0, events = 0;
#define HP_USB_CONTROL(NAME, code, since, meaning)                                                                   \
    assert_int_equal(code, ++controls);                                                                              \
    assert_in_range(since, 1, HP_USB_RELEASE >> 8);
#define HP_USB_EVENT(NAME, code, meaning) assert_int_equal(code, ++events);
#include <hitpipe/usb.def>
}

/* ---- requests ---- */

static void states_of_chapter_9(void **state) {
    (void)state;
    uint8_t bytes[8] = {0};
    hp_gadget_def def = def_of(HP_USB_HIGH);
    hp_gadget *gadget = plugged(&def);
    assert_int_equal(control(gadget, IN | DEVICE, 8, 0, 0, 1, bytes), 1);
    assert_int_equal(bytes[0], 0);
    assert_int_equal(control(gadget, OUT | DEVICE, 5, 17, 0, 0, NULL), 0);
    assert_int_equal(control(gadget, OUT | DEVICE, 5, 128, 0, 0, NULL), -1);
    assert_int_equal(control(gadget, IN | INTERFACE, 10, 0, 0, 1, bytes), -1); /* not configured */
    assert_int_equal(control(gadget, IN | ENDPOINT, 0, 0, 0x81, 2, bytes), -1);
    assert_int_equal(control(gadget, IN | INTERFACE | CLASS, 1, 0x301, 1, 8, bytes), -1);
    assert_int_equal(control(gadget, OUT | DEVICE, 9, 2, 0, 0, NULL), -1);
    configure(gadget);
    assert_int_equal(control(gadget, IN | DEVICE, 8, 0, 0, 1, bytes), 1);
    assert_int_equal(bytes[0], 1);
    assert_int_equal(control(gadget, IN | DEVICE, 0, 0, 0, 2, bytes), 2);
    assert_int_equal(hp_get16(bytes), 1); /* self-powered */
    for (unsigned i = 0; i < 3; i++) {
        bytes[0] = 9;
        assert_int_equal(control(gadget, IN | INTERFACE, 10, 0, i, 1, bytes), i < 2 ? 1 : -1);
        assert_int_equal(bytes[0], i < 2 ? 0 : 9);
        assert_int_equal(control(gadget, IN | INTERFACE, 0, 0, i, 2, bytes), i < 2 ? 2 : -1);
        assert_int_equal(control(gadget, OUT | INTERFACE, 11, 0, i, 0, NULL), i < 2 ? 0 : -1);
        assert_int_equal(control(gadget, OUT | INTERFACE, 11, 1, i, 0, NULL), -1);
    }
    assert_int_equal(control(gadget, OUT | DEVICE, 9, 0, 0, 0, NULL), 0);
    assert_int_equal(control(gadget, IN | DEVICE, 8, 0, 0, 1, bytes), 1);
    assert_int_equal(bytes[0], 0);
    hp_gadget_destroy(gadget);
}

/* Values and indices with which some request means something. */
static const unsigned values[] = {0, 1, 48, 0x100, 0x2200, 0x301, 0x303, 0x104};
static const unsigned indices[] = {0, 1, 0x81};

static bool any_succeeds(hp_gadget *gadget, unsigned type, unsigned request) {
    static const size_t lengths[] = {0, 2, 6, 13};
    for (unsigned v = 0; v < 8; v++)
        for (unsigned i = 0; i < 3; i++)
            for (unsigned l = 0; l < 4; l++) {
                uint8_t bytes[16] = {HP_USB_REPORT_CONTROL, HP_USB_CONTROL_ABORT};
                if (control(gadget, type, request, values[v], indices[i], lengths[l], bytes) < 0) continue;
                configure(gadget);
                return true;
            }
    return false;
}

/* Bit 0: at high speed, bit 1: at SuperSpeed. */
static unsigned known(unsigned type, unsigned request) {
    static const struct {
        unsigned type, request, at;
    } requests[] = {{0x80, 0, 3}, {0x80, 6, 3}, {0x80, 8, 3},  {0x81, 0, 3},  {0x81, 6, 3},  {0x81, 10, 3},
                    {0x82, 0, 3}, {0x00, 1, 2}, {0x00, 3, 2},  {0x00, 9, 3},  {0x00, 48, 2}, {0x00, 49, 2},
                    {0x01, 1, 2}, {0x01, 3, 2}, {0x01, 11, 3}, {0x02, 1, 3},  {0x02, 3, 3},  {0xA1, 1, 3},
                    {0xA1, 2, 3}, {0xA1, 3, 3}, {0x21, 9, 3},  {0x21, 10, 3}, {0x21, 11, 3}};
    for (unsigned i = 0; i < sizeof requests / sizeof *requests; i++)
        if (requests[i].type == type && requests[i].request == request) return requests[i].at;
    return 0;
}

static void every_other_request_stalls(void **state) {
    (void)state;
    for (unsigned i = 0; i < 2; i++) {
        hp_gadget *gadget = configured(speeds[i]);
        for (unsigned type = 0; type < 256; type++)
            for (unsigned request = 0; request < 256; request++)
                if (any_succeeds(gadget, type, request) != (known(type, request) >> i & 1))
                    fail_msg("request %02X %u", type, request);
        hp_gadget_destroy(gadget);
    }
}

/* The urb may have less room than wLength says, or more. */
static void a_data_stage_is_no_longer_than_urb_and_request(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    uint8_t bytes[64];
    for (size_t room = 0; room < 40; room++)
        for (uint8_t length = 0; length < 40; length++) {
            hp_urb urb = {.bytes = bytes, .length = room, .setup = {0x80, 6, 0, 1, 0, 0, length, 0}};
            memset(bytes, 0xEE, sizeof bytes);
            submit(gadget, &urb);
            run(gadget);
            size_t most = room < length ? room : length;
            assert_int_equal(urb.moved, most < 18 ? most : 18);
            assert_int_equal(bytes[urb.moved], 0xEE);
        }
    hp_gadget_destroy(gadget);
}

/* ---- halts ---- */

static int feature(hp_gadget *gadget, bool set, unsigned endpoint) {
    return control(gadget, OUT | ENDPOINT, set ? 3 : 1, 0, endpoint, 0, NULL);
}

static void a_halted_endpoint_stalls_until_cleared(void **state) {
    (void)state;
    static const unsigned endpoints[] = {0x01, 0x81, 0x82};
    hp_gadget *gadget = configured(HP_USB_HIGH);
    uint8_t status[2];
    for (unsigned i = 0; i < 3; i++) {
        hp_urb waits = {.endpoint = (uint8_t)endpoints[i], .bytes = buffer, .length = 512};
        assert_int_equal(feature(gadget, true, endpoints[i]), 0);
        assert_int_equal(control(gadget, IN | ENDPOINT, 0, 0, endpoints[i], 2, status), 2);
        assert_int_equal(hp_get16(status), 1);
        for (unsigned k = 0; k < 2; k++) { /* it stays halted */
            submit(gadget, &waits);
            run(gadget);
            assert_non_null(waits.owner);
            assert_int_equal(waits.status, HP_URB_STALL);
        }
        assert_int_equal(feature(gadget, false, endpoints[i]), 0);
        assert_int_equal(control(gadget, IN | ENDPOINT, 0, 0, endpoints[i], 2, status), 2);
        assert_int_equal(hp_get16(status), 0);
        submit(gadget, &waits);
        run(gadget);
        if (!waits.owner) hp_gadget_unlink(gadget, &waits);
        assert_int_not_equal(waits.status, HP_URB_STALL);
    }
    assert_int_equal(feature(gadget, true, 0x00), -1);
    assert_int_equal(feature(gadget, true, 0x02), -1);
    assert_int_equal(feature(gadget, true, 0x83), -1);
    hp_gadget_destroy(gadget);
}

/* Waiting urbs stall too when the halt comes. */
static void a_halt_ends_what_waits(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hp_urb waits = in_urb(buffer, 512);
    submit(gadget, &waits);
    run(gadget);
    assert_null(waits.owner);
    feature(gadget, true, 0x81);
    assert_non_null(waits.owner);
    assert_int_equal(waits.status, HP_URB_STALL);
    hp_gadget_destroy(gadget);
}

static void endpoints_that_are_not_there_stall(void **state) {
    (void)state;
    static const uint8_t addresses[] = {0x01, 0x81, 0x82, 0x02, 0x83, 0x80, 0x10};
    hp_gadget_def def = def_of(HP_USB_HIGH);
    hp_gadget *gadget = plugged(&def);
    for (unsigned i = 0; i < sizeof addresses; i++) {
        hp_urb urb = {.endpoint = addresses[i], .bytes = buffer, .length = 64};
        if (i == 3) configure(gadget); /* from here on the first three are */
        submit(gadget, &urb);
        run(gadget);
        assert_non_null(urb.owner);
        assert_int_equal(urb.status, HP_URB_STALL);
    }
    hp_gadget_destroy(gadget);
}

/* ---- queries ---- */

/* Sends a packet as urbs of `piece` bytes; ends it by the flag, or by an urb of none. */
static void send_cut(hp_gadget *gadget, const hpt_packet *packet, size_t piece, bool flag) {
    size_t at = 0;
    for (; packet->n - at > piece; at += piece) send(gadget, packet->bytes + at, piece, false);
    send(gadget, packet->bytes + at, packet->n - at, flag);
    if (!flag && packet->n % packet_size(gadget) == 0) send(gadget, NULL, 0, false);
}

/* The next transfer, through urbs of `piece` bytes; 0: there is none. */
static size_t receive_cut(hp_gadget *gadget, uint8_t *bytes, size_t piece) {
    size_t n = 0;
    for (;;) {
        assert_true(n + piece <= ROOM);
        size_t moved = receive(gadget, bytes + n, piece);
        if (moved == SIZE_MAX) {
            assert_int_equal(n, 0); /* every transfer ends */
            return 0;
        }
        n += moved;
        if (moved < piece) return n;
    }
}

/* Whatever the cut, the board answers what it answers without USB. */
static void check_cut(hp_gadget *gadget, const hpt_script *script, const hpt_log *log, size_t out, size_t in) {
    size_t at = 0;
    for (size_t i = 0; i < script->count; i++) {
        size_t n;
        send_cut(gadget, &script->packets[i], out, i & 1);
        while ((n = receive_cut(gadget, buffer, in))) {
            while (at < log->count && log->events[at].kind != HP_BOARD_SENT) at++;
            assert_true(at < log->count);
            assert_int_equal(n, log->events[at].n);
            if (buffer[HP_AT_HEADER_opcode] != HP_OPCODE_COUNTERS_REPLY)
                assert_memory_equal(buffer, log->events[at].bytes, n);
            at++;
        }
    }
    while (at < log->count) assert_int_not_equal(log->events[at++].kind, HP_BOARD_SENT);
}

static hpt_script mixed_script(void) {
    hpt_script script = script_of(1, RAYS);
    hpt_query all = hpt_query_all(HP_MODE_ALL, TRIANGLES, RAYS, rays);
    hpt_ask(&script, &all);
    hpt_counters(&script, false);
    hpt_query high = hpt_query_all(HP_MODE_CLOSEST, TRIANGLES, 53, rays); /* its RESULT has 1536 bytes */
    hpt_ask(&script, &high);
    hpt_query super = hpt_query_all(HP_MODE_CLOSEST, TRIANGLES, 181, rays); /* 5120 */
    hpt_ask(&script, &super);
    return script;
}

static void queries_are_answered_however_they_are_cut(void **state) {
    (void)state;
    for (unsigned i = 0; i < 2; i++) {
        hp_gadget_def def = def_of(speeds[i]);
        hpt_script script = mixed_script();
        def.board.config.packet_results = 1000;
        hpt_log log = hpt_play(&def.board, &script, 1);
        hp_gadget *gadget = plugged(&def);
        configure(gadget);
        for (size_t out = 1024; out < 16384; out *= 2)
            for (size_t in = 1024; in < 65536; in *= 4) {
                check_cut(gadget, &script, &log, out, in);
            }
        check_cut(gadget, &script, &log, ROOM, 524288 + 1024);
        hp_gadget_destroy(gadget);
        hpt_log_free(&log);
        hpt_script_free(&script);
    }
}

/* ---- packet sizes and zero-length packets ---- */

static void a_full_last_packet_is_followed_by_an_empty_one(void **state) {
    (void)state;
    for (unsigned i = 0; i < 2; i++) {
        hp_gadget *gadget = configured(speeds[i]);
        unsigned primaries = i ? 181 : 53;
        size_t n = i ? 5120 : 1536, size = packet_size(gadget);
        hpt_script script = script_of(1, primaries);
        for (unsigned k = 0; k < 3; k++) {
            open_session(gadget, &script);
            send_packet(gadget, &script.packets[2]);
            if (k == 0) { /* room for more: the empty packet ends this urb */
                assert_int_equal(receive(gadget, buffer, n + size), n);
            } else if (k == 1) { /* the urb is full before it */
                assert_int_equal(receive(gadget, buffer, n), n);
                assert_int_equal(receive(gadget, buffer, size), 0);
            } else { /* it fits an urb of no room */
                assert_int_equal(receive(gadget, buffer, n), n);
                assert_int_equal(receive(gadget, buffer, 0), 0);
            }
            assert_int_equal(receive(gadget, buffer, size), SIZE_MAX);
        }
        hp_gadget_destroy(gadget);
        hpt_script_free(&script);
    }
}

/* Without its end a transfer goes on with whatever comes next. */
static void a_transfer_without_an_end_goes_on(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_SUPER);
    hpt_script script = script_of(1, 1);
    send_packet(gadget, &script.packets[0]);
    receive_packet(gadget);
    assert_int_equal(script.packets[1].n, 1024);
    send(gadget, script.packets[1].bytes, 1024, false);
    assert_int_equal(receive(gadget, buffer, 1024), SIZE_MAX);
    send_packet(gadget, &script.packets[2]);
    hp_header header = receive_packet(gadget);
    assert_int_equal(header.status, HP_ERROR_LENGTH);
    assert_int_equal(header.tag, 2);
    send(gadget, script.packets[1].bytes, 1024, false);
    send(gadget, NULL, 0, false); /* the end, late */
    assert_int_equal(receive_packet(gadget).opcode, HP_OPCODE_ACK);
    send(gadget, script.packets[1].bytes, 1024, false);
    assert_int_equal(feature(gadget, false, 0x01), 0); /* the host gives it up */
    send_packet(gadget, &script.packets[2]);
    assert_int_equal(receive_packet(gadget).opcode, HP_OPCODE_RESULT);
    send(gadget, NULL, 0, false); /* a transfer of no bytes is no packet */
    assert_int_equal(receive_packet(gadget).status, HP_ERROR_LENGTH);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void a_transfer_without_bound_is_refused(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hpt_script script = script_of(0, 0);
    memset(buffer, 0x55, ROOM);
    memcpy(buffer, script.packets[0].bytes, script.packets[0].n);
    for (unsigned i = 0; i < 20; i++) send(gadget, buffer, ROOM, false); /* 12 MB */
    send(gadget, buffer, 1, false);
    assert_int_equal(receive_packet(gadget).status, HP_ERROR_LENGTH);
    open_session(gadget, &script);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* ---- overflow ---- */

/* A USB packet that the urb has no room for stays; what went before it is taken. */
static void an_urb_too_small_overflows(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hpt_script script = script_of(1, RAYS); /* 5652 bytes */
    open_session(gadget, &script);
    send_packet(gadget, &script.packets[2]);
    static const struct {
        size_t room, moved;
        hp_urb_status status;
    } urbs[] = {{0, 0, HP_URB_OVERFLOW}, {511, 0, HP_URB_OVERFLOW},     {1100, 1024, HP_URB_OVERFLOW},
                {512, 512, HP_URB_OK},   {4094, 3584, HP_URB_OVERFLOW}, {19, 0, HP_URB_OVERFLOW},
                {532, 532, HP_URB_OK}};
    size_t at = 0;
    for (unsigned i = 0; i < 7; i++) {
        hp_urb urb = in_urb(buffer + at, urbs[i].room);
        submit(gadget, &urb);
        run(gadget);
        assert_int_equal(urb.status, urbs[i].status);
        assert_int_equal(urb.moved, urbs[i].moved);
        at += urb.moved;
    }
    hp_header header;
    const uint8_t *payload;
    assert_int_equal(hp_packet_open(buffer, at, &header, &payload), HP_OK);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* The rest of a packet is not gone on with behind a cleared halt; packets behind it are. */
static void a_cleared_halt_begins_with_a_whole_packet(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hpt_script script = script_of(2, 53);
    open_session(gadget, &script);
    send_packet(gadget, &script.packets[2]);
    send_packet(gadget, &script.packets[3]);
    assert_int_equal(receive(gadget, buffer, 1536), 1536); /* all but the empty packet */
    assert_int_equal(feature(gadget, true, 0x81), 0);
    assert_int_equal(feature(gadget, false, 0x81), 0);
    assert_int_equal(feature(gadget, false, 0x81), 0);
    assert_int_equal(receive_packet(gadget).tag, 4);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* ---- order, waiting, unlinking ---- */

/* Answers wait in the gadget, and behind a few of them the board does. Nothing is lost. */
static void answers_wait_for_the_host(void **state) {
    (void)state;
    hp_gadget_def def = def_of(HP_USB_SUPER);
    def.board.config.packet_results = 10;
    hp_gadget *gadget = plugged(&def);
    configure(gadget);
    hpt_script script = script_of(1, RAYS);
    open_session(gadget, &script);
    hp_urb urb = out_urb(script.packets[2].bytes, script.packets[2].n, true);
    submit(gadget, &urb);
    run(gadget);
    assert_non_null(urb.owner);
    for (unsigned i = 0; i < RAYS / 10; i++) {
        hp_header header = receive_packet(gadget);
        assert_int_equal(header.opcode, HP_OPCODE_RESULT);
        assert_int_equal(hp_get64(buffer + HP_HEADER_BYTES + HP_AT_RESULT_first), 10 * i);
        assert_int_equal(header.flags, i == RAYS / 10 - 1);
    }
    assert_int_equal(receive(gadget, buffer, ROOM), SIZE_MAX);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void urbs_are_done_in_order(void **state) {
    (void)state;
    enum { MANY = 6 };
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hpt_script script = script_of(MANY - 2, 1);
    static uint8_t answers[MANY][4096];
    hp_urb out[MANY], in[MANY];
    for (unsigned i = 0; i < MANY; i++) {
        out[i] = out_urb(script.packets[i].bytes, script.packets[i].n, true);
        in[i] = in_urb(answers[i], sizeof answers[i]);
        submit(gadget, &in[i]);
    }
    for (unsigned i = 0; i < MANY; i++) {
        submit(gadget, &out[i]);
        run(gadget);
        assert_non_null(out[i].owner);
        assert_non_null(in[i].owner);
        if (i + 1 < MANY) assert_null(in[i + 1].owner);
        assert_int_equal(hp_get32(answers[i] + HP_AT_HEADER_tag), i + 1);
    }
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void an_unlinked_urb_is_cancelled(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hpt_script script = script_of(1, 1);
    uint8_t spare[3][1024];
    hp_urb in[3];
    for (unsigned i = 0; i < 3; i++) {
        in[i] = in_urb(spare[i], sizeof spare[i]);
        submit(gadget, &in[i]);
    }
    hp_gadget_unlink(gadget, &in[1]);
    assert_non_null(in[1].owner);
    assert_int_equal(in[1].status, HP_URB_CANCELLED);
    hp_gadget_unlink(gadget, &in[1]); /* done: left alone, or mark_done would fail */
    hp_gadget_unlink(gadget, &in[2]);
    send_packet(gadget, &script.packets[0]);
    assert_int_equal(in[0].status, HP_URB_OK);
    hp_gadget_unlink(gadget, &in[0]);
    send_packet(gadget, &script.packets[1]);
    assert_int_equal(receive_packet(gadget).opcode, HP_OPCODE_ACK);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* A board with a slow link to it, so that answers come while a packet crosses. */
static hp_gadget *slow_gadget(void) {
    hp_gadget_def def = def_of(HP_USB_SUPER);
    def.board.config.packet_buffers = 8;
    def.board.config.link_to_board_rate = 10000000;
    hp_gadget *gadget = plugged(&def);
    configure(gadget);
    return gadget;
}

/* Three queries are submitted: the first one is answered, the second one crosses the link, the third one waits. */
static void make_busy(hp_gadget *gadget, const hpt_script *script, hp_urb out[3]) {
    open_session(gadget, script);
    for (unsigned i = 0; i < 3; i++) {
        out[i] = out_urb(script->packets[2 + i].bytes, script->packets[2 + i].n, true);
        submit(gadget, &out[i]);
    }
    while (!out[0].owner) assert_true(hp_gadget_run(gadget));
    assert_true(hp_gadget_run(gadget));
    assert_null(out[1].owner);
}

/* What the board already has of an urb stays; its bytes may be reused at once. */
static void an_urb_that_crosses_is_cancelled(void **state) {
    (void)state;
    hp_gadget *gadget = slow_gadget();
    hpt_script script = script_of(3, RAYS);
    hp_urb out[3];
    make_busy(gadget, &script, out);
    hp_gadget_unlink(gadget, &out[1]);
    hp_gadget_unlink(gadget, &out[2]);
    assert_int_equal(out[1].status, HP_URB_CANCELLED);
    assert_int_equal(out[2].status, HP_URB_CANCELLED);
    memset(script.packets[3].bytes, 0, script.packets[3].n);
    assert_int_equal(receive_packet(gadget).tag, 3);
    hp_header header = receive_packet(gadget);
    assert_int_equal(header.tag, 4);
    assert_int_equal(header.opcode, HP_OPCODE_RESULT);
    assert_int_equal(receive(gadget, buffer, ROOM), SIZE_MAX);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* ---- reports ---- */

static int get_report(hp_gadget *gadget, unsigned kind, unsigned id, uint8_t *bytes, size_t room) {
    return control(gadget, IN | INTERFACE | CLASS, 1, kind << 8 | id, HP_USB_HID_INTERFACE, room, bytes);
}

static int set_report(hp_gadget *gadget, unsigned kind, unsigned id, uint8_t *bytes, size_t n) {
    return control(gadget, OUT | INTERFACE | CLASS, 9, kind << 8 | id, HP_USB_HID_INTERFACE, n, bytes);
}

/* Sends a command, and returns what reading it back says of its outcome. */
static unsigned command(hp_gadget *gadget, unsigned code, unsigned status, uint64_t argument) {
    uint8_t report[1 + HP_USB_BYTES_CONTROL] = {HP_USB_REPORT_CONTROL}, back[64];
    hp_put16(report + 1 + HP_USB_AT_CONTROL_command, (uint16_t)code);
    hp_put16(report + 1 + HP_USB_AT_CONTROL_status, (uint16_t)status);
    hp_put64(report + 1 + HP_USB_AT_CONTROL_argument, argument);
    assert_int_equal(set_report(gadget, FEATURE, HP_USB_REPORT_CONTROL, report, sizeof report), sizeof report);
    assert_int_equal(get_report(gadget, FEATURE, HP_USB_REPORT_CONTROL, back, sizeof back), sizeof report);
    assert_memory_equal(back, report, 3);
    assert_memory_equal(back + 1 + HP_USB_AT_CONTROL_argument, report + 1 + HP_USB_AT_CONTROL_argument, 8);
    return hp_get16(back + 1 + HP_USB_AT_CONTROL_status);
}

static void reports_of_other_kinds_and_sizes_stall(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    uint8_t bytes[64] = {HP_USB_REPORT_CONTROL, HP_USB_CONTROL_ABORT};
    for (unsigned kind = 0; kind < 5; kind++)
        for (unsigned id = 0; id < 8; id++) {
            uint8_t got[64];
            bool input = id == HP_USB_REPORT_EVENT;
            bool there = id >= 1 && id <= 4 && kind == (input ? INPUT : FEATURE);
            assert_int_equal(get_report(gadget, kind, id, got, sizeof got) > 0, there);
            if (there) assert_int_equal(got[0], id);
        }
    for (unsigned kind = 0; kind < 5; kind++)
        for (uint8_t id = 0; id < 8; id++)
            for (size_t n = 0; n < 20; n++) {
                bool right = kind == FEATURE && id == HP_USB_REPORT_CONTROL && n == 1 + HP_USB_BYTES_CONTROL;
                bytes[0] = id;
                assert_int_equal(set_report(gadget, kind, id, bytes, n), right ? (int)n : -1);
            }
    bytes[0] = HP_USB_REPORT_EVENT; /* another ID in the report than in the request */
    assert_int_equal(set_report(gadget, FEATURE, HP_USB_REPORT_CONTROL, bytes, 13), -1);
    hp_gadget_destroy(gadget);
}

static void identity_says_what_the_board_is(void **state) {
    (void)state;
    hp_gadget_def def = def_of(HP_USB_SUPER);
    uint8_t got[64], *identity = got + 1;
    strcpy(def.board.config.name, "a board of 31 bytes in its name");
    def.board.config.pipes = 1u << HP_PAIR_RAY_TRIANGLE | 1u << HP_PAIR_OBB_OBB;
    def.serial = "123456789012";
    hp_gadget *gadget = plugged(&def);
    configure(gadget);
    assert_int_equal(get_report(gadget, FEATURE, HP_USB_REPORT_IDENTITY, got, 64), 1 + HP_USB_BYTES_IDENTITY);
    assert_int_equal(hp_get16(identity + HP_USB_AT_IDENTITY_protocol), 1);
    assert_int_equal(hp_get16(identity + HP_USB_AT_IDENTITY_reports), 1);
    assert_int_equal(hp_get32(identity + HP_USB_AT_IDENTITY_pairs), 6);
    assert_int_equal(hp_get64(identity + HP_USB_AT_IDENTITY_clock_hz), 100000000);
    assert_memory_equal(identity + HP_USB_AT_IDENTITY_serial, "123456789012", 12);
    assert_string_equal((char *)identity + HP_USB_AT_IDENTITY_name, "a board of 31 bytes in its name");
    hp_gadget_destroy(gadget);
}

typedef struct health {
    double celsius;
    unsigned link, speed, refused, crc, sequence, lost, resets;
    uint64_t packets;
} health;

static health ask_health(hp_gadget *gadget) {
    uint8_t got[64], *at = got + 1;
    assert_int_equal(get_report(gadget, FEATURE, HP_USB_REPORT_HEALTH, got, 64), 1 + HP_USB_BYTES_HEALTH);
    assert_int_equal(hp_get32(at + HP_USB_AT_HEALTH_reserved), 0);
    return (health){.celsius = (int16_t)hp_get16(at + HP_USB_AT_HEALTH_temperature) / 256.0,
                    .link = at[HP_USB_AT_HEALTH_link],
                    .speed = at[HP_USB_AT_HEALTH_speed],
                    .packets = hp_get64(at + HP_USB_AT_HEALTH_packets),
                    .refused = hp_get32(at + HP_USB_AT_HEALTH_refused),
                    .crc = hp_get32(at + HP_USB_AT_HEALTH_crc),
                    .sequence = hp_get32(at + HP_USB_AT_HEALTH_sequence),
                    .lost = hp_get32(at + HP_USB_AT_HEALTH_events_lost),
                    .resets = hp_get32(at + HP_USB_AT_HEALTH_resets)};
}

static void health_says_how_the_board_is(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_SUPER);
    hpt_script script = script_of(2, 1);
    health at = ask_health(gadget);
    assert_int_equal(at.link, 0);
    assert_int_equal(at.speed, 5);
    assert_true(at.celsius >= 35 && at.celsius <= 65);
    open_session(gadget, &script);
    send_packet(gadget, &script.packets[3]);
    assert_int_equal(receive_packet(gadget).status, HP_ERROR_SEQUENCE);
    script.packets[2].bytes[60] ^= 1;
    send_packet(gadget, &script.packets[2]);
    assert_int_equal(receive_packet(gadget).status, HP_ERROR_CRC);
    send_packet(gadget, &script.packets[3]);
    receive_packet(gadget);
    at = ask_health(gadget);
    assert_int_equal(at.link, 1);
    assert_int_equal(at.packets, 2);
    assert_int_equal(at.refused, 3);
    assert_int_equal(at.crc, 1);
    assert_int_equal(at.sequence, 2);
    assert_int_equal(at.resets, 0);
    assert_int_equal(command(gadget, HP_USB_CONTROL_RESET, 0, 0), HP_OK);
    at = ask_health(gadget);
    assert_int_equal(at.link, 0);
    assert_int_equal(at.packets, 2);
    assert_int_equal(at.resets, 1);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void commands_that_are_none_are_refused(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_SUPER);
    hpt_script script = script_of(0, 0);
    uint8_t back[13];
    assert_int_equal(get_report(gadget, FEATURE, HP_USB_REPORT_CONTROL, back, 13), 13);
    for (unsigned i = 1; i < 13; i++) assert_int_equal(back[i], 0); /* there was none yet */
    open_session(gadget, &script);
    assert_int_equal(command(gadget, 0, 0, 0), HP_ERROR_OPCODE);
    assert_int_equal(command(gadget, 4, 0, 0), HP_ERROR_OPCODE);
    assert_int_equal(command(gadget, HP_USB_CONTROL_RESET, 0, 1), HP_ERROR_FIELD);
    assert_int_equal(command(gadget, HP_USB_CONTROL_RESET, 1, 0), HP_ERROR_FIELD);
    assert_int_equal(command(gadget, HP_USB_CONTROL_ABORT, 0, UINT64_C(1) << 63), HP_ERROR_FIELD);
    assert_int_equal(command(gadget, HP_USB_CONTROL_CLOCK, 0, 0), HP_ERROR_FIELD);
    assert_int_equal(command(gadget, HP_USB_CONTROL_CLOCK, 0, UINT64_C(20000000000)), HP_ERROR_FIELD);
    assert_int_equal(ask_health(gadget).link, 1); /* nothing was done */
    assert_int_equal(ask_health(gadget).resets, 0);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void a_soft_reset_drops_what_is_under_way(void **state) {
    (void)state;
    hp_gadget *gadget = slow_gadget();
    hpt_script script = script_of(3, RAYS);
    hp_urb out[3];
    make_busy(gadget, &script, out);
    assert_int_equal(command(gadget, HP_USB_CONTROL_RESET, 0, 0), HP_OK);
    assert_int_equal(out[1].status, HP_URB_OK); /* the device had it all */
    assert_int_equal(out[1].moved, out[1].length);
    hp_header header = receive_packet(gadget); /* the last one came behind the reset: there is no session */
    assert_int_equal(header.tag, 5);
    assert_int_equal(header.status, HP_ERROR_SEQUENCE);
    assert_int_equal(receive(gadget, buffer, ROOM), SIZE_MAX);
    open_session(gadget, &script);
    send_packet(gadget, &script.packets[2]);
    assert_int_equal(receive_packet(gadget).status, HP_OK);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void abort_drops_what_has_not_begun(void **state) {
    (void)state;
    hp_gadget *gadget = slow_gadget();
    hpt_script script = script_of(3, RAYS);
    hp_urb out[3];
    make_busy(gadget, &script, out);
    assert_int_equal(command(gadget, HP_USB_CONTROL_ABORT, 0, 0), HP_OK);
    assert_non_null(out[1].owner);
    assert_int_equal(out[1].status, HP_URB_OK);
    assert_int_equal(receive_packet(gadget).tag, 3); /* it had begun */
    hp_header header = receive_packet(gadget);       /* it came behind the abort: one is missing before it */
    assert_int_equal(header.tag, 5);
    assert_int_equal(header.status, HP_ERROR_SEQUENCE);
    assert_int_equal(header.sequence, 3);
    assert_int_equal(receive(gadget, buffer, ROOM), SIZE_MAX);
    send_packet(gadget, &script.packets[3]);
    header = receive_packet(gadget);
    assert_int_equal(header.tag, 4);
    assert_int_equal(header.status, HP_OK);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

static void the_clock_is_selected(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_SUPER);
    hpt_script script = script_of(0, 0);
    uint8_t got[64];
    assert_int_equal(command(gadget, HP_USB_CONTROL_CLOCK, 0, 125000000), HP_OK);
    assert_int_equal(get_report(gadget, FEATURE, HP_USB_REPORT_IDENTITY, got, 64), 1 + HP_USB_BYTES_IDENTITY);
    assert_int_equal(hp_get64(got + 1 + HP_USB_AT_IDENTITY_clock_hz), 100000000);
    send_packet(gadget, &script.packets[0]);
    receive_packet(gadget);
    assert_int_equal(hp_get64(buffer + HP_HEADER_BYTES + HP_AT_HELLO_REPLY_clock_hz), 125000000);
    get_report(gadget, FEATURE, HP_USB_REPORT_IDENTITY, got, 64);
    assert_int_equal(hp_get64(got + 1 + HP_USB_AT_IDENTITY_clock_hz), 125000000);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* ---- events ---- */

typedef struct event {
    unsigned kind, status;
    uint32_t number, tag;
    uint64_t clocks;
} event;

static event read_event(const uint8_t *report) {
    assert_int_equal(report[0], HP_USB_REPORT_EVENT);
    return (event){hp_get16(report + 1 + HP_USB_AT_EVENT_kind), hp_get16(report + 1 + HP_USB_AT_EVENT_status),
                   hp_get32(report + 1 + HP_USB_AT_EVENT_number), hp_get32(report + 1 + HP_USB_AT_EVENT_tag),
                   hp_get64(report + 1 + HP_USB_AT_EVENT_clocks)};
}

/* False: there is none. */
static bool next_event(hp_gadget *gadget, event *next) {
    uint8_t report[64];
    hp_urb urb = {.endpoint = 0x82, .bytes = report, .length = sizeof report};
    submit(gadget, &urb);
    run(gadget);
    if (!urb.owner) {
        hp_gadget_unlink(gadget, &urb);
        return false;
    }
    assert_int_equal(urb.status, HP_URB_OK);
    assert_int_equal(urb.moved, 1 + HP_USB_BYTES_EVENT);
    *next = read_event(report);
    return true;
}

static void expect_event(hp_gadget *gadget, unsigned kind, unsigned status, uint32_t number, uint32_t tag) {
    event next;
    assert_true(next_event(gadget, &next));
    assert_int_equal(next.kind, kind);
    assert_int_equal(next.status, status);
    assert_int_equal(next.number, number);
    assert_int_equal(next.tag, tag);
}

static void what_happens_is_told(void **state) {
    (void)state;
    hp_gadget_def def = def_of(HP_USB_SUPER);
    hpt_script script = script_of(2, RAYS);
    uint8_t got[64];
    event next, last;
    def.board.config.packet_results = 30; /* answers of several packets make one event */
    hp_gadget *gadget = plugged(&def);
    configure(gadget);
    expect_event(gadget, HP_USB_EVENT_RESET, HP_OK, 0, HP_NO_TAG);
    assert_false(next_event(gadget, &next));
    open_session(gadget, &script);
    send_packet(gadget, &script.packets[3]);
    assert_int_equal(receive_packet(gadget).status, HP_ERROR_SEQUENCE);
    send_packet(gadget, &script.packets[2]);
    while (!(receive_packet(gadget).flags & HP_FLAG_LAST)) {
    }
    command(gadget, HP_USB_CONTROL_RESET, 0, 0);
    expect_event(gadget, HP_USB_EVENT_PACKET_DONE, HP_OK, 1, 1);
    expect_event(gadget, HP_USB_EVENT_PACKET_DONE, HP_OK, 2, 2);
    expect_event(gadget, HP_USB_EVENT_PACKET_ERROR, HP_ERROR_SEQUENCE, 3, 4);
    assert_true(next_event(gadget, &last));
    assert_int_equal(last.kind, HP_USB_EVENT_PACKET_DONE);
    assert_int_equal(last.tag, 3);
    assert_true(last.clocks > RAYS * TRIANGLES);
    expect_event(gadget, HP_USB_EVENT_RESET, HP_OK, 5, HP_NO_TAG);
    assert_false(next_event(gadget, &next));
    assert_int_equal(get_report(gadget, INPUT, HP_USB_REPORT_EVENT, got, 64), 1 + HP_USB_BYTES_EVENT);
    assert_int_equal(read_event(got).number, 5);
    assert_int_equal(ask_health(gadget).lost, 0);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* Nobody looks for long: the newest are there, the others counted. */
static void events_that_nobody_fetches_are_lost(void **state) {
    (void)state;
    enum { MANY = 200 };
    hp_gadget *gadget = configured(HP_USB_SUPER);
    event next;
    for (unsigned i = 1; i < MANY; i++) command(gadget, HP_USB_CONTROL_RESET, 0, 0);
    assert_true(next_event(gadget, &next));
    assert_int_equal(next.number, MANY - 64);
    assert_int_equal(ask_health(gadget).lost, next.number);
    for (uint32_t number = next.number + 1; number < MANY; number++)
        expect_event(gadget, HP_USB_EVENT_RESET, HP_OK, number, HP_NO_TAG);
    assert_false(next_event(gadget, &next));
    hp_gadget_destroy(gadget);
}

static void an_event_stays_for_an_urb_that_has_room(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_SUPER);
    hp_urb urb = {.endpoint = 0x82, .bytes = buffer, .length = 20};
    submit(gadget, &urb);
    run(gadget);
    assert_int_equal(urb.status, HP_URB_OVERFLOW);
    expect_event(gadget, HP_USB_EVENT_RESET, HP_OK, 0, HP_NO_TAG);
    hp_gadget_destroy(gadget);
}

/* ---- resets ---- */

static void a_bus_reset_begins_anew(void **state) {
    (void)state;
    hp_gadget *gadget = slow_gadget();
    hpt_script script = script_of(3, RAYS);
    hp_urb out[3], in = in_urb(buffer, 512);
    uint8_t configuration;
    event next;
    feature(gadget, true, 0x82);
    make_busy(gadget, &script, out);
    submit(gadget, &in);
    hp_gadget_reset(gadget);
    assert_int_equal(out[1].status, HP_URB_CANCELLED);
    assert_int_equal(out[2].status, HP_URB_CANCELLED);
    assert_int_equal(in.status, HP_URB_CANCELLED);
    assert_int_equal(control(gadget, IN | DEVICE, 8, 0, 0, 1, &configuration), 1);
    assert_int_equal(configuration, 0);
    configure(gadget);
    assert_int_equal(ask_health(gadget).link, 0);
    assert_int_equal(ask_health(gadget).resets, 0); /* of those asked for by report CONTROL */
    assert_int_equal(ask_health(gadget).lost, 4);   /* the configuration, and three packets */
    expect_event(gadget, HP_USB_EVENT_RESET, HP_OK, 4, HP_NO_TAG);
    expect_event(gadget, HP_USB_EVENT_RESET, HP_OK, 5, HP_NO_TAG);
    assert_false(next_event(gadget, &next));
    assert_int_equal(receive(gadget, buffer, ROOM), SIZE_MAX);
    open_session(gadget, &script);
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* Who configures the device or selects the data interface begins anew as well. */
static void configuring_resets_the_board(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_SUPER);
    hpt_script script = script_of(1, RAYS);
    for (unsigned i = 0; i < 3; i++) {
        open_session(gadget, &script);
        send_packet(gadget, &script.packets[2]);
        send(gadget, script.packets[1].bytes, 1024, false);
        if (i == 0) configure(gadget);
        if (i > 0) assert_int_equal(control(gadget, OUT | INTERFACE, 11, 0, i - 1, 0, NULL), 0);
        assert_int_equal(ask_health(gadget).link, i == 2); /* the HID is another function */
        assert_int_equal(receive(gadget, buffer, ROOM) == SIZE_MAX, i != 2);
    }
    hp_gadget_destroy(gadget);
    hpt_script_free(&script);
}

/* Everything that was submitted ends once, whenever the gadget does. */
static void the_end_cancels_everything(void **state) {
    (void)state;
    for (unsigned rounds = 0; rounds < 12; rounds++) {
        hp_gadget *gadget = configured(HP_USB_SUPER);
        hpt_script script = script_of(1, RAYS);
        hp_urb urbs[8];
        for (unsigned i = 0; i < 8; i++) {
            if (i < 3)
                urbs[i] = out_urb(script.packets[i].bytes, script.packets[i].n, true);
            else
                urbs[i] = (hp_urb){.endpoint = i < 5 ? 0x81 : i < 7 ? 0x82 : 0x55, .bytes = buffer, .length = 4096};
            submit(gadget, &urbs[i]);
        }
        for (unsigned i = 0; i < rounds; i++) hp_gadget_run(gadget);
        hp_gadget_destroy(gadget);
        for (unsigned i = 0; i < 8; i++) assert_non_null(urbs[i].owner);
        hpt_script_free(&script);
    }
}

/* ---- a host that acts in `done` ---- */

typedef struct eager {
    hp_gadget *gadget;
    hp_urb *other;
    unsigned times;
} eager;

static void again(hp_urb *urb) {
    eager *e = urb->owner;
    e->times++;
    if (e->other) hp_gadget_unlink(e->gadget, e->other);
    hp_gadget_submit(e->gadget, urb);
}

/* An endpoint that always stalls must not keep run from returning. */
static void run_returns_to_an_eager_host(void **state) {
    (void)state;
    hp_gadget *gadget = configured(HP_USB_HIGH);
    hp_urb other = in_urb(buffer, 512);
    eager e = {gadget, &other, 0};
    hp_urb urb = {.endpoint = 0x01, .bytes = buffer, .length = 64, .done = again, .owner = &e};
    feature(gadget, true, 0x01);
    submit(gadget, &other);
    hp_gadget_submit(gadget, &urb);
    for (unsigned i = 1; i < 5; i++) {
        assert_true(hp_gadget_run(gadget));
        assert_int_equal(e.times, i);
        assert_int_equal(other.status, HP_URB_CANCELLED);
        e.other = NULL;
    }
    urb.owner = NULL;
    urb.done = mark_done;
    hp_gadget_destroy(gadget);
}

/* ---- defs ---- */

static hp_status creating(hp_gadget_def def) {
    hp_gadget *gadget = (hp_gadget *)&gadget;
    hp_status status = hp_gadget_create(&def, &gadget);
    assert_int_equal(status == HP_OK, gadget != NULL);
    hp_gadget_destroy(gadget);
    return status;
}

static void a_device_that_cannot_be_is_refused(void **state) {
    (void)state;
    static const char *const serials[] = {NULL, "", "1234567890123", "a b", "a\n", "\xC3\xA4"};
    hp_gadget_def def = def_of(HP_USB_HIGH);
    assert_int_equal(creating(def), HP_OK);
    for (unsigned i = 0; i < 6; i++) {
        def.serial = serials[i];
        assert_int_equal(creating(def), HP_ERROR_USAGE);
    }
    def.serial = "1";
    def.speed = (hp_usb_speed)4;
    assert_int_equal(creating(def), HP_ERROR_USAGE);
    def.speed = HP_USB_SUPER;
    def.vendor = 0x10000;
    assert_int_equal(creating(def), HP_ERROR_USAGE);
    def.vendor = 0;
    def.board.config.lanes = 0;
    assert_int_equal(creating(def), HP_ERROR_CONFIG);
    hp_gadget_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(descriptors_at_high_speed_are_these_bytes),
                                       cmocka_unit_test(descriptors_at_superspeed_are_these_bytes),
                                       cmocka_unit_test(names_are_strings),
                                       cmocka_unit_test(identifiers_are_settable),
                                       cmocka_unit_test(configurations_keep_the_rules),
                                       cmocka_unit_test(the_report_descriptor_is_of_usb_def),
                                       cmocka_unit_test(fields_fill_their_reports),
                                       cmocka_unit_test(states_of_chapter_9),
                                       cmocka_unit_test(every_other_request_stalls),
                                       cmocka_unit_test(a_data_stage_is_no_longer_than_urb_and_request),
                                       cmocka_unit_test(a_halted_endpoint_stalls_until_cleared),
                                       cmocka_unit_test(a_halt_ends_what_waits),
                                       cmocka_unit_test(endpoints_that_are_not_there_stall),
                                       cmocka_unit_test(queries_are_answered_however_they_are_cut),
                                       cmocka_unit_test(a_full_last_packet_is_followed_by_an_empty_one),
                                       cmocka_unit_test(a_transfer_without_an_end_goes_on),
                                       cmocka_unit_test(a_transfer_without_bound_is_refused),
                                       cmocka_unit_test(an_urb_too_small_overflows),
                                       cmocka_unit_test(a_cleared_halt_begins_with_a_whole_packet),
                                       cmocka_unit_test(answers_wait_for_the_host),
                                       cmocka_unit_test(urbs_are_done_in_order),
                                       cmocka_unit_test(an_unlinked_urb_is_cancelled),
                                       cmocka_unit_test(an_urb_that_crosses_is_cancelled),
                                       cmocka_unit_test(reports_of_other_kinds_and_sizes_stall),
                                       cmocka_unit_test(identity_says_what_the_board_is),
                                       cmocka_unit_test(health_says_how_the_board_is),
                                       cmocka_unit_test(commands_that_are_none_are_refused),
                                       cmocka_unit_test(a_soft_reset_drops_what_is_under_way),
                                       cmocka_unit_test(abort_drops_what_has_not_begun),
                                       cmocka_unit_test(the_clock_is_selected),
                                       cmocka_unit_test(what_happens_is_told),
                                       cmocka_unit_test(events_that_nobody_fetches_are_lost),
                                       cmocka_unit_test(an_event_stays_for_an_urb_that_has_room),
                                       cmocka_unit_test(a_bus_reset_begins_anew),
                                       cmocka_unit_test(configuring_resets_the_board),
                                       cmocka_unit_test(the_end_cancels_everything),
                                       cmocka_unit_test(run_returns_to_an_eager_host),
                                       cmocka_unit_test(a_device_that_cannot_be_is_refused)};
    return cmocka_run_group_tests(tests, make_input, NULL);
}
