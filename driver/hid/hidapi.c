/* Reports by way of hidapi, with either of its back ends: hidraw, whose paths are device nodes, and libusb, whose
 * paths are bus-port:configuration.interface.
 *
 * hidapi 0.13 has state of the process (the last error of hid_enumerate and hid_open_path; with libusb a context,
 * made by the first call), hence the lock. It tells of errors in words of its own, or with libusb in none, so why
 * something failed is found out here: from errno where hidraw's ioctl set it, from the device's node, from how long
 * it took. */
#include "hid.h"
#include <errno.h>
#include <fcntl.h>
#include <hidapi.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
    PATIENCE_MS = 950, /* a request that took so long was given up by hidapi (after 1 s) or the kernel (5 s) */
    NOTICE_MS = 500,   /* the kernel asks a hub every quarter of a second whether a board was unplugged */
    STEP_MS = 5
};

typedef struct hidapi_board {
    hp_hid head;
    hid_device *device;
    hp_control_board board;
} hidapi_board;

static pthread_mutex_t hidapi_lock = PTHREAD_MUTEX_INITIALIZER;

/* ---- what the operating system says of a path ---- */

static bool is_node(const char *path) {
    return path[0] == '/';
}

/* Writes the directory of the device behind a path of the libusb back end: that of "1-2:1.1" is named 1-2. */
static void device_directory(const char *path, char *directory, size_t room) {
    snprintf(directory, room, "/sys/bus/usb/devices/%.*s", (int)strcspn(path, ":"), path);
}

static bool plugged_in(const char *path) {
    char directory[256];
    if (is_node(path)) return access(path, F_OK) == 0;
    device_directory(path, directory, sizeof directory);
    return access(directory, F_OK) == 0;
}

static unsigned read_number(const char *directory, const char *name) {
    char path[300];
    unsigned number = 0;
    snprintf(path, sizeof path, "%s/%s", directory, name);
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    char text[16] = "";
    if (read(file, text, sizeof text - 1) > 0) number = (unsigned)strtoul(text, NULL, 10);
    close(file);
    return number;
}

/* The node that must be open for reading and writing. */
static void find_node(const char *path, char *node, size_t room) {
    char directory[256];
    if (is_node(path)) {
        snprintf(node, room, "%s", path);
        return;
    }
    device_directory(path, directory, sizeof directory);
    snprintf(node, room, "/dev/bus/usb/%03u/%03u", read_number(directory, "busnum"),
             read_number(directory, "devnum"));
}

static uint64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

/* ---- requests ---- */

static hp_status gone(const hidapi_board *b, hp_message *message) {
    return hp_say(message, HP_ERROR_DISCONNECTED, "board %s (%s) was unplugged", b->board.serial, b->board.path);
}

/* Whether the board is unplugged, or will be within `ms`: requests fail before the kernel notices. */
static bool is_going(const hidapi_board *b, unsigned ms) {
    for (; plugged_in(b->board.path); ms -= STEP_MS) {
        if (ms < STEP_MS) return false;
        nanosleep(&(struct timespec){.tv_nsec = STEP_MS * 1000000L}, NULL);
    }
    return true;
}

/* Why a request failed that began at `began`, with `error` for errno behind it. */
static hp_status why(const hidapi_board *b, uint64_t began, int error, const char *request, hp_message *message) {
    char words[128];
    bool told = is_node(b->board.path) && error;
    uint64_t took = now_ms() - began;
    bool late = (told && error == ETIMEDOUT) || took >= PATIENCE_MS;
    bool refused = told && error == EPIPE; /* by the board itself */
    bool shut = told && (error == ENODEV || error == ESHUTDOWN);
    if (shut || is_going(b, late || refused ? 0 : NOTICE_MS)) return gone(b, message);
    if (late)
        return hp_say(message, HP_ERROR_TIMEOUT, "board %s did not answer %s in %llu ms", b->board.serial, request,
                      (unsigned long long)took);
    return hp_say(message, HP_ERROR_IO, "board %s refused %s: %s", b->board.serial, request,
                  told ? strerror_r(error, words, sizeof words) : "no reason was given");
}

static hp_status get_feature(hp_hid *hid, uint8_t *bytes, size_t room, size_t *n, hp_message *message) {
    hidapi_board *b = (hidapi_board *)hid;
    uint64_t began = now_ms();
    unsigned id = bytes[0];
    errno = 0;
    int got = hid_get_feature_report(b->device, bytes, room);
    int error = errno;
    char request[40];
    snprintf(request, sizeof request, "to read report %u", id);
    if (got < 0) return why(b, began, error, request, message);
    *n = (size_t)got < room ? (size_t)got : room;
    return HP_OK;
}

static hp_status set_feature(hp_hid *hid, const uint8_t *bytes, size_t n, hp_message *message) {
    hidapi_board *b = (hidapi_board *)hid;
    uint64_t began = now_ms();
    errno = 0;
    int sent = hid_send_feature_report(b->device, bytes, n);
    int error = errno;
    char request[40];
    snprintf(request, sizeof request, "to write report %u", bytes[0]);
    if (sent < 0) return why(b, began, error, request, message);
    if ((size_t)sent < n)
        return hp_say(message, HP_ERROR_LENGTH, "board %s took %d of %zu bytes of report %u", b->board.serial, sent,
                      n, bytes[0]);
    return HP_OK;
}

