/* What the verbs of the command line share: the options of every verb, opening the board they name, and the ways to
 * end.
 *
 * A verb is int hp_verb_NAME(int argc, char **argv): argv[0] is "hitpipe NAME", the rest are its arguments; it
 * returns the exit status. It parses with argp and takes hp_cli_argp as a child, whose input is its hp_cli. */
#ifndef HITPIPE_HOST_CLI_H
#define HITPIPE_HOST_CLI_H

#include "host/import/fault.h"
#include "host/output/progress.h"

#include <hitpipe/control.h>
#include <hitpipe/hitpipe.h>

#include <argp.h>
#include <stdio.h>

#define HP_VERB(name, summary) int hp_verb_##name(int argc, char **argv);
#include "host/cli/verbs.def"
#undef HP_VERB

typedef struct hp_cli {
    const char *verb;     /* "hitpipe trace" */
    hp_device_def device; /* --target, --reconnect, --usb-..., --board, --engine, --isa, --threads */
    const char *report;   /* --report */
    const char *vcd_path; /* --vcd */
    bool json;            /* --json */
    bool taken;           /* standard output is for one of these, or for a file that the verb claims */
    FILE *vcd;
    hp_progress_bar bar;
} hp_cli;

/* The options above, for argp_child. Wrong values end the program with status 2 or, for a board, 3. */
extern const struct argp hp_cli_argp;

/* For verbs of the control plane, in its place: --target usb[:SERIAL], --usb-id and --json alone. */
extern const struct argp hp_cli_control_argp;

hp_cli hp_cli_begin(const char *verb);

/* Opens the control plane of the board that the options name. Errors as hp_control_open. */
hp_status hp_cli_control_open(const hp_cli *cli, hp_control **control, hp_fault *fault);

/* Opens the board that the options name. The progress bar shows the driver's progress; Ctrl-C cancels its calls.
 * Errors as hp_open; HP_ERROR_IO: the waveform cannot be written. */
hp_status hp_cli_open(hp_cli *cli, hp_device **device, hp_fault *fault);

/* Closes the board (NULL is fine) and the waveform. HP_ERROR_IO: the waveform was not written whole. */
hp_status hp_cli_close(hp_cli *cli, hp_device *device, hp_fault *fault);

/* Status and words of the last error of a device, as a fault; `place` comes before the words unless NULL. */
hp_status hp_cli_device_fault(const hp_device *device, hp_status status, const char *place, hp_fault *fault);

/* Says what went wrong on standard error, if anything did; the exit status. */
int hp_cli_end(hp_cli *cli, hp_status status, const hp_fault *fault);

/* A verb says so of each file that it will write, unless NULL. Ends the program with status 2 when a second one is
 * "-", standard output. */
void hp_cli_claim(hp_cli *cli, const char *path, struct argp_state *state);

/* Parses digits, and nothing else, that make a number up to `most`. */
bool hp_cli_whole(const char *text, size_t most, size_t *number);

/* Parses exactly n numbers with a comma or blanks between. */
bool hp_cli_numbers(const char *text, double *numbers, size_t n);
/* The same as the nearest binary32 of each, without a double on the way. */
bool hp_cli_floats(const char *text, float *numbers, size_t n);

/* Takes the argument of --separation. Ends the program with status 2 when it is neither on nor off. */
hp_separation hp_cli_separation(const char *text, struct argp_state *state);

/* Parses two whole numbers from 1 to `most` with an 'x' between. */
bool hp_cli_pair(const char *text, size_t most, size_t *first, size_t *second);

/* Writes a count with commas between its thousands into `text`, and returns it. */
enum { HP_COUNT_TEXT = 32 };
const char *hp_cli_count(uint64_t count, char text[HP_COUNT_TEXT]);

#endif
