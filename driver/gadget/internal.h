/* The inside of the gadget: what its files share. */
#ifndef HITPIPE_GADGET_INTERNAL_H
#define HITPIPE_GADGET_INTERNAL_H

#include "gadget.h"
#include <hitpipe/packet.h>

/* ---- urbs, waiting for their endpoint ---- */

typedef enum hp_endpoint {
    HP_ENDPOINT_CONTROL,
    HP_ENDPOINT_OUT,
    HP_ENDPOINT_IN,
    HP_ENDPOINT_EVENT,
    HP_ENDPOINT_NONE, /* an address that the device does not have */
    HP_ENDPOINTS
} hp_endpoint;

typedef struct hp_urb_queue {
    hp_urb *first, *last;
} hp_urb_queue;

/* Which endpoint has this address, direction included. */
hp_endpoint hp_endpoint_at(unsigned address);

/* Takes the oldest urb from its queue and ends it. */
void hp_urb_finish(hp_gadget *gadget, hp_endpoint endpoint, hp_urb_status status, size_t moved);

/* ---- descriptors ---- */

enum {
    HP_DEVICE_BYTES = 18,
    HP_QUALIFIER_BYTES = 10,
    HP_HID_BYTES = 9,
    HP_HID_AT = 9 + 9 + 2 * (7 + 6) + 9, /* most bytes before the HID descriptor */
    HP_CONFIGURATION_ROOM = HP_HID_AT + HP_HID_BYTES + 7 + 6,
    HP_BOS_BYTES = 5 + 7 + 10,
    HP_REPORT_ROOM = 160,
    HP_STRING_ROOM = 2 + 2 * 40
};

typedef struct hp_descriptors {
    uint8_t device[HP_DEVICE_BYTES];
    uint8_t qualifier[HP_QUALIFIER_BYTES]; /* what the device is at the other speed; high speed only */
    uint8_t bos[HP_BOS_BYTES];             /* SuperSpeed only */
    uint8_t configuration[HP_CONFIGURATION_ROOM], other_speed[HP_CONFIGURATION_ROOM];
    uint8_t report[HP_REPORT_ROOM];
    size_t configuration_bytes, other_speed_bytes, report_bytes;
} hp_descriptors;

/* Makes all of them. */
hp_descriptors hp_descriptors_make(const hp_gadget_def *def);

/* Descriptor `index` of `type` as GET_DESCRIPTOR asks the device for it, in `room` bytes that hold any. Its bytes, or
 * 0: there is none. */
size_t hp_descriptor_find(const hp_gadget *gadget, unsigned type, unsigned index, uint8_t *room);

/* The same, asked of an interface: HID and report descriptor. */
size_t hp_interface_descriptor_find(const hp_gadget *gadget, unsigned interface, unsigned type, uint8_t *room);

/* ---- control endpoint ---- */

enum { HP_REPLY_ROOM = 256 }; /* bytes of any answer on it */
_Static_assert((int)HP_REPLY_ROOM >= (int)HP_REPORT_ROOM, "a report descriptor is an answer");

/* Carries out the oldest control urb. False: there is none. */
bool hp_control_run(hp_gadget *gadget);

/* ---- bulk endpoints ---- */

enum { HP_IN_PACKETS = 4 }; /* packets for the host that wait in the gadget before the board has to */

typedef struct hp_bulk_packet {
    uint8_t *bytes;
    size_t n, room;
} hp_bulk_packet;

typedef struct hp_bulk {
    /* OUT: the transfer that is coming in, or crosses the link to the board */
    uint8_t *out;
    size_t out_bytes;
    bool crossing;
    bool urb_waits; /* for the crossing to end: the oldest urb, whose bytes ended the transfer */
    /* IN: a ring of packets that the board has sent, and how much of the oldest one the host has */
    hp_bulk_packet in[HP_IN_PACKETS];
    unsigned in_head, in_count;
    size_t in_moved;
} hp_bulk;

/* HP_ERROR_MEMORY. */
hp_status hp_bulk_create(hp_bulk *bulk);
void hp_bulk_destroy(hp_bulk *bulk);

/* Each does what the oldest urb of its endpoint allows. False: nothing. */
bool hp_bulk_run_out(hp_gadget *gadget);
bool hp_bulk_run_in(hp_gadget *gadget);
/* Carries the board on by one event. False: it is idle, or there is no room for what it would send. */
bool hp_bulk_run_board(hp_gadget *gadget);

/* A transfer that is only half there is not gone on with. */
void hp_bulk_cut_out(hp_gadget *gadget);
void hp_bulk_cut_in(hp_gadget *gadget);
/* The board has dropped what was on its way to it; `all`: and what it had sent is dropped as well. */
void hp_bulk_drop(hp_gadget *gadget, bool all);

/* ---- HID ---- */

enum { HP_EVENTS = 64, HP_EVENT_BYTES = 1 + HP_USB_BYTES_EVENT };

typedef struct hp_reports {
    uint8_t control[HP_USB_BYTES_CONTROL]; /* the last command and its outcome */
    uint8_t events[HP_EVENTS][HP_EVENT_BYTES];
    unsigned head, count;         /* of those that nobody fetched */
    uint32_t number, lost;        /* events since power-up; of them lost */
    uint8_t last[HP_EVENT_BYTES]; /* the newest event, fetched or not */
    uint32_t resets;
} hp_reports;

/* Report `id` of a kind (1 input, 3 feature), its ID first. Its bytes, or 0: there is none. */
size_t hp_hid_get(hp_gadget *gadget, unsigned kind, unsigned id, uint8_t room[HP_REPLY_ROOM]);
/* The host sets a report, its ID first. False: there is none that can be set with so many bytes. */
bool hp_hid_set(hp_gadget *gadget, unsigned kind, unsigned id, const uint8_t *bytes, size_t n);

/* Something happened: for the event endpoint. */
void hp_event_add(hp_gadget *gadget, unsigned kind, hp_status status, uint32_t tag);
/* Everything that waits is lost. */
void hp_events_lose(hp_reports *reports);
/* Gives the oldest event to the oldest urb. False: nothing. */
bool hp_event_run(hp_gadget *gadget);

/* ---- the gadget ---- */

enum { HP_SERIAL_MOST = 12 };

struct hp_gadget {
    hp_board *board;
    char serial[HP_SERIAL_MOST + 1];
    hp_usb_speed speed;
    hp_descriptors descriptors;
    uint8_t address, configuration; /* 0: none */
    bool halted[HP_ENDPOINTS];
    hp_urb_queue queues[HP_ENDPOINTS];
    hp_bulk bulk;
    hp_reports reports;
};

/* The endpoint is there and not halted; otherwise its oldest urb, if any, ends with a stall and *stalled is set. */
bool hp_endpoint_works(hp_gadget *gadget, hp_endpoint endpoint, bool *stalled);

/* The board in reset, nothing on its way to or from it, and an event that says so. */
void hp_gadget_reset_board(hp_gadget *gadget);

/* wMaxPacketSize of the bulk endpoints. */
static inline size_t hp_bulk_packet_bytes(const hp_gadget *gadget) {
    return gadget->speed == HP_USB_SUPER ? HP_USB_SUPER_PACKET : HP_USB_HIGH_PACKET;
}

#endif
