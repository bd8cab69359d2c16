#include "cable.h"
#include <errno.h>
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

enum { PACKET_MOST = 512 * 1024, FETCHES = 2, ARRIVED_MOST = 4, IN = 0x80, HALT_OUT = 0, HALT_IN = 1 };

/* A packet on its way. */
typedef struct wire wire;
struct wire {
    wire *next;
    hpt_cable *cable;
    hp_urb urb;    /* OUT: to the gadget */
    hpt_urb *host; /* OUT: ends when the gadget has it; NULL: nobody waits */
    bool zero;     /* IN: a zero-length USB packet ends it */
    size_t at, n;  /* IN: of its bytes the host has had so many */
    uint8_t bytes[];
};

typedef struct urbs {
    hpt_urb *first, *last;
} urbs;

/* An urb of the cable's own that waits for the board's packets. */
typedef struct fetch {
    hp_urb urb;
    bool busy;
    hpt_cable *cable;
    uint8_t bytes[PACKET_MOST + HP_USB_SUPER_PACKET];
} fetch;

struct hpt_cable {
    hp_gadget *gadget;
    hpt_choose *choose;
    void (*pulled)(void *context, unsigned back_ms);
    void *context;
    size_t packet; /* wMaxPacketSize */
    unsigned number[2];
    bool halted[2];
    bool out_of_socket; /* nothing passes any more */
    bool reset_due;     /* somebody resets the board */
    bool refused;       /* the board is not configured: no use in asking it again at once */
    urbs in;            /* of the host, waiting for bytes */
    urbs stuck;         /* never end */
    uint8_t *out;       /* the packet that the host is sending */
    size_t out_n;
    wire *outs;    /* in the gadget */
    wire *arrived; /* for the host, in order */
    wire *swapped[2];
    fetch *fetches;
};

/* ---- lists ---- */

static void append(urbs *list, hpt_urb *urb) {
    urb->next = NULL;
    if (list->first)
        list->last->next = urb;
    else
        list->first = urb;
    list->last = urb;
}

static bool take(urbs *list, const hpt_urb *urb) {
    hpt_urb *before = NULL;
    for (hpt_urb *at = list->first; at; before = at, at = at->next) {
        if (at != urb) continue;
        if (before)
            before->next = at->next;
        else
            list->first = at->next;
        if (list->last == at) list->last = before;
        return true;
    }
    return false;
}

static void end(hpt_urb *urb, int error) {
    urb->error = error;
    urb->done(urb);
}

static void end_all(urbs *list, int error) {
    for (hpt_urb *urb; (urb = list->first);) {
        take(list, urb);
        end(urb, error);
    }
}

static void put_last(wire **list, wire *packet) {
    while (*list) list = &(*list)->next;
    packet->next = NULL;
    *list = packet;
}

static void drop_first(wire **list) {
    wire *packet = *list;
    *list = packet->next;
    free(packet);
}

static wire *new_wire(hpt_cable *cable, const uint8_t *bytes, size_t n, size_t room) {
    wire *packet = calloc(1, sizeof *packet + (room > n ? room : n));
    if (!packet) abort();
    packet->cable = cable;
    packet->n = n;
    packet->zero = n % cable->packet == 0;
    if (n) memcpy(packet->bytes, bytes, n);
    return packet;
}

/* ---- what every urb knows ---- */

static int error_of(const hpt_cable *cable, const hp_urb *urb) {
    if (cable->out_of_socket) return -ESHUTDOWN;
    switch (urb->status) {
    case HP_URB_OK:
        return 0;
    case HP_URB_STALL:
        return -EPIPE;
    case HP_URB_OVERFLOW:
        return -EOVERFLOW;
    case HP_URB_CANCELLED:
        return -ENOENT;
    default:
        return -EPROTO;
    }
}

static void straight_done(hp_urb *urb) {
    hpt_urb *host = urb->owner;
    end(host, error_of(host->cable, urb));
}

/* ---- to the board ---- */

