/* Look-ups in the .def tables: status, objects, pairs, modes, registers. */
#include <hitpipe/counters.h>
#include <hitpipe/types.h>
#include <math.h>
#include <string.h>

const char *hp_status_name(hp_status status) {
    switch (status) {
#define HP_STATUS(NAME, code, exit, text, cause)                                                                     \
    case HP_##NAME:                                                                                                  \
        return "HP_" #NAME;
#include <hitpipe/status.def>
#undef HP_STATUS
    }
    return NULL;
}

const char *hp_status_text(hp_status status) {
    switch (status) {
#define HP_STATUS(NAME, code, exit, text, cause)                                                                     \
    case HP_##NAME:                                                                                                  \
        return text;
#include <hitpipe/status.def>
#undef HP_STATUS
    }
    return NULL;
}

const char *hp_status_cause(hp_status status) {
    switch (status) {
#define HP_STATUS(NAME, code, exit, text, cause)                                                                     \
    case HP_##NAME:                                                                                                  \
        return cause;
#include <hitpipe/status.def>
#undef HP_STATUS
    }
    return NULL;
}

int hp_status_exit(hp_status status) {
    switch (status) {
#define HP_STATUS(NAME, code, exit, text, cause)                                                                     \
    case HP_##NAME:                                                                                                  \
        return exit;
#include <hitpipe/status.def>
#undef HP_STATUS
    }
    return 5;
}

const char *hp_object_name(hp_object object) {
    switch (object) {
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    case HP_##NAME:                                                                                                  \
        return #name;
#include <hitpipe/objects.def>
#undef HP_OBJECT
    }
    return NULL;
}

unsigned hp_object_words(hp_object object) {
    switch (object) {
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    case HP_##NAME:                                                                                                  \
        return words;
#include <hitpipe/objects.def>
#undef HP_OBJECT
    }
    return 0;
}

unsigned hp_object_beats(hp_object object) {
    return (hp_object_words(object) + HP_BEAT_WORDS - 1) / HP_BEAT_WORDS;
}

const char *hp_pair_name(hp_pair pair) {
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    case HP_PAIR_##NAME:                                                                                             \
        return typed;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return NULL;
}

hp_object hp_pair_primary(hp_pair pair) {
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    case HP_PAIR_##NAME:                                                                                             \
        return HP_##PRIMARY;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return (hp_object)0;
}

