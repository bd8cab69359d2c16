#include "host/cli/pair.h"

#include <string.h>

const hp_pair hp_cli_pairs[] = {
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) HP_PAIR_##NAME,
#include <hitpipe/pairs.def>
#undef HP_PAIR
};

const size_t hp_cli_pair_count = sizeof hp_cli_pairs / sizeof hp_cli_pairs[0];

const struct argp hp_cli_pair_argp = {
    .doc =
        "\vPAIR is the type of the primaries and that of the secondaries:"
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) " " typed
#include <hitpipe/pairs.def>
#undef HP_PAIR
        ".\n\nA line of a file is an object, its numbers with commas between. It may end in a comment after #; the "
        "first line may be a header.\n"
#define HP_OBJECT(name, NAME, code, words, layout) "\n  " #name ": " #words " numbers: " layout
#include <hitpipe/objects.def>
#undef HP_OBJECT
};

void hp_cli_pair_names(uint32_t pairs, char *text, size_t room) {
    size_t at = 0;
    snprintf(text, room, "%s", pairs ? "" : "none");
    for (size_t i = 0; i < hp_cli_pair_count && at < room; i++)
        if (pairs >> hp_cli_pairs[i] & 1)
            at += (size_t)snprintf(text + at, room - at, "%s%s", at ? ", " : "", hp_pair_name(hp_cli_pairs[i]));
}

/* The name with its two types in the other order, if that is a pair. */
static const char *swapped(const char *name) {
    for (size_t i = 0; i < hp_cli_pair_count; i++) {
        char other[64];
        snprintf(other, sizeof other, "%s-%s", hp_object_name(hp_pair_secondary(hp_cli_pairs[i])),
                 hp_object_name(hp_pair_primary(hp_cli_pairs[i])));
        if (strcmp(other, name) == 0) return hp_pair_name(hp_cli_pairs[i]);
    }
    return NULL;
}

hp_pair hp_cli_pair_named(const char *name, struct argp_state *state) {
    hp_pair pair = name ? hp_pair_from_name(name) : (hp_pair)0;
    char names[512];
    hp_cli_pair_names(UINT32_MAX, names, sizeof names);
    if (!name) argp_error(state, "which pair? There are %s", names);
    if (!pair && swapped(name))
        argp_error(state, "no pair '%s', but %s: swap primaries and secondaries", name, swapped(name));
    if (!pair) argp_error(state, "no pair '%s'; there are %s", name, names);
    return pair;
}

void hp_cli_two_files(const char *primary, const char *secondary, struct argp_state *state) {
    if (strcmp(primary, "-") == 0 && strcmp(secondary, "-") == 0)
        argp_error(state, "--primary and --secondary cannot both be standard input");
}

hp_status hp_cli_check_resident(const hp_device *device, hp_pair pair, hp_fault *fault) {
    const hp_identity *board = hp_identify(device);
    if (board->pairs >> pair & 1) return HP_OK;
    char names[512];
    hp_cli_pair_names(board->pairs, names, sizeof names);
    return hp_fault_set(fault, HP_ERROR_NOT_RESIDENT, "board '%s' has no pipe %s; it has %s", board->name,
                        hp_pair_name(pair), names);
}
