/* hitpipe beside FCL, ODE, Bullet and libccd: who agrees with whom, and how fast. */
#include "testbench/peers/peers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    peer_list (*list)(void);
} libraries[] = {{peers_fcl}, {peers_ode}, {peers_bullet}, {peers_ccd}};

void peers_of(hp_pair pair, peers_visitor *with, void *context) {
    for (size_t l = 0; l < sizeof libraries / sizeof *libraries; l++) {
        peer_list list = libraries[l].list();
        for (size_t i = 0; i < list.n; i++)
            if (list.peers[i].pair == pair) with(&list.peers[i], context);
    }
}

static const hp_pair all_pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};
enum { PAIRS = sizeof all_pairs / sizeof *all_pairs };

static int usage(void) {
    fputs("usage: peers agreement [--count N] [PAIR...]\n"
          "       peers speed [--rounds N] [PAIR...]\n",
          stderr);
    return 2;
}

int main(int argc, char **argv) {
    if (argc < 2) return usage();
    bool speed = strcmp(argv[1], "speed") == 0;
    if (!speed && strcmp(argv[1], "agreement") != 0) return usage();
    hp_pair pairs[PAIRS];
    unsigned n = 0, number = speed ? 9 : 10000;
    for (int i = 2; i < argc; i++) {
        if (strcmp(argv[i], speed ? "--rounds" : "--count") == 0 && i + 1 < argc) {
            number = (unsigned)strtoul(argv[++i], NULL, 10);
            if (number < 1 || (speed && number > 99)) return usage();
        } else if (n == PAIRS || !(pairs[n++] = hp_pair_from_name(argv[i])))
            return usage();
    }
    if (n == 0) memcpy(pairs, all_pairs, sizeof pairs), n = PAIRS;
    if (speed)
        peers_print_speed(pairs, n, number);
    else
        peers_print_agreement(pairs, n, number);
    return 0;
}
