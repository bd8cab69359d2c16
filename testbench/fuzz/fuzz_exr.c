/* EXR from anywhere: an image whose bits survive being written and read again, or an error that names the file. */
#include "host/import/exr.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

static void require(bool holds) {
    if (!holds) abort();
}

static const hp_exr_channel *named(const hp_exr *image, const char *name) {
    for (size_t i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0) return &image->channels[i];
    return NULL;
}

static void write_and_read_again(const hp_exr *image) {
    hp_fault fault;
    hp_bytes bytes;
    hp_exr again;
    /* a damaged name may be empty or stand twice: such an image is not written */
    if (hp_exr_write(image, "written", &bytes, &fault) != HP_OK) return;
    if (hp_exr_read(&bytes, &again, &fault) == HP_OK) {
        require(again.width == image->width && again.height == image->height);
        for (size_t i = 0; i < again.channel_count; i++) {
            const hp_exr_channel *before = named(image, again.channels[i].name);
            require(before && !memcmp(before->words, again.channels[i].words, image->width * image->height * 4));
        }
        hp_exr_free(&again);
    }
    hp_bytes_free(&bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_fault fault;
    hp_bytes bytes;
    hp_exr image;
    require(hp_bytes_copy("fuzz", data, n, &bytes, &fault) == HP_OK);
    hp_status status = hp_exr_read(&bytes, &image, &fault);
    if (status == HP_OK)
        write_and_read_again(&image);
    else
        require((status == HP_ERROR_INPUT || status == HP_ERROR_MEMORY) && strncmp(fault.message, "fuzz:", 5) == 0);
    hp_exr_free(&image);
    hp_bytes_free(&bytes);
    return 0;
}
