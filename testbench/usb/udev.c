/* The functions of libudev that libusb calls, over the sockets of the bus, and the files of /sys that it reads. */
#include "bus.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

enum { EVENTS_MOST = 64 };

struct udev {
    unsigned users;
};

struct udev_device {
    char action[8], name[8], node[32];
};

struct udev_list_entry {
    char name[8];
    struct udev_list_entry *next;
};

struct udev_enumerate {
    struct udev_list_entry *first;
};

/* There is one at a time, as libusb uses it. */
struct udev_monitor {
    int fd; /* counts the events that wait */
    struct udev_device events[EVENTS_MOST];
    unsigned head, count;
};

static struct udev_monitor *monitor;

static struct udev_device device_of(const hpt_device *device, const char *action) {
    struct udev_device made;
    memset(&made, 0, sizeof made);
    snprintf(made.action, sizeof made.action, "%s", action);
    snprintf(made.name, sizeof made.name, "%s", device->name);
    snprintf(made.node, sizeof made.node, "/dev/bus/usb/%03d/%03u", HPT_BUS, device->address);
    return made;
}

void hpt_udev_tell(const hpt_device *device, const char *action) {
    const uint64_t one = 1;
    if (!monitor || monitor->count == EVENTS_MOST) return;
    monitor->events[(monitor->head + monitor->count++) % EVENTS_MOST] = device_of(device, action);
    if (hpt_kernel_write(monitor->fd, &one, sizeof one) != sizeof one) abort();
}

/* ---- /sys ---- */

static int file_with(const void *bytes, size_t n) {
    int fd = memfd_create("attribute", MFD_CLOEXEC);
    if (fd < 0) return -errno;
    if (hpt_kernel_write(fd, bytes, n) != (long)n || lseek(fd, 0, SEEK_SET)) abort();
    return fd;
}

static int descriptors(const hpt_device *device) {
    uint8_t bytes[512];
    size_t n, first = 18;
    const uint8_t *configuration = hp_gadget_configuration(device->gadget, &n);
    if (first + n > sizeof bytes) abort();
    memcpy(bytes, hp_gadget_device_descriptor(device->gadget), first);
    memcpy(bytes + first, configuration, n);
    return file_with(bytes, first + n);
}

