/* The control plane against the device side itself: what each call does on the board, what a board of another version
 * can and cannot, and that a report which is short, damaged or another's ends with its cause. */
#include "testbench/support/board_host.h"
#include "testbench/support/gadget_hid.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { MANY = 200, ROOM = 1 << 20 };

/* ---- a board and a control ---- */

typedef struct bench {
    hp_gadget *gadget;
    hpt_gadget_hid hid;
    hp_control *control;
    hpt_script script;
    unsigned sent; /* packets of the script */
} bench;

static void plug_in(bench *b, hpt_twist *twist, void *context, const hp_feature_row *features) {
    hp_message message = {""};
    memset(b, 0, sizeof *b);
    b->gadget = hpt_gadget_configured("HP-000001");
    b->hid = hpt_gadget_hid_of(b->gadget);
    b->hid.twist = twist;
    b->hid.context = context;
    assert_int_equal(hp_control_over(&b->hid.head, "HP-000001", features, &b->control, &message), HP_OK);
    assert_string_equal(message.text, "");
}

static void unplug(bench *b) {
    hp_control_close(b->control);
    assert_int_equal(b->hid.closed, 1);
    hp_gadget_destroy(b->gadget);
    hpt_script_free(&b->script);
}

#define SAYS(words)                                                                                                  \
    do {                                                                                                             \
        if (!strstr(hp_control_message(b.control), words))                                                           \
            fail_msg("no '%s' in '%s'", words, hp_control_message(b.control));                                       \
    } while (0)

/* Sends what the script has more, and returns the status that the last answer has. */
static hp_status play(bench *b) {
    static uint8_t bytes[ROOM];
    hp_header header = {0};
    const uint8_t *payload;
    for (; b->sent < b->script.count; b->sent++) {
        const hpt_packet *packet = &b->script.packets[b->sent];
        hpt_gadget_send(b->gadget, packet->bytes, packet->n);
        size_t n = hpt_gadget_receive(b->gadget, bytes, sizeof bytes);
        assert_int_not_equal(n, SIZE_MAX);
        assert_int_equal(hp_packet_open(bytes, n, &header, &payload), HP_OK);
    }
    return (hp_status)header.status;
}

/* A packet that there is none of. */
static void ask_nonsense(hpt_script *script) {
    enum { OPCODE = 0x7F };
    hpt_append(script, OPCODE, 0);
    hp_header header = hpt_header(script, OPCODE, 0);
    hpt_reseal(script, &header);
}

static void expect_event(bench *b, unsigned kind, hp_status status, uint32_t number, uint32_t tag, uint32_t lost) {
    hp_control_event event;
    assert_int_equal(hp_control_next_event(b->control, 0, &event), HP_OK);
    assert_int_equal(event.kind, kind);
    assert_int_equal(event.status, status);
    assert_int_equal(event.number, number);
    assert_int_equal(event.tag, tag);
    assert_int_equal(event.lost, lost);
}

/* ---- what the calls do ---- */

static void the_board_says_what_it_is(void **state) {
    (void)state;
    bench b;
    plug_in(&b, NULL, NULL, hp_features);
    const hp_control_identity *said = hp_control_identify(b.control);
    hp_config config;
    hp_config_preset(&config, "usb3");
    assert_int_equal(said->protocol, HP_PROTOCOL_VERSION);
    assert_int_equal(said->reports, 1);
    assert_int_equal(said->pairs, config.pipes);
    assert_int_equal(said->clock_hz, config.clock_hz);
    assert_string_equal(said->serial, "HP-000001");
    assert_string_equal(said->name, config.name);
    unplug(&b);
}