static void out_done(hp_urb *urb) {
    wire *packet = urb->owner;
    hpt_urb *host = packet->host;
    wire **at = &packet->cable->outs;
    while (*at != packet) at = &(*at)->next;
    *at = packet->next;
    if (host) {
        host->urb.moved = urb->status == HP_URB_OK ? host->urb.length : 0;
        end(host, error_of(packet->cable, urb));
    }
    free(packet);
}

static void send(hpt_cable *cable, wire *packet) {
    packet->urb = (hp_urb){.endpoint = HP_USB_OUT_ENDPOINT,
                           .bytes = packet->bytes,
                           .length = packet->n,
                           .zero_packet = packet->zero,
                           .done = out_done,
                           .owner = packet};
    put_last(&cable->outs, packet);
    hp_gadget_submit(cable->gadget, &packet->urb);
}

/* ---- to the host ---- */

/* Gives the oldest urb of the host as much of the oldest packet as it takes. False: there is none of the one or the
 * other. */
static bool deal(hpt_cable *cable) {
    hpt_urb *host = cable->in.first;
    wire *packet = cable->arrived;
    if (!host || !packet) return false;
    size_t left = packet->n - packet->at, room = host->urb.length - host->urb.moved, n = left < room ? left : room;
    if (n) memcpy(host->urb.bytes + host->urb.moved, packet->bytes + packet->at, n);
    packet->at += n;
    host->urb.moved += n;
    bool full = host->urb.moved == host->urb.length, whole = packet->at == packet->n;
    bool ends = whole && (packet->n % cable->packet || (packet->zero && !(full && n)));
    if (ends || (whole && !packet->zero)) drop_first(&cable->arrived);
    if (ends || full) {
        take(&cable->in, host);
        end(host, 0);
    }
    return true;
}

static void fail_in(hpt_cable *cable, int error) {
    hpt_urb *host = cable->in.first;
    if (!host) return;
    take(&cable->in, host);
    end(host, error);
}

/* ---- faults ---- */

static void soft_reset(hpt_cable *cable) {
    uint8_t report[1 + HP_USB_BYTES_CONTROL] = {HP_USB_REPORT_CONTROL, HP_USB_CONTROL_RESET};
    const uint8_t setup[8] = {0x21, 9, HP_USB_REPORT_CONTROL, 3, HP_USB_HID_INTERFACE, 0, sizeof report, 0};
    if (hpt_cable_control(cable, setup, report, sizeof report) < 0) abort();
    while (cable->arrived) drop_first(&cable->arrived);
    cable->reset_due = false;
}

static void halt(hpt_cable *cable, bool in) {
    cable->halted[in] = true;
    if (in) end_all(&cable->in, -EPIPE);
}

/* The board's answer becomes that of one with another protocol alone. */
static void make_newer(wire *packet, unsigned version) {
    hp_header header;
    const uint8_t *payload;
    if (hp_packet_open(packet->bytes, packet->n, &header, &payload) || header.length < HP_ERROR_FIXED) return;
    header.version = (uint8_t)version;
    header.opcode = HP_OPCODE_ERROR;
    header.status = HP_ERROR_VERSION;
    header.length = HP_ERROR_FIXED;
    hp_put32(packet->bytes + HP_HEADER_BYTES + HP_AT_ERROR_detail, version);
    packet->n = hp_packet_seal(packet->bytes, &header);
    packet->zero = false;
}

