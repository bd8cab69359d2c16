/* PLY from anywhere: it becomes a mesh of finite coordinates, or an error that names the file. */
#include "host/import/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

static void require(bool holds) {
    if (!holds) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    hp_mesh mesh = {0};
    require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
    hp_status status = hp_mesh_read_ply(&bytes, &mesh, &fault);
    require(status == HP_OK || (status == HP_ERROR_INPUT && strncmp(fault.message, "fuzz:", 5) == 0));
    require(mesh.degenerate <= mesh.count);
    for (size_t i = 0; i < mesh.count * HP_TRIANGLE_WORDS; i++) require(isfinite(mesh.words[i]));
    hp_mesh_free(&mesh);
    hp_bytes_free(&bytes);
    return 0;
}
