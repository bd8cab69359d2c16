/* Transfers of one direction.
 *
 *            submit                pump               callback            look
 *   queue  ---------->  waiting  -------->  flying  ------------>  landed  ---->  ended
 *                          ^                                                |
 *                          +--- called back when the lane was broken -------+
 *
 * A packet to the board goes out as one or more pieces, each a multiple of the endpoint's packet size but for the
 * last, behind which a zero-length USB packet is added where it is one too. A packet to the host fills one transfer;
 * a lane that copies takes it in pieces, into buffers of its own, until one is not full.
 *
 * A lane breaks when its endpoint stalls or fails, or when a packet to the board is called back, of which the board
 * may have the beginning. Then everything is called back, and when all of it is there, the lane is mended: CLEAR_HALT
 * makes both sides begin anew, and the board forgets what it has half. What was waiting to go out ends with the
 * error, and the queue sends it again; transfers to the host just go on waiting. Each failure in a row makes the next
 * mending wait longer. */
#include "usb_internal.h"
#include <string.h>

/* ---- lists ---- */

void hp_usb_append(hp_usb_fifo *fifo, hp_transfer *transfer) {
    transfer->next = NULL;
    if (fifo->first)
        fifo->last->next = transfer;
    else
        fifo->first = transfer;
    fifo->last = transfer;
}

static void take_out(hp_usb_fifo *fifo, hp_transfer *transfer) {
    hp_transfer *before = NULL, *at = fifo->first;
    for (; at != transfer; at = at->next) before = at;
    if (before)
        before->next = at->next;
    else
        fifo->first = at->next;
    if (fifo->last == at) fifo->last = before;
}

static void end(hp_usb_lane *lane, hp_transfer *transfer, hp_status status) {
    take_out(&lane->queue, transfer);
    transfer->status = status;
    if (status && lane->in) transfer->moved = 0;
    hp_usb_append(&lane->usb->done, transfer);
}

/* ---- open and close ---- */

/* Runs on whatever thread handles libusb's events. */
static void LIBUSB_CALL landed(struct libusb_transfer *libusb) {
    hp_usb_slot *slot = libusb->user_data;
    hp_usb *usb = slot->lane->usb;
    pthread_mutex_lock(&usb->lock);
    hp_usb_slot **last = &usb->landed;
    while (*last) last = &(*last)->next;
    slot->next = NULL;
    *last = slot;
    __atomic_store_n(&usb->arrived, 1, __ATOMIC_RELEASE); /* libusb reads it, without our lock */
    pthread_mutex_unlock(&usb->lock);
}

hp_status hp_usb_lane_open(hp_usb *usb, hp_usb_lane *lane, bool in, unsigned piece) {
    lane->in = in;
    lane->address = in ? usb->interface.in : usb->interface.out;
    lane->copies = in && piece && piece < HP_USB_ROOM_MAX;
    lane->piece = piece ? piece : HP_USB_ROOM_MAX;
    for (unsigned i = 0; i < usb->depth; i++) {
        hp_usb_slot *slot = &lane->slots[i];
        slot->lane = lane;
        slot->libusb = libusb_alloc_transfer(0);
        if (lane->copies) slot->buffer = hp_usb_allocate(usb, lane->piece);
        if (!slot->libusb || (lane->copies && !slot->buffer)) return HP_ERROR_MEMORY;
    }
    return HP_OK;
}

void hp_usb_lane_close(hp_usb_lane *lane) {
    for (unsigned i = 0; i < HP_USB_DEPTH_MAX; i++) libusb_free_transfer(lane->slots[i].libusb);
}

/* ---- handing over ---- */

static hp_usb_slot *free_slot(hp_usb_lane *lane) {
    for (unsigned i = 0; i < lane->usb->depth; i++) {
        hp_usb_slot *slot = &lane->slots[i];
        bool full = false;
        for (hp_usb_slot *held = lane->held; held; held = held->next) full |= held == slot;
        if (!slot->flying && !full) return slot;
    }
    return NULL;
}

static void break_lane(hp_usb_lane *lane);

/* Ends the transfer, now or when the last of its pieces is back. */
static void fail(hp_usb_lane *lane, hp_transfer *transfer, hp_status status) {
    transfer->begun = transfer->room;
    transfer->status = status;
    if (!transfer->pieces) end(lane, transfer, status);
}

/* False: libusb does not take it, and the lane is broken. */
static bool fly(hp_usb_slot *slot, hp_transfer *transfer, uint8_t *bytes, size_t n, bool last) {
    hp_usb_lane *lane = slot->lane;
    hp_usb *usb = lane->usb;
    libusb_fill_bulk_transfer(slot->libusb, usb->handle, lane->address, bytes, (int)n, landed, slot, 0);
    slot->libusb->flags = last ? LIBUSB_TRANSFER_ADD_ZERO_PACKET : 0;
    slot->transfer = transfer;
    slot->number = lane->number++;
    slot->flying = true; /* before it can land */
    int error = libusb_submit_transfer(slot->libusb);
    if (!error) {
        lane->flying++;
        if (transfer) transfer->pieces++;
        return true;
    }
    slot->flying = false;
    if (error == LIBUSB_ERROR_NO_DEVICE) usb->gone = true;
    if (error == LIBUSB_ERROR_NO_MEM && lane->flying) return false; /* of the kernel's: again when something landed */
    lane->failures = error == LIBUSB_ERROR_NO_MEM ? 1 : lane->failures + 1; /* others may free some soon */
    if (transfer) fail(lane, transfer, hp_usb_status(error));
    break_lane(lane);
    return false;
}

