/* Board files from anywhere: a configuration that holds together, or an error that names the file and changes
 * nothing. */
#include "host/import/board_json.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

static void require(bool holds) {
    if (!holds) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    hp_config config, before;
    char message[HP_CONFIG_MESSAGE];
    require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
    memset(&config, 0, sizeof config);
    require(hp_config_preset(&config, "usb3") == HP_OK);
    before = config;
    hp_status status = hp_board_json_read(&bytes, &config, &fault);
    if (status == HP_OK)
        require(hp_config_check(&config, message) == HP_OK);
    else
        require(strncmp(fault.message, "fuzz:", 5) == 0 && memcmp(&config, &before, sizeof config) == 0);
    hp_bytes_free(&bytes);
    return 0;
}
