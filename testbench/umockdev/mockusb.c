/* The machine: its sysfs, what udev announces, and the hooks that usbfs.c and sockets.c have for a bus. */
#include "mock.h"
#include <dlfcn.h>
#include <errno.h>
#include <hitpipe/packet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { QUIET_MS = 5000, PERMITTED = 0666 };

static UMockdevTestbed *testbed;
static char root[128];
static hpt_mock_device mocks[HPT_DEVICES_MOST];

UMockdevTestbed *hpt_mock_testbed(void) {
    return testbed;
}

const char *hpt_mock_root(void) {
    return root;
}

static hpt_mock_device *find(const hpt_device *device) {
    for (unsigned i = 0; i < HPT_DEVICES_MOST; i++)
        if (mocks[i].device == device) return &mocks[i];
    return NULL;
}

hpt_mock_device *hpt_mock_device_of(const hpt_device *device) {
    hpt_mock_device *mock = find(device);
    if (!mock) abort();
    return mock;
}

/* ---- sysfs ---- */

void hpt_mock_remove(const char *path) {
    char full[300];
    snprintf(full, sizeof full, "/sys%s", path);
    umockdev_testbed_uevent(testbed, full, "remove");
    umockdev_testbed_remove_device(testbed, full);
}

static void add(const char *text) {
    if (!umockdev_testbed_add_from_string(testbed, text, NULL)) abort();
}

/* A string descriptor, which is ASCII here. */
static void read_string(hpt_device *device, unsigned index, char *text, size_t room) {
    uint8_t bytes[255];
    const uint8_t setup[8] = {0x80, 6, (uint8_t)index, 3, 0x09, 0x04, sizeof bytes, 0};
    int n = index ? hpt_cable_control(device->cable, setup, bytes, sizeof bytes) : 0;
    size_t at = 0;
    for (int i = 2; i + 1 < n && at + 1 < room; i += 2) text[at++] = (char)bytes[i];
    text[at] = '\0';
}

static void put_hex(char *to, const uint8_t *bytes, size_t n) {
    for (size_t i = 0; i < n; i++) sprintf(to + 2 * i, "%02X", bytes[i]);
}

static void add_device(const hpt_mock_device *mock) {
    enum { DEVICE_BYTES = 18, MOST = 1024 };
    hpt_device *device = mock->device;
    char hex[2 * MOST + 1], manufacturer[64], product[64], serial[64], text[4096];
    size_t n;
    const uint8_t *first = hp_gadget_device_descriptor(device->gadget);
    const uint8_t *second = hp_gadget_configuration(device->gadget, &n);
    if (DEVICE_BYTES + n > MOST) abort();
    put_hex(hex, first, DEVICE_BYTES);
    put_hex(hex + 2 * DEVICE_BYTES, second, n);
    read_string(device, first[14], manufacturer, sizeof manufacturer);
    read_string(device, first[15], product, sizeof product);
    read_string(device, first[16], serial, sizeof serial);
    snprintf(text, sizeof text,
             "P: %s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: DEVNAME=%s\nE: BUSNUM=%03u\n"
             "E: DEVNUM=%03u\nE: MAJOR=189\nE: MINOR=%u\nE: PRODUCT=%x/%x/%x\nA: dev=189:%u\nA: busnum=%u\\n\n"
             "A: devnum=%u\\n\nA: speed=%u\\n\nA: bConfigurationValue=1\\n\nA: bNumConfigurations=1\\n\n"
             "A: idVendor=%02x%02x\\n\nA: idProduct=%02x%02x\\n\nA: bcdDevice=%02x%02x\\n\nA: manufacturer=%s\\n\n"
             "A: product=%s\\n\nA: serial=%s\\n\nH: descriptors=%s\n\n",
             mock->usb_path, mock->usb->path, HPT_BUS, device->address, device->address - 1, hp_get16(first + 8),
             hp_get16(first + 10), hp_get16(first + 12), device->address - 1, HPT_BUS, device->address,
             hp_gadget_speed(device->gadget) == HP_USB_SUPER ? 5000 : 480, first[9], first[8], first[11], first[10],
             first[13], first[12], manufacturer, product, serial, hex);
    add(text);
}

static void add_interface(const hpt_mock_device *mock, unsigned number) {
    char text[600];
    snprintf(text, sizeof text,
             "P: %s/%s:1.%u\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=%02u\\n\n"
             "A: bAlternateSetting= 0\\n\nA: bInterfaceClass=%s\\n\n\n",
             mock->usb_path, mock->device->name, number, number, number == HP_USB_HID_INTERFACE ? "03" : "ff");
    add(text);
}

