/* A machine with a USB bus, as umockdev makes one for programs under its wrapper: sysfs, udev's events, device nodes.
 * Behind the nodes are the devices of testbench/usb/usbfs.h, each a gadget at the end of a cable.
 *
 *     program -- libusb, hidapi (the real ones, unmodified) -- libumockdev-preload
 *        |                          |  sysfs, uevents, nodes: FIFOs whose readiness poll(2) sees
 *        |                          |  ioctl, read: over a socket to this process
 *        v                          v
 *     this process: usbfs.c -- cable.c -- gadget -- board     a thread of umockdev's does what the kernel does
 *                   usbhid.c (hidraw) --/
 *
 * Devices come and go by hpt_plug, hpt_pull, hpt_push and hpt_discard. A device's HID is bound to usbhid, which makes
 * a hidraw node of it, until a program detaches it (libusb can) or opens it not at all.
 *
 * One at a time in a process, which must itself run under the wrapper: hpt_mock_under_wrapper. All functions are
 * thread safe. */
#ifndef TESTBENCH_UMOCKDEV_MOCKUSB_H
#define TESTBENCH_UMOCKDEV_MOCKUSB_H

#include "testbench/usb/usbfs.h"

/* Runs the program again under umockdev's wrapper, with the sanitizers' consent, unless it is. */
void hpt_mock_under_wrapper(char **argv);

/* Makes the machine, with an empty bus. Programs that are started later see it, and so does this process. */
void hpt_mock_begin(void);

/* Waits until all programs have closed their nodes, and forgets the machine. Discard all devices before. */
void hpt_mock_end(void);

/* Waits until nobody has a node open, at most 5 seconds. */
bool hpt_mock_quiet(void);

/* Nodes of a device that is plugged in: "/dev/bus/usb/001/002", "/dev/hidraw0". In `path`, which is returned. */
enum { HPT_MOCK_PATH = 64 };
const char *hpt_mock_usb_node(hpt_device *device, char path[HPT_MOCK_PATH]);
const char *hpt_mock_hid_node(hpt_device *device, char path[HPT_MOCK_PATH]);

/* Access rights of both nodes, as chmod(2) has them; when plugged in they are 0666. */
void hpt_mock_chmod(hpt_device *device, unsigned mode);

/* Looks at a feature report on its way from the HID to whoever asks, by hidraw or libusb; n bytes, the ID first. May
 * change it, or shorten it by returning fewer. Runs on a thread of umockdev's. NULL: none. */
typedef size_t hpt_mock_twist(void *context, uint8_t *bytes, size_t n);
void hpt_mock_twist_reports(hpt_device *device, hpt_mock_twist *twist, void *context);

/* Requests to the HID are not answered any more: by hidraw they end with ETIMEDOUT, at once, as they would with the
 * kernel after 5 seconds. */
void hpt_mock_mute(hpt_device *device, bool mute);

/* Another report descriptor in sysfs, for who only reads there. Until the HID is bound anew. */
void hpt_mock_describe_hid(hpt_device *device, const uint8_t *descriptor, size_t n);

/* How many programs fetch input reports: they have the hidraw node open and have asked for a report, or by libusb the
 * interface and an urb. (hidapi 0.13 leaks when the board goes while it opens the node.) */
unsigned hpt_mock_listeners(hpt_device *device);

/* Claims an interface, as another program would, from usbhid if need be, and gives it back. */
typedef struct hpt_claim hpt_claim;
hpt_claim *hpt_mock_claim(hpt_device *device, unsigned interface);
void hpt_mock_release(hpt_claim *claim);

#endif
