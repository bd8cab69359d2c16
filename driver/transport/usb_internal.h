/* What the files of the USB transport share: usb.c (opening, closing, the vtable), usb_find.c (which board),
 * usb_bus.c (the context and its log), usb_lane.c (transfers of one direction, and mending it), usb_events.c
 * (waiting), usb_memory.c (buffers), usb_errors.c (what libusb says). */
#ifndef HITPIPE_TRANSPORT_USB_INTERNAL_H
#define HITPIPE_TRANSPORT_USB_INTERNAL_H

#include "usb.h"
#include <hitpipe/usb.h>
#include <libusb.h>
#include <pthread.h>

/* ---- usb_bus.c, usb_find.c, usb_errors.c ---- */

/* libusb, for as long as something of it is in use: a context of our own, or the user's. */
typedef struct hp_usb_bus {
    libusb_context *context;
    bool own;
} hp_usb_bus;

hp_status hp_usb_bus_open(const hp_device_def *def, hp_usb_bus *bus, hp_message *message);
void hp_usb_bus_close(hp_usb_bus *bus);

/* The data interface of a device, from its active configuration. */
typedef struct hp_usb_interface {
    uint8_t number, out, in; /* endpoint addresses */
    unsigned packet;         /* wMaxPacketSize of both */
} hp_usb_interface;

/* False: it has none, so it is no board. */
bool hp_usb_data_interface(libusb_device *device, hp_usb_interface *interface);

/* Opens the board with this serial number; NULL: the only board there is. HP_ERROR_NO_DEVICE in words: none, none of
 * that serial, several, no permission. */
hp_status hp_usb_open(const hp_usb_bus *bus, const hp_device_def *def, const char *serial,
                      libusb_device_handle **handle, hp_message *message);

/* A string of an open device, printable; "" when it has none or does not say. */
void hp_usb_text(libusb_device_handle *handle, uint8_t index, char text[HP_USB_TEXT]);

hp_status hp_usb_outcome(enum libusb_transfer_status outcome);

/* ---- the transport ---- */

/* Largest packet, and the buffer that takes it in one transfer: one USB packet more, so that the end of the largest
 * packet, which is a zero-length USB packet, still falls into it, and nothing overflows. */
enum { HP_USB_PACKET_MAX = 512 * 1024, HP_USB_ROOM_MAX = HP_USB_PACKET_MAX + HP_USB_SUPER_PACKET };

typedef struct hp_usb hp_usb;
typedef struct hp_usb_lane hp_usb_lane;
typedef struct hp_usb_slot hp_usb_slot;

typedef struct hp_usb_fifo {
    hp_transfer *first, *last;
} hp_usb_fifo;

/* One libusb transfer: a whole hp_transfer, a piece of one, or bytes that no hp_transfer has asked for yet. */
struct hp_usb_slot {
    hp_usb_lane *lane;
    struct libusb_transfer *libusb;
    hp_transfer *transfer; /* whose bytes they are; NULL: nobody's */
    uint8_t *buffer;       /* of its own, when the lane copies */
    uint64_t number;       /* of its submission: later ones have higher ones */
    bool flying;           /* from submit until it was looked at after its callback */
    hp_usb_slot *next;     /* in a list of landed ones */
};

/* One direction. */
struct hp_usb_lane {
    hp_usb *usb;
    uint8_t address;
    bool in;
    bool copies;       /* IN, transfers smaller than packets: into buffers of the slots, copied from there */
    unsigned piece;    /* most bytes of a libusb transfer */
    unsigned flying;   /* slots */
    hp_usb_fifo queue; /* submitted and not ended, in order */
    hp_usb_slot *held; /* copying: landed and not yet copied, in order */
    bool skip;         /* copying: what comes is the rest of a packet that nobody wants */
    uint64_t number;   /* of the next submission */
    bool broken;       /* all is called back, then mended, before anything goes out again */
    uint64_t mend_ms;  /* not before then */
    unsigned failures; /* since something went well */
    hp_usb_slot slots[HP_USB_DEPTH_MAX];
};

/* A buffer. */
typedef struct hp_usb_memory {
    uint8_t *bytes;
    size_t room;
    bool device; /* from libusb_dev_mem_alloc */
    struct hp_usb_memory *next;
} hp_usb_memory;

struct hp_usb {
    hp_transport head;
    hp_usb_bus bus;
    libusb_device_handle *handle;
    hp_usb_interface interface;
    char serial[HP_USB_TEXT];
    unsigned depth;
    hp_usb_lane out, into; /* to the board, to the host */
    hp_usb_fifo done;      /* ended: `done` is due */
    bool gone;             /* the board */
    hp_usb_memory *memory;
    size_t device_memory; /* bytes of it that the kernel gave */

    hp_wait *wait;
    void *wait_context;
    hp_wait_file *files; /* what libusb waits for, for `wait` */
    size_t file_count;
    bool files_stale;

    pthread_mutex_t lock; /* the callback may run on a thread of the user's: it touches nothing but these */
    hp_usb_slot *landed;  /* in order */
    int arrived;          /* something has landed */
};

uint64_t hp_usb_ms(void); /* monotonic */

/* ---- usb_lane.c ---- */

/* Makes the libusb transfers of a lane with interface and depth of usb. */
hp_status hp_usb_lane_open(hp_usb *usb, hp_usb_lane *lane, bool in, unsigned piece);
void hp_usb_lane_close(hp_usb_lane *lane);

void hp_usb_append(hp_usb_fifo *fifo, hp_transfer *transfer);
void hp_usb_cancel(hp_usb_lane *lane, hp_transfer *transfer);

/* Hands libusb what there is to hand over. */
void hp_usb_pump(hp_usb_lane *lane);

/* Looks at what has landed, mends what is broken if its time has come; ended transfers are then in usb->done. */
void hp_usb_look(hp_usb *usb);

/* Calls everything back from libusb, without waiting for it. */
void hp_usb_call_back(hp_usb_lane *lane);

/* Ends all that libusb does not hold. */
void hp_usb_end_all(hp_usb_lane *lane, hp_status status);

/* ---- usb_events.c, usb_memory.c ---- */

/* Waits until something has landed, or timeout_ms. HP_OK also when a signal came first; HP_ERROR_IO. */
hp_status hp_usb_wait(hp_usb *usb, unsigned timeout_ms);
void hp_usb_events_open(hp_usb *usb);
void hp_usb_events_close(hp_usb *usb);

uint8_t *hp_usb_allocate(hp_usb *usb, size_t bytes); /* NULL: no memory */
void hp_usb_free_all(hp_usb *usb);

#endif
