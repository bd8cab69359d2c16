/* hitpipe trace SCENE: rays against a mesh, a heightfield, spheres or cylinders. */
#include "host/cli/trace.h"

#include "host/cli/pair.h"
#include "host/output/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum {
    KEY_OUT = 'o',
    KEY_MODE = 'm',
    KEY_PNG = 0x2000,
    KEY_SIZE,
    KEY_CAMERA,
    KEY_EYE,
    KEY_AT,
    KEY_UP,
    KEY_FOV,
    KEY_RAYS,
    KEY_FLIGHT,
    KEY_MOVING,
    KEY_RESAMPLE,
    KEY_SPACING,
    KEY_NO_SHADOWS,
    KEY_SEPARATION,
    KEY_OBJECTS,
    MOST_FRAMES = 1000000,
    MOST_PIXELS = 65536, /* on a side */
    MOST_SAMPLES = 32768
};

static const struct argp_option option_table[] = {
    {NULL, 0, NULL, 0, "What is written:", 1},
    {"out", KEY_OUT, "X.exr|X.csv", 0,
     "results: channels T, index, F, CP.X, CP.Y, CP.Z, or the columns of `query`; - is standard output", 1},
    {"png", KEY_PNG, "X.png", 0, "a shaded picture", 1},
    {"no-shadows", KEY_NO_SHADOWS, NULL, 0, "do not ask the board for the picture's shadows", 1},
    {NULL, 0, NULL, 0, "The rays:", 2},
    {"size", KEY_SIZE, "WxH", 0, "pixels of the picture (default 400x225)", 2},
    {"eye", KEY_EYE, "X,Y,Z", 0, "where the camera stands (default: it sees the whole scene)", 2},
    {"at", KEY_AT, "X,Y,Z", 0, "what it looks at (default: the middle of the scene)", 2},
    {"up", KEY_UP, "X,Y,Z", 0, "which way is up in the picture (default 0,0,1)", 2},
    {"fov", KEY_FOV, "DEGREES", 0, "vertical field of view (default 30)", 2},
    {"camera", KEY_CAMERA, "EX,EY,EZ,CX,CY,CZ,FOV", 0, "--eye, --at and --fov at once", 2},
    {"rays", KEY_RAYS, "F.csv", 0, "rays from a file, origin xyz and direction xyz a line", 2},
    {"flight", KEY_FLIGHT, "N", 0, "N frames of one ray each, from a flight path, in random directions", 2},
    {"moving", KEY_MOVING, NULL, 0, "with --flight: the transformer moves the scene every frame", 2},
    {"mode", KEY_MODE, "MODE", 0, "closest (default), any, or, with --flight, all", 2},
    {"separation", KEY_SEPARATION, "on|off", 0, "whether T of a miss is the distance (default: in mode all)", 2},
    {NULL, 0, NULL, 0, "The scene:", 3},
    {"objects", KEY_OBJECTS, "TYPE", 0,
     "SCENE is a CSV file of objects: triangle, sphere, cylinder (default: by the numbers of its first line)", 3},
    {"resample", KEY_RESAMPLE, "RxC", 0, "heightfields: R rows by C columns, bilinear, corners on corners", 3},
    {"spacing", KEY_SPACING, "X,Y", 0, "heightfields: lengths between columns and rows (default: the file's, or 1)",
     3},
    {0},
};

static void numbers(struct argp_state *state, const char *option, const char *text, double *values, size_t n) {
    if (!hp_cli_numbers(text, values, n))
        argp_error(state, "%s takes %zu numbers with commas between, not '%s'", option, n, text);
}

static void set_camera(trace_options *trace, const char *text, struct argp_state *state) {
    double values[7];
    numbers(state, "--camera", text, values, 7);
    memcpy(trace->camera.eye, values, sizeof trace->camera.eye);
    memcpy(trace->camera.at, values + 3, sizeof trace->camera.at);
    trace->camera.fov = values[6];
    trace->eye = trace->at = trace->fov = true;
}

