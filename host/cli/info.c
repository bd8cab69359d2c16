/* hitpipe info: the boards there are, the knobs of one, and what its pipes are made of. */
#include "host/cli/pair.h"
#include "host/cli/plugged.h"
#include "host/output/file.h"
#include "host/output/report.h"

#include <hitpipe/pipe.h>

#include <inttypes.h>
#include <string.h>

enum { KEY_PIPES = 'p', KEY_CONFIG = 'c' };

typedef struct info_options {
    hp_cli cli;
    bool pipes, config;
} info_options;

static const struct argp_option option_table[] = {
    {"pipes", KEY_PIPES, NULL, 0, "operators, levels and latency of every pipe under the board's operator table", 1},
    {"config", KEY_CONFIG, NULL, 0, "every knob of the board: value, range, meaning", 1},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state) {
    info_options *info = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &info->cli;
        return 0;
    case KEY_PIPES:
        info->pipes = true;
        return 0;
    case KEY_CONFIG:
        info->config = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "info takes no argument, but here is '%s'", argument);
        return 0;
    case ARGP_KEY_END:
        if (info->pipes && info->config) argp_error(state, "--pipes and --config exclude each other");
        if ((info->pipes || info->config) && (info->cli.report || info->cli.vcd_path))
            argp_error(state, "--pipes and --config ask no board: there is nothing for --report and --vcd");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&hp_cli_argp, 0, "Board and output:", 90}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Shows the boards found and what each can do.\v"
           "Of the pipes: operators as counted in the operator graph, those of a loop once; levels: operators on the "
           "longest path; clocks: latency; interval: clocks between two tests in a lane.",
    .children = children,
};

/* ---- pipes ---- */

/* The numbers of a pipe, under these keys and, those with a column, in the table. */
static const struct cost_field {
    const char *key, *column;
    size_t offset; /* in hp_pipe_cost */
    int width;
} cost_fields[] = {
    {"multipliers", "mul", offsetof(hp_pipe_cost, multipliers), 6},
    {"dividers", "div", offsetof(hp_pipe_cost, dividers), 5},
    {"square_roots", "sqrt", offsetof(hp_pipe_cost, square_roots), 6},
    {"adders", "add", offsetof(hp_pipe_cost, adders), 6},
    {"subtractors", "sub", offsetof(hp_pipe_cost, subtractors), 6},
    {"comparators", "cmp", offsetof(hp_pipe_cost, comparators), 6},
    {"selects", "select", offsetof(hp_pipe_cost, selects), 8},
    {"ands", "and", offsetof(hp_pipe_cost, ands), 5},
    {"ors", "or", offsetof(hp_pipe_cost, ors), 5},
    {"levels", "levels", offsetof(hp_pipe_cost, levels), 9},
    {"clocks", "clocks", offsetof(hp_pipe_cost, clocks), 9},
    {"interval", "interval", offsetof(hp_pipe_cost, interval), 10},
    {"inputs", NULL, offsetof(hp_pipe_cost, inputs), 0},
    {"outputs", NULL, offsetof(hp_pipe_cost, outputs), 0},
    {"clocks_F", NULL, offsetof(hp_pipe_cost, clocks_F), 0},
    {"clocks_T", NULL, offsetof(hp_pipe_cost, clocks_T), 0},
    {"clocks_CP", NULL, offsetof(hp_pipe_cost, clocks_CP), 0},
};

enum { COST_FIELDS = sizeof cost_fields / sizeof cost_fields[0] };

static unsigned cost_number(const hp_pipe_cost *cost, const struct cost_field *field) {
    unsigned number;
    memcpy(&number, (const char *)cost + field->offset, sizeof number);
    return number;
}

static void put_cost(json_t *json, const hp_pipe_cost *cost) {
    for (const struct cost_field *field = cost_fields; field < cost_fields + COST_FIELDS; field++)
        hp_report_set(json, field->key, json_integer(cost_number(cost, field)));
}

static json_t *pipe_json(hp_pair pair, const hp_config *board) {
    hp_pipe_cost plain = hp_pipe_cost_of(pair, false, board), separating = hp_pipe_cost_of(pair, true, board);
    json_t *pipe = json_object(), *with = json_object();
    hp_report_set(pipe, "pair", json_string(hp_pair_name(pair)));
    hp_report_set(pipe, "resident", json_boolean(board->pipes >> pair & 1));
    put_cost(pipe, &plain);
    put_cost(with, &separating);
    hp_report_set(pipe, "separation", with);
    return pipe;
}

