/* What makes the resident scene: secondaries, and the matrix that moves them. */
#include "device.h"
#include "words.h"
#include <math.h>
#include <stdlib.h>

typedef struct upload {
    hp_device *device;
    hp_object object;
    const float *words;
    size_t count, sent, done; /* objects */
    size_t chunk;             /* objects in a packet */
    bool quiet;               /* not the user's call: progress is not told */
} upload;

static hp_status check_scene(hp_device *device, hp_object object, const float *words, size_t count) {
    hp_message *message = &device->message;
    unsigned n = hp_object_words(object);
    if (n == 0) return hp_say(message, HP_ERROR_USAGE, "no object type has the number %d", (int)object);
    if (count && !words) return hp_say(message, HP_ERROR_USAGE, "no objects given");
    uint64_t most = device->identity.ddr_bytes / (4 * HP_BEAT_WORDS * hp_object_beats(object));
    if (most > HP_NO_INDEX) most = HP_NO_INDEX;
    if (count > most)
        return hp_say(message, HP_ERROR_CAPACITY, "%zu objects of type %s: the board holds %llu", count,
                      hp_object_name(object), (unsigned long long)most);
    for (size_t i = 0; i < count && !device->def.unchecked; i++) {
        const char *fault = hp_object_fault(object, words + i * n);
        if (fault) return hp_say(message, HP_ERROR_INPUT, "%s %zu %s", hp_object_name(object), i, fault);
    }
    return HP_OK;
}

static hp_status take_ack(hp_command *command, const uint8_t *payload, uint32_t length, bool last) {
    upload *up = command->owner;
    hp_status status = hp_take_nothing(command, payload, length, last);
    if (status) return status;
    up->done = up->done + up->chunk < up->count ? up->done + up->chunk : up->count;
    size_t bytes = 4 * hp_object_words(up->object);
    if (up->quiet) return HP_OK;
    return hp_tell_progress(up->device, up->done * bytes, up->count * bytes) ? HP_OK : HP_ERROR_CANCELLED;
}

static hp_status send_chunk(upload *up) {
    hp_command *command;
    hp_status status = hp_queue_reserve(&up->device->queue, &command);
    if (status) return status;
    unsigned n = hp_object_words(up->object);
    size_t count = up->count - up->sent < up->chunk ? up->count - up->sent : up->chunk;
    command->opcode = HP_OPCODE_UPLOAD;
    command->reply = HP_OPCODE_ACK;
    command->length = (uint32_t)(HP_UPLOAD_FIXED + 4 * n * count);
    command->take = take_ack;
    command->owner = up;
    hp_put32(command->payload + HP_AT_UPLOAD_object, (uint32_t)up->object);
    hp_put32(command->payload + HP_AT_UPLOAD_first, (uint32_t)up->sent);
    hp_put32(command->payload + HP_AT_UPLOAD_count, (uint32_t)count);
    hp_put32(command->payload + HP_AT_UPLOAD_reserved, 0);
    if (count) hp_put_words(command->payload + HP_UPLOAD_FIXED, up->words + up->sent * n, count * n);
    hp_queue_post(&up->device->queue, command);
    up->sent += count;
    return HP_OK;
}

static hp_status send_all(upload *up) {
    hp_device *device = up->device;
    hp_status status;
    up->chunk = (device->queue.payload_max - HP_UPLOAD_FIXED) / (4 * hp_object_words(up->object));
    up->sent = up->done = 0;
    do status = send_chunk(up);
    while (!status && up->sent < up->count);
    return hp_end(device, hp_queue_finish(&device->queue));
}

/* For a board that is lost and comes back, when the user wants that. */
static hp_status copy_scene(hp_device *device, const upload *up, float **copy) {
    size_t bytes = 4 * hp_object_words(up->object) * up->count;
    *copy = NULL;
    if (!device->def.reconnect_ms) return HP_OK;
    *copy = malloc(bytes ? bytes : 1);
    if (!*copy) return hp_say(&device->message, HP_ERROR_MEMORY, "no memory for a copy of the scene");
    if (bytes) memcpy(*copy, up->words, bytes);
    return HP_OK;
}

static void forget_scene(hp_device *device) {
    free(device->scene_words);
    device->scene_words = NULL;
    device->scene = device->scene_lost = (hp_object)0;
}

hp_status hp_upload(hp_device *device, hp_object object, const float *words, size_t count) {
    float *copy;
    if (!device) return HP_ERROR_USAGE;
    hp_status status = hp_begin(device);
    if (!status) status = check_scene(device, object, words, count);
    if (status) return status;
    upload up = {.device = device, .object = object, .words = words, .count = count};
    status = copy_scene(device, &up, &copy);
    if (status) return status;
    forget_scene(device); /* there is none until the last object is there */
    device->progress_total = 4 * hp_object_words(object) * count;
    do status = send_all(&up);
    while (status && hp_recover(device, &status, 0));
    if (status) {
        free(copy);
        return status;
    }
    device->scene = object;
    device->scene_count = count;
    device->scene_words = copy;
    return HP_OK;
}

hp_status hp_restore_scene(hp_device *device) {
    upload up = {.device = device,
                 .object = device->scene_lost,
                 .words = device->scene_words,
                 .count = device->scene_count,
                 .quiet = true};
    hp_status status = send_all(&up);
    if (status) return status;
    device->scene = device->scene_lost;
    device->scene_lost = (hp_object)0;
    return HP_OK;
}

hp_status hp_send_transform(hp_device *device) {
    static const float none[12];
    hp_command *command;
    hp_status status = hp_queue_reserve(&device->queue, &command);
    if (status) return status;
    command->opcode = HP_OPCODE_TRANSFORM;
    command->reply = HP_OPCODE_ACK;
    command->length = HP_TRANSFORM_FIXED;
    command->take = hp_take_nothing;
    hp_put32(command->payload + HP_AT_TRANSFORM_enable, device->transformed);
    hp_put_words(command->payload + HP_AT_TRANSFORM_matrix, device->transformed ? device->matrix : none, 12);
    status = hp_ask(device, command);
    if (!status) device->transform_due = false;
    return status;
}

hp_status hp_transform(hp_device *device, const float matrix[12]) {
    if (!device) return HP_ERROR_USAGE;
    hp_status status = hp_begin(device);
    if (status) return status;
    for (unsigned i = 0; matrix && !device->def.unchecked && i < 12; i++)
        if (!isfinite(matrix[i]))
            return hp_say(&device->message, HP_ERROR_INPUT, "matrix: row %u, column %u is %s", i / 4, i % 4,
                          isnan(matrix[i]) ? "a NaN" : "an infinity");
    device->transformed = matrix != NULL;
    device->transform_due = true;
    if (matrix) memcpy(device->matrix, matrix, sizeof device->matrix);
    status = hp_send_transform(device);
    return status && hp_recover(device, &status, 0) ? HP_OK : status; /* which sends it, too */
}