static void the_board_says_how_it_is(void **state) {
    (void)state;
    bench b;
    hp_control_health health;
    plug_in(&b, NULL, NULL, hp_features);
    assert_int_equal(hp_control_read_health(b.control, &health), HP_OK);
    assert_false(health.session);
    assert_int_equal(health.packets, 0);
    assert_int_equal(health.speed, 3);
    assert_true(health.celsius > 0 && health.celsius < 100);
    hpt_hello(&b.script);
    hpt_counters(&b.script, false);
    assert_int_equal(play(&b), HP_OK);
    ask_nonsense(&b.script);
    assert_int_equal(play(&b), HP_ERROR_OPCODE);
    assert_int_equal(hp_control_read_health(b.control, &health), HP_OK);
    assert_true(health.session);
    assert_int_equal(health.packets, 2); /* the two that were taken */
    assert_int_equal(health.refused, 1);
    assert_int_equal(health.crc, 0);
    assert_int_equal(health.sequence, 0);
    assert_int_equal(health.resets, 0);
    unplug(&b);
}

static void a_reset_ends_the_session(void **state) {
    (void)state;
    bench b;
    hp_control_health health;
    plug_in(&b, NULL, NULL, hp_features);
    hpt_hello(&b.script);
    assert_int_equal(play(&b), HP_OK);
    assert_int_equal(hp_control_reset(b.control), HP_OK);
    assert_string_equal(hp_control_message(b.control), "");
    assert_int_equal(hp_control_read_health(b.control, &health), HP_OK);
    assert_false(health.session);
    assert_int_equal(health.resets, 1);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 1, 1, 0);
    expect_event(&b, HP_USB_EVENT_RESET, HP_OK, 2, HP_NO_TAG, 0);
    hpt_counters(&b.script, false);
    assert_int_equal(play(&b), HP_ERROR_SEQUENCE); /* no session */
    unplug(&b);
}

static void mark_done(hp_urb *urb) {
    urb->owner = urb;
}

static void an_abort_drops_what_has_not_begun(void **state) {
    (void)state;
    bench b;
    hp_control_health health;
    uint8_t bytes[1024];
    plug_in(&b, NULL, NULL, hp_features);
    hpt_hello(&b.script);
    assert_int_equal(play(&b), HP_OK);
    hpt_counters(&b.script, false);
    const hpt_packet *packet = &b.script.packets[1];
    hp_urb urb = {.endpoint = HP_USB_OUT_ENDPOINT,
                  .bytes = packet->bytes,
                  .length = packet->n,
                  .zero_packet = true,
                  .done = mark_done};
    hp_gadget_submit(b.gadget, &urb);
    hp_gadget_run(b.gadget); /* it is on its way, no more */
    assert_int_equal(hp_control_abort(b.control), HP_OK);
    assert_non_null(urb.owner);
    assert_int_equal(hpt_gadget_receive(b.gadget, bytes, sizeof bytes), SIZE_MAX);
    assert_int_equal(hp_control_read_health(b.control, &health), HP_OK);
    assert_true(health.session);
    assert_int_equal(health.resets, 0);
    assert_int_equal(play(&b), HP_OK); /* the same packet again */
    unplug(&b);
}

static void the_clock_is_selected(void **state) {
    (void)state;
    bench b;
    plug_in(&b, NULL, NULL, hp_features);
    uint64_t before = hp_control_identify(b.control)->clock_hz;
    assert_int_equal(hp_control_set_clock(b.control, 125000000), HP_OK);
    assert_int_equal(hp_control_read_identity(b.control), HP_OK);
    assert_int_equal(hp_control_identify(b.control)->clock_hz, before); /* until there is a session */
    hpt_hello(&b.script);
    assert_int_equal(play(&b), HP_OK);
    assert_int_equal(hp_control_read_identity(b.control), HP_OK);
    assert_int_equal(hp_control_identify(b.control)->clock_hz, 125000000);
    assert_int_equal(hp_control_set_clock(b.control, 0), HP_ERROR_FIELD);
    SAYS("the board refused CLOCK 0: packet field out of range");
    assert_int_equal(hp_control_set_clock(b.control, UINT64_MAX), HP_ERROR_FIELD);
    SAYS("CLOCK 18446744073709551615");
    assert_int_equal(hp_control_read_identity(b.control), HP_OK);
    assert_string_equal(hp_control_message(b.control), "");
    unplug(&b);
}

