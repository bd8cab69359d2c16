/* Names of the operator vocabulary, so that one text can be included again under another number system.
 *
 * A number system defines HP_MEANING and includes this; every word below then stands for HP_MEANING_word. That keeps
 * two systems apart in one file and lets a pipe say div, abs, sqrt and select where the C library has those names
 * too. Include it after the system headers. */
#ifndef HP_NUMBER_NAMES_H
#define HP_NUMBER_NAMES_H

#define HP_PASTE_(a, b) a##_##b
#define HP_PASTE(a, b) HP_PASTE_(a, b)
#define HP_NAMED(word) HP_PASTE(HP_MEANING, word)

/* Functions of the vocabulary and of the pipes. In wide lanes they must melt into their caller, so that numbers live
 * in registers; where that does not matter a file says HP_CALLED first, and compiles in a fraction of the time. */
#ifdef HP_CALLED
#define HP_INLINE __attribute__((unused)) static
#else
#define HP_INLINE __attribute__((always_inline, unused)) static inline
#endif

/* A loop over copies of hardware side by side, i from `from` to less than `to`. It vanishes, so that what i indexes
 * lives in registers; compilers leave loops in loops alone when their bodies are as long as a pipe's. */
#ifdef HP_CALLED
#define HP_EACH(i, from, to) for (unsigned i = (from); i < (to); i++)
#elif defined __clang__
#define HP_EACH(i, from, to) _Pragma("unroll") for (unsigned i = (from); i < (to); i++)
#else
#define HP_EACH(i, from, to) _Pragma("GCC unroll 32") for (unsigned i = (from); i < (to); i++)
#endif

/* types: a number, a truth value, an index, a point or direction, a pipe's answer */
#define num HP_NAMED(num)
#define flag HP_NAMED(flag)
#define bits HP_NAMED(bits)
#define vec3 HP_NAMED(vec3)
#define answer HP_NAMED(answer)

/* operators: each one is a piece of hardware */
#define constant HP_NAMED(constant)
#define constant_bits HP_NAMED(constant_bits)
#define add HP_NAMED(add)
#define sub HP_NAMED(sub)
#define mul HP_NAMED(mul)
#define div HP_NAMED(div)
#define sqrt HP_NAMED(sqrt)
#define less HP_NAMED(less)
#define at_most HP_NAMED(at_most)
#define min HP_NAMED(min)
#define max HP_NAMED(max)
#define select HP_NAMED(select)
#define select_bits HP_NAMED(select_bits)
#define and HP_NAMED(and)
#define or HP_NAMED(or)
#define not HP_NAMED(not )
#define neg HP_NAMED(neg)
#define abs HP_NAMED(abs)

/* made of them, in vocabulary.h */
#define at_least HP_NAMED(at_least)
#define vec3_of HP_NAMED(vec3_of)
#define put_vec3 HP_NAMED(put_vec3)
#define add3 HP_NAMED(add3)
#define sub3 HP_NAMED(sub3)
#define scale3 HP_NAMED(scale3)
#define neg3 HP_NAMED(neg3)
#define select3 HP_NAMED(select3)
#define cross HP_NAMED(cross)
#define dot HP_NAMED(dot)
#define length HP_NAMED(length)
#define clamp HP_NAMED(clamp)
#define could_count HP_NAMED(could_count)
#define answer_of HP_NAMED(answer_of)
#define answer_with HP_NAMED(answer_with)
#define miss HP_NAMED(miss)

#endif
