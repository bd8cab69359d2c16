/* A USB bus in this process, as libusb on Linux sees one: devices in /dev/bus/usb and /sys, announced by udev, and
 * files that answer the ioctls of usbfs. Behind each is a gadget at the end of a cable (cable.h).
 *
 *     driver -- libusb (the real one) -- open, ioctl, read, mmap, udev_... -- this -- cable -- gadget -- board
 *
 * A program that links this has its own open, access, close, read, lseek, ioctl and mmap, and the functions of
 * libudev that libusb calls; what is not of this bus goes on to the kernel. The file that libusb gets is the writing
 * end of a pipe: it is writable when an urb can be reaped, and in error when the device is gone, so poll, epoll and
 * select are the kernel's. The board works inside of the calls that give it something to do, on their thread. All
 * functions are thread safe. */
#ifndef TESTBENCH_USB_USBFS_H
#define TESTBENCH_USB_USBFS_H

#include "cable.h"

typedef struct hpt_device hpt_device;

typedef struct hpt_device_def {
    hp_gadget_def gadget;
    hpt_choose *choose; /* NULL: the cable is straight */
    void *context;      /* of choose */
    bool denied;        /* open for writing: EACCES */
    bool keeps;         /* what was on its way to the host survives SET_INTERFACE, as in a careless board */
    bool maps;          /* mmap gives memory, as newer kernels do */
    unsigned memory;    /* bytes that urbs may take at a time, as usbcore.usbfs_memory_mb has it; 0: any */
    unsigned delay_us;  /* urbs to the host end so much later */
    unsigned rate;      /* bulk bytes a millisecond, both directions together; 0: as fast as memory */
    unsigned caps;      /* USBDEVFS_CAP_...; 0: what kernels with a modern host controller have */
} hpt_device_def;

/* Plugs a new device into a socket of its own: on bus 1, configured, announced. */
hpt_device *hpt_plug(const hpt_device_def *def);

/* Pulls it out; puts it in again, with another address. */
void hpt_pull(hpt_device *device);
void hpt_push(hpt_device *device);

/* Pulls it out as it happens: for `ms` milliseconds every bulk and control urb fails with EPROTO at once, then the
 * kernel notices. */
void hpt_pull_slowly(hpt_device *device, unsigned ms);

/* Pulls it out for good. Open files stay good for nothing until they are closed. */
void hpt_discard(hpt_device *device);

void hpt_deny(hpt_device *device, bool denied);
void hpt_delay(hpt_device *device, unsigned delay_us);

/* A file as open("/dev/bus/usb/...") gives it. */
int hpt_open(hpt_device *device);

/* A control request of the kernel's or of a HID driver's. Bytes moved, or a negative errno. */
int hpt_control(hpt_device *device, const uint8_t setup[8], uint8_t *bytes, size_t length);

typedef struct hpt_bus_counts {
    unsigned urbs, in_flight, in_flight_most; /* bulk urbs submitted; now pending; most of them at a time */
    unsigned packets[2];                      /* of a faulty cable; [1]: to the host */
    unsigned halts_cleared, files;            /* files now open */
    unsigned mapped;                          /* bulk urbs whose bytes lay in memory that mmap gave */
    size_t memory_most;                       /* bytes of bulk urbs pending at a time */
} hpt_bus_counts;
hpt_bus_counts hpt_counts(hpt_device *device);

double hpt_now_ms(void); /* monotonic */

/* Whether this thread is inside of a call that is for the bus: what it does there is the board's doing. */
bool hpt_inside(void);

#endif
