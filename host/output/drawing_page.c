/* The page of a drawing: strokes fitted to it, caption and style, written as SVG. */
#include "host/output/drawing.h"

#include "host/output/file.h"

enum {
    PAGE_WIDTH = 480,
    PICTURE_HEIGHT = 330,
    PAGE_HEIGHT = 428,
    MARGIN = 24,
    BAR_WIDTH = PAGE_WIDTH - 200, /* most that a bar under the picture takes */
    HEAD = 10                     /* length of an arrow's head */
};

static const char *const ink_names[] = {"primary", "secondary", "ghost", "meeting", "measure"};
static const char *const pen_names[] = {"fill", "front", "back", "head", "bar", "dot"};

/* Text has a white rim, so that it can be read on lines. */
static const char style[] =
    "<style>\n"
    "line, path { fill: none; stroke-linejoin: round; stroke-linecap: round }\n"
    ".primary { stroke: #1b6ca8 } .primary.fill, .primary.head { fill: #1b6ca8 }\n"
    ".secondary { stroke: #c9641a } .secondary.fill { fill: #c9641a }\n"
    ".ghost { stroke: #1b6ca8 } .meeting { stroke: #333 }\n"
    ".measure { stroke: #b00020 } .measure.head { fill: #b00020 }\n"
    ".fill { stroke: none; fill-opacity: 0.16 } .front { stroke-width: 1.8 }\n"
    ".back { stroke-width: 0.8; stroke-opacity: 0.6; stroke-dasharray: 1 3 }\n"
    ".ghost.front { stroke-width: 1; stroke-opacity: 0.8; stroke-dasharray: 6 4 }\n"
    ".meeting.front { stroke-width: 1 } .bar { stroke-width: 3.2 } .head { stroke-width: 1 }\n"
    ".scale { stroke: #333; stroke-width: 1.6 } .axis { stroke: #777; stroke-width: 1 }\n"
    "circle { stroke: white; stroke-width: 1; fill: #111 } text { fill: #111 }\n"
    ".name { font-weight: bold; paint-order: stroke; stroke: white; stroke-width: 3 }\n"
    ".measured { fill: #b00020 } .quiet { fill: #777 }\n"
    "</style>\n";

/* From the drawing's own lengths to the page. */
typedef struct page_fit {
    double scale, x, y;
} page_fit;

static page_fit fit_of(const hp_drawing *drawing, double length) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < drawing->point_count; i++)
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], drawing->points[i][axis]);
            high[axis] = fmax(high[axis], drawing->points[i][axis]);
        }
    page_fit fit = {
        fmin((PAGE_WIDTH - 2 * MARGIN) / (high[0] - low[0]), (PICTURE_HEIGHT - 2 * MARGIN) / (high[1] - low[1])), 0,
        0};
    if (length > 0) fit.scale = fmin(fit.scale, BAR_WIDTH / length);
    if (!isfinite(fit.scale)) fit.scale = 1;
    fit.x = PAGE_WIDTH / 2.0 - fit.scale * (low[0] + high[0]) / 2;
    fit.y = PICTURE_HEIGHT / 2.0 + fit.scale * (low[1] + high[1]) / 2;
    return fit;
}

static double page_x(const page_fit *fit, const double point[2]) {
    return fit->x + fit->scale * point[0];
}

static double page_y(const page_fit *fit, const double point[2]) {
    return fit->y - fit->scale * point[1];
}

/* The head of an arrow that ends at (x, y) having come by (dx, dy). */
static void write_head(FILE *file, const char *ink, double x, double y, double dx, double dy) {
    double length = sqrt(dx * dx + dy * dy);
    if (length == 0) return;
    dx *= HEAD / length;
    dy *= HEAD / length;
    fprintf(file, "<path class=\"%s head\" d=\"M%.1f %.1fL%.1f %.1fL%.1f %.1fZ\"/>\n", ink, x, y, x - dx + 0.4 * dy,
            y - dy - 0.4 * dx, x - dx - 0.4 * dy, y - dy + 0.4 * dx);
}

