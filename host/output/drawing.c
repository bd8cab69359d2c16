#include "host/output/drawing.h"

#include "host/import/bytes.h"
#include "host/output/file.h"
#include "host/rays/angle.h"

#include <stdlib.h>
#include <string.h>

enum {
    PAGE_WIDTH = 640,
    PICTURE_HEIGHT = 400,
    PAGE_HEIGHT = 500,
    MARGIN = 24,
    BAR_WIDTH = PAGE_WIDTH - 200 /* most that a bar under the picture takes */
};

typedef struct hp_stroke {
    hp_ink ink;
    hp_pen pen;
    bool closed;
    size_t first, count; /* points */
    const char *name;    /* of a dot */
} hp_stroke;

hp_drawing hp_drawing_begin(double azimuth, double elevation) {
    double flat = hp_cosine(elevation), high = hp_sine(elevation), x = hp_cosine(azimuth), y = hp_sine(azimuth);
    return (hp_drawing){
        .right = {-y, x, 0}, .up = {-high * x, -high * y, flat}, .toward = {flat * x, flat * y, high}};
}

void hp_drawing_free(hp_drawing *drawing) {
    free(drawing->strokes);
    free(drawing->points);
    *drawing = (hp_drawing){0};
}

static void add_point(hp_drawing *drawing, hp_vector point) {
    if (drawing->failed ||
        !hp_grow((void **)&drawing->points, &drawing->point_room, drawing->point_count, sizeof *drawing->points)) {
        drawing->failed = true;
        return;
    }
    double *at = drawing->points[drawing->point_count++];
    at[0] = hp_vector_dot(point, drawing->right);
    at[1] = hp_vector_dot(point, drawing->up);
}

static void add_stroke(hp_drawing *drawing, hp_stroke stroke) {
    if (drawing->failed || !hp_grow((void **)&drawing->strokes, &drawing->stroke_room, drawing->stroke_count,
                                    sizeof *drawing->strokes)) {
        drawing->failed = true;
        return;
    }
    drawing->strokes[drawing->stroke_count++] = stroke;
}

void hp_drawing_line(hp_drawing *drawing, hp_ink ink, hp_pen pen, const hp_vector *points, size_t n, bool closed) {
    size_t first = drawing->point_count;
    for (size_t i = 0; i < n; i++) add_point(drawing, points[i]);
    add_stroke(drawing, (hp_stroke){ink, pen, closed, first, n, NULL});
}

void hp_drawing_dot(hp_drawing *drawing, hp_ink ink, hp_vector at, const char *name) {
    add_point(drawing, at);
    add_stroke(drawing, (hp_stroke){ink, HP_PEN_DOT, false, drawing->point_count - 1, 1, name});
}

static int compare_points(const void *a, const void *b) {
    const double *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

/* How far c lies to the left of the line from a to b, times its length. */
static double leftness(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Andrew, "Another efficient algorithm for convex hulls in two dimensions" (1979): one chain of the hull of sorted
 * points, from the first (step 1) or the last (step -1) on. Its end, which begins the other chain, is left out. */
static size_t chain(const double (*sorted)[2], size_t n, int step, double (*hull)[2]) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        const double *point = sorted[step > 0 ? i : n - 1 - i];
        while (count >= 2 && leftness(hull[count - 2], hull[count - 1], point) <= 0) count--;
        memcpy(hull[count++], point, sizeof *hull);
    }
    return count - 1;
}

void hp_drawing_outline(hp_drawing *drawing, hp_ink ink, hp_pen pen, const hp_vector *points, size_t n) {
    size_t first = drawing->point_count;
    for (size_t i = 0; i < n; i++) add_point(drawing, points[i]);
    for (size_t i = 0; i < n + 2; i++) add_point(drawing, points[0]); /* room for the hull */
    double(*sorted)[2] = malloc(n * sizeof *sorted);
    if (drawing->failed || !sorted) {
        drawing->failed = true;
    } else {
        memcpy(sorted, drawing->points + first, n * sizeof *sorted);
        qsort(sorted, n, sizeof *sorted, compare_points);
        size_t count = chain(sorted, n, 1, drawing->points + first);
        count += chain(sorted, n, -1, drawing->points + first + count);
        drawing->point_count = first + count;
        add_stroke(drawing, (hp_stroke){ink, pen, true, first, count, NULL});
    }
    free(sorted);
}

/* ---- the page ---- */

static const char *const ink_names[] = {"primary", "secondary", "ghost", "measure"};
static const char *const pen_names[] = {"fill", "front", "back", "front", "dot"};

static const char style[] =
    "<style>\n"
    "line, path { fill: none; stroke-linejoin: round; stroke-linecap: round }\n"
    ".primary { stroke: #1b6ca8 } .primary.fill, .primary.head { fill: #1b6ca8 }\n"
    ".secondary { stroke: #c9641a } .secondary.fill { fill: #c9641a }\n"
    ".ghost { stroke: #1b6ca8 } .measure { stroke: #b00020 }\n"
    ".fill { stroke: none; fill-opacity: 0.16 } .front { stroke-width: 1.6 }\n"
    ".back { stroke-width: 0.8; stroke-opacity: 0.55; stroke-dasharray: 3 3 }\n"
    ".ghost.front, .ghost.back { stroke-width: 1; stroke-opacity: 0.7; stroke-dasharray: 6 4 }\n"
    ".measure.front { stroke-width: 3 } .scale { stroke: #333; stroke-width: 1.6 }\n"
    ".axis { stroke: #777; stroke-width: 1 }\n"
    "circle { stroke: white; stroke-width: 1; fill: #111 } text { fill: #111 }\n"
    ".quiet { fill: #777 }\n"
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

