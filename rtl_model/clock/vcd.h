/* The waveform of the clocked engine, as a value change dump (IEEE 1364-2005, clause 18): GTKWave and others read it.
 */
#ifndef HITPIPE_VCD_H
#define HITPIPE_VCD_H

#include "clocked.h"

/* What stood at the start of a clock and is changed in it. */
typedef struct hp_probe {
    bool inbound, answer, result,
        packet;                        /* there is a transfer, an answer, one with records, a packet to be decoded */
    bool to_board, to_host, decoding;  /* which move */
    bool wanted, test, output, record; /* a beat, a test ready, a result in the output register, a record */
    bool tests, rested;                /* a query streams; its pipe's interval has passed */
    bool records;                      /* the query's tests leave records */
    hp_activity activity;
    uint64_t level, held; /* of the secondary register file and the SRAMs */
} hp_probe;

typedef struct hp_vcd hp_vcd;

/* NULL: out of memory. Writes the header. */
hp_vcd *hp_vcd_create(const hp_board *board);
/* Writes what is still in the buffer, and the clock reached. */
void hp_vcd_destroy(hp_vcd *vcd, const hp_board *board);

/* Call at the start of each clock, and at its end. */
void hp_vcd_probe(hp_vcd *vcd, const hp_board *board);
void hp_vcd_dump(hp_vcd *vcd, const hp_board *board);

#endif
