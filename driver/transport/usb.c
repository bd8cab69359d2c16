/* The USB transport: opening and closing a board, and the vtable. */
#include "usb_internal.h"
#include <stdio.h>
#include <stdlib.h>

/* ---- the vtable ---- */

static hp_status submit(hp_usb *usb, hp_usb_lane *lane, hp_transfer *transfer) {
    if (usb->gone) return HP_ERROR_DISCONNECTED;
    transfer->in = lane->in;
    transfer->moved = transfer->begun = 0;
    transfer->pieces = 0;
    transfer->cancelled = false;
    transfer->status = HP_OK;
    hp_usb_append(&lane->queue, transfer);
    hp_usb_pump(lane);
    return HP_OK;
}

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    hp_usb *usb = (hp_usb *)transport;
    return transfer->room ? submit(usb, &usb->out, transfer) : HP_ERROR_LENGTH;
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    hp_usb *usb = (hp_usb *)transport;
    return transfer->room >= usb->interface.packet ? submit(usb, &usb->into, transfer) : HP_ERROR_LENGTH;
}

static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    hp_usb *usb = (hp_usb *)transport;
    hp_usb_cancel(transfer->in ? &usb->into : &usb->out, transfer);
    return HP_OK;
}

/* Runs `done` of what had ended by now; what ends in them is for the next round. */
static unsigned run_done(hp_usb *usb) {
    unsigned completed = 0;
    hp_transfer *last = usb->done.last;
    while (usb->done.first) {
        hp_transfer *transfer = usb->done.first;
        bool was_last = transfer == last;
        usb->done.first = transfer->next;
        completed++;
        transfer->done(transfer);
        if (was_last) break;
    }
    return completed;
}

/* How long there is to wait: not past the mending of a lane. */
static unsigned until(const hp_usb *usb, uint64_t deadline) {
    uint64_t now = hp_usb_ms();
    const hp_usb_lane *lanes[] = {&usb->out, &usb->into};
    for (unsigned i = 0; i < 2; i++)
        if (lanes[i]->broken && !lanes[i]->flying && lanes[i]->mend_ms < deadline) deadline = lanes[i]->mend_ms;
    return deadline > now ? (unsigned)(deadline - now) : 0;
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    hp_usb *usb = (hp_usb *)transport;
    uint64_t deadline = hp_usb_ms() + timeout_ms;
    for (bool last = timeout_ms == 0;; last = hp_usb_ms() >= deadline) {
        hp_usb_look(usb);
        bool flying = usb->out.flying || usb->into.flying;
        *completed =
            usb->gone && flying && !last ? 0 : run_done(usb); /* what came before the board went comes first */
        if (*completed) return HP_OK;
        if (usb->gone && !flying) return HP_ERROR_DISCONNECTED;
        hp_status status = hp_usb_wait(usb, last ? 0 : until(usb, deadline));
        if (status) return status;
        if (!last) continue;
        hp_usb_look(usb);
        *completed = run_done(usb);
        return *completed ? HP_OK : usb->gone ? HP_ERROR_DISCONNECTED : HP_ERROR_TIMEOUT;
    }
}

static size_t transfer_max(const hp_transport *transport) {
    (void)transport;
    return HP_USB_PACKET_MAX;
}

static size_t in_room(const hp_transport *transport) {
    (void)transport;
    return HP_USB_ROOM_MAX;
}

static unsigned in_transfers(const hp_transport *transport) {
    return ((const hp_usb *)transport)->depth;
}

static uint8_t *allocate(hp_transport *transport, size_t bytes) {
    return hp_usb_allocate((hp_usb *)transport, bytes);
}

/* ---- close ---- */

enum { CLOSE_MS = 2000 };

/* Waits until libusb has given everything back. A kernel that does not is not waited for longer than that; closing
 * the handle takes it from there. */
