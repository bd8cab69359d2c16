/* A hostile host before the board's USB side. Input: actions, each a byte and what belongs to it:
 *
 *     0 control    setup (8 bytes), then as many bytes as wLength says, to a device
 *     1 OUT        flags, n (2 bytes), n bytes
 *     2 IN         room (2 bytes)
 *     3 event      room
 *     4 elsewhere  endpoint, room
 *     5 unlink     which of the pending urbs
 *     6 run        so many times
 *     7 reset
 *
 * Flags of OUT: bit 0: there is a zero-length packet behind it; bit 1: the bytes are made a whole packet, bit 2: with
 * the sequence number that the board expects; bit 3: no bytes follow here, the urb has any.
 *
 * Every urb must end once, with no more bytes than it has room for and nothing written behind them; what begins like
 * an answer and fits must be one; and the gadget must come to rest. */
#include "driver/gadget/gadget.h"
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

enum { URBS = 64, RUNS = 200000, CONTROL_MOST = 300, CANARY = 0xA5, WHOLE_ROOM = 60000 };
enum { ZERO_PACKET = 1, WHOLE = 2, EXPECTED = 4, ANY = 8 };

typedef struct urb {
    hp_urb urb;
    bool done;
    struct host *host;
} urb;

typedef struct host {
    hp_gadget *gadget;
    const uint8_t *data;
    size_t n;
    urb urbs[URBS];
    unsigned count, pending;
    uint32_t expected;
} host;

static void require(bool holds) {
    if (!holds) abort();
}

static unsigned next(host *h) {
    if (!h->n) return 0;
    h->n--;
    return *h->data++;
}

static unsigned next_two(host *h) {
    unsigned low = next(h);
    return low | next(h) << 8;
}

/* ---- urbs ---- */

static bool is_in(const hp_urb *u) {
    return (u->endpoint ? u->endpoint : u->setup[0]) & 0x80;
}

/* What a host makes of an IN urb that began with a packet. */
static void hear(host *h, const hp_urb *u) {
    hp_header header;
    const uint8_t *payload;
    if (u->moved < HP_HEADER_BYTES || hp_packet_open(u->bytes, u->moved, &header, &payload) != HP_OK) return;
    require(!hp_opcode_to_board(header.opcode));
    h->expected = header.sequence;
}

static void done(hp_urb *u) {
    urb *mine = u->owner;
    require(!mine->done && u->moved <= u->length);
    require(u->status <= HP_URB_CANCELLED);
    require((u->status != HP_URB_STALL && u->status != HP_URB_CANCELLED) || u->moved == 0);
    if (is_in(u)) require(u->bytes[u->moved] == CANARY && u->bytes[u->length] == CANARY);
    if (u->endpoint == 0x81 && u->status == HP_URB_OK) hear(mine->host, u);
    if (u->endpoint == 0x82 && u->status == HP_URB_OK) require(u->moved == 1 + HP_USB_BYTES_EVENT);
    mine->done = true;
    mine->host->pending--;
    free(u->bytes);
}

/* The bytes of an IN urb are canaries, so that what is written shows. */
static hp_urb *add(host *h, unsigned endpoint, size_t length) {
    urb *u = &h->urbs[h->count++];
    *u = (urb){.urb = {.endpoint = (uint8_t)endpoint, .length = length, .done = done, .owner = u}, .host = h};
    u->urb.bytes = malloc(length + 1);
    require(u->urb.bytes != NULL);
    memset(u->urb.bytes, CANARY, length + 1);
    h->pending++;
    return &u->urb;
}

static void take_bytes(host *h, uint8_t *to, size_t n) {
    size_t there = n < h->n ? n : h->n;
    memcpy(to, h->data, there);
    h->data += there;
    h->n -= there;
}

/* ---- actions ---- */

static void control(host *h) {
    uint8_t setup[8] = {0};
    take_bytes(h, setup, sizeof setup);
    size_t length = hp_get16(setup + 6);
    hp_urb *u = add(h, 0, length < CONTROL_MOST ? length : CONTROL_MOST);
    memcpy(u->setup, setup, sizeof setup);
    if (!is_in(u)) take_bytes(h, u->bytes, u->length);
    hp_gadget_submit(h->gadget, u);
}

