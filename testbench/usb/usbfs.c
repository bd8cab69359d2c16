/* Open files of usbfs: urbs and the other ioctls, as drivers/usb/core/devio.c answers them. */
#include "bus.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { CONTROL_SETUP = 8, PIPE_BYTES = 4096 };

static hpt_file *files[HPT_FILES_MOST];
static hpt_pending *spare; /* urbs that were reaped */

__attribute__((no_sanitize("address", "undefined", "thread"))) hpt_file *hpt_file_at(int fd) {
    return fd >= 0 && fd < HPT_FILES_MOST ? __atomic_load_n(&files[fd], __ATOMIC_ACQUIRE) : NULL;
}

/* ---- lists ---- */

static void append(hpt_pendings *list, hpt_pending *pending) {
    pending->next = NULL;
    if (list->first)
        list->last->next = pending;
    else
        list->first = pending;
    list->last = pending;
}

static void take(hpt_pendings *list, hpt_pending *pending) {
    hpt_pending *before = NULL, *at = list->first;
    for (; at && at != pending; at = at->next) before = at;
    if (!at) return;
    if (before)
        before->next = at->next;
    else
        list->first = at->next;
    if (list->last == at) list->last = before;
}

/* ---- the file itself ---- */

/* The pipe holds one byte, and is full, while there is nothing to reap. */
static void show(hpt_file *file) {
    bool ready = file->ended.first != NULL;
    char byte = 0;
    if (file->dead || ready == file->ready) return;
    file->ready = ready;
    if (ready ? hpt_kernel_read(file->reader, &byte, 1) != 1 : hpt_kernel_write(file->fd, &byte, 1) != 1) abort();
}

int hpt_file_open(hpt_device *device) {
    int ends[2];
    if (syscall(SYS_pipe2, ends, O_CLOEXEC | O_NONBLOCK)) return -errno;
    hpt_file *file = calloc(1, sizeof *file);
    if (!file || ends[1] >= HPT_FILES_MOST) abort();
    *file = (hpt_file){.fd = ends[1], .reader = ends[0], .device = device, .ready = true, .next = device->files};
    syscall(SYS_fcntl, file->fd, F_SETPIPE_SZ, PIPE_BYTES);
    show(file);
    device->files = file;
    device->counts.files++;
    __atomic_store_n(&files[file->fd], file, __ATOMIC_RELEASE);
    return file->fd;
}

void hpt_file_kill(hpt_file *file) {
    if (file->dead) return;
    file->dead = true;
    hpt_kernel_close(file->reader); /* the writing end is in error now */
}

static void release_all(hpt_file *file) {
    for (unsigned i = 0; i < HPT_INTERFACES; i++)
        if (file->device->claims[i] == file) file->device->claims[i] = NULL;
}

static void forget(hpt_pending *pending) {
    pending->next = spare;
    spare = pending;
}

/* What is under way is called back, what was delayed is not waited for. */
static void end_urbs(hpt_file *file) {
    hpt_device *device = file->device;
    for (hpt_pending *at; (at = file->under_way.first);) {
        hpt_cable_unlink(device->cable, &at->urb);
        if (file->under_way.first == at) abort(); /* the cable has lost it */
    }
    for (hpt_pending *at = device->later.first, *next; at; at = next) {
        next = at->next;
        if (at->file == file) hpt_pending_deliver(at);
    }
    for (hpt_pending *at; (at = file->ended.first);) {
        take(&file->ended, at);
        forget(at);
    }
}

void hpt_file_close(hpt_file *file) {
    hpt_device *device = file->device;
    end_urbs(file);
    release_all(file);
    hpt_file **at = &device->files;
    while (*at != file) at = &(*at)->next;
    *at = file->next;
    device->counts.files--;
    __atomic_store_n(&files[file->fd], NULL, __ATOMIC_RELEASE);
    hpt_file_kill(file);
    hpt_kernel_close(file->fd);
    free(file);
    hpt_settle(device);
}

/* The device descriptor and the configuration, one after the other. */
long hpt_file_read(hpt_file *file, void *bytes, size_t n) {
    size_t configuration;
    const uint8_t *second = hp_gadget_configuration(file->device->gadget, &configuration);
    const uint8_t *first = hp_gadget_device_descriptor(file->device->gadget);
    enum { DEVICE = 18 };
    size_t all = DEVICE + configuration, at = 0;
    if (file->dead) return -ENODEV;
    for (; at < n && file->offset < all; at++, file->offset++)
        ((uint8_t *)bytes)[at] = file->offset < DEVICE ? first[file->offset] : second[file->offset - DEVICE];
    return (long)at;
}

