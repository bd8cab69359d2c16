/* The USB/IP server: what a client reads and writes, byte by byte, from offsets typed in from the kernel's
 * usbip_protocol.rst; the golden vectors through it; and clients that are broken, slow, greedy or hostile. */
#include "driver/usbip/server.h"
#include "host/import/vectors.h"
#include "testbench/support/board_host.h"
#include "testbench/support/random.h"
#include <arpa/inet.h>
#include <errno.h>
#include <glob.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { DEVICE = 312, HEAD = 48, ROOM = 1 << 20, TRIANGLES = 27, RAYS = 200 };
enum { OUT = 0, IN = 1 };

static float triangles[TRIANGLES * HP_TRIANGLE_WORDS], rays[RAYS * HP_RAY_WORDS];

static int make_input(void **state) {
    (void)state;
    hpt_triangles(7, TRIANGLES, 1, triangles);
    hpt_rays(8, RAYS, rays);
    return 0;
}

/* ---- big endian ---- */

static void put(uint8_t *at, uint32_t number) {
    for (unsigned i = 0; i < 4; i++) at[i] = (uint8_t)(number >> (24 - 8 * i));
}

static uint32_t get(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* ---- boards and a connection without a socket ---- */

typedef struct boards {
    hp_usbip_export exports[2];
    hp_usbip_limits limits;
} boards;

static hp_gadget_def gadget_def(const char *serial) {
    return (hp_gadget_def){.board = hpt_board("usb3", HP_ENGINE_QUICK), .serial = serial, .speed = HP_USB_SUPER};
}

static void make_boards_of(boards *b, const hp_gadget_def *def) {
    b->limits = hp_usbip_default_limits();
    for (unsigned i = 0; i < 2; i++) {
        hp_usbip_export *made = &b->exports[i];
        *made = (hp_usbip_export){.place = {.busnum = 1, .devnum = 2 + i}};
        snprintf(made->place.busid, sizeof made->place.busid, "1-%u", i + 1);
        assert_int_equal(hp_gadget_create(def, &made->gadget), HP_OK);
    }
}

static void make_boards(boards *b) {
    hp_gadget_def def = gadget_def("HP-000001");
    make_boards_of(b, &def);
}

static void free_boards(boards *b) {
    for (unsigned i = 0; i < 2; i++) {
        assert_null(b->exports[i].user);
        hp_gadget_destroy(b->exports[i].gadget);
    }
}

/* One end of a connection. What the server has said is in `heard`. */
typedef struct line {
    hp_usbip_client *client;
    hpt_random random; /* of the pieces in which bytes come */
    uint8_t *heard;
    size_t heard_bytes, heard_room;
    uint32_t seqnum;
} line;

static line connect_to(boards *b) {
    line l = {.client = hp_usbip_client_create(b->exports, 2, &b->limits), .random = hpt_random_seed(5)};
    assert_non_null(l.client);
    return l;
}

static void hang_up(line *l) {
    hp_usbip_client_destroy(l->client);
    free(l->heard);
    *l = (line){0};
}

/* Says as much as is wanted, in pieces of any size; how much that was. */
static size_t say(line *l, const uint8_t *bytes, size_t n) {
    size_t said = 0, wanted;
    uint8_t *to;
    while (said < n && (wanted = hp_usbip_client_wants(l->client, &to))) {
        size_t piece = wanted < n - said ? wanted : n - said;
        if (hpt_random_below(&l->random, 4) == 0) piece = 1 + hpt_random_below(&l->random, piece);
        memcpy(to, bytes + said, piece);
        hp_usbip_client_got(l->client, piece);
        said += piece;
    }
    return said;
}

static void run_board(line *l) {
    while (hp_usbip_client_run(l->client)) {
    }
}

static void hear(line *l) {
    const uint8_t *from;
    bool more;
    size_t n;
    run_board(l);
    while ((n = hp_usbip_client_has(l->client, &from, &more))) {
        if (hpt_random_below(&l->random, 4) == 0) n = 1 + hpt_random_below(&l->random, n);
        if (l->heard_bytes + n > l->heard_room) {
            l->heard_room = 2 * (l->heard_bytes + n);
            l->heard = realloc(l->heard, l->heard_room);
            assert_non_null(l->heard);
        }
        memcpy(l->heard + l->heard_bytes, from, n);
        l->heard_bytes += n;
        hp_usbip_client_sent(l->client, n);
    }
}

static void forget(line *l, size_t n) {
    assert_true(n <= l->heard_bytes);
    memmove(l->heard, l->heard + n, l->heard_bytes - n);
    l->heard_bytes -= n;
}

/* ---- messages ---- */

static const uint8_t list_request[8] = {0x01, 0x11, 0x80, 0x05};

static void make_import(uint8_t bytes[40], const char *busid) {
    memset(bytes, 0, 40);
    memcpy(bytes, (uint8_t[]){0x01, 0x11, 0x80, 0x03}, 4);
    memcpy(bytes + 8, busid, strlen(busid));
}

/* Status of the reply; on success the device is in l->heard. */
static uint32_t import(line *l, const char *busid) {
    uint8_t bytes[40];
    make_import(bytes, busid);
    assert_int_equal(say(l, bytes, 40), 40);
    hear(l);
    assert_true(l->heard_bytes >= 8);
    assert_memory_equal(l->heard, ((uint8_t[]){0x01, 0x11, 0x00, 0x03}), 4);
    uint32_t status = get(l->heard + 4);
    forget(l, 8);
    assert_int_equal(l->heard_bytes, status ? 0 : DEVICE);
    return status;
}

static line attached(boards *b) {
    line l = connect_to(b);
    assert_int_equal(import(&l, "1-1"), 0);
    forget(&l, DEVICE);
    return l;
}

typedef struct submit {
    unsigned endpoint, direction, flags;
    uint32_t length;
    const uint8_t *setup; /* NULL: none */
    const uint8_t *bytes; /* to the device */
} submit;

static void make_submit(uint8_t head[HEAD], uint32_t seqnum, const submit *s) {
    memset(head, 0, HEAD);
    put(head, 1);
    put(head + 4, seqnum);
    put(head + 8, 1 << 16 | 2);
    put(head + 12, s->direction);
    put(head + 16, s->endpoint);
    put(head + 20, s->flags);
    put(head + 24, s->length);
    if (s->setup) memcpy(head + 40, s->setup, 8);
}

static uint32_t say_submit(line *l, submit s) {
    uint8_t head[HEAD];
    make_submit(head, ++l->seqnum, &s);
    assert_int_equal(say(l, head, HEAD), HEAD);
    if (s.direction == OUT && s.length) assert_int_equal(say(l, s.bytes, s.length), s.length);
    return l->seqnum;
}

static void say_unlink(line *l, uint32_t seqnum) {
    uint8_t head[HEAD] = {0};
    put(head, 2);
    put(head + 4, ++l->seqnum);
    put(head + 8, 1 << 16 | 2);
    put(head + 20, seqnum);
    assert_int_equal(say(l, head, HEAD), HEAD);
}

typedef struct reply {
    uint32_t command, seqnum, moved;
    int32_t status;
} reply;

/* The next reply that was heard; its bytes, behind its head, stay. */
static reply next_reply(line *l) {
    assert_true(l->heard_bytes >= HEAD);
    reply r = {get(l->heard), get(l->heard + 4), get(l->heard + 24), (int32_t)get(l->heard + 20)};
    for (unsigned i = 8; i < 20; i++) assert_int_equal(l->heard[i], 0);
    for (unsigned i = 28; i < HEAD; i++) assert_int_equal(l->heard[i], 0);
    forget(l, HEAD);
    return r;
}

static reply expect_return(line *l, uint32_t seqnum, int32_t status, uint32_t moved) {
    hear(l);
    reply r = next_reply(l);
    assert_int_equal(r.command, 3);
    assert_int_equal(r.seqnum, seqnum);
    assert_int_equal(r.status, status);
    assert_int_equal(r.moved, moved);
    return r;
}

static void configure(line *l) {
    const uint8_t setup[8] = {0, 9, 1};
    uint32_t seqnum = say_submit(l, (submit){.setup = setup});
    expect_return(l, seqnum, 0, 0);
}

static void send_packet(line *l, const hpt_packet *packet) {
    submit s = {.endpoint = 1, .flags = 0x40, .length = (uint32_t)packet->n, .bytes = packet->bytes};
    uint32_t seqnum = say_submit(l, s);
    expect_return(l, seqnum, 0, (uint32_t)packet->n);
}

/* The packet is at the start of l->heard; its bytes. */
static size_t receive_packet(line *l, hp_header *header, const uint8_t **payload) {
    uint32_t seqnum = say_submit(l, (submit){.endpoint = 1, .direction = IN, .length = ROOM});
    hear(l);
    reply r = next_reply(l);
    assert_int_equal(r.command, 3);
    assert_int_equal(r.seqnum, seqnum);
    assert_int_equal(r.status, 0);
    assert_int_equal(l->heard_bytes, r.moved);
    assert_int_equal(hp_packet_open(l->heard, r.moved, header, payload), HP_OK);
    return r.moved;
}

static hpt_script script_of(unsigned queries) {
    hpt_script script = {0};
    hpt_query query = hpt_query_all(HP_MODE_CLOSEST, TRIANGLES, RAYS, rays);
    hpt_hello(&script);
    hpt_upload(&script, HP_TRIANGLE, 0, TRIANGLES, triangles);
    for (unsigned i = 0; i < queries; i++) hpt_ask(&script, &query);
    return script;
}

static void play(line *l, const hpt_script *script) {
    for (size_t i = 0; i < script->count; i++) {
        hp_header header;
        const uint8_t *payload;
        send_packet(l, &script->packets[i]);
        size_t n = receive_packet(l, &header, &payload);
        assert_int_equal(header.status, HP_OK);
        assert_int_equal(header.tag, i + 1);
        forget(l, n);
    }
}

/* ---- list and import ---- */

static void check_device(const uint8_t *device, unsigned number) {
    char busid[8];
    snprintf(busid, sizeof busid, "1-%u", number);
    assert_int_equal(strncmp((const char *)device, "/sys/", 5), 0);
    assert_string_equal((const char *)device + strlen((const char *)device) - 3, busid);
    assert_string_equal((const char *)device + 256, busid);
    assert_int_equal(get(device + 288), 1);
    assert_int_equal(get(device + 292), number + 1);
    assert_int_equal(get(device + 296), 5);
    assert_memory_equal(device + 300, ((uint8_t[]){0x12, 0x09, 0x00, 0x01, 0x01, 0x00, 0, 0, 0, 0, 1, 2}), 12);
}

static void boards_are_listed(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    line l = connect_to(&b);
    for (unsigned times = 0; times < 2; times++) { /* who asks may ask again */
        assert_int_equal(say(&l, list_request, 8), 8);
        hear(&l);
        assert_int_equal(l.heard_bytes, 12 + 2 * (DEVICE + 8));
        assert_memory_equal(l.heard, ((uint8_t[]){0x01, 0x11, 0x00, 0x05, 0, 0, 0, 0, 0, 0, 0, 2}), 12);
        for (unsigned i = 0; i < 2; i++) {
            const uint8_t *device = l.heard + 12 + i * (DEVICE + 8);
            check_device(device, i + 1);
            assert_memory_equal(device + DEVICE, ((uint8_t[]){0xFF, 0x48, 0, 0, 3, 0, 0, 0}), 8);
        }
        forget(&l, l.heard_bytes);
    }
    assert_int_equal(hp_usbip_client_messages(l.client), 2);
    hang_up(&l);
    free_boards(&b);
}

static void a_board_is_imported_by_one_client(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    line one = connect_to(&b), other = connect_to(&b);
    assert_int_equal(import(&one, "1-3"), 4);
    assert_int_equal(import(&one, ""), 4);
    assert_int_equal(import(&one, "1-12345678901234567890123456789"), 4); /* no zero at its end */
    assert_null(hp_usbip_client_board(one.client));
    assert_int_equal(import(&one, "1-2"), 0);
    check_device(one.heard, 2);
    assert_ptr_equal(hp_usbip_client_board(one.client), &b.exports[1]);
    assert_int_equal(import(&other, "1-2"), 2);
    hang_up(&one);
    assert_int_equal(import(&other, "1-2"), 0);
    hang_up(&other);
    free_boards(&b);
}

/* ---- urbs ---- */

static void a_descriptor_comes_as_these_bytes(void **state) {
    (void)state;
    static const uint8_t request[HEAD] = {0,    0, 0, 1, 0,    0,    0,    7,    0, 1, 0, 2, 0, 0,
                                          0,    1, 0, 0, 0,    0,    0,    0,    2, 0, 0, 0, 0, 64,
                                          0,    0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0, /* setup */
                                          0x80, 6, 0, 1, 0,    0,    64,   0};
    static const uint8_t answer[HEAD + 18] = {
        0,    0,    0,    3,    0,    0,    0,    7,    [27] = 18, [48] = 0x12, 0x01, 0x20, 0x03, 0x00,
        0x00, 0x00, 0x09, 0x09, 0x12, 0x01, 0x00, 0x00, 0x01,      0x01,        0x02, 0x03, 0x01};
    boards b;
    make_boards(&b);
    line l = attached(&b);
    assert_int_equal(say(&l, request, HEAD), HEAD);
    hear(&l);
    assert_int_equal(l.heard_bytes, sizeof answer);
    assert_memory_equal(l.heard, answer, sizeof answer);
    assert_true(hp_usbip_client_rests(l.client));
    hang_up(&l);
    free_boards(&b);
}

static void queries_are_answered(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    line l = attached(&b);
    hpt_script script = script_of(3);
    configure(&l);
    hpt_log log = hpt_play(&(hp_board_def){.config = gadget_def("1").board.config, .threads = 1}, &script, 1);
    for (size_t i = 0, at = 0; i < script.count; i++, at++) {
        hp_header header;
        const uint8_t *payload;
        send_packet(&l, &script.packets[i]);
        size_t n = receive_packet(&l, &header, &payload);
        while (log.events[at].kind != HP_BOARD_SENT) at++;
        assert_int_equal(n, log.events[at].n);
        assert_memory_equal(l.heard, log.events[at].bytes, n);
        forget(&l, n);
    }
    hpt_log_free(&log);
    hpt_script_free(&script);
    hang_up(&l);
    free_boards(&b);
}

/* How an urb ends, in Linux's numbers. */
static void urbs_end_as_linux_has_it(void **state) {
    (void)state;
    const uint8_t device[8] = {0x80, 6, 0, 1, 0, 0, 64}, unknown[8] = {0x80, 99}, halt[8] = {2, 3, 0, 0, 0x81};
    const uint8_t clear[8] = {2, 1, 0, 0, 0x81};
    boards b;
    make_boards(&b);
    line l = attached(&b);
    hpt_script script = script_of(1);
    configure(&l);
    expect_return(&l, say_submit(&l, (submit){.setup = unknown, .direction = IN, .length = 5}), -32, 0);
    expect_return(&l, say_submit(&l, (submit){.setup = device, .direction = IN, .length = 64, .flags = 1}), -121, 18);
    forget(&l, 18);
    expect_return(&l, say_submit(&l, (submit){.setup = device, .direction = IN, .length = 18, .flags = 1}), 0, 18);
    forget(&l, 18);
    expect_return(&l, say_submit(&l, (submit){.setup = halt}), 0, 0);
    expect_return(&l, say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = 512}), -32, 0);
    expect_return(&l, say_submit(&l, (submit){.setup = clear}), 0, 0);
    expect_return(&l, say_submit(&l, (submit){.endpoint = 9, .direction = IN, .length = 512}), -32, 0);
    for (unsigned i = 0; i < 2; i++) {
        hp_header header;
        const uint8_t *payload;
        send_packet(&l, &script.packets[i]);
        forget(&l, receive_packet(&l, &header, &payload));
    }
    send_packet(&l, &script.packets[2]);
    expect_return(&l, say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = 1500}), -75, 1024);
    assert_int_equal((int32_t)hp_usbip_status(HP_URB_LOST, false), -71); /* the gadget loses nothing; cables do */
    hpt_script_free(&script);
    hang_up(&l);
    free_boards(&b);
}