static void print_cost(const char *name, const hp_pipe_cost *cost, const char *remark) {
    printf("%-19s", name);
    for (const struct cost_field *field = cost_fields; field < cost_fields + COST_FIELDS; field++)
        if (field->column) printf("%*u", field->width, cost_number(cost, field));
    printf("%s\n", remark);
}

static void print_pipes(const hp_config *board) {
    printf(
        "Pipes under the operator table of board '%s', and below each the same with the distance of a miss:\n\n%-19s",
        board->name, "pair");
    for (const struct cost_field *field = cost_fields; field < cost_fields + COST_FIELDS; field++)
        if (field->column) printf("%*s", field->width, field->column);
    putchar('\n');
    for (size_t i = 0; i < hp_cli_pair_count; i++) {
        hp_pair pair = hp_cli_pairs[i];
        hp_pipe_cost plain = hp_pipe_cost_of(pair, false, board), separating = hp_pipe_cost_of(pair, true, board);
        print_cost(hp_pair_name(pair), &plain, board->pipes >> pair & 1 ? "" : "  not resident");
        print_cost("  with separation", &separating, "");
    }
}

/* ---- knobs ---- */

static json_t *config_json(const hp_config *board) {
    json_t *knobs = json_array();
    for (unsigned i = 0; hp_config_key(i); i++) {
        char value[HP_CONFIG_MESSAGE], range[HP_CONFIG_MESSAGE];
        hp_config_get(board, hp_config_key(i), value, sizeof value);
        hp_config_range(i, range, sizeof range);
        json_array_append_new(knobs, json_pack("{s:s, s:s, s:s, s:s}", "key", hp_config_key(i), "value", value,
                                               "range", range, "meaning", hp_config_meaning(i)));
    }
    return knobs;
}

static void print_config(const hp_config *board) {
    printf("%-32s %-18s %-34s %s\n", "key", "value", "range", "meaning");
    for (unsigned i = 0; hp_config_key(i); i++) {
        char value[HP_CONFIG_MESSAGE], range[HP_CONFIG_MESSAGE];
        hp_config_get(board, hp_config_key(i), value, sizeof value);
        hp_config_range(i, range, sizeof range);
        printf("%-32s %-18s %-34s %s\n", hp_config_key(i), value, range, hp_config_meaning(i));
    }
}

/* ---- boards ---- */

static void print_link(const hp_config *config) {
    printf("link       %s duplex, %.4g MB/s to the board, %.4g MB/s to the host, %.4g us a transfer\n",
           config->link_duplex ? "full" : "half", (double)config->link_to_board_rate / 1e6,
           (double)config->link_to_host_rate / 1e6, (double)config->link_turnaround_ns / 1e3);
}

static void print_board(const hp_device *device, const hp_config *config) {
    const hp_identity *board = hp_identify(device);
    char names[512], count[HP_COUNT_TEXT];
    hp_cli_pair_names(board->pairs, names, sizeof names);
    bool simulated = board->isa[0];
    printf("target     %s\nboard      %s, protocol %u\nengine     %s%s%s\n", board->target, board->name,
           board->version, board->engine, simulated ? ", arithmetic on " : "", board->isa);
    printf("clock      %.6g MHz, lanes: %u, %s, subnormals %s\n", (double)board->clock_hz / 1e6, board->lanes,
           board->loop_order == HP_PRIMARY_OUTER ? "primary-outer" : "secondary-outer",
           board->subnormals == HP_FLUSH ? "flushed" : "gradual");
    printf("packets    %u primaries, %u on the board at a time\n", board->packet_primaries, board->packet_buffers);
    printf("memory     %s MiB for secondaries\n", hp_cli_count(board->ddr_bytes >> 20, count));
    if (simulated) print_link(config);
    printf("pipes      %s\n", names);
}

static void print_presets(void) {
    fputs("\nPresets for --board:", stdout);
    for (unsigned i = 0; hp_config_preset_name(i); i++) printf("%s %s", i ? "," : "", hp_config_preset_name(i));
    fputs(". `hitpipe info --pipes` shows what a pipe costs, `--config` every knob.\n", stdout);
}

