/* hitpipe draw PAIR: one pair of two files as a picture, with what the board answers. */
#include "host/cli/contact.h"
#include "host/cli/pair.h"
#include "host/import/csv.h"
#include "host/import/shape.h"
#include "host/output/file.h"
#include "host/output/report.h"
#include "host/output/wireframe.h"

#include <string.h>

enum { KEY_PRIMARY = 'p', KEY_SECONDARY = 's', KEY_OUT = 'o', KEY_INDEX = 'i', KEY_VIEW = 0x2000 };

typedef struct draw_options {
    hp_cli cli;
    hp_pair pair;
    const char *typed, *primary, *secondary, *out;
    size_t index[2];
    double view[2]; /* azimuth, elevation in degrees */
} draw_options;

static const struct argp_option option_table[] = {
    {"primary", KEY_PRIMARY, "P.csv", 0, "primaries, one a line, numbers as below", 1},
    {"secondary", KEY_SECONDARY, "S.csv", 0, "secondaries, likewise", 1},
    {"index", KEY_INDEX, "I[,J]", 0, "draw primary I and secondary J, counted from 0 (default 0; J: as I)", 1},
    {"out", KEY_OUT, "X.svg", 0, "the drawing; - is standard output", 1},
    {"view", KEY_VIEW, "AZIMUTH,ELEVATION", 0,
     "where the viewer stands, in degrees from the x axis towards y, and above both (default -60,24)", 1},
    {0},
};

static void set_index(draw_options *draw, const char *text, struct argp_state *state) {
    char first[24] = "";
    const char *comma = strchr(text, ',');
    size_t n = comma ? (size_t)(comma - text) : strlen(text);
    if (n < sizeof first) memcpy(first, text, n);
    bool taken = hp_cli_whole(first, HP_NO_INDEX - 1, &draw->index[0]);
    draw->index[1] = draw->index[0];
    if (taken && comma) taken = hp_cli_whole(comma + 1, HP_NO_INDEX - 1, &draw->index[1]);
    if (!taken) argp_error(state, "--index takes I or I,J, counted from 0, not '%s'", text);
}

static void set_view(draw_options *draw, const char *text, struct argp_state *state) {
    if (!hp_cli_numbers(text, draw->view, 2) || !(fabs(draw->view[0]) <= 360 && fabs(draw->view[1]) <= 90))
        argp_error(state, "--view takes two angles, up to 360 and up to 90 degrees, not '%s'", text);
}

