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
} hpt_row;

hpt_row hpt_row_of(const hpt_sample *sample);

/* What is above its bound: bit 0 for flags, bit 1 + figure for the errors. */
unsigned hpt_row_over(const hpt_row *row);

#endif
