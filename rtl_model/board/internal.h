/* The inside of a board: what both engines share. Everything here acts in no time; the engines say when. */
#ifndef HITPIPE_INTERNAL_H
#define HITPIPE_INTERNAL_H

#include "answer.h"
#include "rtl_model/clock/engine.h"
#include "rtl_model/link/link.h"
#include "rtl_model/memory/ddr.h"

/* A transfer of the host that has not crossed the link. */
typedef struct hp_inbound {
    struct hp_inbound *next;
    const uint8_t *bytes;
    size_t n;
} hp_inbound;

/* A packet on the board, from its arrival to the end of its command. */
typedef struct hp_held {
    struct hp_held *next;
    bool lost; /* there was no buffer: only its header is here */
    size_t n;
    _Alignas(16) uint8_t bytes[];
} hp_held;

/* Of one pipe, read off its operator graph. */
typedef struct hp_pipe_times {
    unsigned clocks, interval; /* 0: not read yet */
} hp_pipe_times;

struct hp_board {
    hp_config config;
    hp_board_def def;
    const hp_engine *engine;
    void *state; /* the engine's own */
    const char *isa;
    unsigned threads;
    hp_pipe_times pipe_times[2][32];           /* by separation and pair; of those that were used */
    unsigned transformer_clocks[HP_PLANE + 1]; /* by object */
    hp_session session;
    hp_ddr ddr;
    hp_inbound *inbound, **inbound_end;
    unsigned inbound_count;
    hp_held *held, **held_end; /* the oldest is the one under decoding or carried out */
    unsigned held_count;
    unsigned buffers_taken;            /* of config.packet_buffers: held packets but those that were lost */
    hp_answer *answers, **answers_end; /* known to the link; the oldest may be on its way */
    hp_command command;                /* the one carried out */
    hp_query *query;                   /* of a QUERY carried out */
    uint64_t clock;                    /* the present one */
    hp_counters counters;              /* of the clocks before it */
    uint8_t *packet;                   /* HP_BOARD_SENT: the bytes */
    bool sent, received;               /* events of the present clock that the host has not seen */
    size_t sent_bytes;
    uint64_t next_clock_hz; /* from the next HELLO on */
    hp_health health;
    uint64_t busy_clocks;                   /* clocks in which a command was carried out, since power-up */
    uint64_t warmed_at, warmed_busy_clocks; /* clock and busy_clocks that health.celsius is of */
};

/* The times of the query's pipe, with what it was asked for. Read when a pipe is first used: a pipe that is not used
 * costs nothing. Clocks 0: out of memory. */
hp_pipe_times hp_board_pipe(hp_board *board, const hp_query *query);

/* What the selector has selected for a query. With and without separation are two pipes to it. */
static inline unsigned hp_selection(const hp_query *query) {
    return (unsigned)query->pair << 1 | query->separation;
}

/* ---- what happens at the start of a clock ---- */

/* The oldest transfer of the host has arrived; so has the oldest answer. */
void hp_board_received(hp_board *board);
void hp_board_answered(hp_board *board);

/* ---- commands ---- */

/* Begins the command of the oldest packet: decodes it, and does what it does to session and scene. */
void hp_command_begin(hp_board *board);
/* Ends it: the answer becomes known, counters are cleared, the packet's buffer is free. */
void hp_command_end(hp_board *board);
/* Forgets the oldest packet held. */
void hp_held_drop(hp_board *board);
/* There is no memory to carry out the query: the command becomes an ERROR. */
void hp_query_refuse(hp_board *board);
/* Objects in an UPLOAD's payload, and its first. */
uint32_t hp_upload_count(const hp_command *command);
uint32_t hp_upload_first(const hp_command *command);

/* Makes a RESULT with records [first, first + count) of the present query known to the link. */
void hp_result_known(hp_board *board, uint64_t first, uint32_t count, bool last);

/* ---- health ---- */

void hp_health_reset(hp_board *board);

/* ---- counting ---- */

typedef struct hp_busy {
    bool to_board, to_host, decoder, command;
} hp_busy;

/* Counts `clocks` clocks in which these were busy: what does not depend on the inside of a query. */
void hp_board_count(hp_board *board, hp_busy busy, uint64_t clocks);

/* A query ends that has made so many records known and written, and run so many tests: its last RESULT. */
void hp_query_end(hp_board *board, uint64_t known, uint64_t written, uint64_t tests_run);

#endif
