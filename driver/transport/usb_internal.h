/* What the files of the USB transport share. */
#ifndef HITPIPE_TRANSPORT_USB_INTERNAL_H
#define HITPIPE_TRANSPORT_USB_INTERNAL_H

#include "usb.h"
#include <hitpipe/usb.h>
#include <libusb.h>

/* libusb, for as long as something of it is in use: a context of our own, or the user's. */
typedef struct hp_usb_bus {
    libusb_context *context;
    bool own;
} hp_usb_bus;

hp_status hp_usb_bus_open(const hp_device_def *def, hp_usb_bus *bus, hp_message *message);
void hp_usb_bus_close(hp_usb_bus *bus);

/* The data interface of a device, from its active configuration. */
typedef struct hp_usb_interface {
    uint8_t number, out, in; /* endpoint addresses */
    unsigned packet;         /* wMaxPacketSize of both */
} hp_usb_interface;

/* False: it has none, so it is no board. */
bool hp_usb_data_interface(libusb_device *device, hp_usb_interface *interface);

/* Opens the board with this serial number; NULL: the only board there is. HP_ERROR_NO_DEVICE in words: none, none of
 * that serial, several, no permission. */
hp_status hp_usb_open(const hp_usb_bus *bus, const hp_device_def *def, const char *serial,
                      libusb_device_handle **handle, hp_message *message);

/* A string of an open device, printable; "" when it has none or does not say. */
void hp_usb_text(libusb_device_handle *handle, uint8_t index, char text[HP_USB_TEXT]);

hp_status hp_usb_outcome(enum libusb_transfer_status outcome);

#endif
