/* The words of hitpipe: objects, pairs, modes, results and status codes, made from the .def tables.
 *
 * All floats are IEEE 754 binary32. Shapes and units stand with each type. Nothing here allocates or keeps state, so
 * everything here may be used from any thread. */
#ifndef HITPIPE_TYPES_H
#define HITPIPE_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Status of a call: HP_OK is 0, everything else is an error. status.def has the cause of each. */
typedef enum hp_status {
#define HP_STATUS(NAME, code, exit, text, cause) HP_##NAME = code,
#include <hitpipe/status.def>
#undef HP_STATUS
} hp_status;

/* Object types. */
typedef enum hp_object {
#define HP_OBJECT(name, NAME, code, words, layout) HP_##NAME = code,
#include <hitpipe/objects.def>
#undef HP_OBJECT
} hp_object;

/* 32-bit words of one object, as constants: HP_RAY_WORDS is 6. */
enum {
#define HP_OBJECT(name, NAME, code, words, layout) HP_##NAME##_WORDS = words,
#include <hitpipe/objects.def>
#undef HP_OBJECT
    HP_OBJECT_WORDS_MAX = 15,
    HP_BEAT_WORDS = 9,         /* words the secondary bus carries in a clock: 288 bits */
    HP_PACKET_PRIMARIES = 256, /* most primaries in a packet */
    HP_RESULT_WORDS = 7        /* F, index, T, CP xyz, stencil */
};

/* Pairs of object types, primary first: one pipe each. */
typedef enum hp_pair {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME = code,
#include <hitpipe/pairs.def>
#undef HP_PAIR
} hp_pair;

/* What a query keeps. */
typedef enum hp_mode {
#define HP_MODE(name, NAME, code, meaning) HP_MODE_##NAME = code,
#include <hitpipe/modes.def>
#undef HP_MODE
} hp_mode;

/* What a query may ask for beyond its mode: a mask. */
typedef enum hp_option {
#define HP_OPTION(name, NAME, bit, meaning) HP_OPTION_##NAME = 1 << bit,
#include <hitpipe/options.def>
#undef HP_OPTION
} hp_option;

enum {
    HP_OPTIONS_ALL = 0
#define HP_OPTION(name, NAME, bit, meaning) | HP_OPTION_##NAME
#include <hitpipe/options.def>
#undef HP_OPTION
};

/* The order of the two loops of a query (knob loop_order). */
typedef enum hp_loop_order { HP_PRIMARY_OUTER = 0, HP_SECONDARY_OUTER = 1 } hp_loop_order;

/* Underflow (knob subnormals). HP_FLUSH: operands and results that are subnormal become zero of their sign; a result
 * is subnormal when, rounded to 24 bits as if the exponent had no bounds, it is below 2^-126. */
typedef enum hp_subnormals { HP_GRADUAL = 0, HP_FLUSH = 1 } hp_subnormals;

#define HP_NO_INDEX 0xFFFFFFFFu /* index of a miss */

/* One record of an answer, as the output SRAMs hold it: seven 32-bit words. A miss has F 0, index HP_NO_INDEX, T +inf
 * and CP 0, 0, 0; with the option separation T is its distance, with nearest index is the secondary it misses least.
 */
typedef struct hp_result {
    uint32_t F;       /* collision flag: 0 or 1 */
    uint32_t index;   /* which secondary */
    float T;          /* ray pairs: units of the direction; others: length. design table in docs/architecture.md */
    float CP[3];      /* collision position */
    uint32_t stencil; /* 1: the primary is still looking; 0: stopped by mode any */
} hp_result;

/* What stands in the tables about a code, or NULL / 0 for a code that is not in them. Strings live for ever. */
const char *hp_status_name(hp_status status);  /* "HP_ERROR_CRC" */
const char *hp_status_text(hp_status status);  /* "packet with a wrong CRC" */
const char *hp_status_cause(hp_status status); /* what brings it about */
int hp_status_exit(hp_status status);          /* exit status of the command line */
const char *hp_object_name(hp_object object);  /* "triangle" */
unsigned hp_object_words(hp_object object);
unsigned hp_object_beats(hp_object object); /* clocks of the secondary bus an object takes */
const char *hp_pair_name(hp_pair pair);     /* "ray-triangle" */
hp_object hp_pair_primary(hp_pair pair);
hp_object hp_pair_secondary(hp_pair pair);
const char *hp_mode_name(hp_mode mode); /* "closest" */
/* Which of its hits mode closest keeps for a primary: the one with the largest T (penetration depth), or the smallest
 * (ray pairs). */
bool hp_pair_keeps_deepest(hp_pair pair);

/* The code of a typed name, or 0. */
hp_pair hp_pair_from_name(const char *name);
hp_mode hp_mode_from_name(const char *name);

/* Whether an object may be sent: every word finite, and what its type forbids absent (a zero direction, p0 = p1, a
 * negative size, min > max, axes of an obb that are not orthonormal or a normal of a plane that is not of length 1,
 * to within 4e-6). Returns NULL when it may, else what is wrong with it ("direction is zero"). */
const char *hp_object_fault(hp_object object, const float *words);

/* The same of `count` objects, one after another, and quicker: *at is the number of the first that may not be sent.
 */
const char *hp_objects_fault(hp_object object, const float *words, size_t count, size_t *at);

/* Whether objects of this type can be moved by the 3x4 row-major matrix: triangles by any, an aabb by one that moves
 * and stretches along the axes, the others by a rigid one (a rotation or reflection, to within 4e-6, and any
 * translation). Returns NULL when they can, else why not ("a sphere cannot carry a scale or a shear"). */
const char *hp_transform_fault(hp_object object, const float matrix[12]);

#ifdef __cplusplus
}
#endif
#endif
