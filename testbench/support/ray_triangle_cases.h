/* Rays and triangles on which a pipe may go wrong, from a seed: for golden vectors, accuracy tests and benches.
 *
 * The same words for the same sequence on every machine: only operations that IEEE 754 rounds exactly. Any thread. */
#ifndef TESTBENCH_SUPPORT_RAY_TRIANGLE_CASES_H
#define TESTBENCH_SUPPORT_RAY_TRIANGLE_CASES_H

#include "testbench/support/random.h"

#include <stddef.h>

/* Makes case number i of a kind: kinds go through their variants with i and draw the rest. */
typedef void hpt_ray_triangle_maker(hpt_random *random, unsigned i, float ray[6], float triangle[9]);

/* Coordinates about 1. */
hpt_ray_triangle_maker hpt_random_pair; /* anywhere; a third to a half of the rays hit, some point away */
hpt_ray_triangle_maker
    hpt_grazing_pair; /* past an edge or vertex within 2^-8 to 2^-26 of the size, or from the surface */
hpt_ray_triangle_maker hpt_slanting_pair;   /* 2^-2 to 2^-14 from parallel to the plane */
hpt_ray_triangle_maker hpt_sliver_pair;     /* triangles 2^10 to 2^17 (1e3 to 1e5) times as long as wide */
hpt_ray_triangle_maker hpt_offset_pair;     /* random, moved 1e3 to 1e4 from the origin */
hpt_ray_triangle_maker hpt_far_offset_pair; /* random, moved 1e5 to 1e6 */

/* Small whole numbers, on which binary32 arithmetic makes no error: the answer must be exact. */
hpt_ray_triangle_maker hpt_vertex_pair;      /* through v0, v1, v2 in turn */
hpt_ray_triangle_maker hpt_edge_pair;        /* through edge v0 v1, v1 v2, v2 v0 in turn */
hpt_ray_triangle_maker hpt_start_pair;       /* t = 0: from a point inside, on an edge, on a vertex */
hpt_ray_triangle_maker hpt_behind_pair;      /* t < 0: away from a point inside, on an edge, on a vertex */
hpt_ray_triangle_maker hpt_one_bit_off_pair; /* through an edge or vertex, but for the last bit of one word */
hpt_ray_triangle_maker hpt_parallel_pair;    /* parallel to the plane, half of them in it */
hpt_ray_triangle_maker hpt_flat_pair;        /* no area: three vertices on a line, two or three the same */
hpt_ray_triangle_maker hpt_still_pair;       /* direction zero, from off and on the triangle */
hpt_ray_triangle_maker hpt_signed_zero_pair; /* coordinates 0, 1 and -1, each 0 of either sign */

/* Words that are no usual number. */
hpt_ray_triangle_maker hpt_nonfinite_pair;      /* one of the 15 words an infinity or a NaN */
hpt_ray_triangle_maker hpt_two_nonfinite_pair;  /* two of them */
hpt_ray_triangle_maker hpt_subnormal_word_pair; /* one of the 15 words subnormal, among words about 1 */
hpt_ray_triangle_maker hpt_tiny_pair;           /* all words subnormal or 0, but for a direction of 2^80 to 2^125 */
hpt_ray_triangle_maker hpt_underflow_pair;      /* 2^-75 to 2^-30: products go below 2^-126 */
hpt_ray_triangle_maker hpt_overflow_pair;       /* 2^30 to 2^127: products go past the largest number */
hpt_ray_triangle_maker hpt_long_direction_pair; /* det past the largest number, t not */
hpt_ray_triangle_maker hpt_far_hit_pair;        /* T near the largest number and past it */

#endif
