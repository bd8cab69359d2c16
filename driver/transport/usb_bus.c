/* The libusb context: our own unless the user brings one, and where libusb's log goes. */
#include "usb_internal.h"
#include <stdlib.h>

static void drop(libusb_context *context, enum libusb_log_level level, const char *text) {
    (void)context, (void)level, (void)text;
}

/* libusb writes its log to standard error unless a handler of the whole process is there, even when the context has
 * one. So one that drops everything is put in, if there is to be a log at all; messages still reach the context's. */
static void keep_quiet(const hp_device_def *def) {
    if (def->usb_log || getenv("LIBUSB_DEBUG")) libusb_set_log_cb(NULL, drop, LIBUSB_LOG_CB_GLOBAL);
}

hp_status hp_usb_bus_open(const hp_device_def *def, hp_usb_bus *bus, hp_message *message) {
    *bus = (hp_usb_bus){.context = def->usb_context, .own = !def->usb_context};
    if (!bus->own) return HP_OK;
    keep_quiet(def);
    int error = libusb_init(&bus->context);
    if (error) return hp_say(message, hp_usb_status(error), "USB cannot be used here: %s", hp_usb_words(error));
    if (!def->usb_log) return HP_OK;
    libusb_set_option(bus->context, LIBUSB_OPTION_LOG_LEVEL,
                      LIBUSB_LOG_LEVEL_WARNING); /* LIBUSB_DEBUG asks for more */
    libusb_set_log_cb(bus->context, def->usb_log, LIBUSB_LOG_CB_CONTEXT);
    return HP_OK;
}

void hp_usb_bus_close(hp_usb_bus *bus) {
    if (bus->own) libusb_exit(bus->context);
}
