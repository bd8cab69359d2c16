/* Golden vectors from anywhere: whatever is in the file, the reader takes it or names a place in it; what it takes,
 * it writes so that it reads back the same. */
#include <stdlib.h>
#include <string.h>

#include "host/import/vectors.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

static void require(bool holds) {
    if (!holds) abort();
}

static void write_and_read_again(const hp_vectors *vectors) {
    hp_fault fault;
    char *text = NULL;
    size_t n = 0;
    FILE *file = open_memstream(&text, &n);
    require(file && hp_vectors_write(vectors, file, &fault) == HP_OK);
    fclose(file);
    hp_bytes bytes = {.name = "written", .data = (uint8_t *)text, .n = n};
    hp_vectors again;
    require(hp_vectors_parse(&bytes, &again, &fault) == HP_OK);
    require(again.count == vectors->count && again.group_count == vectors->group_count);
    require(memcmp(again.answers, vectors->answers, again.count * 4 * HP_VECTOR_ANSWER_WORDS) == 0);
    hp_vectors_free(&again);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    hp_vectors vectors;
    require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
    hp_status status = hp_vectors_parse(&bytes, &vectors, &fault);
    if (status == HP_OK)
        write_and_read_again(&vectors);
    else
        require(status == HP_ERROR_INPUT && strncmp(fault.message, "fuzz:", 5) == 0);
    hp_vectors_free(&vectors);
    hp_bytes_free(&bytes);
    return 0;
}
