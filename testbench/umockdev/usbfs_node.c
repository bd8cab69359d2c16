/* Nodes of usbfs: carries the ioctls of a program to usbfs.c. What the program's pointers point to lies in its own
 * memory, which umockdev reads and writes for us: bytes to the board when an urb is submitted, bytes from it when the
 * urb is reaped, the urb itself likewise. */
#include "mock.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* An urb that the board has, or that waits to be reaped: our copy of the program's. */
struct hpt_lent {
    UMockdevIoctlData *urb; /* data: struct usbdevfs_urb */
    void *buffer;           /* the program's */
    uint8_t *room;          /* for bytes to the host */
    bool mute, ended;       /* the board never had it; and it was called back */
    hpt_lent *next;
};

enum { SETUP_BYTES = 8, IN = 0x80 };

static struct usbdevfs_urb *urb_of(const hpt_lent *lent) {
    return (struct usbdevfs_urb *)(void *)lent->urb->data;
}

static void forget(hpt_lent *lent) {
    g_object_unref(lent->urb);
    free(lent->room);
    free(lent);
}

static void give_back(hpt_client *client, hpt_lent *lent) {
    hpt_lent **at = &client->lent;
    while (*at != lent) at = &(*at)->next;
    *at = lent->next;
}

/* ---- requests to the HID ---- */

enum { TO_HID = 0x21, FROM_HID = 0xA1, GET_REPORT = 1, FEATURE = 3 };

/* Whether it is a class request to the HID, of that type; 0: any. */
static bool asks_hid(const hpt_lent *lent, unsigned type) {
    const struct usbdevfs_urb *urb = urb_of(lent);
    const uint8_t *setup = urb->buffer;
    if (urb->type != USBDEVFS_URB_TYPE_CONTROL || setup[4] != HP_USB_HID_INTERFACE) return false;
    return type ? setup[0] == type : setup[0] == TO_HID || setup[0] == FROM_HID;
}

static void twist(const hpt_mock_device *mock, const hpt_lent *lent) {
    struct usbdevfs_urb *urb = urb_of(lent);
    if (!mock->twist || urb->status || urb->actual_length == 0 || !asks_hid(lent, FROM_HID)) return;
    uint8_t *setup = urb->buffer;
    if (setup[1] != GET_REPORT || setup[3] != FEATURE) return;
    urb->actual_length = (int)mock->twist(mock->context, setup + SETUP_BYTES, (size_t)urb->actual_length);
}

/* ---- submit ---- */

/* Bytes to the board, and the setup of a control request, are fetched now. */
static int lend_buffer(hpt_lent *lent) {
    struct usbdevfs_urb *urb = urb_of(lent);
    size_t at = offsetof(struct usbdevfs_urb, buffer);
    bool control = urb->type == USBDEVFS_URB_TYPE_CONTROL;
    lent->buffer = urb->buffer;
    if (urb->buffer_length < 0 || (control && urb->buffer_length < SETUP_BYTES)) return -EINVAL;
    if (urb->buffer_length && (control || !(urb->endpoint & IN))) {
        UMockdevIoctlData *bytes = umockdev_ioctl_data_resolve(lent->urb, at, (size_t)urb->buffer_length, NULL);
        if (!bytes) return -EFAULT;
        g_object_unref(bytes); /* the urb has it */
        return 0;
    }
    lent->room = malloc((size_t)urb->buffer_length + 1);
    if (!lent->room) abort();
    return 0;
}

/* Where usbfs.c looks for the bytes is not where the program has them. */
static int submit_lent(hpt_client *client, hpt_lent *lent) {
    struct usbdevfs_urb *urb = urb_of(lent);
    void *theirs = urb->buffer;
    if (lent->room) urb->buffer = lent->room;
    int result = hpt_file_ioctl(client->file, USBDEVFS_SUBMITURB, urb);
    urb->buffer = theirs;
    return result;
}

static int submit(hpt_client *client, UMockdevIoctlData *argument) {
    UMockdevIoctlData *urb = umockdev_ioctl_data_resolve(argument, 0, sizeof(struct usbdevfs_urb), NULL);
    hpt_lent *lent = calloc(1, sizeof *lent);
    if (!urb || !lent) abort();
    *lent = (hpt_lent){.urb = urb, .next = client->lent};
    client->lent = lent;
    int result = lend_buffer(lent);
    lent->mute = !result && hpt_mock_device_of(client->node->device)->mute && asks_hid(lent, 0);
    if (!result && !lent->mute) result = submit_lent(client, lent);
    if (result) {
        give_back(client, lent);
        forget(lent);
    }
    return result;
}

/* ---- discard, reap ---- */

static int discard(const hpt_client *client, const UMockdevIoctlData *argument) {
    unsigned long address;
    memcpy(&address, argument->data, sizeof address);
    hpt_lent *lent = client->lent;
    while (lent && lent->urb->client_addr != address) lent = lent->next;
    if (!lent) return -EINVAL;
    if (!lent->mute) return hpt_file_ioctl(client->file, USBDEVFS_DISCARDURB, urb_of(lent));
    lent->ended = true;
    urb_of(lent)->status = -ENOENT;
    return 0;
}

