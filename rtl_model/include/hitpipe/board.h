/* The simulated board, as its link sees it: bytes in, bytes out, and a clock.
 *
 * Only the model transport (and later the USB/IP server) include this. One thread at a time per board. */
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

/* Present counters, and the ISA in use ("avx512"). */
hp_counters hp_board_counters(const hp_board *board);
const char *hp_board_isa(const hp_board *board);

#ifdef __cplusplus
}
#endif
#endif
