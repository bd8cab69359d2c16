/* Golden vectors: pairs of objects and the bits a board must answer, as text that $readmemh loads. docs/vectors.md
 * describes the format.
 *
 * Words are kept as bits: a NaN keeps its payload. Plain values without shared state: any thread. */
#ifndef HITPIPE_HOST_VECTORS_H
#define HITPIPE_HOST_VECTORS_H

#include "host/import/bytes.h"

#include <stdio.h>

enum {
    HP_VECTORS_VERSION = 1,
    HP_VECTOR_ANSWER_WORDS = 6, /* F, index, T, CP xyz */
};

/* Which boards must give these bits. */
typedef enum hp_numerics {
    HP_NUMERICS_GRADUAL, /* subnormals = gradual */
    HP_NUMERICS_FLUSH,   /* subnormals = flush */
    HP_NUMERICS_ANY      /* both */
} hp_numerics;

/* Records that belong together, from record `first` to the next group's. */
typedef struct hp_vector_group {
    char *name;
    char *why;     /* why the group exists */
    char *checked; /* what the oracle found at generation; NULL: not said */
    size_t first;
} hp_vector_group;

/* A file of vectors. Everything in it is owned by it. */
typedef struct hp_vectors {
    hp_pair pair;
    hp_numerics numerics;
    bool separation; /* T of a miss is the distance */
    char *generator; /* program, its version and seed */
    char *oracle;    /* program and its version */
    size_t count;
    float *primaries;   /* count objects, hp_object_words of the pair's primary each; any bits */
    float *secondaries; /* likewise */
    uint32_t *answers;  /* bits: HP_VECTOR_ANSWER_WORDS a record */
    size_t *lines;      /* of the file: where each record stands, from 1; 0 for one that was not read */
    hp_vector_group *groups;
    size_t group_count;
    size_t room, group_room; /* allocated */
} hp_vectors;

/* No groups and no records yet, no separation. The two strings are copied. HP_ERROR_MEMORY. */
hp_status hp_vectors_begin(hp_vectors *vectors, hp_pair pair, hp_numerics numerics, const char *generator,
                           const char *oracle, hp_fault *fault);
void hp_vectors_free(hp_vectors *vectors);

/* Begins a group; `checked` may be NULL. HP_ERROR_MEMORY. */
hp_status hp_vectors_add_group(hp_vectors *vectors, const char *name, const char *why, const char *checked,
                               hp_fault *fault);

/* Adds a record to the last group. HP_ERROR_MEMORY. */
hp_status hp_vectors_add(hp_vectors *vectors, const uint32_t *primary, const uint32_t *secondary,
                         const uint32_t answer[HP_VECTOR_ANSWER_WORDS], size_t line, hp_fault *fault);

/* Parses a file. HP_ERROR_INPUT: no such file, or not of the format, with "file:line:column: cause"; HP_ERROR_MEMORY.
 * On an error *vectors holds nothing. */
hp_status hp_vectors_read(const char *path, hp_vectors *vectors, hp_fault *fault);
hp_status hp_vectors_parse(const hp_bytes *bytes, hp_vectors *vectors, hp_fault *fault);

/* Writes what hp_vectors_parse reads. HP_ERROR_IO. */
hp_status hp_vectors_write(const hp_vectors *vectors, FILE *file, hp_fault *fault);

/* The group of a record; "gradual", "flush", "any". */
const hp_vector_group *hp_vectors_group_of(const hp_vectors *vectors, size_t record);
const char *hp_numerics_name(hp_numerics numerics);

#endif
