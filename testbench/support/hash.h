/* A hash of many results of a pipe: equal bits, equal hash, on every instruction set, compiler and optimisation
 * level.
 *
 * The pairs: a sequence of hpt_random from `seed`, made as hash.c says (ray-triangle in its own way). Of each result,
 * F and the bits of T, CP.x, CP.y, CP.z go into the hash in this order, as h = (h ^ word) * 0x100000001B3, from h =
 * 0xCBF29CE484222325 (FNV-1a taken 32 bits at a time). */
#ifndef HPT_HASH_H
#define HPT_HASH_H

#include <hitpipe/types.h>

typedef struct hpt_hashing {
    hp_pair pair;
    bool separation;
    hp_subnormals subnormals;
    uint64_t seed, count;
} hpt_hashing;

/* Hash of the first `count` pairs of `seed` on an instruction set of hp_isa_name, or on the scalar datapath when
 * `isa` is "scalar"; *hits counts their hits. 0 when there is no such instruction set here. */
uint64_t hpt_hash(const hpt_hashing *what, const char *isa, uint64_t *hits);

#endif
