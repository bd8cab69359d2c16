#include "host/output/wireframe.h"

#include "host/rays/angle.h"

enum { TURN = 72, STEP = 360 / TURN }; /* points of a circle */

static hp_vector vector_at(const float *words) {
    return (hp_vector){words[0], words[1], words[2]};
}

/* a + s u + t v */
static hp_vector place(hp_vector a, double s, hp_vector u, double t, hp_vector v) {
    return hp_vector_along(hp_vector_along(a, s, u), t, v);
}

static void circle(hp_vector centre, hp_vector u, hp_vector v, double radius, hp_vector points[TURN]) {
    for (int i = 0; i < TURN; i++)
        points[i] = place(centre, radius * hp_cosine(i * STEP), u, radius * hp_sine(i * STEP), v);
}

static void segment(hp_drawing *drawing, hp_ink ink, hp_pen pen, hp_vector a, hp_vector b) {
    hp_drawing_line(drawing, ink, pen, (const hp_vector[]){a, b}, 2, false);
}

/* A circle about `centre`, of which the half that faces the viewer is seen. */
static void half_seen(hp_drawing *drawing, hp_ink ink, hp_vector centre, const hp_vector points[TURN]) {
    bool seen[TURN];
    int start = 0;
    for (int i = 0; i < TURN; i++) seen[i] = hp_vector_dot(hp_vector_sub(points[i], centre), drawing->toward) >= 0;
    while (start < TURN && seen[start] == seen[(start + TURN - 1) % TURN]) start++; /* where a half begins */
    hp_vector run[TURN + 1];
    for (int i = 0, n = 0; i < TURN; i++) {
        int at = (start + i) % TURN, next = (at + 1) % TURN;
        run[n++] = points[at];
        if (i + 1 < TURN && seen[at] == seen[next]) continue;
        run[n++] = points[next];
        hp_drawing_line(drawing, ink, seen[at] ? HP_PEN_FRONT : HP_PEN_BACK, run, (size_t)n, false);
        n = 0;
    }
}

static void draw_sphere(hp_drawing *drawing, hp_ink ink, const float *words) {
    const hp_vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    hp_vector points[TURN], centre = vector_at(words);
    circle(centre, drawing->right, drawing->up, (double)words[3], points);
    hp_drawing_line(drawing, ink, HP_PEN_FILL, points, TURN, true);
    hp_drawing_line(drawing, ink, HP_PEN_FRONT, points, TURN, true);
    if (words[3] == 0) return;
    for (int i = 0; i < 3; i++) {
        circle(centre, axes[i], axes[(i + 1) % 3], (double)words[3], points);
        half_seen(drawing, ink, centre, points);
    }
}

static void draw_triangle(hp_drawing *drawing, hp_ink ink, const float *words) {
    const hp_vector corners[] = {vector_at(words), vector_at(words + 3), vector_at(words + 6)};
    hp_drawing_line(drawing, ink, HP_PEN_FILL, corners, 3, true);
    hp_drawing_line(drawing, ink, HP_PEN_FRONT, corners, 3, true);
}

/* half[i]: half extents along the unit axes. A face is seen when its normal points to the viewer, an edge with one of
 * its two faces. */
static void draw_box(hp_drawing *drawing, hp_ink ink, hp_vector centre, const double half[3],
                     const hp_vector axes[3]) {
    hp_vector corners[8];
    for (int i = 0; i < 8; i++) {
        corners[i] = centre;
        for (int k = 0; k < 3; k++)
            corners[i] = hp_vector_along(corners[i], i >> k & 1 ? half[k] : -half[k], axes[k]);
    }
    hp_drawing_outline(drawing, ink, HP_PEN_FILL, corners, 8);
    for (int pen = HP_PEN_BACK; pen >= HP_PEN_FRONT; pen--)
        for (int i = 0; i < 12; i++) {
            int along = i / 4, a = (along + 1) % 3, b = (along + 2) % 3, from = (i & 1) << a | (i >> 1 & 1) << b;
            bool seen = hp_vector_dot(axes[a], drawing->toward) * (i & 1 ? 1 : -1) > 0 ||
                        hp_vector_dot(axes[b], drawing->toward) * (i & 2 ? 1 : -1) > 0;
            if (seen == (pen == HP_PEN_FRONT))
                segment(drawing, ink, (hp_pen)pen, corners[from], corners[from | 1 << along]);
        }
}

