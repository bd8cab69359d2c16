/* Opening and closing a device, and what every call has in common. */
#include "device.h"
#include "transport/targets.h"
#include <stdlib.h>
#include <time.h>

enum { PROGRESS_MS = 50 };

/* ---- open ---- */

/* For waits without news: the same figures again. */
static bool tick(void *context) {
    hp_device *device = context;
    return hp_tell_progress(device, device->progress_done, device->progress_total);
}

hp_status hp_open_link(hp_device *device) {
    const hp_device_def *def = &device->def;
    const hp_link_counts counts = device->queue.counts;
    hp_status status =
        hp_queue_open(&device->queue, device->transport, &device->message, def->timeout_ms, def->retries);
    device->queue.counts = counts;
    device->queue.tick = def->progress ? tick : NULL;
    device->queue.tick_context = device;
    return status;
}

void hp_drop_link(hp_device *device) {
    if (!device->transport) return;
    device->transport->ops->close(device->transport);
    device->transport = NULL;
    hp_queue_close(&device->queue);
}

hp_status hp_open_transport(const hp_device_def *def, hp_transport *transport, hp_device **out, hp_message *message) {
    *out = NULL;
    hp_device *device = calloc(1, sizeof *device);
    if (!device) {
        transport->ops->close(transport);
        return hp_say(message, HP_ERROR_MEMORY, "%s", hp_status_text(HP_ERROR_MEMORY));
    }
    device->transport = transport;
    device->def = *def;
    hp_target_identify(transport, def, &device->identity);
    hp_status status = hp_open_link(device);
    if (!status) status = hp_begin(device);
    *message = device->message;
    if (status)
        hp_close(device);
    else
        *out = device;
    return status;
}

static hp_status reopen(void *context, hp_transport **transport, hp_message *message) {
    const hp_device *device = context;
    return hp_target_open(&device->def, transport, message);
}

static _Thread_local hp_message open_message; /* of this thread's last hp_open */

static hp_status check_def(const hp_device_def *def) {
    if (!def) return hp_say(&open_message, HP_ERROR_USAGE, "no device def");
    if (def->cookie != HP_DEVICE_COOKIE)
        return hp_say(&open_message, HP_ERROR_USAGE, "the device def does not come from hp_default_device_def");
    if (!def->timeout_ms) return hp_say(&open_message, HP_ERROR_USAGE, "timeout_ms is 0: nothing could come in time");
    return HP_OK;
}

hp_status hp_open(const hp_device_def *def, hp_device **out) {
    hp_transport *transport;
    open_message.text[0] = '\0';
    if (!out) return hp_say(&open_message, HP_ERROR_USAGE, "no place for the device");
    *out = NULL;
    hp_status status = check_def(def);
    if (!status) status = hp_target_open(def, &transport, &open_message);
    if (!status) status = hp_open_transport(def, transport, out, &open_message);
    if (status) return status;
    hp_device *device = *out;
    hp_target_again(transport, def, device->target, sizeof device->target);
    device->def.target = device->target;
    device->reopen = reopen;
    device->reopen_context = device;
    return HP_OK;
}

void hp_close(hp_device *device) {
    if (!device) return;
    hp_drop_link(device);
    free(device->scene_words);
    free(device->batch_primary);
    free(device->batch_secondary);
    free(device->batch_records);
    free(device);
}

size_t hp_completed(const hp_device *device) {
    return device ? device->completed : 0;
}

unsigned hp_reconnections(const hp_device *device) {
    return device ? device->reconnections : 0;
}

const hp_identity *hp_identify(const hp_device *device) {
    return device ? &device->identity : NULL;
}

const char *hp_error_message(const hp_device *device) {
    return device ? device->message.text : open_message.text;
}

/* ---- calls ---- */

hp_status hp_make_ready(hp_device *device) {
    hp_status status = hp_queue_settle(&device->queue);
    if (!status && device->queue.forgotten) hp_end(device, HP_OK);
    if (!status && !device->session) status = hp_say_hello(device);
    if (!status && device->transform_due) status = hp_send_transform(device);
    if (!status && device->scene_lost) status = hp_restore_scene(device);
    return status;
}

hp_status hp_begin(hp_device *device) {
    device->losses = 0;
    device->progress_done = device->progress_total = 0;
    hp_status status = hp_make_ready(device);
    if (status && hp_recover(device, &status, 0)) status = HP_OK;
    return status;
}

hp_status hp_end(hp_device *device, hp_status status) {
    if (device->queue.forgotten) {
        device->queue.forgotten = false;
        device->session = false;
        if (device->scene_words && device->scene) device->scene_lost = device->scene;
        device->scene = (hp_object)0;
    }
    return status;
}

hp_status hp_ask(hp_device *device, hp_command *command) {
    hp_queue_post(&device->queue, command);
    return hp_end(device, hp_queue_finish(&device->queue));
}

hp_status hp_take_nothing(hp_command *command, const uint8_t *payload, uint32_t length, bool last) {
    (void)command, (void)payload;
    return length == 0 && last ? HP_OK : HP_ERROR_LENGTH;
}

bool hp_tell_progress(hp_device *device, uint64_t done, uint64_t total) {
    const hp_device_def *def = &device->def;
    device->progress_done = done;
    device->progress_total = total;
    if (!def->progress) return true;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    uint64_t ms = (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
    if (device->progress_ms && ms < device->progress_ms + PROGRESS_MS) return true;
    device->progress_ms = ms;
    return def->progress(def->progress_context, done, total);
}
