/* Flags, T and CP of the scalar ray-triangle datapath against the exact oracle, on 10,000 pairs of each class.
 *
 * Errors of T and CP are lengths over max(L, C) and over 1/|cos|; a wrong flag is measured in bands, max(1e-6 L,
 * 2^-21 C), from touching, and is outside from 1 on (docs/vectors.md). The bounds are what binary32 reaches in this
 * operation order, measured, with a third to spare: a change of the datapath that loses accuracy fails here. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <hitpipe/pipe.h>

#include "testbench/reference/judge.h"
#include "testbench/support/ray_triangle_cases.h"

enum { PAIRS = 10000 };

typedef struct accuracy {
    const char *name;
    hpt_ray_triangle_maker *make;
    unsigned outside;     /* most wrong flags outside the band */
    double bands;         /* of the worst wrong flag */
    double T_999, T_most; /* bounds of T's error: at the 99.9th percentile, at worst */
    double CP_most;       /* of CP's, at worst */
} accuracy;

static const accuracy classes[] = {
    {"random", hpt_random_pair, 0, 0.1, 1.5e-6, 3e-6, 3e-6},
    {"grazing", hpt_grazing_pair, 1, 1.5, 1.8e-6, 6e-6, 6e-6},
    {"slanting", hpt_slanting_pair, 1, 2.5, 5e-7, 2e-6, 2e-6},
    {"degenerate", hpt_sliver_pair, 5, 6e3, 6e-2, 0.1, 0.1},
    {"offset", hpt_offset_pair, 0, 0.1, 3.2e-10, 4e-9, 9e-8},
};

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void holds(void **state) {
    const accuracy *c = *state;
    hpt_random random = hpt_random_seed(2);
    hpt_tally tally = {0};
    double *errors = calloc(PAIRS, sizeof *errors);
    assert_non_null(errors);
    unsigned measured = 0;
    for (unsigned i = 0; i < PAIRS; i++) {
        float ray[6], triangle[9];
        c->make(&random, i, ray, triangle);
        hp_result answer = hp_pipe_test(HP_PAIR_RAY_TRIANGLE, HP_GRADUAL, false, ray, triangle, i);
        hpt_verdict verdict = hpt_judge_result(HP_PAIR_RAY_TRIANGLE, ray, triangle, &answer);
        hpt_tally_add(&tally, &answer, &verdict);
        if (verdict.measured) errors[measured++] = verdict.T_error;
    }
    qsort(errors, measured, sizeof *errors, ascending);
    double T_999 = errors[measured - 1 - measured / 1000];
    printf("| %-10s | %6u | %5u | %7u | %7u | %5.2g | %.1e | %.1e | %.1e | %.1e |\n", c->name, tally.count,
           tally.hits, tally.within, tally.outside, tally.worst_margin, errors[measured / 2], T_999, tally.worst_T,
           tally.worst_CP);
    free(errors);
    assert_true(tally.hits > PAIRS / 4 && tally.hits < PAIRS);
    assert_true(tally.outside <= c->outside);
    assert_true(tally.worst_margin <= c->bands);
    assert_true(T_999 <= c->T_999);
    assert_true(tally.worst_T <= c->T_most);
    assert_true(tally.worst_CP <= c->CP_most);
}

int main(void) {
    enum { CLASSES = sizeof classes / sizeof *classes };
    struct CMUnitTest tests[CLASSES];
    for (unsigned i = 0; i < CLASSES; i++)
        tests[i] = (struct CMUnitTest){classes[i].name, holds, NULL, NULL, (void *)&classes[i]};
    puts("| class      |  pairs |  hits | in band | outside | bands | T median | T 99.9 % | T worst | CP worst |");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