static void draw_aabb(hp_drawing *drawing, hp_ink ink, const float *words) {
    const hp_vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double half[3], middle[3];
    for (int i = 0; i < 3; i++) {
        half[i] = ((double)words[3 + i] - (double)words[i]) / 2;
        middle[i] = ((double)words[3 + i] + (double)words[i]) / 2;
    }
    draw_box(drawing, ink, hp_vector_of(middle), half, axes);
}

static void draw_obb(hp_drawing *drawing, hp_ink ink, const float *words) {
    const hp_vector axes[] = {vector_at(words + 6), vector_at(words + 9), vector_at(words + 12)};
    draw_box(drawing, ink, vector_at(words), (const double[]){words[3], words[4], words[5]}, axes);
}

static void draw_cylinder(hp_drawing *drawing, hp_ink ink, const float *words) {
    hp_vector p[] = {vector_at(words), vector_at(words + 3)}, u, v, rims[2 * TURN];
    hp_vector axis = hp_vector_unit(hp_vector_sub(p[1], p[0]));
    double radius = words[6], facing = hp_vector_dot(axis, drawing->toward);
    hp_figure_across(axis, &u, &v);
    for (int cap = 0; cap < 2; cap++) circle(p[cap], u, v, radius, rims + cap * TURN);
    hp_drawing_outline(drawing, ink, HP_PEN_FILL, rims, 2 * TURN);
    for (int cap = 0; cap < 2; cap++) {
        bool whole = cap ? facing >= 0 : facing <= 0; /* the cap itself is seen */
        if (whole)
            hp_drawing_line(drawing, ink, HP_PEN_FRONT, rims + cap * TURN, TURN, true);
        else
            half_seen(drawing, ink, p[cap], rims + cap * TURN);
    }
    hp_vector side = hp_vector_unit(hp_vector_cross(axis, drawing->toward)); /* where the surface turns away */
    for (int sign = -1; sign <= 1; sign += 2)
        segment(drawing, ink, HP_PEN_FRONT, hp_vector_along(p[0], sign * radius, side),
                hp_vector_along(p[1], sign * radius, side));
}

static void draw_plane(hp_drawing *drawing, hp_ink ink, const hp_figure *plane) {
    enum { CELLS = 6 };
    hp_patch patch = hp_figure_patch(plane);
    double reach = plane->reach;
    hp_vector foot = patch.middle, u = patch.u, v = patch.v, corners[4];
    for (int i = 0; i < 4; i++)
        corners[i] = place(foot, i == 1 || i == 2 ? reach : -reach, u, i >= 2 ? reach : -reach, v);
    hp_drawing_line(drawing, ink, HP_PEN_FILL, corners, 4, true);
    hp_drawing_line(drawing, ink, HP_PEN_FRONT, corners, 4, true);
    for (int i = 1; i < CELLS; i++) {
        double at = reach * (2.0 * i / CELLS - 1);
        segment(drawing, ink, HP_PEN_BACK, place(foot, at, u, -reach, v), place(foot, at, u, reach, v));
        segment(drawing, ink, HP_PEN_BACK, place(foot, -reach, u, at, v), place(foot, reach, u, at, v));
    }
}

static void draw_ray(hp_drawing *drawing, hp_ink ink, const hp_figure *ray) {
    hp_vector origin = vector_at(ray->words), along = hp_vector_unit(vector_at(ray->words + 3));
    hp_vector end = hp_vector_along(origin, ray->reach, along);
    segment(drawing, ink, HP_PEN_FRONT, origin, end);
    segment(drawing, ink, HP_PEN_HEAD, origin, end);
}

void hp_wireframe(hp_drawing *drawing, hp_ink ink, const hp_figure *figure) {
    switch (figure->object) {
    case HP_RAY:
        draw_ray(drawing, ink, figure);
        return;
    case HP_TRIANGLE:
        draw_triangle(drawing, ink, figure->words);
        return;
    case HP_SPHERE:
        draw_sphere(drawing, ink, figure->words);
        return;
    case HP_AABB:
        draw_aabb(drawing, ink, figure->words);
        return;
    case HP_OBB:
        draw_obb(drawing, ink, figure->words);
        return;
    case HP_CYLINDER:
        draw_cylinder(drawing, ink, figure->words);
        return;
    case HP_PLANE:
        draw_plane(drawing, ink, figure);
        return;
    }
}