/* The upload has 1024 bytes: with the flag, or an urb of none behind it, it is a whole packet; without, it waits. */
static void zero_length_packets_are_asked_for(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    line l = attached(&b);
    hpt_script script = script_of(0);
    hp_header header;
    const uint8_t *payload;
    configure(&l);
    play(&l, &script);
    submit upload = {.endpoint = 1, .length = 1024, .bytes = script.packets[1].bytes};
    expect_return(&l, say_submit(&l, upload), 0, 1024);
    uint32_t waits = say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = ROOM});
    hear(&l);
    assert_int_equal(l.heard_bytes, 0);
    uint32_t empty = say_submit(&l, (submit){.endpoint = 1});
    hear(&l);
    assert_int_equal(next_reply(&l).seqnum, empty);
    reply r = next_reply(&l);
    assert_int_equal(r.seqnum, waits);
    assert_int_equal(hp_packet_open(l.heard, r.moved, &header, &payload), HP_OK);
    assert_int_equal(header.status, HP_ERROR_SEQUENCE); /* the same again: it came whole, and is one too many */
    hpt_script_free(&script);
    hang_up(&l);
    free_boards(&b);
}

static void unlinked_urbs_do_not_return(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    line l = attached(&b);
    hpt_script script = script_of(0);
    configure(&l);
    uint32_t waits[3];
    for (unsigned i = 0; i < 3; i++)
        waits[i] = say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = ROOM});
    hear(&l);
    assert_int_equal(l.heard_bytes, 0);
    say_unlink(&l, waits[1]);
    hear(&l);
    reply r = next_reply(&l);
    assert_int_equal(r.command, 4);
    assert_int_equal(r.seqnum, l.seqnum);
    assert_int_equal(r.status, -104);
    submit hello = {.endpoint = 1, .length = (uint32_t)script.packets[0].n, .bytes = script.packets[0].bytes};
    uint32_t sent = say_submit(&l, hello);
    hear(&l);
    assert_int_equal(next_reply(&l).seqnum, sent);
    r = next_reply(&l);
    assert_int_equal(r.seqnum, waits[0]);
    forget(&l, r.moved);
    say_unlink(&l, waits[0]); /* it is done; there is nothing to take back */
    say_unlink(&l, waits[1]);
    say_unlink(&l, 12345);
    for (unsigned i = 0; i < 3; i++) {
        hear(&l);
        r = next_reply(&l);
        assert_int_equal(r.command, 4);
        assert_int_equal(r.seqnum, l.seqnum - 2 + i);
        assert_int_equal(r.status, 0);
    }
    assert_int_equal(l.heard_bytes, 0);
    hpt_script_free(&script);
    hang_up(&l);
    free_boards(&b);
}

