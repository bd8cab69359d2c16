#include "accuracy.h"

#include <hitpipe/pipe.h>
#include <math.h>
#include <stdlib.h>

#include "rtl_model/pipes/quad.h"

enum { SEED = 3, BATCH = 100, THREADS = 2 };

static void measure(const hpt_sample *s, hpt_record *r) {
    r->truth = hpt_truth_of(s->pair, r->primary, r->secondary);
    r->result = hp_pipe_test(s->pair, HP_GRADUAL, true, r->primary, r->secondary, 0);
    const float *CP = r->result.CP;
    hpt_given given = {r->result.F != 0, r->result.T, {CP[0], CP[1], CP[2]}};
    r->verdict = hpt_judge(s->pair, r->primary, r->secondary, &r->truth, true, &given);
    if (!s->quad) return;
    hp_quad_result q = hp_quad_pipe_test(s->pair, true, r->primary, r->secondary);
    given = (hpt_given){q.F, (double)q.T, {(double)q.CP[0], (double)q.CP[1], (double)q.CP[2]}};
    r->in_quad = hpt_judge(s->pair, r->primary, r->secondary, &r->truth, true, &given);
}

/* Each batch has a sequence of its own. */
static void *work(void *argument) {
    hpt_sample *s = argument;
    for (;;) {
        pthread_mutex_lock(&s->lock);
        unsigned first = s->next;
        s->next += BATCH;
        pthread_mutex_unlock(&s->lock);
        if (first >= s->count) return NULL;
        hpt_random random = hpt_random_seed(((uint64_t)s->pair << 40) + ((uint64_t)s->class << 32) + first + SEED);
        for (unsigned i = first; i < first + BATCH && i < s->count; i++) {
            hpt_draw_pair(&random, s->pair, s->class, i, s->records[i].primary, s->records[i].secondary);
            measure(s, &s->records[i]);
        }
    }
}

hpt_sample *hpt_sample_new(hp_pair pair, hpt_class class, unsigned count, bool quad) {
    pthread_t thread[THREADS];
    hpt_sample *s = calloc(1, sizeof *s);
    if (!s) abort();
    *s = (hpt_sample){.pair = pair, .class = class, .count = count, .quad = quad};
    s->records = calloc(count, sizeof *s->records);
    if (!s->records || pthread_mutex_init(&s->lock, NULL) != 0) abort();
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&thread[i], NULL, work, s) != 0) abort();
    for (int i = 0; i < THREADS; i++) pthread_join(thread[i], NULL);
    return s;
}

void hpt_sample_free(hpt_sample *sample) {
    pthread_mutex_destroy(&sample->lock);
    free(sample->records);
    free(sample);
}

double hpt_error_of(const hpt_verdict *v, hpt_figure figure) {
    if (figure == HPT_OF_SEPARATION) return v->separated ? v->separation_error : -1;
    return !v->measured ? -1 : figure == HPT_OF_T ? v->T_error : v->CP_error;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static const hpt_verdict *verdict_in(const hpt_sample *s, unsigned i, bool quad) {
    return quad ? &s->records[i].in_quad : &s->records[i].verdict;
}

static hpt_spread spread_of(const hpt_sample *s, hpt_figure figure, bool quad) {
    double *error = malloc(s->count * sizeof *error);
    hpt_spread spread = {0};
    if (!error) abort();
    for (unsigned i = 0; i < s->count; i++) {
        double e = hpt_error_of(verdict_in(s, i, quad), figure);
        if (e >= 0) error[spread.n++] = e;
    }
    unsigned n = spread.n, above = (n + 999) / 1000;
    qsort(error, n, sizeof *error, ascending);
    if (n) {
        spread.median = error[n / 2];
        spread.high = error[n > above ? n - 1 - above : n - 1];
        spread.worst = error[n - 1];
    }
    free(error);
    return spread;
}

static hpt_flags flags_of(const hpt_sample *s, bool quad) {
    hpt_flags f = {0};
    for (unsigned i = 0; i < s->count; i++) {
        const hpt_verdict *v = verdict_in(s, i, quad);
        f.hits += s->records[i].truth.F;
        f.within += !v->right && v->within;
        f.outside += !v->right && !v->within;
        f.open += !s->records[i].truth.certified;
        f.worst = fmax(f.worst, v->margin);
    }
    return f;
}

/* ---- ray against triangle ---- */

static double size(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* kappa, and the lengths of edges, way and direction. */
typedef struct condition {
    double kappa, e1, e2, s, d;
} condition;

static condition condition_of(const hpt_record *r) {
    const float *o = r->primary, *v = r->secondary;
    double e1[3], e2[3], s[3], d[3], det = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = (double)o[3 + k];
        s[k] = (double)o[k] - (double)v[k];
        e1[k] = (double)v[3 + k] - (double)v[k];
        e2[k] = (double)v[6 + k] - (double)v[k];
    }
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        det += e1[k] * (d[l] * e2[m] - d[m] * e2[l]);
    }
    condition c = {.e1 = size(e1), .e2 = size(e2), .s = size(s), .d = size(d)};
    c.kappa = c.e1 * c.e2 * c.d / fabs(det);
    return c;
}

