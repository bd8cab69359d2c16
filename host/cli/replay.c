/* hitpipe replay FILE...: golden vectors against a board, bit for bit. docs/vectors.md describes the files. */
#include "host/cli/cli.h"
#include "host/import/vectors.h"
#include "host/output/divergence.h"
#include "host/output/file.h"
#include "host/output/report.h"

#include <stdlib.h>
#include <string.h>

typedef struct replay {
    hp_cli cli;
    char **paths;
    int path_count;
    uint64_t subnormals; /* the board's own, for files that any board must pass */
    uint64_t clock_hz;
    size_t records, differ; /* of all files */
    hp_counters counters;   /* of all files */
    json_t *report;         /* made with the first board; "files" is in it */
} replay;

static error_t parse(int key, char *argument, struct argp_state *state) {
    replay *r = state->input;
    (void)argument;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &r->cli;
        return 0;
    case ARGP_KEY_ARGS:
        r->paths = state->argv + state->next;
        r->path_count = state->argc - state->next;
        return 0;
    case ARGP_KEY_END:
        if (r->path_count == 0) argp_error(state, "which files? For example vectors/ray-triangle/*.hex");
        if (r->cli.vcd_path && r->path_count > 1) argp_error(state, "--vcd takes one FILE: each gets a fresh board");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&hp_cli_argp, 0, "Board and output:", 90}, {0}};
static const struct argp argp = {
    .parser = parse,
    .args_doc = "FILE...",
    .doc =
        "Sends the objects of golden vectors to the board, unchecked, in mode zip, and compares every answer bit for "
        "bit with the expected one.\vThe first record that differs in each file is shown in full. A simulated board "
        "is set to the subnormals that a file is made for; any other must have them.",
    .children = children,
};

/* ---- one file ---- */

/* Opens a board with the numerics of the vectors. */
static hp_status open_board(replay *r, const char *path, hp_numerics numerics, hp_device **device, hp_fault *fault) {
    bool any = numerics == HP_NUMERICS_ANY;
    hp_subnormals wanted = numerics == HP_NUMERICS_FLUSH ? HP_FLUSH : HP_GRADUAL;
    r->cli.device.unchecked = true;
    r->cli.device.board.subnormals = any ? r->subnormals : wanted;
    hp_status status = hp_cli_open(&r->cli, device, fault);
    if (status != HP_OK || any || hp_identify(*device)->subnormals == wanted) return status;
    return hp_fault_set(fault, HP_ERROR_CONFIG, "%s: made for subnormals %s, and board '%s' has the other kind", path,
                        hp_numerics_name(numerics), hp_identify(*device)->name);
}

/* Asks for all pairs at once, so that the board's index of a secondary is the number of its record. */
static hp_status ask(hp_device *device, const char *path, const hp_vectors *vectors, hp_result *answers,
                     hp_counters *counters, hp_fault *fault) {
    hp_query_def def = hp_default_query_def();
    def.pair = vectors->pair;
    def.mode = HP_MODE_ZIP;
    def.separation = vectors->separation ? HP_SEPARATION_ON : HP_SEPARATION_OFF;
    hp_status status = hp_upload(device, hp_pair_secondary(vectors->pair), vectors->secondaries, vectors->count);
    if (status == HP_OK) status = hp_query(device, &def, vectors->primaries, vectors->count, answers);
    if (status == HP_OK) status = hp_read_counters(device, false, counters);
    return status == HP_OK ? HP_OK : hp_cli_device_fault(device, status, path, fault);
}

static hp_status run(replay *r, const char *path, const hp_vectors *vectors, hp_result *answers, hp_fault *fault) {
    hp_device *device;
    hp_counters counters;
    hp_status status = open_board(r, path, vectors->numerics, &device, fault);
    if (status == HP_OK) status = ask(device, path, vectors, answers, &counters, fault);
    if (status == HP_OK) {
        hp_counters_add(&r->counters, &counters);
        r->clock_hz = hp_identify(device)->clock_hz;
        if (!r->report) r->report = hp_report_new(device);
        if (!r->report) status = hp_fault_set(fault, HP_ERROR_MEMORY, "out of memory");
    }
    hp_status closed = hp_cli_close(&r->cli, device, status == HP_OK ? fault : &(hp_fault){0});
    return status == HP_OK ? closed : status;
}