/* Five points across a bar, to the side where its name stands: the left. */
static void across_bar(const page_fit *fit, const double (*ends)[2], double across[2]) {
    double dx = page_x(fit, ends[1]) - page_x(fit, ends[0]), dy = page_y(fit, ends[1]) - page_y(fit, ends[0]);
    double length = sqrt(dx * dx + dy * dy), turn = dy > 0 ? -5 : 5;
    across[0] = length > 0 ? turn * dy / length : -5;
    across[1] = length > 0 ? -turn * dx / length : 0;
}

/* A bar with small strokes across its ends; its name stands beside its middle. */
static void write_bar(FILE *file, const page_fit *fit, const hp_stroke *bar, const double (*ends)[2]) {
    double x[2], y[2], across[2];
    across_bar(fit, ends, across);
    for (int i = 0; i < 2; i++) x[i] = page_x(fit, ends[i]), y[i] = page_y(fit, ends[i]);
    const char *ink = ink_names[bar->ink];
    fprintf(file, "<path class=\"%s bar\" d=\"M%.1f %.1fL%.1f %.1f\"/>", ink, x[0], y[0], x[1], y[1]);
    for (int i = 0; i < 2; i++)
        fprintf(file, "<path class=\"%s front\" d=\"M%.1f %.1fL%.1f %.1f\"/>", ink, x[i] + across[0],
                y[i] + across[1], x[i] - across[0], y[i] - across[1]);
    fprintf(file, "<text class=\"name measured\" text-anchor=\"end\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            (x[0] + x[1]) / 2 + 1.6 * across[0], (y[0] + y[1]) / 2 + 1.6 * across[1] + 4, bar->name);
}

/* The name stands to the right, and beside a bar on the other side than its. */
static void write_dot(FILE *file, const hp_drawing *drawing, const page_fit *fit, const hp_stroke *dot) {
    const double *at = drawing->points[dot->first];
    double x = page_x(fit, at), y = page_y(fit, at), across[2] = {-4.5, 3};
    for (size_t i = 0; i < drawing->stroke_count; i++)
        if (drawing->strokes[i].pen == HP_PEN_BAR)
            across_bar(fit, (const double(*)[2])(drawing->points + drawing->strokes[i].first), across);
    fprintf(file, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/><text class=\"name\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            x, y, x - 1.8 * across[0], y - 2.4 * across[1] + 4, dot->name);
}

static void write_line(FILE *file, const page_fit *fit, const hp_stroke *stroke, const double (*points)[2]) {
    fprintf(file, "<path class=\"%s %s\" d=\"", ink_names[stroke->ink], pen_names[stroke->pen]);
    for (size_t i = 0; i < stroke->count; i++)
        fprintf(file, "%c%.1f %.1f", i ? 'L' : 'M', page_x(fit, points[i]), page_y(fit, points[i]));
    fputs(stroke->closed ? "Z\"/>\n" : "\"/>\n", file);
}

static void write_stroke(FILE *file, const hp_drawing *drawing, const page_fit *fit, const hp_stroke *stroke) {
    const double(*points)[2] = (const double(*)[2])(drawing->points + stroke->first);
    double x = page_x(fit, points[stroke->count - 1]), y = page_y(fit, points[stroke->count - 1]);
    if (stroke->pen == HP_PEN_DOT)
        write_dot(file, drawing, fit, stroke);
    else if (stroke->pen == HP_PEN_BAR)
        write_bar(file, fit, stroke, points);
    else if (stroke->pen == HP_PEN_HEAD)
        write_head(file, ink_names[stroke->ink], x, y, x - page_x(fit, points[0]), y - page_y(fit, points[0]));
    else
        write_line(file, fit, stroke, points);
}

static void write_axes(FILE *file, const hp_drawing *drawing) {
    const hp_vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double x = PAGE_WIDTH - 44, y = PAGE_HEIGHT - 22;
    for (int i = 0; i < 3; i++) {
        double dx = 21 * hp_vector_dot(axes[i], drawing->right), dy = -21 * hp_vector_dot(axes[i], drawing->up);
        fprintf(file, "<line class=\"axis\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", x, y, x + dx, y + dy);
        fprintf(file, "<text class=\"quiet\" x=\"%.1f\" y=\"%.1f\">%c</text>\n", x + 1.3 * dx - 4, y + 1.3 * dy + 4,
                "xyz"[i]);
    }
}

/* The largest of 1, 2 and 5 times a power of ten that takes at most 100 points. */
static double round_length(double scale) {
    double most = 100 / scale, power = pow(10, floor(log10(most)));
    return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
}

static void write_key(FILE *file, int x, int y, const char *ink, const char *words) {
    fprintf(file,
            "<rect class=\"%s fill\" x=\"%d\" y=\"%d\" width=\"12\" height=\"12\" style=\"fill-opacity:1\"/>"
            "<text x=\"%d\" y=\"%d\">%s</text>\n",
            ink, x, y - 10, x + 18, y, words);
}

/* A bar of a length in space, at the left margin, with words to its right. */
static void write_length(FILE *file, const page_fit *fit, int y, const char *class, double length,
                         const char *words) {
    double end = MARGIN + fit->scale * length;
    fprintf(file,
            "<line class=\"%s\" x1=\"%d\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\"/><text x=\"%.1f\" y=\"%d\">%s</text>\n",
            class, MARGIN, y, end, y, end + 8, y + 4, words);
}

static void write_caption(FILE *file, const page_fit *fit, const hp_caption *caption) {
    const int top = PICTURE_HEIGHT;
    write_key(file, MARGIN, top + 14, "primary", caption->primary);
    write_key(file, 174, top + 14, "secondary", caption->secondary);
    if (caption->ghost)
        fprintf(file,
                "<line class=\"ghost front\" x1=\"350\" y1=\"%d\" x2=\"368\" y2=\"%d\"/>"
                "<text x=\"374\" y=\"%d\">%s</text>\n",
                top + 10, top + 10, top + 14, caption->ghost);
    for (int i = 0; i < 2; i++)
        if (caption->lines[i])
            fprintf(file, "<text x=\"%d\" y=\"%d\">%s</text>\n", MARGIN, top + 34 + 18 * i, caption->lines[i]);
    double length = round_length(fit->scale);
    char words[32];
    snprintf(words, sizeof words, "%.6g", length);
    write_length(file, fit, top + 66, "scale", length, words);
    if (caption->measure) write_length(file, fit, top + 84, "measure bar", caption->length, caption->measure);
}

hp_status hp_drawing_write(const hp_drawing *drawing, const hp_caption *caption, const char *path, hp_fault *fault) {
    if (drawing->failed) return hp_fault_set(fault, HP_ERROR_MEMORY, "no memory for the drawing");
    FILE *file = hp_file_create(path, fault);
    if (!file) return fault->status;
    page_fit fit = fit_of(drawing, caption->measure ? caption->length : 0);
    fprintf(
        file,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
        "font-family=\"sans-serif\" font-size=\"13\">\n%s<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
        PAGE_WIDTH, PAGE_HEIGHT, PAGE_WIDTH, PAGE_HEIGHT, style);
    for (int lines = 0; lines < 2; lines++) /* no area over a line */
        for (size_t i = 0; i < drawing->stroke_count; i++)
            if ((drawing->strokes[i].pen != HP_PEN_FILL) == lines)
                write_stroke(file, drawing, &fit, &drawing->strokes[i]);
    write_axes(file, drawing);
    write_caption(file, &fit, caption);
    fputs("</svg>\n", file);
    return hp_file_finish(file, path, fault);
}
