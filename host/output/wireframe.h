/* An object as strokes of a drawing: its outline filled, its edges, and of those it hides itself a trace. */
#ifndef HITPIPE_HOST_WIREFRAME_H
#define HITPIPE_HOST_WIREFRAME_H

#include "host/output/drawing.h"

void hp_wireframe(hp_drawing *drawing, hp_ink ink, const hp_figure *figure);

#endif
