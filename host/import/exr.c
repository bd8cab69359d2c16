#include "host/import/exr.h"

#include <openexr.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXR_SIDE_MAX = 1 << 20 };
#define EXR_WORDS_MAX ((uint64_t)1 << 28) /* 1 GiB of words in all channels */

void hp_exr_create(hp_exr *image, size_t width, size_t height) {
    *image = (hp_exr){.width = width, .height = height};
}

uint32_t *hp_exr_add_channel(hp_exr *image, const char *name, hp_exr_type type) {
    if (image->channel_count == HP_EXR_CHANNELS) return NULL;
    hp_exr_channel *channel = &image->channels[image->channel_count];
    channel->words = calloc(image->width * image->height, sizeof *channel->words);
    if (!channel->words) return NULL;
    snprintf(channel->name, sizeof channel->name, "%s", name);
    channel->type = type;
    image->channel_count++;
    return channel->words;
}

void hp_exr_free(hp_exr *image) {
    for (size_t i = 0; i < image->channel_count; i++) free(image->channels[i].words);
    *image = (hp_exr){0};
}

/* ---- what OpenEXRCore reads from, writes to and complains to ---- */

typedef struct exr_memory {
    hp_bytes *bytes;
    size_t room; /* of bytes->data, when writing */
    char complaint[256];
} exr_memory;

static exr_memory *memory_of(exr_const_context_t context) {
    void *memory = NULL;
    exr_get_user_data(context, &memory);
    return memory;
}

/* Keeps the first complaint, which is nearest to the cause. Early ones come before there is user data. */
static void complain(exr_const_context_t context, exr_result_t code, const char *text) {
    exr_memory *memory = context ? memory_of(context) : NULL;
    (void)code;
    if (memory && !memory->complaint[0]) snprintf(memory->complaint, sizeof memory->complaint, "%s", text);
}

static int64_t size_of(exr_const_context_t context, void *user) {
    (void)context;
    return (int64_t)((exr_memory *)user)->bytes->n;
}

static int64_t read_at(exr_const_context_t context, void *user, void *buffer, uint64_t n, uint64_t offset,
                       exr_stream_error_func_ptr_t error) {
    (void)context, (void)error;
    const hp_bytes *bytes = ((exr_memory *)user)->bytes;
    if (offset >= bytes->n) return 0;
    if (n > bytes->n - offset) n = bytes->n - offset;
    memcpy(buffer, bytes->data + offset, n);
    return (int64_t)n;
}

static int64_t write_at(exr_const_context_t context, void *user, const void *buffer, uint64_t n, uint64_t offset,
                        exr_stream_error_func_ptr_t error) {
    (void)context, (void)error;
    exr_memory *memory = user;
    hp_bytes *bytes = memory->bytes;
    size_t end = offset + n;
    while (memory->room <= end)
        if (!hp_grow((void **)&bytes->data, &memory->room, memory->room, 1)) return -1;
    if (offset > bytes->n) memset(bytes->data + bytes->n, 0, offset - bytes->n);
    memcpy(bytes->data + offset, buffer, n);
    if (end > bytes->n) bytes->n = end;
    return (int64_t)n;
}

static exr_context_initializer_t initializer(exr_memory *memory) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = complain;
    init.user_data = memory;
    init.read_fn = read_at;
    init.size_fn = size_of;
    init.write_fn = write_at;
    init.max_image_width = init.max_image_height = EXR_SIDE_MAX;
    init.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return init;
}

static hp_status exr_fault(const exr_memory *memory, exr_result_t code, hp_fault *fault) {
    const char *why = memory->complaint[0] ? memory->complaint : exr_get_default_error_message(code);
    hp_status status = code == EXR_ERR_OUT_OF_MEMORY ? HP_ERROR_MEMORY : HP_ERROR_INPUT;
    return hp_fault_set(fault, status, "%s: %s", memory->bytes->name, why);
}

/* ---- reading ---- */

/* binary16 to binary32: exact */
static uint32_t widen(uint16_t half) {
    uint32_t sign = (uint32_t)(half & 0x8000) << 16, exponent = half >> 10 & 31, fraction = half & 1023;
    if (exponent == 31) return sign | 0x7F800000 | fraction << 13;
    if (exponent != 0) return sign | (exponent + 112) << 23 | fraction << 13;
    float small = (float)fraction * 0x1p-24f;
    uint32_t bits;
    memcpy(&bits, &small, sizeof bits);
    return sign | bits;
}

/* In place, from the last to the first: half number i stands before word i. */
static void widen_all(uint32_t *words, size_t n) {
    const uint8_t *halves = (const uint8_t *)words;
    for (size_t i = n; i-- > 0;) {
        uint16_t half;
        memcpy(&half, halves + 2 * i, sizeof half);
        words[i] = widen(half);
    }
}

