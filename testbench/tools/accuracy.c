/* How far the pipes are from the truth: the table of docs/accuracy.md, or the worst pairs one by one.
 *
 *   accuracy [--count N] [--pair NAME] [--class CLASS] [--worst N] [--no-quad]
 */
#include <errno.h>
#include <hitpipe/pipe.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rtl_model/pipes/quad.h"
#include "testbench/reference/judge.h"
#include "testbench/support/pair_cases.h"

enum { SEED = 3, BATCH = 100, THREADS = 2 };

static const char usage[] =
    "usage: accuracy [--count N] [--pair NAME] [--class CLASS] [--worst N] [--no-quad]\n"
    "  --count N     pairs of each kind and class, default 10000\n"
    "  --pair NAME   obb-obb, ...; default all\n"
    "  --class CLASS random, grazing, degenerate or offset; default all\n"
    "  --worst N     not the table, but the N worst answers: by wrong flag, T, separation and CP\n"
    "  --no-quad     without the columns of the same datapath in binary128\n";

typedef struct options {
    unsigned count, worst;
    hp_pair pair; /* 0: all */
    int class;    /* -1: all */
    bool quad;
} options;

/* One pair and what was made of it. */
typedef struct record {
    float primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX];
    hp_result result;
    hpt_truth truth;
    hpt_verdict verdict, in_quad;
} record;

/* ---- measuring ---- */

typedef struct job {
    hp_pair pair;
    hpt_class class;
    unsigned count, next;
    bool quad;
    record *records;
    pthread_mutex_t lock;
} job;

static void measure(const job *j, record *r) {
    r->truth = hpt_truth_of(j->pair, r->primary, r->secondary);
    r->result = hp_pipe_test(j->pair, HP_GRADUAL, true, r->primary, r->secondary, 0);
    const float *CP = r->result.CP;
    hpt_given given = {r->result.F != 0, r->result.T, {CP[0], CP[1], CP[2]}};
    r->verdict = hpt_judge(j->pair, r->primary, r->secondary, &r->truth, true, &given);
    if (!j->quad) return;
    hp_quad_result q = hp_quad_pipe_test(j->pair, true, r->primary, r->secondary);
    given = (hpt_given){q.F, (double)q.T, {(double)q.CP[0], (double)q.CP[1], (double)q.CP[2]}};
    r->in_quad = hpt_judge(j->pair, r->primary, r->secondary, &r->truth, true, &given);
}

/* Each batch has a sequence of its own, so that the pairs do not depend on threads or on the count. */
static void *work(void *argument) {
    job *j = argument;
    for (;;) {
        pthread_mutex_lock(&j->lock);
        unsigned first = j->next;
        j->next += BATCH;
        pthread_mutex_unlock(&j->lock);
        if (first >= j->count) return NULL;
        hpt_random random = hpt_random_seed(((uint64_t)j->pair << 40) + ((uint64_t)j->class << 32) + first + SEED);
        for (unsigned i = first; i < first + BATCH && i < j->count; i++) {
            hpt_draw_pair(&random, j->pair, j->class, i, j->records[i].primary, j->records[i].secondary);
            measure(j, &j->records[i]);
        }
    }
}

static void measure_all(job *j) {
    pthread_t thread[THREADS];
    j->next = 0;
    pthread_mutex_init(&j->lock, NULL);
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&thread[i], NULL, work, j) != 0) abort();
    for (int i = 0; i < THREADS; i++) pthread_join(thread[i], NULL);
    pthread_mutex_destroy(&j->lock);
}

/* ---- the errors of a row ---- */

typedef enum figure { OF_T, OF_SEPARATION, OF_CP, FIGURES } figure;

static const char *const figure_names[FIGURES] = {"T", "separation", "CP"};

