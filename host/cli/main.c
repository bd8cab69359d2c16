/* hitpipe VERB ...: finds the verb. Each verb is a file of its own, listed in verbs.def. */
#include "host/cli/cli.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
} verbs[] = {
#define HP_VERB(name, summary) {#name, summary, hp_verb_##name},
#include "host/cli/verbs.def"
#undef HP_VERB
};

enum { VERB_COUNT = sizeof verbs / sizeof verbs[0] };

const char *argp_program_version = "hitpipe " HITPIPE_VERSION;

static void help(FILE *file) {
    fputs("Usage: hitpipe VERB [OPTION...]\n"
          "Collision and intersection queries on a board, simulated clock by clock.\n\n",
          file);
    for (size_t i = 0; i < VERB_COUNT; i++) fprintf(file, "  %-10s %s\n", verbs[i].name, verbs[i].summary);
    fputs("\n  -?, --help     this text; `hitpipe VERB --help` for a verb's options\n"
          "  -V, --version  the version\n\n"
          "Exit status: 0 done, 1 a comparison failed, 2 wrong use, 3 bad input, 4 device or files, 5 internal "
          "error.\n",
          file);
}

/* A verb that begins like what was typed, to suggest it. */
static const char *resembling(const char *typed) {
    for (size_t n = strlen(typed); n > 0; n--)
        for (size_t i = 0; i < VERB_COUNT; i++)
            if (strncmp(verbs[i].name, typed, n) == 0) return verbs[i].name;
    return NULL;
}

static int refuse(const char *typed) {
    const char *near = typed[0] == '-' ? NULL : resembling(typed);
    fprintf(stderr, "hitpipe: no %s '%s'", typed[0] == '-' ? "option" : "verb", typed);
    if (near) fprintf(stderr, "; did you mean '%s'?", near);
    fputs("\nTry `hitpipe --help' for the list.\n", stderr);
    return hp_status_exit(HP_ERROR_USAGE);
}

int main(int argc, char **argv) {
    argp_err_exit_status = hp_status_exit(HP_ERROR_USAGE);
    if (argc < 2) {
        help(stderr);
        return hp_status_exit(HP_ERROR_USAGE);
    }
    const char *typed = argv[1];
    if (strcmp(typed, "--help") == 0 || strcmp(typed, "-?") == 0 || strcmp(typed, "-h") == 0) {
        help(stdout);
        return fflush(stdout) == 0 ? 0 : hp_status_exit(HP_ERROR_IO);
    }
    if (strcmp(typed, "--version") == 0 || strcmp(typed, "-V") == 0) {
        puts(argp_program_version);
        return fflush(stdout) == 0 ? 0 : hp_status_exit(HP_ERROR_IO);
    }
    for (size_t i = 0; i < VERB_COUNT; i++) {
        if (strcmp(verbs[i].name, typed) != 0) continue;
        char name[32];
        snprintf(name, sizeof name, "hitpipe %s", typed);
        argv[1] = name;
        return verbs[i].run(argc - 1, argv + 1);
    }
    return refuse(typed);
}