static void wait_for_all(hp_usb *usb) {
    uint64_t deadline = hp_usb_ms() + CLOSE_MS;
    usb->wait = NULL;                          /* the user has closed the device: his loop does not run for it */
    usb->out.broken = usb->into.broken = true; /* nothing goes out any more ... */
    usb->out.mend_ms = usb->into.mend_ms = UINT64_MAX;
    while ((usb->out.flying || usb->into.flying) && hp_usb_ms() < deadline) {
        hp_usb_wait(usb, until(usb, deadline));
        hp_usb_look(usb);
    }
}

static void close_usb(hp_transport *transport) {
    hp_usb *usb = (hp_usb *)transport;
    hp_usb_call_back(&usb->into);
    hp_usb_call_back(&usb->out);
    wait_for_all(usb);
    hp_usb_end_all(&usb->out, HP_ERROR_CANCELLED);
    hp_usb_end_all(&usb->into, HP_ERROR_CANCELLED);
    while (run_done(usb)) continue;
    hp_usb_events_close(usb);
    libusb_release_interface(usb->handle, usb->interface.number);
    hp_usb_free_all(usb);
    libusb_close(usb->handle);
    hp_usb_lane_close(&usb->out);
    hp_usb_lane_close(&usb->into);
    hp_usb_bus_close(&usb->bus);
    pthread_mutex_destroy(&usb->lock);
    free(usb);
}

static const hp_transport_ops usb_ops = {
    .name = "usb",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .waits = true,
    .transfer_max = transfer_max,
    .in_room = in_room,
    .in_transfers = in_transfers,
    .allocate = allocate,
    .close = close_usb,
};

const char *hp_transport_usb_serial(const hp_transport *transport) {
    return transport->ops == &usb_ops ? ((const hp_usb *)transport)->serial : NULL;
}

/* ---- open ---- */

enum { DRAIN_MS = 10, DRAIN_MS_MOST = 1000, DRAIN_BYTES = 64 * 1024 };

/* Throws away what the board still sends to a program that is no more, until it is silent. What an earlier program's
 * last packets are answered with later than that, the queue knows by its tags. */
static int drain(hp_usb *usb) {
    uint64_t deadline = hp_usb_ms() + DRAIN_MS_MOST;
    uint8_t *bytes = malloc(DRAIN_BYTES);
    int moved = 0, error = bytes ? 0 : LIBUSB_ERROR_NO_MEM;
    while (!error && hp_usb_ms() < deadline) {
        error = libusb_bulk_transfer(usb->handle, usb->interface.in, bytes, DRAIN_BYTES, &moved, DRAIN_MS);
        if (error == LIBUSB_ERROR_TIMEOUT && moved == 0) break;
        if (error == LIBUSB_ERROR_PIPE) error = libusb_clear_halt(usb->handle, usb->interface.in);
        if (error == LIBUSB_ERROR_TIMEOUT || error == LIBUSB_ERROR_OVERFLOW) error = 0;
    }
    free(bytes);
    return error == LIBUSB_ERROR_TIMEOUT ? 0 : error;
}

/* The board's name in messages: "board HP1", or where it is. */
static void name_board(const hp_usb *usb, char name[HP_USB_TEXT]) {
    libusb_device *device = libusb_get_device(usb->handle);
    if (usb->serial[0])
        snprintf(name, HP_USB_TEXT, "board %.50s", usb->serial);
    else
        snprintf(name, HP_USB_TEXT, "board at USB bus %u, address %u", libusb_get_bus_number(device),
                 libusb_get_device_address(device));
}