int hpt_sysfs_open(const hpt_device *device, const char *attribute) {
    const struct {
        const char *name;
        unsigned value;
    } numbers[] = {
        {"busnum", HPT_BUS},
        {"devnum", device->address},
        {"speed", hp_gadget_speed(device->gadget) == HP_USB_SUPER ? 5000 : 480},
        {"bConfigurationValue", 1},
    };
    char text[16];
    if (strcmp(attribute, "descriptors") == 0) return descriptors(device);
    for (unsigned i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (strcmp(attribute, numbers[i].name) == 0)
            return file_with(text, (size_t)snprintf(text, sizeof text, "%u\n", numbers[i].value));
    return -ENOENT;
}

/* ---- libudev ---- */

struct udev *udev_new(void);
struct udev *udev_new(void) {
    return calloc(1, sizeof(struct udev));
}

struct udev *udev_unref(struct udev *udev);
struct udev *udev_unref(struct udev *udev) {
    free(udev);
    return NULL;
}

struct udev_monitor *udev_monitor_new_from_netlink(struct udev *udev, const char *name);
struct udev_monitor *udev_monitor_new_from_netlink(struct udev *udev, const char *name) {
    (void)udev, (void)name;
    struct udev_monitor *made = calloc(1, sizeof *made);
    if (!made) abort();
    made->fd = eventfd(0, EFD_SEMAPHORE | EFD_NONBLOCK | EFD_CLOEXEC);
    pthread_mutex_lock(&hpt_lock);
    if (monitor) abort();
    monitor = made;
    pthread_mutex_unlock(&hpt_lock);
    return made;
}

struct udev_monitor *udev_monitor_unref(struct udev_monitor *old);
struct udev_monitor *udev_monitor_unref(struct udev_monitor *old) {
    pthread_mutex_lock(&hpt_lock);
    monitor = NULL;
    pthread_mutex_unlock(&hpt_lock);
    close(old->fd);
    free(old);
    return NULL;
}

int udev_monitor_filter_add_match_subsystem_devtype(struct udev_monitor *now, const char *system, const char *type);
int udev_monitor_filter_add_match_subsystem_devtype(struct udev_monitor *now, const char *system, const char *type) {
    (void)now, (void)system, (void)type;
    return 0;
}

int udev_monitor_enable_receiving(struct udev_monitor *now);
int udev_monitor_enable_receiving(struct udev_monitor *now) {
    (void)now;
    return 0;
}

int udev_monitor_get_fd(struct udev_monitor *now);
int udev_monitor_get_fd(struct udev_monitor *now) {
    return now->fd;
}

static struct udev_device *copy_of(const struct udev_device *from) {
    struct udev_device *made = malloc(sizeof *made);
    if (!made) abort();
    *made = *from;
    return made;
}

struct udev_device *udev_monitor_receive_device(struct udev_monitor *now);
struct udev_device *udev_monitor_receive_device(struct udev_monitor *now) {
    uint64_t one;
    if (hpt_kernel_read(now->fd, &one, sizeof one) != sizeof one) return NULL;
    pthread_mutex_lock(&hpt_lock);
    struct udev_device *device = copy_of(&now->events[now->head]);
    now->head = (now->head + 1) % EVENTS_MOST;
    now->count--;
    pthread_mutex_unlock(&hpt_lock);
    return device;
}

struct udev_enumerate *udev_enumerate_new(struct udev *udev);
struct udev_enumerate *udev_enumerate_new(struct udev *udev) {
    (void)udev;
    return calloc(1, sizeof(struct udev_enumerate));
}

int udev_enumerate_add_match_subsystem(struct udev_enumerate *list, const char *system);
int udev_enumerate_add_match_subsystem(struct udev_enumerate *list, const char *system) {
    (void)list, (void)system;
    return 0;
}

int udev_enumerate_add_match_property(struct udev_enumerate *list, const char *name, const char *value);
int udev_enumerate_add_match_property(struct udev_enumerate *list, const char *name, const char *value) {
    (void)list, (void)name, (void)value;
    return 0;
}

int udev_enumerate_scan_devices(struct udev_enumerate *list);
int udev_enumerate_scan_devices(struct udev_enumerate *list) {
    pthread_mutex_lock(&hpt_lock);
    for (hpt_device *at = hpt_device_next(NULL); at; at = hpt_device_next(at)) {
        struct udev_list_entry *entry = calloc(1, sizeof *entry);
        if (!entry) abort();
        memcpy(entry->name, at->name, sizeof entry->name);
        entry->next = list->first;
        list->first = entry;
    }
    pthread_mutex_unlock(&hpt_lock);
    return 0;
}

struct udev_list_entry *udev_enumerate_get_list_entry(struct udev_enumerate *list);
struct udev_list_entry *udev_enumerate_get_list_entry(struct udev_enumerate *list) {
    return list->first;
}

struct udev_enumerate *udev_enumerate_unref(struct udev_enumerate *list);
struct udev_enumerate *udev_enumerate_unref(struct udev_enumerate *list) {
    while (list->first) {
        struct udev_list_entry *entry = list->first;
        list->first = entry->next;
        free(entry);
    }
    free(list);
    return NULL;
}

struct udev_list_entry *udev_list_entry_get_next(struct udev_list_entry *entry);
struct udev_list_entry *udev_list_entry_get_next(struct udev_list_entry *entry) {
    return entry->next;
}

const char *udev_list_entry_get_name(struct udev_list_entry *entry);
const char *udev_list_entry_get_name(struct udev_list_entry *entry) {
    return entry->name;
}

struct udev_device *udev_device_new_from_syspath(struct udev *udev, const char *path);
struct udev_device *udev_device_new_from_syspath(struct udev *udev, const char *path) {
    (void)udev;
    pthread_mutex_lock(&hpt_lock);
    const hpt_device *device = hpt_device_named(path);
    struct udev_device made;
    memset(&made, 0, sizeof made); /* it may have gone meanwhile: a device without a node */
    if (device) made = device_of(device, "");
    pthread_mutex_unlock(&hpt_lock);
    return copy_of(&made);
}

struct udev_device *udev_device_unref(struct udev_device *device);
struct udev_device *udev_device_unref(struct udev_device *device) {
    free(device);
    return NULL;
}

const char *udev_device_get_devnode(struct udev_device *device);
const char *udev_device_get_devnode(struct udev_device *device) {
    return device->node[0] ? device->node : NULL;
}

const char *udev_device_get_sysname(struct udev_device *device);
const char *udev_device_get_sysname(struct udev_device *device) {
    return device->name[0] ? device->name : NULL;
}

const char *udev_device_get_action(struct udev_device *device);
const char *udev_device_get_action(struct udev_device *device) {
    return device->action[0] ? device->action : NULL;
}