/* ---- in and out, for sockets.c ---- */

static void came(hpt_device *device) {
    hpt_mock_device *mock = find(device);
    if (!mock) {
        mock = find(NULL);
        *mock = (hpt_mock_device){.device = device};
    }
    mock->mode = device->def.denied ? 0 : PERMITTED;
    snprintf(mock->usb_path, sizeof mock->usb_path, "/devices/pci0000:00/0000:00:14.0/usb1/%s", device->name);
    snprintf(mock->hid_path, sizeof mock->hid_path, "%s/%s:1.1/0003:1209:0001.%04X", mock->usb_path, device->name,
             device->address);
    snprintf(mock->hidraw_path, sizeof mock->hidraw_path, "%s/hidraw/hidraw%u", mock->hid_path, device->port);
    char node[HPT_MOCK_PATH];
    snprintf(node, sizeof node, "/dev/bus/usb/%03d/%03u", HPT_BUS, device->address);
    mock->usb = hpt_node_new(node, &hpt_usbfs_node, device, mock->mode);
    add_device(mock);
    add_interface(mock, HP_USB_DATA_INTERFACE);
    add_interface(mock, HP_USB_HID_INTERFACE);
    hpt_usbhid_bind(mock);
}

static void went(hpt_device *device) {
    hpt_mock_device *mock = hpt_mock_device_of(device);
    char path[300];
    hpt_usbhid_unbind(mock);
    hpt_node_remove(mock->usb);
    hpt_usbfs_show(mock->usb);
    mock->usb = NULL;
    for (unsigned i = 0; i < HPT_INTERFACES; i++) {
        snprintf(path, sizeof path, "%s/%s:1.%u", mock->usb_path, device->name, i);
        hpt_mock_remove(path);
    }
    hpt_mock_remove(mock->usb_path);
    if (device->discarded) mock->device = NULL;
}

void hpt_udev_tell(const hpt_device *device, const char *action) {
    if (strcmp(action, "add") == 0)
        came((hpt_device *)device);
    else
        went((hpt_device *)device);
}

/* ---- system calls, for usbfs.c ---- */

int hpt_kernel_close(int fd) {
    return (int)syscall(SYS_close, fd);
}

/* usbfs.c writes and reads its pipe when what there is to reap changes: the node shows it too. */
static void show_all(void) {
    for (unsigned i = 0; i < HPT_DEVICES_MOST; i++)
        if (mocks[i].device && mocks[i].usb) hpt_usbfs_show(mocks[i].usb);
}

long hpt_kernel_read(int fd, void *bytes, size_t n) {
    long got = syscall(SYS_read, fd, bytes, n);
    show_all();
    return got;
}

long hpt_kernel_write(int fd, const void *bytes, size_t n) {
    return syscall(SYS_write, fd, bytes, n);
}

/* ---- umockdev's own events ---- */

/* umockdev 0.17 ends this process when a program closes its socket for events just when it is to be told of one. A
 * socket that refuses it leaves alone, as is right for both. */
int connect(int fd, const struct sockaddr *address, socklen_t bytes) {
    int (*next)(int, const struct sockaddr *, socklen_t);
    *(void **)&next = dlsym(RTLD_NEXT, "connect");
    int result = next(fd, address, bytes);
    if (result < 0 && errno == ENOENT) errno = ECONNREFUSED;
    return result;
}

/* ---- what tests call ---- */

void hpt_mock_under_wrapper(char **argv) {
    const char *preloaded = getenv("LD_PRELOAD"), *options = getenv("ASAN_OPTIONS");
    char text[512];
    if (preloaded && strstr(preloaded, "libumockdev-preload")) return;
    snprintf(text, sizeof text, "libumockdev-preload.so.0%s%s", preloaded ? ":" : "", preloaded ? preloaded : "");
    setenv("LD_PRELOAD", text, 1);
    snprintf(text, sizeof text, "%s%sverify_asan_link_order=0", options ? options : "", options ? ":" : "");
    setenv("ASAN_OPTIONS", text, 1);
    execv("/proc/self/exe", argv);
    abort();
}

void hpt_mock_begin(void) {
    pthread_mutex_lock(&hpt_lock);
    testbed = umockdev_testbed_new();
    gchar *directory = umockdev_testbed_get_root_dir(testbed);
    snprintf(root, sizeof root, "%s", directory);
    g_free(directory);
    if (!umockdev_in_mock_environment()) abort(); /* hpt_mock_under_wrapper was not called */
    pthread_mutex_unlock(&hpt_lock);
}

