/* A carrier of reports for driver/hid/ that goes straight to a gadget: no hidapi, no cable. Reports can be changed or
 * failed on their way to the host. A call that the gadget leaves open fails by cmocka. */
#ifndef TESTBENCH_SUPPORT_GADGET_HID_H
#define TESTBENCH_SUPPORT_GADGET_HID_H

#include "driver/gadget/gadget.h"
#include "driver/hid/hid.h"

/* Looks at a report of *n bytes, the ID first, on its way to the host; may change both, n up to HP_HID_ROOM. Anything
 * but HP_OK is what the host gets in its place. */
typedef hp_status hpt_twist(void *context, uint8_t *bytes, size_t *n);

typedef struct hpt_gadget_hid {
    hp_hid head;
    hp_gadget *gadget; /* configured; stays the test's */
    hpt_twist *twist;  /* NULL: none */
    void *context;
    unsigned closed; /* how often the carrier was closed */
} hpt_gadget_hid;

/* A plugged-in and configured device with this serial number; event 0, its reset, is fetched. */
hp_gadget *hpt_gadget_configured(const char *serial);

hpt_gadget_hid hpt_gadget_hid_of(hp_gadget *gadget);

/* One transfer on a bulk endpoint: sends n bytes and the short packet that ends them; or takes what comes, SIZE_MAX
 * for nothing. */
void hpt_gadget_send(hp_gadget *gadget, const uint8_t *bytes, size_t n);
size_t hpt_gadget_receive(hp_gadget *gadget, uint8_t *bytes, size_t room);

#endif