static void set_flight(trace_options *trace, const char *text, struct argp_state *state) {
    if (!hp_cli_whole(text, MOST_FRAMES, &trace->flight) || trace->flight == 0)
        argp_error(state, "--flight takes a number of frames from 1 to %d, not '%s'", MOST_FRAMES, text);
}

static void set_objects(trace_options *trace, const char *text, struct argp_state *state) {
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    if (strcmp(text, #name) == 0 && hp_ray_pair(HP_##NAME)) trace->scene_def.objects = HP_##NAME;
#include <hitpipe/objects.def>
#undef HP_OBJECT
    if (!trace->scene_def.objects) argp_error(state, "--objects is triangle, sphere or cylinder, not '%s'", text);
}

bool trace_to_exr(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, ".exr") == 0;
}

static void check_together(const trace_options *trace, struct argp_state *state) {
    bool camera = trace->eye || trace->at || trace->up || trace->fov || trace->size;
    if (!trace->scene_path) argp_error(state, "which scene?");
    if (trace->flight && trace->rays) argp_error(state, "--flight and --rays exclude each other");
    if ((trace->flight || trace->rays) && camera) argp_error(state, "--flight and --rays are without a camera");
    if ((trace->flight || trace->rays) && trace->png) argp_error(state, "--png needs a camera");
    if (trace->png && trace->mode != HP_MODE_CLOSEST) argp_error(state, "--png needs --mode closest");
    if (trace->moving && !trace->flight) argp_error(state, "--moving needs --flight");
    if (trace->mode == HP_MODE_ALL && !trace->flight) argp_error(state, "--mode all needs --flight");
    if (trace->no_shadows && !trace->png) argp_error(state, "--no-shadows needs --png");
    if (trace->flight && trace->out && trace_to_exr(trace->out)) argp_error(state, "a flight is written as .csv");
}

/* The next three take the options of their group; false for others. */
static bool parse_camera(trace_options *trace, int key, char *argument, struct argp_state *state) {
    switch (key) {
    case KEY_CAMERA:
        set_camera(trace, argument, state);
        return true;
    case KEY_EYE:
        numbers(state, "--eye", argument, trace->camera.eye, 3);
        return trace->eye = true;
    case KEY_AT:
        numbers(state, "--at", argument, trace->camera.at, 3);
        return trace->at = true;
    case KEY_UP:
        numbers(state, "--up", argument, trace->camera.up, 3);
        return trace->up = true;
    case KEY_FOV:
        numbers(state, "--fov", argument, &trace->camera.fov, 1);
        return trace->fov = true;
    case KEY_SIZE:
        if (!hp_cli_pair(argument, MOST_PIXELS, &trace->width, &trace->height))
            argp_error(state, "--size takes WxH, each from 1 to %d, not '%s'", MOST_PIXELS, argument);
        return trace->size = true;
    default:
        return false;
    }
}

static bool parse_rays(trace_options *trace, int key, char *argument, struct argp_state *state) {
    switch (key) {
    case KEY_RAYS:
        trace->rays = argument;
        return true;
    case KEY_FLIGHT:
        set_flight(trace, argument, state);
        return true;
    case KEY_MOVING:
        return trace->moving = true;
    case KEY_MODE:
        trace->mode = hp_mode_from_name(argument);
        if (!trace->mode || trace->mode == HP_MODE_ZIP)
            argp_error(state, "--mode is closest, any or all, not '%s'", argument);
        return true;
    case KEY_SEPARATION:
        trace->separation = hp_cli_separation(argument, state);
        return true;
    default:
        return false;
    }
}

static bool parse_scene(trace_options *trace, int key, char *argument, struct argp_state *state) {
    double *spacing = trace->scene_def.spacing;
    switch (key) {
    case KEY_OBJECTS:
        set_objects(trace, argument, state);
        return true;
    case KEY_SPACING:
        numbers(state, "--spacing", argument, spacing, 2);
        for (int axis = 0; axis < 2; axis++)
            if (spacing[axis] == 0 || !isfinite(spacing[axis]))
                argp_error(state, "--spacing: lengths between samples are finite and not zero");
        return true;
    case KEY_RESAMPLE:
        if (!hp_cli_pair(argument, MOST_SAMPLES, &trace->scene_def.rows, &trace->scene_def.columns))
            argp_error(state, "--resample takes RxC, each from 2 to %d, not '%s'", MOST_SAMPLES, argument);
        return true;
    default:
        return false;
    }
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    trace_options *trace = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &trace->cli;
        return 0;
    case KEY_OUT:
        trace->out = argument;
        return 0;
    case KEY_PNG:
        trace->png = argument;
        return 0;
    case KEY_NO_SHADOWS:
        trace->no_shadows = true;
        return 0;
    case ARGP_KEY_ARG:
        if (trace->scene_path) argp_error(state, "'%s' is one argument too many", argument);
        trace->scene_path = argument;
        return 0;
    case ARGP_KEY_END:
        check_together(trace, state);
        hp_cli_claim(&trace->cli, trace->out, state);
        hp_cli_claim(&trace->cli, trace->png, state);
        return 0;
    default:
        return parse_camera(trace, key, argument, state) || parse_rays(trace, key, argument, state) ||
                       parse_scene(trace, key, argument, state)
                   ? 0
                   : ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&hp_cli_argp, 0, "Board and report:", 90}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "SCENE",
    .doc =
        "Traces rays against a scene on the board.\v"
        "SCENE is a heightfield (.exr, .pgm), a mesh (.obj, .ply, .stl, or any other format of assimp) or a file of "
        "objects (.csv), one a line: spheres (centre xyz, radius), cylinders (cap centres xyz xyz, radius) or "
        "triangles (v0 xyz, v1 xyz, v2 xyz).",
    .children = children,
};