bool hpt_mock_quiet(void) {
    for (unsigned ms = 0; ms < QUIET_MS; ms++) {
        pthread_mutex_lock(&hpt_lock);
        unsigned open = hpt_nodes_open();
        pthread_mutex_unlock(&hpt_lock);
        if (!open) return true;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    return false;
}

void hpt_mock_end(void) {
    if (!hpt_mock_quiet()) abort();
    pthread_mutex_lock(&hpt_lock);
    hpt_nodes_free();
    g_object_unref(testbed);
    testbed = NULL;
    pthread_mutex_unlock(&hpt_lock);
}

const char *hpt_mock_usb_node(hpt_device *device, char path[HPT_MOCK_PATH]) {
    pthread_mutex_lock(&hpt_lock);
    strcpy(path, hpt_mock_device_of(device)->usb->path);
    pthread_mutex_unlock(&hpt_lock);
    return path;
}

const char *hpt_mock_hid_node(hpt_device *device, char path[HPT_MOCK_PATH]) {
    pthread_mutex_lock(&hpt_lock);
    strcpy(path, hpt_mock_device_of(device)->hid->path);
    pthread_mutex_unlock(&hpt_lock);
    return path;
}

static void change_mode(const hpt_node *node, unsigned mode) {
    char path[256];
    snprintf(path, sizeof path, "%s%s", root, node->path);
    if (chmod(path, mode)) abort();
}

void hpt_mock_chmod(hpt_device *device, unsigned mode) {
    pthread_mutex_lock(&hpt_lock);
    hpt_mock_device *mock = hpt_mock_device_of(device);
    change_mode(mock->usb, mode);
    change_mode(mock->hid, mode);
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_mock_twist_reports(hpt_device *device, hpt_mock_twist *twist, void *context) {
    pthread_mutex_lock(&hpt_lock);
    hpt_mock_device *mock = hpt_mock_device_of(device);
    mock->twist = twist;
    mock->context = context;
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_mock_mute(hpt_device *device, bool mute) {
    pthread_mutex_lock(&hpt_lock);
    hpt_mock_device_of(device)->mute = mute;
    pthread_mutex_unlock(&hpt_lock);
}

void hpt_mock_describe_hid(hpt_device *device, const uint8_t *descriptor, size_t n) {
    char path[256];
    pthread_mutex_lock(&hpt_lock);
    snprintf(path, sizeof path, "/sys%s", hpt_mock_device_of(device)->hid_path);
    umockdev_testbed_set_attribute_binary(testbed, path, "report_descriptor", (guint8 *)descriptor, (gint)n);
    pthread_mutex_unlock(&hpt_lock);
}

static unsigned listeners(const hpt_mock_device *mock) {
    unsigned count = 0;
    const hpt_file *file = mock->device->claims[HP_USB_HID_INTERFACE];
    if (!mock->device->present || !file) return 0;
    if (mock->bound)
        for (const hpt_client *client = mock->hid->clients; client; client = client->next) count += client->has_asked;
    else
        for (const hpt_pending *at = file->under_way.first; at; at = at->next)
            count |= at->urb.urb.endpoint == HP_USB_EVENT_ENDPOINT;
    return count;
}

unsigned hpt_mock_listeners(hpt_device *device) {
    pthread_mutex_lock(&hpt_lock);
    unsigned count = listeners(hpt_mock_device_of(device));
    pthread_mutex_unlock(&hpt_lock);
    return count;
}

/* ---- another program ---- */

struct hpt_claim {
    hpt_file *file;
};

hpt_claim *hpt_mock_claim(hpt_device *device, unsigned interface) {
    pthread_mutex_lock(&hpt_lock);
    hpt_claim *claim = calloc(1, sizeof *claim);
    if (!claim || hpt_file_open(device) < 0) abort();
    if (interface == HP_USB_HID_INTERFACE) hpt_usbhid_unbind(hpt_mock_device_of(device));
    claim->file = device->files;
    if (hpt_file_ioctl(claim->file, USBDEVFS_CLAIMINTERFACE, &interface)) abort();
    pthread_mutex_unlock(&hpt_lock);
    return claim;
}

void hpt_mock_release(hpt_claim *claim) {
    pthread_mutex_lock(&hpt_lock);
    hpt_file_close(claim->file);
    pthread_mutex_unlock(&hpt_lock);
    free(claim);
}
