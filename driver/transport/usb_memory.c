/* Buffers of the transport: memory of the kernel's that needs no copy on the way to the bus, as long as it gives
 * some, and else the process's own. */
#include "usb_internal.h"
#include <stdlib.h>

enum { ALIGNMENT = 4096, DEVICE_MEMORY_MAX = 8 * 1024 * 1024 };

/* The kernel has 16 MiB for all USB programs (usbcore.usbfs_memory_mb), and transfers from other memory are counted
 * too: so only as much as is under way at a time comes from there. */
static bool wants_device_memory(const hp_usb *usb, size_t bytes) {
    size_t most = 2 * usb->depth * (size_t)HP_USB_ROOM_MAX;
    return usb->device_memory + bytes <= (most < DEVICE_MEMORY_MAX ? most : DEVICE_MEMORY_MAX);
}

uint8_t *hp_usb_allocate(hp_usb *usb, size_t bytes) {
    hp_usb_memory *memory = calloc(1, sizeof *memory);
    if (!memory) return NULL;
    memory->room = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (wants_device_memory(usb, memory->room)) memory->bytes = libusb_dev_mem_alloc(usb->handle, memory->room);
    memory->device = memory->bytes != NULL;
    if (!memory->device) memory->bytes = aligned_alloc(ALIGNMENT, memory->room);
    if (!memory->bytes) {
        free(memory);
        return NULL;
    }
    usb->device_memory += memory->device ? memory->room : 0;
    memory->next = usb->memory;
    usb->memory = memory;
    return memory->bytes;
}

void hp_usb_free_all(hp_usb *usb) {
    while (usb->memory) {
        hp_usb_memory *memory = usb->memory;
        usb->memory = memory->next;
        if (memory->device)
            libusb_dev_mem_free(usb->handle, memory->bytes, memory->room);
        else
            free(memory->bytes);
        free(memory);
    }
}
