/* Objects drawn without ado, from nothing but integers and operations that IEEE 754 rounds exactly: what hashes and
 * golden vectors rest on, so that a change here changes both. Legal but for rays without a direction and cylinders
 * without an axis, which whole numbers can make. Any thread, on its own generator. */
#ifndef TESTBENCH_SUPPORT_PLAIN_OBJECTS_H
#define TESTBENCH_SUPPORT_PLAIN_OBJECTS_H

#include "testbench/support/random.h"
#include <hitpipe/types.h>

/* Evenly in [-size, size) from one of the three 21-bit parts of 64 random bits. */
float hpt_part(uint64_t random, unsigned which, float size);

/* A point with such coordinates; one with whole numbers from -3 to 3. */
void hpt_draw_point(hpt_random *random, float size, float *point);
void hpt_draw_whole_point(hpt_random *random, float *point);

/* Coordinates from -1 to 1 and sizes from 0 to 1; `whole`: whole numbers from -3 to 3, sizes 0, 1, 2 (radii of
 * cylinders half that), boxes and planes along the axes: they often touch. */
void hpt_draw_plain_object(hpt_random *random, hp_object type, bool whole, float *words);

/* Whether word w of an object is a length, not a part of a direction. */
bool hpt_is_length(hp_object type, unsigned w);

#endif
