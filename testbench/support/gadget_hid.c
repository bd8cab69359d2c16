#include "testbench/support/gadget_hid.h"

#include "testbench/support/board_host.h"
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { SET_CONFIGURATION = 9, GET_REPORT = 1, SET_REPORT = 9, FEATURE = 3, HID_IN = 0xA1, HID_OUT = 0x21 };

/* ---- transfers ---- */

static void mark_done(hp_urb *urb) {
    urb->owner = urb;
}

/* False: the gadget waits for something else to happen first, and the urb is taken back. */
static bool transfer(hp_gadget *gadget, hp_urb *urb) {
    urb->done = mark_done;
    urb->owner = NULL;
    hp_gadget_submit(gadget, urb);
    while (hp_gadget_run(gadget)) continue;
    bool done = urb->owner != NULL;
    if (!done) hp_gadget_unlink(gadget, urb);
    return done;
}

static bool control(hp_gadget *gadget, unsigned type, unsigned request, unsigned value, unsigned index, size_t length,
                    uint8_t *bytes, size_t *moved) {
    hp_urb urb = {.bytes = bytes, .length = length};
    const uint8_t setup[8] = {(uint8_t)type,  (uint8_t)request,      (uint8_t)value,  (uint8_t)(value >> 8),
                              (uint8_t)index, (uint8_t)(index >> 8), (uint8_t)length, (uint8_t)(length >> 8)};
    memcpy(urb.setup, setup, 8);
    assert_true(transfer(gadget, &urb));
    *moved = urb.moved;
    return urb.status == HP_URB_OK;
}

void hpt_gadget_send(hp_gadget *gadget, const uint8_t *bytes, size_t n) {
    hp_urb urb = {.endpoint = HP_USB_OUT_ENDPOINT, .bytes = (uint8_t *)bytes, .length = n, .zero_packet = true};
    assert_true(transfer(gadget, &urb));
    assert_int_equal(urb.status, HP_URB_OK);
}

size_t hpt_gadget_receive(hp_gadget *gadget, uint8_t *bytes, size_t room) {
    hp_urb urb = {.endpoint = HP_USB_IN_ENDPOINT, .bytes = bytes, .length = room};
    if (!transfer(gadget, &urb)) return SIZE_MAX;
    assert_int_equal(urb.status, HP_URB_OK);
    return urb.moved;
}

hp_gadget *hpt_gadget_configured(const char *serial) {
    const hp_gadget_def def = {.board = hpt_board("usb3", HP_ENGINE_QUICK), .serial = serial, .speed = HP_USB_HIGH};
    hp_gadget *gadget;
    size_t moved;
    assert_int_equal(hp_gadget_create(&def, &gadget), HP_OK);
    assert_true(control(gadget, 0, SET_CONFIGURATION, 1, 0, 0, NULL, &moved));
    uint8_t event[HP_HID_ROOM];
    hp_urb urb = {.endpoint = HP_USB_EVENT_ENDPOINT, .bytes = event, .length = sizeof event};
    assert_true(transfer(gadget, &urb));
    assert_int_equal(event[1 + HP_USB_AT_EVENT_kind], HP_USB_EVENT_RESET);
    return gadget;
}

/* ---- the carrier ---- */

static hp_status twisted(hpt_gadget_hid *h, uint8_t *bytes, size_t *n, hp_message *message) {
    hp_status status = h->twist ? h->twist(h->context, bytes, n) : HP_OK;
    return status ? hp_say(message, status, "twisted") : HP_OK;
}

static hp_status get_feature(hp_hid *hid, uint8_t *bytes, size_t room, size_t *n, hp_message *message) {
    hpt_gadget_hid *h = (hpt_gadget_hid *)hid;
    if (!control(h->gadget, HID_IN, GET_REPORT, FEATURE << 8 | bytes[0], HP_USB_HID_INTERFACE, room, bytes, n))
        return hp_say(message, HP_ERROR_IO, "stall");
    return twisted(h, bytes, n, message);
}

static hp_status set_feature(hp_hid *hid, const uint8_t *bytes, size_t n, hp_message *message) {
    hpt_gadget_hid *h = (hpt_gadget_hid *)hid;
    uint8_t copy[HP_HID_ROOM];
    size_t moved;
    assert_true(n <= sizeof copy);
    memcpy(copy, bytes, n);
    if (!control(h->gadget, HID_OUT, SET_REPORT, FEATURE << 8 | bytes[0], HP_USB_HID_INTERFACE, n, copy, &moved))
        return hp_say(message, HP_ERROR_IO, "stall");
    assert_int_equal(moved, n);
    return HP_OK;
}

static hp_status next_input(hp_hid *hid, unsigned timeout_ms, uint8_t *bytes, size_t room, size_t *n,
                            hp_message *message) {
    hpt_gadget_hid *h = (hpt_gadget_hid *)hid;
    hp_urb urb = {.endpoint = HP_USB_EVENT_ENDPOINT, .bytes = bytes, .length = room};
    (void)timeout_ms; /* waiting would bring nothing */
    if (!transfer(h->gadget, &urb)) return HP_ERROR_TIMEOUT;
    if (urb.status != HP_URB_OK) return hp_say(message, HP_ERROR_IO, "stall");
    *n = urb.moved;
    return twisted(h, bytes, n, message);
}

static void close_carrier(hp_hid *hid) {
    ((hpt_gadget_hid *)hid)->closed++;
}

static const hp_hid_ops ops = {
    .get_feature = get_feature,
    .set_feature = set_feature,
    .next_input = next_input,
    .close = close_carrier,
};

hpt_gadget_hid hpt_gadget_hid_of(hp_gadget *gadget) {
    return (hpt_gadget_hid){.head = {.ops = &ops}, .gadget = gadget};
}
