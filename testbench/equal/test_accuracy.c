/* The bounds of docs/accuracy.md on fewer pairs: each pipe and class against the oracle, in binary32 and, for the
 * method alone, in binary128; and the page itself, which must have all rows of all tables. */
#include "testbench/support/accuracy.h"
#include <hitpipe/pipe.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
/* cmocka wants its headers first */
#include <cmocka.h>

enum { PAIRS = 300 };

static const hp_pair all_pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};
enum { ALL_PAIRS = sizeof all_pairs / sizeof *all_pairs, ROWS = ALL_PAIRS * HPT_CLASSES };

static hpt_row measured(hp_pair pair, hpt_class class) {
    hpt_sample *sample = hpt_sample_new(pair, class, PAIRS, true);
    hpt_row row = hpt_row_of(sample);
    hpt_sample_free(sample);
    return row;
}

static void pipe_is_within_its_bounds(void **state) {
    const hp_pair pair = *(const hp_pair *)*state;
    for (hpt_class class = 0; class < HPT_CLASSES; class ++) {
        hpt_row row = measured(pair, class);
        assert_in_range(row.flags[0].hits, PAIRS / 4, PAIRS - PAIRS / 8);
        for (int i = 0; i < HPT_FIGURES; i++) assert_true(row.spread[0][i].n > PAIRS / 8);
        if (hpt_row_over(&row, true)) fail_msg("%s, %s: binary128", hp_pair_name(pair), hpt_class_name(class));
        if (hpt_row_over(&row, false) && !hpt_row_explained(&row))
            fail_msg("%s, %s: binary32: %#x", hp_pair_name(pair), hpt_class_name(class), hpt_row_over(&row, false));
    }
}

/* What explains a row must not explain another, nor a datapath that does worse than round. */
static void only_slivers_are_explained(void **state) {
    (void)state;
    hpt_row row = measured(HP_PAIR_RAY_TRIANGLE, HPT_DEGENERATE);
    assert_true(hpt_row_explained(&row));
    assert_true(row.strain_of_T > 0.1); /* it is measured */
    hpt_row other = row;
    other.class = HPT_RANDOM;
    assert_false(hpt_row_explained(&other));
    other = row;
    other.strain_of_T = HPT_STRAIN * 1.01;
    assert_false(hpt_row_explained(&other));
    other = row;
    other.flags[0].outside = 21;
    assert_false(hpt_row_explained(&other));
    other = row;
    other.flags[1].outside = 2;
    assert_false(hpt_row_explained(&other));
}

/* Two rows a pair and class: of the pipe on 10,000 pairs, and of its text in binary128. */
static void the_page_is_complete(void **state) {
    (void)state;
    unsigned rows[ALL_PAIRS][HPT_CLASSES] = {{0}}, wide[ALL_PAIRS][HPT_CLASSES] = {{0}}, pairs;
    char line[1024], pair[32], class[32], flag[32];
    FILE *page = fopen("docs/accuracy.md", "r");
    assert_non_null(page);
    while (fgets(line, sizeof line, page)) {
        int n = sscanf(line, "| %31s | %31s | %u | %31s", pair, class, &pairs, flag);
        if (n < 3) continue;
        for (unsigned p = 0; p < ALL_PAIRS; p++)
            for (unsigned c = 0; c < HPT_CLASSES; c++)
                if (strcmp(pair, hp_pair_name(all_pairs[p])) == 0 && strcmp(class, hpt_class_name((hpt_class)c)) == 0)
                    ++*(pairs == 10000 ? &rows[p][c] : &wide[p][c]);
    }
    fclose(page);
    for (unsigned p = 0; p < ALL_PAIRS; p++)
        for (unsigned c = 0; c < HPT_CLASSES; c++) {
            assert_int_equal(rows[p][c], 1);
            assert_in_range(wide[p][c], 1, 2); /* ray-triangle has strains too */
        }
}

int main(void) {
    struct CMUnitTest tests[ALL_PAIRS + 2] = {[ALL_PAIRS] = cmocka_unit_test(only_slivers_are_explained),
                                              [ALL_PAIRS + 1] = cmocka_unit_test(the_page_is_complete)};
    for (unsigned i = 0; i < ALL_PAIRS; i++)
        tests[i] = (struct CMUnitTest){hp_pair_name(all_pairs[i]), pipe_is_within_its_bounds, NULL, NULL,
                                       (void *)&all_pairs[i]};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
