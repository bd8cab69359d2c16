/* hitpipe query PAIR: primaries of one CSV file against secondaries of another. */
#include "host/cli/pair.h"
#include "host/import/csv.h"
#include "host/import/shape.h"
#include "host/output/file.h"
#include "host/output/report.h"
#include "host/output/result_csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    KEY_PRIMARY = 'p',
    KEY_SECONDARY = 's',
    KEY_MODE = 'm',
    KEY_OUT = 'o',
    KEY_TRANSFORM = 't',
    KEY_NEAREST = 'n',
    KEY_SEPARATION = 0x2000
};

typedef struct query_options {
    hp_cli cli;
    hp_query_def def;
    const char *pair, *primary, *secondary, *out;
    bool moved;
    float matrix[12];
} query_options;

static const struct argp_option option_table[] = {
    {"primary", KEY_PRIMARY, "P.csv", 0, "primaries, one a line, words in the order of the table below", 1},
    {"secondary", KEY_SECONDARY, "S.csv", 0, "secondaries, likewise", 1},
    {"mode", KEY_MODE, "MODE", 0, "closest (default), any, all, or zip: primary i against secondary i", 1},
    {"nearest", KEY_NEAREST, NULL, 0, "mode closest: a primary without a hit shows the secondary it misses least", 1},
    {"separation", KEY_SEPARATION, "on|off", 0,
     "whether the board computes the distance of a miss (default: where it shows, in modes all and zip and with "
     "--nearest)",
     1},
    {"out", KEY_OUT, "R.csv", 0, "results: primary,secondary,F,T,cpx,cpy,cpz (default: standard output)", 1},
    {"transform", KEY_TRANSFORM, "12 NUMBERS", 0, "move the secondaries by this 3x4 matrix, row by row", 1},
    {0},
};

static void set_transform(query_options *query, const char *text, struct argp_state *state) {
    if (!hp_cli_floats(text, query->matrix, 12))
        argp_error(state, "--transform takes 12 numbers with commas between, not '%s'", text);
    query->moved = true;
}