static json_t *board_json(const hp_device *device) {
    const hp_identity *board = hp_identify(device);
    char names[512];
    hp_cli_pair_names(board->pairs, names, sizeof names);
    json_t *json = hp_report_new(device);
    hp_report_set(json, "protocol", json_integer(board->version));
    hp_report_set(json, "clock_hz", json_integer((json_int_t)board->clock_hz));
    hp_report_set(json, "lanes", json_integer(board->lanes));
    hp_report_set(json, "packet_primaries", json_integer(board->packet_primaries));
    hp_report_set(json, "packet_buffers", json_integer(board->packet_buffers));
    hp_report_set(json, "ddr_bytes", json_integer((json_int_t)board->ddr_bytes));
    hp_report_set(json, "pairs", json_string(names));
    return json;
}

static hp_status write_report(hp_device *device, const char *path, hp_fault *fault) {
    hp_counters counters;
    double start = hp_seconds();
    hp_status status = hp_read_counters(device, false, &counters);
    if (status != HP_OK) return hp_cli_device_fault(device, status, NULL, fault);
    json_t *report = hp_report_new(device);
    hp_report_counters(report, &counters, hp_identify(device)->clock_hz);
    hp_report_host(report, &counters, hp_seconds() - start);
    status = hp_report_write(report, path, fault);
    json_decref(report);
    return status;
}

static hp_status show_json(const hp_device *device, const hp_plugged *plugged, hp_fault *fault) {
    json_t *boards = json_pack("[o]", board_json(device));
    hp_plugged_json(plugged, boards);
    hp_status status = hp_report_write(boards, "-", fault);
    json_decref(boards);
    return status;
}

/* The board that is the target, and all that are plugged in. */
static hp_status show_all(info_options *info, const hp_device *device, hp_fault *fault) {
    hp_plugged plugged;
    hp_status status = hp_plugged_find(&info->cli, &plugged, fault);
    if (status == HP_OK && info->cli.json) {
        status = show_json(device, &plugged, fault);
    } else if (status == HP_OK) {
        print_board(device, &info->cli.device.board);
        hp_plugged_print(&info->cli, &plugged);
        print_presets();
    }
    hp_plugged_free(&plugged);
    return status;
}

static hp_status show_boards(info_options *info, hp_fault *fault) {
    hp_device *device;
    hp_status status = hp_cli_open(&info->cli, &device, fault);
    if (status == HP_OK && (info->cli.json || !info->cli.taken)) status = show_all(info, device, fault);
    if (status == HP_OK && info->cli.report) status = write_report(device, info->cli.report, fault);
    hp_status closed = hp_cli_close(&info->cli, device, status == HP_OK ? fault : &(hp_fault){0});
    return status == HP_OK ? closed : status;
}

static hp_status show_pipes_json(const hp_config *board, hp_fault *fault) {
    json_t *pipes = json_array();
    for (size_t i = 0; i < hp_cli_pair_count; i++) json_array_append_new(pipes, pipe_json(hp_cli_pairs[i], board));
    hp_status status = hp_report_write(pipes, "-", fault);
    json_decref(pipes);
    return status;
}

static hp_status show_config_json(const hp_config *board, hp_fault *fault) {
    json_t *knobs = config_json(board);
    hp_status status = hp_report_write(knobs, "-", fault);
    json_decref(knobs);
    return status;
}

int hp_verb_info(int argc, char **argv) {
    info_options info = {.cli = hp_cli_begin(argv[0])};
    argp_parse(&argp, argc, argv, 0, NULL, &info);
    const hp_config *board = &info.cli.device.board;
    hp_fault fault = {0};
    hp_status status = HP_OK;
    if (info.pipes && info.cli.json)
        status = show_pipes_json(board, &fault);
    else if (info.pipes)
        print_pipes(board);
    else if (info.config && info.cli.json)
        status = show_config_json(board, &fault);
    else if (info.config)
        print_config(board);
    else
        status = show_boards(&info, &fault);
    if (status == HP_OK) status = hp_file_finish(stdout, "-", &fault);
    return hp_cli_end(&info.cli, status, &fault);
}
