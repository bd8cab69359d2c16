/* Where two objects are deepest in each other, or nearest to each other, found by asking the board.
 *
 * An answer tells how deep a pair is, not in which direction. That is the gradient of the answer when the primary
 * moves: the board is asked again with it moved a little along each axis, and once more with it moved until it just
 * touches. */
#ifndef HITPIPE_HOST_CONTACT_H
#define HITPIPE_HOST_CONTACT_H

#include "host/import/fault.h"
#include "host/rays/vector.h"

#include <hitpipe/hitpipe.h>

typedef struct hp_contact {
    hp_result answer;
    bool found;    /* the rest holds: not for a ray that hits, nor where there is no single direction */
    hp_vector out; /* unit vector: which way the primary leaves the secondary soonest */
    hp_vector on_primary, on_secondary; /* the deepest points in each other, or the nearest; |T| apart along `out` */
} hp_contact;

/* Asks about one primary and one secondary, which becomes the scene of the device. `size`: a length of the smaller
 * one. Errors as hp_upload and hp_query. */
hp_status hp_contact_find(hp_device *device, hp_pair pair, const float *primary, const float *secondary, double size,
                          hp_contact *contact);

/* Moves an object of any type but a plane: writes the moved words. */
void hp_shape_move(hp_object object, const float *words, hp_vector by, float *moved);

#endif