static void seal(host *h, hp_urb *u, bool expected) {
    hp_header header = {.version = u->bytes[HP_AT_HEADER_version],
                        .opcode = u->bytes[HP_AT_HEADER_opcode],
                        .tag = hp_get32(u->bytes + HP_AT_HEADER_tag),
                        .length = (uint32_t)(u->length - HP_HEADER_BYTES - HP_CRC_BYTES),
                        .sequence = hp_get32(u->bytes + HP_AT_HEADER_sequence)};
    if (expected) header.sequence = header.opcode == HP_OPCODE_HELLO ? 0 : h->expected;
    if (header.length == 0) u->length = HP_HEADER_BYTES;
    hp_packet_seal(u->bytes, &header);
}

static void out(host *h) {
    unsigned flags = next(h);
    hp_urb *u = add(h, 0x01, next_two(h));
    if (!(flags & ANY)) take_bytes(h, u->bytes, u->length);
    u->zero_packet = flags & ZERO_PACKET;
    if (flags & WHOLE && u->length >= HP_HEADER_BYTES + HP_CRC_BYTES) seal(h, u, flags & EXPECTED);
    hp_gadget_submit(h->gadget, u);
}

static void unlink_one(host *h) {
    unsigned which = next(h);
    for (unsigned i = 0; i < h->count; i++)
        if (!h->urbs[i].done && which-- == 0) {
            hp_gadget_unlink(h->gadget, &h->urbs[i].urb);
            require(h->urbs[i].done);
            return;
        }
}

static void act(host *h) {
    unsigned endpoint;
    switch (next(h) % 8) {
    case 0:
        control(h);
        break;
    case 1:
        out(h);
        break;
    case 2:
        hp_gadget_submit(h->gadget, add(h, 0x81, next_two(h)));
        break;
    case 3:
        hp_gadget_submit(h->gadget, add(h, 0x82, next(h)));
        break;
    case 4:
        endpoint = next(h);
        hp_gadget_submit(h->gadget, add(h, endpoint ? endpoint : 1, next(h)));
        break;
    case 5:
        unlink_one(h);
        break;
    case 6:
        for (unsigned i = next(h); i > 0; i--) hp_gadget_run(h->gadget);
        break;
    default:
        hp_gadget_reset(h->gadget);
        require(h->pending == 0);
        break;
    }
}

static hp_gadget *plug_in(unsigned flags) {
    hp_gadget_def def = {.board = {.isa = "plain", .threads = 1}, .serial = "FUZZ"};
    hp_gadget *gadget;
    def.speed = flags & 1 ? HP_USB_HIGH : HP_USB_SUPER;
    def.board.engine = flags & 2 ? HP_ENGINE_CLOCKED : HP_ENGINE_QUICK;
    hp_config_preset(&def.board.config, "usb3");
    def.board.config.ddr_bytes = 36 * 20; /* so that no query is long */
    def.board.config.packet_primaries = 16;
    def.board.config.packet_results = 50;
    def.board.config.sram_records = 100;
    def.board.config.link_turnaround_ns = 0;
    def.board.config.packet_buffers = 4;
    require(hp_gadget_create(&def, &gadget) == HP_OK);
    return gadget;
}

/* Reads what is left, so that all that waits for a host is seen to come to an end. */
static void come_to_rest(host *h) {
    unsigned runs = 0;
    while (hp_gadget_run(h->gadget)) require(++runs < RUNS);
    for (unsigned i = 0; i < 8 && h->count < URBS; i++) {
        hp_gadget_submit(h->gadget, add(h, 0x81, WHOLE_ROOM));
        while (hp_gadget_run(h->gadget)) require(++runs < RUNS);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    static host h;
    if (n < 1) return 0;
    h = (host){.gadget = plug_in(data[0]), .data = data + 1, .n = n - 1};
    while (h.n && h.count < URBS - 8) act(&h);
    come_to_rest(&h);
    hp_gadget_destroy(h.gadget);
    require(h.pending == 0);
    return 0;
}