/* ---- golden vectors ---- */

/* All records of a file, up to 256 in a query. */
static hpt_script script_of_vectors(const hp_vectors *vectors) {
    hpt_script script = {0};
    unsigned words = hp_object_words(hp_pair_primary(vectors->pair));
    hpt_hello(&script);
    for (uint32_t at = 0; at < vectors->count; at += HP_PACKET_PRIMARIES) {
        uint32_t n = (uint32_t)vectors->count - at;
        if (n > HP_PACKET_PRIMARIES) n = HP_PACKET_PRIMARIES;
        hpt_query query = hpt_query_all(HP_MODE_ZIP, n, n, vectors->primaries + (size_t)at * words);
        query.pair = vectors->pair;
        query.options = vectors->separation ? HP_OPTION_SEPARATION : 0;
        hp_object secondary = hp_pair_secondary(vectors->pair);
        const float *objects = vectors->secondaries + (size_t)at * hp_object_words(secondary);
        hpt_upload(&script, secondary, 0, n, objects);
        hpt_ask(&script, &query);
    }
    return script;
}

/* A record on the wire against the words of the file; the index counts from the start of the upload. */
static void check_record(const uint8_t *record, const uint32_t *answer, uint32_t index) {
    assert_int_equal(hp_get32(record), answer[0]);
    assert_int_equal(hp_get32(record + 4), answer[0] ? index : HP_NO_INDEX);
    for (unsigned i = 2; i < 6; i++) assert_int_equal(hp_get32(record + 4 * i), answer[i]);
}

