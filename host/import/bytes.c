#include "host/import/bytes.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool hp_grow(void **array, size_t *room, size_t count, size_t size) {
    if (count < *room) return true;
    size_t wanted = *room ? 2 * *room : 64;
    void *grown = wanted > SIZE_MAX / size ? NULL : realloc(*array, wanted * size);
    if (!grown) return false;
    *array = grown;
    *room = wanted;
    return true;
}

static hp_status read_all(FILE *file, hp_bytes *bytes, hp_fault *fault) {
    size_t room = 0, got;
    do {
        /* a byte stays free for the zero at the end */
        if (!hp_grow((void **)&bytes->data, &room, bytes->n + 1, 1))
            return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", bytes->name);
        got = fread(bytes->data + bytes->n, 1, room - bytes->n - 1, file);
        bytes->n += got;
    } while (got > 0);
    if (ferror(file)) return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %s", bytes->name, strerror(errno));
    bytes->data[bytes->n] = 0;
    return HP_OK;
}

hp_status hp_bytes_read(const char *path, hp_bytes *bytes, hp_fault *fault) {
    bool standard = strcmp(path, "-") == 0;
    *bytes = (hp_bytes){.name = standard ? "(standard input)" : path};
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (!file) return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %s", *path ? path : "''", strerror(errno));
    hp_status status = read_all(file, bytes, fault);
    if (!standard) fclose(file);
    if (status != HP_OK) hp_bytes_free(bytes);
    return status;
}

hp_status hp_bytes_copy(const char *name, const void *data, size_t n, hp_bytes *bytes, hp_fault *fault) {
    *bytes = (hp_bytes){.name = name, .data = malloc(n + 1), .n = n};
    if (!bytes->data) return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", name);
    if (n > 0) memcpy(bytes->data, data, n);
    bytes->data[n] = 0;
    return HP_OK;
}

void hp_bytes_free(hp_bytes *bytes) {
    free(bytes->data);
    bytes->data = NULL;
    bytes->n = 0;
}
