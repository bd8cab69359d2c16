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
    double view[2]; /* azimuth, elevation in degrees; NAN: to be chosen */
} draw_options;

static const struct argp_option option_table[] = {
    {"primary", KEY_PRIMARY, "P.csv", 0, "primaries, one a line, numbers as below", 1},
    {"secondary", KEY_SECONDARY, "S.csv", 0, "secondaries, likewise", 1},
    {"index", KEY_INDEX, "I[,J]", 0, "draw primary I and secondary J, counted from 0 (default 0; J: as I)", 1},
    {"out", KEY_OUT, "X.svg", 0, "the drawing; - is standard output", 1},
    {"view", KEY_VIEW, "AZIMUTH,ELEVATION", 0,
     "where the viewer stands, in degrees from the x axis towards y, and above both (default: about -60,24, so that "
     "T "
     "and thin things are not seen end on)",
     1},
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
    hp_cli_two_files(draw->primary, draw->secondary, state);
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

/* The two objects to be drawn: primary and secondary. */
typedef struct draw_scene {
    hp_figure figure[2];
    hp_vector middle[2];
    double size[2]; /* diagonals of the boxes around them */
} draw_scene;

static void measure(draw_scene *scene, int i) {
    hp_bounds box = hp_shape_bounds(scene->figure[i].object, scene->figure[i].words);
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

static bool is_ray(const draw_scene *scene) {
    return scene->figure[0].object == HP_RAY;
}

/* How much of a ray or a plane is shown: a ray to a little past its hit or the object. */
static double reach_of(const draw_scene *scene, const hp_result *answer) {
    if (scene->figure[1].object == HP_PLANE) return 0.6 * scene->size[0];
    const float *d = scene->figure[0].words + 3;
    if (!is_ray(scene)) return 0;
    hp_vector to = hp_vector_sub(scene->middle[1], scene->middle[0]);
    if (!answer->F) return sqrt(hp_vector_dot(to, to)) + 0.8 * scene->size[1];
    double length = sqrt((double)d[0] * d[0] + (double)d[1] * d[1] + (double)d[2] * d[2]);
    return (double)answer->T * length + 0.8 * scene->size[1];
}

/* The ends of T: of a ray that hits from its origin to CP, else the points that are T apart. False: no direction. */
static bool measure_ends(const draw_scene *scene, const hp_contact *contact, hp_vector ends[2]) {
    const hp_result *answer = &contact->answer;
    bool ray_hit = answer->F && is_ray(scene);
    ends[0] = ray_hit ? scene->middle[0] : contact->on_primary;
    ends[1] = ray_hit ? (hp_vector){answer->CP[0], answer->CP[1], answer->CP[2]} : contact->on_secondary;
    return ray_hit || contact->found;
}

/* ---- where the viewer stands ---- */

/* How well a box is seen, up to 1: three faces of it. */
static double box_clearness(const float *words, hp_vector toward) {
    double least = 1;
    for (int i = 6; i < 15; i += 3)
        least = fmin(least, fabs(hp_vector_dot((hp_vector){words[i], words[i + 1], words[i + 2]}, toward)));
    return fmin(1, least / 0.2);
}

/* How well a view shows an object's shape, up to 1: a thin one not edge on, a cylinder neither as a disc nor as a
 * rectangle. What is enough is no worse than more. */
static double clearness(const hp_figure *figure, hp_vector toward) {
    if (figure->object == HP_OBB) return box_clearness(figure->words, toward);
    double normal[3] = {figure->words[0], figure->words[1], figure->words[2]}; /* a plane's */
    if (figure->object == HP_TRIANGLE) hp_shape_normal(figure->object, figure->words, figure->words, normal);
    if (figure->object == HP_CYLINDER)
        for (int i = 0; i < 3; i++) normal[i] = (double)figure->words[3 + i] - (double)figure->words[i];
    double cosine = fabs(hp_vector_dot(hp_vector_unit(hp_vector_of(normal)), toward));
    if (figure->object == HP_CYLINDER) return fmin(1, fmin(cosine / 0.25, (1 - cosine) / 0.2));
    return figure->object == HP_TRIANGLE || figure->object == HP_PLANE ? fmin(1, cosine / 0.45) : 1;
}

/* How much a view shows, up to 1: T too should not be seen end on. */
static double worth(const draw_scene *scene, bool barred, const hp_vector ends[2], hp_vector toward) {
    hp_vector along = hp_vector_unit(hp_vector_sub(ends[1], ends[0]));
    double cosine = hp_vector_dot(along, toward), shown = 1;
    if (barred) shown = fmin(1, sqrt(fmax(0, 1 - cosine * cosine)) / 0.9);
    for (int i = 0; i < 2; i++) shown = fmin(shown, clearness(&scene->figure[i], toward));
    return shown;
}

static hp_drawing best_view(const draw_options *draw, const draw_scene *scene, bool barred, const hp_vector ends[2]) {
    if (!isnan(draw->view[0])) return hp_drawing_begin(draw->view[0], draw->view[1]);
    hp_drawing best = hp_drawing_begin(-60, 24);
    double most = worth(scene, barred, ends, best.toward);
    for (int turn = 1; turn <= 8; turn++) /* from the usual place to either side, never along an axis */
        for (int side = -1; side <= 1; side += 2) {
            hp_drawing other = hp_drawing_begin(-60 + side * turn * 22.5, 24);
            double shown = worth(scene, barred, ends, other.toward);
            if (shown <= most + 0.02) continue;
            most = shown;
            best = other;
        }
    return best;
}

static void draw_objects(hp_drawing *drawing, const draw_scene *scene) {
    static const hp_ink inks[] = {HP_INK_PRIMARY, HP_INK_SECONDARY};
    for (int i = 1; i >= 0; i--) {
        drawing->cover = &scene->figure[1 - i];
        hp_wireframe(drawing, inks[i], &scene->figure[i]);
    }
    drawing->cover = NULL;
    hp_drawing_meeting(drawing, &scene->figure[0], &scene->figure[1]);
}

/* The primary moved by T: it touches. */
static void draw_ghost(hp_drawing *drawing, const draw_scene *scene, const hp_contact *contact) {
    float moved[HP_OBJECT_WORDS_MAX];
    hp_figure ghost = scene->figure[0];
    hp_shape_move(ghost.object, ghost.words, hp_vector_sub(contact->on_secondary, contact->on_primary), moved);
    ghost.words = moved;
    drawing->cover = &scene->figure[1];
    hp_wireframe(drawing, HP_INK_GHOST, &ghost);
    drawing->cover = NULL;
}

/* The caption's words, which it points into. */
typedef struct draw_words {
    char answer[160], point[120], objects[2][48], measure[64];
} draw_words;

static hp_caption caption_of(const draw_options *draw, const hp_contact *contact, draw_words *words) {
    const hp_result *answer = &contact->answer;
    const hp_object objects[] = {hp_pair_primary(draw->pair), hp_pair_secondary(draw->pair)};
    static const char *const roles[] = {"primary", "secondary"};
    bool ray_hit = objects[0] == HP_RAY && answer->F, shown = isfinite(answer->T) && !ray_hit;
    const char *meaning = !answer->F ? "distance" : ray_hit ? "lengths of the direction" : "penetration depth";
    snprintf(words->answer, sizeof words->answer, "%s: F %d, T %.6g (%s%s)", draw->typed, (int)answer->F,
             (double)answer->T, meaning, ray_hit || contact->found || answer->T == 0 ? "" : ", direction unclear");
    snprintf(words->point, sizeof words->point, "CP %.6g, %.6g, %.6g", (double)answer->CP[0], (double)answer->CP[1],
             (double)answer->CP[2]);
    for (int i = 0; i < 2; i++)
        snprintf(words->objects[i], sizeof words->objects[i], "%s %zu, %s", hp_object_name(objects[i]),
                 draw->index[i], roles[i]);
    snprintf(words->measure, sizeof words->measure, "T %.6g", (double)answer->T);
    return (hp_caption){{words->answer, answer->F ? words->point : NULL},
                        words->objects[0],
                        words->objects[1],
                        answer->F && contact->found ? "moved by T" : NULL,
                        shown ? words->measure : NULL,
                        shown ? (double)answer->T : 0};
}

static hp_status draw_picture(const draw_options *draw, draw_scene *scene, const hp_contact *contact,
                              hp_fault *fault) {
    const hp_result *answer = &contact->answer;
    draw_words words;
    hp_caption caption = caption_of(draw, contact, &words);
    hp_vector ends[2];
    bool barred = measure_ends(scene, contact, ends);
    hp_drawing drawing = best_view(draw, scene, barred, ends);
    drawing.slack = 3e-3 * small_size(scene);
    for (int i = 0; i < 2; i++) {
        scene->figure[i].around = scene->middle[1 - i];
        scene->figure[i].reach = reach_of(scene, answer);
    }
    draw_objects(&drawing, scene);
    if (answer->F && contact->found) draw_ghost(&drawing, scene, contact);
    if (barred) hp_drawing_bar(&drawing, HP_INK_MEASURE, ends, "T");
    if (answer->F)
        hp_drawing_dot(&drawing, HP_INK_MEASURE, (hp_vector){answer->CP[0], answer->CP[1], answer->CP[2]}, "CP");
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

static hp_status draw_on_board(draw_options *draw, draw_scene *scene, hp_fault *fault) {
    hp_device *device;
    hp_contact contact;
    hp_status status = hp_cli_open(&draw->cli, &device, fault), closed;
    if (status == HP_OK) status = hp_cli_check_resident(device, draw->pair, fault);
    if (status == HP_OK) {
        status = hp_contact_find(device, draw->pair, scene->figure[0].words, scene->figure[1].words,
                                 small_size(scene), &contact);
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
    draw_options draw = {.cli = hp_cli_begin(argv[0]), .view = {NAN, NAN}};
    argp_parse(&argp, argc, argv, 0, NULL, &draw);
    hp_fault fault = {0};
    draw_scene scene = {.figure = {{.object = hp_pair_primary(draw.pair)}, {.object = hp_pair_secondary(draw.pair)}}};
    const char *paths[] = {draw.primary, draw.secondary};
    hp_objects objects[2] = {{0}, {0}};
    hp_status status = HP_OK;
    for (int i = 0; i < 2 && status == HP_OK; i++) {
        status = hp_csv_load(paths[i], scene.figure[i].object, &objects[i], &fault);
        if (status == HP_OK)
            status =
                pick(paths[i], &objects[i], draw.index[i], scene.figure[i].object, &scene.figure[i].words, &fault);
        if (status == HP_OK) measure(&scene, i);
    }
    if (status == HP_OK) status = draw_on_board(&draw, &scene, &fault);
    for (int i = 0; i < 2; i++) hp_objects_free(&objects[i]);
    return hp_cli_end(&draw.cli, status, &fault);
}
