/* Pairs of a class with hitpipe's answers, the right ones, and room for a library's: what agreement.c and summary.c
 * count over. */
#ifndef TESTBENCH_PEERS_SAMPLE_H
#define TESTBENCH_PEERS_SAMPLE_H

#include "testbench/peers/peer.h"
#include "testbench/reference/truth.h"

/* T counts as right, or as the same, within this share of max(L, C). */
#define SAMPLE_NEAR 1e-5

enum { SAMPLE_CLASSES = 2 }; /* random, grazing */

typedef struct sample {
    hp_pair pair;
    unsigned count;
    float *primaries, *secondaries;
    hp_result *ours;
    hpt_truth *truths;
    peer_answer *theirs; /* of the row that was asked last */
} sample;

/* The same pairs for the same class on every machine. Out of memory: aborts. */
sample sample_draw(hp_pair pair, unsigned class, unsigned count);
void sample_free(sample *sample);

/* Fills `theirs`. */
void sample_ask(const sample *sample, const peer *row);

/* The T that the table of design promises for that F: of a ray that hits t (NaN where it does not meet the object),
 * else depth or distance. */
double sample_exact_T(hp_pair pair, const hpt_truth *truth, bool F);

/* A difference of two such T as a length over max(L, C); of rays that hit also over 1/|cos| of the incidence. */
double sample_scaled(hp_pair pair, const hpt_truth *truth, bool F, double T);

#endif