/* The next piece of what waits to go out. False: there is none, or it could not go. */
static bool send_piece(hp_usb_lane *lane, hp_usb_slot *slot) {
    hp_transfer *transfer = lane->queue.first;
    while (transfer && transfer->begun == transfer->room) transfer = transfer->next;
    if (!transfer) return false;
    size_t left = transfer->room - transfer->begun, n = left < lane->piece ? left : lane->piece;
    if (!fly(slot, transfer, transfer->bytes + transfer->begun, n, n == left)) return false;
    transfer->begun += n;
    return true;
}

static bool listen(hp_usb_lane *lane, hp_usb_slot *slot) {
    if (lane->copies) return fly(slot, NULL, slot->buffer, lane->piece, false);
    hp_transfer *transfer = lane->queue.first;
    while (transfer && transfer->begun) transfer = transfer->next;
    if (!transfer) return false;
    size_t room = transfer->room / lane->usb->interface.packet * lane->usb->interface.packet;
    if (!fly(slot, transfer, transfer->bytes, room, false)) return false;
    transfer->begun = room;
    return true;
}

void hp_usb_pump(hp_usb_lane *lane) {
    hp_usb_slot *slot;
    while (!lane->broken && !lane->usb->gone && (slot = free_slot(lane)))
        if (!(lane->in ? listen(lane, slot) : send_piece(lane, slot))) break;
}

/* ---- calling back ---- */

/* The newest first: what is behind one that goes must not move up and be sent instead. */
void hp_usb_call_back(hp_usb_lane *lane) {
    uint64_t above = lane->number;
    for (hp_usb_slot *newest;; above = newest->number) {
        newest = NULL;
        for (unsigned i = 0; i < lane->usb->depth; i++) {
            hp_usb_slot *slot = &lane->slots[i];
            if (slot->flying && slot->number < above && (!newest || slot->number > newest->number)) newest = slot;
        }
        if (!newest) return;
        libusb_cancel_transfer(newest->libusb);
    }
}

void hp_usb_end_all(hp_usb_lane *lane, hp_status status) {
    for (hp_transfer *at = lane->queue.first, *next; at; at = next) {
        next = at->next;
        if (!at->pieces) end(lane, at, status);
    }
}

static void call_one_back(hp_usb_lane *lane, const hp_transfer *transfer) {
    for (unsigned i = 0; i < lane->usb->depth; i++)
        if (lane->slots[i].flying && lane->slots[i].transfer == transfer)
            libusb_cancel_transfer(lane->slots[i].libusb);
}

void hp_usb_cancel(hp_usb_lane *lane, hp_transfer *transfer) {
    hp_transfer *at = lane->queue.first;
    while (at && at != transfer) at = at->next;
    if (!at) return; /* it has ended, and `done` is due */
    transfer->cancelled = true;
    transfer->begun = transfer->room; /* no further pieces */
    if (!transfer->pieces) {
        if (lane->copies) lane->skip |= transfer->moved > 0;
        end(lane, transfer, HP_ERROR_CANCELLED);
    } else if (lane->in) {
        call_one_back(lane, transfer);
    } else {
        break_lane(lane);
    }
}

static void break_lane(hp_usb_lane *lane) {
    /* A cable that is pulled gives errors for a while before the kernel says that the board is gone. */
    static const unsigned pauses[] = {0, 20, 80, 320};
    unsigned last = sizeof pauses / sizeof pauses[0] - 1;
    if (lane->broken) return;
    lane->broken = true;
    lane->mend_ms = hp_usb_ms() + pauses[lane->failures < last ? lane->failures : last];
    hp_usb_call_back(lane);
    if (!lane->in) hp_usb_end_all(lane, HP_ERROR_IO);
}

static void mend(hp_usb_lane *lane) {
    if (!lane->broken || lane->flying || lane->usb->gone || hp_usb_ms() < lane->mend_ms) return;
    int error = libusb_clear_halt(lane->usb->handle, lane->address);
    lane->broken = false;
    if (error == LIBUSB_ERROR_NO_DEVICE) {
        lane->usb->gone = true;
    } else if (error) {
        lane->failures++;
        break_lane(lane);
    }
}

/* ---- landing ---- */

static bool is_fault(enum libusb_transfer_status outcome) {
    return outcome != LIBUSB_TRANSFER_COMPLETED && outcome != LIBUSB_TRANSFER_CANCELLED &&
           outcome != LIBUSB_TRANSFER_NO_DEVICE;
}

