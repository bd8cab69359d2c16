/* The committed hashes of vectors/hashes.txt hold on the instruction set in use (HP_ISA picks another). */
#include "testbench/support/hash.h"
#include <hitpipe/pipe.h>
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* "obb-obb" or "obb-obb+separation" */
static void read_name(char *name, hpt_hashing *what) {
    char *plus = strchr(name, '+');
    what->separation = plus != NULL;
    if (plus) assert_string_equal(plus, "+separation");
    if (plus) *plus = 0;
    what->pair = hp_pair_from_name(name);
    assert_int_not_equal(what->pair, 0);
}

/* Checks one line. Returns what it is about. */
static hpt_hashing check_line(const char *line) {
    char name[48], underflow[16];
    hpt_hashing what;
    uint64_t hash, hits;
    assert_int_equal(
        sscanf(line, "%47s %15s %" SCNu64 " %" SCNu64 " %" SCNx64, name, underflow, &what.seed, &what.count, &hash),
        5);
    read_name(name, &what);
    what.subnormals = strcmp(underflow, "flush") == 0 ? HP_FLUSH : HP_GRADUAL;
    if (what.subnormals == HP_GRADUAL) assert_string_equal(underflow, "gradual");
    uint64_t got = hpt_hash(&what, hp_isa_choose(NULL), &hits);
    if (got != hash) fail_msg("%016" PRIx64 " for %s", got, line);
    assert_in_range(hits, what.count / 40, what.count * 4 / 5);
    return what;
}

static void test_committed_hashes(void **state) {
    (void)state;
    char line[128];
    uint64_t pairs = 0, lines[2][2][32] = {0};
    FILE *file = fopen("vectors/hashes.txt", "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        if (line[0] == '#') continue;
        hpt_hashing what = check_line(line);
        pairs += what.count;
        lines[what.separation][what.subnormals][what.pair]++;
    }
    fclose(file);
    assert_true(pairs >= 20000000);
    for (int s = HP_GRADUAL; s <= HP_FLUSH; s++) {
        assert_true(lines[false][s][HP_PAIR_RAY_TRIANGLE]);
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) assert_true(lines[true][s][code]);
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
}

/* One result that differs makes another hash. */
static void test_hash_depends_on_every_pair(void **state) {
    (void)state;
    uint64_t hits;
    const hpt_hashing whole = {HP_PAIR_RAY_TRIANGLE, false, HP_GRADUAL, 1, 5000};
    hpt_hashing shorter = whole, other = whole, flush = whole;
    shorter.count--;
    other.seed++;
    flush.subnormals = HP_FLUSH;
    uint64_t hash = hpt_hash(&whole, "scalar", &hits);
    assert_int_not_equal(hash, hpt_hash(&shorter, "scalar", &hits));
    assert_int_not_equal(hash, hpt_hash(&other, "scalar", &hits));
    assert_int_not_equal(hash, hpt_hash(&flush, "scalar", &hits));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_committed_hashes),
        cmocka_unit_test(test_hash_depends_on_every_pair),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
