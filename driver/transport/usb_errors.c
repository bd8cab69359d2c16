/* libusb's outcomes, from the table. */
#include "usb_internal.h"

hp_status hp_usb_status(int error) {
    switch (error) {
    case LIBUSB_SUCCESS:
        return HP_OK;
#define HP_USB_ERROR(NAME, STATUS, words)                                                                            \
    case LIBUSB_ERROR_##NAME:                                                                                        \
        return HP_##STATUS;
#include "usb_errors.def"
    }
    return HP_ERROR_IO;
}

const char *hp_usb_words(int error) {
    switch (error) {
    case LIBUSB_SUCCESS:
        return "done";
#define HP_USB_ERROR(NAME, STATUS, words)                                                                            \
    case LIBUSB_ERROR_##NAME:                                                                                        \
        return words;
#include "usb_errors.def"
    }
    return "for a reason that libusb has no name for";
}

const char *hp_usb_advice(int error) {
    if (error != LIBUSB_ERROR_ACCESS) return "";
    return "; put the udev rule 60-hitpipe.rules (make install does) into /usr/lib/udev/rules.d or "
           "/etc/udev/rules.d, then plug the board in again";
}

hp_status hp_usb_outcome(enum libusb_transfer_status outcome) {
    switch (outcome) {
#define HP_USB_OUTCOME(NAME, STATUS, words)                                                                          \
    case LIBUSB_TRANSFER_##NAME:                                                                                     \
        return HP_##STATUS;
#include "usb_errors.def"
    }
    return HP_ERROR_IO;
}