/* How a piece that did not go well ended: called back by the user, or with the others of a broken lane. */
static hp_status status_of(const hp_usb_slot *slot) {
    if (slot->libusb->status != LIBUSB_TRANSFER_CANCELLED) return hp_usb_outcome(slot->libusb->status);
    return slot->transfer->cancelled ? HP_ERROR_CANCELLED : HP_ERROR_IO;
}

static void sent(hp_usb_slot *slot) {
    hp_usb_lane *lane = slot->lane;
    hp_transfer *transfer = slot->transfer;
    if (!transfer) return;
    hp_status status = slot->libusb->status == LIBUSB_TRANSFER_COMPLETED ? HP_OK : status_of(slot);
    transfer->moved += (size_t)slot->libusb->actual_length;
    if (status && !transfer->status) transfer->status = status;
    if (transfer->status) transfer->begun = transfer->room;
    if (transfer->cancelled && transfer->moved < transfer->room && !transfer->status)
        transfer->status = HP_ERROR_CANCELLED;
    if (!transfer->pieces && transfer->begun == transfer->room) end(lane, transfer, transfer->status);
}

static void received(hp_usb_slot *slot) {
    hp_usb_lane *lane = slot->lane;
    hp_transfer *transfer = slot->transfer;
    enum libusb_transfer_status outcome = slot->libusb->status;
    transfer->moved = (size_t)slot->libusb->actual_length;
    if (outcome == LIBUSB_TRANSFER_CANCELLED && !transfer->cancelled && transfer->moved == 0)
        transfer->begun = 0; /* called back with the others: it waits on */
    else
        end(lane, transfer, outcome == LIBUSB_TRANSFER_COMPLETED ? HP_OK : status_of(slot));
}

/* Copies what the oldest held slot has to the oldest transfer. True: that is possible, and the slot is free again. */
static bool copy(hp_usb_lane *lane) {
    hp_usb_slot *slot = lane->held;
    hp_transfer *transfer = lane->queue.first;
    if (!slot || (!transfer && !lane->skip)) return false;
    size_t n = (size_t)slot->libusb->actual_length;
    bool ends = n < lane->piece;
    lane->held = slot->next;
    if (lane->skip) {
        lane->skip = !ends;
        return true;
    }
    bool fits = n <= transfer->room - transfer->moved;
    if (fits) memcpy(transfer->bytes + transfer->moved, slot->buffer, n);
    transfer->moved += fits ? n : 0;
    lane->skip = !fits && !ends;
    if (ends || !fits) end(lane, transfer, fits ? HP_OK : HP_ERROR_LENGTH);
    return true;
}

/* A copying lane: the bytes are kept until a transfer asks for them; an error is the oldest transfer's. */
static void collected(hp_usb_slot *slot) {
    hp_usb_lane *lane = slot->lane;
    hp_usb_slot **last = &lane->held;
    if (slot->libusb->status == LIBUSB_TRANSFER_COMPLETED) {
        while (*last) last = &(*last)->next;
        slot->next = NULL;
        *last = slot;
        return;
    }
    bool nothing = slot->libusb->actual_length == 0 && (slot->libusb->status == LIBUSB_TRANSFER_CANCELLED ||
                                                        slot->libusb->status == LIBUSB_TRANSFER_NO_DEVICE);
    if (nothing || !lane->queue.first) return;
    while (copy(lane)) continue;
    if (lane->queue.first) end(lane, lane->queue.first, hp_usb_outcome(slot->libusb->status));
}

static void look_at(hp_usb_slot *slot) {
    hp_usb_lane *lane = slot->lane;
    enum libusb_transfer_status outcome = slot->libusb->status;
    slot->flying = false;
    lane->flying--;
    if (slot->transfer) slot->transfer->pieces--;
    if (outcome == LIBUSB_TRANSFER_COMPLETED) lane->failures = 0;
    if (outcome == LIBUSB_TRANSFER_NO_DEVICE) lane->usb->gone = true;
    if (!lane->in)
        sent(slot);
    else if (lane->copies)
        collected(slot);
    else
        received(slot);
    if (!is_fault(outcome)) return;
    break_lane(lane);
    lane->failures++;
}

void hp_usb_look(hp_usb *usb) {
    pthread_mutex_lock(&usb->lock);
    hp_usb_slot *slot = usb->landed;
    usb->landed = NULL;
    __atomic_store_n(&usb->arrived, 0, __ATOMIC_RELAXED);
    pthread_mutex_unlock(&usb->lock);
    while (slot) {
        hp_usb_slot *next = slot->next;
        look_at(slot);
        slot = next;
    }
    while (usb->into.copies && copy(&usb->into)) continue;
    mend(&usb->out);
    mend(&usb->into);
    if (usb->gone) hp_usb_end_all(&usb->out, HP_ERROR_DISCONNECTED);
    if (usb->gone && !(usb->into.copies && usb->into.flying)) /* what flies may still have bytes for them */
        hp_usb_end_all(&usb->into, HP_ERROR_DISCONNECTED);
    hp_usb_pump(&usb->out);
    hp_usb_pump(&usb->into);
}