/* ---- events ---- */

static void events_come_as_they_happen(void **state) {
    (void)state;
    bench b;
    hp_control_event untouched = {.kind = 77}, event = untouched;
    plug_in(&b, NULL, NULL, hp_features);
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_TIMEOUT);
    SAYS("nothing happened in 0 ms");
    assert_memory_equal(&event, &untouched, sizeof event);
    hpt_hello(&b.script);
    hpt_counters(&b.script, false);
    ask_nonsense(&b.script);
    play(&b);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 1, 1, 0);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 2, 2, 0);
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_OK);
    assert_int_equal(event.kind, HP_USB_EVENT_PACKET_ERROR);
    assert_int_equal(event.status, HP_ERROR_OPCODE);
    assert_true(event.clocks > 0);
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_TIMEOUT);
    unplug(&b);
}

/* The gadget keeps so many events and drops the oldest. */
static void lost_events_are_counted(void **state) {
    (void)state;
    bench b;
    hp_control_health health;
    hp_control_event event;
    plug_in(&b, NULL, NULL, hp_features);
    hpt_hello(&b.script);
    play(&b);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 1, 1, 0);
    for (unsigned i = 0; i < MANY; i++) hpt_counters(&b.script, false);
    play(&b);
    assert_int_equal(hp_control_read_health(b.control, &health), HP_OK);
    assert_true(health.events_lost > 0);
    uint32_t lost = health.events_lost;
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 2 + lost, 2 + lost, lost);
    uint32_t last = 2 + lost;
    while (hp_control_next_event(b.control, 0, &event) == HP_OK) {
        assert_int_equal(event.lost, 0);
        assert_int_equal(event.number, ++last);
    }
    assert_int_equal(last, 1 + MANY);
    unplug(&b);
}

/* Numbers the events anew: 0xFFFFFFFE, 0xFFFFFFFF, 0, then 0 again, then 1. */
static hp_status renumber(void *context, uint8_t *bytes, size_t *n) {
    static const uint32_t numbers[] = {0xFFFFFFFE, 0xFFFFFFFF, 0, 0, 1, 4};
    unsigned *count = context;
    (void)n;
    if (bytes[0] == HP_USB_REPORT_EVENT) hp_put32(bytes + 1 + HP_USB_AT_EVENT_number, numbers[(*count)++]);
    return HP_OK;
}

static void numbers_of_events_go_on_past_their_end_and_never_back(void **state) {
    (void)state;
    bench b;
    unsigned count = 0;
    hp_control_event event = {.kind = 77};
    plug_in(&b, renumber, &count, hp_features);
    hpt_hello(&b.script);
    for (unsigned i = 0; i < 5; i++) hpt_counters(&b.script, false);
    play(&b);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 0xFFFFFFFE, 1, 0);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 0xFFFFFFFF, 2, 0);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 0, 3, 0);
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_SEQUENCE);
    SAYS("event 0 came after event 0");
    assert_int_equal(event.kind, 77);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 1, 5, 0);
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 4, 6, 2);
    unplug(&b);
}

/* ---- versions ---- */

/* What another version of reports is like. */
typedef struct other {
    unsigned version;
    bool longer;         /* a later one has more fields, and values of its own in the others */
    unsigned strange;    /* input reports of another ID that come first */
    unsigned kind, code; /* of events, 0: as they are */
} other;

static hp_status make_other(void *context, uint8_t *bytes, size_t *n) {
    other *o = context;
    if (bytes[0] == HP_USB_REPORT_IDENTITY) hp_put16(bytes + 1 + HP_USB_AT_IDENTITY_reports, (uint16_t)o->version);
    if (bytes[0] == HP_USB_REPORT_EVENT && o->strange) {
        o->strange--;
        bytes[0] = 9;
    } else if (bytes[0] == HP_USB_REPORT_EVENT) {
        if (o->kind) hp_put16(bytes + 1 + HP_USB_AT_EVENT_kind, (uint16_t)o->kind);
        if (o->code) hp_put16(bytes + 1 + HP_USB_AT_EVENT_status, (uint16_t)o->code);
    }
    if (o->longer && bytes[0] == HP_USB_REPORT_HEALTH) bytes[1 + HP_USB_AT_HEALTH_speed] = 6;
    if (o->longer) {
        memset(bytes + *n, 0xEE, HP_HID_ROOM - *n);
        *n = HP_HID_ROOM;
    }
    return HP_OK;
}

