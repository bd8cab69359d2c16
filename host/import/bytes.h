/* A file in memory. Every reader of hitpipe parses bytes, so that files, tests and fuzzers take the same way.
 *
 * Plain values without shared state: any thread. */
#ifndef HITPIPE_HOST_BYTES_H
#define HITPIPE_HOST_BYTES_H

#include "host/import/fault.h"

/* n bytes and a zero byte after them, so that number parsing stops there. `name` is what errors call the place; it is
 * the caller's and must outlive the struct. */
typedef struct hp_bytes {
    const char *name;
    uint8_t *data;
    size_t n;
} hp_bytes;

/* Reads a whole file (or pipe; "-" is standard input). The caller frees with hp_bytes_free.
 * HP_ERROR_INPUT: cannot be opened or read, or is a directory. HP_ERROR_MEMORY. */
hp_status hp_bytes_read(const char *path, hp_bytes *bytes, hp_fault *fault);

/* A copy of n bytes in memory. HP_ERROR_MEMORY. */
hp_status hp_bytes_copy(const char *name, const void *data, size_t n, hp_bytes *bytes, hp_fault *fault);

void hp_bytes_free(hp_bytes *bytes);

/* Makes room for one more of *count entries of `size` bytes in *array, which grows by doubling. False: out of memory.
 */
bool hp_grow(void **array, size_t *room, size_t count, size_t size);

#endif
