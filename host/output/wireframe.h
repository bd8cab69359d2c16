/* An object as strokes of a drawing: its outline filled, its edges, and of those it hides itself a trace. */
#ifndef HITPIPE_HOST_WIREFRAME_H
#define HITPIPE_HOST_WIREFRAME_H

#include "host/output/drawing.h"

#include <hitpipe/types.h>

/* Of a ray as much as `reach` from its origin, of a plane as much as `reach` around the foot of `around`: those two
 * have no end. */
void hp_wireframe(hp_drawing *drawing, hp_ink ink, hp_object object, const float *words, hp_vector around,
                  double reach);

#endif
