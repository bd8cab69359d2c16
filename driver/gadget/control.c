/* Requests on the control endpoint: those of chapter 9 and of HID that the device has. Everything else stalls. */
#include "internal.h"
#include <string.h>

enum { /* bmRequestType */
       TO_DEVICE = 0x00,
       TO_INTERFACE = 0x01,
       TO_ENDPOINT = 0x02,
       TO_HID = 0x21,
       IN = 0x80
};

enum { /* bRequest */
       GET_STATUS = 0,
       CLEAR_FEATURE = 1,
       SET_FEATURE = 3,
       SET_ADDRESS = 5,
       GET_DESCRIPTOR = 6,
       GET_CONFIGURATION = 8,
       SET_CONFIGURATION = 9,
       GET_INTERFACE = 10,
       SET_INTERFACE = 11,
       SET_SEL = 48,
       SET_ISOCH_DELAY = 49,
       GET_REPORT = 1,
       GET_IDLE = 2,
       GET_PROTOCOL = 3,
       SET_REPORT = 9,
       SET_IDLE = 10,
       SET_PROTOCOL = 11
};

enum { /* features */
       ENDPOINT_HALT = 0,
       FUNCTION_SUSPEND = 0,
       U1_ENABLE = 48,
       U2_ENABLE = 49
};

enum { STALL = -1, REPORT_PROTOCOL = 1, SEL_BYTES = 6, ADDRESS_MOST = 127 };

/* A request and its data stage. */
typedef struct request {
    unsigned type, code, value, index, length;
    const uint8_t *data; /* OUT: what came, n bytes */
    size_t n;
    uint8_t *reply; /* IN: room for an answer */
} request;

/* Each handler returns the bytes of its answer, 0 for a request without one, or STALL. */
typedef int handler(hp_gadget *gadget, const request *r);

static unsigned low(unsigned number) {
    return number & 0xFF;
}
static unsigned high(unsigned number) {
    return number >> 8;
}

static bool is_super(const hp_gadget *gadget) {
    return gadget->speed == HP_USB_SUPER;
}

static bool is_interface(unsigned index) {
    return index == HP_USB_DATA_INTERFACE || index == HP_USB_HID_INTERFACE;
}

static int answer(const request *r, size_t bytes, unsigned number) {
    for (size_t i = 0; i < bytes; i++) r->reply[i] = (uint8_t)(number >> 8 * i);
    return (int)bytes;
}

static int found(size_t bytes) {
    return bytes ? (int)bytes : STALL;
}

/* Only an endpoint that can be halted: the control endpoint recovers with the next request. */
static bool can_halt(const hp_gadget *gadget, unsigned address, hp_endpoint *endpoint) {
    *endpoint = hp_endpoint_at(address);
    return gadget->configuration && *endpoint != HP_ENDPOINT_CONTROL && *endpoint != HP_ENDPOINT_NONE;
}

/* An endpoint begins anew: not halted, and what was half transferred is not gone on with. */
static void begin_anew(hp_gadget *gadget, hp_endpoint endpoint) {
    gadget->halted[endpoint] = false;
    if (endpoint == HP_ENDPOINT_OUT) hp_bulk_cut_out(gadget);
    if (endpoint == HP_ENDPOINT_IN) hp_bulk_cut_in(gadget);
}

/* ---- the device ---- */

static int get_descriptor(hp_gadget *gadget, const request *r) {
    return found(hp_descriptor_find(gadget, high(r->value), low(r->value), r->reply));
}

static int device_status(hp_gadget *gadget, const request *r) {
    (void)gadget;
    enum { SELF_POWERED = 1 };
    return r->value || r->index ? STALL : answer(r, 2, SELF_POWERED);
}

/* Link power states are the cable's own matter; a SuperSpeed host is let to have them as it likes. */
static int device_feature(hp_gadget *gadget, const request *r) {
    bool known = r->value == U1_ENABLE || r->value == U2_ENABLE;
    return is_super(gadget) && gadget->configuration && known && r->index == 0 ? 0 : STALL;
}

