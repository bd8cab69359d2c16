/* Waiting for libusb: in the driver, in a loop of the user's, or for a thread of the user's that handles the events.
 */
#include "usb_internal.h"
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

uint64_t hp_usb_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

/* ---- what the user's loop waits for ---- */

static void file_added(int fd, short events, void *user) {
    (void)fd, (void)events;
    ((hp_usb *)user)->files_stale = true;
}

static void file_removed(int fd, void *user) {
    (void)fd;
    ((hp_usb *)user)->files_stale = true;
}

void hp_usb_events_open(hp_usb *usb) {
    usb->files_stale = true;
    if (usb->bus.own && usb->wait) libusb_set_pollfd_notifiers(usb->bus.context, file_added, file_removed, usb);
}

void hp_usb_events_close(hp_usb *usb) {
    if (usb->bus.own && usb->wait) libusb_set_pollfd_notifiers(usb->bus.context, NULL, NULL, NULL);
    free(usb->files);
}

/* The files are asked for again only when they changed; those of a user's context may change unseen. */
static hp_status list_files(hp_usb *usb) {
    if (!usb->files_stale && usb->bus.own) return HP_OK;
    const struct libusb_pollfd **list = libusb_get_pollfds(usb->bus.context);
    size_t count = 0;
    while (list && list[count]) count++;
    hp_wait_file *files = list ? realloc(usb->files, (count + 1) * sizeof *files) : NULL;
    for (size_t i = 0; i < count && files; i++) files[i] = (hp_wait_file){list[i]->fd, list[i]->events};
    libusb_free_pollfds(list);
    if (!files) return HP_ERROR_MEMORY;
    usb->files = files;
    usb->file_count = count;
    usb->files_stale = false;
    return HP_OK;
}

static unsigned next_timeout(const hp_usb *usb, unsigned timeout_ms) {
    struct timeval next;
    if (libusb_pollfds_handle_timeouts(usb->bus.context)) return timeout_ms;
    if (libusb_get_next_timeout(usb->bus.context, &next) != 1) return timeout_ms;
    uint64_t ms = (uint64_t)next.tv_sec * 1000 + (uint64_t)next.tv_usec / 1000;
    return ms < timeout_ms ? (unsigned)ms : timeout_ms;
}

/* ---- waiting ---- */

static hp_status handle_events(hp_usb *usb, unsigned timeout_ms) {
    struct timeval most = {.tv_sec = timeout_ms / 1000, .tv_usec = timeout_ms % 1000 * 1000};
    int error = libusb_handle_events_timeout_completed(usb->bus.context, &most, &usb->arrived);
    return error == 0 || error == LIBUSB_ERROR_INTERRUPTED ? HP_OK : HP_ERROR_IO;
}

hp_status hp_usb_wait(hp_usb *usb, unsigned timeout_ms) {
    if (!usb->wait || timeout_ms == 0) return handle_events(usb, timeout_ms);
    hp_status status = list_files(usb);
    if (status) return status;
    usb->wait(usb->wait_context, usb->files, usb->file_count, next_timeout(usb, timeout_ms));
    return handle_events(usb, 0);
}