/* The error, or -1 where there is none to be had. */
static double error_in(const hpt_verdict *v, figure which) {
    if (which == OF_SEPARATION) return v->separated ? v->separation_error : -1;
    return !v->measured ? -1 : which == OF_T ? v->T_error : v->CP_error;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct spread {
    unsigned n;
    double median, high, worst; /* high: 99.9 % are no greater */
} spread;

static spread spread_of(const job *j, figure which, bool quad) {
    double *error = malloc(j->count * sizeof *error);
    spread s = {0};
    if (!error) abort();
    for (unsigned i = 0; i < j->count; i++) {
        double e = error_in(quad ? &j->records[i].in_quad : &j->records[i].verdict, which);
        if (e >= 0) error[s.n++] = e;
    }
    qsort(error, s.n, sizeof *error, ascending);
    if (s.n) {
        s.median = error[s.n / 2];
        s.high = error[(unsigned)ceil(0.999 * s.n) - 1];
        s.worst = error[s.n - 1];
    }
    free(error);
    return s;
}

typedef struct flags {
    unsigned hits, within, outside, open; /* wrong inside and outside the band; certificates that did not close */
    double worst;                         /* wrong flag, in bands */
} flags;

static flags flags_of(const job *j, bool quad) {
    flags f = {0};
    for (unsigned i = 0; i < j->count; i++) {
        const hpt_verdict *v = quad ? &j->records[i].in_quad : &j->records[i].verdict;
        f.hits += j->records[i].truth.F;
        f.within += !v->right && v->within;
        f.outside += !v->right && !v->within;
        f.open += !j->records[i].truth.certified;
        f.worst = fmax(f.worst, v->margin);
    }
    return f;
}

/* ---- the table ---- */

/* What issue and design ask of a class: flags wrong outside the band, T and CP at 99.9 % and at worst. */
static const struct {
    unsigned wrong_in_10000;
    double high, worst;
} bounds[HPT_CLASSES] = {
    [HPT_RANDOM] = {0, 1e-6, 1e-5},
    [HPT_GRAZING] = {0, 1e-5, 1e-4},
    [HPT_DEGENERATE] = {1, 1e-5, 1e-4},
    [HPT_OFFSET] = {0, 1e-6, 1e-5},
};

static void head(bool quad) {
    printf("| pair | class | pairs | hits | in band | wrong | worst, bands | T median | T 99.9 %% | T worst | "
           "separation median | separation 99.9 %% | separation worst | CP 99.9 %% | CP worst |");
    if (quad)
        printf(" wrong, binary128 | T 99.9 %%, binary128 | T worst, binary128 | separation worst, binary128 | "
               "CP worst, binary128 |");
    printf(" open | above its bound |\n|---|---|");
    for (int i = 0; i < 14 + (quad ? 5 : 0); i++) printf("--:|");
    printf("---|\n");
}

static void number(bool any, double x) {
    if (any)
        printf(" %.1e |", x);
    else
        printf(" |");
}

/* Names what is above its bound. */
static unsigned print_over(const job *j, const flags *f, const spread of[FIGURES]) {
    unsigned over = 0;
    printf(" %u |", f->open);
    if ((uint64_t)f->outside * 10000 >
        (uint64_t)bounds[j->class].wrong_in_10000 * (j->count < 10000 ? 10000 : j->count))
        printf("%s**F**", over++ ? ", " : " ");
    for (int i = 0; i < FIGURES; i++)
        if (of[i].high > bounds[j->class].high || of[i].worst > bounds[j->class].worst)
            printf("%s**%s**", over++ ? ", " : " ", figure_names[i]);
    printf(" |\n");
    return over;
}

static unsigned print_row(const job *j) {
    flags f = flags_of(j, false), fq = flags_of(j, true);
    spread of[FIGURES], in_quad[FIGURES];
    for (int i = 0; i < FIGURES; i++) {
        of[i] = spread_of(j, i, false);
        in_quad[i] = spread_of(j, i, true);
    }
    printf("| %s | %s | %u | %u | %u | %u |", hp_pair_name(j->pair), hpt_class_name(j->class), j->count, f.hits,
           f.within, f.outside);
    if (f.worst > 0)
        printf(" %.2g |", f.worst);
    else
        printf(" |");
    for (int i = 0; i < FIGURES; i++) {
        if (i != OF_CP) number(of[i].n, of[i].median);
        number(of[i].n, of[i].high);
        number(of[i].n, of[i].worst);
    }
    if (j->quad) {
        printf(" %u |", fq.outside);
        number(in_quad[OF_T].n, in_quad[OF_T].high);
        for (int i = 0; i < FIGURES; i++) number(in_quad[i].n, in_quad[i].worst);
    }
    unsigned over = print_over(j, &f, of);
    fflush(stdout);
    return over;
}

/* ---- the worst pairs ---- */

static void print_words(const char *name, const float *words, unsigned n) {
    printf("    %-9s", name);
    for (unsigned i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &words[i], sizeof bits);
        printf(" %08x", (unsigned)bits);
    }
    printf("\n             ");
    for (unsigned i = 0; i < n; i++) printf("%s%.9g", i ? ", " : "", words[i]);
    printf("\n");
}

