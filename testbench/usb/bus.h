/* What the files of the bus share: usbfs.c (open files and their ioctls), sockets.c (devices, plugged in and out),
 * udev.c (libudev and /sys), system_calls.c (what the program's own open, ioctl ... do). */
#ifndef TESTBENCH_USB_BUS_H
#define TESTBENCH_USB_BUS_H

#include "usbfs.h"
#include <linux/usbdevice_fs.h>
#include <pthread.h>
#include <sys/ioctl.h>

enum { HPT_BUS = 1, HPT_DEVICES_MOST = 16, HPT_FILES_MOST = 1024, HPT_INTERFACES = 2 };

typedef struct hpt_file hpt_file;
typedef struct hpt_pending hpt_pending;

/* An urb of a file, until it is reaped. */
struct hpt_pending {
    hpt_urb urb;
    hpt_file *file;
    struct usbdevfs_urb *user;
    uint64_t due_us; /* delayed until then */
    size_t bytes;    /* of the kernel's memory */
    hpt_pending *next;
};

typedef struct hpt_pendings {
    hpt_pending *first, *last;
} hpt_pendings;

struct hpt_file {
    int fd, reader; /* ends of the pipe */
    bool ready;     /* the pipe has room: there is something to reap */
    hpt_device *device;
    bool dead; /* its device is gone */
    size_t offset;
    hpt_pendings under_way, ended;
    uint8_t *map; /* memory that mmap gave */
    size_t map_bytes;
    hpt_file *next;
};

struct hpt_device {
    hpt_device_def def;
    hp_gadget *gadget;
    hpt_cable *cable;
    unsigned port, address;
    char name[8]; /* in /sys: "1-3" */
    bool present, pull_due, discarded;
    hpt_file *files;
    const hpt_file *claims[HPT_INTERFACES];
    hpt_bus_counts counts;
    size_t memory;   /* of urbs under way */
    unsigned flying; /* bulk urbs */
    /* What happens later, on a thread of its own. */
    pthread_t clock;
    bool ticking;
    pthread_cond_t changed;
    hpt_pendings later;      /* ended urbs, delayed; the earliest first */
    double busy_us;          /* the wire is, until then */
    bool failing;            /* every urb but the one that waits for events ends with EPROTO */
    uint64_t pull_due_us;    /* 0: never */
    uint64_t push_due_us;    /* 0: never */
    uint64_t release_due_us; /* of what the cable holds; 0: it holds nothing */
};

/* Everything of the bus is under one lock, which the functions below expect to be held. */
extern pthread_mutex_t hpt_lock;
uint64_t hpt_now_us(void);

/* ---- sockets.c ---- */

hpt_device *hpt_device_at(unsigned bus, unsigned address); /* present ones */
hpt_device *hpt_device_named(const char *name);
hpt_device *hpt_device_next(const hpt_device *before); /* NULL: the first */

/* Lets the board do what it can, and the device be pulled if that is what came of it. */
void hpt_settle(hpt_device *device);

/* The bus resets the device and configures it again. */
void hpt_bus_reset(hpt_device *device);

/* Makes the device's clock look again. */
void hpt_clock_changed(hpt_device *device);

/* ---- usbfs.c ---- */

hpt_file *hpt_file_at(int fd); /* NULL: not one of ours */
int hpt_file_open(hpt_device *device);
void hpt_file_close(hpt_file *file);
void hpt_file_kill(hpt_file *file);                                        /* its device is gone */
int hpt_file_ioctl(hpt_file *file, unsigned long request, void *argument); /* 0, or a negative errno */
long hpt_file_read(hpt_file *file, void *bytes, size_t n);
void *hpt_file_map(hpt_file *file, size_t bytes); /* NULL: not given */
void hpt_file_fail(hpt_file *file);               /* its device is failing */
void hpt_pending_deliver(hpt_pending *pending);   /* its time has come */

/* ---- udev.c ---- */

/* Announces a device. Action: "add" or "remove". */
void hpt_udev_tell(const hpt_device *device, const char *action);
/* A file of /sys of a device, or a negative errno. */
int hpt_sysfs_open(const hpt_device *device, const char *attribute);

/* ---- system calls as the kernel has them ---- */

int hpt_kernel_open(const char *path, int flags, unsigned mode);
int hpt_kernel_close(int fd);
long hpt_kernel_read(int fd, void *bytes, size_t n);
long hpt_kernel_write(int fd, const void *bytes, size_t n);

#endif