static hp_status next_input(hp_hid *hid, unsigned timeout_ms, uint8_t *bytes, size_t room, size_t *n,
                            hp_message *message) {
    hidapi_board *b = (hidapi_board *)hid;
    errno = 0;
    int got = hid_read_timeout(b->device, bytes, room, timeout_ms < INT_MAX ? (int)timeout_ms : INT_MAX);
    int error = errno;
    *n = got > 0 ? (size_t)got : 0;
    if (got > 0) return HP_OK;
    if (got == 0) return HP_ERROR_TIMEOUT;
    if (is_node(b->board.path) && error == EINTR)
        return hp_say(message, HP_ERROR_CANCELLED, "a signal ended the wait for an event");
    return gone(b, message); /* hidapi gives no other reason to stop reading */
}

static void close_board(hp_hid *hid) {
    hidapi_board *b = (hidapi_board *)hid;
    hid_close(b->device);
    free(b);
}

static const hp_hid_ops ops = {
    .get_feature = get_feature,
    .set_feature = set_feature,
    .next_input = next_input,
    .close = close_board,
};

/* ---- list ---- */

/* Appends a character as UTF-8 if it fits before `end`; control characters as '?'. */
static char *put_character(char *to, const char *end, uint32_t code) {
    if (code < ' ' || (code >= 0x7F && code < 0xA0) || code > 0x10FFFF) code = '?';
    unsigned more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    if (end - to <= (ptrdiff_t)more) return to;
    static const uint8_t first[] = {0, 0xC0, 0xE0, 0xF0};
    *to++ = (char)(first[more] | code >> 6 * more);
    while (more--) *to++ = (char)(0x80 | (code >> 6 * more & 0x3F));
    return to;
}

static void take_text(char *to, size_t room, const wchar_t *from) {
    const char *end = to + room - 1;
    for (; from && *from; from++) to = put_character(to, end, (uint32_t)*from);
    *to = '\0';
}

static hp_control_board take_board(const struct hid_device_info *info) {
    hp_control_board board = {
        .vendor = info->vendor_id, .product = info->product_id, .release = info->release_number};
    take_text(board.serial, sizeof board.serial, info->serial_number);
    take_text(board.name, sizeof board.name, info->product_string);
    snprintf(board.path, sizeof board.path, "%s", info->path);
    return board;
}

/* Others have the same identifiers: they are of a range for tests. The libusb back end cannot tell the usage page,
 * and what is no USB interface has no number. */
static bool is_board(const struct hid_device_info *info) {
    bool interface = info->interface_number < 0 || info->interface_number == HP_USB_HID_INTERFACE;
    bool page = info->usage_page == 0 || info->usage_page == HP_USB_USAGE_PAGE;
    return info->path && strlen(info->path) < sizeof((hp_control_board *)0)->path && interface && page;
}

/* hidapi lists a device once for each of its top-level usages. */
static bool is_listed(const hp_control_board *boards, size_t count, const char *path) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(boards[i].path, path) == 0) return true;
    return false;
}

static int by_serial(const void *a, const void *b) {
    const hp_control_board *one = a, *other = b;
    int order = strcmp(one->serial, other->serial);
    return order ? order : strcmp(one->path, other->path);
}

hp_status hp_hidapi_list(uint16_t vendor, uint16_t product, hp_control_board **out, size_t *count,
                         hp_message *message) {
    *out = NULL;
    *count = 0;
    pthread_mutex_lock(&hidapi_lock);
    struct hid_device_info *infos = hid_enumerate(vendor, product);
    pthread_mutex_unlock(&hidapi_lock);
    size_t most = 1; /* so that memory for none is not NULL */
    for (const struct hid_device_info *info = infos; info; info = info->next) most++;
    hp_control_board *boards = calloc(most, sizeof *boards);
    for (const struct hid_device_info *info = infos; boards && info; info = info->next)
        if (is_board(info) && !is_listed(boards, *count, info->path)) boards[(*count)++] = take_board(info);
    hid_free_enumeration(infos);
    if (boards) qsort(boards, *count, sizeof *boards, by_serial);
    *out = boards;
    return boards ? HP_OK : hp_say(message, HP_ERROR_MEMORY, "%s", hp_status_text(HP_ERROR_MEMORY));
}

/* ---- open ---- */

/* Without permission the libusb back end has no serial number to tell. */
static hp_status refused(const hp_control_board *board, hp_message *message) {
    char node[128];
    const char *space = board->serial[0] ? " " : "";
    find_node(board->path, node, sizeof node);
    if (!plugged_in(board->path))
        return hp_say(message, HP_ERROR_NO_DEVICE, "board%s%s (%s) was unplugged", space, board->serial, board->path);
    if (access(node, R_OK | W_OK) != 0 && errno == EACCES)
        return hp_say(
            message, HP_ERROR_NO_DEVICE,
            "no permission to open board%s%s (%s): the udev rule 60-hitpipe.rules gives it, see docs/usb.md", space,
            board->serial, node);
    return hp_say(message, HP_ERROR_NO_DEVICE, "board%s%s (%s) cannot be opened: %s", space, board->serial,
                  board->path,
                  is_node(board->path) ? "it is no HID any more" : "another program holds its HID interface");
}

hp_status hp_hidapi_open(const hp_control_board *board, hp_hid **hid, hp_message *message) {
    hidapi_board *b = calloc(1, sizeof *b);
    *hid = NULL;
    if (!b) return hp_say(message, HP_ERROR_MEMORY, "%s", hp_status_text(HP_ERROR_MEMORY));
    b->head.ops = &ops;
    b->board = *board;
    pthread_mutex_lock(&hidapi_lock);
    b->device = hid_open_path(board->path);
    pthread_mutex_unlock(&hidapi_lock);
    if (!b->device) {
        free(b);
        return refused(board, message);
    }
    *hid = &b->head;
    return HP_OK;
}
