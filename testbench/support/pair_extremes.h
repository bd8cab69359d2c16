/* Pairs of any types at the edge of what a board may meet: for golden vectors. Case i of each kind, the rest drawn;
 * the same on every machine. Any thread, on its own generator. */
#ifndef TESTBENCH_SUPPORT_PAIR_EXTREMES_H
#define TESTBENCH_SUPPORT_PAIR_EXTREMES_H

#include "testbench/support/random.h"
#include <hitpipe/types.h>

/* `primary` and `secondary` have room for the words of their types. */
typedef void hpt_pair_maker(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary);

hpt_pair_maker hpt_whole_pair;     /* whole numbers and axes: faces, edges, vertices, surfaces often touch exactly */
hpt_pair_maker hpt_flat_objects;   /* legal and flat: no area, no radius, no extent, in one object or in both */
hpt_pair_maker hpt_small_pair;     /* so small that products underflow, and words are subnormal */
hpt_pair_maker hpt_nonfinite_word; /* a quiet or signalling NaN or an infinity in each word in turn */
hpt_pair_maker hpt_illegal_object; /* what the host refuses: no direction, no axis, a negative size, min > max */

#endif
