/* A hostile client before the USB/IP server. Input: a byte of flags, then
 *
 *     flags bit 0 clear: the bytes of the connection, from its beginning
 *     flags bit 0 set:   messages behind an import, each a byte and what belongs to it:
 *         0 submit   endpoint, direction and flags, length (2 bytes), setup (8 bytes), and bytes to the device
 *         1 unlink   which of the numbers so far
 *         2 raw      a head of 48 bytes as it is
 *         3 listen   the client fetches its replies
 *
 * A submit with flag 0x80 has no bytes here: they are 0.
 *
 * with bit 1: bytes come one by one. Whatever comes, the client is ended or goes on: replies are whole and in order
 * of what they answer, no more is pending than the limits let be, and the board is free behind it. */
#include "driver/usbip/client.h"
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

enum { FRAMED = 1, BYTEWISE = 2, ZEROS = 0x80, RUNS = 200000, MESSAGES = 200, HEAD = HP_USBIP_URB_BYTES };

typedef struct connection {
    hp_usbip_client *client;
    const uint8_t *data;
    size_t n;
    bool bytewise;
    uint32_t seqnum;
    bool raw;                                      /* what was said is not known here: replies are not looked at */
    bool in[MESSAGES + 1], answered[MESSAGES + 1]; /* by number */
    uint32_t unlinks[MESSAGES + 1];                /* number of the urb */
    uint8_t head[HEAD];                            /* of the reply that is coming */
    size_t head_bytes, left;                       /* of it, and of the bytes behind it */
} connection;

static void require(bool holds) {
    if (!holds) abort();
}

