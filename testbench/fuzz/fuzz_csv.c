/* CSV from anywhere: it becomes rays that a board takes, or an error that names the file. */
#include "host/import/csv.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

static void require(bool holds) {
    if (!holds) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    hp_objects objects;
    require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
    hp_status status = hp_csv_read(&bytes, HP_RAY, &objects, &fault);
    require(status == HP_OK || (status == HP_ERROR_INPUT && strncmp(fault.message, "fuzz:", 5) == 0));
    require((status == HP_OK) == (objects.count > 0));
    for (size_t i = 0; i < objects.count; i++) require(!hp_object_fault(HP_RAY, objects.words + i * HP_RAY_WORDS));
    hp_objects_free(&objects);
    hp_bytes_free(&bytes);
    return 0;
}
