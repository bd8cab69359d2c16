/* Reports of usb.def as bytes. What comes from a board is looked at here, and nowhere else: a report that is short,
 * another, or says what cannot be ends as an error with its cause. */
#include "hid.h"
#include <hitpipe/packet.h>
#include <string.h>

enum {
    REPORTS_VERSION = 1, /* that this host knows in full */
    SERIAL_BYTES = HP_USB_AT_IDENTITY_name - HP_USB_AT_IDENTITY_serial,
    NAME_BYTES = HP_USB_BYTES_IDENTITY - HP_USB_AT_IDENTITY_name
};

_Static_assert(sizeof((hp_control_identity *)0)->serial == SERIAL_BYTES + 1, "a serial and its end");
_Static_assert(sizeof((hp_control_identity *)0)->name == NAME_BYTES + 1, "a name and its end");
#define HP_USB_REPORT(NAME, id, KIND, bytes, meaning)                                                                \
    _Static_assert(1 + bytes <= HP_HID_ROOM, "report " #NAME " with its ID fits a packet");
#include <hitpipe/usb.def>

/* ---- any report ---- */

typedef struct shape {
    const char *name;
    unsigned id;
    size_t bytes; /* behind the ID */
} shape;

static const shape identity_shape = {"IDENTITY", HP_USB_REPORT_IDENTITY, HP_USB_BYTES_IDENTITY};
static const shape health_shape = {"HEALTH", HP_USB_REPORT_HEALTH, HP_USB_BYTES_HEALTH};
static const shape control_shape = {"CONTROL", HP_USB_REPORT_CONTROL, HP_USB_BYTES_CONTROL};
static const shape event_shape = {"EVENT", HP_USB_REPORT_EVENT, HP_USB_BYTES_EVENT};

/* A later version may have more behind the end. */
static hp_status check_shape(const uint8_t *bytes, size_t n, shape wanted, hp_message *message) {
    if (n == 0) return hp_say(message, HP_ERROR_LENGTH, "report %s is empty", wanted.name);
    if (bytes[0] != wanted.id)
        return hp_say(message, HP_ERROR_OPCODE, "report %u came, not %s, which is %u: no hitpipe board, or damaged",
                      bytes[0], wanted.name, wanted.id);
    if (n < 1 + wanted.bytes)
        return hp_say(message, HP_ERROR_LENGTH, "report %s has %zu bytes behind its ID, not %zu", wanted.name, n - 1,
                      wanted.bytes);
    return HP_OK;
}

static hp_status cannot(hp_message *message, shape of, const char *what, unsigned long long value) {
    return hp_say(message, HP_ERROR_FIELD, "report %s is damaged: %s is %llu", of.name, what, value);
}

/* ---- text ---- */

/* Length of the UTF-8 character at `at`, of n bytes at most; 0 when it is none, or a control character. */
static size_t character(const uint8_t *at, size_t n) {
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    size_t bytes = at[0] < 0x80 ? 1 : at[0] >> 5 == 6 ? 2 : at[0] >> 4 == 14 ? 3 : at[0] >> 3 == 30 ? 4 : 0;
    if (bytes <= 1) return at[0] < ' ' || at[0] == 0x7F ? 0 : bytes;
    if (bytes > n) return 0;
    uint32_t code = at[0] & (0x7Fu >> bytes);
    for (size_t i = 1; i < bytes; i++) {
        if (at[i] >> 6 != 2) return 0;
        code = code << 6 | (at[i] & 0x3F);
    }
    bool control = code < 0xA0, surrogate = code >= 0xD800 && code < 0xE000;
    return code < least[bytes] || code > 0x10FFFF || control || surrogate ? 0 : bytes;
}

/* Copies a field of zero-padded text, which `to` has room for and one more. False: it is no text. */
static bool take_text(char *to, const uint8_t *from, size_t n, bool ascii) {
    size_t at = 0;
    while (at < n && from[at]) {
        size_t bytes = character(from + at, n - at);
        if (bytes == 0 || (ascii && (bytes > 1 || from[at] == ' '))) return false;
        at += bytes;
    }
    for (size_t i = at; i < n; i++)
        if (from[i]) return false;
    memcpy(to, from, n);
    to[n] = '\0';
    return true;
}

/* ---- each of them ---- */

#define AT(REPORT, name) (bytes + 1 + HP_USB_AT_##REPORT##_##name)

hp_status hp_parse_identity(const uint8_t *bytes, size_t n, hp_control_identity *identity, hp_message *message) {
    hp_status status = check_shape(bytes, n, identity_shape, message);
    if (status) return status;
    hp_control_identity said = {
        .protocol = hp_get16(AT(IDENTITY, protocol)),
        .reports = hp_get16(AT(IDENTITY, reports)),
        .pairs = hp_get32(AT(IDENTITY, pairs)),
        .clock_hz = hp_get64(AT(IDENTITY, clock_hz)),
    };
    if (said.protocol == 0) return cannot(message, identity_shape, "protocol", 0);
    if (said.clock_hz == 0) return cannot(message, identity_shape, "clock_hz", 0);
    if (!take_text(said.serial, AT(IDENTITY, serial), SERIAL_BYTES, true) || !said.serial[0])
        return hp_say(message, HP_ERROR_FIELD, "report IDENTITY is damaged: its serial number is no ASCII text");
    if (!take_text(said.name, AT(IDENTITY, name), NAME_BYTES, false))
        return hp_say(message, HP_ERROR_FIELD, "report IDENTITY is damaged: its name is no UTF-8 text");
    *identity = said;
    return HP_OK;
}

hp_status hp_parse_health(const uint8_t *bytes, size_t n, unsigned version, hp_control_health *health,
                          hp_message *message) {
    hp_status status = check_shape(bytes, n, health_shape, message);
    if (status) return status;
    unsigned link = *AT(HEALTH, link), speed = *AT(HEALTH, speed);
    bool known = version <= REPORTS_VERSION;
    if (known && link > 1) return cannot(message, health_shape, "link", link);
    if (known && speed != 3 && speed != 5) return cannot(message, health_shape, "speed", speed);
    *health = (hp_control_health){
        .celsius = (int16_t)hp_get16(AT(HEALTH, temperature)) / 256.0,
        .session = link != 0,
        .speed = speed,
        .packets = hp_get64(AT(HEALTH, packets)),
        .refused = hp_get32(AT(HEALTH, refused)),
        .crc = hp_get32(AT(HEALTH, crc)),
        .sequence = hp_get32(AT(HEALTH, sequence)),
        .events_lost = hp_get32(AT(HEALTH, events_lost)),
        .resets = hp_get32(AT(HEALTH, resets)),
    };
    return HP_OK;
}

hp_status hp_parse_outcome(const uint8_t *bytes, size_t n, hp_control_outcome *outcome, hp_message *message) {
    hp_status status = check_shape(bytes, n, control_shape, message);
    if (status) return status;
    *outcome = (hp_control_outcome){
        .command = hp_get16(AT(CONTROL, command)),
        .status = hp_get16(AT(CONTROL, status)),
        .argument = hp_get64(AT(CONTROL, argument)),
    };
    return HP_OK;
}

hp_status hp_parse_event(const uint8_t *bytes, size_t n, unsigned version, hp_control_event *event,
                         hp_message *message) {
    hp_status status = check_shape(bytes, n, event_shape, message);
    if (status) return status;
    unsigned kind = hp_get16(AT(EVENT, kind)), code = hp_get16(AT(EVENT, status));
    bool known = version <= REPORTS_VERSION;
    if (known && !hp_event_name(kind)) return cannot(message, event_shape, "kind", kind);
    if (known && !hp_status_name((hp_status)code)) return cannot(message, event_shape, "status", code);
    *event = (hp_control_event){
        .kind = kind,
        .status = (hp_status)code,
        .number = hp_get32(AT(EVENT, number)),
        .tag = hp_get32(AT(EVENT, tag)),
        .clocks = hp_get64(AT(EVENT, clocks)),
    };
    return HP_OK;
}

void hp_write_command(uint8_t *bytes, unsigned command, uint64_t argument) {
    memset(bytes, 0, 1 + HP_USB_BYTES_CONTROL);
    bytes[0] = HP_USB_REPORT_CONTROL;
    hp_put16(AT(CONTROL, command), (uint16_t)command);
    hp_put64(AT(CONTROL, argument), argument);
}

const char *hp_event_name(unsigned kind) {
    switch (kind) {
#define HP_USB_EVENT(NAME, code, meaning)                                                                            \
    case code:                                                                                                       \
        return #NAME;
#include <hitpipe/usb.def>
    default:
        return NULL;
    }
}