static void a_board_of_the_version_before_lacks_what_came_since(void **state) {
    (void)state;
    bench b;
    other o = {.version = 1};
    hp_feature_row features[HP_FEATURES];
    memcpy(features, hp_features, sizeof features);
    features[HP_FEATURE_CLOCK].since = 2; /* as if this host were of a later version */
    plug_in(&b, make_other, &o, features);
    assert_false(hp_control_can(b.control, HP_FEATURE_CLOCK));
    assert_int_equal(hp_control_set_clock(b.control, 125000000), HP_ERROR_VERSION);
    SAYS("board HP-000001 lacks CLOCK: it has version 1 of the reports, and CLOCK came with version 2");
    assert_true(hp_control_can(b.control, HP_FEATURE_RESET));
    assert_int_equal(hp_control_reset(b.control), HP_OK);
    assert_int_equal(hp_control_abort(b.control), HP_OK);
    hpt_hello(&b.script);
    assert_int_equal(play(&b), HP_OK);
    assert_int_equal(hp_control_read_identity(b.control), HP_OK);
    assert_int_not_equal(hp_control_identify(b.control)->clock_hz, 125000000); /* nothing was sent */
    unplug(&b);
}

static void a_board_of_version_0_can_only_say_what_it_is(void **state) {
    (void)state;
    bench b;
    other o = {.version = 0};
    hp_control_health health;
    hp_control_event event;
    plug_in(&b, make_other, &o, hp_features);
    assert_string_equal(hp_control_identify(b.control)->serial, "HP-000001");
    for (int i = 0; i < HP_FEATURES; i++) {
        assert_false(hp_control_can(b.control, (hp_feature)i));
        assert_int_equal(hp_feature_since((hp_feature)i), 1);
    }
    assert_int_equal(hp_control_read_health(b.control, &health), HP_ERROR_VERSION);
    SAYS("lacks HEALTH");
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_VERSION);
    SAYS("lacks EVENTS");
    assert_int_equal(hp_control_reset(b.control), HP_ERROR_VERSION);
    SAYS("lacks RESET");
    assert_int_equal(hp_control_abort(b.control), HP_ERROR_VERSION);
    SAYS("lacks ABORT");
    unplug(&b);
}

static void a_board_of_a_later_version_works(void **state) {
    (void)state;
    bench b;
    other o = {.version = 7, .longer = true, .strange = 2, .kind = 99, .code = 999};
    hp_control_health health;
    plug_in(&b, make_other, &o, hp_features);
    assert_int_equal(hp_control_identify(b.control)->reports, 7);
    assert_int_equal(hp_control_read_health(b.control, &health), HP_OK);
    assert_int_equal(health.speed, 6);
    assert_int_equal(hp_control_reset(b.control), HP_OK);
    hpt_hello(&b.script);
    hpt_counters(&b.script, false);
    play(&b);
    expect_event(&b, 99, (hp_status)999, 3, 2, 0); /* behind two reports that are no events */
    assert_null(hp_event_name(99));
    unplug(&b);
}