/* Choosing the interface's setting puts the board in reset, whoever used it before, and ends what is half there. */
static hp_status take_interface(hp_usb *usb, hp_message *message) {
    char name[HP_USB_TEXT];
    struct libusb_device_descriptor said;
    libusb_device *device = libusb_get_device(usb->handle);
    if (libusb_get_device_descriptor(device, &said) == 0) hp_usb_text(usb->handle, said.iSerialNumber, usb->serial);
    name_board(usb, name);
    if (!hp_usb_data_interface(device, &usb->interface))
        return hp_say(message, HP_ERROR_NO_DEVICE, "%s has no data interface", name);
    int error = libusb_claim_interface(usb->handle, usb->interface.number);
    if (error == LIBUSB_ERROR_BUSY)
        return hp_say(message, HP_ERROR_NO_DEVICE, "%s is busy: another program has its data interface", name);
    if (error)
        return hp_say(message, hp_usb_status(error), "%s: cannot claim its data interface: %s", name,
                      hp_usb_words(error));
    error = libusb_set_interface_alt_setting(usb->handle, usb->interface.number, 0);
    if (!error) error = drain(usb);
    if (!error) return HP_OK;
    libusb_release_interface(usb->handle, usb->interface.number);
    return hp_say(message, hp_usb_status(error), "%s: cannot begin: %s", name, hp_usb_words(error));
}

static hp_status check_def(const hp_device_def *def, hp_message *message) {
    if (def->usb_depth < 1 || def->usb_depth > HP_USB_DEPTH_MAX)
        return hp_say(message, HP_ERROR_USAGE, "usb_depth is %u: it is 1 to %d", def->usb_depth, HP_USB_DEPTH_MAX);
    if (def->usb_transfer > HP_USB_TRANSFER_MAX || def->usb_transfer % HP_USB_SUPER_PACKET)
        return hp_say(message, HP_ERROR_USAGE, "usb_transfer is %u: it is a multiple of %d up to %d, or 0",
                      def->usb_transfer, HP_USB_SUPER_PACKET, HP_USB_TRANSFER_MAX);
    if (def->usb_vendor > 0xFFFF || def->usb_product > 0xFFFF)
        return hp_say(message, HP_ERROR_USAGE, "usb_vendor and usb_product have 16 bits");
    return HP_OK;
}

static hp_status make_lanes(hp_usb *usb, const hp_device_def *def, hp_message *message) {
    usb->wait = def->wait;
    usb->wait_context = def->wait_context;
    hp_status status = hp_usb_lane_open(usb, &usb->out, false, def->usb_transfer);
    if (!status) status = hp_usb_lane_open(usb, &usb->into, true, def->usb_transfer);
    return status ? hp_say(message, status, "no memory for USB transfers") : HP_OK;
}

/* Over a handle, which becomes the transport's also on error, and so does the bus. */
static hp_status open_handle(const hp_device_def *def, hp_usb_bus bus, libusb_device_handle *handle,
                             hp_transport **transport, hp_message *message) {
    hp_usb *usb = calloc(1, sizeof *usb);
    if (!usb) {
        libusb_close(handle);
        hp_usb_bus_close(&bus);
        return hp_say(message, HP_ERROR_MEMORY, "%s", hp_status_text(HP_ERROR_MEMORY));
    }
    usb->head.ops = &usb_ops;
    usb->bus = bus;
    usb->handle = handle;
    usb->depth = def->usb_depth;
    usb->out.usb = usb->into.usb = usb;
    pthread_mutex_init(&usb->lock, NULL);
    hp_status status = take_interface(usb, message);
    if (!status) status = make_lanes(usb, def, message);
    hp_usb_events_open(usb);
    if (status)
        close_usb(&usb->head);
    else
        *transport = &usb->head;
    return status;
}

hp_status hp_transport_usb_wrap(const hp_device_def *def, struct libusb_context *context,
                                struct libusb_device_handle *handle, hp_transport **transport, hp_message *message) {
    hp_status status = check_def(def, message);
    if (status) {
        libusb_close(handle);
        return status;
    }
    return open_handle(def, (hp_usb_bus){.context = context}, handle, transport, message);
}

hp_status hp_transport_usb(const hp_device_def *def, const char *serial, hp_transport **transport,
                           hp_message *message) {
    hp_usb_bus bus;
    libusb_device_handle *handle;
    hp_status status = check_def(def, message);
    if (!status) status = hp_usb_bus_open(def, &bus, message);
    if (status) return status;
    status = hp_usb_open(&bus, def, serial, &handle, message);
    if (!status) return open_handle(def, bus, handle, transport, message);
    hp_usb_bus_close(&bus);
    return status;
}
