/* The lines in which the surfaces of two figures cross, as far as the viewer sees them: where the one that was in
 * front goes behind the other. Found on a grid over the page, cell by cell, and joined to lines.
 * Lorensen and Cline, "Marching cubes" (1987), in two dimensions. */
#include "host/output/drawing.h"

#include "host/import/bytes.h"

#include <stdlib.h>
#include <string.h>

enum {
    CELLS = 240, /* along the longer side */
    LEAST = 4    /* pieces of a line: along an outline, where one of the figures ends, there are crumbs */
};

/* Pieces of the lines, a cell's each: their ends on the page. */
typedef struct hp_piece {
    double ends[2][2];
    bool taken; /* is part of a line */
} hp_piece;

typedef struct meeting {
    hp_drawing *drawing;
    const hp_figure *a, *b;
    double low[2], step;
    size_t columns, rows; /* corners */
    double *lead;         /* how far a is in front of b at each corner; NAN: one of them is not there */
    hp_piece *pieces;
    size_t count, room;
    hp_vector *line; /* room for a line of all pieces */
} meeting;

static hp_vector on_page(const hp_drawing *drawing, const double at[2]) {
    return hp_vector_along(hp_vector_along((hp_vector){0}, at[0], drawing->right), at[1], drawing->up);
}

static double lead_at(const meeting *m, const double at[2]) {
    hp_vector point = on_page(m->drawing, at);
    double a = hp_figure_end(m->a, point, m->drawing->toward), b = hp_figure_end(m->b, point, m->drawing->toward);
    return isfinite(a) && isfinite(b) ? a - b - m->drawing->slack : NAN;
}

static bool lay_grid(meeting *m) {
    const hp_drawing *drawing = m->drawing;
    double high[2] = {-INFINITY, -INFINITY};
    m->low[0] = m->low[1] = INFINITY;
    for (size_t i = 0; i < drawing->point_count; i++)
        for (int axis = 0; axis < 2; axis++) {
            m->low[axis] = fmin(m->low[axis], drawing->points[i][axis]);
            high[axis] = fmax(high[axis], drawing->points[i][axis]);
        }
    m->step = fmax(high[0] - m->low[0], high[1] - m->low[1]) / CELLS;
    if (!(m->step > 0)) return false;
    m->columns = (size_t)((high[0] - m->low[0]) / m->step) + 2;
    m->rows = (size_t)((high[1] - m->low[1]) / m->step) + 2;
    m->lead = malloc(m->columns * m->rows * sizeof *m->lead);
    if (!m->lead) m->drawing->failed = true;
    return m->lead != NULL;
}

static void corner(const meeting *m, size_t column, size_t row, double at[2]) {
    at[0] = m->low[0] + m->step * (double)column;
    at[1] = m->low[1] + m->step * (double)row;
}

/* Where the lead changes its sign on the side from corner (c, r) one further along an axis. Always seen from the
 * lower corner, so that two cells find the same bits. */
static bool crossing(const meeting *m, size_t c, size_t r, int axis, double at[2]) {
    double from = m->lead[r * m->columns + c];
    double to = axis ? m->lead[(r + 1) * m->columns + c] : m->lead[r * m->columns + c + 1];
    if ((from > 0) == (to > 0)) return false;
    corner(m, c, r, at);
    at[axis] += m->step * from / (from - to);
    return true;
}

static bool whole_cell(const meeting *m, size_t c, size_t r) {
    const double *low = m->lead + r * m->columns + c, *high = low + m->columns;
    return !isnan(low[0]) && !isnan(low[1]) && !isnan(high[0]) && !isnan(high[1]);
}

static void march(meeting *m, size_t c, size_t r) {
    double ends[4][2];
    int n = 0;
    if (crossing(m, c, r, 0, ends[n])) n++;
    if (crossing(m, c, r, 1, ends[n])) n++;
    if (crossing(m, c, r + 1, 0, ends[n])) n++;
    if (crossing(m, c + 1, r, 1, ends[n])) n++;
    for (int i = 0; i + 1 < n; i += 2) {
        if (!hp_grow((void **)&m->pieces, &m->room, m->count, sizeof *m->pieces)) {
            m->drawing->failed = true;
            return;
        }
        hp_piece *piece = &m->pieces[m->count++];
        piece->taken = false;
        memcpy(piece->ends, ends[i], sizeof piece->ends);
    }
}

/* A piece not yet taken with an end at `at`: writes its other end. */
static bool next_piece(meeting *m, const double at[2], double end[2]) {
    for (size_t i = 0; i < m->count; i++) {
        hp_piece *piece = &m->pieces[i];
        bool first = memcmp(piece->ends[0], at, sizeof piece->ends[0]) == 0;
        if (piece->taken || (!first && memcmp(piece->ends[1], at, sizeof piece->ends[1]) != 0)) continue;
        piece->taken = true;
        memcpy(end, piece->ends[first ? 1 : 0], sizeof piece->ends[0]);
        return true;
    }
    return false;
}

/* Goes on from `from` as far as there are pieces; writes the points after it; how many. */
static size_t follow(meeting *m, const double from[2], hp_vector *points) {
    double at[2] = {from[0], from[1]}, end[2];
    size_t n = 0;
    while (next_piece(m, at, end)) {
        memcpy(at, end, sizeof at);
        points[n++] = on_page(m->drawing, at);
    }
    return n;
}

/* Both ways from a piece: the one way is turned round, and the other added. */
static void join(meeting *m, hp_piece *start) {
    hp_vector *line = m->line;
    start->taken = true;
    line[0] = on_page(m->drawing, start->ends[0]);
    size_t n = 1 + follow(m, start->ends[0], line + 1);
    for (size_t i = 0; i < n / 2; i++) {
        hp_vector other = line[i];
        line[i] = line[n - 1 - i];
        line[n - 1 - i] = other;
    }
    line[n++] = on_page(m->drawing, start->ends[1]);
    n += follow(m, start->ends[1], line + n);
    if (n > LEAST) hp_drawing_line(m->drawing, HP_INK_MEETING, HP_PEN_FRONT, line, n, false);
}

void hp_drawing_meeting(hp_drawing *drawing, const hp_figure *a, const hp_figure *b) {
    meeting m = {.drawing = drawing, .a = a, .b = b};
    if (drawing->failed || !lay_grid(&m)) return;
    for (size_t r = 0; r < m.rows; r++)
        for (size_t c = 0; c < m.columns; c++) {
            double at[2];
            corner(&m, c, r, at);
            m.lead[r * m.columns + c] = lead_at(&m, at);
        }
    for (size_t r = 0; r + 1 < m.rows; r++)
        for (size_t c = 0; c + 1 < m.columns; c++)
            if (whole_cell(&m, c, r)) march(&m, c, r);
    m.line = malloc((m.count + 2) * sizeof *m.line);
    if (!m.line) drawing->failed = true;
    for (size_t i = 0; i < m.count && m.line; i++)
        if (!m.pieces[i].taken) join(&m, &m.pieces[i]);
    free(m.line);
    free(m.pieces);
    free(m.lead);
}