static void write_head(FILE *file, const page_fit *fit, const char *ink, const double from[2], const double to[2]) {
    double x = page_x(fit, to), y = page_y(fit, to), dx = x - page_x(fit, from), dy = y - page_y(fit, from);
    double length = sqrt(dx * dx + dy * dy);
    if (length == 0) return;
    dx *= 10 / length;
    dy *= 10 / length;
    fprintf(file, "<path class=\"%s head\" d=\"M%.1f %.1fL%.1f %.1fL%.1f %.1fZ\"/>\n", ink, x, y, x - dx + 0.4 * dy,
            y - dy - 0.4 * dx, x - dx - 0.4 * dy, y - dy + 0.4 * dx);
}

static void write_stroke(FILE *file, const hp_drawing *drawing, const page_fit *fit, const hp_stroke *stroke) {
    const double(*points)[2] = (const double(*)[2])(drawing->points + stroke->first);
    const char *ink = ink_names[stroke->ink];
    if (stroke->pen == HP_PEN_DOT) {
        double x = page_x(fit, points[0]), y = page_y(fit, points[0]);
        fprintf(file, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/><text x=\"%.1f\" y=\"%.1f\">%s</text>\n", x, y, x + 7,
                y - 6, stroke->name);
        return;
    }
    fprintf(file, "<path class=\"%s %s\" d=\"", ink, pen_names[stroke->pen]);
    for (size_t i = 0; i < stroke->count; i++)
        fprintf(file, "%c%.1f %.1f", i ? 'L' : 'M', page_x(fit, points[i]), page_y(fit, points[i]));
    fputs(stroke->closed ? "Z\"/>\n" : "\"/>\n", file);
    if (stroke->pen == HP_PEN_ARROW) write_head(file, fit, ink, points[stroke->count - 2], points[stroke->count - 1]);
}

static void write_axes(FILE *file, const hp_drawing *drawing) {
    const hp_vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double x = PAGE_WIDTH - 52, y = PAGE_HEIGHT - 40;
    for (int i = 0; i < 3; i++) {
        double dx = 28 * hp_vector_dot(axes[i], drawing->right), dy = -28 * hp_vector_dot(axes[i], drawing->up);
        fprintf(file, "<line class=\"axis\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", x, y, x + dx, y + dy);
        fprintf(file, "<text class=\"quiet\" x=\"%.1f\" y=\"%.1f\">%c</text>\n", x + 1.3 * dx - 4, y + 1.3 * dy + 4,
                "xyz"[i]);
    }
}

/* The largest of 1, 2 and 5 times a power of ten that takes at most 140 points. */
static double round_length(double scale) {
    double most = 140 / scale, power = pow(10, floor(log10(most)));
    return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
}

static void write_caption(FILE *file, const page_fit *fit, const hp_caption *caption) {
    const int left = MARGIN, top = PICTURE_HEIGHT;
    fprintf(file,
            "<rect class=\"primary fill\" x=\"%d\" y=\"%d\" width=\"12\" height=\"12\" style=\"fill-opacity:1\"/>",
            left, top + 8);
    fprintf(file, "<text x=\"%d\" y=\"%d\">%s</text>\n", left + 18, top + 18, caption->primary);
    fprintf(file,
            "<rect class=\"secondary fill\" x=\"%d\" y=\"%d\" width=\"12\" height=\"12\" style=\"fill-opacity:1\"/>",
            PAGE_WIDTH / 2, top + 8);
    fprintf(file, "<text x=\"%d\" y=\"%d\">%s</text>\n", PAGE_WIDTH / 2 + 18, top + 18, caption->secondary);
    for (int i = 0; i < 2; i++)
        fprintf(file, "<text x=\"%d\" y=\"%d\">%s</text>\n", left, top + 38 + 18 * i, caption->lines[i]);
    double length = round_length(fit->scale);
    fprintf(file, "<line class=\"scale\" x1=\"%d\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\"/>", left, top + 70,
            left + fit->scale * length, top + 70);
    fprintf(file, "<text x=\"%.1f\" y=\"%d\">%.6g</text>\n", left + fit->scale * length + 8, top + 74, length);
    if (!caption->measure) return;
    fprintf(file, "<line class=\"measure front\" x1=\"%d\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\"/>", left, top + 88,
            left + fit->scale * caption->length, top + 88);
    fprintf(file, "<text x=\"%.1f\" y=\"%d\">%s</text>\n", left + fit->scale * caption->length + 8, top + 92,
            caption->measure);
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
    for (size_t i = 0; i < drawing->stroke_count; i++) write_stroke(file, drawing, &fit, &drawing->strokes[i]);
    write_axes(file, drawing);
    write_caption(file, &fit, caption);
    fputs("</svg>\n", file);
    return hp_file_finish(file, path, fault);
}