static void check_vectors(line *l, const hp_vectors *vectors) {
    hpt_script script = script_of_vectors(vectors);
    size_t checked = 0;
    for (size_t i = 0; i < script.count; i++) {
        hp_header header;
        const uint8_t *payload;
        send_packet(l, &script.packets[i]);
        size_t n = receive_packet(l, &header, &payload);
        assert_int_equal(header.status, HP_OK);
        assert_true(header.flags & HP_FLAG_LAST);
        uint32_t records = header.opcode == HP_OPCODE_RESULT ? hp_get32(payload + HP_AT_RESULT_count) : 0;
        for (uint32_t k = 0; k < records; k++, checked++)
            check_record(payload + HP_RESULT_FIXED + k * HP_RESULT_BYTES,
                         vectors->answers + checked * HP_VECTOR_ANSWER_WORDS, k);
        forget(l, n);
    }
    assert_int_equal(checked, vectors->count);
    hpt_script_free(&script);
}

static size_t check_file(const char *path) {
    hp_vectors vectors;
    hp_fault fault;
    hp_gadget_def def = gadget_def("HP-000001");
    boards b;
    assert_int_equal(hp_vectors_read(path, &vectors, &fault), HP_OK);
    def.board.config.subnormals = vectors.numerics == HP_NUMERICS_FLUSH ? HP_FLUSH : HP_GRADUAL;
    make_boards_of(&b, &def);
    line l = attached(&b);
    configure(&l);
    check_vectors(&l, &vectors);
    hang_up(&l);
    free_boards(&b);
    size_t count = vectors.count;
    hp_vectors_free(&vectors);
    return count;
}

static void golden_vectors_have_the_same_bits(void **state) {
    (void)state;
    glob_t files;
    size_t records = 0;
    assert_int_equal(glob("vectors/*/*.hex", 0, NULL, &files), 0);
    for (size_t i = 0; i < files.gl_pathc; i++) records += check_file(files.gl_pathv[i]);
    assert_true(files.gl_pathc >= 13 && records > 10000);
    globfree(&files);
}

/* ---- connections that end ---- */

/* A connection that is lost at any time leaves a board that the next client finds new. */
static void a_lost_connection_frees_the_board(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    hpt_script script = script_of(2);
    for (unsigned steps = 0; steps < 30; steps++) {
        line l = attached(&b);
        configure(&l);
        for (unsigned i = 0; i < 4; i++) {
            submit s = {.endpoint = 1, .flags = 0x40, .length = (uint32_t)script.packets[i].n};
            s.bytes = script.packets[i].bytes;
            say_submit(&l, s);
            say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = ROOM});
            say_submit(&l, (submit){.endpoint = 2, .direction = IN, .length = 64});
        }
        for (unsigned i = 0; i < steps; i++) hp_usbip_client_run(l.client);
        if (steps % 3 == 1) hear(&l);
        hang_up(&l);
        assert_null(b.exports[0].user);
    }
    line l = attached(&b);
    configure(&l);
    play(&l, &script);
    hang_up(&l);
    hpt_script_free(&script);
    free_boards(&b);
}

/* Everything that a client may say, and some bytes of an urb. */
static size_t whole_session(uint8_t *bytes) {
    const uint8_t setup[8] = {0, 9, 1};
    uint8_t *at = bytes;
    memcpy(at, list_request, 8), at += 8;
    make_import(at, "1-1"), at += 40;
    make_submit(at, 1, &(submit){.setup = setup}), at += HEAD;
    make_submit(at, 2, &(submit){.endpoint = 1, .direction = IN, .length = 4096}), at += HEAD;
    make_submit(at, 3, &(submit){.endpoint = 1, .length = 100}), at += HEAD;
    memset(at, 0x5A, 100), at += 100;
    memset(at, 0, HEAD), put(at, 2), put(at + 4, 4), put(at + 8, 1 << 16 | 2), put(at + 20, 2), at += HEAD;
    return (size_t)(at - bytes);
}

static void a_session_may_end_at_every_byte(void **state) {
    (void)state;
    boards b;
    uint8_t bytes[400];
    make_boards(&b);
    size_t n = whole_session(bytes);
    for (size_t cut = 0; cut <= n; cut++) {
        line l = connect_to(&b);
        assert_int_equal(say(&l, bytes, cut), cut);
        hear(&l);
        assert_null(hp_usbip_client_fault(l.client));
        assert_int_equal(hp_usbip_client_rests(l.client),
                         cut == 0 || cut == 8 || cut == 48 || cut == 96 || cut == 144 || cut == 292 || cut == n);
        hang_up(&l);
        assert_null(b.exports[0].user);
    }
    free_boards(&b);
}

/* ---- hostile messages ---- */

static void expect_fault(line *l, const char *words) {
    uint8_t *to;
    const uint8_t *from;
    bool more;
    assert_non_null(hp_usbip_client_fault(l->client));
    assert_non_null(strstr(hp_usbip_client_fault(l->client), words));
    assert_int_equal(hp_usbip_client_wants(l->client, &to), 0);
    assert_int_equal(hp_usbip_client_has(l->client, &from, &more), 0);
    assert_false(hp_usbip_client_run(l->client));
}

static void requests_that_are_none_end_the_client(void **state) {
    (void)state;
    static const struct {
        uint8_t bytes[8];
        const char *words;
    } requests[] = {
        {{0x01, 0x10, 0x80, 0x05}, "version 0110"},         {{0x00, 0x00, 0x80, 0x05}, "version"},
        {{0x01, 0x11, 0x80, 0x05, 0, 0, 0, 1}, "status 1"}, {{0x01, 0x11, 0x00, 0x05}, "request 0005"},
        {{0x01, 0x11, 0x80, 0x04}, "request 8004"},         {{'G', 'E', 'T', ' ', '/', ' ', 'H', 'T'}, "version"}};
    boards b;
    make_boards(&b);
    for (unsigned i = 0; i < sizeof requests / sizeof *requests; i++) {
        line l = connect_to(&b);
        say(&l, requests[i].bytes, 8);
        expect_fault(&l, requests[i].words);
        hang_up(&l);
    }
    free_boards(&b);
}