/* Adds what the comparison found to the report, and says it. */
static void tell(replay *r, const char *path, const hp_vectors *vectors, const hp_result *answers) {
    hp_divergence found = hp_diverge(vectors, answers);
    r->records += vectors->count;
    r->differ += found.count;
    json_t *file = json_pack("{s:o, s:s, s:s, s:I, s:I}", "file", hp_report_string(path), "pair",
                             hp_pair_name(vectors->pair), "numerics", hp_numerics_name(vectors->numerics), "records",
                             (json_int_t)vectors->count, "differ", (json_int_t)found.count);
    if (found.count > 0)
        json_object_set_new(file, "first", hp_divergence_json(vectors, found.first, &answers[found.first]));
    if (!json_object_get(r->report, "files")) json_object_set_new(r->report, "files", json_array());
    json_array_append_new(json_object_get(r->report, "files"), file);
    if (r->cli.taken) return;
    printf("%s: %zu of %zu records differ\n", path, found.count, vectors->count);
    if (found.count > 0) hp_divergence_print(stdout, path, vectors, found.first, &answers[found.first]);
}

static hp_status replay_file(replay *r, const char *path, hp_fault *fault) {
    hp_vectors vectors;
    hp_progress_bar_begin(&r->cli.bar, "replaying"); /* until the board is closed */
    hp_status status = hp_vectors_read(path, &vectors, fault);
    if (status != HP_OK) return status;
    hp_result *answers = calloc(vectors.count, sizeof *answers);
    if (!answers) status = hp_fault_set(fault, HP_ERROR_MEMORY, "no memory for %zu results", vectors.count);
    if (status == HP_OK) status = run(r, path, &vectors, answers, fault);
    if (status == HP_OK) tell(r, path, &vectors, answers);
    free(answers);
    hp_vectors_free(&vectors);
    return status;
}

/* ---- all files ---- */

static hp_status write_report(replay *r, double seconds, hp_fault *fault) {
    hp_report_counters(r->report, &r->counters, r->clock_hz);
    hp_report_host(r->report, &r->counters, seconds);
    hp_report_set(r->report, "records", json_integer((json_int_t)r->records));
    hp_report_set(r->report, "differ", json_integer((json_int_t)r->differ));
    hp_status status = r->cli.report ? hp_report_write(r->report, r->cli.report, fault) : HP_OK;
    if (status == HP_OK && r->cli.json) status = hp_report_write(r->report, "-", fault);
    return status;
}

static hp_status conclude(replay *r, hp_fault *fault) {
    char count[HP_COUNT_TEXT];
    if (!r->cli.taken)
        printf("%d file%s, %s records, %zu differ\n", r->path_count, r->path_count == 1 ? "" : "s",
               hp_cli_count(r->records, count), r->differ);
    if (hp_file_finish(stdout, "-", fault) != HP_OK) return fault->status;
    if (r->differ == 0) return HP_OK;
    return hp_fault_set(fault, HP_ERROR_MISMATCH, "%zu of %s records differ from the golden vectors", r->differ,
                        hp_cli_count(r->records, count));
}

int hp_verb_replay(int argc, char **argv) {
    replay r = {.cli = hp_cli_begin(argv[0])};
    argp_parse(&argp, argc, argv, 0, NULL, &r);
    r.subnormals = r.cli.device.board.subnormals;
    hp_fault fault = {0};
    hp_status status = HP_OK;
    double start = hp_seconds();
    for (int i = 0; i < r.path_count && status == HP_OK; i++) status = replay_file(&r, r.paths[i], &fault);
    if (status == HP_OK) status = write_report(&r, hp_seconds() - start, &fault);
    if (status == HP_OK) status = conclude(&r, &fault);
    json_decref(r.report);
    return hp_cli_end(&r.cli, status, &fault);
}