static int set_address(hp_gadget *gadget, const request *r) {
    if (r->value > ADDRESS_MOST || r->index || r->length || gadget->configuration) return STALL;
    gadget->address = (uint8_t)r->value;
    return 0;
}

static int get_configuration(hp_gadget *gadget, const request *r) {
    return r->value || r->index ? STALL : answer(r, 1, gadget->configuration);
}

/* A host that attaches over USB/IP keeps the address to itself, so there may be none. Who configures the device, or
 * chooses the setting of the data interface, begins anew: the board is in reset. */
static int set_configuration(hp_gadget *gadget, const request *r) {
    if (r->value > 1 || r->index || r->length) return STALL;
    gadget->configuration = (uint8_t)r->value;
    for (unsigned i = 0; i < HP_ENDPOINTS; i++) begin_anew(gadget, (hp_endpoint)i);
    hp_gadget_reset_board(gadget);
    return 0;
}

/* What the host tells of latencies on its side: for a device that plans by them. */
static int set_latencies(hp_gadget *gadget, const request *r) {
    return is_super(gadget) && !r->value && !r->index && r->n == SEL_BYTES ? 0 : STALL;
}

static int set_delay(hp_gadget *gadget, const request *r) {
    return is_super(gadget) && !r->index && !r->length ? 0 : STALL;
}

/* ---- interfaces ---- */

static int interface_descriptor(hp_gadget *gadget, const request *r) {
    if (low(r->value)) return STALL;
    return found(hp_interface_descriptor_find(gadget, r->index, high(r->value), r->reply));
}

static int interface_status(hp_gadget *gadget, const request *r) {
    return gadget->configuration && is_interface(r->index) && !r->value ? answer(r, 2, 0) : STALL;
}

/* Functions do not wake the host: there is nothing to set but the sleep itself, which nothing shows. */
static int interface_feature(hp_gadget *gadget, const request *r) {
    bool known = r->value == FUNCTION_SUSPEND && is_interface(low(r->index));
    return is_super(gadget) && gadget->configuration && known ? 0 : STALL;
}

static int get_interface(hp_gadget *gadget, const request *r) {
    return gadget->configuration && is_interface(r->index) && !r->value ? answer(r, 1, 0) : STALL;
}

static int set_interface(hp_gadget *gadget, const request *r) {
    if (!gadget->configuration || !is_interface(r->index) || r->value || r->length) return STALL;
    if (r->index == HP_USB_HID_INTERFACE) {
        begin_anew(gadget, HP_ENDPOINT_EVENT);
        return 0;
    }
    begin_anew(gadget, HP_ENDPOINT_OUT);
    begin_anew(gadget, HP_ENDPOINT_IN);
    hp_gadget_reset_board(gadget);
    return 0;
}

/* ---- endpoints ---- */

static int endpoint_status(hp_gadget *gadget, const request *r) {
    hp_endpoint endpoint;
    if (r->value) return STALL;
    if (low(r->index) == 0 || low(r->index) == IN) return answer(r, 2, 0);
    return can_halt(gadget, r->index, &endpoint) ? answer(r, 2, gadget->halted[endpoint]) : STALL;
}

static int set_endpoint_feature(hp_gadget *gadget, const request *r) {
    hp_endpoint endpoint;
    if (r->value != ENDPOINT_HALT || !can_halt(gadget, r->index, &endpoint)) return STALL;
    gadget->halted[endpoint] = true;
    return 0;
}

static int clear_endpoint_feature(hp_gadget *gadget, const request *r) {
    hp_endpoint endpoint;
    if (r->value != ENDPOINT_HALT || !can_halt(gadget, r->index, &endpoint)) return STALL;
    begin_anew(gadget, endpoint);
    return 0;
}

/* ---- HID ---- */

static bool asks_hid(const hp_gadget *gadget, const request *r) {
    return gadget->configuration && r->index == HP_USB_HID_INTERFACE;
}

static int get_report(hp_gadget *gadget, const request *r) {
    if (!asks_hid(gadget, r)) return STALL;
    return found(hp_hid_get(gadget, high(r->value), low(r->value), r->reply));
}