static void urbs_that_are_none_end_the_client(void **state) {
    (void)state;
    static const struct {
        unsigned at;
        uint32_t value;
        const char *words;
    } changes[] = {{0, 0, "command 0"},
                   {0, 3, "command 3"},
                   {0, 0xFFFFFFFF, "command"},
                   {8, 1 << 16 | 3, "not imported"},
                   {8, 0, "not imported"},
                   {12, 2, "direction 2"},
                   {12, 0xFFFFFFFF, "direction"},
                   {16, 16, "endpoint 16"},
                   {16, 0x81, "endpoint"},
                   {16, 0xFFFFFFFF, "endpoint"},
                   {24, (1 << 20) + 1, "1048577 bytes"},
                   {24, 0x7FFFFFFF, "2147483647 bytes"},
                   {24, 0x80000000, "2147483648 bytes"},
                   {24, 0xFFFFFFFF, "4294967295 bytes"},
                   {32, 1, "isochronous"},
                   {32, 0x7FFFFFFF, "isochronous"},
                   {4, 1, "two urbs"}};
    boards b;
    make_boards(&b);
    for (unsigned i = 0; i < sizeof changes / sizeof *changes; i++) {
        line l = attached(&b);
        uint8_t head[HEAD];
        configure(&l);
        l.seqnum = 0;
        say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = 512}); /* number 1 */
        make_submit(head, 2, &(submit){.endpoint = 1, .direction = IN, .length = 512});
        put(head + changes[i].at, changes[i].value);
        assert_int_equal(say(&l, head, HEAD), HEAD);
        expect_fault(&l, changes[i].words);
        hang_up(&l);
    }
    free_boards(&b);
}

/* The setup says IN, the message OUT, or the other way: one of them lies about whose the bytes are. */
static void a_control_request_has_one_direction(void **state) {
    (void)state;
    const uint8_t setup_in[8] = {0x80, 6, 0, 1, 0, 0, 18}, setup_out[8] = {0, 9, 1};
    uint8_t bytes[18] = {0}, head[HEAD];
    boards b;
    make_boards(&b);
    for (unsigned i = 0; i < 2; i++) {
        line l = attached(&b);
        make_submit(head, 1, &(submit){.setup = i ? setup_in : setup_out, .direction = i ? OUT : IN, .length = 18});
        say(&l, head, HEAD);
        say(&l, bytes, 18);
        expect_fault(&l, "direction");
        hang_up(&l);
    }
    line l = attached(&b); /* without bytes it does not matter */
    expect_return(&l, say_submit(&l, (submit){.setup = setup_in, .direction = OUT}), 0, 0);
    hang_up(&l);
    free_boards(&b);
}

/* Any bytes at all: the client ends or goes on, and memory is safe. */
static void garbage_ends_the_client_at_most(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    hpt_random random = hpt_random_seed(3);
    for (unsigned times = 0; times < 300; times++) {
        line l = times % 2 ? attached(&b) : connect_to(&b);
        uint8_t bytes[600];
        size_t n = whole_session(bytes);
        for (unsigned i = 0; i < 1 + times % 7; i++)
            bytes[hpt_random_below(&random, n)] = (uint8_t)hpt_random_bits(&random);
        say(&l, bytes + (times % 2 ? 48 : 0), n - (times % 2 ? 48 : 0));
        hear(&l);
        hang_up(&l);
    }
    free_boards(&b);
}

/* ---- limits ---- */

static void pending_urbs_are_limited(void **state) {
    (void)state;
    boards b;
    make_boards(&b);
    b.limits.urbs = 10;
    line l = attached(&b);
    configure(&l);
    for (unsigned i = 0; i < 10; i++) say_submit(&l, (submit){.endpoint = 2, .direction = IN, .length = 64});
    assert_null(hp_usbip_client_fault(l.client));
    uint8_t head[HEAD];
    make_submit(head, ++l.seqnum, &(submit){.endpoint = 2, .direction = IN, .length = 64});
    say(&l, head, HEAD);
    expect_fault(&l, "more than 10 urbs");
    hang_up(&l);
    free_boards(&b);
}

static void pending_bytes_are_limited(void **state) {
    (void)state;
    for (unsigned direction = 0; direction < 2; direction++) {
        boards b;
        uint8_t head[HEAD];
        make_boards(&b);
        b.limits.bytes = 1000000;
        line l = attached(&b);
        configure(&l);
        for (unsigned i = 0; i < 3; i++) say_submit(&l, (submit){.endpoint = 1, .direction = IN, .length = 300000});
        assert_null(hp_usbip_client_fault(l.client));
        make_submit(head, ++l.seqnum, &(submit){.endpoint = 1, .direction = direction, .length = 300000});
        say(&l, head, HEAD);
        expect_fault(&l, "1000000 bytes");
        hang_up(&l);
        free_boards(&b);
    }
}

/* Replies that nobody fetches: the client is not listened to, and goes on when it fetches them. */
static void who_does_not_listen_is_not_listened_to(void **state) {
    (void)state;
    const uint8_t setup[8] = {0x80, 6, 0, 2, 0, 0, 0, 1};
    boards b;
    uint8_t head[HEAD], *to;
    make_boards(&b);
    b.limits.urbs = 20;
    line l = attached(&b);
    unsigned asked = 0;
    for (; asked < 1000 && hp_usbip_client_wants(l.client, &to); asked++) {
        make_submit(head, asked, &(submit){.setup = setup, .direction = IN, .length = 256});
        assert_int_equal(say(&l, head, HEAD), HEAD);
        run_board(&l);
    }
    assert_int_equal(asked, 20);
    assert_null(hp_usbip_client_fault(l.client));
    assert_false(hp_usbip_client_rests(l.client));
    hear(&l);
    for (unsigned i = 0; i < asked; i++) {
        reply r = next_reply(&l);
        assert_int_equal(r.seqnum, i);
        assert_int_equal(r.moved, 75);
        forget(&l, 75);
    }
    assert_int_not_equal(hp_usbip_client_wants(l.client, &to), 0);
    for (asked = 0; asked < 1000 && hp_usbip_client_wants(l.client, &to); asked++) say_unlink(&l, 7);
    assert_int_equal(asked, 20);
    hang_up(&l);
    free_boards(&b);
}

/* ---- the server, over loopback ---- */

enum { PATIENCE_MS = 5000 }; /* of the tests with the server */

typedef struct serving {
    hp_usbip_def def;
    hp_gadget_def gadgets[3];
    hp_usbip_server *server;
    pthread_t thread;
    hp_status status;
    pthread_mutex_t lock;
    char log[4000];
} serving;

static void take_line(void *context, const char *text) {
    serving *s = context;
    pthread_mutex_lock(&s->lock);
    size_t n = strlen(s->log);
    snprintf(s->log + n, sizeof s->log - n, "%s\n", text);
    pthread_mutex_unlock(&s->lock);
}

static void *serve(void *context) {
    serving *s = context;
    s->status = hp_usbip_serve(s->server);
    return NULL;
}