static void a_strange_report_or_value_is_no_event_of_this_version(void **state) {
    (void)state;
    bench b;
    other o = {.version = 1, .strange = 1};
    hp_control_event event = {.kind = 77};
    plug_in(&b, make_other, &o, hp_features);
    hpt_hello(&b.script);
    for (unsigned i = 0; i < 3; i++) hpt_counters(&b.script, false);
    play(&b);
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_OPCODE);
    SAYS("report 9 came, not EVENT, which is 4");
    o.kind = 99;
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_FIELD);
    SAYS("report EVENT is damaged: kind is 99");
    o.kind = 0, o.code = 999;
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_FIELD);
    SAYS("report EVENT is damaged: status is 999");
    assert_int_equal(event.kind, 77);
    o.code = 0;
    expect_event(&b, HP_USB_EVENT_PACKET_DONE, HP_OK, 4, 4, 0);
    unplug(&b);
}

/* ---- damaged reports ---- */

/* Cuts, overwrites or fails the reports of one ID. */
typedef struct damage {
    unsigned id;
    size_t length; /* SIZE_MAX: all of it */
    size_t at;     /* behind the ID; SIZE_MAX: none, and SIZE_MAX - 1: the ID itself */
    uint8_t byte;
    hp_status status;
} damage;

static hp_status do_damage(void *context, uint8_t *bytes, size_t *n) {
    const damage *d = context;
    if (bytes[0] != d->id) return HP_OK;
    if (d->at == SIZE_MAX - 1)
        bytes[0] = d->byte;
    else if (d->at != SIZE_MAX)
        bytes[1 + d->at] = d->byte;
    if (d->length < *n) *n = d->length;
    return d->status;
}

/* The call that reads the report of an ID. */
static hp_status call(bench *b, unsigned id) {
    hp_control_health health;
    hp_control_event event;
    switch (id) {
    case HP_USB_REPORT_IDENTITY:
        return hp_control_read_identity(b->control);
    case HP_USB_REPORT_HEALTH:
        return hp_control_read_health(b->control, &health);
    case HP_USB_REPORT_CONTROL:
        return hp_control_reset(b->control); /* which also makes an event */
    default:
        assert_int_equal(hp_control_reset(b->control), HP_OK);
        return hp_control_next_event(b->control, 0, &event);
    }
}

static void a_short_report_is_refused_at_every_length(void **state) {
    (void)state;
    bench b;
    damage d = {.at = SIZE_MAX};
    static const size_t bytes[] = {0, HP_USB_BYTES_IDENTITY, HP_USB_BYTES_HEALTH, HP_USB_BYTES_CONTROL,
                                   HP_USB_BYTES_EVENT};
    plug_in(&b, do_damage, &d, hp_features);
    for (d.id = 1; d.id <= 4; d.id++) {
        for (d.length = 0; d.length <= bytes[d.id]; d.length++) {
            assert_int_equal(call(&b, d.id), HP_ERROR_LENGTH);
            SAYS(d.length ? "bytes behind its ID, not" : "is empty");
        }
        assert_int_equal(d.length, 1 + bytes[d.id]);
        assert_int_equal(call(&b, d.id), HP_OK); /* the control is as good as before */
    }
    unplug(&b);
}

static void a_foreign_report_is_refused(void **state) {
    (void)state;
    bench b;
    damage d = {.length = SIZE_MAX, .at = SIZE_MAX - 1};
    plug_in(&b, do_damage, &d, hp_features);
    for (d.id = 1; d.id <= 4; d.id++) {
        for (unsigned byte = 0; byte < 256; byte++) {
            if (byte == d.id) continue;
            d.byte = (uint8_t)byte;
            assert_int_equal(call(&b, d.id), HP_ERROR_OPCODE);
            SAYS("no hitpipe board, or damaged");
        }
    }
    unplug(&b);
}

