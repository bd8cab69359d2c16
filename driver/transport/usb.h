/* The board over USB: which boards there are, and packets over libusb-1.0's asynchronous interface.
 *
 *     hp_queue                       hp_transfer                      libusb_transfer
 *     --------> submit, poll ------> [ waiting ... ] -> [ in flight, usb_depth of them ] --> kernel, bus, board
 *     <-------- done ---------------- [ ended ... ]  <- callback, perhaps on a thread of the user's
 *
 * What the bytes are, identifiers and endpoints: hitpipe/usb.def. Not part of the public interface. */
#ifndef HITPIPE_TRANSPORT_USB_H
#define HITPIPE_TRANSPORT_USB_H

#include "driver/message.h"
#include "transport.h"
#include <hitpipe/hitpipe.h>

struct libusb_device_handle;

/* ---- which boards there are ---- */

enum { HP_USB_TEXT = 64 };

/* A board on the bus, whether it can be opened or not. */
typedef struct hp_usb_board {
    char serial[HP_USB_TEXT]; /* printable ASCII; "" when the board could not be asked, see `error` */
    char product[HP_USB_TEXT];
    unsigned vendor, product_id, release; /* idVendor, idProduct, bcdDevice */
    unsigned bus, address;
    unsigned mbits; /* of the link: 480 high speed, 5000 SuperSpeed; 0: unknown */
    int error;      /* libusb's, of opening it; 0: it can be opened. hp_usb_words says it in words */
} hp_usb_board;

/* The boards with the identifiers of def that have a data interface, in the order of bus and address; *boards is the
 * caller's to free. HP_ERROR_MEMORY, HP_ERROR_IO: USB cannot be used here. */
hp_status hp_usb_list(const hp_device_def *def, hp_usb_board **boards, size_t *count, hp_message *message);

/* ---- the transport ---- */

/* Opens the board with this serial number, or the only one (NULL). HP_ERROR_USAGE (usb_ fields out of their range),
 * HP_ERROR_NO_DEVICE (none, several, no permission, interface busy: in words), HP_ERROR_MEMORY, HP_ERROR_IO. */
hp_status hp_transport_usb(const hp_device_def *def, const char *serial, hp_transport **transport,
                           hp_message *message);

/* The same over a handle that is open already; it becomes the transport's, also on error. */
hp_status hp_transport_usb_wrap(const hp_device_def *def, struct libusb_context *context,
                                struct libusb_device_handle *handle, hp_transport **transport, hp_message *message);

/* Of the board behind a USB transport, "" when it has none; NULL for a transport of another kind. Lives as long as
 * the transport. */
const char *hp_transport_usb_serial(const hp_transport *transport);

/* What an error of libusb is to hitpipe, and in words that go on from "cannot open the board: ". */
hp_status hp_usb_status(int error);
const char *hp_usb_words(int error);
/* What can be done about it, to go on behind those words: "; put the udev rule ..."; "" where there is nothing to
 * say. */
const char *hp_usb_advice(int error);

#endif
