/* The operators that C's own say, for a number system whose num is one C number. No include guard. */

#define REPEAT(i, n) for (unsigned i = 0; i < (n); i++)

HP_INLINE flag less(num a, num b) {
    return a < b;
}
HP_INLINE flag at_most(num a, num b) {
    return a <= b;
}
HP_INLINE num min(num a, num b) {
    return a < b ? a : b;
}
HP_INLINE num max(num a, num b) {
    return a < b ? b : a;
}
HP_INLINE num select(flag f, num a, num b) {
    return f ? a : b;
}
HP_INLINE bits select_bits(flag f, bits a, bits b) {
    return f ? a : b;
}
HP_INLINE flag and (flag a, flag b) {
    return a && b;
}
HP_INLINE flag or (flag a, flag b) {
    return a || b;
}
HP_INLINE flag not(flag a) {
    return !a;
}
HP_INLINE num neg(num a) {
    return -a;
}
