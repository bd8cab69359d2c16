/* hash_pipes [ISA...]: prints the lines of vectors/hashes.txt, computed on each instruction set named ("scalar" is
 * one; without names: scalar), and the share of hits. Exit status 1 when two instruction sets disagree. */
#include "testbench/support/hash.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 12000000, SEED = 2007 };

static uint64_t print_line(const char *isa, hp_subnormals subnormals) {
    uint64_t hits, hash = hpt_hash_ray_triangle(isa, subnormals, SEED, COUNT, &hits);
    printf("ray-triangle %s %d %d %016" PRIx64 "\n", subnormals == HP_FLUSH ? "flush" : "gradual", SEED, COUNT, hash);
    fprintf(stderr, "%s: %.1f %% hits\n", isa, 100.0 * (double)hits / COUNT);
    return hash;
}

int main(int argc, char **argv) {
    static char *scalar[] = {"scalar"};
    char **isas = argc > 1 ? argv + 1 : scalar;
    int n = argc > 1 ? argc - 1 : 1, disagree = 0;
    for (int s = HP_GRADUAL; s <= HP_FLUSH; s++) {
        uint64_t first = 0;
        for (int i = 0; i < n; i++) {
            uint64_t hash = print_line(isas[i], (hp_subnormals)s);
            if (i == 0) first = hash;
            disagree |= hash != first;
        }
    }
    return disagree;
}