static void a_field_that_cannot_be_is_refused(void **state) {
    (void)state;
    bench b;
    damage d = {.length = SIZE_MAX};
    static const struct row {
        unsigned id;
        size_t at;
        uint8_t byte;
        const char *words;
    } rows[] = {
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_protocol, 0, "protocol is 0"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_serial, 0, "serial number"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_serial, ' ', "serial number"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_serial + 3, 0, "serial number"}, /* text behind the end */
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_serial + 3, 0x7F, "serial number"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_serial + 3, 0xC3, "serial number"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_name, 0x1B, "name"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_name, 0x80, "name"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_name, 0xC3, "name"},
        {HP_USB_REPORT_IDENTITY, HP_USB_AT_IDENTITY_name + 31, 'x', "name"},
        {HP_USB_REPORT_HEALTH, HP_USB_AT_HEALTH_link, 2, "link is 2"},
        {HP_USB_REPORT_HEALTH, HP_USB_AT_HEALTH_speed, 4, "speed is 4"},
    };
    plug_in(&b, do_damage, &d, hp_features);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        d.id = rows[i].id, d.at = rows[i].at, d.byte = rows[i].byte;
        assert_int_equal(call(&b, d.id), HP_ERROR_FIELD);
        SAYS(rows[i].words);
        assert_string_equal(hp_control_identify(b.control)->serial, "HP-000001"); /* stays as it was */
    }
    unplug(&b);
}

static hp_status parse_named(const char *serial, const char *name, hp_control_identity *identity) {
    uint8_t bytes[1 + HP_USB_BYTES_IDENTITY] = {HP_USB_REPORT_IDENTITY};
    hp_message message;
    hp_put16(bytes + 1 + HP_USB_AT_IDENTITY_protocol, 1);
    hp_put64(bytes + 1 + HP_USB_AT_IDENTITY_clock_hz, 1);
    memcpy(bytes + 1 + HP_USB_AT_IDENTITY_serial, serial, strlen(serial));
    memcpy(bytes + 1 + HP_USB_AT_IDENTITY_name, name, strlen(name));
    return hp_parse_identity(bytes, sizeof bytes, identity, &message);
}

