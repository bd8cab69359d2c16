/* Who agrees with whom, over pairs of the classes random and grazing; and where two differ, who is right by the
 * oracle.
 *
 * F: the same; not the same, but the pair is within design's band of touching, where either will do; not the same,
 * and one of them is right. T is compared where both have the same F and the function says it: the same when the
 * lengths they stand for are within NEAR of max(L, C) of each other (rays: and over 1/|cos|), and right when within
 * as much of the exact one. */
#include "testbench/peers/peers.h"
#include "testbench/reference/truth.h"
#include "testbench/support/pair_cases.h"

#include <hitpipe/pipe.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { CLASSES = 2, ROWS_MAX = 32, SEED = 1997 };
static const hpt_class classes[CLASSES] = {HPT_RANDOM, HPT_GRAZING};
static const double NEAR = 1e-5;

typedef struct tally {
    unsigned same, band, ours, theirs, failed; /* F */
    unsigned T_same, T_ours, T_theirs, T_neither;
    unsigned errors; /* of their T, where it was compared */
    double *error, our_worst;
} tally;

/* One class of one pair. */
typedef struct sample {
    hp_pair pair;
    unsigned count;
    float *primaries, *secondaries;
    hp_result *ours;
    hpt_truth *truths;
    peer_answer *theirs;
} sample;

static void *room(size_t n, size_t size) {
    void *memory = calloc(n, size);
    if (!memory) abort();
    return memory;
}

static sample draw_sample(hp_pair pair, hpt_class class, unsigned count) {
    unsigned a = hp_object_words(hp_pair_primary(pair)), b = hp_object_words(hp_pair_secondary(pair));
    sample s = {.pair = pair,
                .count = count,
                .primaries = room((size_t)count * a, sizeof(float)),
                .secondaries = room((size_t)count * b, sizeof(float)),
                .ours = room(count, sizeof *s.ours),
                .truths = room(count, sizeof *s.truths),
                .theirs = room(count, sizeof *s.theirs)};
    hpt_random random = hpt_random_seed(SEED + pair);
    for (unsigned i = 0; i < count; i++) {
        float *primary = s.primaries + (size_t)i * a, *secondary = s.secondaries + (size_t)i * b;
        hpt_draw_pair(&random, pair, class, i, primary, secondary);
        s.ours[i] = hp_pipe_test(pair, HP_GRADUAL, true, primary, secondary, i);
        s.truths[i] = hpt_truth_of(pair, primary, secondary);
    }
    return s;
}

static void free_sample(sample *s) {
    free(s->primaries);
    free(s->secondaries);
    free(s->ours);
    free(s->truths);
    free(s->theirs);
}

/* A length of T over max(L, C). */
static double scaled(hp_pair pair, const hpt_truth *truth, bool F, double T) {
    double size = fmax(truth->L, truth->C);
    bool ray = hp_pair_primary(pair) == HP_RAY;
    return F && ray ? T * truth->length * truth->cosine / size : T / size;
}

static double exact_T(hp_pair pair, const hpt_truth *truth, bool F) {
    if (F && hp_pair_primary(pair) == HP_RAY) return truth->crosses ? truth->t : NAN;
    return fabs(truth->signed_distance);
}

static void compare_T(tally *t, hp_pair pair, const hpt_truth *truth, bool F, double ours, double theirs) {
    double exact = exact_T(pair, truth, F);
    double our_error = fabs(scaled(pair, truth, F, ours - exact));
    double their_error = fabs(scaled(pair, truth, F, theirs - exact));
    if (isnan(theirs) || !(our_error < INFINITY)) return; /* the latter: within the band, and a miss to the oracle */
    t->error[t->errors++] = their_error;
    t->our_worst = fmax(t->our_worst, our_error);
    if (fabs(scaled(pair, truth, F, ours - theirs)) <= NEAR)
        t->T_same++;
    else if (our_error <= NEAR)
        t->T_ours++;
    else if (their_error <= NEAR)
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
    tally t = {.error = room(s->count, sizeof *t.error)};
    void *primaries = row->make_primaries(s->primaries, s->count);
    void *secondaries = row->make_secondaries(s->secondaries, s->count);
    row->zip(primaries, secondaries, s->count, s->theirs);
    for (unsigned i = 0; i < s->count; i++) compare(&t, s, row, i);
    row->free_primaries(primaries);
    row->free_secondaries(secondaries);
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
    tally t[CLASSES];
    unsigned failed = 0;
    for (unsigned c = 0; c < CLASSES; c++) {
        t[c] = compare_all(&samples[c], row);
        failed += t[c].failed;
        printf(" %u, %u, %u, %u |", t[c].same, t[c].band, t[c].ours, t[c].theirs);
    }
    for (unsigned c = 0; c < CLASSES; c++) {
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
        count, NEAR);
    for (unsigned i = 0; i < n; i++) {
        sample samples[CLASSES];
        for (unsigned c = 0; c < CLASSES; c++) samples[c] = draw_sample(pairs[i], classes[c], count);
        peers_of(pairs[i], print_peer, &(printing){samples});
        for (unsigned c = 0; c < CLASSES; c++) free_sample(&samples[c]);
    }
}