double hpt_strain_of_T(const hpt_record *r) {
    double error = hpt_error_of(&r->verdict, HPT_OF_T);
    if (error <= 0) return 0;
    condition c = condition_of(r);
    double length = error * fmax(r->truth.L, r->truth.C) / r->truth.cosine;
    return length / (0x1p-24 * c.kappa * (c.s + fabs(r->truth.t) * c.d));
}

double hpt_strain_of_F(const hpt_record *r) {
    if (r->verdict.right) return 0;
    condition c = condition_of(r);
    return r->verdict.margin * r->truth.band / (0x1p-24 * c.kappa * (c.s + c.e1 + c.e2));
}

static void strain(const hpt_sample *s, hpt_row *row) {
    if (s->pair != HP_PAIR_RAY_TRIANGLE) return;
    for (unsigned i = 0; i < s->count; i++) {
        row->strain_of_T = fmax(row->strain_of_T, hpt_strain_of_T(&s->records[i]));
        row->strain_of_F = fmax(row->strain_of_F, hpt_strain_of_F(&s->records[i]));
    }
}

/* ---- rows ---- */

hpt_row hpt_row_of(const hpt_sample *s) {
    hpt_row row = {.pair = s->pair, .class = s->class, .count = s->count};
    strain(s, &row);
    for (int quad = 0; quad < 1 + s->quad; quad++) {
        row.flags[quad] = flags_of(s, quad);
        for (int i = 0; i < HPT_FIGURES; i++) row.spread[quad][i] = spread_of(s, (hpt_figure)i, quad);
    }
    return row;
}

/* Asked of a class: flags wrong outside the band in 10,000, errors but for one in a thousand and at worst. */
static const struct {
    unsigned wrong;
    double high, worst;
} bounds[HPT_CLASSES] = {
    [HPT_RANDOM] = {0, 1e-6, 1e-5},
    [HPT_GRAZING] = {0, 1e-5, 1e-4},
    [HPT_DEGENERATE] = {1, 1e-5, 1e-4},
    [HPT_OFFSET] = {0, 1e-6, 1e-5},
};

/* At most `most` in 10,000, and in any fewer. */
static bool too_many(const hpt_row *row, unsigned wrong, unsigned most) {
    uint64_t count = row->count < 10000 ? 10000 : row->count;
    return (uint64_t)wrong * 10000 > most * count;
}

unsigned hpt_row_over(const hpt_row *row, bool quad) {
    unsigned over = too_many(row, row->flags[quad].outside, bounds[row->class].wrong);
    for (int i = 0; i < HPT_FIGURES; i++) {
        const hpt_spread *s = &row->spread[quad][i];
        if (s->high > bounds[row->class].high || s->worst > bounds[row->class].worst) over |= 2u << i;
    }
    return over;
}

bool hpt_row_explained(const hpt_row *row) {
    return row->pair == HP_PAIR_RAY_TRIANGLE && row->class == HPT_DEGENERATE && row->strain_of_T <= HPT_STRAIN &&
           row->strain_of_F <= HPT_STRAIN && !too_many(row, row->flags[0].outside, 20) && !hpt_row_over(row, true);
}
