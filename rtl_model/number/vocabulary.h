/* The operator vocabulary in which pipes and transformer are written. No include guard: it stands once per number
 * system.
 *
 * Before this a number system (scalar.h, wide.h, graph_numbers.h, quad.h) has defined HP_MEANING and
 *
 *   num, flag, bits            a number, a truth value, a 32-bit index; in wide lanes one of each per lane
 *   constant(c)                the float c
 *   add sub mul div sqrt       IEEE 754, rounded to nearest even
 *   less(a, b) at_most(a, b)   a < b and a <= b; false when either is a NaN
 *   min(a, b)                  less(a, b) ? a : b     One comparator and two multiplexers make both. So min of
 *   max(a, b)                  less(a, b) ? b : a     equal numbers is b, max is a, and with a NaN likewise.
 *   select(f, a, b)            f ? a : b
 *   and or not neg abs         gates and wires; neg and abs touch the sign bit only
 *   UNLESS_ANY(f)              "if (no lane has f)": a short cut for programs, which leaves the hardware as it is.
 * What it skips may only be what cannot change the answer; or, of pairs whose depth is not above `bar`, anything: a
 * pipe is asked then for what is deeper than what is already there.
 *   REPEAT(i, n)               a loop of n steps, n a literal: one piece of hardware that is used n times a test.
 * The pipe's interval is then n (nested loops multiply), and an operator of the body counts once.
 *
 * Underflow: in a number system that flushes, a num is never subnormal: words are flushed where they enter, results
 * where they arise. That is what operators that flush operands and results do. */

typedef struct vec3 {
    num x, y, z;
} vec3;

/* What leaves a pipe. */
typedef struct answer {
    flag F;
    bits index;
    num T;
    vec3 CP;
    bool any; /* false: no lane has F, the rest was not computed; not a wire */
} answer;

HP_INLINE flag at_least(num a, num b) {
    return at_most(b, a);
}

/* Words i, i + 1, i + 2 of an object, and back. */
HP_INLINE vec3 vec3_of(const num *object, unsigned i) {
    return (vec3){object[i], object[i + 1], object[i + 2]};
}

HP_INLINE void put_vec3(num *object, unsigned i, vec3 a) {
    object[i] = a.x;
    object[i + 1] = a.y;
    object[i + 2] = a.z;
}

HP_INLINE vec3 add3(vec3 a, vec3 b) {
    return (vec3){add(a.x, b.x), add(a.y, b.y), add(a.z, b.z)};
}

HP_INLINE vec3 sub3(vec3 a, vec3 b) {
    return (vec3){sub(a.x, b.x), sub(a.y, b.y), sub(a.z, b.z)};
}

HP_INLINE vec3 scale3(num s, vec3 a) {
    return (vec3){mul(s, a.x), mul(s, a.y), mul(s, a.z)};
}

HP_INLINE vec3 neg3(vec3 a) {
    return (vec3){neg(a.x), neg(a.y), neg(a.z)};
}

HP_INLINE vec3 select3(flag f, vec3 a, vec3 b) {
    return (vec3){select(f, a.x, b.x), select(f, a.y, b.y), select(f, a.z, b.z)};
}

HP_INLINE vec3 cross(vec3 a, vec3 b) {
    return (vec3){sub(mul(a.y, b.z), mul(a.z, b.y)), sub(mul(a.z, b.x), mul(a.x, b.z)),
                  sub(mul(a.x, b.y), mul(a.y, b.x))};
}

HP_INLINE num dot(vec3 a, vec3 b) {
    return add(add(mul(a.x, b.x), mul(a.y, b.y)), mul(a.z, b.z));
}

HP_INLINE num length(vec3 a) {
    return sqrt(dot(a, a));
}

HP_INLINE num clamp(num x, num low, num high) {
    return min(max(x, low), high);
}

/* Whether a depth of at most `bound` may be one that counts: that of a hit, and deeper than the bar. */
HP_INLINE flag could_count(num bound, num bar) {
    return and(at_least(bound, constant(0)), less(bar, bound));
}

/* The output multiplexers: what a hit computed, or the answer of a miss: its distance and nothing else. */
HP_INLINE answer answer_with(flag F, bits index, num T, num distance, vec3 CP) {
    num zero = constant(0);
    return (answer){.F = F,
                    .index = select_bits(F, index, constant_bits(HP_NO_INDEX)),
                    .T = select(F, T, distance),
                    .CP = {select(F, CP.x, zero), select(F, CP.y, zero), select(F, CP.z, zero)},
                    .any = true};
}

/* The same for a pipe that was not asked for the distance of a miss. */
HP_INLINE answer answer_of(flag F, bits index, num T, vec3 CP) {
    return answer_with(F, index, T, constant(INFINITY), CP);
}

/* The answer when every lane misses. */
HP_INLINE answer miss(void) {
    return (answer){.any = false};
}
