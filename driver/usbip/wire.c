#include "wire.h"
#include <stdio.h>
#include <string.h>

/* ---- big endian ---- */

static void put16(uint8_t *at, unsigned number) {
    at[0] = (uint8_t)(number >> 8);
    at[1] = (uint8_t)number;
}

static void put32(uint8_t *at, uint32_t number) {
    put16(at, number >> 16);
    put16(at + 2, number & 0xFFFF);
}

static unsigned get16(const uint8_t *at) {
    return (unsigned)at[0] << 8 | at[1];
}

static uint32_t get32(const uint8_t *at) {
    return (uint32_t)get16(at) << 16 | get16(at + 2);
}

/* ---- before the import ---- */

hp_usbip_op hp_usbip_read_op(const uint8_t bytes[HP_USBIP_OP_BYTES]) {
    return (hp_usbip_op){get16(bytes), get16(bytes + 2), get32(bytes + 4)};
}

void hp_usbip_write_op(uint8_t bytes[HP_USBIP_OP_BYTES], hp_usbip_code code, hp_usbip_outcome outcome) {
    put16(bytes, HP_USBIP_VERSION);
    put16(bytes + 2, code);
    put32(bytes + 4, outcome);
}

void hp_usbip_write_count(uint8_t bytes[HP_USBIP_COUNT_BYTES], uint32_t count) {
    put32(bytes, count);
}

enum {
    PATH = 0,
    BUSID = 256,
    BUSNUM = 288,
    DEVNUM = 292,
    SPEED = 296,
    VENDOR = 300,
    CLASS = 306,
    CONFIGURATION = 309
};

/* Numbers that a descriptor has in little endian. */
static void turn16(uint8_t *to, const uint8_t *from) {
    to[0] = from[1];
    to[1] = from[0];
}

/* A board that nobody has imported is not configured. */
void hp_usbip_write_device(uint8_t bytes[HP_USBIP_DEVICE_BYTES], const hp_gadget *gadget,
                           const hp_usbip_place *place) {
    const uint8_t *device = hp_gadget_device_descriptor(gadget);
    memset(bytes, 0, HP_USBIP_DEVICE_BYTES);
    snprintf((char *)bytes + PATH, BUSID - PATH, "/sys/devices/hitpipe/usb%u/%s", place->busnum, place->busid);
    memcpy(bytes + BUSID, place->busid, HP_USBIP_BUSID_BYTES);
    put32(bytes + BUSNUM, place->busnum);
    put32(bytes + DEVNUM, place->devnum);
    put32(bytes + SPEED, hp_gadget_speed(gadget));
    for (unsigned i = 0; i < 3; i++)
        turn16(bytes + VENDOR + 2 * i, device + 8 + 2 * i); /* vendor, product, release */
    memcpy(bytes + CLASS, device + 4, 3);
    bytes[CONFIGURATION] = 0;
    bytes[CONFIGURATION + 1] = device[17];
    bytes[CONFIGURATION + 2] = (uint8_t)hp_usbip_interfaces(gadget);
}

unsigned hp_usbip_interfaces(const hp_gadget *gadget) {
    size_t n;
    return hp_gadget_configuration(gadget, &n)[4];
}

void hp_usbip_write_interface(uint8_t bytes[HP_USBIP_INTERFACE_BYTES], const hp_gadget *gadget, unsigned number) {
    enum { INTERFACE = 4 };
    size_t n;
    const uint8_t *at = hp_gadget_configuration(gadget, &n), *end = at + n;
    memset(bytes, 0, HP_USBIP_INTERFACE_BYTES);
    for (; at < end; at += at[0])
        if (at[1] == INTERFACE && at[2] == number) memcpy(bytes, at + 5, 3);
}

/* ---- behind it ---- */

hp_usbip_urb hp_usbip_read_urb(const uint8_t bytes[HP_USBIP_URB_BYTES]) {
    hp_usbip_urb urb = {.command = get32(bytes),
                        .seqnum = get32(bytes + 4),
                        .devid = get32(bytes + 8),
                        .direction = get32(bytes + 12),
                        .endpoint = get32(bytes + 16),
                        .flags = get32(bytes + 20),
                        .length = get32(bytes + 24),
                        .packets = get32(bytes + 32),
                        .unlinked = get32(bytes + 20)};
    memcpy(urb.setup, bytes + 40, sizeof urb.setup);
    return urb;
}

void hp_usbip_write_return(uint8_t bytes[HP_USBIP_URB_BYTES], hp_usbip_command command, uint32_t seqnum,
                           uint32_t status, uint32_t moved) {
    memset(bytes, 0, HP_USBIP_URB_BYTES);
    put32(bytes, command);
    put32(bytes + 4, seqnum);
    put32(bytes + 20, status);
    put32(bytes + 24, moved);
}

uint32_t hp_usbip_status(hp_urb_status status, bool cut) {
    enum {
        EPIPE_ = 32,
        EPROTO_ = 71,
        EOVERFLOW_ = 75,
        ECONNRESET_ = 104,
        EREMOTEIO_ = 121
    }; /* of Linux, on any system */
    switch (status) {
    case HP_URB_OK:
        return cut ? -(uint32_t)EREMOTEIO_ : 0;
    case HP_URB_STALL:
        return -(uint32_t)EPIPE_;
    case HP_URB_OVERFLOW:
        return -(uint32_t)EOVERFLOW_;
    case HP_URB_CANCELLED:
        return -(uint32_t)ECONNRESET_;
    default:
        return -(uint32_t)EPROTO_;
    }
}
