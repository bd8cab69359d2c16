/* Number system: the operator graph. A num, a flag and a bits are a node; computing with them adds nodes. No include
 * guard; define HP_MEANING first. The graph that grows is the one traced points at. */
#include "rtl_model/number/graph.h"
#include "rtl_model/number/names.h"

/* Calls here: an operator of the graph is a call already, and thirteen pipes melted into one function keep a compiler
 * busy for minutes. */
#undef HP_INLINE
#define HP_INLINE __attribute__((noinline, unused)) static

typedef struct num {
    bool wired;  /* false: a constant, in the graph once an operator takes it */
    float value; /* of the constant */
    unsigned node;
} num;
typedef num flag;
typedef num bits;

#define UNLESS_ANY(f) if ((void)sizeof(f), false) /* hardware computes everything */
#define REPEAT(i, n)                                                                                                 \
    for (unsigned i = hp_graph_repeat(HP_NAMED(traced), n); hp_graph_repeating(HP_NAMED(traced), i, n); i++)

static _Thread_local hp_graph *HP_NAMED(traced);

HP_INLINE num constant(float c) {
    return (num){.value = c};
}

/* An index is a word of 32 wires like any other; the float with these bits stands for it. */
HP_INLINE bits constant_bits(uint32_t c) {
    bits k = {0};
    memcpy(&k.value, &c, sizeof c);
    return k;
}

HP_INLINE num HP_NAMED(node)(hp_operator operator, unsigned variant, unsigned operands, const num *operand) {
    hp_graph *graph = HP_NAMED(traced);
    unsigned node[HP_GRAPH_OPERANDS] = {0};
    for (unsigned i = 0; i < operands; i++)
        node[i] = operand[i].wired ? operand[i].node : hp_graph_constant(graph, operand[i].value);
    return (num){.wired = true, .node = hp_graph_operator(graph, operator, variant, operands, node)};
}

#define HP_UNARY(name, operator)                                                                                     \
    HP_INLINE num name(num a) {                                                                                      \
        return HP_NAMED(node)(operator, 0, 1, &a);                                                                   \
    }
#define HP_BINARY(name, operator, variant)                                                                           \
    HP_INLINE num name(num a, num b) {                                                                               \
        return HP_NAMED(node)(operator, variant, 2, (num[]){a, b});                                                  \
    }
#define HP_TERNARY(name, operator)                                                                                   \
    HP_INLINE num name(num a, num b, num c) {                                                                        \
        return HP_NAMED(node)(operator, 0, 3, (num[]){a, b, c});                                                     \
    }

HP_BINARY(add, HP_OP_ADD, 0)
HP_BINARY(sub, HP_OP_SUB, 0)
HP_BINARY(mul, HP_OP_MUL, 0)
HP_BINARY(div, HP_OP_DIV, 0)
HP_UNARY(sqrt, HP_OP_SQRT)
HP_BINARY(less, HP_OP_COMPARE, 0)
HP_BINARY(at_most, HP_OP_COMPARE, 1)
HP_BINARY(min, HP_OP_MIN, 0)
HP_BINARY(max, HP_OP_MAX, 0)
HP_TERNARY(select, HP_OP_SELECT)
HP_TERNARY(select_bits, HP_OP_SELECT)
HP_BINARY(and, HP_OP_AND, 0)
HP_BINARY(or, HP_OP_OR, 0)
HP_UNARY(not, HP_OP_NOT)
HP_UNARY(neg, HP_OP_NEG)
HP_UNARY(abs, HP_OP_ABS)

#include "rtl_model/number/vocabulary.h"
