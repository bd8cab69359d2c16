/* The host's side of a board under test: makes packets byte by byte, sends them, and takes what the board answers.
 *
 * A script is a list of packets; playing it keeps so many of them in flight. Everything fails with a message, by
 * cmocka, where a test could not go on. */
#ifndef TESTBENCH_SUPPORT_BOARD_HOST_H
#define TESTBENCH_SUPPORT_BOARD_HOST_H

#include <hitpipe/board.h>
#include <hitpipe/packet.h>
#include <stdbool.h>

typedef struct hpt_packet {
    uint8_t *bytes;
    size_t n;
} hpt_packet;

typedef struct hpt_script {
    hpt_packet *packets;
    size_t count, room;
    uint32_t sequence; /* of the next packet */
    uint32_t tag;
} hpt_script;

void hpt_script_free(hpt_script *script);

/* Each of these appends a packet, sealed and in sequence. */
void hpt_hello(hpt_script *script);
void hpt_upload(hpt_script *script, hp_object object, uint32_t first, uint32_t count, const float *words);
void hpt_transform(hpt_script *script, const float matrix[12]); /* NULL: off */
void hpt_counters(hpt_script *script, bool clear);

typedef struct hpt_query {
    hp_pair pair;
    hp_mode mode;
    uint32_t options;
    uint32_t first, count, primaries;
    uint32_t stencil[8];
    const float *words; /* of the primaries */
} hpt_query;
/* A query of ray-triangle in which all take part. */
hpt_query hpt_query_all(hp_mode mode, uint32_t count, uint32_t primaries, const float *rays);
void hpt_ask(hpt_script *script, const hpt_query *query);

/* Appends any packet: `payload` of `length` bytes behind a header with this opcode, in sequence. */
uint8_t *hpt_append(hpt_script *script, unsigned opcode, uint32_t length);
/* Seals the packet appended last again, after its bytes were changed; `header` is what it should say. */
hp_header hpt_header(const hpt_script *script, unsigned opcode, uint32_t length);
void hpt_reseal(hpt_script *script, const hp_header *header);

/* An event of the board, with what stood in the counters. */
typedef struct hpt_event {
    hp_board_event_kind kind;
    uint64_t clock;
    uint8_t *bytes;
    size_t n;
    hp_counters counters;
} hpt_event;

typedef struct hpt_log {
    hpt_event *events;
    size_t count, room;
    hp_counters counters; /* at the end */
    uint64_t clock;
} hpt_log;

void hpt_log_free(hpt_log *log);

/* Plays a script on a board with at most `in_flight` packets not answered, until nothing is under way. */
hpt_log hpt_play(const hp_board_def *def, const hpt_script *script, unsigned in_flight);

/* A board of preset "ideal" or another, of one of the engines, one thread. */
hp_board_def hpt_board(const char *preset, hp_engine_kind engine);

/* The n-th packet of this opcode that the board sent; NULL if there are not so many. Its payload, and its bytes if
 * wanted. */
const uint8_t *hpt_answer(const hpt_log *log, unsigned opcode, unsigned n, hp_header *header);

/* The records of all RESULTs with this tag, in order; count in *n. The caller's to free. */
hp_result *hpt_records(const hpt_log *log, uint32_t tag, size_t *n);

/* clocks.total = clocks.issue + all stalls = all phases. */
bool hpt_clocks_add_up(const hp_counters *counters);

/* n rays towards, n triangles in, a cube of this half size around the origin; some degenerate, some the same as
 * the one before. */
void hpt_rays(uint64_t seed, unsigned n, float *rays);
void hpt_triangles(uint64_t seed, unsigned n, float size, float *triangles);

#endif