static void a_name_is_any_printable_utf8(void **state) {
    (void)state;
    hp_control_identity identity;
    static const char *const good[] = {"",
                                       "usb3",
                                       "four lanes",
                                       "Br\303\274cke",
                                       "\xE2\x82\xAC",
                                       "\xF0\x9F\x9B\xB0",
                                       "\xC2\xA0",
                                       "\xF4\x8F\xBF\xBF",
                                       "\xED\x9F\xBF",
                                       "exactly thirty-two bytes of name"};
    static const char *const bad[] = {"\xC0\x80",
                                      "\xC1\xBF",
                                      "\xE0\x9F\xBF",
                                      "\xF0\x8F\xBF\xBF",
                                      "\xED\xA0\x80",
                                      "\xF4\x90\x80\x80",
                                      "\xC2\x9B",
                                      "\xF8\x88\x80\x80\x80",
                                      "\xE2\x82",
                                      "\xE2\x82x",
                                      "a\nb",
                                      "\xFF",
                                      "thirty-one bytes of a name and \xC3"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_int_equal(parse_named("A", good[i], &identity), HP_OK);
        assert_string_equal(identity.name, good[i]);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        if (parse_named("A", bad[i], &identity) != HP_ERROR_FIELD) fail_msg("bad name %zu is taken", i);
}

static void a_serial_number_is_ascii_and_not_empty(void **state) {
    (void)state;
    hp_control_identity identity;
    assert_int_equal(parse_named("twelve-bytes", "", &identity), HP_OK);
    assert_string_equal(identity.serial, "twelve-bytes");
    assert_int_equal(parse_named("", "", &identity), HP_ERROR_FIELD);
    assert_int_equal(parse_named("Br\303\274cke", "", &identity), HP_ERROR_FIELD);
    assert_int_equal(parse_named("a b", "", &identity), HP_ERROR_FIELD);
}

static void the_outcome_of_anothers_command_is_not_ones_own(void **state) {
    (void)state;
    bench b;
    damage d = {.id = HP_USB_REPORT_CONTROL, .length = SIZE_MAX, .at = HP_USB_AT_CONTROL_command, .byte = 2};
    plug_in(&b, do_damage, &d, hp_features);
    assert_int_equal(hp_control_reset(b.control), HP_ERROR_TAG);
    SAYS("the outcome of RESET is not known: the board tells of command 2 0, which another program gave");
    d.at = HP_USB_AT_CONTROL_argument;
    assert_int_equal(hp_control_reset(b.control), HP_ERROR_TAG);
    d.at = HP_USB_AT_CONTROL_status;
    assert_int_equal(hp_control_reset(b.control), HP_ERROR_USAGE);
    SAYS("the board refused RESET 0: wrong use");
    d.byte = 99;
    assert_int_equal(hp_control_reset(b.control), HP_ERROR_FIELD);
    SAYS("the unknown status 99");
    d.id = 0;
    assert_int_equal(hp_control_reset(b.control), HP_OK);
    unplug(&b);
}

static void what_the_carrier_says_is_what_the_caller_hears(void **state) {
    (void)state;
    bench b;
    damage d = {.length = SIZE_MAX, .at = SIZE_MAX};
    static const hp_status statuses[] = {HP_ERROR_DISCONNECTED, HP_ERROR_TIMEOUT, HP_ERROR_IO};
    plug_in(&b, do_damage, &d, hp_features);
    for (d.id = 1; d.id <= 3; d.id++)
        for (unsigned i = 0; i < 3; i++) {
            d.status = statuses[i];
            assert_int_equal(call(&b, d.id), d.status);
            SAYS("twisted");
        }
    d.status = HP_ERROR_CANCELLED;
    assert_int_equal(call(&b, 4), HP_ERROR_CANCELLED);
    d.id = 0;
    for (unsigned id = 1; id <= 4; id++) assert_int_equal(call(&b, id), HP_OK);
    unplug(&b);
}

/* ---- opening ---- */

static void a_board_that_is_not_the_one_is_not_opened(void **state) {
    (void)state;
    hp_gadget *gadget = hpt_gadget_configured("HP-000001");
    hpt_gadget_hid hid = hpt_gadget_hid_of(gadget);
    hp_message message = {""};
    hp_control *control = (hp_control *)&hid;
    assert_int_equal(hp_control_over(&hid.head, "HP-000002", hp_features, &control, &message), HP_ERROR_FIELD);
    assert_null(control);
    assert_int_equal(hid.closed, 1);
    assert_non_null(strstr(message.text, "it has the serial number HP-000001, and the device has HP-000002"));
    damage d = {.id = HP_USB_REPORT_IDENTITY, .length = 5, .at = SIZE_MAX};
    hid.twist = do_damage;
    hid.context = &d;
    assert_int_equal(hp_control_over(&hid.head, NULL, hp_features, &control, &message), HP_ERROR_LENGTH);
    assert_int_equal(hid.closed, 2);
    hid.twist = NULL;
    assert_int_equal(hp_control_over(&hid.head, "", hp_features, &control, &message), HP_OK);
    hp_control_close(control);
    assert_int_equal(hid.closed, 3);
    hp_gadget_destroy(gadget);
}

#define CHOOSE(number, name) hp_hid_choose(boards, number, ((def).serial = (name), &(def)), &chosen, &message)
#define TELLS(words)                                                                                                 \
    do {                                                                                                             \
        if (!strstr(message.text, words)) fail_msg("no '%s' in '%s'", words, message.text);                          \
    } while (0)

static void the_board_that_is_named_is_chosen(void **state) {
    (void)state;
    const hp_control_board boards[] = {{.serial = "A"}, {.serial = ""}, {.serial = "B"}};
    hp_control_def def = hp_default_control_def();
    hp_message message;
    size_t chosen = 77;
    assert_int_equal(CHOOSE(0, NULL), HP_ERROR_NO_DEVICE);
    TELLS("no board is plugged in: looked for a HID device 1209:0001");
    assert_int_equal(CHOOSE(0, "B"), HP_ERROR_NO_DEVICE);
    TELLS("looked for a HID device 1209:0001 with serial number B");
    assert_int_equal(CHOOSE(1, NULL), HP_OK);
    assert_int_equal(chosen, 0);
    assert_int_equal(CHOOSE(3, "B"), HP_OK);
    assert_int_equal(chosen, 2);
    assert_int_equal(CHOOSE(3, "C"), HP_ERROR_NO_DEVICE);
    TELLS("no board with serial number C among the HID devices 1209:0001; there is A, B; of 1 the serial number "
          "cannot be read without permission to open them, which the udev rule 60-hitpipe.rules gives");
    assert_int_equal(CHOOSE(3, NULL), HP_ERROR_NO_DEVICE);
    TELLS("3 boards are plugged in, and none is named; there is A, B");
    assert_int_equal(CHOOSE(1, ""), HP_OK);
}

static void wrong_use_is_refused(void **state) {
    (void)state;
    hp_control_def def = hp_default_control_def(), strange = {0};
    hp_control *control = (hp_control *)&def;
    hp_control_board board;
    size_t count;
    assert_int_equal(hp_control_open(&strange, &control), HP_ERROR_USAGE);
    assert_null(control);
    assert_non_null(strstr(hp_control_message(NULL), "does not come from hp_default_control_def"));
    assert_int_equal(hp_control_open(NULL, &control), HP_ERROR_USAGE);
    assert_int_equal(hp_control_open(&def, NULL), HP_ERROR_USAGE);
    assert_int_equal(hp_control_list(&strange, &board, 1, &count), HP_ERROR_USAGE);
    assert_int_equal(hp_control_list(&def, &board, 1, NULL), HP_ERROR_USAGE);
    hp_control_close(NULL);
    assert_null(hp_feature_name(HP_FEATURES));
    assert_int_equal(hp_feature_since(HP_FEATURES), 0);
    assert_string_equal(hp_feature_name(HP_FEATURE_CLOCK), "CLOCK");
}

/* A machine without a board of these identifiers, which are nobody's. */
static void where_no_board_is_plugged_in_that_is_said(void **state) {
    (void)state;
    hp_control_def def = hp_default_control_def();
    hp_control *control;
    size_t count = 77;
    def.vendor = 0xFFFF, def.product = 0xFFFE;
    assert_int_equal(hp_control_list(&def, NULL, 0, &count), HP_OK);
    assert_int_equal(count, 0);
    assert_int_equal(hp_control_open(&def, &control), HP_ERROR_NO_DEVICE);
    assert_non_null(strstr(hp_control_message(NULL), "looked for a HID device ffff:fffe"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_board_says_what_it_is),
        cmocka_unit_test(the_board_says_how_it_is),
        cmocka_unit_test(a_reset_ends_the_session),
        cmocka_unit_test(an_abort_drops_what_has_not_begun),
        cmocka_unit_test(the_clock_is_selected),
        cmocka_unit_test(events_come_as_they_happen),
        cmocka_unit_test(lost_events_are_counted),
        cmocka_unit_test(numbers_of_events_go_on_past_their_end_and_never_back),
        cmocka_unit_test(a_board_of_the_version_before_lacks_what_came_since),
        cmocka_unit_test(a_board_of_version_0_can_only_say_what_it_is),
        cmocka_unit_test(a_board_of_a_later_version_works),
        cmocka_unit_test(a_strange_report_or_value_is_no_event_of_this_version),
        cmocka_unit_test(a_short_report_is_refused_at_every_length),
        cmocka_unit_test(a_foreign_report_is_refused),
        cmocka_unit_test(a_field_that_cannot_be_is_refused),
        cmocka_unit_test(a_name_is_any_printable_utf8),
        cmocka_unit_test(a_serial_number_is_ascii_and_not_empty),
        cmocka_unit_test(the_outcome_of_anothers_command_is_not_ones_own),
        cmocka_unit_test(what_the_carrier_says_is_what_the_caller_hears),
        cmocka_unit_test(a_board_that_is_not_the_one_is_not_opened),
        cmocka_unit_test(the_board_that_is_named_is_chosen),
        cmocka_unit_test(wrong_use_is_refused),
        cmocka_unit_test(where_no_board_is_plugged_in_that_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
