/* hitpipe watch: prints what happens on a board, as it happens. */
#include "host/cli/cli.h"
#include "host/cli/interrupt.h"
#include "host/output/file.h"

#include <hitpipe/packet.h>
#include <hitpipe/usb.h>

#include <inttypes.h>
#include <jansson.h>
#include <time.h>
#include <unistd.h>

enum { KEY_COUNT = 'c', KEY_SECONDS = 's' };
enum { SLICE_MS = 200 }; /* how long Ctrl-C may take, where a signal does not end the wait for an event */

typedef struct watch_options {
    hp_cli cli;
    size_t count;   /* SIZE_MAX: no end */
    double seconds; /* 0: no end */
} watch_options;

static const struct argp_option option_table[] = {
    {"count", KEY_COUNT, "N", 0, "end after N events", 1},
    {"seconds", KEY_SECONDS, "S", 0, "end after S seconds", 1},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state) {
    watch_options *w = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &w->cli;
        return 0;
    case KEY_COUNT:
        if (!hp_cli_whole(argument, SIZE_MAX / 100, &w->count) || w->count == 0)
            argp_error(state, "--count takes a number from 1 on, not '%s'", argument);
        return 0;
    case KEY_SECONDS:
        if (!hp_cli_numbers(argument, &w->seconds, 1) || !(w->seconds > 0 && w->seconds < 1e9))
            argp_error(state, "--seconds takes a number above 0, not '%s'", argument);
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "watch takes no argument, but here is '%s'", argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&hp_cli_control_argp, 0, "Board and output:", 90}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Prints the events of a board as they come: packets that were answered, packets that were refused, "
           "resets.\v"
           "Ends after --count events, after --seconds, or with Ctrl-C, each time with exit status 0. Events that "
           "were lost on the way, because nobody fetched them in time, are counted where they are missing.",
    .children = children,
};

/* ---- printing ---- */

static void print_event(const hp_control_event *event) {
    const char *name = hp_event_name(event->kind);
    if (event->lost) printf("-- %" PRIu32 " event%s lost\n", event->lost, event->lost == 1 ? "" : "s");
    if (name)
        printf("%" PRIu32 "  %-12s", event->number, name);
    else
        printf("%" PRIu32 "  kind %-7u", event->number, event->kind);
    if (event->tag != HP_NO_TAG) printf("  tag %" PRIu32, event->tag);
    printf("  clock %" PRIu64, event->clocks);
    const char *text = hp_status_text(event->status);
    if (event->status != HP_OK && text) printf("  %s", text);
    if (!text) printf("  status %d", (int)event->status);
    putchar('\n');
}

static void print_json(const hp_control_event *event) {
    const char *kind = hp_event_name(event->kind), *status = hp_status_name(event->status);
    json_t *json = json_pack("{s:I, s:I, s:o, s:o, s:o, s:I}", "number", (json_int_t)event->number, "lost",
                             (json_int_t)event->lost, "kind", kind ? json_string(kind) : json_integer(event->kind),
                             "status", status ? json_string(status) : json_integer(event->status), "tag",
                             event->tag == HP_NO_TAG ? json_null() : json_integer(event->tag), "clocks",
                             (json_int_t)event->clocks);
    json_dumpf(json, stdout, JSON_COMPACT);
    putchar('\n');
    json_decref(json);
}

/* ---- watching ---- */

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Milliseconds to wait for, at most a slice; 0 when the time is up. */
static unsigned slice(const watch_options *w, double start) {
    double left = w->seconds > 0 ? 1e3 * (start + w->seconds - now()) : SLICE_MS;
    return left <= 0 ? 0 : left < SLICE_MS ? (unsigned)left + 1 : SLICE_MS;
}

static hp_status take(const watch_options *w, const hp_control_event *event, hp_fault *fault) {
    if (w->cli.json)
        print_json(event);
    else
        print_event(event);
    return hp_file_finish(stdout, "-", fault); /* who reads it wants it now */
}

static hp_status watch(const watch_options *w, hp_control *control, hp_fault *fault) {
    double start = now();
    unsigned wait;
    for (size_t i = 0; i < w->count && !hp_interrupted() && (wait = slice(w, start)) > 0;) {
        hp_control_event event;
        hp_status status = hp_control_next_event(control, wait, &event);
        if (status == HP_ERROR_TIMEOUT || status == HP_ERROR_CANCELLED) continue;
        if (status) return hp_fault_set(fault, status, "%s", hp_control_message(control));
        if (take(w, &event, fault)) return fault->status;
        i++;
    }
    return HP_OK;
}

static void say_begin(const watch_options *w, const hp_control *control) {
    const hp_control_identity *board = hp_control_identify(control);
    if (isatty(STDERR_FILENO) && !w->cli.json)
        fprintf(stderr, "watching board %s (%s), Ctrl-C ends\n", board->serial, board->name);
}

int hp_verb_watch(int argc, char **argv) {
    watch_options w = {.cli = hp_cli_begin(argv[0]), .count = SIZE_MAX};
    argp_parse(&argp, argc, argv, 0, NULL, &w);
    hp_fault fault = {0};
    hp_control *control;
    hp_interrupt_watch();
    hp_status status = hp_cli_control_open(&w.cli, &control, &fault);
    if (!status) {
        say_begin(&w, control);
        status = watch(&w, control, &fault);
    }
    hp_control_close(control);
    return hp_cli_end(&w.cli, status, &fault);
}
