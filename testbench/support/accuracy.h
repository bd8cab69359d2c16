/* How far the pipes are from the truth: many pairs of one class through a pipe, its text in binary128 and the oracle.
 *
 * The pairs of a class are the same whatever their number and however many threads work on them: a run on fewer is
 * the beginning of a longer one. */
#ifndef TESTBENCH_SUPPORT_ACCURACY_H
#define TESTBENCH_SUPPORT_ACCURACY_H

#include <pthread.h>

#include "pair_cases.h"
#include "testbench/reference/judge.h"

/* One pair and what was made of it. */
typedef struct hpt_record {
    float primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX];
    hp_result result; /* with the distance of a miss */
    hpt_truth truth;
    hpt_verdict verdict, in_quad;
} hpt_record;

typedef struct hpt_sample {
    hp_pair pair;
    hpt_class class;
    unsigned count;
    bool quad; /* binary128 too */
    hpt_record *records;
    unsigned next; /* not given out to a thread yet */
    pthread_mutex_t lock;
} hpt_sample;

/* Draws and measures all records, in two threads. Aborts when out of memory. */
hpt_sample *hpt_sample_new(hp_pair pair, hpt_class class, unsigned count, bool quad);
void hpt_sample_free(hpt_sample *sample);

typedef enum hpt_figure { HPT_OF_T, HPT_OF_SEPARATION, HPT_OF_CP, HPT_FIGURES } hpt_figure;

/* An error, or -1 where there is none to be had. */
double hpt_error_of(const hpt_verdict *verdict, hpt_figure figure);

typedef struct hpt_spread {
    unsigned n;
    double median, high, worst; /* high: all but one in a thousand, rounded up, are no greater */
} hpt_spread;

typedef struct hpt_flags {
    unsigned hits;            /* in truth */
    unsigned within, outside; /* wrong, inside and outside the band */
    unsigned open;            /* certificates of the oracle that did not close */
    double worst;             /* wrong flag, in bands */
} hpt_flags;

/* A row of the table: [0] of the pipe, [1] of its text in binary128. */
typedef struct hpt_row {
    hp_pair pair;
    hpt_class class;
    unsigned count;
    hpt_flags flags[2];
    hpt_spread spread[2][HPT_FIGURES];
    double strain_of_T, strain_of_F; /* ray-triangle: greatest hpt_strain of T, and of wrong flags */
} hpt_row;

hpt_row hpt_row_of(const hpt_sample *sample);

/* What is above its bound: bit 0 for flags, bit 1 + figure for the errors. `quad`: of the text in binary128. */
unsigned hpt_row_over(const hpt_row *row, bool quad);

/* Ray against triangle forms det = e1.(d x e2) as a difference of products of |e1| |e2| |d|. What those are rounded
 * by is of 2^-24 |e1| |e2| |d|, so u, v and t are uncertain by that over |det|, the condition number kappa: u and v
 * as shares of the edges, t as a share of the lengths it is made of. The strain is a length in units of this,
 *
 *   2^-24 kappa (|s| + |t d|) for t,     2^-24 kappa (|s| + |e1| + |e2|) for the place that a flag depends on,
 *
 * s from v0 to the origin. A datapath of the paper's operators that does nothing worse than round has strains of a
 * few units whatever the triangle, while the errors themselves grow with kappa beyond any bound. */
double hpt_strain_of_T(const hpt_record *record);
double hpt_strain_of_F(const hpt_record *record);

/* Whether a row above its bounds is that of the slivers of ray-triangle, with strains of no more than STRAIN units,
 * at most 20 wrong flags in 10,000, and nothing above any bound in binary128. */
enum { HPT_STRAIN = 4 };
bool hpt_row_explained(const hpt_row *row);

#endif