static serving *prepared(size_t count) {
    static const char *const serials[] = {"A", "B", "C"};
    serving *s = calloc(1, sizeof *s);
    assert_non_null(s);
    for (unsigned i = 0; i < 3; i++) s->gadgets[i] = gadget_def(serials[i]);
    s->def = (hp_usbip_def){.gadgets = s->gadgets,
                            .count = count,
                            .limits = hp_usbip_default_limits(),
                            .log = take_line,
                            .log_context = s};
    pthread_mutex_init(&s->lock, NULL);
    return s;
}

static void start(serving *s) {
    char why[HP_USBIP_MESSAGE];
    if (hp_usbip_create(&s->def, &s->server, why) != HP_OK) fail_msg("%s", why);
    assert_int_equal(pthread_create(&s->thread, NULL, serve, s), 0);
}

static void finish(serving *s) {
    pthread_join(s->thread, NULL);
    assert_int_equal(s->status, HP_OK);
    hp_usbip_destroy(s->server);
    pthread_mutex_destroy(&s->lock);
    free(s);
}

static void stop(serving *s) {
    hp_usbip_stop(s->server);
    finish(s);
}

static bool logged(serving *s, const char *words) {
    pthread_mutex_lock(&s->lock);
    bool there = strstr(s->log, words);
    pthread_mutex_unlock(&s->lock);
    return there;
}

static void clear_log(serving *s) {
    pthread_mutex_lock(&s->lock);
    s->log[0] = 0;
    pthread_mutex_unlock(&s->lock);
}

static void sleep_ms(unsigned ms) {
    nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000L}, NULL);
}

static void wait_for_line(serving *s, const char *words) {
    for (unsigned ms = 0; !logged(s, words); ms++) {
        if (ms == PATIENCE_MS) fail_msg("no \"%s\" in:\n%s", words, s->log);
        sleep_ms(1);
    }
}

/* ---- a client with a socket ---- */

