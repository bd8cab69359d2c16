/* The kernel's HID driver: takes the board's HID, makes a hidraw node of it, carries feature reports over the control
 * endpoint, and fetches input reports while somebody has the node open. */
#include "mock.h"
#include <errno.h>
#include <linux/hidraw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SLOTS = 64, /* input reports that hidraw keeps for a reader */
    FROM_INTERFACE = 0x81,
    FROM_HID = 0xA1,
    TO_HID = 0x21,
    GET_DESCRIPTOR = 6,
    GET_REPORT = 1,
    SET_REPORT = 9,
    REPORT_DESCRIPTOR = 0x22,
    FEATURE = 3,
    NUMBER_GRDESCSIZE = 1, /* of the ioctls of type 'H' */
    NUMBER_GRDESC = 2,
    NUMBER_SFEATURE = 6,
    NUMBER_GFEATURE = 7
};

static int request(hpt_device *device, unsigned type, unsigned code, unsigned value, uint8_t *bytes, size_t n) {
    const uint8_t setup[8] = {(uint8_t)type,         (uint8_t)code,        (uint8_t)value,
                              (uint8_t)(value >> 8), HP_USB_HID_INTERFACE, 0,
                              (uint8_t)(n & 0xFF),   (uint8_t)(n >> 8)};
    int moved = hpt_cable_control(device->cable, setup, bytes, n);
    hpt_settle(device);
    return moved;
}

/* ---- input reports ---- */

static void fetched(hpt_urb *urb) {
    hpt_mock_device *mock = urb->owner;
    mock->polling = false;
    if (urb->error) return; /* hpt_usbhid_poll begins again, when there is something to begin with */
    if (mock->hid) hpt_node_report(mock->hid, mock->report, urb->urb.moved);
    hpt_usbhid_poll(mock);
}

void hpt_usbhid_poll(hpt_mock_device *mock) {
    bool wanted = mock->bound && mock->hid && mock->hid->clients && mock->device->present;
    if (wanted == mock->polling) return;
    if (!wanted) {
        hpt_cable_unlink(mock->device->cable, &mock->interrupt);
        return;
    }
    mock->polling = true;
    mock->interrupt = (hpt_urb){
        .urb = {.endpoint = HP_USB_EVENT_ENDPOINT, .bytes = mock->report, .length = sizeof mock->report},
        .done = fetched,
        .owner = mock,
    };
    hpt_cable_submit(mock->device->cable, &mock->interrupt);
}

/* ---- hidraw ---- */

static void opened(hpt_client *client) {
    hpt_mock_device *mock = hpt_mock_device_of(client->node->device);
    if (client->node->gone) return;
    if (!client->next) hpt_node_drain(client->node); /* it is the first */
    hpt_usbhid_poll(mock);
    hpt_settle(mock->device);
}

static void closed(hpt_client *client) {
    if (!client->node->gone) hpt_usbhid_poll(hpt_mock_device_of(client->node->device));
}

static int get_descriptor(hpt_device *device, bool size_alone, void *argument) {
    struct hidraw_report_descriptor *descriptor = argument;
    uint8_t bytes[HID_MAX_DESCRIPTOR_SIZE];
    int n = request(device, FROM_INTERFACE, GET_DESCRIPTOR, REPORT_DESCRIPTOR << 8, bytes, sizeof bytes);
    if (n < 0) return n;
    if (size_alone) {
        memcpy(argument, &n, sizeof n);
        return 0;
    }
    if (descriptor->size < (unsigned)n) n = (int)descriptor->size;
    memcpy(descriptor->value, bytes, (size_t)n);
    return 0;
}

static int feature(hpt_mock_device *mock, bool set, uint8_t *bytes, size_t n) {
    if (mock->mute) return -ETIMEDOUT;
    int moved = request(mock->device, set ? TO_HID : FROM_HID, set ? SET_REPORT : GET_REPORT,
                        (unsigned)FEATURE << 8 | bytes[0], bytes, n);
    return moved > 0 && !set && mock->twist ? (int)mock->twist(mock->context, bytes, (size_t)moved) : moved;
}