static uint32_t big(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static void put(uint8_t *at, uint32_t number) {
    for (unsigned i = 0; i < 4; i++) at[i] = (uint8_t)(number >> (24 - 8 * i));
}

static unsigned next(connection *c) {
    if (!c->n) return 0;
    c->n--;
    return *c->data++;
}

/* ---- what is heard ---- */

static void check_head(connection *c) {
    uint32_t command = big(c->head), seqnum = big(c->head + 4), moved = big(c->head + 24);
    require(command == HP_RET_SUBMIT || command == HP_RET_UNLINK);
    require(seqnum >= 1 && seqnum <= c->seqnum && !c->answered[seqnum]);
    require(command == HP_RET_SUBMIT || moved == 0);
    c->answered[seqnum] = true;
    if (command == HP_RET_UNLINK && big(c->head + 20) != 0) { /* taken back: it has no reply of its own */
        uint32_t unlinked = c->unlinks[seqnum];
        require(unlinked >= 1 && unlinked < seqnum && !c->answered[unlinked]);
        c->answered[unlinked] = true;
    }
    c->left = c->in[seqnum] ? moved : 0;
}

static void hear(connection *c, const uint8_t *bytes, size_t n) {
    while (n) {
        size_t wanted = c->left ? c->left : HEAD - c->head_bytes, some = wanted < n ? wanted : n;
        if (c->left) {
            c->left -= some;
        } else {
            memcpy(c->head + c->head_bytes, bytes, some);
            c->head_bytes = (c->head_bytes + some) % HEAD;
            if (c->head_bytes == 0) check_head(c);
        }
        bytes += some;
        n -= some;
    }
}

static void run_board(connection *c) {
    unsigned runs = 0;
    while (hp_usbip_client_run(c->client)) require(++runs < RUNS);
}

static void listen(connection *c, bool urbs) {
    const uint8_t *from;
    bool more;
    size_t n;
    run_board(c);
    while ((n = hp_usbip_client_has(c->client, &from, &more))) {
        volatile uint8_t touched = from[n - 1]; /* all of it is there */
        (void)touched;
        if (urbs) hear(c, from, n);
        hp_usbip_client_sent(c->client, n);
    }
}

/* ---- what is said ---- */

/* False: the client is not listened to any more. */
static bool say(connection *c, const uint8_t *bytes, size_t n) {
    while (n) {
        uint8_t *to;
        size_t wanted = hp_usbip_client_wants(c->client, &to), some = c->bytewise || wanted < 2 ? 1 : wanted;
        if (!wanted && hp_usbip_client_fault(c->client)) return false;
        if (!wanted) {
            listen(c, !c->raw);
            require(hp_usbip_client_fault(c->client) || hp_usbip_client_wants(c->client, &to));
            continue;
        }
        if (some > n) some = n;
        memcpy(to, bytes, some);
        hp_usbip_client_got(c->client, some);
        bytes += some;
        n -= some;
    }
    return true;
}

static void import(connection *c) {
    uint8_t request[HP_USBIP_IMPORT_BYTES] = {0x01, 0x11, 0x80, 0x03, [8] = '1', '-', '1'};
    require(say(c, request, sizeof request));
    listen(c, false);
    require(hp_usbip_client_board(c->client) != NULL);
}

static bool submit(connection *c, uint8_t *head) {
    unsigned endpoint = next(c), how = next(c);
    uint32_t length = next(c);
    length |= next(c) << 8;
    put(head, HP_CMD_SUBMIT);
    put(head + 12, how & 1);
    put(head + 16, endpoint & 15);
    put(head + 20, how & 0xFE);
    put(head + 24, length);
    c->in[c->seqnum] = how & 1;
    for (unsigned i = 0; i < 8; i++) head[40 + i] = (uint8_t)next(c);
    if (!say(c, head, HEAD) || how & 1 || hp_usbip_client_fault(c->client)) return !hp_usbip_client_fault(c->client);
    size_t there = how & ZEROS ? 0 : length < c->n ? length : c->n;
    if (!say(c, c->data, there)) return false;
    c->data += there;
    c->n -= there;
    static const uint8_t zeros[65536];
    return say(c, zeros, length - there);
}

static bool say_message(connection *c) {
    uint8_t head[HEAD] = {0};
    unsigned kind = next(c) % 4;
    if (kind == 3) {
        listen(c, !c->raw);
        return true;
    }
    put(head + 4, ++c->seqnum);
    put(head + 8, 1 << 16 | 2);
    if (kind == 0) return submit(c, head);
    put(head, HP_CMD_UNLINK);
    c->unlinks[c->seqnum] = next(c);
    put(head + 20, c->unlinks[c->seqnum]);
    if (kind == 2) {
        c->raw = true;
        for (unsigned i = 0; i < HEAD; i++) head[i] = (uint8_t)next(c);
    }
    return say(c, head, HEAD);
}

/* ---- one client ---- */

static hp_gadget *plug_in(void) {
    hp_gadget_def def = {.board = {.isa = "plain", .threads = 1}, .serial = "FUZZ", .speed = HP_USB_SUPER};
    hp_gadget *gadget;
    hp_config_preset(&def.board.config, "usb3");
    def.board.config.ddr_bytes = 36 * 20; /* so that no query is long */
    def.board.config.packet_primaries = 16;
    def.board.config.packet_results = 50;
    def.board.config.sram_records = 100;
    require(hp_gadget_create(&def, &gadget) == HP_OK);
    return gadget;
}

static void connect_once(hp_usbip_export *board, const hp_usbip_limits *limits, const uint8_t *data, size_t n) {
    connection c = {.client = hp_usbip_client_create(board, 1, limits), .data = data + 1, .n = n - 1};
    require(c.client != NULL);
    c.bytewise = data[0] & BYTEWISE;
    if (data[0] & FRAMED) {
        import(&c);
        while (c.n && c.seqnum < MESSAGES && say_message(&c)) {
        }
    } else {
        c.raw = true;
        say(&c, c.data, c.n);
    }
    listen(&c, !c.raw);
    hp_usbip_client_destroy(c.client);
    require(board->user == NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    static const hp_usbip_limits limits = {.urb_bytes = 16384, .urbs = 32, .bytes = 100000};
    hp_usbip_export board = {.place = {"1-1", 1, 2}};
    if (n < 1) return 0;
    board.gadget = plug_in();
    connect_once(&board, &limits, data, n);
    const uint8_t list[9] = {0, 0x01, 0x11, 0x80, 0x05};
    connect_once(&board, &limits, list, sizeof list); /* the next client finds a server */
    hp_gadget_destroy(board.gadget);
    return 0;
}
