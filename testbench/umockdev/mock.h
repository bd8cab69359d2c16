/* What the files of the mock share. Everything is under hpt_lock, which the functions expect to be held, unless they
 * say otherwise. */
#ifndef TESTBENCH_UMOCKDEV_MOCK_H
#define TESTBENCH_UMOCKDEV_MOCK_H

#include "mockusb.h"
#include "testbench/usb/bus.h"
#include <umockdev.h>

typedef struct hpt_node hpt_node;
typedef struct hpt_client hpt_client;
typedef struct hpt_lent hpt_lent;

/* ---- node.c: device nodes, and who has them open ---- */

/* What stands behind a kind of node. `answer` returns what the ioctl does, negative errno for an error. */
typedef struct hpt_node_kind {
    void (*opened)(hpt_client *client);
    void (*closed)(hpt_client *client);
    int (*answer)(hpt_client *client, unsigned long request, UMockdevIoctlData *argument);
    unsigned slots; /* reports that the FIFO holds; 0: it is full, or writable when there is something to reap */
} hpt_node_kind;

struct hpt_node {
    char path[HPT_MOCK_PATH]; /* in the machine: "/dev/hidraw0" */
    int fifo;
    bool full; /* of a node without slots */
    bool gone;
    const hpt_node_kind *kind;
    hpt_device *device;
    UMockdevIoctlBase *base;
    hpt_client *clients;
    hpt_node *next;
};

struct hpt_client {
    hpt_node *node;
    UMockdevIoctlClient *connection;
    hpt_file *file; /* of usbfs */
    hpt_lent *lent; /* urbs that are not reaped */
    bool told;      /* that the device is gone */
    bool has_asked; /* of hidraw: for a report */
    hpt_client *next;
};

hpt_node *hpt_node_new(const char *path, const hpt_node_kind *kind, hpt_device *device, unsigned mode);
/* The device is gone: nobody can open it any more, and who has it open is told. */
void hpt_node_remove(hpt_node *node);
/* For a node without slots: whether poll(2) shows something to reap. */
void hpt_node_show(hpt_node *node, bool ready);
/* For one with slots: a report for whoever reads; lost when nobody does. */
void hpt_node_report(hpt_node *node, const uint8_t *bytes, size_t n);
void hpt_node_drain(hpt_node *node);
/* Frees all nodes. Nobody may have one open. */
void hpt_nodes_free(void);
unsigned hpt_nodes_open(void);

/* ---- mockusb.c: the machine ---- */

/* What the mock knows of a device beside the bus. */
typedef struct hpt_mock_device {
    hpt_device *device; /* NULL: free */
    hpt_node *usb, *hid;
    char usb_path[128], hid_path[192], hidraw_path[224]; /* in sysfs */
    unsigned mode;                                       /* of its nodes */
    hpt_mock_twist *twist;
    void *context;
    bool mute;       /* requests to the HID are not answered */
    hpt_file usbhid; /* stands for the kernel's driver where an interface is claimed */
    bool bound;      /* usbhid has the HID */
    bool polling;    /* the interrupt urb is under way */
    hpt_urb interrupt;
    uint8_t report[HP_USB_REPORT_PACKET];
} hpt_mock_device;

hpt_mock_device *hpt_mock_device_of(const hpt_device *device);
UMockdevTestbed *hpt_mock_testbed(void);
const char *hpt_mock_root(void);
void hpt_mock_remove(const char *path); /* announces it, and takes it out of sysfs */

/* ---- usbfs_node.c ---- */

extern const hpt_node_kind hpt_usbfs_node;
/* Shows whether there is something to reap, to all who have the node open. */
void hpt_usbfs_show(hpt_node *node);

/* ---- usbhid.c ---- */

extern const hpt_node_kind hpt_hidraw_node;
/* usbhid takes the HID and makes a hidraw node, or lets go of it. */
void hpt_usbhid_bind(hpt_mock_device *mock);
void hpt_usbhid_unbind(hpt_mock_device *mock);
/* usbhid fetches input reports as long as somebody has the hidraw node open: begins, goes on or ends. */
void hpt_usbhid_poll(hpt_mock_device *mock);

#endif
