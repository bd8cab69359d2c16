#include "testbench/peers/sample.h"

#include "testbench/support/pair_cases.h"

#include <hitpipe/pipe.h>
#include <math.h>
#include <stdlib.h>

enum { SEED = 1997 };
static const hpt_class classes[SAMPLE_CLASSES] = {HPT_RANDOM, HPT_GRAZING};

static void *room(size_t n, size_t size) {
    void *memory = calloc(n, size);
    if (!memory) abort();
    return memory;
}

sample sample_draw(hp_pair pair, unsigned class, unsigned count) {
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
        hpt_draw_pair(&random, pair, classes[class], i, primary, secondary);
        s.ours[i] = hp_pipe_test(pair, HP_GRADUAL, true, primary, secondary, i);
        s.truths[i] = hpt_truth_of(pair, primary, secondary);
    }
    return s;
}

void sample_free(sample *s) {
    free(s->primaries);
    free(s->secondaries);
    free(s->ours);
    free(s->truths);
    free(s->theirs);
}

void sample_ask(const sample *s, const peer *row) {
    void *primaries = row->make_primaries(s->primaries, s->count);
    void *secondaries = row->make_secondaries(s->secondaries, s->count);
    row->zip(primaries, secondaries, s->count, s->theirs);
    row->free_primaries(primaries);
    row->free_secondaries(secondaries);
}

double sample_exact_T(hp_pair pair, const hpt_truth *truth, bool F) {
    if (F && hp_pair_primary(pair) == HP_RAY) return truth->crosses ? truth->t : NAN;
    return fabs(truth->signed_distance);
}

double sample_scaled(hp_pair pair, const hpt_truth *truth, bool F, double T) {
    double size = fmax(truth->L, truth->C);
    bool ray = hp_pair_primary(pair) == HP_RAY;
    return F && ray ? T * truth->length * truth->cosine / size : T / size;
}