static void check_complete(draw_options *draw, struct argp_state *state) {
    draw->pair = hp_cli_pair_named(draw->typed, state);
    if (!draw->primary || !draw->secondary) argp_error(state, "--primary and --secondary are needed");
    if (!draw->out) argp_error(state, "--out is needed");
    hp_cli_claim(&draw->cli, draw->out, state);
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    draw_options *draw = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &draw->cli;
        return 0;
    case KEY_PRIMARY:
        draw->primary = argument;
        return 0;
    case KEY_SECONDARY:
        draw->secondary = argument;
        return 0;
    case KEY_OUT:
        draw->out = argument;
        return 0;
    case KEY_INDEX:
        set_index(draw, argument, state);
        return 0;
    case KEY_VIEW:
        set_view(draw, argument, state);
        return 0;
    case ARGP_KEY_ARG:
        if (draw->typed) argp_error(state, "'%s' is one argument too many", argument);
        draw->typed = argument;
        return 0;
    case ARGP_KEY_END:
        check_complete(draw, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {
    {&hp_cli_argp, 0, "Board and report:", 90}, {&hp_cli_pair_argp, 0, NULL, 0}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "PAIR",
    .doc = "Draws a pair of objects and the board's answer: the common point CP, and T as a bar, to scale.",
    .children = children,
};

/* ---- the picture ---- */

/* The two objects to be drawn. */
typedef struct draw_scene {
    hp_object object[2];
    const float *words[2];
    hp_vector middle[2];
    double size[2]; /* diagonals of the boxes around them */
} draw_scene;

static void measure(draw_scene *scene, int i) {
    hp_bounds box = hp_shape_bounds(scene->object[i], scene->words[i]);
    hp_vector low = hp_vector_of(box.low), diagonal = hp_vector_sub(hp_vector_of(box.high), low);
    scene->middle[i] = hp_vector_along(low, 0.5, diagonal);
    scene->size[i] = sqrt(hp_vector_dot(diagonal, diagonal));
}

/* A length to take small steps of: the smaller object's that has one. */
static double small_size(const draw_scene *scene) {
    double least = fmin(scene->size[0], scene->size[1]), most = fmax(scene->size[0], scene->size[1]);
    double apart = sqrt(hp_vector_dot(scene->middle[0], scene->middle[0])) + most;
    return least > 1e-3 * most ? least : most > 0 ? most : apart > 0 ? apart : 1;
}

/* How much of a ray or a plane is shown: a ray to a little past its hit or the object. */
static double reach_of(const draw_scene *scene, const hp_result *answer) {
    if (scene->object[1] == HP_PLANE) return 0.85 * scene->size[0];
    const float *d = scene->words[0] + 3;
    if (scene->object[0] != HP_RAY) return 0;
    hp_vector to = hp_vector_sub(scene->middle[1], scene->middle[0]);
    if (!answer->F) return sqrt(hp_vector_dot(to, to)) + 0.6 * scene->size[1];
    double length = sqrt((double)d[0] * d[0] + (double)d[1] * d[1] + (double)d[2] * d[2]);
    return (double)answer->T * length + 0.6 * scene->size[1];
}

static void draw_answer(hp_drawing *drawing, const draw_scene *scene, const hp_contact *contact, double reach) {
    const hp_result *answer = &contact->answer;
    const hp_vector cp = {answer->CP[0], answer->CP[1], answer->CP[2]};
    if (contact->found && answer->F) {
        float moved[HP_OBJECT_WORDS_MAX];
        hp_shape_move(scene->object[0], scene->words[0], hp_vector_sub(contact->on_secondary, contact->on_primary),
                      moved);
        hp_wireframe(drawing, HP_INK_GHOST, scene->object[0], moved, scene->middle[0], reach);
    }
    hp_vector ends[] = {contact->on_primary, contact->on_secondary};
    if (answer->F && scene->object[0] == HP_RAY) ends[0] = scene->middle[0], ends[1] = cp;
    if (contact->found || (answer->F && scene->object[0] == HP_RAY))
        hp_drawing_line(drawing, HP_INK_MEASURE, HP_PEN_FRONT, ends, 2, false);
    if (answer->F) hp_drawing_dot(drawing, HP_INK_MEASURE, cp, "CP");
}

/* The caption's words, which it points into. */
typedef struct draw_words {
    char pair[160], answer[200], objects[2][80], measure[64];
} draw_words;

static hp_caption caption_of(const draw_options *draw, const hp_result *answer, draw_words *words) {
    bool ray = hp_pair_primary(draw->pair) == HP_RAY, shown = isfinite(answer->T) && !(ray && answer->F);
    const char *meaning = !answer->F ? "distance" : ray ? "lengths of the direction" : "penetration depth";
    snprintf(words->pair, sizeof words->pair, "%s: %s", draw->typed, answer->F ? "F 1, a hit" : "F 0, a miss");
    int n = snprintf(words->answer, sizeof words->answer, "T %.6g (%s)", (double)answer->T, meaning);
    if (answer->F)
        snprintf(words->answer + n, sizeof words->answer - (size_t)n, ", CP %.6g, %.6g, %.6g", (double)answer->CP[0],
                 (double)answer->CP[1], (double)answer->CP[2]);
    snprintf(words->objects[0], sizeof words->objects[0], "%s %zu (primary)",
             hp_object_name(hp_pair_primary(draw->pair)), draw->index[0]);
    snprintf(words->objects[1], sizeof words->objects[1], "%s %zu (secondary)",
             hp_object_name(hp_pair_secondary(draw->pair)), draw->index[1]);
    snprintf(words->measure, sizeof words->measure, "T %.6g", (double)answer->T);
    return (hp_caption){{words->pair, words->answer},
                        words->objects[0],
                        words->objects[1],
                        shown ? words->measure : NULL,
                        shown ? (double)answer->T : 0};
}

static hp_status draw_picture(const draw_options *draw, const draw_scene *scene, const hp_contact *contact,
                              hp_fault *fault) {
    draw_words words;
    hp_caption caption = caption_of(draw, &contact->answer, &words);
    hp_drawing drawing = hp_drawing_begin(draw->view[0], draw->view[1]);
    double reach = reach_of(scene, &contact->answer);
    hp_wireframe(&drawing, HP_INK_SECONDARY, scene->object[1], scene->words[1], scene->middle[0], reach);
    hp_wireframe(&drawing, HP_INK_PRIMARY, scene->object[0], scene->words[0], scene->middle[1], reach);
    draw_answer(&drawing, scene, contact, reach);
    hp_status status = hp_drawing_write(&drawing, &caption, draw->out, fault);
    hp_drawing_free(&drawing);
    return status;
}

/* ---- running ---- */

static void put_vector(json_t *report, const char *key, double x, double y, double z) {
    hp_report_set(report, key, json_pack("[f, f, f]", x, y, z));
}

static hp_status write_report(const draw_options *draw, hp_device *device, const hp_contact *contact,
                              hp_fault *fault) {
    json_t *report = hp_report_new(device);
    if (!report) return hp_fault_set(fault, HP_ERROR_MEMORY, "out of memory");
    const hp_result *answer = &contact->answer;
    hp_report_set(report, "pair", json_string(draw->typed));
    hp_report_set(report, "F", json_integer(answer->F));
    hp_report_set(report, "T", isfinite(answer->T) ? json_real((double)answer->T) : json_null());
    put_vector(report, "CP", (double)answer->CP[0], (double)answer->CP[1], (double)answer->CP[2]);
    if (contact->found) {
        const hp_vector *p = &contact->on_primary, *s = &contact->on_secondary;
        put_vector(report, "direction", contact->out.x, contact->out.y, contact->out.z);
        put_vector(report, "on_primary", p->x, p->y, p->z);
        put_vector(report, "on_secondary", s->x, s->y, s->z);
    }
    hp_counters counters;
    hp_status status = hp_read_counters(device, false, &counters);
    if (status == HP_OK)
        hp_report_counters(report, &counters, hp_identify(device)->clock_hz);
    else
        hp_cli_device_fault(device, status, NULL, fault);
    if (status == HP_OK && draw->cli.report) status = hp_report_write(report, draw->cli.report, fault);
    if (status == HP_OK && draw->cli.json) status = hp_report_write(report, "-", fault);
    json_decref(report);
    return status;
}

static hp_status draw_on_board(draw_options *draw, const draw_scene *scene, hp_fault *fault) {
    hp_device *device;
    hp_contact contact;
    hp_status status = hp_cli_open(&draw->cli, &device, fault), closed;
    if (status == HP_OK) status = hp_cli_check_resident(device, draw->pair, fault);
    if (status == HP_OK) {
        status = hp_contact_find(device, draw->pair, scene->words[0], scene->words[1], small_size(scene), &contact);
        if (status != HP_OK) hp_cli_device_fault(device, status, NULL, fault);
    }
    if (status == HP_OK) status = draw_picture(draw, scene, &contact, fault);
    if (status == HP_OK && (draw->cli.report || draw->cli.json)) status = write_report(draw, device, &contact, fault);
    closed = hp_cli_close(&draw->cli, device, status == HP_OK ? fault : &(hp_fault){0});
    return status == HP_OK ? closed : status;
}

static hp_status pick(const char *path, const hp_objects *objects, size_t index, hp_object object,
                      const float **words, hp_fault *fault) {
    if (index >= objects->count)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: there is no %s %zu: the file has %zu, counted from 0", path,
                            hp_object_name(object), index, objects->count);
    *words = objects->words + index * hp_object_words(object);
    return HP_OK;
}

int hp_verb_draw(int argc, char **argv) {
    draw_options draw = {.cli = hp_cli_begin(argv[0]), .view = {-60, 24}};
    argp_parse(&argp, argc, argv, 0, NULL, &draw);
    hp_fault fault = {0};
    draw_scene scene = {.object = {hp_pair_primary(draw.pair), hp_pair_secondary(draw.pair)}};
    const char *paths[] = {draw.primary, draw.secondary};
    hp_objects objects[2] = {{0}, {0}};
    hp_status status = HP_OK;
    for (int i = 0; i < 2 && status == HP_OK; i++) {
        status = hp_csv_load(paths[i], scene.object[i], &objects[i], &fault);
        if (status == HP_OK)
            status = pick(paths[i], &objects[i], draw.index[i], scene.object[i], &scene.words[i], &fault);
        if (status == HP_OK) measure(&scene, i);
    }
    if (status == HP_OK) status = draw_on_board(&draw, &scene, &fault);
    for (int i = 0; i < 2; i++) hp_objects_free(&objects[i]);
    return hp_cli_end(&draw.cli, status, &fault);
}
