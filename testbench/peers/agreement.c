/* Who agrees with whom, over pairs of the classes random and grazing; and where two differ, who is right by the
 * oracle.
 *
 * F: the same; not the same, but the pair is within design's band of touching, where either will do; not the same,
 * and one of them is right. T is compared where both have the same F and the function says it: the same when the
 * lengths they stand for are within SAMPLE_NEAR of max(L, C) of each other (rays: and over 1/|cos|), and right when
 * within as much of the exact one. */
#include "testbench/peers/peers.h"
#include "testbench/peers/sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct tally {
    unsigned same, band, ours, theirs, failed; /* F */
    unsigned T_same, T_ours, T_theirs, T_neither;
    unsigned errors; /* of their T, where it was compared */
    double *error, our_worst;
} tally;

static void compare_T(tally *t, hp_pair pair, const hpt_truth *truth, bool F, double ours, double theirs) {
    double exact = sample_exact_T(pair, truth, F);
    double our_error = fabs(sample_scaled(pair, truth, F, ours - exact));
    double their_error = fabs(sample_scaled(pair, truth, F, theirs - exact));
    if (isnan(theirs) || !(our_error < INFINITY)) return; /* the latter: within the band, and a miss to the oracle */
    t->error[t->errors++] = their_error;
    t->our_worst = fmax(t->our_worst, our_error);
    if (fabs(sample_scaled(pair, truth, F, ours - theirs)) <= SAMPLE_NEAR)
        t->T_same++;
    else if (our_error <= SAMPLE_NEAR)
        t->T_ours++;
    else if (their_error <= SAMPLE_NEAR)
        t->T_theirs++;
    else
        t->T_neither++;
}

static void compare(tally *t, const sample *s, const peer *row, unsigned i) {
    const hp_result *ours = &s->ours[i];
    const hpt_truth *truth = &s->truths[i];
    const peer_answer *theirs = &s->theirs[i];
    if (theirs->failed)
        t->failed++;
    else if (theirs->F != (ours->F == 1))
        (*(fabs(truth->signed_distance) <= truth->band ? &t->band : theirs->F == truth->F ? &t->theirs : &t->ours))++;
    else {
        t->same++;
        if (ours->F ? row->depth : row->distance)
            compare_T(t, s->pair, truth, ours->F == 1, (double)ours->T, theirs->T);
    }
}

static tally compare_all(const sample *s, const peer *row) {
    tally t = {.error = calloc(s->count, sizeof *t.error)};
    if (!t.error) abort();
    sample_ask(s, row);
    for (unsigned i = 0; i < s->count; i++) compare(&t, s, row, i);
    return t;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_errors(tally *t) {
    if (!t->errors) {
        printf(" | |");
        return;
    }
    qsort(t->error, t->errors, sizeof *t->error, by_value);
    printf(" %.0e, %.0e | %.0e |", t->error[t->errors / 2], t->error[t->errors - 1], t->our_worst);
}

static void print_row(const sample *samples, const peer *row) {
    printf("| %s | %s | %s |", hp_pair_name(row->pair), row->library, row->function);
    tally t[SAMPLE_CLASSES];
    unsigned failed = 0;
    for (unsigned c = 0; c < SAMPLE_CLASSES; c++) {
        t[c] = compare_all(&samples[c], row);
        failed += t[c].failed;
        printf(" %u, %u, %u, %u |", t[c].same, t[c].band, t[c].ours, t[c].theirs);
    }
    for (unsigned c = 0; c < SAMPLE_CLASSES; c++) {
        t[c].errors ? printf(" %u, %u, %u, %u |", t[c].T_same, t[c].T_ours, t[c].T_theirs, t[c].T_neither)
                    : printf(" |");
        if (c == 0) print_errors(&t[c]);
        free(t[c].error);
    }
    printf(failed ? " failed: %u%s" : "%.0u", failed, *row->answers ? "; " : "");
    printf(" %s |\n", row->answers);
}

typedef struct printing {
    const sample *samples;
} printing;

static void print_peer(const peer *row, void *context) {
    print_row(((const printing *)context)->samples, row);
}

void peers_print_agreement(const hp_pair *pairs, unsigned n, unsigned count) {
    printf(
        "%u pairs of each class. F: the same; not, within the band; not, hitpipe right; not, the peer right. T: the "
        "same within %.0e of max(L, C); not, hitpipe right; not, the peer right; neither.\n\n"
        "| pair | library | function | F, random | F, grazing | T, random | error of T, random: median, worst | of "
        "hitpipe: worst | T, grazing | notes |\n|---|---|---|---|---|---|---|---|---|---|\n",
        count, SAMPLE_NEAR);
    for (unsigned i = 0; i < n; i++) {
        sample samples[SAMPLE_CLASSES];
        for (unsigned c = 0; c < SAMPLE_CLASSES; c++) samples[c] = sample_draw(pairs[i], c, count);
        peers_of(pairs[i], print_peer, &(printing){samples});
        for (unsigned c = 0; c < SAMPLE_CLASSES; c++) sample_free(&samples[c]);
    }
}
