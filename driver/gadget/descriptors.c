/* Descriptors, made from usb.def. Chapter 9 of USB 2.0 and USB 3.2, and of HID 1.11 sections 6.2 and E. */
#include "internal.h"
#include <string.h>

enum { /* bDescriptorType */
       DEVICE = 1,
       CONFIGURATION = 2,
       STRING = 3,
       INTERFACE = 4,
       ENDPOINT = 5,
       QUALIFIER = 6,
       OTHER_SPEED = 7,
       BOS = 15,
       CAPABILITY = 16,
       HID = 0x21,
       REPORT = 0x22,
       COMPANION = 48
};

enum { LANGUAGES, MANUFACTURER, PRODUCT, SERIAL, PACKETS, REPORTS }; /* indices of strings */

enum { BULK = 2, INTERRUPT = 3 };

/* The speeds at which descriptors differ. The board works at full speed too, at which no gadget is made. */
typedef enum speed { FULL = 2, HIGH = HP_USB_HIGH, SUPER = HP_USB_SUPER } speed;

enum { FULL_PACKET = 64, SELF_POWERED = 0xC0, BURST = 15, POLL_FULL = 1, POLL_MICROFRAMES = 4 };

/* ---- writing ---- */

typedef struct writer {
    uint8_t *bytes;
    size_t n;
} writer;

static void put(writer *to, unsigned byte) {
    to->bytes[to->n++] = (uint8_t)byte;
}

static void put_two(writer *to, unsigned number) {
    put(to, number & 0xFF);
    put(to, number >> 8);
}

/* ---- device ---- */

static unsigned usb_release(speed at) {
    return at == SUPER ? 0x0320 : 0x0200;
}

/* The part that device and qualifier share: classes are those of the interfaces. */
static void put_device_head(writer *to, unsigned bytes, unsigned type, unsigned usb, unsigned packet) {
    put(to, bytes);
    put(to, type);
    put_two(to, usb);
    for (unsigned i = 0; i < 3; i++) put(to, 0);
    put(to, packet);
}

static void make_device(hp_descriptors *made, const hp_gadget_def *def) {
    writer to = {made->device, 0};
    speed at = (speed)def->speed;
    put_device_head(&to, HP_DEVICE_BYTES, DEVICE, usb_release(at), at == SUPER ? 9 : 64); /* at SuperSpeed 2^9 */
    put_two(&to, def->vendor ? def->vendor : HP_USB_VENDOR);
    put_two(&to, def->product ? def->product : HP_USB_PRODUCT);
    put_two(&to, HP_USB_RELEASE);
    put(&to, MANUFACTURER);
    put(&to, PRODUCT);
    put(&to, SERIAL);
    put(&to, 1); /* configurations */
}

static void make_qualifier(hp_descriptors *made) {
    writer to = {made->qualifier, 0};
    put_device_head(&to, HP_QUALIFIER_BYTES, QUALIFIER, usb_release(HIGH), FULL_PACKET);
    put(&to, 1); /* configurations */
    put(&to, 0);
}

/* ---- BOS ---- */

static void make_bos(hp_descriptors *made) {
    writer to = {made->bos, 0};
    put(&to, 5), put(&to, BOS), put_two(&to, HP_BOS_BYTES), put(&to, 2);
    put(&to, 7), put(&to, CAPABILITY), put(&to, 2);  /* USB 2.0 extension */
    put(&to, 2), put(&to, 0), put_two(&to, 0);       /* link power management */
    put(&to, 10), put(&to, CAPABILITY), put(&to, 3); /* SuperSpeed */
    put(&to, 0);                                     /* no latency tolerance messages */
    put_two(&to, 0x000E);                            /* full, high, SuperSpeed */
    put(&to, 1);                                     /* everything works from full speed on */
    put(&to, 10), put_two(&to, 2047);                /* microseconds to leave U1, U2: the most there may be */
}

/* ---- configuration ---- */

static unsigned bulk_packet(speed at) {
    return at == SUPER ? HP_USB_SUPER_PACKET : at == HIGH ? HP_USB_HIGH_PACKET : FULL_PACKET;
}

static void put_endpoint(writer *to, speed at, unsigned address, unsigned attributes) {
    bool bulk = attributes == BULK;
    put(to, 7);
    put(to, ENDPOINT);
    put(to, address);
    put(to, attributes);
    put_two(to, bulk ? bulk_packet(at) : HP_USB_REPORT_PACKET);
    put(to, bulk ? 0 : at == FULL ? POLL_FULL : POLL_MICROFRAMES);
    if (at != SUPER) return;
    put(to, 6);
    put(to, COMPANION);
    put(to, bulk ? BURST : 0);
    put(to, 0);
    put_two(to, bulk ? 0 : HP_USB_REPORT_PACKET);
}

static void put_interface(writer *to, unsigned number, unsigned endpoints, unsigned class, unsigned subclass,
                          unsigned name) {
    put(to, 9);
    put(to, INTERFACE);
    put(to, number);
    put(to, 0); /* alternate setting */
    put(to, endpoints);
    put(to, class);
    put(to, subclass);
    put(to, 0);
    put(to, name);
}

static void put_hid(writer *to, size_t report_bytes) {
    put(to, HP_HID_BYTES);
    put(to, HID);
    put_two(to, 0x0111);
    put(to, 0); /* no country */
    put(to, 1);
    put(to, REPORT);
    put_two(to, (unsigned)report_bytes);
}

