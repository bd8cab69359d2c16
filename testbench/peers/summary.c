/* The same comparison in a row for each pair and library, for docs/peers.md: wrong answers by the oracle, of the
 * library's function that has fewest. F, T of a hit and T of a miss may be the best of three different functions. */
#include "testbench/peers/peers.h"
#include "testbench/peers/sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 32 };

/* T where F is right and the function says T. */
typedef struct lengths {
    unsigned asked, wrong;
    double worst; /* error over max(L, C) */
} lengths;

/* A function's wrong answers; of hitpipe's pipe if there is no row. */
typedef struct faults {
    const peer *row;
    unsigned F[SAMPLE_CLASSES]; /* outside the band of touching; also where it fails */
    lengths T[2];               /* of misses, of hits */
} faults;

typedef struct summary {
    sample samples[SAMPLE_CLASSES];
    faults all[ROWS_MAX];
    unsigned n;
} summary;

static void count_length(lengths *T, hp_pair pair, const hpt_truth *truth, double said) {
    double exact = sample_exact_T(pair, truth, truth->F);
    if (isnan(exact)) return; /* within the band, and the ray passes by */
    double error = fabs(sample_scaled(pair, truth, truth->F, said - exact));
    T->asked++;
    T->wrong += !(error <= SAMPLE_NEAR);
    T->worst = fmax(T->worst, error);
}

static void count_answer(faults *f, unsigned class, const sample *s, unsigned i, peer_answer said) {
    const hpt_truth *truth = &s->truths[i];
    bool right = !said.failed && said.F == truth->F;
    if (!right && (said.failed || fabs(truth->signed_distance) > truth->band)) f->F[class]++;
    bool says = !f->row || (said.F ? f->row->depth : f->row->distance);
    if (right && says) count_length(&f->T[said.F], s->pair, truth, said.T);
}

static void count_all(summary *sum, const peer *row) {
    if (sum->n == ROWS_MAX) abort();
    faults *f = &sum->all[sum->n++];
    *f = (faults){.row = row};
    for (unsigned c = 0; c < SAMPLE_CLASSES; c++) {
        const sample *s = &sum->samples[c];
        if (row) sample_ask(s, row);
        for (unsigned i = 0; i < s->count; i++) {
            peer_answer ours = {s->ours[i].F == 1, false, (double)s->ours[i].T};
            count_answer(f, c, s, i, row ? s->theirs[i] : ours);
        }
    }
}

static void add_peer(const peer *row, void *context) {
    count_all(context, row);
}

/* ---- printing ---- */

static double share(const lengths *T) {
    return T->asked ? (double)T->wrong / T->asked : INFINITY;
}

static double worth(const faults *f, int what) {
    return what < 2 ? share(&f->T[what]) : (double)f->F[0] + f->F[1];
}

/* What: 0 T of misses, 1 T of hits, 2 F. The first of those with fewest faults. NULL: none says it. */
static const faults *best_of(const faults *from, unsigned n, int what) {
    const faults *best = NULL;
    for (const faults *f = from; f < from + n; f++)
        if (worth(f, what) < INFINITY && (!best || worth(f, what) < worth(best, what))) best = f;
    return best;
}

static const char *function_of(const faults *f) {
    return f->row ? f->row->function : "pipe";
}

static void print_lengths(const faults *best, bool hit) {
    if (!best) {
        printf(" | | |");
        return;
    }
    const lengths *T = &best->T[hit];
    printf(" %.*f %% | %.0e | %s |", T->wrong && share(T) < 0.1 ? 2 : 0, 100 * share(T), T->worst, function_of(best));
}

/* What the functions named before say of themselves, each once. */
static void print_notes(const faults *const named[3]) {
    const char *said[3];
    unsigned n = 0;
    for (int i = 0; i < 3; i++) {
        const char *note = named[i] && named[i]->row ? named[i]->row->answers : "";
        bool again = !*note;
        for (unsigned k = 0; k < n; k++) again = again || strcmp(said[k], note) == 0;
        if (!again) said[n++] = note;
    }
    for (unsigned k = 0; k < n; k++) printf("%s%s", k ? "; " : " ", said[k]);
    puts(" |");
}

static void print_library(hp_pair pair, const char *name, const faults *from, unsigned n) {
    const faults *named[3] = {best_of(from, n, 2), best_of(from, n, 1), best_of(from, n, 0)};
    printf("| %s | %s | %u | %u | %s |", hp_pair_name(pair), name, named[0]->F[0], named[0]->F[1],
           function_of(named[0]));
    print_lengths(named[1], true);
    print_lengths(named[2], false);
    print_notes(named);
}

static const char *library_of(const faults *f) {
    return f->row ? f->row->library : "hitpipe";
}

static void print_pair(const summary *sum) {
    for (unsigned from = 0, to; from < sum->n; from = to) {
        const char *name = library_of(&sum->all[from]);
        for (to = from; to < sum->n && strcmp(library_of(&sum->all[to]), name) == 0; to++) continue;
        print_library(sum->samples[0].pair, name, &sum->all[from], to - from);
    }
}

void peers_print_summary(const hp_pair *pairs, unsigned n, unsigned count) {
    printf("%u pairs of each class.\n\n"
           "| pair | library | F wrong, random | F wrong, grazing | function | T of hits wrong | worst | function | "
           "T of misses wrong | worst | function | differs |\n"
           "|---|---|--:|--:|---|--:|--:|---|--:|--:|---|---|\n",
           count);
    for (unsigned i = 0; i < n; i++) {
        summary sum = {.n = 0};
        for (unsigned c = 0; c < SAMPLE_CLASSES; c++) sum.samples[c] = sample_draw(pairs[i], c, count);
        count_all(&sum, NULL);
        peers_of(pairs[i], add_peer, &sum);
        print_pair(&sum);
        for (unsigned c = 0; c < SAMPLE_CLASSES; c++) sample_free(&sum.samples[c]);
    }
}
