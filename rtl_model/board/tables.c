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
        for (unsigned axis = 6; axis < 15; axis += 3)
            if (all_zero(words + axis, 3)) return "axis is zero";
        return NULL;
    case HP_CYLINDER:
        if (any_negative(words + 6, 1)) return "radius is negative";
        return words[0] == words[3] && words[1] == words[4] && words[2] == words[5] ? "p0 and p1 are the same point"
                                                                                    : NULL;
    case HP_PLANE:
        return all_zero(words, 3) ? "normal is zero" : NULL;
    }
    return "is of no known type";
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