static int set_report(hp_gadget *gadget, const request *r) {
    if (!asks_hid(gadget, r)) return STALL;
    return hp_hid_set(gadget, high(r->value), low(r->value), r->data, r->n) ? 0 : STALL;
}

/* Events come when they happen and are never repeated: the idle rate is endless. */
static int get_idle(hp_gadget *gadget, const request *r) {
    return asks_hid(gadget, r) && high(r->value) == 0 ? answer(r, 1, 0) : STALL;
}

static int set_idle(hp_gadget *gadget, const request *r) {
    return asks_hid(gadget, r) && high(r->value) == 0 ? 0 : STALL;
}

static int get_protocol(hp_gadget *gadget, const request *r) {
    return asks_hid(gadget, r) && !r->value ? answer(r, 1, REPORT_PROTOCOL) : STALL;
}

static int set_protocol(hp_gadget *gadget, const request *r) {
    return asks_hid(gadget, r) && r->value == REPORT_PROTOCOL ? 0 : STALL;
}

/* ---- the table ---- */

static const struct {
    uint8_t type, code;
    handler *handle;
} requests[] = {
    {IN | TO_DEVICE, GET_STATUS, device_status},
    {IN | TO_DEVICE, GET_DESCRIPTOR, get_descriptor},
    {IN | TO_DEVICE, GET_CONFIGURATION, get_configuration},
    {TO_DEVICE, CLEAR_FEATURE, device_feature},
    {TO_DEVICE, SET_FEATURE, device_feature},
    {TO_DEVICE, SET_ADDRESS, set_address},
    {TO_DEVICE, SET_CONFIGURATION, set_configuration},
    {TO_DEVICE, SET_SEL, set_latencies},
    {TO_DEVICE, SET_ISOCH_DELAY, set_delay},
    {IN | TO_INTERFACE, GET_STATUS, interface_status},
    {IN | TO_INTERFACE, GET_DESCRIPTOR, interface_descriptor},
    {IN | TO_INTERFACE, GET_INTERFACE, get_interface},
    {TO_INTERFACE, CLEAR_FEATURE, interface_feature},
    {TO_INTERFACE, SET_FEATURE, interface_feature},
    {TO_INTERFACE, SET_INTERFACE, set_interface},
    {IN | TO_ENDPOINT, GET_STATUS, endpoint_status},
    {TO_ENDPOINT, CLEAR_FEATURE, clear_endpoint_feature},
    {TO_ENDPOINT, SET_FEATURE, set_endpoint_feature},
    {IN | TO_HID, GET_REPORT, get_report},
    {IN | TO_HID, GET_IDLE, get_idle},
    {IN | TO_HID, GET_PROTOCOL, get_protocol},
    {TO_HID, SET_REPORT, set_report},
    {TO_HID, SET_IDLE, set_idle},
    {TO_HID, SET_PROTOCOL, set_protocol},
};

static int carry_out(hp_gadget *gadget, const request *r) {
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++)
        if (requests[i].type == r->type && requests[i].code == r->code) return requests[i].handle(gadget, r);
    return STALL;
}

/* The data stage has at most wLength bytes, and no more than the urb has room for. */
bool hp_control_run(hp_gadget *gadget) {
    hp_urb *urb = gadget->queues[HP_ENDPOINT_CONTROL].first;
    uint8_t reply[HP_REPLY_ROOM];
    if (!urb) return false;
    const uint8_t *setup = urb->setup;
    request r = {setup[0], setup[1], hp_get16(setup + 2), hp_get16(setup + 4), hp_get16(setup + 6), urb->bytes,
                 0,        reply};
    size_t most = urb->length < r.length ? urb->length : r.length;
    bool in = r.type & IN;
    if (!in) r.n = most;
    int bytes = carry_out(gadget, &r);
    size_t moved = bytes == STALL ? 0 : !in ? most : (size_t)bytes < most ? (size_t)bytes : most;
    if (in && moved) memcpy(urb->bytes, reply, moved);
    hp_urb_finish(gadget, HP_ENDPOINT_CONTROL, bytes == STALL ? HP_URB_STALL : HP_URB_OK, moved);
    return true;
}
