/* A board's answers beside those of golden vectors: how many differ, and the first one in full.
 *
 * Answers are compared bit for bit in F, index, T and CP. Pure functions; any thread. */
#ifndef HITPIPE_HOST_DIVERGENCE_H
#define HITPIPE_HOST_DIVERGENCE_H

#include "host/import/vectors.h"

#include <jansson.h>

typedef struct hp_divergence {
    size_t count; /* records that differ */
    size_t first; /* the first of them; meaningless when there are none */
} hp_divergence;

/* answers: one a record. */
hp_divergence hp_diverge(const hp_vectors *vectors, const hp_result *answers);

/* Record `record` in words and numbers: place, group, both objects, what was expected, what came, what differs. */
void hp_divergence_print(FILE *file, const char *path, const hp_vectors *vectors, size_t record,
                         const hp_result *answer);

/* The same as {"record", "line", "group", "why", "primary", "secondary", "expected", "got", "differs"}, words as
 * eight hex digits. The caller frees it with json_decref. NULL: out of memory. */
json_t *hp_divergence_json(const hp_vectors *vectors, size_t record, const hp_result *answer);

#endif
