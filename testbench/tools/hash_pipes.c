/* hash_pipes [--count N] [ISA...]: prints the lines of vectors/hashes.txt, computed on each instruction set named
 * ("scalar" is one; without names: scalar), and on stderr the share of hits. Exit status 1 when two instruction sets
 * disagree. hash_pipes --isas: the names to be had here. */
#include "testbench/support/hash.h"
#include <hitpipe/pipe.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    COUNT = 12000000, /* pairs of ray-triangle */
    OTHERS = 240,     /* of the others, and with the distance of a miss, there is one for so many */
    SEED = 2007
};

static uint64_t print_line(const char *isa, hpt_hashing what) {
    uint64_t hits, hash = hpt_hash(&what, isa, &hits);
    printf("%s%s %s %" PRIu64 " %" PRIu64 " %016" PRIx64 "\n", hp_pair_name(what.pair),
           what.separation ? "+separation" : "", what.subnormals == HP_FLUSH ? "flush" : "gradual", what.seed,
           what.count, hash);
    fprintf(stderr, "%s: %.1f %% hits\n", isa, 100.0 * (double)hits / (double)what.count);
    return hash;
}

/* The same pairs on all instruction sets. Returns whether they disagree. */
static bool print_lines(char **isas, int n, hpt_hashing what) {
    uint64_t first = 0;
    bool disagree = false;
    for (int i = 0; i < n; i++) {
        uint64_t hash = print_line(isas[i], what);
        if (i == 0) first = hash;
        disagree |= hash != first;
    }
    return disagree;
}

static int print_isas(void) {
    for (unsigned i = 0; hp_isa_name(i); i++) puts(hp_isa_name(i));
    return 0;
}

int main(int argc, char **argv) {
    static char *scalar[] = {"scalar"};
    uint64_t count = COUNT;
    if (argc > 1 && strcmp(argv[1], "--isas") == 0) return print_isas();
    if (argc > 2 && strcmp(argv[1], "--count") == 0) {
        count = strtoull(argv[2], NULL, 10);
        argv += 2;
        argc -= 2;
    }
    char **isas = argc > 1 ? argv + 1 : scalar;
    int n = argc > 1 ? argc - 1 : 1, disagree = 0;
    for (int s = HP_GRADUAL; s <= HP_FLUSH; s++) {
        hpt_hashing what = {HP_PAIR_RAY_TRIANGLE, false, (hp_subnormals)s, SEED, count};
        disagree |= print_lines(isas, n, what);
        what.separation = true;
        what.count = count / OTHERS;
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    what.pair = HP_PAIR_##NAME;                                                                                      \
    disagree |= print_lines(isas, n, what);
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return disagree;
}