static void print_record(const job *j, const record *r) {
    const hpt_truth *t = &r->truth;
    const hp_result *a = &r->result;
    print_words("primary", r->primary, hp_object_words(hp_pair_primary(j->pair)));
    print_words("secondary", r->secondary, hp_object_words(hp_pair_secondary(j->pair)));
    printf("    pipe      F %u T %.9g CP %.9g %.9g %.9g\n", (unsigned)a->F, a->T, a->CP[0], a->CP[1], a->CP[2]);
    printf("    truth     F %d signed distance %.17g (gap %.1e%s) direction %.9g %.9g %.9g\n", t->F,
           t->signed_distance, t->gap, t->certified ? "" : ", OPEN", t->direction[0], t->direction[1],
           t->direction[2]);
    if (t->crosses)
        printf("              t %.17g CP %.17g %.17g %.17g cos %.9g\n", t->t, t->CP[0], t->CP[1], t->CP[2],
               t->cosine);
    printf("    scales    L %.9g C %.9g band %.3g\n", t->L, t->C, t->band);
    printf("    binary32  %s T %.2e separation %.2e CP %.2e\n",
           r->verdict.right    ? "right"
           : r->verdict.within ? "in band"
                               : "WRONG",
           r->verdict.T_error, r->verdict.separation_error, r->verdict.CP_error);
    if (j->quad)
        printf("    binary128 %s T %.2e separation %.2e CP %.2e\n",
               r->in_quad.right    ? "right"
               : r->in_quad.within ? "in band"
                                   : "WRONG",
               r->in_quad.T_error, r->in_quad.separation_error, r->in_quad.CP_error);
}

/* Prints the `worst` records of the greatest badness above 0, one after the other. */
static void print_worst(const job *j, unsigned worst, const char *what, double (*badness)(const record *)) {
    double below = INFINITY;
    for (unsigned shown = 0; shown < worst;) {
        double most = 0;
        for (unsigned i = 0; i < j->count; i++) {
            double b = badness(&j->records[i]);
            if (b > most && (b < below || (shown == 0 && isinf(b)))) most = b;
        }
        if (most == 0) return;
        for (unsigned i = 0; i < j->count && shown < worst; i++)
            if (badness(&j->records[i]) == most) {
                printf("%s %s #%u, %s: %.3g\n", hp_pair_name(j->pair), hpt_class_name(j->class), i, what, most);
                print_record(j, &j->records[i]);
                shown++;
            }
        below = most;
    }
}

static double bad_flag(const record *r) {
    return r->verdict.right || r->verdict.within ? 0 : r->verdict.margin;
}
static double bad_T(const record *r) {
    return error_in(&r->verdict, OF_T);
}
static double bad_separation(const record *r) {
    return error_in(&r->verdict, OF_SEPARATION);
}
static double bad_CP(const record *r) {
    return error_in(&r->verdict, OF_CP);
}

/* ---- command line ---- */

static bool number_of(const char *text, unsigned *to) {
    char *end;
    errno = 0;
    unsigned long value = text ? strtoul(text, &end, 10) : 0;
    if (!text || errno || end == text || *end || value == 0 || value > 100000000) return false;
    *to = (unsigned)value;
    return true;
}

static bool class_of(const char *text, int *to) {
    for (*to = 0; text && *to < HPT_CLASSES; ++*to)
        if (strcmp(text, hpt_class_name((hpt_class)*to)) == 0) return true;
    return false;
}

static bool read_options(int argc, char **argv, options *o) {
    *o = (options){.count = 10000, .class = -1, .quad = true};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        bool good = false;
        if (strcmp(argv[i], "--no-quad") == 0) {
            o->quad = false;
            continue;
        }
        if (strcmp(argv[i], "--count") == 0)
            good = number_of(value, &o->count);
        else if (strcmp(argv[i], "--worst") == 0)
            good = number_of(value, &o->worst);
        else if (strcmp(argv[i], "--class") == 0)
            good = class_of(value, &o->class);
        else if (strcmp(argv[i], "--pair") == 0)
            good = value && (o->pair = hp_pair_from_name(value)) != 0;
        if (!good) return false;
        i++;
    }
    return true;
}

static unsigned run(const options *o, hp_pair pair, hpt_class class) {
    job j = {.pair = pair, .class = class, .count = o->count, .quad = o->quad};
    unsigned over = 0;
    j.records = calloc(o->count, sizeof *j.records);
    if (!j.records) abort();
    measure_all(&j);
    if (!o->worst)
        over = print_row(&j);
    else {
        print_worst(&j, o->worst, "wrong flag, in bands", bad_flag);
        print_worst(&j, o->worst, "T", bad_T);
        print_worst(&j, o->worst, "separation", bad_separation);
        print_worst(&j, o->worst, "CP", bad_CP);
    }
    free(j.records);
    return over;
}

int main(int argc, char **argv) {
    static const hp_pair pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
    };
    options o;
    unsigned over = 0;
    if (!read_options(argc, argv, &o)) {
        fputs(usage, stderr);
        return 2;
    }
    if (!o.worst) head(o.quad);
    for (unsigned p = 0; p < sizeof pairs / sizeof *pairs; p++)
        for (int class = 0; class < HPT_CLASSES; class ++)
            if ((!o.pair || o.pair == pairs[p]) && (o.class < 0 || o.class == class))
                over += run(&o, pairs[p], (hpt_class) class);
    return over ? 1 : 0;
}
