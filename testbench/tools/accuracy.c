/* How far the pipes are from the truth: the tables of docs/accuracy.md, or the worst pairs one by one.
 *
 *   accuracy [--count N] [--pair NAME] [--class CLASS] [--worst N] [--no-quad]
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "testbench/support/accuracy.h"

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

static const hp_pair pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};
enum { PAIRS = sizeof pairs / sizeof *pairs };

/* ---- the tables ---- */

static void number(bool any, double x) {
    if (any)
        printf(" %.1e |", x);
    else
        printf(" |");
}

static void print_head(void) {
    printf("| pair | class | pairs | hits | in band | wrong | worst, bands | T median | T 99.9 %% | T worst | "
           "separation median | separation 99.9 %% | separation worst | CP 99.9 %% | CP worst | open | above its "
           "bound |\n"
           "|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|\n");
}

static void print_row(const hpt_row *row) {
    static const char *const names[] = {"F", "T", "separation", "CP"};
    const hpt_flags *f = &row->flags[0];
    printf("| %s | %s | %u | %u | %u | %u |", hp_pair_name(row->pair), hpt_class_name(row->class), row->count,
           f->hits, f->within, f->outside);
    if (f->worst > 0)
        printf(" %.2g |", f->worst);
    else
        printf(" |");
    for (int i = 0; i < HPT_FIGURES; i++) {
        const hpt_spread *s = &row->spread[0][i];
        if (i != HPT_OF_CP) number(s->n, s->median);
        number(s->n, s->high);
        number(s->n, s->worst);
    }
    unsigned over = hpt_row_over(row, false);
    printf(" %u |", f->open);
    for (int i = 0; i < 1 + HPT_FIGURES; i++)
        if (over >> i & 1) printf(" **%s**", names[i]);
    printf(over && hpt_row_explained(row) ? " explained |\n" : " |\n");
    fflush(stdout);
}

static void print_strains(const hpt_row *rows, unsigned n) {
    printf("\n| pair | class | greatest strain of t | of a wrong flag |\n|---|---|--:|--:|\n");
    for (const hpt_row *r = rows; r < rows + n; r++)
        if (r->pair == HP_PAIR_RAY_TRIANGLE)
            printf("| %s | %s | %.2g | %.2g |\n", hp_pair_name(r->pair), hpt_class_name(r->class), r->strain_of_T,
                   r->strain_of_F);
}

static void print_quad_head(void) {
    printf("\n| pair, in binary128 | class | in band | wrong | worst, bands | T 99.9 %% | T worst | separation 99.9 "
           "%% | "
           "separation worst | CP 99.9 %% | CP worst |\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
}

static void print_quad_row(const hpt_row *row) {
    const hpt_flags *f = &row->flags[1];
    printf("| %s | %s | %u | %u |", hp_pair_name(row->pair), hpt_class_name(row->class), f->within, f->outside);
    if (f->worst > 0)
        printf(" %.2g |", f->worst);
    else
        printf(" |");
    for (int i = 0; i < HPT_FIGURES; i++) {
        number(row->spread[1][i].n, row->spread[1][i].high);
        number(row->spread[1][i].n, row->spread[1][i].worst);
    }
    printf("\n");
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

static void print_record(const hpt_sample *j, const hpt_record *r) {
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
static void print_worst(const hpt_sample *j, unsigned worst, const char *what,
                        double (*badness)(const hpt_record *)) {
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

static double bad_flag(const hpt_record *r) {
    return r->verdict.right || r->verdict.within ? 0 : r->verdict.margin;
}
static double bad_T(const hpt_record *r) {
    return hpt_error_of(&r->verdict, HPT_OF_T);
}
static double bad_separation(const hpt_record *r) {
    return hpt_error_of(&r->verdict, HPT_OF_SEPARATION);
}
static double bad_CP(const hpt_record *r) {
    return hpt_error_of(&r->verdict, HPT_OF_CP);
}

static void print_all_worst(const hpt_sample *j, unsigned worst) {
    print_worst(j, worst, "wrong flag, in bands", bad_flag);
    print_worst(j, worst, "T", bad_T);
    print_worst(j, worst, "separation", bad_separation);
    print_worst(j, worst, "CP", bad_CP);
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

static bool is_chosen(const options *o, hp_pair pair, int class) {
    return (!o->pair || o->pair == pair) && (o->class < 0 || o->class == class);
}

int main(int argc, char **argv) {
    hpt_row rows[PAIRS * HPT_CLASSES];
    unsigned n = 0, over = 0;
    options o;
    if (!read_options(argc, argv, &o)) {
        fputs(usage, stderr);
        return 2;
    }
    if (!o.worst) print_head();
    for (unsigned p = 0; p < PAIRS; p++)
        for (int class = 0; class < HPT_CLASSES; class ++) {
            if (!is_chosen(&o, pairs[p], class)) continue;
            hpt_sample *sample = hpt_sample_new(pairs[p], (hpt_class) class, o.count, o.quad);
            rows[n] = hpt_row_of(sample);
            over |= (hpt_row_over(&rows[n], false) && !hpt_row_explained(&rows[n])) ||
                    (o.quad && hpt_row_over(&rows[n], true));
            if (o.worst)
                print_all_worst(sample, o.worst);
            else
                print_row(&rows[n]);
            hpt_sample_free(sample);
            n++;
        }
    if (!o.worst) print_strains(rows, n);
    if (o.quad && !o.worst) {
        print_quad_head();
        for (unsigned i = 0; i < n; i++) print_quad_row(&rows[i]);
    }
    return over ? 1 : 0;
}