void *hpt_file_map(hpt_file *file, size_t bytes) {
    size_t room = 64u << 20;
    if (!file->device->def.maps || file->dead) return NULL;
    if (!file->map) { /* one range for all, so that it is known what lies in it */
        void *range = (void *)syscall(SYS_mmap, NULL, room, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (range == MAP_FAILED) return NULL;
        file->map = range;
    }
    if (file->map_bytes + bytes > room) return NULL;
    uint8_t *memory = file->map + file->map_bytes;
    file->map_bytes += bytes;
    return syscall(SYS_mprotect, memory, bytes, PROT_READ | PROT_WRITE) ? NULL : memory;
}

/* ---- urbs ---- */

static bool is_bulk(const hpt_pending *pending) {
    return pending->user->type == USBDEVFS_URB_TYPE_BULK;
}

/* Of a device that is failing, all but the urb that waits for events. */
static bool fails(const hpt_pending *pending) {
    return pending->file->device->failing && pending->urb.urb.endpoint != HP_USB_EVENT_ENDPOINT;
}

void hpt_pending_deliver(hpt_pending *pending) {
    hpt_file *file = pending->file;
    take(&file->device->later, pending); /* it is in one of the two */
    take(&file->under_way, pending);
    append(&file->ended, pending);
    show(file);
}

/* When an urb that has ended well comes to the host; 0: at once. */
static uint64_t due(hpt_device *device, const hpt_pending *pending) {
    const hpt_device_def *def = &device->def;
    double now = (double)hpt_now_us();
    if (def->rate && is_bulk(pending)) {
        if (device->busy_us < now) device->busy_us = now;
        device->busy_us += 1e3 * (double)pending->urb.urb.moved / def->rate;
        now = device->busy_us;
    }
    if (pending->urb.urb.endpoint & 0x80) now += def->delay_us;
    return now > (double)hpt_now_us() ? (uint64_t)now : 0;
}

static void urb_done(hpt_urb *urb) {
    hpt_pending *pending = urb->owner;
    hpt_device *device = pending->file->device;
    device->memory -= pending->bytes;
    device->flying -= is_bulk(pending);
    if (fails(pending)) urb->error = -EPROTO;
    pending->due_us = due(device, pending);
    if (!pending->due_us || urb->error) {
        hpt_pending_deliver(pending);
        return;
    }
    take(&pending->file->under_way, pending);
    append(&device->later, pending);
    hpt_clock_changed(device);
}

static int claim(hpt_file *file, unsigned interface) {
    if (interface >= HPT_INTERFACES) return -ENOENT;
    const hpt_file **claimed = &file->device->claims[interface];
    if (*claimed && *claimed != file) return -EBUSY;
    *claimed = file;
    return 0;
}

static int claim_for(hpt_file *file, unsigned endpoint) {
    if (endpoint == HP_USB_EVENT_ENDPOINT) return claim(file, HP_USB_HID_INTERFACE);
    return endpoint ? claim(file, HP_USB_DATA_INTERFACE) : 0;
}

static void count_urb(hpt_device *device, const hpt_pending *pending) {
    hpt_bus_counts *counts = &device->counts;
    const uint8_t *bytes = pending->urb.urb.bytes, *map = pending->file->map;
    device->memory += pending->bytes;
    if (device->memory > counts->memory_most) counts->memory_most = device->memory;
    if (!is_bulk(pending)) return;
    counts->urbs++;
    counts->mapped += map && bytes >= map && bytes < map + pending->file->map_bytes;
    device->flying++;
    if (device->flying > counts->in_flight_most) counts->in_flight_most = device->flying;
}

static hpt_pending *new_pending(void) {
    hpt_pending *pending = spare;
    if (pending)
        spare = pending->next;
    else
        pending = malloc(sizeof *pending);
    if (!pending) abort();
    return pending;
}

static int submit(hpt_file *file, struct usbdevfs_urb *user) {
    hpt_device *device = file->device;
    bool control = user->type == USBDEVFS_URB_TYPE_CONTROL;
    size_t skip = control ? CONTROL_SETUP : 0, n = (size_t)user->buffer_length - skip;
    if (user->buffer_length < (int)skip || user->type == USBDEVFS_URB_TYPE_ISO) return -EINVAL;
    int error = claim_for(file, control ? 0 : user->endpoint);
    if (error) return error;
    if (device->def.memory && device->memory + n > device->def.memory) return -ENOMEM;
    hpt_pending *pending = new_pending();
    *pending = (hpt_pending){.file = file, .user = user, .bytes = n};
    pending->urb = (hpt_urb){.urb = {.endpoint = control ? 0 : user->endpoint,
                                     .bytes = (uint8_t *)user->buffer + skip,
                                     .length = n,
                                     .zero_packet = user->flags & USBDEVFS_URB_ZERO_PACKET},
                             .done = urb_done,
                             .owner = pending};
    if (control) memcpy(pending->urb.urb.setup, user->buffer, CONTROL_SETUP);
    append(&file->under_way, pending);
    count_urb(device, pending);
    if (fails(pending))
        urb_done(&pending->urb);
    else
        hpt_cable_submit(device->cable, &pending->urb);
    return 0;
}

void hpt_file_fail(hpt_file *file) {
    for (hpt_pending *at = file->under_way.first, *next; at; at = next) {
        next = at->next;
        if (fails(at)) hpt_cable_unlink(file->device->cable, &at->urb);
    }
}

static hpt_pending *find(const hpt_pendings *list, const hpt_file *file, const struct usbdevfs_urb *user) {
    hpt_pending *at = list->first;
    while (at && (at->file != file || at->user != user)) at = at->next;
    return at;
}

/* One that is on its late way comes back at once and empty: what it carried is lost. */
static int discard(hpt_file *file, const struct usbdevfs_urb *user) {
    hpt_pending *at = find(&file->under_way, file, user), *late = find(&file->device->later, file, user);
    if (at) hpt_cable_unlink(file->device->cable, &at->urb);
    if (late) {
        late->urb.error = -ENOENT;
        late->urb.urb.moved = 0;
        hpt_pending_deliver(late);
    }
    return at || late ? 0 : -EINVAL;
}

static int reap(hpt_file *file, struct usbdevfs_urb **user) {
    hpt_pending *pending = file->ended.first;
    if (!pending) return file->dead ? -ENODEV : -EAGAIN;
    take(&file->ended, pending);
    show(file);
    *user = pending->user;
    (*user)->status = pending->urb.error;
    (*user)->actual_length = (int)pending->urb.urb.moved;
    forget(pending);
    return 0;
}

/* ---- the other ioctls ---- */

static int control(hpt_file *file, struct usbdevfs_ctrltransfer *request) {
    const uint8_t setup[8] = {
        request->bRequestType,
        request->bRequest,
        (uint8_t)request->wValue,
        (uint8_t)(request->wValue >> 8),
        (uint8_t)request->wIndex,
        (uint8_t)(request->wIndex >> 8),
        (uint8_t)(request->wLength & 255),
        (uint8_t)(request->wLength >> 8),
    };
    if (file->device->failing) return -EPROTO;
    return hpt_cable_control(file->device->cable, setup, request->data, request->wLength);
}

static int set_interface(hpt_file *file, const struct usbdevfs_setinterface *choice) {
    const uint8_t setup[8] = {0x01, 11, (uint8_t)choice->altsetting, 0, (uint8_t)choice->interface, 0, 0, 0};
    int error = claim(file, choice->interface);
    if (error) return error;
    if (!file->device->def.keeps) hpt_cable_flush(file->device->cable);
    return hpt_cable_control(file->device->cable, setup, NULL, 0) < 0 ? -EPIPE : 0;
}

static unsigned capabilities(const hpt_device *device) {
    unsigned caps = device->def.caps;
    return caps ? caps
                : USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                      USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_MMAP;
}

static int clear_halt(hpt_device *device, unsigned endpoint) {
    device->counts.halts_cleared++;
    return hpt_cable_clear_halt(device->cable, (uint8_t)endpoint);
}

static int get_driver(const hpt_device *device, struct usbdevfs_getdriver *driver) {
    if (driver->interface >= HPT_INTERFACES || !device->claims[driver->interface]) return -ENODATA;
    strcpy(driver->driver, "usbfs");
    return 0;
}

static int answer(hpt_file *file, unsigned long request, void *argument) {
    hpt_device *device = file->device;
    switch (request) {
    case USBDEVFS_CONTROL:
        return control(file, argument);
    case USBDEVFS_SUBMITURB:
        return submit(file, argument);
    case USBDEVFS_DISCARDURB:
        return discard(file, argument);
    case USBDEVFS_CLAIMINTERFACE:
        return claim(file, *(unsigned *)argument);
    case USBDEVFS_RELEASEINTERFACE:
        if (*(unsigned *)argument >= HPT_INTERFACES || device->claims[*(unsigned *)argument] != file) return -EINVAL;
        device->claims[*(unsigned *)argument] = NULL;
        return 0;
    case USBDEVFS_SETINTERFACE:
        return set_interface(file, argument);
    case USBDEVFS_CLEAR_HALT:
        return clear_halt(device, *(unsigned *)argument);
    case USBDEVFS_RESET:
        hpt_bus_reset(device);
        return 0;
    case USBDEVFS_GET_CAPABILITIES:
        *(uint32_t *)argument = capabilities(device);
        return 0;
    case USBDEVFS_GET_SPEED:
        return (int)hp_gadget_speed(device->gadget);
    case USBDEVFS_CONNECTINFO:
        *(struct usbdevfs_connectinfo *)argument = (struct usbdevfs_connectinfo){.devnum = device->address};
        return 0;
    case USBDEVFS_GETDRIVER:
        return get_driver(device, argument);
    default:
        return -ENOTTY;
    }
}

int hpt_file_ioctl(hpt_file *file, unsigned long request, void *argument) {
    if (request == USBDEVFS_REAPURBNDELAY) return reap(file, argument);
    if (file->dead) return -ENODEV;
    int error = answer(file, request, argument);
    hpt_settle(file->device);
    return error;
}