hp_object hp_pair_secondary(hp_pair pair) {
    switch (pair) {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                               \
    case HP_PAIR_##NAME:                                                                                             \
        return HP_##SECONDARY;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    }
    return (hp_object)0;
}

bool hp_pair_keeps_deepest(hp_pair pair) {
    return hp_pair_primary(pair) != HP_RAY;
}

hp_pair hp_pair_from_name(const char *name) {
#define HP_PAIR(lower, NAME, code, typed, PRIMARY, SECONDARY, prepared)                                              \
    if (strcmp(name, typed) == 0) return HP_PAIR_##NAME;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    return (hp_pair)0;
}

const char *hp_mode_name(hp_mode mode) {
    switch (mode) {
#define HP_MODE(name, NAME, code, meaning)                                                                           \
    case HP_MODE_##NAME:                                                                                             \
        return #name;
#include <hitpipe/modes.def>
#undef HP_MODE
    }
    return NULL;
}

hp_mode hp_mode_from_name(const char *name) {
#define HP_MODE(lower, NAME, code, meaning)                                                                          \
    if (strcmp(name, #lower) == 0) return HP_MODE_##NAME;
#include <hitpipe/modes.def>
#undef HP_MODE
    return (hp_mode)0;
}

static bool all_zero(const float *words, unsigned n) {
    for (unsigned i = 0; i < n; i++)
        if (words[i] != 0) return false;
    return true;
}

static bool any_negative(const float *words, unsigned n) {
    for (unsigned i = 0; i < n; i++)
        if (words[i] < 0) return true;
    return false;
}

/* What binary32 words of unit length may be off by, squared lengths and cosines; a few times their rounding. */
#define UNIT_TOLERANCE 4e-6

static double dot(const float *a, const float *b) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* Whether n vectors, one after another, have length 1 and right angles. */
static bool orthonormal(const float *vectors, unsigned n) {
    for (unsigned i = 0; i < n; i++)
        for (unsigned k = i; k < n; k++)
            if (!(fabs(dot(vectors + 3 * i, vectors + 3 * k) - (i == k)) <= UNIT_TOLERANCE)) return false;
    return true;
}

const char *hp_object_fault(hp_object object, const float *words) {
    for (unsigned i = 0; i < hp_object_words(object); i++) {
        if (isnan(words[i])) return "holds a NaN";
        if (isinf(words[i])) return "holds an infinity";
    }
    switch (object) {
    case HP_RAY:
        return all_zero(words + 3, 3) ? "direction is zero" : NULL;
    case HP_TRIANGLE:
        return NULL;
    case HP_SPHERE:
        return any_negative(words + 3, 1) ? "radius is negative" : NULL;
    case HP_AABB:
        for (unsigned i = 0; i < 3; i++)
            if (words[i] > words[i + 3]) return "min is greater than max";
        return NULL;
    case HP_OBB:
        if (any_negative(words + 3, 3)) return "half extent is negative";
        return orthonormal(words + 6, 3) ? NULL : "axes are not orthonormal";
    case HP_CYLINDER:
        if (any_negative(words + 6, 1)) return "radius is negative";
        return words[0] == words[3] && words[1] == words[4] && words[2] == words[5] ? "p0 and p1 are the same point"
                                                                                    : NULL;
    case HP_PLANE:
        if (all_zero(words, 3)) return "normal is zero";
        return fabs(dot(words, words) - 1) > UNIT_TOLERANCE ? "normal is not of length 1" : NULL;
    }
    return "is of no known type";
}

const char *hp_transform_fault(hp_object object, const float matrix[12]) {
    for (unsigned i = 0; i < 12; i++)
        if (!isfinite(matrix[i])) return "the matrix holds a NaN or an infinity";
    float rows[9];
    for (unsigned i = 0; i < 9; i++) rows[i] = matrix[i / 3 * 4 + i % 3];
    bool rigid = orthonormal(rows, 3);
    switch (object) {
    case HP_RAY:
        return "rays are not moved: they are primaries";
    case HP_TRIANGLE:
        return NULL;
    case HP_SPHERE:
        return rigid ? NULL : "a sphere cannot carry a scale or a shear";
    case HP_AABB:
        for (unsigned i = 0; i < 9; i++)
            if (i % 4 == 0 ? rows[i] <= 0 : rows[i] != 0)
                return "an aabb cannot carry a rotation, a reflection, a shear or a scale of 0";
        return NULL;
    case HP_OBB:
        return rigid ? NULL : "an obb cannot carry a scale or a shear";
    case HP_CYLINDER:
        return rigid ? NULL : "a cylinder cannot carry a scale or a shear";
    case HP_PLANE:
        return rigid ? NULL : "a plane cannot carry a scale or a shear";
    }
    return "objects of no known type";
}

static const struct {
    const char *name, *meaning;
} registers[] = {
#define HP_REGISTER(group, name, meaning) {#group "." #name, meaning},
#include <hitpipe/registers.def>
#undef HP_REGISTER
};

_Static_assert(sizeof(hp_counters) == 8 * HP_REGISTER_COUNT,
               "a register is 64 bits and the struct holds nothing else");

const char *hp_register_name(unsigned i) {
    return i < HP_REGISTER_COUNT ? registers[i].name : NULL;
}
const char *hp_register_meaning(unsigned i) {
    return i < HP_REGISTER_COUNT ? registers[i].meaning : NULL;
}

uint64_t hp_register_value(const hp_counters *counters, unsigned i) {
    uint64_t value = 0;
    if (i < HP_REGISTER_COUNT) memcpy(&value, (const char *)counters + 8 * i, 8);
    return value;
}

void hp_register_set(hp_counters *counters, unsigned i, uint64_t value) {
    if (i < HP_REGISTER_COUNT) memcpy((char *)counters + 8 * i, &value, 8);
}
