/* A hash of many results of a pipe: equal bits, equal hash, on every instruction set, compiler and optimisation
 * level.
 *
 * The pairs: a sequence of hpt_random from `seed`, whose case i is made by kind number i, modulo their number, of a
 * fixed list in hash.c. Of each result, F and the bits of T, CP.x, CP.y, CP.z go into the hash in this order, as h =
 * (h ^ word) * 0x100000001B3, from h = 0xCBF29CE484222325 (FNV-1a taken 32 bits at a time). */
#ifndef HPT_HASH_H
#define HPT_HASH_H

#include <hitpipe/types.h>

/* Hash of the first `count` ray-triangle pairs of `seed` on an instruction set of hp_isa_name, or on the scalar
 * datapath when `isa` is "scalar"; *hits counts their hits. 0 when there is no such instruction set here. */
uint64_t hpt_hash_ray_triangle(const char *isa, hp_subnormals subnormals, uint64_t seed, uint64_t count,
                               uint64_t *hits);

#endif
