/* The tables of this program: docs/peers.md. */
#ifndef TESTBENCH_PEERS_PEERS_H
#define TESTBENCH_PEERS_PEERS_H

#include "testbench/peers/peer.h"

/* Calls `with` for every row of every library that knows the pair. */
typedef void peers_visitor(const peer *row, void *context);
void peers_of(hp_pair pair, peers_visitor *with, void *context);

/* The pairs asked for, `pairs` of them. */
void peers_print_speed(const hp_pair *pairs, unsigned n, unsigned rounds);
void peers_print_agreement(const hp_pair *pairs, unsigned n, unsigned count);
void peers_print_summary(const hp_pair *pairs, unsigned n, unsigned count);

#endif
