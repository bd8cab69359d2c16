/* Sizes that no object has, kept out of pipes. A board that meets a negative size, a NaN or an infinity answers F =
 * 0; a secondary gets there through its prepared words: a NaN in one of them spoils every comparison that decides F.
 */

/* The size, or NaN where it is negative, infinite or NaN. */
HP_INLINE num HP_NAMED(legal_size)(num size) {
    return select(and(at_least(size, constant(0)), less(size, constant(INFINITY))), size, constant(NAN));
}

/* No NaN, no infinity. */
HP_INLINE flag HP_NAMED(finite)(num a) {
    return less(abs(a), constant(INFINITY));
}
