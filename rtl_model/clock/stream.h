/* A query's way through the blocks, as the quick engine computes it: from a clock, the longest run of clocks in which
 * every block does the same is taken in one step, so time costs what changes, not what passes. docs/timing.md. */
#ifndef HITPIPE_STREAM_H
#define HITPIPE_STREAM_H

#include "rtl_model/memory/ddr_runs.h"
#include "rtl_model/regfile/primary.h"

/* Objects on their way to or in the secondary register file, as runs: object i of a run is ready in clock ready + i *
 * beats. */
typedef struct hp_object_run {
    uint64_t ready;
    uint64_t objects;
    uint64_t refresh, row; /* clocks the first one was held up by, not yet counted as waited */
} hp_object_run;

/* Tests in the pipe, as runs: test i of a run leaves it with move exit + i. */
typedef struct hp_test_run {
    uint64_t exit;
    uint64_t tests;
    unsigned records; /* of each test */
} hp_test_run;

typedef struct hp_stop {
    uint64_t clock; /* the hit is in the update engine */
    unsigned primary;
} hp_stop;

typedef enum hp_stream_phase { HP_STREAM_SELECT, HP_STREAM_TESTS, HP_STREAM_FLUSH, HP_STREAM_END } hp_stream_phase;

typedef struct hp_stream {
    /* fixed for a query */
    const hp_config *config;
    hp_query *query;
    const uint32_t *hit; /* mode any: for each active primary the secondary that stops it, or HP_NO_INDEX */
    bool secondary_outer, records_tests;
    uint64_t beats, latency, interval, read_clocks, packet_records, total;
    unsigned lanes, groups, sweeps;
    uint64_t per_sweep;
    hp_stream_phase phase;
    uint64_t start;   /* first clock */
    uint64_t streams; /* clock s */
    /* reader */
    unsigned read_sweep;
    uint64_t read_beat; /* beats read in this sweep */
    uint64_t outstanding;
    uint64_t refresh, row;  /* held up the object being read */
    hp_object_run *objects; /* ring of config->secondary_depth runs */
    uint64_t objects_head, objects_count;
    /* selector */
    unsigned group;  /* primary-outer: present group; secondary-outer: place in `order` */
    uint64_t object; /* number in its sweep of the oldest object */
    uint64_t issue_from;
    unsigned order[HP_PACKET_PRIMARIES]; /* groups that are not stopped */
    unsigned alive[HP_PACKET_PRIMARIES]; /* primaries of a group that are not stopped */
    unsigned alive_all;
    bool over; /* nothing more to issue */
    /* pipe */
    uint64_t moves, exit; /* clocks it moved; the move with which its last test leaves */
    hp_test_run *tests;   /* ring */
    uint64_t tests_head, tests_count, tests_room;
    uint64_t output; /* records in the output register */
    /* mode any */
    unsigned by_hit[HP_PACKET_PRIMARIES], hits,
        next_hit; /* secondary-outer: primaries by the secondary that stops them */
    hp_stop stops[HP_PACKET_PRIMARIES];
    unsigned stops_head, stops_count;
    /* SRAM */
    uint64_t *sram;   /* records held */
    uint64_t written; /* records of this query written */
    uint64_t known;   /* of them in packets the link knows of */
    bool loose;       /* reading is too broken up for lockstep */
    uint64_t run;     /* tests run */
} hp_stream;

/* Buffers for queries on a board of this configuration. HP_ERROR_MEMORY. */
hp_status hp_stream_create(hp_stream *stream, const hp_config *config);
/* Makes room for a query of a pipe of this latency. HP_ERROR_MEMORY: the stream is as it was. */
hp_status hp_stream_reserve(hp_stream *stream, uint64_t latency);
void hp_stream_free(hp_stream *stream);

typedef struct hp_stream_timing {
    uint64_t clock; /* in which the query begins */
    bool select;    /* the pipe changes */
    uint64_t latency, interval, transformer;
} hp_stream_timing;

void hp_stream_begin(hp_stream *stream, hp_query *query, const uint32_t *hit, hp_stream_timing timing,
                     uint64_t *sram);

/* Carries the query from clock `from` on, to clock `to` at most; earlier when a packet of records is complete
 * (hp_stream_packet) or the query ends (hp_stream_ended). Returns the clock reached. */
uint64_t hp_stream_advance(hp_stream *stream, uint64_t from, uint64_t to, hp_ddr_runs *ddr, hp_counters *counters);

static inline bool hp_stream_ended(const hp_stream *stream) {
    return stream->phase == HP_STREAM_END;
}

/* A full packet of records that is not the last waits to be made known. */
static inline bool hp_stream_packet(const hp_stream *stream) {
    return stream->written - stream->known == stream->packet_records && stream->written < stream->total;
}

#endif