static int dial(const serving *s) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)hp_usbip_port(s->server))};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int yes = 1;
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    assert_int_equal(connect(fd, (const struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

static void write_all(int fd, const uint8_t *bytes, size_t n) {
    for (ssize_t moved; n; bytes += moved, n -= (size_t)moved) {
        moved = send(fd, bytes, n, MSG_NOSIGNAL);
        assert_true(moved > 0);
    }
}

/* Bytes that came before the connection ended, or before `n` were there. */
static size_t read_until(int fd, uint8_t *bytes, size_t n) {
    size_t got = 0;
    while (got < n) {
        struct pollfd wait = {.fd = fd, .events = POLLIN};
        if (poll(&wait, 1, PATIENCE_MS) != 1) fail_msg("the server says nothing");
        ssize_t moved = recv(fd, bytes + got, n - got, 0);
        if (moved <= 0) break;
        got += (size_t)moved;
    }
    return got;
}

static void read_all(int fd, uint8_t *bytes, size_t n) {
    assert_int_equal(read_until(fd, bytes, n), n);
}

/* The server has closed the connection, maybe after some replies. */
static bool has_ended(int fd) {
    uint8_t bytes[4096];
    return read_until(fd, bytes, sizeof bytes) < sizeof bytes;
}

static uint32_t dial_import(int fd, const char *busid) {
    uint8_t bytes[DEVICE];
    make_import(bytes, busid);
    write_all(fd, bytes, 40);
    read_all(fd, bytes, 8);
    uint32_t status = get(bytes + 4);
    if (!status) read_all(fd, bytes, DEVICE);
    return status;
}

static int dial_attached(const serving *s, const char *busid) {
    int fd = dial(s);
    assert_int_equal(dial_import(fd, busid), 0);
    return fd;
}

/* Submits, and reads the reply; bytes to the host are at `bytes`. */
static void exchange(int fd, unsigned devnum, submit s, uint8_t *bytes, uint32_t moved) {
    static uint32_t seqnum;
    uint8_t head[HEAD];
    make_submit(head, ++seqnum, &s);
    put(head + 8, 1 << 16 | devnum);
    write_all(fd, head, HEAD);
    if (s.direction == OUT) write_all(fd, s.bytes, s.length);
    read_all(fd, head, HEAD);
    assert_int_equal(get(head), 3);
    assert_int_equal(get(head + 4), seqnum);
    assert_int_equal(get(head + 20), 0);
    if (s.direction == IN) {
        moved = get(head + 24);
        read_all(fd, bytes, moved);
    }
    assert_int_equal(get(head + 24), moved);
}

static void dial_play(int fd, unsigned devnum, const hpt_script *script) {
    const uint8_t setup[8] = {0, 9, 1};
    uint8_t *bytes = malloc(ROOM);
    assert_non_null(bytes);
    exchange(fd, devnum, (submit){.setup = setup}, NULL, 0);
    for (size_t i = 0; i < script->count; i++) {
        uint32_t n = (uint32_t)script->packets[i].n;
        submit out = {.endpoint = 1, .flags = 0x40, .length = n, .bytes = script->packets[i].bytes};
        exchange(fd, devnum, out, NULL, n);
        exchange(fd, devnum, (submit){.endpoint = 1, .direction = IN, .length = ROOM}, bytes, 0);
        assert_int_equal(hp_get32(bytes + HP_AT_HEADER_tag), i + 1);
        assert_int_equal(hp_get16(bytes + HP_AT_HEADER_status), HP_OK);
    }
    free(bytes);
}

/* ---- several clients ---- */

static void clients_have_boards_at_the_same_time_and_in_turn(void **state) {
    (void)state;
    serving *s = prepared(2);
    hpt_script script = script_of(2);
    start(s);
    assert_string_equal(hp_usbip_busid(s->server, 0), "1-1");
    assert_string_equal(hp_usbip_busid(s->server, 1), "1-2");
    assert_null(hp_usbip_busid(s->server, 2));
    for (unsigned turn = 0; turn < 3; turn++) {
        int one = dial_attached(s, "1-1"), other = dial_attached(s, "1-2"), third = dial(s);
        assert_int_equal(dial_import(third, "1-2"), 2);
        dial_play(one, 2, &script);
        dial_play(other, 3, &script);
        close(one);
        for (unsigned ms = 0; dial_import(third, "1-1") != 0; ms++) {
            assert_true(ms < PATIENCE_MS);
            sleep_ms(1);
        }
        dial_play(third, 2, &script);
        clear_log(s);
        close(other);
        close(third);
        while (dial_import(other = dial(s), "1-2")) close(other);
        close(other);
        wait_for_line(s, "detached from 1-2 (B): the client has closed");
        wait_for_line(s, "detached from 1-1 (A)");
    }
    hpt_script_free(&script);
    stop(s);
}

/* A client that breaks the rules is ended; one beside it notices nothing. */
static void one_client_s_faults_are_no_other_s(void **state) {
    (void)state;
    serving *s = prepared(2);
    hpt_script script = script_of(1);
    uint8_t head[HEAD] = {0xFF};
    start(s);
    int good = dial_attached(s, "1-1"), bad = dial_attached(s, "1-2");
    dial_play(good, 2, &script);
    write_all(bad, head, HEAD);
    assert_true(has_ended(bad));
    close(bad);
    wait_for_line(s, "detached from 1-2 (B): device 0, which it has not imported");
    bad = dial(s);
    write_all(bad, (const uint8_t *)"GET / HTTP/1.1\r\n\r\n", 18);
    assert_true(has_ended(bad));
    close(bad);
    wait_for_line(s, "ended: USB/IP version 4745, not 0111");
    dial_play(good, 2, &script);
    bad = dial_attached(s, "1-2"); /* the board is free again */
    close(bad);
    close(good);
    hpt_script_free(&script);
    stop(s);
}

/* Who asks and then says that it will say no more still gets its answer. */
static void a_half_closed_connection_is_answered(void **state) {
    (void)state;
    serving *s = prepared(1);
    uint8_t bytes[12 + DEVICE + 8 + 1];
    start(s);
    int fd = dial(s);
    write_all(fd, list_request, 8);
    shutdown(fd, SHUT_WR);
    assert_int_equal(read_until(fd, bytes, sizeof bytes), sizeof bytes - 1);
    close(fd);
    stop(s);
}

/* One query, answered in many packets into urbs that all wait: nobody says more, and the board goes on. */
static void much_work_goes_on_by_itself(void **state) {
    (void)state;
    enum { MANY = 400, RECORDS = 10 };
    serving *s = prepared(1);
    hpt_script script = script_of(0);
    hpt_query all = hpt_query_all(HP_MODE_ALL, TRIANGLES, RAYS, rays);
    hpt_ask(&script, &all);
    s->gadgets[0].board.config.packet_results = RECORDS;
    start(s);
    int fd = dial_attached(s, "1-1");
    hpt_packet query = script.packets[2];
    uint8_t head[HEAD], bytes[1024];
    script.count = 2;
    dial_play(fd, 2, &script);
    script.count = 3;
    for (uint32_t i = 0; i < MANY; i++) {
        make_submit(head, 1000000 + i, &(submit){.endpoint = 1, .direction = IN, .length = 1024});
        write_all(fd, head, HEAD);
    }
    make_submit(head, 1, &(submit){.endpoint = 1, .flags = 0x40, .length = (uint32_t)query.n});
    write_all(fd, head, HEAD);
    write_all(fd, query.bytes, query.n);
    for (uint32_t i = 0, answers = 0; i <= MANY; i++) {
        read_all(fd, head, HEAD);
        if (get(head + 4) == 1) continue;
        assert_int_equal(get(head + 4), 1000000 + answers);
        read_all(fd, bytes, get(head + 24));
        assert_int_equal(hp_get64(bytes + HP_HEADER_BYTES + HP_AT_RESULT_first), RECORDS * answers++);
    }
    close(fd);
    hpt_script_free(&script);
    stop(s);
}

/* ---- time ---- */

static uint64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

static void who_never_asks_is_ended(void **state) {
    (void)state;
    serving *s = prepared(1);
    s->def.limits.handshake_ms = 100;
    start(s);
    uint64_t begin = now_ms();
    int silent = dial(s), half = dial(s);
    write_all(half, list_request, 5);
    assert_true(has_ended(silent));
    assert_true(has_ended(half));
    assert_in_range(now_ms() - begin, 90, 2000);
    close(silent);
    close(half);
    stop(s);
}

/* A byte now and then is no request. */
static void a_handshake_byte_by_byte_is_ended(void **state) {
    (void)state;
    serving *s = prepared(1);
    s->def.limits.handshake_ms = 150;
    start(s);
    int fd = dial(s);
    unsigned sent = 0;
    struct pollfd wait = {.fd = fd, .events = POLLIN};
    for (; sent < 7 && poll(&wait, 1, 50) == 0; sent++) write_all(fd, list_request + sent, 1);
    assert_true(has_ended(fd));
    assert_true(sent < 7);
    close(fd);
    stop(s);
}

static void half_a_message_is_not_waited_for_but_silence_is(void **state) {
    (void)state;
    serving *s = prepared(2);
    hpt_script script = script_of(1);
    s->def.limits.stuck_ms = 100;
    s->def.limits.handshake_ms = 100;
    start(s);
    int half = dial_attached(s, "1-1"), idle = dial_attached(s, "1-2");
    uint8_t head[HEAD];
    make_submit(head, 1, &(submit){.endpoint = 1, .length = 1000});
    write_all(half, head, HEAD);
    write_all(half, head, 20);
    assert_true(has_ended(half));
    wait_for_line(s, "detached from 1-1 (A): the client does not go on");
    sleep_ms(200);
    dial_play(idle, 3, &script);
    close(half);
    close(idle);
    hpt_script_free(&script);
    stop(s);
}

/* Replies pile up: the server stops reading, and ends the client when it does not fetch them. Memory stays. */
static void who_never_fetches_is_ended(void **state) {
    (void)state;
    const uint8_t setup[8] = {0x80, 6, 0, 2, 0, 0, 0, 1};
    serving *s = prepared(1);
    s->def.limits.stuck_ms = 200;
    start(s);
    int fd = dial_attached(s, "1-1");
    uint8_t head[HEAD];
    size_t said = 0;
    uint64_t begin = now_ms();
    for (uint32_t i = 0;; i++, said += HEAD) {
        make_submit(head, i, &(submit){.setup = setup, .direction = IN, .length = 256});
        if (send(fd, head, HEAD, MSG_NOSIGNAL) != HEAD) break;
        assert_true(said < 256u << 20 && now_ms() - begin < PATIENCE_MS);
    }
    wait_for_line(s, "detached from 1-1 (A): the client does not go on");
    close(fd);
    stop(s);
}

/* ---- room ---- */

static void guests_are_few_and_others_wait(void **state) {
    (void)state;
    serving *s = prepared(1);
    s->def.limits.guests = 2;
    s->def.limits.handshake_ms = 300;
    start(s);
    int guests[2] = {dial(s), dial(s)};
    sleep_ms(50);
    int waits = dial(s);
    uint8_t bytes[12 + DEVICE + 8];
    write_all(waits, list_request, 8);
    struct pollfd wait = {.fd = waits, .events = POLLIN};
    assert_int_equal(poll(&wait, 1, 100), 0);
    read_all(waits, bytes, sizeof bytes); /* when the others have had their time */
    for (unsigned i = 0; i < 2; i++) close(guests[i]);
    close(waits);
    stop(s);
}

/* Many who come and go at once, and one who works meanwhile. */
static void a_flood_of_connections_passes(void **state) {
    (void)state;
    serving *s = prepared(1);
    hpt_script script = script_of(1);
    start(s);
    int worker = dial_attached(s, "1-1");
    for (unsigned i = 0; i < 300; i++) {
        int fd = dial(s);
        uint8_t some[8];
        if (i % 3 == 0) write_all(fd, list_request, 8);
        if (i % 3 == 1) write_all(fd, (const uint8_t *)"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 8);
        if (i % 6 == 0) read_all(fd, some, 8);
        close(fd);
    }
    dial_play(worker, 2, &script);
    close(worker);
    hpt_script_free(&script);
    stop(s);
}

/* ---- waiting ---- */

static void waiting_takes_no_time(void **state) {
    (void)state;
    serving *s = prepared(1);
    clockid_t clock;
    struct timespec before, after;
    start(s);
    int fd = dial_attached(s, "1-1");
    uint8_t head[HEAD];
    const uint8_t setup[8] = {0, 9, 1};
    exchange(fd, 2, (submit){.setup = setup}, NULL, 0);
    make_submit(head, 1000000, &(submit){.endpoint = 1, .direction = IN, .length = ROOM});
    write_all(fd, head, HEAD);
    sleep_ms(50);
    assert_int_equal(pthread_getcpuclockid(s->thread, &clock), 0);
    clock_gettime(clock, &before);
    sleep_ms(500);
    clock_gettime(clock, &after);
    long ns = (after.tv_sec - before.tv_sec) * 1000000000L + after.tv_nsec - before.tv_nsec;
    assert_in_range(ns, 0, 5000000); /* a hundredth */
    close(fd);
    stop(s);
}

/* ---- beginning and end ---- */

static void once_is_one_client(void **state) {
    (void)state;
    serving *s = prepared(1);
    hpt_script script = script_of(0);
    s->def.once = true;
    start(s);
    int fd = dial(s);
    assert_int_equal(dial_import(fd, "2-1"), 4); /* that was none */
    close(fd);
    fd = dial_attached(s, "1-1");
    dial_play(fd, 2, &script);
    close(fd);
    hpt_script_free(&script);
    finish(s);
}

/* It stops at once, also in the middle of everything. */
static void stop_ends_everything(void **state) {
    (void)state;
    serving *s = prepared(2);
    start(s);
    int fd = dial_attached(s, "1-1"), guest = dial(s);
    uint8_t head[HEAD];
    make_submit(head, 1, &(submit){.endpoint = 1, .direction = IN, .length = ROOM});
    write_all(fd, head, HEAD);
    hp_usbip_stop(s->server);
    hp_usbip_stop(s->server);
    finish(s);
    assert_true(has_ended(fd));
    assert_true(has_ended(guest));
    close(fd);
    close(guest);
}

static void expect_refusal(const hp_usbip_def *def, hp_status status, const char *words) {
    char why[HP_USBIP_MESSAGE] = "";
    hp_usbip_server *server;
    assert_int_equal(hp_usbip_create(def, &server, why), status);
    assert_null(server);
    if (!strstr(why, words)) fail_msg("no \"%s\" in \"%s\"", words, why);
}

static void a_server_that_cannot_be_is_refused(void **state) {
    (void)state;
    serving *s = prepared(3);
    hp_usbip_def def = s->def;
    def.count = 0;
    expect_refusal(&def, HP_ERROR_USAGE, "0 boards");
    def.count = HP_USBIP_BOARDS + 1;
    expect_refusal(&def, HP_ERROR_USAGE, "65 boards");
    def.count = 3;
    def.port = 65536;
    expect_refusal(&def, HP_ERROR_USAGE, "65536");
    def.port = 0;
    def.address = "300.1.1.1";
    expect_refusal(&def, HP_ERROR_USAGE, "300.1.1.1");
    def.address = "192.0.2.1"; /* of no machine: RFC 5737 */
    expect_refusal(&def, HP_ERROR_IO, "cannot listen on 192.0.2.1");
    def.address = NULL;
    s->gadgets[2].serial = "A";
    expect_refusal(&def, HP_ERROR_USAGE, "two boards with serial number A");
    s->gadgets[2].serial = "A B";
    expect_refusal(&def, HP_ERROR_USAGE, "\"A B\"");
    s->gadgets[2].serial = "C";
    s->gadgets[2].board.config.lanes = 0;
    expect_refusal(&def, HP_ERROR_CONFIG, "cannot make the board");
    s->gadgets[2].board.config.lanes = 1;
    start(s);
    def.port = hp_usbip_port(s->server);
    expect_refusal(&def, HP_ERROR_IO, "cannot listen on 127.0.0.1");
    assert_int_equal(strncmp(hp_usbip_address(s->server), "127.0.0.1:", 10), 0);
    assert_int_equal(atoi(hp_usbip_address(s->server) + 10), def.port);
    stop(s);
    hp_usbip_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(boards_are_listed),
                                       cmocka_unit_test(a_board_is_imported_by_one_client),
                                       cmocka_unit_test(a_descriptor_comes_as_these_bytes),
                                       cmocka_unit_test(queries_are_answered),
                                       cmocka_unit_test(urbs_end_as_linux_has_it),
                                       cmocka_unit_test(zero_length_packets_are_asked_for),
                                       cmocka_unit_test(unlinked_urbs_do_not_return),
                                       cmocka_unit_test(golden_vectors_have_the_same_bits),
                                       cmocka_unit_test(a_lost_connection_frees_the_board),
                                       cmocka_unit_test(a_session_may_end_at_every_byte),
                                       cmocka_unit_test(requests_that_are_none_end_the_client),
                                       cmocka_unit_test(urbs_that_are_none_end_the_client),
                                       cmocka_unit_test(a_control_request_has_one_direction),
                                       cmocka_unit_test(garbage_ends_the_client_at_most),
                                       cmocka_unit_test(pending_urbs_are_limited),
                                       cmocka_unit_test(pending_bytes_are_limited),
                                       cmocka_unit_test(who_does_not_listen_is_not_listened_to),
                                       cmocka_unit_test(clients_have_boards_at_the_same_time_and_in_turn),
                                       cmocka_unit_test(one_client_s_faults_are_no_other_s),
                                       cmocka_unit_test(a_half_closed_connection_is_answered),
                                       cmocka_unit_test(much_work_goes_on_by_itself),
                                       cmocka_unit_test(who_never_asks_is_ended),
                                       cmocka_unit_test(a_handshake_byte_by_byte_is_ended),
                                       cmocka_unit_test(half_a_message_is_not_waited_for_but_silence_is),
                                       cmocka_unit_test(who_never_fetches_is_ended),
                                       cmocka_unit_test(guests_are_few_and_others_wait),
                                       cmocka_unit_test(a_flood_of_connections_passes),
                                       cmocka_unit_test(waiting_takes_no_time),
                                       cmocka_unit_test(once_is_one_client),
                                       cmocka_unit_test(stop_ends_everything),
                                       cmocka_unit_test(a_server_that_cannot_be_is_refused)};
    return cmocka_run_group_tests(tests, make_input, NULL);
}
