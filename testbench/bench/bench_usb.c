/* What the driver costs on a USB link: hp_upload against a plain loop of libusb that sends the very same packets,
 * sealed beforehand, with as many under way, over the same bus of testbench/usb/ to the same board. At the pace of
 * cables, and as fast as memory, where driver, kernel's side and board take turns on one processor.
 * Rounds of both alternate; medians and ratios. */
#include "driver/transport/usb.h"
#include "testbench/usb/usbfs.h"
#include <hitpipe/hitpipe.h>
#include <hitpipe/packet.h>
#include <libusb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    PACKETS = 24,
    CHUNK = (HP_PAYLOAD_MAX - HP_UPLOAD_FIXED) / 36,
    TRIANGLES = PACKETS * CHUNK,
    ROUNDS = 9,
    INS = 4
};
enum {
    SUPERSPEED = 400000,
    SUPERSPEED_PLUS = 1000000
}; /* bytes a millisecond: the best of bulk at 5 and 10 Gbit/s */

static float *triangles;

static void must(int good, const char *what) {
    if (good) return;
    fprintf(stderr, "bench_usb: %s\n", what);
    exit(1);
}

static double cpu_ms(void) {
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return 1e3 * (double)used.tv_sec + 1e-6 * (double)used.tv_nsec;
}

static hpt_device *plug(unsigned rate) {
    hpt_device_def def = {.gadget = {.serial = "HP1", .speed = HP_USB_SUPER}, .maps = true, .rate = rate};
    hp_config_preset(&def.gadget.board.config, "ideal");
    def.gadget.board.threads = 1;
    return hpt_plug(&def);
}

/* ---- allocations by driver, bus and board, which are all in this program; libusb's are not ours ---- */

static unsigned allocations;

#if defined __SANITIZE_ADDRESS__ || defined __clang__ || !defined __GLIBC__
#define COUNTED 0
#else
#define COUNTED 1
extern const char __executable_start, etext;
void *__libc_malloc(size_t n);
void *__libc_calloc(size_t count, size_t n);
void *__libc_realloc(void *memory, size_t n);

static void count(const void *caller) {
    const char *at = caller;
    allocations += at >= &__executable_start && at < &etext;
}

void *malloc(size_t n) {
    count(__builtin_return_address(0));
    return __libc_malloc(n);
}

void *calloc(size_t count_of, size_t n) {
    count(__builtin_return_address(0));
    return __libc_calloc(count_of, n);
}

void *realloc(void *memory, size_t n) {
    count(__builtin_return_address(0));
    return __libc_realloc(memory, n);
}
#endif

/* ---- the plain loop ---- */

typedef struct plain {
    libusb_context *context;
    libusb_device_handle *handle;
    uint8_t *packet[1 + PACKETS]; /* HELLO, UPLOADs */
    size_t bytes[1 + PACKETS];
    struct libusb_transfer *out[1 + PACKETS], *in[INS];
    unsigned window, sent, answered, wanted, flying;
} plain;

static void seal(plain *p, unsigned i, hp_opcode opcode, uint32_t length) {
    const hp_header header = {
        .version = HP_PROTOCOL_VERSION, .opcode = (uint8_t)opcode, .tag = 1 + i, .length = length, .sequence = i};
    p->bytes[i] = hp_packet_seal(p->packet[i], &header);
}

static void seal_all(plain *p) {
    for (unsigned i = 0; i <= PACKETS; i++) {
        p->packet[i] = calloc(1, hp_packet_bytes(HP_PAYLOAD_MAX));
        must(p->packet[i] != NULL, "no memory");
        uint8_t *payload = p->packet[i] + HP_HEADER_BYTES;
        if (i == 0) {
            hp_put16(payload + HP_AT_HELLO_version_min, HP_PROTOCOL_VERSION);
            hp_put16(payload + HP_AT_HELLO_version_max, HP_PROTOCOL_VERSION);
            seal(p, i, HP_OPCODE_HELLO, HP_HELLO_FIXED);
            continue;
        }
        hp_put32(payload + HP_AT_UPLOAD_object, HP_TRIANGLE);
        hp_put32(payload + HP_AT_UPLOAD_first, (i - 1) * CHUNK);
        hp_put32(payload + HP_AT_UPLOAD_count, CHUNK);
        memcpy(payload + HP_UPLOAD_FIXED, triangles + (size_t)(i - 1) * CHUNK * 9, CHUNK * 36u); /* little endian */
        seal(p, i, HP_OPCODE_UPLOAD, HP_UPLOAD_FIXED + CHUNK * 36u);
    }
}

static void send_next(plain *p);

static void out_done(struct libusb_transfer *transfer) {
    plain *p = transfer->user_data;
    must(transfer->status == LIBUSB_TRANSFER_COMPLETED, "a packet was not sent");
    p->flying--;
}

static void in_done(struct libusb_transfer *transfer) {
    plain *p = transfer->user_data;
    hp_header header;
    const uint8_t *payload;
    must(transfer->status == LIBUSB_TRANSFER_COMPLETED, "nothing was received");
    must(hp_packet_open(transfer->buffer, (size_t)transfer->actual_length, &header, &payload) == HP_OK &&
             header.opcode != HP_OPCODE_ERROR,
         "the board refused a packet");
    p->answered++;
    must(libusb_submit_transfer(transfer) == 0, "cannot submit");
    send_next(p);
}

