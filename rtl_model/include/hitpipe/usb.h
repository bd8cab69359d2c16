/* Names for the rows of usb.def. HP_USB_VENDOR is 0x1209, HP_USB_REPORT_IDENTITY the report's ID,
 * HP_USB_BYTES_IDENTITY its length behind the ID, HP_USB_AT_IDENTITY_serial a field's offset behind the ID,
 * HP_USB_CONTROL_RESET and HP_USB_EVENT_PACKET_DONE codes. */
#ifndef HITPIPE_USB_H
#define HITPIPE_USB_H

enum {
#define HP_USB_NUMBER(NAME, value, meaning) HP_USB_##NAME = value,
#define HP_USB_REPORT(NAME, id, KIND, bytes, meaning) HP_USB_REPORT_##NAME = id, HP_USB_BYTES_##NAME = bytes,
#define HP_USB_FIELD(REPORT, name, offset, bits, meaning) HP_USB_AT_##REPORT##_##name = offset,
#define HP_USB_CONTROL(NAME, code, since, meaning) HP_USB_CONTROL_##NAME = code,
#define HP_USB_EVENT(NAME, code, meaning) HP_USB_EVENT_##NAME = code,
#include <hitpipe/usb.def>
};

#endif
