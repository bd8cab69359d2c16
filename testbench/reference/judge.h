/* A pipe's answer before the exact oracle: is the flag right, and how far off are T and CP? Any thread. */
#ifndef TESTBENCH_REFERENCE_JUDGE_H
#define TESTBENCH_REFERENCE_JUDGE_H

#include <hitpipe/types.h>

typedef struct hpt_verdict {
    bool right;      /* F is the exact one */
    bool within;     /* it is not, but the pair touches within design's band: either flag will do */
    bool measured;   /* F = 1, and an exact T exists: the errors below are */
    double T_error;  /* |T - exact| as a length, over max(L, C) and over 1/|cos|; exact_ray_triangle.h says more */
    double CP_error; /* distance of CP from the exact point, over the same */
    double margin;   /* where F is wrong: how far from touching, as a fraction of the band; > 1 is outside */
} hpt_verdict;

hpt_verdict hpt_judge_ray_triangle(const float ray[6], const float triangle[9], const hp_result *answer);

/* Verdicts added up. Begin with zeros. */
typedef struct hpt_tally {
    unsigned count, hits;
    unsigned within, outside; /* wrong flags inside and outside the band */
    double worst_T, worst_CP, worst_margin;
} hpt_tally;

void hpt_tally_add(hpt_tally *tally, const hp_result *answer, const hpt_verdict *verdict);

#endif