static int choose(hpt_mock_device *mock, unsigned number, void *argument, size_t bytes) {
    switch (number) {
    case NUMBER_GRDESCSIZE:
    case NUMBER_GRDESC:
        return get_descriptor(mock->device, number == NUMBER_GRDESCSIZE, argument);
    case NUMBER_SFEATURE:
    case NUMBER_GFEATURE:
        return feature(mock, number == NUMBER_SFEATURE, argument, bytes);
    default:
        return -ENOTTY;
    }
}

static int answer(hpt_client *client, unsigned long code, UMockdevIoctlData *argument) {
    size_t bytes = _IOC_SIZE(code);
    if (client->node->gone) return -ENODEV;
    if (_IOC_TYPE(code) != 'H' || bytes == 0) return -ENOTTY;
    UMockdevIoctlData *data = umockdev_ioctl_data_resolve(argument, 0, bytes, NULL);
    if (!data) return -EFAULT;
    int result = choose(hpt_mock_device_of(client->node->device), _IOC_NR(code), data->data, bytes);
    client->has_asked |= _IOC_NR(code) == NUMBER_GFEATURE;
    g_object_unref(data);
    return result;
}

const hpt_node_kind hpt_hidraw_node = {.opened = opened, .closed = closed, .answer = answer, .slots = SLOTS};

/* ---- binding ---- */

/* The attribute dev ends without a newline, or umockdev does not take its link away. */
static void describe(const hpt_mock_device *mock, const char *serial, const uint8_t *descriptor, size_t n) {
    char text[2 * HID_MAX_DESCRIPTOR_SIZE + 1024], hex[2 * HID_MAX_DESCRIPTOR_SIZE + 1] = "";
    for (size_t i = 0; i < n; i++) sprintf(hex + 2 * i, "%02X", descriptor[i]);
    const hp_gadget_def *def = &mock->device->def.gadget;
    unsigned vendor = def->vendor ? def->vendor : HP_USB_VENDOR;
    unsigned product = def->product ? def->product : HP_USB_PRODUCT;
    snprintf(text, sizeof text,
             "P: %s\nE: SUBSYSTEM=hid\nE: DRIVER=hid-generic\nE: HID_ID=0003:%08X:%08X\nE: HID_NAME=hitpipe board\n"
             "E: HID_PHYS=usb-mock-%u/input1\nE: HID_UNIQ=%s\nH: report_descriptor=%s\n\n"
             "P: %s\nE: SUBSYSTEM=hidraw\nE: DEVNAME=%s\nE: MAJOR=240\nE: MINOR=%u\nA: dev=240:%u\n"
             "L: device=../../../%s\n\n",
             mock->hid_path, vendor, product, mock->device->port, serial, hex, mock->hidraw_path, mock->hid->path,
             mock->device->port, mock->device->port, strrchr(mock->hid_path, '/') + 1);
    if (!umockdev_testbed_add_from_string(hpt_mock_testbed(), text, NULL)) abort();
}

void hpt_usbhid_bind(hpt_mock_device *mock) {
    hpt_device *device = mock->device;
    uint8_t descriptor[HID_MAX_DESCRIPTOR_SIZE];
    char node[HPT_MOCK_PATH];
    int n = request(device, FROM_INTERFACE, GET_DESCRIPTOR, REPORT_DESCRIPTOR << 8, descriptor, sizeof descriptor);
    if (n < 0) abort();
    mock->usbhid = (hpt_file){.device = device};
    device->claims[HP_USB_HID_INTERFACE] = &mock->usbhid;
    mock->bound = true;
    snprintf(node, sizeof node, "/dev/hidraw%u", device->port);
    mock->hid = hpt_node_new(node, &hpt_hidraw_node, device, mock->mode);
    describe(mock, hp_gadget_serial(device->gadget), descriptor, (size_t)n);
}

void hpt_usbhid_unbind(hpt_mock_device *mock) {
    if (!mock->bound) return;
    mock->bound = false;
    hpt_usbhid_poll(mock);
    if (mock->device->claims[HP_USB_HID_INTERFACE] == &mock->usbhid)
        mock->device->claims[HP_USB_HID_INTERFACE] = NULL;
    hpt_node_remove(mock->hid);
    mock->hid = NULL;
    hpt_mock_remove(mock->hidraw_path);
    hpt_mock_remove(mock->hid_path);
}
