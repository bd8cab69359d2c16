#include "host/output/result_exr.h"

#include "host/output/file.h"

#include <string.h>

static const struct {
    const char *name;
    hp_exr_type type;
    size_t offset;
} channels[] = {
    {"T", HP_EXR_FLOAT, offsetof(hp_result, T)},        {"index", HP_EXR_UINT, offsetof(hp_result, index)},
    {"F", HP_EXR_UINT, offsetof(hp_result, F)},         {"CP.X", HP_EXR_FLOAT, offsetof(hp_result, CP[0])},
    {"CP.Y", HP_EXR_FLOAT, offsetof(hp_result, CP[1])}, {"CP.Z", HP_EXR_FLOAT, offsetof(hp_result, CP[2])},
};

static bool fill(hp_exr *image, const hp_result *results) {
    for (size_t c = 0; c < sizeof channels / sizeof channels[0]; c++) {
        uint32_t *words = hp_exr_add_channel(image, channels[c].name, channels[c].type);
        if (!words) return false;
        for (size_t i = 0; i < image->width * image->height; i++)
            memcpy(&words[i], (const char *)&results[i] + channels[c].offset, sizeof words[i]);
    }
    return true;
}

hp_status hp_result_exr_write(const char *path, const hp_result *results, size_t width, size_t height,
                              const hp_exr_text *texts, hp_fault *fault) {
    hp_exr image;
    hp_bytes bytes;
    hp_exr_create(&image, width, height);
    image.texts = texts;
    hp_status status = HP_OK;
    if (!fill(&image, results)) status = hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", path);
    if (status == HP_OK) status = hp_exr_write(&image, path, &bytes, fault);
    if (status == HP_OK) {
        status = hp_file_write(path, bytes.data, bytes.n, fault);
        hp_bytes_free(&bytes);
    }
    hp_exr_free(&image);
    return status;
}
