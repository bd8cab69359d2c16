/* The gadget at the end of a cable, as driver/usbip/client.c sees it. mk/kernel.mk compiles that file, unchanged, a
 * second time for `faulty`, with these calls for the gadget's own:
 *
 *     client.c -- hp_urb --> cabled -- hpt_urb --> testbench/usb/cable.c -- hp_urb --> gadget
 *
 * A cable is there from a client's first urb until the client goes, and numbers its packets anew then. */
#ifndef TESTBENCH_KERNEL_CABLED_H
#define TESTBENCH_KERNEL_CABLED_H

#include "testbench/usb/cable.h"

/* The program's: what happens to a packet. The context is the gadget. */
hpt_choose hpt_cabled_choose;

/* As hp_gadget_submit, _unlink, _run, _reset; but an urb may be done in _submit. */
void hpt_cabled_submit(hp_gadget *gadget, hp_urb *urb);
void hpt_cabled_unlink(hp_gadget *gadget, hp_urb *urb);
bool hpt_cabled_run(hp_gadget *gadget);
void hpt_cabled_reset(hp_gadget *gadget);

#endif
