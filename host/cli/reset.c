/* hitpipe reset: resets a board over its control plane, or only drops what waits there; chooses its clock. */
#include "host/cli/cli.h"
#include "host/output/file.h"
#include "host/output/report.h"

#include <inttypes.h>

enum { KEY_ABORT = 'a', KEY_CLOCK = 'c' };

typedef struct reset_options {
    hp_cli cli;
    bool abort;
    bool clock;
    size_t hz;
} reset_options;

static const struct argp_option option_table[] = {
    {"abort", KEY_ABORT, NULL, 0, "in place of a reset, drop the packets that are not begun; the session stays", 1},
    {"clock", KEY_CLOCK, "HZ", 0, "before that, choose the core clock: in use from the next session on", 1},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state) {
    reset_options *r = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &r->cli;
        return 0;
    case KEY_ABORT:
        r->abort = true;
        return 0;
    case KEY_CLOCK:
        r->clock = true;
        if (!hp_cli_whole(argument, SIZE_MAX / 100, &r->hz) || r->hz == 0)
            argp_error(state, "--clock takes a whole number of hertz, not '%s'", argument);
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "reset takes no argument, but here is '%s'", argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&hp_cli_control_argp, 0, "Board and output:", 90}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Resets a board: what is under way there is dropped; session, scene and matrix are forgotten.\v"
           "The command goes over the board's control plane, beside the packets, so it works while another program "
           "uses the board, and on a board that does not answer packets any more.",
    .children = children,
};

/* Everything or nothing: a board that lacks a feature is left as it is. */
static hp_status check(const reset_options *r, hp_control *control) {
    bool can = hp_control_can(control, r->abort ? HP_FEATURE_ABORT : HP_FEATURE_RESET);
    if (r->clock && !can) return r->abort ? hp_control_abort(control) : hp_control_reset(control); /* says so */
    return HP_OK;
}

static hp_status carry_out(const reset_options *r, hp_control *control, hp_fault *fault) {
    hp_status status = check(r, control);
    if (!status && r->clock) status = hp_control_set_clock(control, r->hz);
    if (!status) status = r->abort ? hp_control_abort(control) : hp_control_reset(control);
    return status ? hp_fault_set(fault, status, "%s", hp_control_message(control)) : HP_OK;
}

static hp_status tell(const reset_options *r, const hp_control *control, hp_fault *fault) {
    const hp_control_identity *board = hp_control_identify(control);
    const char *done = r->abort ? "abort" : "reset";
    if (!r->cli.json) {
        printf("board %s (%s): ", board->serial, board->name);
        if (r->clock) printf("clock of %zu Hz from the next session on, ", r->hz);
        printf("%s done\n", done);
        return HP_OK;
    }
    json_t *json = json_pack("{s:s, s:s, s:s}", "serial", board->serial, "board", board->name, "done", done);
    if (r->clock) hp_report_set(json, "clock_hz", json_integer((json_int_t)r->hz));
    hp_status status = hp_report_write(json, "-", fault);
    json_decref(json);
    return status;
}

int hp_verb_reset(int argc, char **argv) {
    reset_options r = {.cli = hp_cli_begin(argv[0])};
    argp_parse(&argp, argc, argv, 0, NULL, &r);
    hp_fault fault = {0};
    hp_control *control;
    hp_status status = hp_cli_control_open(&r.cli, &control, &fault);
    if (!status) status = carry_out(&r, control, &fault);
    if (!status) status = tell(&r, control, &fault);
    if (!status) status = hp_file_finish(stdout, "-", &fault);
    hp_control_close(control);
    return hp_cli_end(&r.cli, status, &fault);
}