/* ---- running ---- */

static hp_status take_counters(trace_run *run, hp_counters *counters, hp_fault *fault) {
    hp_status status = hp_read_counters(run->device, true, counters);
    return status == HP_OK ? HP_OK : hp_cli_device_fault(run->device, status, NULL, fault);
}

hp_query_def trace_query(const trace_run *run, hp_mode mode) {
    hp_query_def query = hp_default_query_def();
    query.pair = hp_ray_pair(run->scene.object);
    query.mode = mode;
    query.separation = run->options->separation;
    return query;
}

static hp_status bring_up(trace_run *run, hp_fault *fault) {
    hp_status resident = hp_cli_check_resident(run->device, hp_ray_pair(run->scene.object), fault);
    if (resident != HP_OK) return resident;
    hp_progress_bar_begin(run->bar, "uploading");
    double start = hp_seconds();
    hp_status status = hp_upload(run->device, run->scene.object, run->scene.words, run->scene.count);
    run->host_seconds += hp_seconds() - start;
    if (status != HP_OK) return hp_cli_device_fault(run->device, status, run->options->scene_path, fault);
    return take_counters(run, &run->upload, fault);
}

static hp_status write_report(trace_run *run, hp_fault *fault) {
    const trace_options *options = run->options;
    uint64_t clock_hz = hp_identify(run->device)->clock_hz;
    hp_counters whole = run->upload;
    hp_counters_add(&whole, &run->counters);
    hp_report_counters(run->report, &whole, clock_hz);
    hp_report_host(run->report, &whole, run->host_seconds);
    hp_report_set(run->report, "seconds.scene_upload",
                  json_real((double)run->upload.clocks_total / (double)clock_hz));
    hp_report_set(run->report, "scene.file", hp_report_string(options->scene_path));
    char key[32];
    snprintf(key, sizeof key, "scene.%ss", hp_object_name(run->scene.object));
    hp_report_set(run->report, key, json_integer((json_int_t)run->scene.count));
    hp_report_set(run->report, "scene.degenerate", json_integer((json_int_t)run->scene.degenerate));
    hp_report_set(run->report, "mode", json_string(hp_mode_name(options->mode)));
    hp_status status = HP_OK;
    if (options->cli.report) status = hp_report_write(run->report, options->cli.report, fault);
    if (status == HP_OK && options->cli.json) status = hp_report_write(run->report, "-", fault);
    return status;
}

