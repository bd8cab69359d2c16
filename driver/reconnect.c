/* A board that is lost in the midst of a call, or reset, and comes back. */
#include "device.h"
#include <string.h>
#include <time.h>

enum { STEP_MS = 50 }; /* between two looks whether the board is there */

static uint64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

/* ---- waiting for the board ---- */

static void pause_for(const hp_device *device, unsigned ms) {
    const struct timespec pause = {.tv_nsec = (long)ms * 1000000};
    if (device->def.wait)
        device->def.wait(device->def.wait_context, NULL, 0, ms);
    else
        nanosleep(&pause, NULL);
}

/* Opens the board anew as soon as it is there. */
static hp_status await_board(hp_device *device) {
    uint64_t deadline = now_ms() + device->def.reconnect_ms;
    hp_message why = {{0}};
    hp_drop_link(device);
    while (device->reopen(device->reopen_context, &device->transport, &why)) {
        device->transport = NULL;
        if (!hp_tell_progress(device, device->progress_done, device->progress_total))
            return hp_say(&device->message, HP_ERROR_CANCELLED, "%s", hp_status_text(HP_ERROR_CANCELLED));
        uint64_t now = now_ms();
        if (now >= deadline)
            return hp_say(&device->message, HP_ERROR_DISCONNECTED, "%s, and not back within %u ms: %.150s",
                          hp_status_text(HP_ERROR_DISCONNECTED), device->def.reconnect_ms, why.text);
        pause_for(device, deadline - now < STEP_MS ? (unsigned)(deadline - now) : STEP_MS);
    }
    device->session = false;
    if (device->scene_words && device->scene) device->scene_lost = device->scene;
    device->scene = (hp_object)0;
    return hp_open_link(device);
}

/* ---- going on ---- */

/* The order and the bits of records depend on these. The clock does not matter. */
static bool same_board(const hp_identity *a, const hp_identity *b) {
    return strcmp(a->name, b->name) == 0 && a->lanes == b->lanes && a->packet_primaries == b->packet_primaries &&
           a->pairs == b->pairs && a->loop_order == b->loop_order && a->subnormals == b->subnormals &&
           a->ddr_bytes == b->ddr_bytes;
}

static hp_status bring_back(hp_device *device) {
    const hp_identity before = device->identity;
    hp_status status = device->queue.disconnected ? await_board(device) : HP_OK;
    if (!status) status = hp_make_ready(device);
    if (!status && !same_board(&before, &device->identity))
        return hp_say(&device->message, HP_ERROR_DISCONNECTED, "%s; the one that came back is configured otherwise",
                      hp_status_text(HP_ERROR_DISCONNECTED));
    return status;
}

static bool may_come_back(hp_device *device, uint64_t taken) {
    if (!device->def.reconnect_ms || !device->reopen) return false;
    if (device->losses && taken > device->taken) device->losses = 0;
    device->taken = taken;
    return device->losses++ <= device->def.retries;
}

/* Lost, or reset: once more, on the way back. */
static bool is_away(const hp_device *device, hp_status status) {
    if (status == HP_ERROR_CANCELLED) return false;
    return device->queue.disconnected || (!device->session && status == HP_ERROR_SEQUENCE);
}

bool hp_recover(hp_device *device, hp_status *status, uint64_t taken) {
    while (is_away(device, *status) && may_come_back(device, taken)) {
        *status = bring_back(device);
        if (!device->transport) break; /* it did not come */
        if (*status) continue;
        device->reconnections++;
        return true;
    }
    return false;
}