static void send_next(plain *p) {
    while (p->sent < p->wanted && p->sent - p->answered < p->window) {
        struct libusb_transfer *out = p->out[p->sent];
        libusb_fill_bulk_transfer(out, p->handle, HP_USB_OUT_ENDPOINT, p->packet[p->sent], (int)p->bytes[p->sent],
                                  out_done, p, 0);
        out->flags = LIBUSB_TRANSFER_ADD_ZERO_PACKET;
        must(libusb_submit_transfer(out) == 0, "cannot submit");
        p->sent++;
        p->flying++;
    }
}

/* Up to packet `until`, answered. */
static void run_plain(plain *p, unsigned until) {
    p->wanted = until;
    send_next(p);
    while (p->answered < until || p->flying) libusb_handle_events(p->context);
}

static void open_plain(plain *p) {
    static uint8_t room[INS][HP_USB_SUPER_PACKET];
    p->handle = libusb_open_device_with_vid_pid(p->context, HP_USB_VENDOR, HP_USB_PRODUCT);
    must(p->handle != NULL, "no board");
    must(libusb_claim_interface(p->handle, HP_USB_DATA_INTERFACE) == 0, "cannot claim");
    for (unsigned i = 0; i < INS; i++) {
        libusb_fill_bulk_transfer(p->in[i], p->handle, HP_USB_IN_ENDPOINT, room[i], sizeof room[i], in_done, p, 0);
        must(libusb_submit_transfer(p->in[i]) == 0, "cannot submit");
    }
    p->sent = p->answered = 0;
    run_plain(p, 1); /* HELLO */
}

static void close_plain(plain *p) {
    libusb_release_interface(p->handle, HP_USB_DATA_INTERFACE);
    libusb_close(p->handle);
}

/* ---- both ---- */

typedef struct figures {
    double ms[ROUNDS], cpu[ROUNDS];
    unsigned allocations; /* of the last round */
} figures;

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *of) {
    qsort(of, ROUNDS, sizeof *of, by_value);
    return of[ROUNDS / 2];
}

static void time_plain(plain *p, unsigned round, figures *f) {
    open_plain(p);
    allocations = 0;
    double start = hpt_now_ms(), used = cpu_ms();
    run_plain(p, 1 + PACKETS);
    f->ms[round] = hpt_now_ms() - start;
    f->cpu[round] = cpu_ms() - used;
    f->allocations = allocations;
    for (unsigned i = 0; i < INS; i++) libusb_cancel_transfer(p->in[i]);
    close_plain(p);
    for (unsigned i = 0; i < INS; i++) p->in[i] = libusb_alloc_transfer(0);
}

static unsigned time_driver(unsigned round, figures *f) {
    hp_device_def def = hp_default_device_def();
    hp_device *device;
    def.target = "usb";
    must(hp_open(&def, &device) == HP_OK, hp_error_message(NULL));
    unsigned window = hp_identify(device)->packet_buffers;
    /* buffers are there after the first */
    must(hp_upload(device, HP_TRIANGLE, triangles, TRIANGLES) == HP_OK, "upload");
    allocations = 0;
    double start = hpt_now_ms(), used = cpu_ms();
    must(hp_upload(device, HP_TRIANGLE, triangles, TRIANGLES) == HP_OK, "upload");
    f->ms[round] = hpt_now_ms() - start;
    f->cpu[round] = cpu_ms() - used;
    f->allocations = allocations;
    hp_close(device);
    return window;
}

static void compare(plain *p, const char *name, unsigned rate) {
    figures driver, loop;
    hpt_device *device = plug(rate);
    for (unsigned round = 0; round < ROUNDS; round++) {
        p->window = time_driver(round, &driver);
        time_plain(p, round, &loop);
    }
    hpt_discard(device);
    must(driver.allocations <= loop.allocations, "the driver allocates while packets go");
    double bytes = (double)PACKETS * (double)p->bytes[1], driver_ms = median(driver.ms), loop_ms = median(loop.ms);
    printf("%-16s driver %7.0f MB/s, processor %3.0f %%; plain loop %7.0f MB/s, processor %3.0f %%; driver / plain "
           "%.2f\n",
           name, 1e-3 * bytes / driver_ms, 100 * median(driver.cpu) / driver_ms, 1e-3 * bytes / loop_ms,
           100 * median(loop.cpu) / loop_ms, loop_ms / driver_ms);
}

int main(void) {
    plain p = {0};
    triangles = malloc((size_t)TRIANGLES * 36);
    must(triangles != NULL, "no memory");
    for (size_t i = 0; i < (size_t)TRIANGLES * 9; i++) triangles[i] = (float)(i % 1000);
    must(libusb_init(&p.context) == 0, "libusb_init");
    for (unsigned i = 0; i <= PACKETS; i++) p.out[i] = libusb_alloc_transfer(0);
    for (unsigned i = 0; i < INS; i++) p.in[i] = libusb_alloc_transfer(0);
    seal_all(&p);
    printf("%d UPLOAD packets of %zu bytes, medians of %d rounds\n", PACKETS, p.bytes[1], ROUNDS);
    compare(&p, "SuperSpeed", SUPERSPEED);
    compare(&p, "SuperSpeed+", SUPERSPEED_PLUS);
    compare(&p, "memory's pace", 0);
    if (COUNTED) puts("the driver allocated nothing while packets went: what was, the board did in both");
    for (unsigned i = 0; i <= PACKETS; i++) {
        libusb_free_transfer(p.out[i]);
        free(p.packet[i]);
    }
    libusb_exit(p.context);
    free(triangles);
    return 0;
}
