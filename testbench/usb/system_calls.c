/* The program's own open, access, close, read, lseek, ioctl and mmap: libusb's calls come here, and those that are
 * not for the bus go on to the kernel. Nothing here may be instrumented: sanitizers call mmap before they are ready.
 */
#include "bus.h"
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#define PLAIN __attribute__((no_sanitize("address", "undefined", "thread")))

int hpt_kernel_open(const char *path, int flags, unsigned mode) {
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}
int hpt_kernel_close(int fd) {
    return (int)syscall(SYS_close, fd);
}
long hpt_kernel_read(int fd, void *bytes, size_t n) {
    return syscall(SYS_read, fd, bytes, n);
}
long hpt_kernel_write(int fd, const void *bytes, size_t n) {
    return syscall(SYS_write, fd, bytes, n);
}

static _Thread_local unsigned depth; /* of calls that are for the bus */

bool hpt_inside(void) {
    return depth > 0;
}

static void enter(void) {
    depth++;
    pthread_mutex_lock(&hpt_lock);
}

static void leave(void) {
    pthread_mutex_unlock(&hpt_lock);
    depth--;
}

static long result(long value) {
    if (value >= 0) return value;
    errno = (int)-value;
    return -1;
}

/* ---- open ---- */

static const char usbfs[] = "/dev/bus/usb/", sysfs[] = "/sys/bus/usb/devices/";

static long find_node(const char *rest, bool writing, hpt_device **device) {
    unsigned bus, address;
    if (sscanf(rest, "%u/%u", &bus, &address) != 2) return -ENOENT;
    *device = hpt_device_at(bus, address);
    if (!*device) return -ENOENT;
    return (*device)->def.denied && writing ? -EACCES : 0;
}

static long open_node(const char *rest, int flags) {
    hpt_device *device;
    long error = find_node(rest, (flags & O_ACCMODE) != O_RDONLY, &device);
    return error ? error : hpt_file_open(device);
}

static long open_attribute(const char *rest) {
    const char *slash = strchr(rest, '/');
    char name[16] = {0};
    if (!slash || (size_t)(slash - rest) >= sizeof name) return -ENOENT;
    memcpy(name, rest, (size_t)(slash - rest));
    const hpt_device *device = hpt_device_named(name);
    return device ? hpt_sysfs_open(device, slash + 1) : -ENOENT;
}

static int open_any(const char *path, int flags, unsigned mode) {
    bool node = strncmp(path, usbfs, sizeof usbfs - 1) == 0, attribute = strncmp(path, sysfs, sizeof sysfs - 1) == 0;
    if (!node && !attribute) return hpt_kernel_open(path, flags, mode);
    enter();
    long fd = node ? open_node(path + sizeof usbfs - 1, flags) : open_attribute(path + sizeof sysfs - 1);
    leave();
    return (int)result(fd);
}

int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    unsigned mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, unsigned) : 0;
    va_end(rest);
    return open_any(path, flags, mode);
}

int __open_2(const char *path, int flags);
int __open_2(const char *path, int flags) {
    return open_any(path, flags, 0);
}

/* ---- access ---- */

int access(const char *path, int mode) {
    bool node = strncmp(path, usbfs, sizeof usbfs - 1) == 0, attribute = strncmp(path, sysfs, sizeof sysfs - 1) == 0;
    if (!node && !attribute) return (int)syscall(SYS_faccessat, AT_FDCWD, path, mode);
    enter();
    hpt_device *device = NULL;
    long error = 0;
    if (node)
        error = find_node(path + sizeof usbfs - 1, mode & W_OK, &device);
    else if (!hpt_device_named(path + sizeof sysfs - 1))
        error = -ENOENT;
    leave();
    return (int)result(error);
}

/* ---- open files ---- */

int close(int fd) {
    hpt_file *file = hpt_file_at(fd);
    if (!file) return hpt_kernel_close(fd);
    enter();
    hpt_file_close(file);
    leave();
    return 0;
}

ssize_t read(int fd, void *bytes, size_t n) {
    hpt_file *file = hpt_file_at(fd);
    if (!file) return hpt_kernel_read(fd, bytes, n);
    enter();
    long moved = hpt_file_read(file, bytes, n);
    leave();
    return result(moved);
}

off_t lseek(int fd, off_t offset, int whence) {
    hpt_file *file = hpt_file_at(fd);
    if (!file) return syscall(SYS_lseek, fd, offset, whence);
    if (whence != SEEK_SET || offset < 0) return result(-EINVAL);
    file->offset = (size_t)offset;
    return offset;
}

int ioctl(int fd, unsigned long request, ...) {
    va_list rest;
    va_start(rest, request);
    void *argument = va_arg(rest, void *);
    va_end(rest);
    hpt_file *file = hpt_file_at(fd);
    if (!file) return (int)syscall(SYS_ioctl, fd, request, argument);
    enter();
    int error = hpt_file_ioctl(file, request, argument);
    leave();
    return (int)result(error);
}

PLAIN void *mmap(void *address, size_t bytes, int protection, int flags, int fd, off_t offset) {
    hpt_file *file = fd < 0 ? NULL : hpt_file_at(fd);
    if (!file) return (void *)syscall(SYS_mmap, address, bytes, protection, flags, fd, offset);
    enter();
    void *memory = hpt_file_map(file, bytes);
    leave();
    if (memory) return memory;
    errno = ENOMEM;
    return MAP_FAILED;
}
