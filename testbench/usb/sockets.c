/* Devices on the bus: plugging in and out, and what happens to them later. */
#include "bus.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RELEASE_US = 1000000 };

pthread_mutex_t hpt_lock = PTHREAD_MUTEX_INITIALIZER;
static hpt_device *devices[HPT_DEVICES_MOST];
static unsigned last_address = 1; /* of the root hub */

uint64_t hpt_now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

double hpt_now_ms(void) {
    return 1e-3 * (double)hpt_now_us();
}

hpt_device *hpt_device_next(const hpt_device *before) {
    unsigned i = 0;
    while (before && devices[i] != before) i++;
    for (i += before != NULL; i < HPT_DEVICES_MOST; i++)
        if (devices[i] && devices[i]->present) return devices[i];
    return NULL;
}

hpt_device *hpt_device_at(unsigned bus, unsigned address) {
    for (hpt_device *at = hpt_device_next(NULL); at; at = hpt_device_next(at))
        if (bus == HPT_BUS && at->address == address) return at;
    return NULL;
}

hpt_device *hpt_device_named(const char *name) {
    for (hpt_device *at = hpt_device_next(NULL); at; at = hpt_device_next(at))
        if (strcmp(at->name, name) == 0) return at;
    return NULL;
}

/* ---- in and out ---- */

static void configure(hpt_device *device) {
    const uint8_t setup[8] = {0x00, 9, 1};
    if (hpt_cable_control(device->cable, setup, NULL, 0) < 0) abort();
}

static void push(hpt_device *device) {
    if (device->present || device->discarded) return;
    device->address = ++last_address;
    device->present = true;
    device->push_due_us = 0;
    hpt_cable_push(device->cable);
    configure(device);
    hpt_udev_tell(device, "add");
}

static void pull(hpt_device *device) {
    device->pull_due = device->failing = false;
    device->pull_due_us = 0;
    if (!device->present) return;
    device->present = false;
    hpt_cable_pull(device->cable);
    while (device->later.first) hpt_pending_deliver(device->later.first);
    for (hpt_file *file = device->files; file; file = file->next) hpt_file_kill(file);
    memset(device->claims, 0, sizeof device->claims);
    hpt_udev_tell(device, "remove");
}

/* A fault of the cable, in the midst of its work. */
static void pulled(hpt_device *device, unsigned back_ms) {
    device->pull_due = true;
    if (!back_ms) return;
    device->push_due_us = hpt_now_us() + 1000ull * back_ms;
    hpt_clock_changed(device);
}

void hpt_settle(hpt_device *device) {
    if (device->present) hpt_cable_run(device->cable);
    if (device->pull_due) pull(device);
    if (!hpt_cable_holds(device->cable)) {
        device->release_due_us = 0;
    } else if (!device->release_due_us) {
        device->release_due_us = hpt_now_us() + RELEASE_US;
        hpt_clock_changed(device);
    }
}

void hpt_bus_reset(hpt_device *device) {
    hpt_cable_pull(device->cable);
    hpt_cable_push(device->cable);
    configure(device);
}

/* ---- later ---- */

static uint64_t next_due(const hpt_device *device) {
    uint64_t due = device->push_due_us ? device->push_due_us : UINT64_MAX;
    if (device->pull_due_us && device->pull_due_us < due) due = device->pull_due_us;
    if (device->later.first && device->later.first->due_us < due) due = device->later.first->due_us;
    if (device->release_due_us && device->release_due_us < due) due = device->release_due_us;
    return due;
}

static void *run_clock(void *argument) {
    hpt_device *device = argument;
    pthread_mutex_lock(&hpt_lock);
    while (device->ticking) {
        uint64_t now = hpt_now_us(), due = next_due(device);
        if (due > now) {
            struct timespec until = {(time_t)(due / 1000000), (long)(due % 1000000) * 1000};
            if (due == UINT64_MAX)
                pthread_cond_wait(&device->changed, &hpt_lock);
            else
                pthread_cond_timedwait(&device->changed, &hpt_lock, &until);
            continue;
        }
        if (device->later.first && device->later.first->due_us <= now) hpt_pending_deliver(device->later.first);
        if (device->pull_due_us && device->pull_due_us <= now) pull(device);
        if (device->push_due_us && device->push_due_us <= now) push(device);
        if (device->release_due_us && device->release_due_us <= now) hpt_cable_release(device->cable);
        if (device->present) hpt_settle(device);
    }
    pthread_mutex_unlock(&hpt_lock);
    return NULL;
}

