/* A pipe's answer before the oracle: is the flag right, and how far off are T and CP? Any thread. */
#ifndef TESTBENCH_REFERENCE_JUDGE_H
#define TESTBENCH_REFERENCE_JUDGE_H

#include "truth.h"

/* An answer, in any number system. */
typedef struct hpt_given {
    bool F;
    double T, CP[3];
} hpt_given;

typedef struct hpt_verdict {
    bool right;              /* F is the exact one */
    bool within;             /* it is not, but the pair touches within design's band: either flag will do */
    bool measured;           /* F = 1, and an exact T exists: T_error and CP_error are. Of volumes: rightly or
                                within the band */
    bool separated;          /* F = 0, rightly or within the band, with `separation`: separation_error is */
    double T_error;          /* of a hit, as a length over max(L, C); ray pairs: over 1/|cos| too. Else 0 */
    double separation_error; /* of a miss, over max(L, C). Else 0 */
    double CP_error; /* of a hit: distance of CP from the farther of the two objects, over max(L, C). Ray pairs:
                        from the exact point, over 1/|cos| too. Else 0 */
    double margin;   /* where F is wrong: how far from touching, as a fraction of the band; > 1 is outside */
} hpt_verdict;

/* `separation`: T of a miss is to be the distance. */
hpt_verdict hpt_judge(hp_pair pair, const float *primary, const float *secondary, const hpt_truth *truth,
                      bool separation, const hpt_given *given);

/* The same of a record without separation, and the oracle asked on the way. */
hpt_verdict hpt_judge_result(hp_pair pair, const float *primary, const float *secondary, const hp_result *answer);

/* Verdicts added up. Begin with zeros. */
typedef struct hpt_tally {
    unsigned count, hits;
    unsigned within, outside; /* wrong flags inside and outside the band */
    double worst_T, worst_CP, worst_margin;
} hpt_tally;

void hpt_tally_add(hpt_tally *tally, const hp_result *answer, const hpt_verdict *verdict);

#endif
