/* Files that hitpipe writes. Nothing counts as written before the system has taken it all, close included. */
#ifndef HITPIPE_HOST_FILE_H
#define HITPIPE_HOST_FILE_H

#include "host/import/fault.h"

#include <stdio.h>

/* Opens for writing; "-" is standard output. NULL with HP_ERROR_IO in `fault`: "path: No such file or directory". */
FILE *hp_file_create(const char *path, hp_fault *fault);

/* Flushes, closes (standard output stays open) and tells whether everything arrived. HP_ERROR_IO. */
hp_status hp_file_finish(FILE *file, const char *path, hp_fault *fault);

/* A whole file at once. HP_ERROR_IO. */
hp_status hp_file_write(const char *path, const void *data, size_t n, hp_fault *fault);

/* Whether a file could be written there, so that hours of work do not end in a refusal. NULL is fine. HP_ERROR_IO. */
hp_status hp_file_probe(const char *path, hp_fault *fault);

#endif
