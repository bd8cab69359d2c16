/* hash_pipes [--count N] [ISA...]: prints the lines of vectors/hashes.txt, computed on each instruction set named
 * ("scalar" is one; without names: scalar), and on stderr the share of hits. Exit status 1 when two instruction sets
 * disagree. hash_pipes --isas: the names to be had here. */
#include "testbench/support/hash.h"
#include <hitpipe/pipe.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 12000000, SEED = 2007 };

static uint64_t print_line(const char *isa, hp_subnormals subnormals, uint64_t count) {
    uint64_t hits, hash = hpt_hash_ray_triangle(isa, subnormals, SEED, count, &hits);
    printf("ray-triangle %s %d %" PRIu64 " %016" PRIx64 "\n", subnormals == HP_FLUSH ? "flush" : "gradual", SEED,
           count, hash);
    fprintf(stderr, "%s: %.1f %% hits\n", isa, 100.0 * (double)hits / (double)count);
    return hash;
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
        uint64_t first = 0;
        for (int i = 0; i < n; i++) {
            uint64_t hash = print_line(isas[i], (hp_subnormals)s, count);
            if (i == 0) first = hash;
            disagree |= hash != first;
        }
    }
    return disagree;
}
