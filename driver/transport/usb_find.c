/* Which boards are on the bus, and which one is meant. */
#include "usb_internal.h"
#include <stdlib.h>
#include <string.h>

/* A board that was found, and libusb's device of it. */
typedef struct found {
    libusb_device *device; /* a reference of ours */
    hp_usb_board board;
} found;

/* ---- asking one device ---- */

static bool is_data(const struct libusb_interface_descriptor *setting) {
    return setting->bInterfaceClass == LIBUSB_CLASS_VENDOR_SPEC &&
           setting->bInterfaceSubClass == HP_USB_DATA_SUBCLASS;
}

static bool read_endpoints(const struct libusb_interface_descriptor *setting, hp_usb_interface *interface) {
    *interface = (hp_usb_interface){.number = setting->bInterfaceNumber};
    for (unsigned i = 0; i < setting->bNumEndpoints; i++) {
        const struct libusb_endpoint_descriptor *endpoint = &setting->endpoint[i];
        if ((endpoint->bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK) continue;
        if (interface->packet && interface->packet != endpoint->wMaxPacketSize) return false;
        interface->packet = endpoint->wMaxPacketSize;
        if (endpoint->bEndpointAddress & LIBUSB_ENDPOINT_IN)
            interface->in = endpoint->bEndpointAddress;
        else
            interface->out = endpoint->bEndpointAddress;
    }
    return interface->in && interface->out && interface->packet;
}

bool hp_usb_data_interface(libusb_device *device, hp_usb_interface *interface) {
    struct libusb_config_descriptor *configuration;
    if (libusb_get_active_config_descriptor(device, &configuration)) return false;
    bool has = false;
    for (unsigned i = 0; i < configuration->bNumInterfaces && !has; i++) {
        const struct libusb_interface *now = &configuration->interface[i];
        has = now->num_altsetting > 0 && is_data(now->altsetting) && read_endpoints(now->altsetting, interface);
    }
    libusb_free_config_descriptor(configuration);
    return has;
}

void hp_usb_text(libusb_device_handle *handle, uint8_t index, char text[HP_USB_TEXT]) {
    int n = index ? libusb_get_string_descriptor_ascii(handle, index, (unsigned char *)text, HP_USB_TEXT - 1) : 0;
    if (n < 0 || n >= HP_USB_TEXT) n = 0;
    for (int i = 0; i < n; i++)
        if (text[i] < ' ' || text[i] > '~') text[i] = '?';
    text[n] = '\0';
}

static unsigned speed_of(libusb_device *device) {
    static const unsigned mbits[] = {
        [LIBUSB_SPEED_FULL] = 12,
        [LIBUSB_SPEED_HIGH] = 480,
        [LIBUSB_SPEED_SUPER] = 5000,
        [LIBUSB_SPEED_SUPER_PLUS] = 10000,
    };
    unsigned speed = (unsigned)libusb_get_device_speed(device);
    return speed < sizeof mbits / sizeof mbits[0] ? mbits[speed] : 0;
}

static hp_usb_board ask(libusb_device *device, const struct libusb_device_descriptor *said) {
    hp_usb_board board = {
        .vendor = said->idVendor,
        .product_id = said->idProduct,
        .release = said->bcdDevice,
        .bus = libusb_get_bus_number(device),
        .address = libusb_get_device_address(device),
        .mbits = speed_of(device),
    };
    libusb_device_handle *handle;
    board.error = libusb_open(device, &handle);
    if (board.error) return board;
    hp_usb_text(handle, said->iSerialNumber, board.serial);
    hp_usb_text(handle, said->iProduct, board.product);
    libusb_close(handle);
    return board;
}

/* ---- all of them ---- */

static bool is_board(const hp_device_def *def, libusb_device *device, struct libusb_device_descriptor *said) {
    hp_usb_interface interface;
    return libusb_get_device_descriptor(device, said) == 0 && said->idVendor == def->usb_vendor &&
           said->idProduct == def->usb_product && hp_usb_data_interface(device, &interface);
}

static int by_place(const void *a, const void *b) {
    const hp_usb_board *one = &((const found *)a)->board, *other = &((const found *)b)->board;
    if (one->bus != other->bus) return one->bus < other->bus ? -1 : 1;
    return one->address < other->address ? -1 : one->address > other->address;
}

static void forget(found *boards, size_t count) {
    for (size_t i = 0; i < count; i++) libusb_unref_device(boards[i].device);
    free(boards);
}

static hp_status find(const hp_usb_bus *bus, const hp_device_def *def, found **boards, size_t *count,
                      hp_message *message) {
    libusb_device **list;
    ssize_t devices = libusb_get_device_list(bus->context, &list);
    if (devices < 0)
        return hp_say(message, hp_usb_status((int)devices), "cannot list USB devices: %s",
                      hp_usb_words((int)devices));
    *count = 0;
    *boards = calloc((size_t)devices + 1, sizeof **boards);
    for (ssize_t i = 0; i < devices && *boards; i++) {
        struct libusb_device_descriptor said;
        if (!is_board(def, list[i], &said)) continue;
        (*boards)[(*count)++] = (found){.device = libusb_ref_device(list[i]), .board = ask(list[i], &said)};
    }
    libusb_free_device_list(list, 1);
    if (!*boards) return hp_say(message, HP_ERROR_MEMORY, "no memory for a list of USB devices");
    qsort(*boards, *count, sizeof **boards, by_place);
    return HP_OK;
}

hp_status hp_usb_list(const hp_device_def *def, hp_usb_board **boards, size_t *count, hp_message *message) {
    hp_usb_bus bus;
    found *all;
    *boards = NULL;
    *count = 0;
    hp_status status = hp_usb_bus_open(def, &bus, message);
    if (status) return status;
    size_t n;
    status = find(&bus, def, &all, &n, message);
    if (!status) {
        *boards = calloc(n + 1, sizeof **boards);
        for (size_t i = 0; i < n && *boards; i++) (*boards)[i] = all[i].board;
        *count = *boards ? n : 0;
        if (!*boards) status = hp_say(message, HP_ERROR_MEMORY, "no memory for a list of boards");
        forget(all, n);
    }
    hp_usb_bus_close(&bus);
    return status;
}

/* ---- the one that is meant ---- */

static hp_status refused(const hp_usb_board *board, hp_message *message) {
    hp_status status = hp_usb_status(board->error);
    hp_say(message, status == HP_ERROR_DISCONNECTED ? HP_ERROR_NO_DEVICE : status,
           "cannot open the board at USB bus %u, address %u: %s%s", board->bus, board->address,
           hp_usb_words(board->error), hp_usb_advice(board->error));
    return status == HP_ERROR_DISCONNECTED ? HP_ERROR_NO_DEVICE : status;
}

/* Words on boards that are there, each as a target to choose: "usb:HP1, usb:HP2, one at bus 1, address 4 (no
 * permission)". */
static void name_boards(const found *boards, size_t count, hp_message *message) {
    for (size_t i = 0; i < count; i++) {
        const hp_usb_board *board = &boards[i].board;
        const char *comma = i ? ", " : "";
        if (board->error)
            hp_say_also(message, "%sone at bus %u, address %u (%s)", comma, board->bus, board->address,
                        hp_usb_words(board->error));
        else
            hp_say_also(message, "%susb:%s", comma, board->serial);
    }
}

static hp_status none(const hp_device_def *def, const char *serial, const found *boards, size_t count,
                      hp_message *message) {
    for (size_t i = 0; i < count; i++) /* it may be the one that cannot even be asked */
        if (boards[i].board.error) return refused(&boards[i].board, message);
    hp_say(message, HP_ERROR_NO_DEVICE, "no board on USB with the identifiers %04x:%04x%s%s", def->usb_vendor,
           def->usb_product, serial ? " and the serial number " : "", serial ? serial : "");
    if (count) hp_say_also(message, "; there are ");
    name_boards(boards, count, message);
    return HP_ERROR_NO_DEVICE;
}

static hp_status choose(const hp_device_def *def, const char *serial, const found *boards, size_t count,
                        const found **chosen, hp_message *message) {
    *chosen = NULL;
    for (size_t i = 0; i < count && serial; i++)
        if (!boards[i].board.error && strcmp(boards[i].board.serial, serial) == 0) *chosen = &boards[i];
    if (!serial && count == 1 && !boards[0].board.error) *chosen = &boards[0];
    if (*chosen) return HP_OK;
    if (serial || count <= 1) return none(def, serial, boards, count, message);
    hp_say(message, HP_ERROR_NO_DEVICE, "%zu boards on USB, say which: ", count);
    name_boards(boards, count, message);
    return HP_ERROR_NO_DEVICE;
}

hp_status hp_usb_open(const hp_usb_bus *bus, const hp_device_def *def, const char *serial,
                      libusb_device_handle **handle, hp_message *message) {
    found *boards;
    size_t count;
    const found *chosen;
    hp_status status = find(bus, def, &boards, &count, message);
    if (status) return status;
    status = choose(def, serial, boards, count, &chosen, message);
    if (!status) {
        hp_usb_board board = chosen->board;
        board.error = libusb_open(chosen->device, handle);
        if (board.error) status = refused(&board, message);
    }
    forget(boards, count);
    return status;
}
