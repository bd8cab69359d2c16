#include "host/output/file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool standard(const char *path) {
    return strcmp(path, "-") == 0;
}

static hp_status refused(const char *path, hp_fault *fault) {
    const char *name = standard(path) ? "standard output" : path;
    return hp_fault_set(fault, HP_ERROR_IO, "%s: cannot be written: %s", name, strerror(errno));
}

FILE *hp_file_create(const char *path, hp_fault *fault) {
    FILE *file = standard(path) ? stdout : fopen(path, "wb");
    if (!file) refused(path, fault);
    return file;
}

hp_status hp_file_finish(FILE *file, const char *path, hp_fault *fault) {
    bool fine = fflush(file) == 0 && !ferror(file);
    hp_status status = fine ? HP_OK : refused(path, fault);
    bool closed = standard(path) || fclose(file) == 0;
    return fine && !closed ? refused(path, fault) : status;
}

hp_status hp_file_write(const char *path, const void *data, size_t n, hp_fault *fault) {
    FILE *file = hp_file_create(path, fault);
    if (!file) return fault->status;
    fwrite(data, 1, n, file);
    return hp_file_finish(file, path, fault);
}

hp_status hp_file_probe(const char *path, hp_fault *fault) {
    if (!path || standard(path)) return HP_OK;
    struct stat found;
    bool existed = lstat(path, &found) == 0; /* a link that leads nowhere too: it must stay */
    if (existed && stat(path, &found) == 0 && S_ISFIFO(found.st_mode))
        return HP_OK;               /* a reader would take it for all */
    FILE *file = fopen(path, "ab"); /* keeps what stands there */
    if (!file) return refused(path, fault);
    fclose(file);
    if (!existed) remove(path);
    return HP_OK;
}
