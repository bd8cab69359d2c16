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

/* What this program prints: the number after its option, which is from 1 to `most`. */
typedef struct peers_table {
    const char *name, *option;
    unsigned number, most;
    void (*print)(const hp_pair *pairs, unsigned n, unsigned number);
} peers_table;

static const peers_table tables[] = {
    {"agreement", "--count", 10000, 10000000, peers_print_agreement},
    {"summary", "--count", 10000, 10000000, peers_print_summary},
    {"speed", "--rounds", 9, 99, peers_print_speed},
};

static int usage(void) {
    fputs("usage: peers agreement|summary [--count N] [PAIR...]\n"
          "       peers speed [--rounds N] [PAIR...]\n",
          stderr);
    return 2;
}

static const peers_table *table_named(const char *name) {
    for (size_t i = 0; name && i < sizeof tables / sizeof *tables; i++)
        if (strcmp(tables[i].name, name) == 0) return &tables[i];
    return NULL;
}

int main(int argc, char **argv) {
    const peers_table *table = table_named(argv[1]);
    if (!table) return usage();
    hp_pair pairs[PAIRS];
    unsigned n = 0, number = table->number;
    for (int i = 2; i < argc; i++) {
        if (strcmp(argv[i], table->option) == 0 && i + 1 < argc) {
            number = (unsigned)strtoul(argv[++i], NULL, 10);
            if (number < 1 || number > table->most) return usage();
        } else if (n == PAIRS || !(pairs[n++] = hp_pair_from_name(argv[i])))
            return usage();
    }
    if (n == 0) memcpy(pairs, all_pairs, sizeof pairs), n = PAIRS;
    table->print(pairs, n, number);
    return 0;
}
