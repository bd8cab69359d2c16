/* The control plane of a board: who it is, how it is, reset, abort, clock, and what happens on it. It is a HID of its
 * own beside the packets (docs/usb.md), so it answers while a query is under way, and to another program.
 *
 *     hp_control_def def = hp_default_control_def();      // the only board there is; def.serial names one of several
 *     hp_control *control;
 *     hp_status status = hp_control_open(&def, &control); // hp_control_message(NULL) says why not
 *     hp_control_health health;
 *     if (!status) status = hp_control_read_health(control, &health);
 *     if (!status && health.celsius > 80) hp_control_reset(control);
 *     hp_control_close(control);
 *
 * Versions: IDENTITY says which version of the reports a board speaks. A later one works, since a later version only
 * adds: fields behind those of the one before, commands, events. An earlier one refuses the features that it lacks,
 * and nothing else, with HP_ERROR_VERSION and words; hp_control_can tells beforehand.
 *
 * Threads: a control is used by one thread at a time; different controls are independent. Listing and opening take
 * turns under a lock of the library, because hidapi, which is below, keeps state of the process. A program that calls
 * hidapi itself must not call hid_init, hid_exit, hid_enumerate or hid_open* while another thread is in
 * hp_control_list or hp_control_open, nor hid_exit while a control is open. The library itself never calls hid_exit.
 * Two controls of one board, in this program or another: with hidapi's hidraw back end (the default) both work, and
 * each gets every event; with its libusb back end only the first one opens.
 *
 * Waiting: hidapi gives a request to the board 5 s (hidraw) or 1 s (libusb); events have the caller's own timeout.
 * Errors: every call returns an hp_status; hp_control_message says place and cause in words. */
#ifndef HITPIPE_CONTROL_H
#define HITPIPE_CONTROL_H

#include <hitpipe/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hp_control hp_control;

/* Which boards. Always begin with hp_default_control_def. */
typedef struct hp_control_def {
    uint32_t cookie;    /* set by hp_default_control_def: a def without it is refused with HP_ERROR_USAGE */
    const char *serial; /* of the board to open; NULL (default): the only one there is */
    uint16_t vendor;    /* idVendor and idProduct; default those of usb.def */
    uint16_t product;
} hp_control_def;

hp_control_def hp_default_control_def(void);

/* A board that is plugged in, as the operating system tells of it. Text is UTF-8; what is not known is "". */
typedef struct hp_control_board {
    char serial[64]; /* "" also where the libusb back end may not open the device */
    char name[64];   /* "collision board" */
    char path[128];  /* what hidapi opens: "/dev/hidraw0" with hidraw, "1-2:1.1" (bus, port, interface) with libusb */
    uint16_t vendor, product;
    uint16_t release; /* bcdDevice: 0x0100 is 1.00 */
} hp_control_board;

/* Writes the first `room` boards with the identifiers of `def` (its serial is not looked at), by serial number,
 * and to *count how many there are. No board is opened or asked. HP_OK also when there is none. HP_ERROR_USAGE. */
hp_status hp_control_list(const hp_control_def *def, hp_control_board *boards, size_t room, size_t *count);

/* Opens a board and reads its IDENTITY. On success *control is the caller's to close; else *control is NULL.
 * HP_ERROR_NO_DEVICE: there is none, not that one, several and none named, or it may not be opened (the words say
 * which; of permissions they name the udev rule). HP_ERROR_USAGE, HP_ERROR_MEMORY, errors of a request. */
hp_status hp_control_open(const hp_control_def *def, hp_control **control);

/* The board does not notice. NULL is fine. */
void hp_control_close(hp_control *control);

/* Errors of a request, beside those of each call:
 *   HP_ERROR_DISCONNECTED  the board was unplugged; close the control
 *   HP_ERROR_TIMEOUT       the board did not answer
 *   HP_ERROR_IO            the operating system or the board refused the request
 *   HP_ERROR_OPCODE        another report came than was asked for: no hitpipe board, or damaged
 *   HP_ERROR_LENGTH        the report is shorter than its version has it
 *   HP_ERROR_FIELD         a field holds what it cannot
 * After any but the first the control can be used again. */