/* What is done to a packet itself. False: it is gone. */
static bool change(hpt_cable *cable, hpt_fault fault, wire *packet) {
    switch (fault.kind) {
    case HPT_FAULT_DROP:
    case HPT_FAULT_HANG:
    case HPT_FAULT_OVERFLOW:
        return false;
    case HPT_FAULT_STALL:
        return fault.argument == 0;
    case HPT_FAULT_PROTO:
        return fault.argument == 1;
    case HPT_FAULT_FLIP:
        packet->bytes[fault.argument / 8 % packet->n] ^= (uint8_t)(1 << fault.argument % 8);
        return true;
    case HPT_FAULT_SHORT:
        packet->n = fault.argument < packet->n ? packet->n - fault.argument : 1;
        packet->zero = packet->n % cable->packet == 0;
        return true;
    case HPT_FAULT_GROW:
        if (packet->n < fault.argument) packet->n = fault.argument;
        packet->zero = packet->n % cable->packet == 0;
        return true;
    case HPT_FAULT_NO_ZERO:
        packet->zero = false;
        return true;
    case HPT_FAULT_NEWER:
        make_newer(packet, fault.argument);
        return true;
    default:
        return true;
    }
}

/* Passes a packet on, and with it one that was to come behind it. */
static void pass_on(hpt_cable *cable, wire *packet, bool in) {
    wire *behind = cable->swapped[in];
    cable->swapped[in] = NULL;
    if (in)
        put_last(&cable->arrived, packet);
    else
        send(cable, packet);
    if (!behind) return;
    if (in)
        put_last(&cable->arrived, behind);
    else
        send(cable, behind);
}

/* How the host's urb fares that brought the packet's end; 0: like the packet; 1: it never ends. */
static int host_error(hpt_fault fault) {
    switch (fault.kind) {
    case HPT_FAULT_STALL:
        return -EPIPE;
    case HPT_FAULT_PROTO:
        return -EPROTO;
    case HPT_FAULT_HANG:
        return 1;
    default:
        return 0;
    }
}

static void finish_host(hpt_cable *cable, hpt_urb *host, int error) {
    if (error > 0) {
        append(&cable->stuck, host);
        return;
    }
    host->urb.moved = error ? 0 : host->urb.length;
    end(host, error);
}

static void common_faults(hpt_cable *cable, hpt_fault fault, bool in) {
    if (fault.kind == HPT_FAULT_STALL) halt(cable, in);
    if (fault.kind == HPT_FAULT_RESET) cable->reset_due = true;
    if (fault.kind != HPT_FAULT_UNPLUG) return;
    cable->out_of_socket = true;
    cable->pulled(cable->context, fault.argument);
}

static bool to_host_alone(hpt_fault_kind kind) {
    return kind == HPT_FAULT_OVERFLOW || kind == HPT_FAULT_GROW || kind == HPT_FAULT_NEWER;
}

static void pass_out(hpt_cable *cable, hpt_urb *host) {
    hpt_fault fault = cable->choose(cable->context, false, cable->number[0]++, cable->out, cable->out_n);
    if (to_host_alone(fault.kind)) fault.kind = HPT_FAULT_NONE;
    wire *packet = new_wire(cable, cable->out, cable->out_n, 0);
    int error = host_error(fault);
    cable->out_n = 0;
    bool passes = change(cable, fault, packet) && fault.kind != HPT_FAULT_UNPLUG && fault.kind != HPT_FAULT_STALL;
    if (passes && !error && fault.kind != HPT_FAULT_SWAP) {
        packet->host = host;
        host = NULL;
    }
    common_faults(cable, fault, false);
    if (fault.kind == HPT_FAULT_DUPLICATE) pass_on(cable, new_wire(cable, packet->bytes, packet->n, 0), false);
    if (!passes)
        free(packet);
    else if (fault.kind == HPT_FAULT_SWAP && !cable->swapped[0])
        cable->swapped[0] = packet;
    else
        pass_on(cable, packet, false);
    if (host) finish_host(cable, host, error);
}