/* Refuses, before anything is allocated, what is no plain image and what the file cannot hold. */
static hp_status check_header(exr_context_t context, const hp_bytes *bytes, hp_fault *fault) {
    int parts = 0, lines = 1;
    exr_storage_t storage;
    exr_compression_t compression;
    exr_attr_box2i_t window;
    const exr_attr_chlist_t *channels;
    if (exr_get_count(context, &parts) != EXR_ERR_SUCCESS || parts != 1)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %d parts; only single images are read", bytes->name, parts);
    if (exr_get_storage(context, 0, &storage) != EXR_ERR_SUCCESS || storage != EXR_STORAGE_SCANLINE)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: tiled or deep; only scanline images are read", bytes->name);
    if (exr_get_compression(context, 0, &compression) != EXR_ERR_SUCCESS || compression > EXR_COMPRESSION_PXR24)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: compressed by B44 or DWA, which lose bits", bytes->name);
    if (exr_get_data_window(context, 0, &window) != EXR_ERR_SUCCESS ||
        exr_get_channels(context, 0, &channels) != EXR_ERR_SUCCESS ||
        exr_get_scanlines_per_chunk(context, 0, &lines) != EXR_ERR_SUCCESS || lines < 1)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: corrupt header", bytes->name);
    if (channels->num_channels < 1 || channels->num_channels > HP_EXR_CHANNELS)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %d channels; 1 to %d are read", bytes->name,
                            channels->num_channels, HP_EXR_CHANNELS);
    for (int i = 0; i < channels->num_channels; i++)
        if (channels->entries[i].x_sampling != 1 || channels->entries[i].y_sampling != 1)
            return hp_fault_set(fault, HP_ERROR_INPUT, "%s: channel %d is subsampled", bytes->name, i);
    uint64_t width = (uint64_t)((int64_t)window.max.x - window.min.x + 1);
    uint64_t height = (uint64_t)((int64_t)window.max.y - window.min.y + 1);
    uint64_t chunks = (height + (uint64_t)lines - 1) / (uint64_t)lines;
    if (width * height * (uint64_t)channels->num_channels > EXR_WORDS_MAX || chunks * 16 > bytes->n)
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %llu x %llu pixels do not fit in the file's %zu bytes",
                            bytes->name, (unsigned long long)width, (unsigned long long)height, bytes->n);
    return HP_OK;
}

static hp_status make_channels(exr_context_t context, const hp_bytes *bytes, hp_exr *image, hp_fault *fault) {
    exr_attr_box2i_t window;
    const exr_attr_chlist_t *channels;
    exr_attr_v2f_t spacing;
    exr_get_data_window(context, 0, &window);
    exr_get_channels(context, 0, &channels);
    hp_exr_create(image, (size_t)(window.max.x - window.min.x) + 1, (size_t)(window.max.y - window.min.y) + 1);
    for (int i = 0; i < channels->num_channels; i++) {
        hp_exr_type type = channels->entries[i].pixel_type == EXR_PIXEL_UINT ? HP_EXR_UINT : HP_EXR_FLOAT;
        if (!hp_exr_add_channel(image, channels->entries[i].name.str, type))
            return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", bytes->name);
    }
    if (exr_attr_get_v2f(context, 0, "spacing", &spacing) == EXR_ERR_SUCCESS) {
        image->spacing[0] = spacing.x;
        image->spacing[1] = spacing.y;
    }
    return HP_OK;
}

/* Points the decoder's channels at the rows of a chunk that begins `row` rows below the top. Half numbers stay halves
 * here, at the front of their channel. */
static void aim(exr_decode_pipeline_t *decode, hp_exr *image, size_t row) {
    for (int i = 0; i < decode->channel_count; i++) {
        exr_coding_channel_info_t *channel = &decode->channels[i];
        size_t size = (size_t)channel->bytes_per_element;
        channel->user_bytes_per_element = channel->bytes_per_element;
        channel->user_data_type = channel->data_type;
        channel->user_pixel_stride = (int32_t)size;
        channel->user_line_stride = (int32_t)(size * image->width);
        channel->decode_to_ptr = (uint8_t *)image->channels[i].words + row * image->width * size;
    }
}

static exr_result_t decode_chunks(exr_context_t context, hp_exr *image, exr_decode_pipeline_t *decode) {
    exr_attr_box2i_t window;
    int lines = 1;
    exr_get_data_window(context, 0, &window);
    exr_get_scanlines_per_chunk(context, 0, &lines);
    exr_result_t code = EXR_ERR_SUCCESS;
    for (size_t row = 0; row < image->height && code == EXR_ERR_SUCCESS; row += (size_t)lines) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(context, 0, window.min.y + (int)row, &chunk);
        if (code != EXR_ERR_SUCCESS) break;
        code = row == 0 ? exr_decoding_initialize(context, 0, &chunk, decode)
                        : exr_decoding_update(context, 0, &chunk, decode);
        if (code != EXR_ERR_SUCCESS) break;
        aim(decode, image, row);
        if (row == 0) code = exr_decoding_choose_default_routines(context, 0, decode);
        if (code == EXR_ERR_SUCCESS) code = exr_decoding_run(context, 0, decode);
    }
    return code;
}

