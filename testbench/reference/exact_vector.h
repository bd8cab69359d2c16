/* Vectors of exact rationals (GMP mpq), for oracles that share neither number format nor algorithm with the datapath.
 *
 * Binary32 numbers are rationals with a power of two below, so reading them loses nothing, and +, -, * and / of
 * rationals lose nothing either. Every hpt_q3 is initialised before and cleared after use; outputs may be inputs only
 * where said. No state; any thread on its own vectors. */
#ifndef TESTBENCH_REFERENCE_EXACT_VECTOR_H
#define TESTBENCH_REFERENCE_EXACT_VECTOR_H

#include <gmp.h>

typedef struct hpt_q3 {
    mpq_t of[3]; /* x, y, z */
} hpt_q3;

void hpt_q3_init(hpt_q3 *a);
void hpt_q3_clear(hpt_q3 *a);
/* The three finite floats at xyz, exactly. */
void hpt_q3_read(hpt_q3 *a, const float *xyz);
void hpt_q3_set(hpt_q3 *to, const hpt_q3 *from);
/* to = a - b; `to` may be a or b. */
void hpt_q3_sub(hpt_q3 *to, const hpt_q3 *a, const hpt_q3 *b);
/* to = a + k b; `to` may be a or b. */
void hpt_q3_add_scaled(hpt_q3 *to, const hpt_q3 *a, const mpq_t k, const hpt_q3 *b);
/* to = a x b; `to` is neither. */
void hpt_q3_cross(hpt_q3 *to, const hpt_q3 *a, const hpt_q3 *b);
/* to = a . b */
void hpt_q3_dot(mpq_t to, const hpt_q3 *a, const hpt_q3 *b);

#endif
