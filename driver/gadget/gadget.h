/* The board as a USB device: descriptors, endpoints and HID reports in front of the simulated board. The only device
 * side there is: the USB/IP server and every level of test put it behind their own kind of cable.
 *
 *   usbfs shim ----\                     control ---- descriptors
 *   umockdev -------+-- urb --> gadget -- bulk ------ board (bytes in, bytes out)
 *   USB/IP server -/                     interrupt -- events
 *
 * An urb is one transfer as a host controller sees it: any length, split into USB packets by nobody; a transfer to
 * the host ends early where the device had less to say. What an urb's bytes are is between host and endpoint.
 *
 * One thread at a time per gadget. Not part of the public interface. */
#ifndef HITPIPE_GADGET_H
#define HITPIPE_GADGET_H

#include <hitpipe/board.h>
#include <hitpipe/usb.h>

typedef struct hp_gadget hp_gadget;

typedef enum hp_usb_speed {
    HP_USB_HIGH = 3,
    HP_USB_SUPER = 5
} hp_usb_speed; /* as USB/IP and the kernel number them */

typedef struct hp_gadget_def {
    hp_board_def board;
    const char *serial; /* ASCII, 1 to 12 characters */
    hp_usb_speed speed;
    unsigned vendor, product; /* 0: those of usb.def */
} hp_gadget_def;

typedef enum hp_urb_status {
    HP_URB_OK,
    HP_URB_STALL,     /* the endpoint is halted, or the request is none that the device knows */
    HP_URB_OVERFLOW,  /* the device had more than the urb has room for */
    HP_URB_CANCELLED, /* hp_gadget_unlink, a reset, or the gadget's end */
    HP_URB_LOST       /* nothing of the gadget's: for cables that lose things, EPROTO in the kernel */
} hp_urb_status;

typedef struct hp_urb hp_urb;
struct hp_urb {
    uint8_t endpoint; /* address, 0x80 set for IN; 0 for control, whose direction is in `setup` */
    uint8_t setup[8]; /* control only */
    uint8_t *bytes;   /* to the device or from it; stays the caller's until `done` */
    size_t length;    /* bytes to send, or room */
    size_t moved;     /* set before `done` */
    bool zero_packet; /* OUT: a transfer that is a multiple of the packet size is ended by a zero-length packet */
    hp_urb_status status;
    void (*done)(hp_urb *urb); /* runs once for each urb, inside hp_gadget_run, _unlink, _reset or _destroy */
    void *owner;               /* the submitter's own */
    hp_urb *next;              /* the gadget's own */
};

/* A device just plugged in: no configuration, its board in reset. HP_ERROR_USAGE (a serial or speed that is none), or
 * what hp_board_create says. */
hp_status hp_gadget_create(const hp_gadget_def *def, hp_gadget **gadget);
void hp_gadget_destroy(hp_gadget *gadget);

/* Queues an urb behind those of its endpoint. On an endpoint that is halted, not configured or not there it ends with
 * HP_URB_STALL. May be called in `done`. */
void hp_gadget_submit(hp_gadget *gadget, hp_urb *urb);

/* Takes back an urb that is not done yet: it ends with HP_URB_CANCELLED. What the board already had of it stays. An
 * urb that is done is left alone. May be called in `done`. */
void hp_gadget_unlink(hp_gadget *gadget, hp_urb *urb);

/* Does what can be done at once, of each endpoint one urb at most, and carries the board on by at most one event.
 * True: something happened, call again; false: nothing can happen before the next submit. Not to be called in `done`,
 * nor are _reset and _destroy. */
bool hp_gadget_run(hp_gadget *gadget);

/* Bus reset: address and configuration 0, all urbs cancelled, the board in reset. What is
 * submitted meanwhile, in `done`, stays. */
void hp_gadget_reset(hp_gadget *gadget);

/* For what shows a device before anybody asks: the 18 bytes of the device descriptor, and the whole configuration. */
const uint8_t *hp_gadget_device_descriptor(const hp_gadget *gadget);
const uint8_t *hp_gadget_configuration(const hp_gadget *gadget, size_t *bytes);
const char *hp_gadget_serial(const hp_gadget *gadget);
hp_usb_speed hp_gadget_speed(const hp_gadget *gadget);

#endif