static hp_status run_on_board(trace_run *run, hp_fault *fault) {
    const trace_options *options = run->options;
    run->report = hp_report_new(run->device);
    if (!run->report) return hp_fault_set(fault, HP_ERROR_MEMORY, "out of memory");
    hp_status status = bring_up(run, fault);
    if (status != HP_OK) return status;
    status = options->flight ? trace_flight(run, fault)
             : options->rays ? trace_rays(run, fault)
                             : trace_picture(run, fault);
    return status == HP_OK ? write_report(run, fault) : status;
}

void trace_summary(const trace_run *run, size_t rays, size_t hits) {
    const hp_identity *board = hp_identify(run->device);
    char a[HP_COUNT_TEXT], b[HP_COUNT_TEXT], c[HP_COUNT_TEXT];
    const hp_scene *scene = &run->scene;
    printf("scene    %s: %s %s%s", run->options->scene_path, hp_cli_count(scene->count, a),
           hp_object_name(scene->object), scene->count == 1 ? "" : "s");
    if (scene->rows) printf(" from %zu x %zu samples", scene->rows, scene->columns);
    if (scene->degenerate) printf(", %s without area", hp_cli_count(scene->degenerate, b));
    hp_counters whole = run->upload;
    hp_counters_add(&whole, &run->counters);
    double hz = (double)board->clock_hz, total = (double)whole.clocks_total;
    printf("\nrays     %s, %s hit (%.1f %%); %s tests\n", hp_cli_count(rays, a), hp_cli_count(hits, b),
           rays ? 100 * (double)hits / (double)rays : 0, hp_cli_count(whole.tests_run, c));
    printf("board    %s at %.6g MHz, %s engine: %.6g s = upload %.4g + compute %.4g + read-back %.4g + idle %.4g s\n",
           board->name, hz / 1e6, board->engine, total / hz, (double)whole.phase_upload / hz,
           (double)whole.phase_compute / hz, (double)whole.phase_read_back / hz, (double)whole.phase_idle / hz);
    printf("         %s clocks; a test issued in %.1f %% of them\n", hp_cli_count(whole.clocks_total, a),
           total > 0 ? 100 * (double)whole.clocks_issue / total : 0);
    printf("host     %.2f s on %s: %.4g million tests a second\n", run->host_seconds, board->isa,
           run->host_seconds > 0 ? (double)whole.tests_run / run->host_seconds / 1e6 : 0);
}

static void say_files(const trace_options *options) {
    const char *paths[] = {options->out, options->png, options->cli.report};
    const char *before = "wrote    ";
    for (int i = 0; i < 3; i++) {
        if (!paths[i] || strcmp(paths[i], "-") == 0) continue;
        printf("%s%s", before, paths[i]);
        before = ", ";
    }
    if (*before == ',') putchar('\n');
}

static hp_status probe(const trace_options *options, hp_fault *fault) {
    hp_status status = hp_file_probe(options->out, fault);
    return status == HP_OK ? hp_file_probe(options->png, fault) : status;
}

int hp_verb_trace(int argc, char **argv) {
    trace_options options = {.cli = hp_cli_begin(argv[0]), .mode = HP_MODE_CLOSEST, .width = 400, .height = 225};
    argp_parse(&argp, argc, argv, 0, NULL, &options);
    hp_fault fault = {0};
    trace_run run = {.options = &options, .bar = &options.cli.bar};
    run.words = !options.cli.taken;
    hp_status status = probe(&options, &fault);
    if (options.out && strcmp(options.out, "-") == 0 && isatty(STDOUT_FILENO)) run.bar->terminal = false;
    hp_progress_bar_begin(run.bar, "loading");
    if (status == HP_OK) status = hp_scene_load(options.scene_path, &options.scene_def, &run.scene, &fault);
    if (status == HP_OK) status = hp_cli_open(&options.cli, &run.device, &fault);
    if (status == HP_OK) status = run_on_board(&run, &fault);
    hp_fault late = {0};
    hp_status closed = hp_cli_close(&options.cli, run.device, &late);
    if (status == HP_OK && closed != HP_OK) status = closed, fault = late;
    if (status == HP_OK && run.words) say_files(&options);
    json_decref(run.report);
    hp_scene_free(&run.scene);
    return hp_cli_end(&options.cli, status, &fault);
}