void hpt_clock_changed(hpt_device *device) {
    if (device->ticking) {
        pthread_cond_signal(&device->changed);
        return;
    }
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&device->changed, &attributes);
    pthread_condattr_destroy(&attributes);
    device->ticking = true;
    if (pthread_create(&device->clock, NULL, run_clock, device)) abort();
}

/* ---- what tests call ---- */

static void cable_pulled(void *context, unsigned back_ms) {
    pulled(context, back_ms);
}

/* The cable's context is the device; the test's own choose wants its own. */
static hpt_fault choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    hpt_device *device = context;
    device->counts.packets[in] = number + 1;
    return device->def.choose(device->def.context, in, number, bytes, n);
}

hpt_device *hpt_plug(const hpt_device_def *def) {
    unsigned port = 0;
    pthread_mutex_lock(&hpt_lock);
    while (port < HPT_DEVICES_MOST && devices[port]) port++;
    hpt_device *device = port < HPT_DEVICES_MOST ? calloc(1, sizeof *device) : NULL;
    if (!device) abort();
    device->def = *def;
    device->port = port;
    snprintf(device->name, sizeof device->name, "%d-%u", HPT_BUS, port + 1);
    if (hp_gadget_create(&def->gadget, &device->gadget) != HP_OK) abort();
    device->cable = hpt_cable_new(device->gadget, def->choose ? choose : NULL, cable_pulled, device);
    devices[port] = device;
    push(device);
    pthread_mutex_unlock(&hpt_lock);
    return device;
}

void hpt_pull(hpt_device *device) {
    pthread_mutex_lock(&hpt_lock);
    device->push_due_us = 0;
    pull(device);
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_pull_slowly(hpt_device *device, unsigned ms) {
    pthread_mutex_lock(&hpt_lock);
    device->failing = true;
    for (hpt_file *file = device->files; file; file = file->next) hpt_file_fail(file);
    device->pull_due_us = hpt_now_us() + 1000ull * ms;
    hpt_clock_changed(device);
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_push(hpt_device *device) {
    pthread_mutex_lock(&hpt_lock);
    push(device);
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_discard(hpt_device *device) {
    if (!device) return;
    pthread_mutex_lock(&hpt_lock);
    device->discarded = true;
    pull(device);
    bool ticking = device->ticking;
    device->ticking = false;
    if (ticking) pthread_cond_signal(&device->changed);
    pthread_mutex_unlock(&hpt_lock);
    if (ticking) pthread_join(device->clock, NULL);
    pthread_mutex_lock(&hpt_lock);
    if (device->files) abort(); /* somebody has not closed the board */
    devices[device->port] = NULL;
    hpt_cable_free(device->cable);
    hp_gadget_destroy(device->gadget);
    if (ticking) pthread_cond_destroy(&device->changed);
    free(device);
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_deny(hpt_device *device, bool denied) {
    pthread_mutex_lock(&hpt_lock);
    device->def.denied = denied;
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_delay(hpt_device *device, unsigned delay_us) {
    pthread_mutex_lock(&hpt_lock);
    device->def.delay_us = delay_us;
    pthread_mutex_unlock(&hpt_lock);
}

int hpt_open(hpt_device *device) {
    pthread_mutex_lock(&hpt_lock);
    int fd = device->present ? hpt_file_open(device) : -ENODEV;
    pthread_mutex_unlock(&hpt_lock);
    return fd;
}

int hpt_control(hpt_device *device, const uint8_t setup[8], uint8_t *bytes, size_t length) {
    pthread_mutex_lock(&hpt_lock);
    int moved = device->present ? hpt_cable_control(device->cable, setup, bytes, length) : -ENODEV;
    hpt_settle(device);
    pthread_mutex_unlock(&hpt_lock);
    return moved;
}

hpt_bus_counts hpt_counts(hpt_device *device) {
    pthread_mutex_lock(&hpt_lock);
    hpt_bus_counts counts = device->counts;
    counts.in_flight = device->flying;
    pthread_mutex_unlock(&hpt_lock);
    return counts;
}
