#include "host/output/file.h"
#include "host/output/picture.h"

#include <png.h>

#include <setjmp.h>

static void complain(png_structp png, const char *text) {
    hp_fault *fault = png_get_error_ptr(png);
    hp_fault_set(fault, HP_ERROR_IO, "PNG: %s", text);
    longjmp(png_jmpbuf(png), 1);
}

static void encode(png_structp png, png_infop info, const uint8_t *rgb, size_t width, size_t height) {
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (size_t row = 0; row < height; row++) png_write_row(png, rgb + 3 * width * row);
    png_write_end(png, NULL);
}

hp_status hp_png_write(const char *path, const uint8_t *rgb, size_t width, size_t height, hp_fault *fault) {
    FILE *file = hp_file_create(path, fault);
    if (!file) return fault->status;
    hp_fault broken = {.status = HP_OK};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &broken, complain, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) hp_fault_set(&broken, HP_ERROR_MEMORY, "%s: out of memory", path);
    if (info && !setjmp(png_jmpbuf(png))) {
        png_init_io(png, file);
        encode(png, info, rgb, width, height);
    }
    png_destroy_write_struct(&png, &info);
    hp_status status = hp_file_finish(file, path, fault); /* names the system's reason, which PNG does not know */
    if (status == HP_OK && broken.status != HP_OK) *fault = broken, status = broken.status;
    return status;
}
