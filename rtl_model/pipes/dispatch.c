/* Which instruction sets there are, and which one to use. HP_WIDE_ISAS is the build's list, "X(plain)X(sse2)...". */
#include "rtl_model/pipes/wide.h"
#include <hitpipe/pipe.h>
#include <stdlib.h>
#include <string.h>

/* Whether processor and operating system run it. */
static bool runs_plain(void) {
    return true;
}

#if defined __x86_64__
static bool runs_sse2(void) {
    return true;
}
static bool runs_avx2(void) {
    return __builtin_cpu_supports("avx2");
}
static bool runs_avx512(void) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
}
#elif defined __aarch64__
static bool runs_neon(void) {
    return true;
}
#endif

#define X(isa) const hp_wide_pipe *hp_wide_##isa(hp_pair pair);
HP_WIDE_ISAS
#undef X

/* Best last, as the Makefile lists them. */
static const struct {
    const char *name;
    bool (*runs)(void);
    const hp_wide_pipe *(*pipe_of)(hp_pair pair);
} isas[] = {
#define X(isa) {#isa, runs_##isa, hp_wide_##isa},
    HP_WIDE_ISAS
#undef X
};

enum { ISAS = sizeof isas / sizeof *isas };

const char *hp_isa_name(unsigned i) {
    for (unsigned best = ISAS; best-- > 0;)
        if (isas[best].runs() && i-- == 0) return isas[best].name;
    return NULL;
}

const char *hp_isa_choose(const char *forced) {
    const char *wanted = forced ? forced : getenv("HP_ISA");
    if (!forced && wanted && *wanted == '\0') wanted = NULL;
    for (unsigned i = 0;; i++) {
        const char *name = hp_isa_name(i);
        if (!name || !wanted || strcmp(name, wanted) == 0) return name;
    }
}

const hp_wide_pipe *hp_wide_pipe_of(const char *isa, hp_pair pair) {
    for (unsigned i = 0; i < ISAS; i++)
        if (strcmp(isas[i].name, isa) == 0) return isas[i].runs() ? isas[i].pipe_of(pair) : NULL;
    return NULL;
}
