/* Hostile reports into the control plane. Input: reports of the form
 *
 *     flags (1 byte), n (1 byte), n bytes
 *
 * with flag bit 0: given the ID that was asked for; bit 1: made text and numbers that a good board could have, where
 * the report is an IDENTITY, so that what lies behind the greeting is reached; bit 2: the request fails instead. One
 * comes for each request and each wait for an event, and silence after the last. Every call must end, with words when
 * it fails, and whatever it reports must be what can be shown to a person. Before that, the whole input is parsed as
 * each kind of report, where a sanitizer sees a read past its end. */
#include "driver/hid/hid.h"
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

enum { OUR_ID = 1, GOOD = 2, FAILS = 4, EVENTS = 8 };

typedef struct script {
    hp_hid head;
    const uint8_t *data;
    size_t n;
} script;

static void require(bool holds) {
    if (!holds) abort();
}

/* ---- a carrier ---- */

static void make_good(uint8_t *bytes, size_t n) {
    if (n < 1 + HP_USB_BYTES_IDENTITY || bytes[0] != HP_USB_REPORT_IDENTITY) return;
    memset(bytes + 1 + HP_USB_AT_IDENTITY_serial, 0, HP_USB_BYTES_IDENTITY - HP_USB_AT_IDENTITY_serial);
    bytes[1 + HP_USB_AT_IDENTITY_protocol] |= 1;
    bytes[1 + HP_USB_AT_IDENTITY_clock_hz] |= 1;
    bytes[1 + HP_USB_AT_IDENTITY_serial] = 'A';
}

static hp_status next_report(script *s, uint8_t id, uint8_t *bytes, size_t room, size_t *n, hp_message *message) {
    if (s->n < 2) return hp_say(message, HP_ERROR_TIMEOUT, "silence");
    uint8_t flags = s->data[0];
    size_t length = s->data[1];
    s->data += 2, s->n -= 2;
    if (length > s->n) length = s->n;
    *n = length < room ? length : room;
    if (*n) memcpy(bytes, s->data, *n);
    s->data += length, s->n -= length;
    if (flags & FAILS) return hp_say(message, HP_ERROR_IO, "failed");
    if (*n && flags & OUR_ID) bytes[0] = id;
    if (flags & GOOD) make_good(bytes, *n);
    return HP_OK;
}

static hp_status get_feature(hp_hid *hid, uint8_t *bytes, size_t room, size_t *n, hp_message *message) {
    return next_report((script *)hid, bytes[0], bytes, room, n, message);
}

static hp_status set_feature(hp_hid *hid, const uint8_t *bytes, size_t n, hp_message *message) {
    (void)hid, (void)message;
    require(n == 1 + HP_USB_BYTES_CONTROL && bytes[0] == HP_USB_REPORT_CONTROL);
    return HP_OK;
}

static hp_status next_input(hp_hid *hid, unsigned timeout_ms, uint8_t *bytes, size_t room, size_t *n,
                            hp_message *message) {
    (void)timeout_ms;
    return next_report((script *)hid, HP_USB_REPORT_EVENT, bytes, room, n, message);
}

static void close_script(hp_hid *hid) {
    (void)hid;
}

static const hp_hid_ops ops = {
    .get_feature = get_feature, .set_feature = set_feature, .next_input = next_input, .close = close_script};

/* ---- the calls ---- */

static bool printable(const char *text, size_t room) {
    size_t n = strnlen(text, room);
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)text[i] < ' ' || text[i] == 0x7F) return false;
    return n < room;
}

static void check(const hp_control *control, hp_status status) {
    require((status == HP_OK) == (hp_control_message(control)[0] == '\0'));
    require(printable(hp_control_message(control), sizeof(hp_message)));
}

static void check_identity(const hp_control_identity *said) {
    require(printable(said->serial, sizeof said->serial) && said->serial[0]);
    require(printable(said->name, sizeof said->name) && said->protocol && said->clock_hz);
}

static void wait_for_events(hp_control *control) {
    hp_control_event event;
    for (unsigned i = 0; i < EVENTS; i++) {
        hp_status status = hp_control_next_event(control, 10000, &event);
        check(control, status);
        if (status != HP_OK) continue;
        require(event.lost <= INT32_MAX);
        require(hp_control_identify(control)->reports > 1 || hp_event_name(event.kind));
        require(hp_control_identify(control)->reports > 1 || hp_status_name(event.status));
    }
}

static void call_everything(hp_control *control) {
    hp_control_health health;
    hp_status status = hp_control_read_health(control, &health);
    check(control, status);
    require(status != HP_OK || (health.celsius >= -128 && health.celsius < 128));
    check(control, hp_control_reset(control));
    check(control, hp_control_abort(control));
    check(control, hp_control_set_clock(control, 125000000));
    wait_for_events(control);
    check(control, hp_control_read_identity(control));
    check_identity(hp_control_identify(control));
}

static void parse_as_each(const uint8_t *data, size_t n) {
    hp_message message = {""};
    hp_control_identity identity;
    hp_control_health health;
    hp_control_outcome outcome;
    hp_control_event event;
    for (unsigned version = 1; version <= 2; version++) {
        hp_status said[] = {
            hp_parse_identity(data, n, &identity, &message), hp_parse_health(data, n, version, &health, &message),
            hp_parse_outcome(data, n, &outcome, &message), hp_parse_event(data, n, version, &event, &message)};
        unsigned taken = 0;
        for (unsigned i = 0; i < 4; i++) taken += said[i] == HP_OK;
        require(taken <= 1); /* they differ in their IDs */
        if (said[0] == HP_OK) check_identity(&identity);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    parse_as_each(data, n);
    script s = {.head = {.ops = &ops}, .data = data, .n = n};
    hp_message message = {""};
    hp_control *control;
    hp_status status = hp_control_over(&s.head, NULL, hp_features, &control, &message);
    require((status == HP_OK) == (control != NULL) && (status == HP_OK) == (message.text[0] == '\0'));
    if (!control) return 0;
    check_identity(hp_control_identify(control));
    call_everything(control);
    hp_control_close(control);
    return 0;
}
