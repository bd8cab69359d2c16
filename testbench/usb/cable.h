/* The cable between a host's urbs and a board's gadget.
 *
 *     usbfs -- hpt_urb --> [ straight ]  -- hp_urb --> gadget
 *                          [ faulty: puts packets together, does something to them, and passes on what is left ]
 *
 * A straight cable hands each bulk urb on as it is. A faulty one shows each packet that passes to `choose`, which
 * says what happens to it; it takes the packets to the host out of the gadget itself and deals them out to the host's
 * urbs, as the device side would. Control and interrupt urbs always go straight.
 *
 * One thread at a time. */
#ifndef TESTBENCH_USB_CABLE_H
#define TESTBENCH_USB_CABLE_H

#include "driver/gadget/gadget.h"

typedef enum hpt_fault_kind {
#define HPT_FAULT(NAME, words) HPT_FAULT_##NAME,
#include "faults.def"
#undef HPT_FAULT
    HPT_FAULT_KINDS
} hpt_fault_kind;

typedef struct hpt_fault {
    hpt_fault_kind kind;
    unsigned argument;
} hpt_fault;

/* What happens to packet `number` (from 0) of its direction; `in`: to the host. */
typedef hpt_fault hpt_choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n);

typedef struct hpt_cable hpt_cable;
typedef struct hpt_urb hpt_urb;
struct hpt_urb {
    hp_urb urb; /* endpoint, setup, bytes, length, zero_packet; when it ended: moved */
    int error;  /* when it ended: 0, or a negative errno as in the kernel */
    void (*done)(hpt_urb *urb);
    void *owner;
    /* The cable's own. */
    hpt_cable *cable;
    bool straight; /* the gadget has it, or had */
    hpt_urb *next;
};

/* `choose` NULL: straight. `pulled` runs when a fault unplugs the board: hpt_cable_pull is to follow, then or later.
 */
hpt_cable *hpt_cable_new(hp_gadget *gadget, hpt_choose *choose, void (*pulled)(void *context, unsigned back_ms),
                         void *context);
void hpt_cable_free(hpt_cable *cable);

/* Submits, takes back (ends with -ENOENT, unless it has ended), and does all that can be done. `done` runs in any of
 * these. */
void hpt_cable_submit(hpt_cable *cable, hpt_urb *urb);
void hpt_cable_unlink(hpt_cable *cable, hpt_urb *urb);
void hpt_cable_run(hpt_cable *cable);

/* Whether a packet is held that is to come behind another; when none comes, it is to be released after a while. */
bool hpt_cable_holds(const hpt_cable *cable);
void hpt_cable_release(hpt_cable *cable);

/* A control request, carried out at once: bytes moved, or -EPIPE. */
int hpt_cable_control(hpt_cable *cable, const uint8_t setup[8], uint8_t *bytes, size_t length);

/* CLEAR_FEATURE(ENDPOINT_HALT), and what it means for what is half transferred. 0 or -EPIPE. */
int hpt_cable_clear_halt(hpt_cable *cable, uint8_t endpoint);

/* What is on its way is gone: the board begins anew. */
void hpt_cable_flush(hpt_cable *cable);

/* Out of the socket: all urbs end with -ESHUTDOWN. Not in `done`. And in again. */
void hpt_cable_pull(hpt_cable *cable);
void hpt_cable_push(hpt_cable *cable);

/* Packets that have passed, or were to; [1]: to the host. */
unsigned hpt_cable_packets(const hpt_cable *cable, bool in);

#endif
