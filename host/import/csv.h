/* Objects as text: one a line, its words in the order of objects.def, with commas between.
 *
 * Decimal (the nearest binary32) or hexadecimal floats; blanks are free; '#' begins a comment; empty lines count for
 * nothing; a first line without any number is a header. */
#ifndef HITPIPE_HOST_CSV_H
#define HITPIPE_HOST_CSV_H

#include "host/import/bytes.h"

typedef struct hp_objects {
    float *words;
    size_t count, room; /* objects */
} hp_objects;

/* HP_ERROR_INPUT "file:line:column: ...": not a number, too few or many, an object that hp_object_fault refuses, none
 * at all, or no UTF-8. HP_ERROR_MEMORY. On error *objects is empty. The caller frees with hp_objects_free. */
hp_status hp_csv_read(const hp_bytes *bytes, hp_object object, hp_objects *objects, hp_fault *fault);
hp_status hp_csv_load(const char *path, hp_object object, hp_objects *objects, hp_fault *fault);

/* The numbers in the first line that is no header: as many as its fields. 0: there is no such line. */
unsigned hp_csv_numbers(const hp_bytes *bytes);

void hp_objects_free(hp_objects *objects);

#endif
