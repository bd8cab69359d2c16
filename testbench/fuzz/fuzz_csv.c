/* CSV from anywhere: as any type of object, it becomes objects that a board takes, or an error that names the file.
 */
#include "host/import/csv.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

static void require(bool holds) {
    if (!holds) abort();
}

static void read_as(hp_object object, const hp_bytes *bytes) {
    hp_fault fault;
    hp_objects objects;
    hp_status status = hp_csv_read(bytes, object, &objects, &fault);
    require(status == HP_OK || (status == HP_ERROR_INPUT && strncmp(fault.message, "fuzz:", 5) == 0));
    require((status == HP_OK) == (objects.count > 0));
    for (size_t i = 0; i < objects.count; i++)
        require(!hp_object_fault(object, objects.words + i * hp_object_words(object)));
    hp_objects_free(&objects);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
#define HP_OBJECT(name, NAME, code, words, layout) read_as(HP_##NAME, &bytes);
#include <hitpipe/objects.def>
#undef HP_OBJECT
    hp_bytes_free(&bytes);
    return 0;
}
