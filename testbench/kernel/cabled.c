#include "cabled.h"
#include "driver/usbip/server.h"
#include <errno.h>
#include <stdlib.h>

/* ---- cables ---- */

static struct cabled {
    hp_gadget *gadget;
    hpt_cable *cable; /* NULL: free */
} all[HP_USBIP_BOARDS];

static struct cabled *find(const hp_gadget *gadget) {
    for (unsigned i = 0; i < HP_USBIP_BOARDS; i++)
        if (all[i].cable && all[i].gadget == gadget) return &all[i];
    return NULL;
}

static hpt_cable *cable_of(hp_gadget *gadget) {
    struct cabled *at = find(gadget);
    if (at) return at->cable;
    for (at = all; at->cable; at++) continue; /* there are no more gadgets than that */
    *at = (struct cabled){gadget, hpt_cable_new(gadget, hpt_cabled_choose, NULL, gadget)};
    return at->cable;
}

/* ---- urbs ---- */

static hp_urb_status status_of(int error) {
    switch (error) {
    case 0:
        return HP_URB_OK;
    case -EPIPE:
        return HP_URB_STALL;
    case -EOVERFLOW:
        return HP_URB_OVERFLOW;
    case -ENOENT:
    case -ESHUTDOWN:
        return HP_URB_CANCELLED;
    default:
        return HP_URB_LOST;
    }
}

static void carried(hpt_urb *carrier) {
    hp_urb *urb = carrier->owner;
    urb->moved = carrier->urb.moved;
    urb->status = status_of(carrier->error);
    free(carrier);
    urb->done(urb);
}

/* As the client sees it the gadget is here, and so is what an urb keeps for the gadget. */
static hpt_urb *carrier_of(const hp_urb *urb) {
    return (hpt_urb *)(void *)urb->next;
}

static bool is_request(const hp_urb *urb, unsigned type, unsigned request) {
    return urb->endpoint == 0 && urb->setup[0] == type && urb->setup[1] == request;
}

/* What the kernel asks of the device in these requests is to be known to the cable too: it has a halt of its own, and
 * bytes that are half there. */
void hpt_cabled_submit(hp_gadget *gadget, hp_urb *urb) {
    enum { TO_INTERFACE = 1, TO_ENDPOINT = 2, CLEAR_FEATURE = 1, SET_INTERFACE = 11 };
    hpt_cable *cable = cable_of(gadget);
    hpt_urb *carrier = malloc(sizeof *carrier);
    if (!carrier) abort();
    *carrier = (hpt_urb){.urb = *urb, .done = carried, .owner = urb};
    urb->next = &carrier->urb;
    if (is_request(urb, TO_ENDPOINT, CLEAR_FEATURE)) {
        carrier->error = hpt_cable_clear_halt(cable, urb->setup[4]);
        carried(carrier);
        return;
    }
    if (is_request(urb, TO_INTERFACE, SET_INTERFACE)) hpt_cable_flush(cable);
    hpt_cable_submit(cable, carrier);
}

void hpt_cabled_unlink(hp_gadget *gadget, hp_urb *urb) {
    hpt_cable_unlink(cable_of(gadget), carrier_of(urb));
}

/* The cable goes on until nothing can happen any more. */
bool hpt_cabled_run(hp_gadget *gadget) {
    hpt_cable_run(cable_of(gadget));
    return false;
}

void hpt_cabled_reset(hp_gadget *gadget) {
    struct cabled *at = find(gadget);
    if (!at) return; /* nobody has sent it anything */
    hpt_cable_free(at->cable);
    at->cable = NULL;
}
