/* The bulk endpoints: packets of packets.def, one a transfer, which a short or zero-length USB packet ends. */
#include "internal.h"
#include <stdlib.h>
#include <string.h>

/* A transfer that is longer than any packet keeps one byte more than that: the board refuses it for its length. */
enum { OUT_ROOM = 512 * 1024 + 1 };
_Static_assert(OUT_ROOM == HP_HEADER_BYTES + HP_PAYLOAD_MAX + HP_CRC_BYTES + 1, "one byte more than a packet");

hp_status hp_bulk_create(hp_bulk *bulk) {
    bulk->out = malloc(OUT_ROOM);
    return bulk->out ? HP_OK : HP_ERROR_MEMORY;
}

void hp_bulk_destroy(hp_bulk *bulk) {
    for (unsigned i = 0; i < HP_IN_PACKETS; i++) free(bulk->in[i].bytes);
    free(bulk->out);
}

/* ---- to the board ---- */

static void take_bytes(hp_bulk *bulk, const hp_urb *urb) {
    size_t room = OUT_ROOM - bulk->out_bytes, n = urb->length < room ? urb->length : room;
    if (n) memcpy(bulk->out + bulk->out_bytes, urb->bytes, n);
    bulk->out_bytes += n;
}

/* Whether the urb's last USB packet is shorter than wMaxPacketSize. */
static bool ends_transfer(const hp_gadget *gadget, const hp_urb *urb) {
    return urb->length == 0 || urb->length % hp_bulk_packet_bytes(gadget) || urb->zero_packet;
}

/* The oldest urb is done when all its bytes are: at once, or when the transfer that it ends has crossed to the board.
 * Out of memory, the packet is lost like any other may be. */
bool hp_bulk_run_out(hp_gadget *gadget) {
    hp_bulk *bulk = &gadget->bulk;
    hp_urb *urb = gadget->queues[HP_ENDPOINT_OUT].first;
    bool stalled;
    if (!urb || bulk->crossing) return false;
    if (!hp_endpoint_works(gadget, HP_ENDPOINT_OUT, &stalled)) return stalled;
    take_bytes(bulk, urb);
    if (ends_transfer(gadget, urb)) {
        bulk->crossing = bulk->urb_waits = hp_board_send(gadget->board, bulk->out, bulk->out_bytes) == HP_OK;
        if (!bulk->crossing) bulk->out_bytes = 0;
    }
    if (!bulk->crossing) hp_urb_finish(gadget, HP_ENDPOINT_OUT, HP_URB_OK, urb->length);
    return true;
}

static void crossed(hp_gadget *gadget) {
    hp_bulk *bulk = &gadget->bulk;
    bool waits = bulk->urb_waits;
    bulk->crossing = bulk->urb_waits = false;
    bulk->out_bytes = 0;
    if (waits) hp_urb_finish(gadget, HP_ENDPOINT_OUT, HP_URB_OK, gadget->queues[HP_ENDPOINT_OUT].first->length);
}

void hp_bulk_cut_out(hp_gadget *gadget) {
    if (!gadget->bulk.crossing) gadget->bulk.out_bytes = 0;
}

/* ---- from the board ---- */

static void pop(hp_bulk *bulk) {
    bulk->in_head = (bulk->in_head + 1) % HP_IN_PACKETS;
    bulk->in_count--;
    bulk->in_moved = 0;
}

static bool push(hp_bulk *bulk, const uint8_t *bytes, size_t n) {
    hp_bulk_packet *packet = &bulk->in[(bulk->in_head + bulk->in_count) % HP_IN_PACKETS];
    if (n > packet->room) {
        uint8_t *wider = realloc(packet->bytes, n);
        if (!wider) return false;
        packet->bytes = wider;
        packet->room = n;
    }
    memcpy(packet->bytes, bytes, n);
    packet->n = n;
    bulk->in_count++;
    return true;
}

/* USB packets go out while the urb has room for them. One that it has no room for is not acknowledged and stays.
 * Behind a last packet of full size comes one of none, in this urb or in the next. */
bool hp_bulk_run_in(hp_gadget *gadget) {
    hp_bulk *bulk = &gadget->bulk;
    hp_urb *urb = gadget->queues[HP_ENDPOINT_IN].first;
    bool stalled;
    if (!urb) return false;
    if (!hp_endpoint_works(gadget, HP_ENDPOINT_IN, &stalled)) return stalled;
    if (!bulk->in_count) return false;
    size_t size = hp_bulk_packet_bytes(gadget);
    const hp_bulk_packet *packet = &bulk->in[bulk->in_head];
    size_t left = packet->n - bulk->in_moved, moved = left;
    if (left > urb->length) moved = urb->length - urb->length % size;
    bool overflow = left > urb->length && (urb->length % size || urb->length == 0);
    bool ended = left <= urb->length && (packet->n % size || left == 0 || left < urb->length);
    if (moved) memcpy(urb->bytes, packet->bytes + bulk->in_moved, moved);
    bulk->in_moved += moved;
    if (ended) pop(bulk);
    hp_urb_finish(gadget, HP_ENDPOINT_IN, overflow ? HP_URB_OVERFLOW : HP_URB_OK, moved);
    return true;
}

void hp_bulk_cut_in(hp_gadget *gadget) {
    if (gadget->bulk.in_moved) pop(&gadget->bulk);
}

/* ---- the board ---- */

/* An event for each answered packet: its last answer is in the gadget. */
static void tell(hp_gadget *gadget, const uint8_t *packet) {
    uint32_t tag = hp_get32(packet + HP_AT_HEADER_tag);
    hp_status status = (hp_status)hp_get16(packet + HP_AT_HEADER_status);
    if (packet[HP_AT_HEADER_opcode] == HP_OPCODE_ERROR)
        hp_event_add(gadget, HP_USB_EVENT_PACKET_ERROR, status, tag);
    else if (hp_get16(packet + HP_AT_HEADER_flags) & HP_FLAG_LAST)
        hp_event_add(gadget, HP_USB_EVENT_PACKET_DONE, status, tag);
}

bool hp_bulk_run_board(hp_gadget *gadget) {
    if (gadget->bulk.in_count == HP_IN_PACKETS) return false;
    hp_board_event event = hp_board_step(gadget->board);
    if (event.kind == HP_BOARD_IDLE) return false;
    if (event.kind == HP_BOARD_RECEIVED) {
        crossed(gadget);
    } else if (push(&gadget->bulk, event.bytes, event.n)) {
        tell(gadget, event.bytes);
    }
    return true;
}

void hp_bulk_drop(hp_gadget *gadget, bool all) {
    hp_bulk *bulk = &gadget->bulk;
    if (all) {
        bulk->in_count = 0;
        bulk->in_moved = 0;
    }
    crossed(gadget);
}