static void pass_in(hpt_cable *cable, const uint8_t *bytes, size_t n) {
    hpt_fault fault = cable->choose(cable->context, true, cable->number[1]++, bytes, n);
    wire *packet = new_wire(cable, bytes, n, fault.kind == HPT_FAULT_GROW ? fault.argument : 0);
    bool passes = change(cable, fault, packet) && fault.kind != HPT_FAULT_UNPLUG;
    int error = fault.kind == HPT_FAULT_OVERFLOW ? -EOVERFLOW : host_error(fault);
    hpt_urb *host = cable->in.first;
    common_faults(cable, fault, true);
    if (error > 0 && host) {
        take(&cable->in, host);
        append(&cable->stuck, host);
    } else if (error < 0) {
        fail_in(cable, error);
    }
    if (fault.kind == HPT_FAULT_DUPLICATE) pass_on(cable, new_wire(cable, packet->bytes, packet->n, 0), true);
    if (!passes)
        free(packet);
    else if (fault.kind == HPT_FAULT_SWAP && !cable->swapped[1])
        cable->swapped[1] = packet;
    else
        pass_on(cable, packet, true);
}

/* ---- the board's packets ---- */

static void fetched(hp_urb *urb) {
    fetch *now = urb->owner;
    now->busy = false;
    if (urb->status == HP_URB_STALL) now->cable->refused = true;
    if (urb->status == HP_URB_OK && !now->cable->out_of_socket) pass_in(now->cable, now->bytes, urb->moved);
}

static unsigned count(const wire *list) {
    unsigned n = 0;
    for (; list; list = list->next) n++;
    return n;
}

static bool fetch_more(hpt_cable *cable) {
    bool any = false;
    for (unsigned i = 0; i < FETCHES && cable->choose && count(cable->arrived) < ARRIVED_MOST; i++) {
        fetch *now = &cable->fetches[i];
        if (now->busy || cable->halted[HALT_IN] || cable->refused) continue;
        now->busy = any = true;
        now->cable = cable;
        now->urb = (hp_urb){.endpoint = HP_USB_IN_ENDPOINT,
                            .bytes = now->bytes,
                            .length = sizeof now->bytes,
                            .done = fetched,
                            .owner = now};
        hp_gadget_submit(cable->gadget, &now->urb);
    }
    return any;
}

bool hpt_cable_holds(const hpt_cable *cable) {
    return cable->swapped[0] || cable->swapped[1];
}

void hpt_cable_release(hpt_cable *cable) {
    for (unsigned in = 0; in < 2; in++) {
        wire *packet = cable->swapped[in];
        cable->swapped[in] = NULL;
        if (packet) pass_on(cable, packet, in);
    }
}

/* ---- the host's side ---- */

static void submit_straight(hpt_cable *cable, hpt_urb *urb) {
    urb->straight = true;
    urb->cable = cable;
    urb->urb.done = straight_done;
    urb->urb.owner = urb;
    hp_gadget_submit(cable->gadget, &urb->urb);
}

static void submit_out(hpt_cable *cable, hpt_urb *urb) {
    if (cable->halted[HALT_OUT]) {
        end(urb, -EPIPE);
        return;
    }
    size_t n = urb->urb.length, room = PACKET_MOST + 1 - cable->out_n;
    if (n > room) n = room;
    if (n) memcpy(cable->out + cable->out_n, urb->urb.bytes, n);
    cable->out_n += n;
    bool ends = urb->urb.length % cable->packet || urb->urb.length == 0 || urb->urb.zero_packet;
    if (ends) {
        pass_out(cable, urb);
        return;
    }
    urb->urb.moved = urb->urb.length;
    end(urb, 0);
}

void hpt_cable_submit(hpt_cable *cable, hpt_urb *urb) {
    urb->urb.moved = 0;
    urb->straight = false;
    bool in = urb->urb.endpoint == HP_USB_IN_ENDPOINT, out = urb->urb.endpoint == HP_USB_OUT_ENDPOINT;
    if (cable->out_of_socket)
        append(&cable->stuck, urb); /* until hpt_cable_pull */
    else if (!cable->choose || !(in || out))
        submit_straight(cable, urb);
    else if (out)
        submit_out(cable, urb);
    else if (cable->halted[HALT_IN])
        end(urb, -EPIPE);
    else
        append(&cable->in, urb);
}

