/* What must hold of any mesh reader, whatever the bytes: a mesh of finite coordinates, or an error that names the
 * file. */
#ifndef HITPIPE_FUZZ_MESH_H
#define HITPIPE_FUZZ_MESH_H

#include "host/import/mesh.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

typedef hp_status fuzz_reader(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault);

static inline void fuzz_require(bool holds) {
    if (!holds) abort();
}

static inline int fuzz_mesh(fuzz_reader *read, const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    hp_mesh mesh = {0};
    fuzz_require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
    hp_status status = read(&bytes, &mesh, &fault);
    fuzz_require(status == HP_OK || (status == HP_ERROR_INPUT && strncmp(fault.message, "fuzz:", 5) == 0));
    fuzz_require(mesh.degenerate <= mesh.count);
    for (size_t i = 0; i < mesh.count * HP_TRIANGLE_WORDS; i++) fuzz_require(isfinite(mesh.words[i]));
    hp_mesh_free(&mesh);
    hp_bytes_free(&bytes);
    return 0;
}

#endif
