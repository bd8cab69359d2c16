/* The argument PAIR of `query` and `draw`: its name, its help, and whether the board has its pipe. */
#ifndef HITPIPE_HOST_PAIR_H
#define HITPIPE_HOST_PAIR_H

#include "host/cli/cli.h"

/* Every pair, in the order of pairs.def. */
extern const hp_pair hp_cli_pairs[];
extern const size_t hp_cli_pair_count;

/* A child parser without options: its help lists the pairs, and the words of each type. */
extern const struct argp hp_cli_pair_argp;

/* The pair of a name. Ends the program with status 2 when there is none (NULL: none was given). */
hp_pair hp_cli_pair_named(const char *name, struct argp_state *state);

/* Ends the program with status 2 when both files are "-", standard input, which is there once. */
void hp_cli_two_files(const char *primary, const char *secondary, struct argp_state *state);

/* Writes the names of the pairs in a mask (bit CODE) with commas between, or "none". */
void hp_cli_pair_names(uint32_t pairs, char *text, size_t room);

/* HP_ERROR_NOT_RESIDENT: the board has no pipe for this pair; the fault says which it has. */
hp_status hp_cli_check_resident(const hp_device *device, hp_pair pair, hp_fault *fault);

#endif
