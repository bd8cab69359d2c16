/* What went wrong in the host program, with its place: "terrain.obj:17: vertex index 9 is past the last, 8".
 *
 * A plain value; whoever calls owns it. Functions that take one return its status, and write it on failure alone. */
#ifndef HITPIPE_HOST_FAULT_H
#define HITPIPE_HOST_FAULT_H

#include <hitpipe/types.h>

typedef struct hp_fault {
    hp_status status;
    char message[512];
} hp_fault;

/* Sets status and message, cut to fit; returns status. */
hp_status hp_fault_set(hp_fault *fault, hp_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
