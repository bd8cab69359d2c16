/* Hostile transfers into the board. Input: transfers of the form
 *
 *     flags (1 byte), n (2 bytes), n bytes
 *
 * with flag bit 0: made a whole packet (magic, length, CRCs); bit 1: given the sequence number that the board
 * expects; bit 2: sent without waiting for the answers to those before. So that both the checks and what lies behind
 * them are reached. The board must neither crash nor hang, must answer every packet, and what it sends must be whole
 * packets. */
#include <hitpipe/board.h>
#include <hitpipe/packet.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

enum { WHOLE = 1, EXPECTED = 2, NO_WAIT = 4, TRANSFERS = 32, STEPS = 200000 };

typedef struct session {
    hp_board *board;
    uint32_t expected;
    unsigned sent, finals; /* transfers, and last answers */
    uint8_t *transfer[TRANSFERS + 1];
} session;

static void require(bool holds) {
    if (!holds) abort();
}

static void hear(session *s, const uint8_t *bytes, size_t n) {
    hp_header header;
    const uint8_t *payload;
    require(hp_packet_open(bytes, n, &header, &payload) == HP_OK);
    require(!hp_opcode_to_board(header.opcode) && header.length >= hp_opcode_fixed(header.opcode));
    require((header.status != HP_OK) == (header.opcode == HP_OPCODE_ERROR));
    require(hp_status_name((hp_status)header.status) != NULL);
    s->expected = header.sequence;
    s->finals += header.flags & HP_FLAG_LAST;
}

static void run(session *s) {
    for (unsigned steps = 0;; steps++) {
        hp_board_event event = hp_board_step(s->board);
        require(steps < STEPS);
        if (event.kind == HP_BOARD_IDLE) break;
        if (event.kind == HP_BOARD_SENT) hear(s, event.bytes, event.n);
    }
    require(s->finals == s->sent);
}

static void send(session *s, uint8_t flags, const uint8_t *bytes, size_t n) {
    uint8_t *packet = calloc(1, n + HP_HEADER_BYTES + HP_CRC_BYTES);
    require(packet != NULL);
    memcpy(packet, bytes, n);
    if (flags & WHOLE) {
        size_t length = n > HP_HEADER_BYTES ? n - HP_HEADER_BYTES : 0;
        hp_header header = {.version = packet[HP_AT_HEADER_version],
                            .opcode = packet[HP_AT_HEADER_opcode],
                            .flags = hp_get16(packet + HP_AT_HEADER_flags),
                            .tag = hp_get32(packet + HP_AT_HEADER_tag),
                            .length = (uint32_t)length,
                            .sequence = hp_get32(packet + HP_AT_HEADER_sequence),
                            .limit = hp_get32(packet + HP_AT_HEADER_limit),
                            .status = hp_get16(packet + HP_AT_HEADER_status)};
        if (flags & EXPECTED) header.sequence = header.opcode == HP_OPCODE_HELLO ? 0 : s->expected;
        n = hp_packet_seal(packet, &header);
    }
    s->transfer[s->sent++] = packet;
    require(hp_board_send(s->board, packet, n) == HP_OK);
    if (!(flags & NO_WAIT)) run(s);
}

static void say_hello(session *s) {
    uint8_t hello[HP_HEADER_BYTES + HP_HELLO_FIXED] = {0};
    hello[HP_AT_HEADER_version] = HP_PROTOCOL_VERSION;
    hello[HP_AT_HEADER_opcode] = HP_OPCODE_HELLO;
    hp_put16(hello + HP_HEADER_BYTES + HP_AT_HELLO_version_min, 1);
    hp_put16(hello + HP_HEADER_BYTES + HP_AT_HELLO_version_max, 1);
    send(s, WHOLE | EXPECTED, hello, sizeof hello);
    require(s->expected == 1);
}

static void open_board(session *s, bool clocked) {
    hp_board_def def = {.isa = "plain", .threads = 1, .engine = clocked ? HP_ENGINE_CLOCKED : HP_ENGINE_QUICK};
    hp_config_preset(&def.config, "usb3");
    def.config.ddr_bytes = 36 * 20; /* so that no query is long */
    def.config.packet_primaries = 16;
    def.config.packet_results = 50;
    def.config.sram_records = 100;
    def.config.link_turnaround_ns = 0;
    def.config.lanes = 3;
    require(hp_board_create(&def, &s->board) == HP_OK);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    session s = {0};
    hp_header header;
    const uint8_t *payload;
    hp_packet_open(data, n, &header, &payload);
    open_board(&s, n & 1);
    say_hello(&s);
    while (n >= 3 && s.sent < TRANSFERS) {
        size_t length = hp_get16(data + 1);
        if (length > n - 3) length = n - 3;
        send(&s, data[0], data + 3, length);
        data += 3 + length;
        n -= 3 + length;
    }
    run(&s);
    hp_board_destroy(s.board);
    for (unsigned i = 0; i < s.sent; i++) free(s.transfer[i]);
    return 0;
}
