#include "testbench/peers/peers.h"
void peers_print_agreement(const hp_pair *pairs, unsigned n, unsigned count) {
    (void)pairs, (void)n, (void)count;
}