static void check_complete(query_options *query, struct argp_state *state) {
    query->def.pair = hp_cli_pair_named(query->pair, state);
    if (!query->primary || !query->secondary) argp_error(state, "--primary and --secondary are needed");
    hp_cli_two_files(query->primary, query->secondary, state);
    if (query->def.nearest && query->def.mode != HP_MODE_CLOSEST) argp_error(state, "--nearest is for mode closest");
    if (query->def.nearest && query->def.separation == HP_SEPARATION_OFF)
        argp_error(state, "--nearest needs the distance of a miss: not --separation off");
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    query_options *query = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &query->cli;
        return 0;
    case KEY_PRIMARY:
        query->primary = argument;
        return 0;
    case KEY_SECONDARY:
        query->secondary = argument;
        return 0;
    case KEY_OUT:
        query->out = argument;
        return 0;
    case KEY_TRANSFORM:
        set_transform(query, argument, state);
        return 0;
    case KEY_NEAREST:
        query->def.nearest = true;
        return 0;
    case KEY_SEPARATION:
        query->def.separation = hp_cli_separation(argument, state);
        return 0;
    case KEY_MODE:
        query->def.mode = hp_mode_from_name(argument);
        if (!query->def.mode) argp_error(state, "--mode is closest, any, all or zip, not '%s'", argument);
        return 0;
    case ARGP_KEY_ARG:
        if (query->pair) argp_error(state, "'%s' is one argument too many", argument);
        query->pair = argument;
        return 0;
    case ARGP_KEY_END:
        check_complete(query, state);
        hp_cli_claim(&query->cli, query->out, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {
    {&hp_cli_argp, 0, "Board and output:", 90}, {&hp_cli_pair_argp, 0, NULL, 0}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "PAIR",
    .doc = "Tests primaries against secondaries on the board.",
    .children = children,
};

/* ---- running ---- */

/* Whether the secondaries' type can carry the matrix. hp_query would refuse it too, in fewer words. */
static hp_status check_transform(const query_options *query, hp_fault *fault) {
    hp_object object = hp_pair_secondary(query->def.pair);
    float rows[9];
    for (unsigned i = 0; i < 12; i++)
        if (!isfinite(query->matrix[i]))
            return hp_fault_set(fault, HP_ERROR_INPUT, "--transform: number %u of 12 is %s", i + 1,
                                isnan(query->matrix[i]) ? "a NaN" : "an infinity, or past binary32");
    const char *wrong = hp_transform_fault(object, query->matrix);
    if (!wrong) return HP_OK;
    for (unsigned i = 0; i < 9; i++) rows[i] = query->matrix[i / 3 * 4 + i % 3];
    hp_product worst = hp_worst_product(rows, 3);
    if (object == HP_AABB) return hp_fault_set(fault, HP_ERROR_INPUT, "--transform: %s", wrong);
    if (worst.i == worst.k)
        return hp_fault_set(fault, HP_ERROR_INPUT, "--transform: %s: row %u has the squared length %.7g, not 1",
                            wrong, worst.i + 1, worst.value);
    return hp_fault_set(fault, HP_ERROR_INPUT, "--transform: %s: rows %u and %u have the scalar product %.7g, not 0",
                        wrong, worst.i + 1, worst.k + 1, worst.value);
}

static bool take_records(void *file, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                         size_t count) {
    for (size_t i = 0; i < count; i++) hp_result_csv_line(file, primary[i], secondary[i], &records[i]);
    return !ferror((FILE *)file);
}

static hp_status ask(const query_options *query, hp_device *device, const hp_objects *primaries, FILE *file,
                     hp_fault *fault) {
    hp_status status;
    if (query->def.mode == HP_MODE_ALL) {
        status = hp_query_all(device, &query->def, primaries->words, primaries->count, take_records, file);
        return status == HP_OK ? HP_OK : hp_cli_device_fault(device, status, query->primary, fault);
    }
    hp_result *results = calloc(primaries->count, sizeof *results);
    if (!results) return hp_fault_set(fault, HP_ERROR_MEMORY, "no memory for %zu results", primaries->count);
    status = hp_query(device, &query->def, primaries->words, primaries->count, results);
    if (status != HP_OK) hp_cli_device_fault(device, status, query->primary, fault);
    for (size_t i = 0; i < primaries->count && status == HP_OK; i++)
        hp_result_csv_line(file, i, query->def.mode == HP_MODE_ZIP ? (uint32_t)i : results[i].index, &results[i]);
    free(results);
    return status;
}

static hp_status send_scene(const query_options *query, hp_device *device, const hp_objects *secondaries,
                            hp_fault *fault) {
    hp_object object = hp_pair_secondary(query->def.pair);
    hp_status status = hp_upload(device, object, secondaries->words, secondaries->count);
    if (status != HP_OK) return hp_cli_device_fault(device, status, query->secondary, fault);
    if (query->moved) status = hp_transform(device, query->matrix);
    return status == HP_OK ? HP_OK : hp_cli_device_fault(device, status, "--transform", fault);
}

static hp_status write_report(const query_options *query, hp_device *device, double seconds, hp_fault *fault) {
    hp_counters counters;
    hp_status status = hp_read_counters(device, false, &counters);
    if (status != HP_OK) return hp_cli_device_fault(device, status, NULL, fault);
    json_t *report = hp_report_new(device);
    if (!report) return hp_fault_set(fault, HP_ERROR_MEMORY, "out of memory");
    hp_report_counters(report, &counters, hp_identify(device)->clock_hz);
    hp_report_host(report, &counters, seconds);
    hp_report_set(report, "pair", json_string(query->pair));
    hp_report_set(report, "mode", json_string(hp_mode_name(query->def.mode)));
    if (query->cli.report) status = hp_report_write(report, query->cli.report, fault);
    if (status == HP_OK && query->cli.json) status = hp_report_write(report, "-", fault);
    json_decref(report);
    return status;
}

static hp_status run_on_board(query_options *query, const hp_objects *primaries, const hp_objects *secondaries,
                              hp_fault *fault) {
    hp_device *device;
    hp_status status = hp_cli_open(&query->cli, &device, fault), closed;
    double start = hp_seconds();
    if (status == HP_OK) status = hp_cli_check_resident(device, query->def.pair, fault);
    if (status == HP_OK) status = hp_file_probe(query->out, fault);
    if (status == HP_OK) status = send_scene(query, device, secondaries, fault);
    FILE *file = status == HP_OK ? hp_file_create(query->out, fault) : NULL; /* from here on older results are gone */
    if (status == HP_OK && !file) status = fault->status;
    if (status == HP_OK) {
        hp_result_csv_header(file);
        hp_progress_bar_begin(&query->cli.bar, "querying");
        status = ask(query, device, primaries, file, fault);
    }
    if (file) {
        hp_fault broken;
        closed = hp_file_finish(file, query->out, &broken);
        /* a full disk shows to the board as a cancelled query: the cause is the disk */
        if (closed != HP_OK && (status == HP_OK || status == HP_ERROR_CANCELLED)) status = closed, *fault = broken;
    }
    if (status == HP_OK && (query->cli.report || query->cli.json))
        status = write_report(query, device, hp_seconds() - start, fault);
    closed = hp_cli_close(&query->cli, device, status == HP_OK ? fault : &(hp_fault){0});
    return status == HP_OK ? closed : status;
}

int hp_verb_query(int argc, char **argv) {
    query_options query = {.cli = hp_cli_begin(argv[0]), .def = hp_default_query_def()};
    argp_parse(&argp, argc, argv, 0, NULL, &query);
    if (!query.out) query.out = query.cli.taken ? "/dev/null" : "-";
    if (strcmp(query.out, "-") == 0 && isatty(STDOUT_FILENO)) query.cli.bar.terminal = false; /* results go there */
    hp_fault fault = {0};
    hp_objects primaries = {0}, secondaries = {0};
    hp_progress_bar_begin(&query.cli.bar, "reading");
    hp_status status = query.moved ? check_transform(&query, &fault) : HP_OK;
    if (status == HP_OK) status = hp_csv_load(query.primary, hp_pair_primary(query.def.pair), &primaries, &fault);
    if (status == HP_OK)
        status = hp_csv_load(query.secondary, hp_pair_secondary(query.def.pair), &secondaries, &fault);
    if (status == HP_OK && query.def.mode == HP_MODE_ZIP && primaries.count != secondaries.count)
        status =
            hp_fault_set(&fault, HP_ERROR_INPUT, "zip needs as many secondaries as primaries, here are %zu and %zu",
                         secondaries.count, primaries.count);
    if (status == HP_OK) status = run_on_board(&query, &primaries, &secondaries, &fault);
    hp_objects_free(&primaries);
    hp_objects_free(&secondaries);
    return hp_cli_end(&query.cli, status, &fault);
}
