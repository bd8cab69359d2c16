#include "host/output/drawing.h"

#include "host/import/bytes.h"
#include "host/rays/angle.h"

#include <stdlib.h>
#include <string.h>

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

/* Of a ghost only what is seen is drawn. */
static bool left_out(hp_stroke stroke) {
    return stroke.ink == HP_INK_GHOST && stroke.pen != HP_PEN_FRONT;
}

static void add_stroke(hp_drawing *drawing, hp_stroke stroke) {
    if (left_out(stroke)) return;
    if (drawing->failed || !hp_grow((void **)&drawing->strokes, &drawing->stroke_room, drawing->stroke_count,
                                    sizeof *drawing->strokes)) {
        drawing->failed = true;
        return;
    }
    drawing->strokes[drawing->stroke_count++] = stroke;
}

/* A line that becomes strokes where it goes behind the drawing's cover and comes out again. */
typedef struct cutting {
    hp_drawing *drawing;
    hp_stroke stroke; /* the one under way */
    hp_pen pen;       /* of what is seen */
} cutting;

static bool hidden(const hp_drawing *drawing, hp_vector point) {
    return hp_figure_end(drawing->cover, point, drawing->toward) > drawing->slack;
}

static void begin_stroke(cutting *cut, bool behind) {
    cut->stroke.pen = behind ? HP_PEN_BACK : cut->pen;
    cut->stroke.first = cut->drawing->point_count;
    cut->stroke.count = 0;
}

static void go_to(cutting *cut, hp_vector point) {
    add_point(cut->drawing, point);
    cut->stroke.count++;
}

/* Between two points of which one is hidden: where the line goes behind. */
static hp_vector edge_of_cover(const hp_drawing *drawing, hp_vector a, hp_vector b) {
    bool first = hidden(drawing, a);
    for (int i = 0; i < 30; i++) {
        hp_vector middle = hp_vector_along(a, 0.5, hp_vector_sub(b, a));
        if (hidden(drawing, middle) == first)
            a = middle;
        else
            b = middle;
    }
    return hp_vector_along(a, 0.5, hp_vector_sub(b, a));
}

/* The leg from a, where the stroke is, to b. What a convex cover hides of it is one piece; one that is shorter than a
 * step may be overlooked. */
static void cut_leg(cutting *cut, hp_vector a, hp_vector b, int steps) {
    hp_vector leg = hp_vector_sub(b, a), last = a;
    bool behind = hidden(cut->drawing, a);
    for (int i = 1; i <= steps; i++) {
        hp_vector next = hp_vector_along(a, (double)i / steps, leg);
        if (hidden(cut->drawing, next) != behind) {
            hp_vector edge = edge_of_cover(cut->drawing, last, next);
            go_to(cut, edge);
            add_stroke(cut->drawing, cut->stroke);
            behind = !behind;
            begin_stroke(cut, behind);
            go_to(cut, edge);
        }
        last = next;
    }
    go_to(cut, b);
}

static void cut_line(cutting *cut, const hp_vector *points, size_t n, bool closed) {
    size_t before = cut->drawing->stroke_count;
    int steps = n > 8 ? 4 : 64; /* curves have short legs */
    begin_stroke(cut, hidden(cut->drawing, points[0]));
    go_to(cut, points[0]);
    for (size_t i = 1; i < n + (closed ? 1 : 0); i++) cut_leg(cut, points[i - 1], points[i % n], steps);
    cut->stroke.closed = closed && cut->drawing->stroke_count == before; /* in one piece */
    add_stroke(cut->drawing, cut->stroke);
}

void hp_drawing_line(hp_drawing *drawing, hp_ink ink, hp_pen pen, const hp_vector *points, size_t n, bool closed) {
    cutting cut = {.drawing = drawing, .stroke = {.ink = ink}, .pen = pen};
    if (drawing->cover && pen == HP_PEN_FRONT) {
        cut_line(&cut, points, n, closed);
        return;
    }
    begin_stroke(&cut, false);
    for (size_t i = 0; i < n; i++) go_to(&cut, points[i]);
    cut.stroke.closed = closed;
    add_stroke(drawing, cut.stroke);
}

void hp_drawing_dot(hp_drawing *drawing, hp_ink ink, hp_vector at, const char *name) {
    add_point(drawing, at);
    add_stroke(drawing, (hp_stroke){ink, HP_PEN_DOT, false, drawing->point_count - 1, 1, name});
}

void hp_drawing_bar(hp_drawing *drawing, hp_ink ink, const hp_vector ends[2], const char *name) {
    for (int i = 0; i < 2; i++) add_point(drawing, ends[i]);
    add_stroke(drawing, (hp_stroke){ink, HP_PEN_BAR, false, drawing->point_count - 2, 2, name});
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