/* Bytes to the host go to the program now, as many as there are. */
static void deliver(hpt_lent *lent) {
    struct usbdevfs_urb *urb = urb_of(lent);
    size_t n = (size_t)urb->actual_length;
    if (!lent->room || n == 0) return;
    UMockdevIoctlData *bytes = umockdev_ioctl_data_resolve(lent->urb, offsetof(struct usbdevfs_urb, buffer), n, NULL);
    if (!bytes) abort();
    memcpy(bytes->data, lent->room, n);
    g_object_unref(bytes);
}

static hpt_lent *find_ended(const hpt_client *client) {
    hpt_lent *lent = client->lent;
    while (lent && !lent->ended) lent = lent->next;
    return lent;
}

/* The urb that ended first. */
static int take_ended(hpt_client *client, hpt_lent **ended) {
    struct usbdevfs_urb *urb;
    *ended = find_ended(client);
    if (*ended) return 0;
    int result = hpt_file_ioctl(client->file, USBDEVFS_REAPURBNDELAY, &urb);
    if (result) return result;
    *ended = client->lent;
    while (urb_of(*ended) != urb) *ended = (*ended)->next;
    twist(hpt_mock_device_of(client->node->device), *ended);
    return 0;
}

static int reap(hpt_client *client, UMockdevIoctlData *argument) {
    hpt_lent *lent;
    int result = take_ended(client, &lent);
    if (result == -ENODEV) client->told = true;
    if (result) return result;
    UMockdevIoctlData *pointer = umockdev_ioctl_data_resolve(argument, 0, sizeof(void *), NULL);
    if (!pointer) abort();
    give_back(client, lent);
    deliver(lent);
    umockdev_ioctl_data_set_ptr(pointer, 0, lent->urb);
    g_object_unref(pointer);
    forget(lent);
    return 0;
}

/* ---- the HID's driver ---- */

static int get_driver(hpt_client *client, struct usbdevfs_getdriver *driver) {
    const hpt_mock_device *mock = hpt_mock_device_of(client->node->device);
    if (driver->interface != HP_USB_HID_INTERFACE || !mock->bound)
        return hpt_file_ioctl(client->file, USBDEVFS_GETDRIVER, driver);
    strcpy(driver->driver, "usbhid");
    return 0;
}

static int driver_command(const hpt_client *client, const struct usbdevfs_ioctl *command) {
    hpt_mock_device *mock = hpt_mock_device_of(client->node->device);
    if (command->ifno != HP_USB_HID_INTERFACE) return -ENODATA;
    switch ((unsigned)command->ioctl_code) {
    case USBDEVFS_DISCONNECT:
        if (!mock->bound) return -ENODATA;
        hpt_usbhid_unbind(mock);
        return 0;
    case USBDEVFS_CONNECT:
        if (mock->bound || client->node->device->claims[HP_USB_HID_INTERFACE]) return -EBUSY;
        hpt_usbhid_bind(mock);
        return 1;
    default:
        return -ENOTTY;
    }
}

/* ---- the others, whose argument holds no pointer ---- */

static int plain(hpt_client *client, unsigned long request, UMockdevIoctlData *argument) {
    size_t bytes = _IOC_SIZE(request);
    UMockdevIoctlData *data = bytes ? umockdev_ioctl_data_resolve(argument, 0, bytes, NULL) : NULL;
    void *local = data ? data->data : NULL;
    int result = -EFAULT;
    if (bytes && !data) return result;
    if (request == USBDEVFS_GETDRIVER)
        result = get_driver(client, local);
    else if (request == USBDEVFS_IOCTL)
        result = driver_command(client, local);
    else
        result = hpt_file_ioctl(client->file, request, local);
    if (data) g_object_unref(data);
    return result;
}

static int choose(hpt_client *client, unsigned long request, UMockdevIoctlData *argument) {
    switch (request) {
    case USBDEVFS_SUBMITURB:
        return submit(client, argument);
    case USBDEVFS_DISCARDURB:
        return discard(client, argument);
    case USBDEVFS_REAPURBNDELAY:
        return reap(client, argument);
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESET:
    case USBDEVFS_GET_CAPABILITIES:
    case USBDEVFS_GET_SPEED:
    case USBDEVFS_CONNECTINFO:
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
        return plain(client, request, argument);
    default:
        return -ENOTTY;
    }
}

static int answer(hpt_client *client, unsigned long request, UMockdevIoctlData *argument) {
    int result =
        client->node->gone && request != USBDEVFS_REAPURBNDELAY ? -ENODEV : choose(client, request, argument);
    if (!client->node->gone) hpt_usbhid_poll(hpt_mock_device_of(client->node->device)); /* a reset ended it */
    hpt_usbfs_show(client->node);
    return result;
}

/* ---- readiness ---- */

/* Of a device that is gone there is always something to reap, the news, until the program has heard it. */
void hpt_usbfs_show(hpt_node *node) {
    bool ready = false;
    for (hpt_client *client = node->clients; client; client = client->next)
        ready |= node->gone ? !client->told : client->file->ended.first || find_ended(client);
    hpt_node_show(node, ready);
}

static void opened(hpt_client *client) {
    int fd = hpt_file_open(client->node->device);
    if (fd < 0) abort();
    client->file = client->node->device->files;
}

static void closed(hpt_client *client) {
    hpt_file_close(client->file);
    for (hpt_lent *lent; (lent = client->lent);) {
        client->lent = lent->next;
        forget(lent);
    }
    hpt_usbfs_show(client->node);
}

const hpt_node_kind hpt_usbfs_node = {.opened = opened, .closed = closed, .answer = answer};
