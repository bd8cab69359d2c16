#include "internal.h"
#include <stdlib.h>
#include <string.h>

hp_endpoint hp_endpoint_at(unsigned address) {
    switch (address) {
    case 0x00:
        return HP_ENDPOINT_CONTROL;
    case HP_USB_OUT_ENDPOINT:
        return HP_ENDPOINT_OUT;
    case HP_USB_IN_ENDPOINT:
        return HP_ENDPOINT_IN;
    case HP_USB_EVENT_ENDPOINT:
        return HP_ENDPOINT_EVENT;
    default:
        return HP_ENDPOINT_NONE;
    }
}

/* ---- queues ---- */

static void append(hp_urb_queue *queue, hp_urb *urb) {
    urb->next = NULL;
    if (queue->first)
        queue->last->next = urb;
    else
        queue->first = urb;
    queue->last = urb;
}

static bool take_out(hp_urb_queue *queue, const hp_urb *urb) {
    hp_urb *before = NULL;
    for (hp_urb *at = queue->first; at; before = at, at = at->next) {
        if (at != urb) continue;
        *(before ? &before->next : &queue->first) = at->next;
        if (queue->last == at) queue->last = before;
        return true;
    }
    return false;
}

static void end(hp_urb *urb, hp_urb_status status, size_t moved) {
    urb->status = status;
    urb->moved = moved;
    urb->done(urb);
}

void hp_urb_finish(hp_gadget *gadget, hp_endpoint endpoint, hp_urb_status status, size_t moved) {
    hp_urb *urb = gadget->queues[endpoint].first;
    gadget->queues[endpoint].first = urb->next;
    end(urb, status, moved);
}

/* Urbs that are submitted meanwhile stay. */
static void cancel_all(hp_gadget *gadget) {
    hp_urb_queue queues[HP_ENDPOINTS];
    memcpy(queues, gadget->queues, sizeof queues);
    memset(gadget->queues, 0, sizeof gadget->queues);
    gadget->bulk.urb_waits = false;
    for (unsigned i = 0; i < HP_ENDPOINTS; i++)
        for (hp_urb *urb = queues[i].first, *next; urb; urb = next) {
            next = urb->next;
            end(urb, HP_URB_CANCELLED, 0);
        }
}

/* ---- create, destroy, reset ---- */

static bool serial_fits(const char *serial) {
    size_t n = serial ? strnlen(serial, HP_SERIAL_MOST + 1) : 0;
    for (size_t i = 0; i < n; i++)
        if (serial[i] <= ' ' || serial[i] > '~') return false;
    return n >= 1 && n <= HP_SERIAL_MOST;
}

static bool fits(const hp_gadget_def *def) {
    return serial_fits(def->serial) && (def->speed == HP_USB_HIGH || def->speed == HP_USB_SUPER) &&
           def->vendor <= 0xFFFF && def->product <= 0xFFFF;
}

hp_status hp_gadget_create(const hp_gadget_def *def, hp_gadget **gadget) {
    *gadget = NULL;
    if (!fits(def)) return HP_ERROR_USAGE;
    hp_gadget *made = calloc(1, sizeof *made);
    if (!made) return HP_ERROR_MEMORY;
    strcpy(made->serial, def->serial);
    made->speed = def->speed;
    made->descriptors = hp_descriptors_make(def);
    hp_status status = hp_bulk_create(&made->bulk);
    if (status == HP_OK) status = hp_board_create(&def->board, &made->board);
    if (status != HP_OK)
        hp_gadget_destroy(made);
    else
        *gadget = made;
    return status;
}

void hp_gadget_destroy(hp_gadget *gadget) {
    if (!gadget) return;
    cancel_all(gadget);
    hp_board_destroy(gadget->board);
    hp_bulk_destroy(&gadget->bulk);
    free(gadget);
}

void hp_gadget_reset(hp_gadget *gadget) {
    cancel_all(gadget);
    hp_events_lose(&gadget->reports);
    gadget->address = gadget->configuration = 0;
    hp_gadget_reset_board(gadget);
}

void hp_gadget_reset_board(hp_gadget *gadget) {
    hp_board_reset(gadget->board);
    hp_bulk_drop(gadget, true);
    hp_event_add(gadget, HP_USB_EVENT_RESET, HP_OK, HP_NO_TAG);
}

/* ---- urbs ---- */

void hp_gadget_submit(hp_gadget *gadget, hp_urb *urb) {
    append(&gadget->queues[hp_endpoint_at(urb->endpoint)], urb);
}

void hp_gadget_unlink(hp_gadget *gadget, hp_urb *urb) {
    hp_endpoint endpoint = hp_endpoint_at(urb->endpoint);
    if (gadget->bulk.urb_waits && urb == gadget->queues[HP_ENDPOINT_OUT].first) gadget->bulk.urb_waits = false;
    if (take_out(&gadget->queues[endpoint], urb)) end(urb, HP_URB_CANCELLED, 0);
}

bool hp_endpoint_works(hp_gadget *gadget, hp_endpoint endpoint, bool *stalled) {
    bool works = gadget->configuration && !gadget->halted[endpoint];
    *stalled = !works && gadget->queues[endpoint].first;
    if (*stalled) hp_urb_finish(gadget, endpoint, HP_URB_STALL, 0);
    return works;
}

static bool refuse_stray(hp_gadget *gadget) {
    if (!gadget->queues[HP_ENDPOINT_NONE].first) return false;
    hp_urb_finish(gadget, HP_ENDPOINT_NONE, HP_URB_STALL, 0);
    return true;
}

/* One urb of each endpoint at most, so that a host which submits again in `done` does not keep this from returning.
 */
bool hp_gadget_run(hp_gadget *gadget) {
    bool happened = hp_control_run(gadget);
    happened |= refuse_stray(gadget);
    happened |= hp_event_run(gadget);
    happened |= hp_bulk_run_in(gadget);
    happened |= hp_bulk_run_out(gadget);
    happened |= hp_bulk_run_board(gadget);
    return happened;
}

/* ---- what the device is ---- */

const uint8_t *hp_gadget_device_descriptor(const hp_gadget *gadget) {
    return gadget->descriptors.device;
}

const uint8_t *hp_gadget_configuration(const hp_gadget *gadget, size_t *bytes) {
    *bytes = gadget->descriptors.configuration_bytes;
    return gadget->descriptors.configuration;
}

const char *hp_gadget_serial(const hp_gadget *gadget) {
    return gadget->serial;
}

hp_usb_speed hp_gadget_speed(const hp_gadget *gadget) {
    return gadget->speed;
}