void hpt_cable_unlink(hpt_cable *cable, hpt_urb *urb) {
    if (urb->straight) {
        hp_gadget_unlink(cable->gadget, &urb->urb);
        return;
    }
    if (take(&cable->in, urb) || take(&cable->stuck, urb)) {
        end(urb, -ENOENT);
        return;
    }
    for (wire *at = cable->outs; at; at = at->next) {
        if (at->host != urb) continue;
        hp_gadget_unlink(cable->gadget, &at->urb);
        return;
    }
}

void hpt_cable_run(hpt_cable *cable) {
    cable->refused = false;
    for (bool any = true; any && !cable->out_of_socket;) {
        if (cable->reset_due) soft_reset(cable);
        any = fetch_more(cable);
        while (deal(cable)) any = true;
        while (hp_gadget_run(cable->gadget)) any = true;
        any |= cable->reset_due;
    }
}

static void control_done(hp_urb *urb) {
    *(bool *)urb->owner = true;
}

int hpt_cable_control(hpt_cable *cable, const uint8_t setup[8], uint8_t *bytes, size_t length) {
    bool done = false;
    hp_urb urb = {.bytes = bytes, .length = length, .done = control_done, .owner = &done};
    memcpy(urb.setup, setup, 8);
    hp_gadget_submit(cable->gadget, &urb);
    while (!done && hp_gadget_run(cable->gadget)) continue;
    if (!done) hp_gadget_unlink(cable->gadget, &urb);
    return urb.status == HP_URB_OK ? (int)urb.moved : -EPIPE;
}

int hpt_cable_clear_halt(hpt_cable *cable, uint8_t endpoint) {
    const uint8_t setup[8] = {0x02, 1, 0, 0, endpoint, 0, 0, 0};
    bool in = endpoint == HP_USB_IN_ENDPOINT, out = endpoint == HP_USB_OUT_ENDPOINT;
    if (in) cable->halted[HALT_IN] = false;
    if (out) cable->halted[HALT_OUT] = false;
    if (out) cable->out_n = 0;
    if (in && cable->arrived && cable->arrived->at) drop_first(&cable->arrived);
    return hpt_cable_control(cable, setup, NULL, 0) < 0 ? -EPIPE : 0;
}

void hpt_cable_flush(hpt_cable *cable) {
    cable->out_n = 0;
    cable->halted[0] = cable->halted[1] = false;
    while (cable->arrived) drop_first(&cable->arrived);
    for (unsigned in = 0; in < 2; in++) {
        free(cable->swapped[in]);
        cable->swapped[in] = NULL;
    }
}

/* The gadget gives back what it has, when it is reset. */
void hpt_cable_pull(hpt_cable *cable) {
    cable->out_of_socket = true;
    end_all(&cable->in, -ESHUTDOWN);
    end_all(&cable->stuck, -ESHUTDOWN);
    hp_gadget_reset(cable->gadget);
    hpt_cable_flush(cable);
}

void hpt_cable_push(hpt_cable *cable) {
    cable->out_of_socket = false;
}

hpt_cable *hpt_cable_new(hp_gadget *gadget, hpt_choose *choose, void (*pulled)(void *context, unsigned back_ms),
                         void *context) {
    hpt_cable *cable = calloc(1, sizeof *cable);
    if (!cable) abort();
    cable->gadget = gadget;
    cable->choose = choose;
    cable->pulled = pulled;
    cable->context = context;
    cable->packet = hp_gadget_speed(gadget) == HP_USB_SUPER ? HP_USB_SUPER_PACKET : HP_USB_HIGH_PACKET;
    cable->out = malloc(PACKET_MOST + 1);
    cable->fetches = calloc(FETCHES, sizeof *cable->fetches);
    if (!cable->out || !cable->fetches) abort();
    return cable;
}

void hpt_cable_free(hpt_cable *cable) {
    hpt_cable_pull(cable);
    free(cable->out);
    free(cable->fetches);
    free(cable);
}

unsigned hpt_cable_packets(const hpt_cable *cable, bool in) {
    return cable->number[in];
}
