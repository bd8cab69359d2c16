/* Line drawings of things in space, as SVG: seen along parallel lines from one side, fitted to the page.
 *
 * What is added later lies on top. Coordinates are any lengths; nothing is drawn before hp_drawing_write knows how
 * much room all of it takes. A drawing that runs out of memory says so when it is written. One thread at a time. */
#ifndef HITPIPE_HOST_DRAWING_H
#define HITPIPE_HOST_DRAWING_H

#include "host/import/fault.h"
#include "host/output/figure.h"

#include <stdio.h>

/* How a stroke looks: a class of the style sheet in drawing_page.c. */
typedef enum hp_ink {
    HP_INK_PRIMARY,
    HP_INK_SECONDARY,
    HP_INK_GHOST,   /* the primary, moved until it touches */
    HP_INK_MEETING, /* where the surfaces of the two cross */
    HP_INK_MEASURE  /* T */
} hp_ink;

typedef enum hp_pen {
    HP_PEN_FILL,  /* a translucent area without an outline */
    HP_PEN_FRONT, /* what the viewer sees */
    HP_PEN_BACK,  /* what the object itself or the other hides */
    HP_PEN_HEAD,  /* an arrow's head at the end of the stroke, nothing else */
    HP_PEN_BAR,   /* a measure with its name beside it */
    HP_PEN_DOT    /* a point with a name */
} hp_pen;

typedef struct hp_stroke {
    hp_ink ink;
    hp_pen pen;
    bool closed;
    size_t first, count; /* points */
    const char *name;    /* of a dot or a bar */
} hp_stroke;

typedef struct hp_drawing {
    hp_vector right, up, toward; /* of the page; unit vectors */
    const hp_figure *cover;      /* lines drawn by the pen FRONT go behind it; NULL: nothing hides them */
    double slack;                /* a length: what is less behind the cover's surface than this is seen */
    hp_stroke *strokes;
    double (*points)[2]; /* on the page, in the lengths of space, y up */
    size_t stroke_count, stroke_room, point_count, point_room;
    bool failed; /* out of memory */
} hp_drawing;

/* A drawing seen from a direction: degrees from the x axis towards y, and above the plane of both. */
hp_drawing hp_drawing_begin(double azimuth, double elevation);
void hp_drawing_free(hp_drawing *drawing);

/* A line through n points; closed: back to the first. */
void hp_drawing_line(hp_drawing *drawing, hp_ink ink, hp_pen pen, const hp_vector *points, size_t n, bool closed);

/* The outline of n points as they are seen: the smallest convex polygon around them. */
void hp_drawing_outline(hp_drawing *drawing, hp_ink ink, hp_pen pen, const hp_vector *points, size_t n);

/* A dot, or a bar from ends[0] to ends[1], with a name beside it, which lives as long as the drawing. */
void hp_drawing_dot(hp_drawing *drawing, hp_ink ink, hp_vector at, const char *name);
void hp_drawing_bar(hp_drawing *drawing, hp_ink ink, const hp_vector ends[2], const char *name);

/* The lines in which the surfaces of two figures cross, as far as they are seen. Draw the figures first: the lines
 * are looked for where the drawing has something already. */
void hp_drawing_meeting(hp_drawing *drawing, const hp_figure *a, const hp_figure *b);

/* What stands under the picture. */
typedef struct hp_caption {
    const char *lines[2];            /* NULL: none */
    const char *primary, *secondary; /* what is drawn in either ink */
    const char *ghost;               /* likewise; NULL: there is none */
    const char *measure;             /* "T 0.25" beside a bar of that length; NULL: none */
    double length;
} hp_caption;

/* Writes the SVG. HP_ERROR_MEMORY, HP_ERROR_IO. */
hp_status hp_drawing_write(const hp_drawing *drawing, const hp_caption *caption, const char *path, hp_fault *fault);

#endif
