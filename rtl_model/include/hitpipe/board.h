/* The simulated board, as its link sees it: bytes in, bytes out, and a clock; and what a control plane beside the
 * link does to it.
 *
 * Only the model transport and the USB device side (driver/gadget/, driver/usbip/) include this. One thread at a time
 * per board. */
#ifndef HITPIPE_BOARD_H
#define HITPIPE_BOARD_H

#include <hitpipe/config.h>
#include <hitpipe/counters.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hp_board hp_board;

typedef enum hp_engine_kind { HP_ENGINE_QUICK = 0, HP_ENGINE_CLOCKED = 1 } hp_engine_kind;

/* Takes n bytes of waveform text. */
typedef void hp_vcd_sink(void *context, const char *text, size_t n);

typedef struct hp_board_def {
    hp_config config;
    hp_engine_kind engine;
    const char *isa;  /* as hp_isa_choose; NULL: HP_ISA or the best */
    unsigned threads; /* of the quick engine's arithmetic; 0: as many as there are processors */
    hp_vcd_sink *vcd; /* clocked engine only; NULL: no waveform */
    void *vcd_context;
} hp_board_def;

typedef enum hp_board_event_kind {
    HP_BOARD_IDLE,     /* nothing under way: the board waits for the host */
    HP_BOARD_RECEIVED, /* the oldest transfer of hp_board_send has crossed the link; its bytes may be reused */
    HP_BOARD_SENT      /* `bytes` for the host have crossed the link */
} hp_board_event_kind;

typedef struct hp_board_event {
    hp_board_event_kind kind;
    uint64_t clock;       /* board clock of the event */
    const uint8_t *bytes; /* HP_BOARD_SENT: a packet, valid until the next call on this board */
    size_t n;
} hp_board_event;

/* A board in reset. HP_ERROR_CONFIG, HP_ERROR_MEMORY, HP_ERROR_USAGE (an ISA not to be had, vcd with the quick
 * engine). */
hp_status hp_board_create(const hp_board_def *def, hp_board **board);
void hp_board_destroy(hp_board *board);

/* Hands one transfer (any bytes, normally a packet) to the link at the board's present clock. The bytes stay the
 * caller's and must not change until HP_BOARD_RECEIVED. Transfers cross in order. HP_ERROR_MEMORY when no more can be
 * queued. */
hp_status hp_board_send(hp_board *board, const void *bytes, size_t n);

/* Lets time pass to the next event on the link, and says which. Events come in clock order; of several in one clock,
 * HP_BOARD_SENT first. The host is taken to be infinitely fast: what it sends after an event is sent in that clock.
 */
hp_board_event hp_board_step(hp_board *board);

/* Present counters, the clock that they are of, and the ISA in use ("avx512"). */
hp_counters hp_board_counters(const hp_board *board);
uint64_t hp_board_clock(const hp_board *board);
const char *hp_board_isa(const hp_board *board);

/* ---- beside the link ---- */

/* Puts the board in reset, as after power-up but for its clock, its memory's refresh, hp_health and the clock that
 * hp_board_set_clock chose: what is under way is dropped; session, scene, matrix and counters are forgotten.
 * Transfers of hp_board_send that have not crossed the link, or whose HP_BOARD_RECEIVED was not returned yet, are
 * dropped too: their bytes may be reused, and no event comes for them. */
void hp_board_reset(hp_board *board);

/* Drops, unanswered, the packets whose commands have not begun, and the transfers as hp_board_reset does. The command
 * under way goes on, and so does the session: to the host the packets are lost on the way. */
void hp_board_abort(hp_board *board);

/* The core clock from the next HELLO on. HP_ERROR_FIELD: out of the range of clock_hz in config.def. HP_ERROR_USAGE:
 * a waveform is being written, which has one clock. On error the clock stays what it was to be. */
hp_status hp_board_set_clock(hp_board *board, uint64_t hz);

/* The board's configuration, with the clock in use. */
const hp_config *hp_board_config(const hp_board *board);

/* Counted since power-up, over resets and sessions. */
typedef struct hp_health {
    bool session;      /* a HELLO was taken since power-up or reset */
    double celsius;    /* of the FPGA */
    uint64_t packets;  /* taken, as docs/protocol.md has it */
    uint64_t refused;  /* answered with ERROR */
    uint64_t crc;      /* of those: ERROR CRC */
    uint64_t sequence; /* of those: ERROR SEQUENCE */
} hp_health;

/* The temperature is that of a chip that warms from 35 degrees towards 65 by the share of clocks in which commands
 * were carried out since the last call, with a time constant of a second of board time. */
hp_health hp_board_health(hp_board *board);

#ifdef __cplusplus
}
#endif
#endif
