/* Which instruction sets there are, and which one to use. HP_WIDE_ISAS(X, name, NAME) is the build's
 * list, "X(plain, name, NAME) X(sse2, name, NAME) ...". */
#include "rtl_model/pipes/wide.h"
#include <hitpipe/pipe.h>
#include <stdlib.h>
#include <string.h>

/* Whether processor and operating system run it. */
__attribute__((unused)) static bool runs_plain(void) {
    return true;
}

#if defined __x86_64__
__attribute__((unused)) static bool runs_sse2(void) {
    return true;
}
__attribute__((unused)) static bool runs_avx2(void) {
    return __builtin_cpu_supports("avx2");
}
__attribute__((unused)) static bool runs_avx512(void) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
}
#elif defined __aarch64__
__attribute__((unused)) static bool runs_neon(void) {
    return true;
}
#endif

/* Best last, as the Makefile lists them. */
static const struct {
    const char *name;
    bool (*runs)(void);
} isas[] = {
#define X(isa, name, NAME) {#isa, runs_##isa},
    HP_WIDE_ISAS(X, , )
#undef X
};

#define X(isa, name, NAME) extern const hp_wide_pipe hp_wide_##isa##_##name;
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words) HP_WIDE_ISAS(X, name, NAME)
#include <hitpipe/pairs.def>
#undef HP_PAIR
#undef X

static const struct {
    const char *isa;
    hp_pair pair;
    const hp_wide_pipe *pipe;
} pipes[] = {
#define X(isa, name, NAME) {#isa, HP_PAIR_##NAME, &hp_wide_##isa##_##name},
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, words) HP_WIDE_ISAS(X, name, NAME)
#include <hitpipe/pairs.def>
#undef HP_PAIR
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

static bool runs(const char *isa) {
    for (unsigned i = 0; i < ISAS; i++)
        if (strcmp(isas[i].name, isa) == 0) return isas[i].runs();
    return false;
}

const hp_wide_pipe *hp_wide_pipe_of(const char *isa, hp_pair pair) {
    if (!runs(isa)) return NULL;
    for (unsigned i = 0; i < sizeof pipes / sizeof *pipes; i++)
        if (pipes[i].pair == pair && strcmp(pipes[i].isa, isa) == 0) return pipes[i].pipe;
    return NULL;
}