static size_t make_configuration(uint8_t *bytes, unsigned type, speed at, size_t report_bytes) {
    writer to = {bytes, 0};
    put(&to, 9);
    put(&to, type);
    put_two(&to, 0); /* the total, below */
    put(&to, 2);     /* interfaces */
    put(&to, 1);     /* its number */
    put(&to, 0);
    put(&to, SELF_POWERED);
    put(&to, 0);
    put_interface(&to, HP_USB_DATA_INTERFACE, 2, 0xFF, HP_USB_DATA_SUBCLASS, PACKETS);
    put_endpoint(&to, at, HP_USB_OUT_ENDPOINT, BULK);
    put_endpoint(&to, at, HP_USB_IN_ENDPOINT, BULK);
    put_interface(&to, HP_USB_HID_INTERFACE, 1, 3, 0, REPORTS);
    put_hid(&to, report_bytes);
    put_endpoint(&to, at, HP_USB_EVENT_ENDPOINT, INTERRUPT);
    hp_put16(bytes + 2, (uint16_t)to.n);
    return to.n;
}

/* ---- report descriptor ---- */

enum { /* short items with their data bytes */
       USAGE_PAGE_2 = 0x06,
       USAGE_1 = 0x09,
       COLLECTION_1 = 0xA1,
       REPORT_ID_1 = 0x85,
       LOGICAL_MINIMUM_1 = 0x15,
       LOGICAL_MAXIMUM_2 = 0x26,
       REPORT_SIZE_1 = 0x75,
       REPORT_COUNT_1 = 0x95,
       INPUT_1 = 0x81,
       FEATURE_2 = 0xB2,
       END_COLLECTION = 0xC0,
       APPLICATION = 1,
       VARIABLE = 2, /* data, variable, absolute */
       BUFFERED = 1  /* high byte: bytes that belong together */
};

/* A report is so many bytes; what they are is for usb.def to say. */
static void put_report(writer *to, unsigned id, bool input, unsigned bytes) {
    put(to, REPORT_ID_1), put(to, id);
    put(to, USAGE_1), put(to, id + 1);
    put(to, REPORT_COUNT_1), put(to, bytes);
    if (input) {
        put(to, INPUT_1), put(to, VARIABLE);
    } else {
        put(to, FEATURE_2), put(to, VARIABLE), put(to, BUFFERED);
    }
}

static void make_report(hp_descriptors *made) {
    enum { FEATURE, INPUT };
    writer to = {made->report, 0};
    put(&to, USAGE_PAGE_2), put_two(&to, HP_USB_USAGE_PAGE);
    put(&to, USAGE_1), put(&to, 1);
    put(&to, COLLECTION_1), put(&to, APPLICATION);
    put(&to, LOGICAL_MINIMUM_1), put(&to, 0);
    put(&to, LOGICAL_MAXIMUM_2), put_two(&to, 255);
    put(&to, REPORT_SIZE_1), put(&to, 8);
#define HP_USB_REPORT(NAME, id, KIND, bytes, meaning) put_report(&to, id, KIND == INPUT, bytes);
#include <hitpipe/usb.def>
    put(&to, END_COLLECTION);
    made->report_bytes = to.n;
}

hp_descriptors hp_descriptors_make(const hp_gadget_def *def) {
    hp_descriptors made = {0};
    make_device(&made, def);
    make_qualifier(&made);
    make_bos(&made);
    make_report(&made);
    made.configuration_bytes =
        make_configuration(made.configuration, CONFIGURATION, (speed)def->speed, made.report_bytes);
    made.other_speed_bytes = make_configuration(made.other_speed, OTHER_SPEED, FULL, made.report_bytes);
    return made;
}

/* ---- strings ---- */

/* English (United States) is the only language. */
static size_t find_string(const hp_gadget *gadget, unsigned index, uint8_t *room) {
    static const char *const texts[] = {
        [MANUFACTURER] = "hitpipe", [PRODUCT] = "collision board", [PACKETS] = "packets", [REPORTS] = "reports"};
    writer to = {room, 0};
    put(&to, 0);
    put(&to, STRING);
    if (index == LANGUAGES) put_two(&to, 0x0409);
    if (index > REPORTS) return 0;
    const char *text = index == SERIAL ? gadget->serial : texts[index];
    for (size_t i = 0; index != LANGUAGES && text[i]; i++) put_two(&to, (unsigned char)text[i]);
    room[0] = (uint8_t)to.n;
    return to.n;
}

/* ---- finding ---- */

static size_t copy(uint8_t *room, const uint8_t *bytes, size_t n) {
    memcpy(room, bytes, n);
    return n;
}

size_t hp_descriptor_find(const hp_gadget *gadget, unsigned type, unsigned index, uint8_t *room) {
    const hp_descriptors *made = &gadget->descriptors;
    bool high = gadget->speed == HP_USB_HIGH;
    if (type == STRING) return find_string(gadget, index, room);
    if (index != 0) return 0;
    switch (type) {
    case DEVICE:
        return copy(room, made->device, sizeof made->device);
    case CONFIGURATION:
        return copy(room, made->configuration, made->configuration_bytes);
    case QUALIFIER:
        return high ? copy(room, made->qualifier, sizeof made->qualifier) : 0;
    case OTHER_SPEED:
        return high ? copy(room, made->other_speed, made->other_speed_bytes) : 0;
    case BOS:
        return high ? 0 : copy(room, made->bos, sizeof made->bos);
    default:
        return 0;
    }
}

/* The HID descriptor lies in the configuration before the last endpoint. */
size_t hp_interface_descriptor_find(const hp_gadget *gadget, unsigned interface, unsigned type, uint8_t *room) {
    const hp_descriptors *made = &gadget->descriptors;
    size_t behind = HP_HID_BYTES + 7 + (gadget->speed == HP_USB_SUPER ? 6 : 0);
    if (interface != HP_USB_HID_INTERFACE) return 0;
    if (type == HID) return copy(room, made->configuration + made->configuration_bytes - behind, HP_HID_BYTES);
    return type == REPORT ? copy(room, made->report, made->report_bytes) : 0;
}
