/* EXR images: every bit comes back, and broken files are refused. */
#include "host/import/exr.h"
#include "host/import/heightfield.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <OpenEXR/openexr.h>
#include <cmocka.h>

enum { WIDTH = 37, HEIGHT = 41 }; /* more than one chunk of lines, and none of them whole */

static uint32_t noise(uint32_t *state) {
    return *state = *state * 1664525 + 1013904223;
}

/* Channels out of order in the alphabet, with every kind of bit pattern. */
static void make(hp_exr *image) {
    static const char *const names[] = {"T", "index", "CP.X", "A"};
    uint32_t state = 1;
    hp_exr_create(image, WIDTH, HEIGHT);
    for (int c = 0; c < 4; c++) {
        uint32_t *words = hp_exr_add_channel(image, names[c], c == 1 ? HP_EXR_UINT : HP_EXR_FLOAT);
        assert_non_null(words);
        for (int i = 0; i < WIDTH * HEIGHT; i++) words[i] = c == 3 ? (uint32_t)i : noise(&state);
        words[0] = 0x7F800001; /* signalling NaN */
        words[1] = 0x80000000;
        words[2] = 0xFFFFFFFF;
    }
}

static const hp_exr_channel *channel(const hp_exr *image, const char *name) {
    for (size_t i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0) return &image->channels[i];
    fail_msg("no channel %s", name);
    return NULL;
}

static void every_bit_comes_back(void **state) {
    (void)state;
    hp_exr image, back;
    hp_bytes bytes;
    hp_fault fault = {0};
    const hp_exr_text texts[] = {{"owner", "someone"}, {NULL, NULL}};
    make(&image);
    image.spacing[0] = 72;
    image.spacing[1] = -90;
    image.texts = texts;
    if (hp_exr_write(&image, "file", &bytes, &fault) != HP_OK) fail_msg("%s", fault.message);
    assert_non_null(memmem(bytes.data, bytes.n, "someone", 7));
    if (hp_exr_read(&bytes, &back, &fault) != HP_OK) fail_msg("%s", fault.message);
    assert_int_equal(back.width, WIDTH);
    assert_int_equal(back.height, HEIGHT);
    assert_int_equal(back.channel_count, 4);
    assert_true(back.spacing[0] == 72 && back.spacing[1] == -90);
    for (size_t i = 0; i < image.channel_count; i++) {
        const hp_exr_channel *copy = channel(&back, image.channels[i].name);
        assert_int_equal(copy->type, image.channels[i].type);
        assert_memory_equal(copy->words, image.channels[i].words, WIDTH * HEIGHT * sizeof(uint32_t));
    }
    hp_exr_free(&image);
    hp_exr_free(&back);
    hp_bytes_free(&bytes);
}

static void cut_files_are_refused(void **state) {
    (void)state;
    hp_exr image, back;
    hp_bytes bytes, cut;
    hp_fault fault;
    make(&image);
    assert_int_equal(hp_exr_write(&image, "file", &bytes, &fault), HP_OK);
    for (size_t n = 0; n < bytes.n; n += 1 + n / 50) {
        assert_int_equal(hp_bytes_copy("cut.exr", bytes.data, n, &cut, &fault), HP_OK);
        fault.message[0] = 0;
        if (hp_exr_read(&cut, &back, &fault) != HP_ERROR_INPUT) fail_msg("accepted when cut to %zu bytes", n);
        assert_memory_equal(fault.message, "cut.exr: ", 9);
        assert_int_equal(back.channel_count, 0);
        hp_bytes_free(&cut);
    }
    hp_exr_free(&image);
    hp_bytes_free(&bytes);
}

/* Flips bits all over the file: it is refused or read, and the sanitizers watch. */
static void damaged_files_do_no_harm(void **state) {
    (void)state;
    hp_exr image, back;
    hp_bytes bytes;
    hp_fault fault;
    make(&image);
    assert_int_equal(hp_exr_write(&image, "file", &bytes, &fault), HP_OK);
    size_t refused = 0;
    for (size_t i = 0; i < bytes.n; i += i < 600 ? 1 : 97) {
        bytes.data[i] ^= 0x81;
        if (hp_exr_read(&bytes, &back, &fault) == HP_OK)
            hp_exr_free(&back);
        else
            refused++;
        bytes.data[i] ^= 0x81;
    }
    assert_true(refused > 100);
    hp_exr_free(&image);
    hp_bytes_free(&bytes);
}

/* ---- half numbers, and heights ---- */

typedef struct memory {
    uint8_t data[65536];
    size_t n;
} memory;