static void widen_channels(exr_context_t context, hp_exr *image) {
    const exr_attr_chlist_t *channels;
    exr_get_channels(context, 0, &channels);
    for (size_t i = 0; i < image->channel_count; i++)
        if (channels->entries[i].pixel_type == EXR_PIXEL_HALF)
            widen_all(image->channels[i].words, image->width * image->height);
}

hp_status hp_exr_read(const hp_bytes *bytes, hp_exr *image, hp_fault *fault) {
    *image = (hp_exr){0};
    hp_bytes source = *bytes;
    exr_memory memory = {.bytes = &source};
    exr_context_initializer_t init = initializer(&memory);
    exr_context_t context = NULL;
    exr_result_t code = exr_start_read(&context, bytes->name, &init);
    if (code != EXR_ERR_SUCCESS) return exr_fault(&memory, code, fault);

    hp_status status = check_header(context, bytes, fault);
    if (status == HP_OK) status = make_channels(context, bytes, image, fault);
    if (status == HP_OK) {
        exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
        code = decode_chunks(context, image, &decode);
        if (code != EXR_ERR_SUCCESS)
            status = exr_fault(&memory, code, fault);
        else
            widen_channels(context, image);
        exr_decoding_destroy(context, &decode);
    }
    exr_finish(&context);
    if (status != HP_OK) hp_exr_free(image);
    return status;
}

/* ---- writing ---- */

static exr_result_t write_header(exr_context_t context, const hp_exr *image) {
    int part;
    exr_result_t code = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, part, (int32_t)image->width, (int32_t)image->height,
                                                   EXR_COMPRESSION_ZIP);
    for (size_t i = 0; i < image->channel_count && code == EXR_ERR_SUCCESS; i++)
        code = exr_add_channel(context, part, image->channels[i].name,
                               image->channels[i].type == HP_EXR_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LINEAR, 1, 1);
    if (code == EXR_ERR_SUCCESS && image->spacing[0] != 0)
        code = exr_attr_set_v2f(context, part, "spacing",
                                &(exr_attr_v2f_t){.x = image->spacing[0], .y = image->spacing[1]});
    for (const hp_exr_text *text = image->texts; text && text->name && code == EXR_ERR_SUCCESS; text++)
        code = exr_attr_set_string(context, part, text->name, text->value);
    return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

static const hp_exr_channel *channel_named(const hp_exr *image, const char *name) {
    for (size_t i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0) return &image->channels[i];
    return NULL;
}

/* The file keeps its channels sorted by name, so they are found by name. */
static void take_from(exr_encode_pipeline_t *encode, const hp_exr *image, size_t row) {
    for (int i = 0; i < encode->channel_count; i++) {
        exr_coding_channel_info_t *channel = &encode->channels[i];
        channel->user_pixel_stride = sizeof(uint32_t);
        channel->user_line_stride = (int32_t)(sizeof(uint32_t) * image->width);
        channel->encode_from_ptr =
            (const uint8_t *)(channel_named(image, channel->channel_name)->words + row * image->width);
    }
}

static exr_result_t encode_chunks(exr_context_t context, const hp_exr *image, exr_encode_pipeline_t *encode) {
    int lines = 1;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &lines);
    for (size_t row = 0; row < image->height && code == EXR_ERR_SUCCESS; row += (size_t)lines) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(context, 0, (int)row, &chunk);
        if (code != EXR_ERR_SUCCESS) break;
        code = row == 0 ? exr_encoding_initialize(context, 0, &chunk, encode)
                        : exr_encoding_update(context, 0, &chunk, encode);
        if (code != EXR_ERR_SUCCESS) break;
        take_from(encode, image, row);
        if (row == 0) code = exr_encoding_choose_default_routines(context, 0, encode);
        if (code == EXR_ERR_SUCCESS) code = exr_encoding_run(context, 0, encode);
    }
    return code;
}

hp_status hp_exr_write(const hp_exr *image, const char *name, hp_bytes *bytes, hp_fault *fault) {
    *bytes = (hp_bytes){.name = name};
    exr_memory memory = {.bytes = bytes};
    exr_context_initializer_t init = initializer(&memory);
    exr_context_t context = NULL;
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t code = exr_start_write(&context, name, EXR_WRITE_FILE_DIRECTLY, &init);
    if (code == EXR_ERR_SUCCESS) code = write_header(context, image);
    if (code == EXR_ERR_SUCCESS) code = encode_chunks(context, image, &encode);
    if (context) exr_encoding_destroy(context, &encode);
    exr_result_t finished = context ? exr_finish(&context) : EXR_ERR_SUCCESS;
    if (code == EXR_ERR_SUCCESS) code = finished;
    if (code == EXR_ERR_SUCCESS) return HP_OK;
    exr_fault(&memory, code, fault);
    fault->status = code == EXR_ERR_OUT_OF_MEMORY ? HP_ERROR_MEMORY : HP_ERROR_INTERNAL;
    hp_bytes_free(bytes);
    return fault->status;
}
