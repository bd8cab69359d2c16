/* Number system: binary32 in wide lanes. No include guard; define HP_MEANING, HP_WIDE_FLUSH (1: flush by hand) and
 * include one header of number/arch first.
 *
 * A num is HP_VECTORS vectors of HP_LANES lanes (1 or 2: two independent chains of operations hide each other's
 * latency). The bits of each lane are those of scalar.h. Where MXCSR flushes, a word from outside may stay subnormal:
 * it is zero to every operator but min, max, select, neg and abs, which pipes apply to results only. */
#include "rtl_model/number/names.h"

/* What only the second vector needs. */
#undef HP_SECOND
#if HP_VECTORS == 2
#define HP_SECOND(...) __VA_ARGS__
#else
#define HP_SECOND(...)
#endif

typedef struct num {
    v_num a;
    HP_SECOND(v_num b;)
} num;
/* A word each for small flags: in one word, the two would be packed and unpacked on every use. */
typedef struct flag {
    v_flag a;
    HP_SECOND(_Alignas(_Alignof(v_flag) > 8 ? _Alignof(v_flag) : 8) v_flag b;)
} flag;
typedef struct bits {
    v_bits a;
    HP_SECOND(v_bits b;)
} bits;

/* An operator on every vector of its operands. */
#define HP_LIFT1(result, name, vector_name, T)                                                                       \
    HP_INLINE result name(T x) {                                                                                     \
        return (result){vector_name(x.a) HP_SECOND(, vector_name(x.b))};                                             \
    }
#define HP_LIFT2(result, name, vector_name, T)                                                                       \
    HP_INLINE result name(T x, T y) {                                                                                \
        return (result){vector_name(x.a, y.a) HP_SECOND(, vector_name(x.b, y.b))};                                   \
    }
#define HP_LIFT3(result, name, vector_name, T)                                                                       \
    HP_INLINE result name(flag f, T x, T y) {                                                                        \
        return (result){vector_name(f.a, x.a, y.a) HP_SECOND(, vector_name(f.b, x.b, y.b))};                         \
    }

#if HP_WIDE_FLUSH
#define HP_SETTLE(result, measure, least) v_settle(result, measure, least)
#else
#define HP_SETTLE(result, measure, least) (result)
#endif

/* Sums, products and quotients of one vector; scalar.h explains the flushing. */
HP_INLINE v_num HP_NAMED(v_add)(v_num x, v_num y) {
    return HP_SETTLE(x + y, x + y, 0x1p-126f);
}
HP_INLINE v_num HP_NAMED(v_sub)(v_num x, v_num y) {
    return HP_SETTLE(x - y, x - y, 0x1p-126f);
}
HP_INLINE v_num HP_NAMED(v_mul)(v_num x, v_num y) {
    return HP_SETTLE(x * y, x * v_constant(0x1p64f) * y, 0x1p-62f);
}
HP_INLINE v_num HP_NAMED(v_div)(v_num x, v_num y) {
    return HP_SETTLE(x / y, x * v_constant(0x1p64f) / y, 0x1p-62f);
}
HP_INLINE v_num HP_NAMED(v_enter)(v_num x) {
    return HP_SETTLE(x, x, 0x1p-126f);
}

#undef HP_SETTLE

HP_LIFT2(num, add, HP_NAMED(v_add), num)
HP_LIFT2(num, sub, HP_NAMED(v_sub), num)
HP_LIFT2(num, mul, HP_NAMED(v_mul), num)
HP_LIFT2(num, div, HP_NAMED(v_div), num)
HP_LIFT1(num, sqrt, v_sqrt, num)
HP_LIFT2(flag, less, v_less, num)
HP_LIFT2(flag, at_most, v_at_most, num)
HP_LIFT2(num, min, v_min, num)
HP_LIFT2(num, max, v_max, num)
HP_LIFT3(num, select, v_select, num)
HP_LIFT3(bits, select_bits, v_select_bits, bits)
HP_LIFT2(flag, and, v_and, flag)
HP_LIFT2(flag, or, v_or, flag)
HP_LIFT1(flag, not, v_not, flag)
HP_LIFT1(num, neg, v_neg, num)
HP_LIFT1(num, abs, v_abs, num)
HP_LIFT2(flag, HP_NAMED(same_bits), v_same_bits, bits)

HP_INLINE num constant(float c) {
    return (num){v_constant(c) HP_SECOND(, v_constant(c))};
}
HP_INLINE bits constant_bits(uint32_t c) {
    return (bits){v_constant_bits(c) HP_SECOND(, v_constant_bits(c))};
}

/* Lanes from memory, unaligned. `load` is for words from outside, `reload` for what this number system computed. */
HP_INLINE num HP_NAMED(reload)(const float *from) {
    return (num){v_load(from) HP_SECOND(, v_load(from + HP_LANES))};
}

HP_INLINE num HP_NAMED(load)(const float *from) {
    return (num){HP_NAMED(v_enter)(v_load(from)) HP_SECOND(, HP_NAMED(v_enter)(v_load(from + HP_LANES)))};
}

HP_INLINE void HP_NAMED(store)(float *to, num x) {
    v_store(to, x.a);
    HP_SECOND(v_store(to + HP_LANES, x.b);)
}

HP_INLINE bits HP_NAMED(load_bits)(const uint32_t *from) {
    return (bits){v_load_bits(from) HP_SECOND(, v_load_bits(from + HP_LANES))};
}

HP_INLINE void HP_NAMED(store_bits)(uint32_t *to, bits x) {
    v_store_bits(to, x.a);
    HP_SECOND(v_store_bits(to + HP_LANES, x.b);)
}

HP_INLINE bool HP_NAMED(any)(flag f) {
#if HP_VECTORS == 2
    return v_any(v_or(f.a, f.b));
#else
    return v_any(f.a);
#endif
}

#define UNLESS_ANY(f) if (__builtin_expect(!HP_NAMED(any)(f), 1))
#define REPEAT(i, n) for (unsigned i = 0; i < (n); i++)

#include "rtl_model/number/vocabulary.h"