static int64_t put(exr_const_context_t context, void *user, const void *buffer, uint64_t n, uint64_t offset,
                   exr_stream_error_func_ptr_t error) {
    (void)context, (void)error;
    memory *file = user;
    assert_true(offset + n <= sizeof file->data);
    memcpy(file->data + offset, buffer, n);
    if (offset + n > file->n) file->n = offset + n;
    return (int64_t)n;
}

/* A one-channel file of 4 x 2 pixels of any type and any number of bytes, uncompressed, by the library alone. */
static void write_with_library(memory *file, exr_pixel_type_t type, int size, const void *pixels) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.user_data = file;
    init.write_fn = put;
    exr_context_t context;
    int part;
    file->n = 0;
    assert_int_equal(exr_start_write(&context, "file", EXR_WRITE_FILE_DIRECTLY, &init), EXR_ERR_SUCCESS);
    exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    exr_initialize_required_attr_simple(context, part, 4, 2, EXR_COMPRESSION_NONE);
    exr_add_channel(context, part, "anything", type, EXR_PERCEPTUALLY_LINEAR, 1, 1);
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    for (int row = 0; row < 2; row++) {
        exr_chunk_info_t chunk;
        exr_write_scanline_chunk_info(context, 0, row, &chunk);
        assert_int_equal(
            exr_write_scanline_chunk(context, 0, row, (const char *)pixels + 4 * row * size, 4 * (uint64_t)size),
            EXR_ERR_SUCCESS);
    }
    exr_finish(&context);
}

static hp_status read_heights(const memory *file, hp_heightfield *field, hp_fault *fault) {
    hp_bytes bytes;
    hp_bytes_copy("file", file->data, file->n, &bytes, fault);
    hp_status status = hp_heightfield_read_exr(&bytes, field, fault);
    hp_bytes_free(&bytes);
    return status;
}

static void heights_of_every_type_are_exact(void **state) {
    (void)state;
    static memory file;
    static const uint16_t halves[] = {0x0000, 0x8000, 0x0001, 0x03FF, 0x0400, 0x3C00, 0xC500, 0x7BFF};
    static const float from_halves[] = {0, -0.0f, 0x1p-24f, 0x1.ff8p-15f, 0x1p-14f, 1, -5, 65504};
    static const uint32_t whole[] = {0, 1, 2, 3, 236, 1076, 16777217, 4294967295u};
    static const float from_whole[] = {0, 1, 2, 3, 236, 1076, 16777216, 4294967296.0f};
    static const float floats[] = {0, 1.5f, -2, 3e38f, 1e-45f, 5, 6, 7};
    const struct {
        exr_pixel_type_t type;
        int size;
        const void *pixels;
        const float *heights;
    } cases[] = {{EXR_PIXEL_HALF, 2, halves, from_halves},
                 {EXR_PIXEL_UINT, 4, whole, from_whole},
                 {EXR_PIXEL_FLOAT, 4, floats, floats}};
    for (int i = 0; i < 3; i++) {
        hp_heightfield field;
        hp_fault fault = {0};
        write_with_library(&file, cases[i].type, cases[i].size, cases[i].pixels);
        if (read_heights(&file, &field, &fault) != HP_OK) fail_msg("%s", fault.message);
        assert_int_equal(field.rows, 2);
        assert_int_equal(field.columns, 4);
        assert_memory_equal(field.heights, cases[i].heights, 8 * sizeof(float));
        hp_heightfield_free(&field);
    }
}

static void heights_that_are_no_numbers_are_refused(void **state) {
    (void)state;
    static memory file;
    float heights[] = {0, 1, 2, 3, 4, 5, NAN, 7};
    hp_heightfield field;
    hp_fault fault = {0};
    write_with_library(&file, EXR_PIXEL_FLOAT, 4, heights);
    assert_int_equal(read_heights(&file, &field, &fault), HP_ERROR_INPUT);
    assert_string_equal(fault.message, "file: row 1, column 2: the height is NaN");
    heights[6] = -INFINITY;
    write_with_library(&file, EXR_PIXEL_FLOAT, 4, heights);
    assert_int_equal(read_heights(&file, &field, &fault), HP_ERROR_INPUT);
    assert_non_null(strstr(fault.message, "infinite"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bit_comes_back),
        cmocka_unit_test(cut_files_are_refused),
        cmocka_unit_test(damaged_files_do_no_harm),
        cmocka_unit_test(heights_of_every_type_are_exact),
        cmocka_unit_test(heights_that_are_no_numbers_are_refused),
    };
    return cmocka_run_group_tests_name("exr", tests, NULL, NULL);
}