/* What a board said of itself when it was opened. Lives as long as the control. */
typedef struct hp_control_identity {
    unsigned protocol; /* highest version of packets that it speaks */
    unsigned reports;  /* version of its reports */
    uint32_t pairs;    /* bit CODE of pairs.def: resident */
    uint64_t clock_hz; /* core clock */
    char serial[13];   /* ASCII */
    char name[33];     /* of the board's configuration, UTF-8 */
} hp_control_identity;
const hp_control_identity *hp_control_identify(const hp_control *control);

/* Features that not every version has. */
typedef enum hp_feature {
    HP_FEATURE_HEALTH,
    HP_FEATURE_EVENTS,
#define HP_USB_CONTROL(NAME, code, since, meaning) HP_FEATURE_##NAME,
#include <hitpipe/usb.def>
    HP_FEATURES
} hp_feature;

/* Whether this board has the feature. */
bool hp_control_can(const hp_control *control, hp_feature feature);

/* Names ("RESET"), and the first version of reports with the feature. NULL and 0 for none. */
const char *hp_feature_name(hp_feature feature);
unsigned hp_feature_since(hp_feature feature);

/* How the board is. Counts are since power-up; those of 32 bits stay at their most. */
typedef struct hp_control_health {
    double celsius;       /* of the FPGA */
    bool session;         /* a host has said HELLO since the last reset */
    unsigned speed;       /* of the cable: 3 high speed, 5 SuperSpeed */
    uint64_t packets;     /* taken */
    uint32_t refused;     /* answered with ERROR */
    uint32_t crc;         /* of those: wrong CRC */
    uint32_t sequence;    /* of those: out of order */
    uint32_t events_lost; /* that nobody fetched in time */
    uint32_t resets;      /* soft resets */
} hp_control_health;

/* Asks for the board's health. HP_ERROR_VERSION, errors of a request. */
hp_status hp_control_read_health(hp_control *control, hp_control_health *health);

/* Reads IDENTITY again: the clock may have changed. Errors of a request; the identity then stays as it was. */
hp_status hp_control_read_identity(hp_control *control);

/* Soft reset: what is under way on the board is dropped; session, scene and matrix are forgotten. A host with a query
 * under way says HELLO again; see hitpipe.h for what it keeps. The others as usb.def says. Each waits for the board's
 * own word on the outcome: HP_ERROR_VERSION; HP_ERROR_TAG (another program gave a command at the same time, and the
 * outcome of this one is not known); what the board refused it with; errors of a request. */
hp_status hp_control_reset(hp_control *control);
hp_status hp_control_abort(hp_control *control);
hp_status hp_control_set_clock(hp_control *control, uint64_t hz);

/* Something that happened on the board. */
typedef struct hp_control_event {
    unsigned kind;    /* HP_USB_EVENT_ of usb.h; a later version may have others */
    hp_status status; /* of status.def; a later version may have others */
    uint32_t number;  /* since power-up, from 0 */
    uint32_t lost;    /* how many came between this one and the last one here, and were lost */
    uint32_t tag;     /* of the packet; 0xFFFFFFFF for none */
    uint64_t clocks;  /* the board's clock, since power-up */
} hp_control_event;

/* Waits up to timeout_ms (0: does not wait) for the next event. Those from before the control was opened may or may
 * not come. HP_ERROR_TIMEOUT: none came. HP_ERROR_CANCELLED: a signal was handled meanwhile (with the libusb back end
 * signals do not end the wait). HP_ERROR_SEQUENCE: a number went back, so the board was powered up anew or repeats
 * itself. HP_ERROR_VERSION, errors of a request. On anything but HP_OK *event stays untouched. */
hp_status hp_control_next_event(hp_control *control, unsigned timeout_ms, hp_control_event *event);

/* Name of an event's kind ("PACKET_DONE"), or NULL. */
const char *hp_event_name(unsigned kind);

/* Words on why the last call on this control failed. Empty when it did not. With NULL: the same of this thread's last
 * hp_control_list or hp_control_open. Valid until the next call. */
const char *hp_control_message(const hp_control *control);

#ifdef __cplusplus
}
#endif
#endif
