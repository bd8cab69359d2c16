/* Pairs of objects of any two types on which a pipe may go wrong, from a seed: for accuracy tables, tests of
 * properties and of equal bits, golden vectors and benches.
 *
 * The same words for the same sequence on every machine: only operations that IEEE 754 rounds exactly. All objects
 * are legal (hp_object_fault). Any thread, on its own generator. */
#ifndef TESTBENCH_SUPPORT_PAIR_CASES_H
#define TESTBENCH_SUPPORT_PAIR_CASES_H

#include "testbench/support/random.h"

#include <hitpipe/types.h>

typedef enum hpt_class {
    HPT_RANDOM,     /* sizes 0.2 to 1 near the origin; half to three quarters collide, some deep, some one inside the
                       other */
    HPT_GRAZING,    /* random, then the primary moved until the sets are 2^-4 to 2^10 bands from touching */
    HPT_DEGENERATE, /* slivers, rods and plates of aspect 1e3 to 1e5, flat and zero extents, parallel and nearly
                       parallel axes and faces, faces that coincide, sizes 1e-3 to 1e4 mixed */
    HPT_OFFSET,     /* random, both moved 1e3 to 1e4 along each coordinate */
    HPT_CLASSES
} hpt_class;

/* "random", "grazing", "degenerate", "offset" */
const char *hpt_class_name(hpt_class class);

/* Pair number i of a class: the variants of a class take turns with i, the rest is drawn. `primary` and `secondary`
 * have room for the words of their type. */
void hpt_draw_pair(hpt_random *random, hp_pair pair, hpt_class class, unsigned i, float *primary, float *secondary);

/* The same for two object types, whether or not a pipe takes them. The second is never a ray. */
void hpt_draw_objects(hpt_random *random, hp_object a, hp_object b, hpt_class class, unsigned i, float *first,
                      float *second);

/* Moves an object by a vector; its words are rounded. */
void hpt_move_object(hp_object object, float *words, const double by[3]);

#endif
