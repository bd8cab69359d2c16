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

/* Checks one line; the number of pairs hashed. */
static uint64_t check_line(const char *line) {
    char pair[32], underflow[16];
    uint64_t seed, count, hash, hits;
    assert_int_equal(
        sscanf(line, "%31s %15s %" SCNu64 " %" SCNu64 " %" SCNx64, pair, underflow, &seed, &count, &hash), 5);
    assert_int_equal(hp_pair_from_name(pair), HP_PAIR_RAY_TRIANGLE);
    bool flush = strcmp(underflow, "flush") == 0;
    assert_true(flush || strcmp(underflow, "gradual") == 0);
    uint64_t got = hpt_hash_ray_triangle(hp_isa_choose(NULL), flush ? HP_FLUSH : HP_GRADUAL, seed, count, &hits);
    assert_int_equal(got, hash);
    assert_in_range(hits, count / 10, count / 2);
    return count;
}

static void test_committed_hashes(void **state) {
    (void)state;
    char line[128];
    uint64_t pairs = 0;
    FILE *file = fopen("vectors/hashes.txt", "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file))
        if (line[0] != '#') pairs += check_line(line);
    fclose(file);
    assert_true(pairs >= 20000000);
}

/* One result that differs makes another hash. */
static void test_hash_depends_on_every_pair(void **state) {
    (void)state;
    uint64_t hits, hash = hpt_hash_ray_triangle("scalar", HP_GRADUAL, 1, 5000, &hits);
    assert_int_not_equal(hash, hpt_hash_ray_triangle("scalar", HP_GRADUAL, 1, 4999, &hits));
    assert_int_not_equal(hash, hpt_hash_ray_triangle("scalar", HP_GRADUAL, 2, 5000, &hits));
    assert_int_not_equal(hash, hpt_hash_ray_triangle("scalar", HP_FLUSH, 1, 5000, &hits));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_committed_hashes),
        cmocka_unit_test(test_hash_depends_on_every_pair),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
