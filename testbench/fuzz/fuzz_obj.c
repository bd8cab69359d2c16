/* OBJ from anywhere. */
#include "mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    return fuzz_mesh(hp_mesh_read_obj, data, n);
}
