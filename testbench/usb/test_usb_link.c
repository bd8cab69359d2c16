/* The USB transport over a sound cable, through the real libusb: finding boards, the speeds, depths and sizes of
 * transfers, memory, whose loop waits, and what waiting costs. */
#include "driver/device.h"
#include "driver/transport/usb.h"
#include "rig.h"
#include <libusb.h>
#include <linux/usbdevice_fs.h>
#include <poll.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { RECORDS = 53 }; /* a RESULT of so many is a multiple of 512 bytes */

static rig *now; /* freed by tear_down whatever happens */

static int tear_down(void **state) {
    (void)state;
    rig_free(now);
    now = NULL;
    return 0;
}

static rig *straight(hp_usb_speed speed, unsigned records) {
    now = rig_new(speed, records, false);
    return now;
}

/* ---- finding ---- */

static void boards_are_listed(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    hp_usb_board *boards;
    size_t count;
    hp_message message;
    rig_plug(r, "HP1");
    hpt_device_def other = r->plug;
    other.gadget.serial = "HP2";
    other.gadget.speed = HP_USB_HIGH;
    other.denied = true;
    hpt_device *denied = hpt_plug(&other);
    other.gadget.vendor = 0x1234; /* nobody asked for it */
    hpt_device *stranger = hpt_plug(&other);
    assert_int_equal(hp_usb_list(&r->def, &boards, &count, &message), HP_OK);
    hpt_discard(denied);
    hpt_discard(stranger);
    assert_int_equal(count, 2);
    assert_string_equal(boards[0].serial, "HP1");
    assert_true(boards[0].product[0] != 0 && boards[0].error == 0);
    assert_int_equal(boards[0].vendor, 0x1209);
    assert_int_equal(boards[0].product_id, 1);
    assert_int_equal(boards[0].release, 0x100);
    assert_int_equal(boards[0].mbits, 5000);
    assert_int_equal(boards[0].bus, 1);
    assert_string_equal(boards[1].serial, "");
    assert_int_equal(boards[1].error, LIBUSB_ERROR_ACCESS);
    assert_int_equal(boards[1].mbits, 480);
    assert_true(boards[0].address < boards[1].address);
    free(boards);
}

static void refuses(rig *r, const char *target, const char *words) {
    r->def.target = target;
    assert_int_equal(rig_open(r), HP_ERROR_NO_DEVICE);
    assert_null(r->device);
    rig_says(NULL, words);
}

static void targets_name_boards(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    refuses(r, "usb", "no board on USB with the identifiers 1209:0001");
    rig_plug(r, "HP1");
    refuses(r, "usb:HP2", "1209:0001 and the serial number HP2; there are usb:HP1");
    hpt_device_def other = r->plug;
    other.gadget.serial = "HP2";
    hpt_device *second = hpt_plug(&other);
    refuses(r, "usb", "2 boards on USB, say which: usb:HP1, usb:HP2");
    r->def.target = "usb:HP2";
    assert_int_equal(rig_open(r), HP_OK);
    assert_string_equal(hp_identify(r->device)->serial, "HP2");
    assert_string_equal(hp_identify(r->device)->target, "usb");
    assert_string_equal(hp_identify(r->device)->engine, "hardware");
    assert_string_equal(hp_identify(r->device)->isa, "");
    rig_close(r);
    hpt_discard(second);
    r->def.target = "usb";
    assert_int_equal(rig_open(r), HP_OK);
    assert_string_equal(hp_identify(r->device)->serial, "HP1");
}

static void other_identifiers(void **state) {
    (void)state;
    rig *r = straight(HP_USB_HIGH, RECORDS);
    r->plug.gadget.vendor = 0xABCD;
    r->plug.gadget.product = 0x4321;
    rig_plug(r, "HP1");
    refuses(r, "usb", "no board on USB with the identifiers 1209:0001");
    r->def.usb_vendor = 0xABCD;
    r->def.usb_product = 0x4321;
    r->def.target = "usb:HP1";
    assert_int_equal(rig_open(r), HP_OK);
    assert_int_equal(rig_upload(r), HP_OK);
    rig_check_usable(r);
}

static void no_permission(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->plug.denied = true;
    rig_plug(r, "HP1");
    refuses(r, "usb", "no permission; put the udev rule 60-hitpipe.rules");
    refuses(r, "usb:HP1", "60-hitpipe.rules");
    rig_says(NULL, "bus 1, address ");
    hpt_device_def other = r->plug;
    other.denied = false;
    other.gadget.serial = "HP2";
    hpt_device *second = hpt_plug(&other);
    refuses(r, "usb", "2 boards on USB, say which: one at bus 1, address ");
    rig_says(NULL, "(no permission), usb:HP2");
    hpt_discard(second);
    hpt_deny(r->board, false);
    r->def.target = "usb";
    assert_int_equal(rig_open(r), HP_OK);
}

static void interface_busy(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    rig_begin(r);
    hp_device *first = r->device;
    r->device = NULL;
    refuses(r, "usb:HP1", "board HP1 is busy: another program has its data interface");
    r->device = first;
    rig_check_usable(r); /* who has it was not disturbed */
    rig_close(r);
    assert_int_equal(rig_open(r), HP_OK);
}

static void several_boards_at_once(void **state) {
    (void)state;
    enum { BOARDS = 3 };
    rig *r = straight(HP_USB_SUPER, RECORDS);
    hpt_device *boards[BOARDS];
    hp_device *devices[BOARDS];
    hp_result results[BOARDS][RIG_RAYS];
    const char *serials[BOARDS] = {"A", "B", "C"}, *targets[BOARDS] = {"usb:A", "usb:B", "usb:C"};
    hp_query_def query = hp_default_query_def();
    r->plug.gadget.board.config = r->config;
    for (unsigned i = 0; i < BOARDS; i++) {
        hpt_device_def def = r->plug;
        def.gadget.serial = serials[i];
        def.gadget.speed = i % 2 ? HP_USB_HIGH : HP_USB_SUPER;
        boards[i] = hpt_plug(&def);
    }
    for (unsigned i = 0; i < BOARDS; i++) {
        r->def.target = targets[i];
        assert_int_equal(hp_open(&r->def, &devices[i]), HP_OK);
        assert_string_equal(hp_identify(devices[i])->serial, serials[i]);
        assert_int_equal(hp_upload(devices[i], HP_TRIANGLE, r->triangles[0], RIG_TRIANGLES), HP_OK);
    }
    for (unsigned i = 0; i < BOARDS; i++)
        assert_int_equal(hp_query(devices[i], &query, r->rays[0], RIG_RAYS, results[i]), HP_OK);
    for (unsigned i = 0; i < BOARDS; i++) {
        rig_check_closest(r, results[i], RIG_RAYS);
        hp_close(devices[i]);
        hpt_discard(boards[i]);
    }
}

/* ---- transfers ---- */

/* Packets that are a multiple of wMaxPacketSize end with a zero-length USB packet, in both directions: the upload of
 * 27 triangles has 1024 bytes, a RESULT of 53 records 1536, one of 181 5120. */
static void works_with(hp_usb_speed speed, unsigned records, unsigned depth, unsigned transfer, unsigned caps) {
    rig *r = straight(speed, records);
    r->def.usb_depth = depth;
    r->def.usb_transfer = transfer;
    r->def.timeout_ms = 2000;
    r->def.retries = 0; /* nothing is lost, so nothing is sent again */
    r->plug.caps = caps;
    rig_begin(r);
    rig_check_usable(r);
    assert_int_equal(r->device->queue.counts.again, 0);
    assert_int_equal(r->device->queue.counts.damaged, 0);
    rig_close(r);
    assert_int_equal(hpt_counts(r->board).files, 0);
    tear_down(NULL);
}

static void both_speeds_and_all_sizes(void **state) {
    (void)state;
    static const unsigned depths[] = {1, 2, 4, HP_USB_DEPTH_MAX}, transfers[] = {0, 1024, 2048, 5120, 1u << 20};
    static const hp_usb_speed speeds[] = {HP_USB_HIGH, HP_USB_SUPER};
    static const unsigned records[] = {7, 53, 181};
    for (unsigned i = 0; i < 2; i++)
        for (unsigned k = 0; k < 4; k++)
            for (unsigned m = 0; m < 5; m++)
                for (unsigned n = 0; n < 3; n++) works_with(speeds[i], records[n], depths[k], transfers[m], 0);
}

/* Kernels whose host controller wants memory in one piece: libusb cuts transfers into urbs of 16 KiB. */
static void old_kernels(void **state) {
    (void)state;
    works_with(HP_USB_HIGH, RECORDS, 4, 0, USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM);
    works_with(HP_USB_SUPER, RECORDS, 4, 0, USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM);
}

enum { MANY = 60000 };

typedef struct stream {
    const rig *r;
    size_t records;
} stream;

static bool take_many(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                      size_t count) {
    stream *s = context;
    for (size_t i = 0; i < count; i++) {
        hp_result truth = s->r->all[primary[i]][secondary[i] % RIG_TRIANGLES];
        if (truth.F) truth.index = secondary[i];
        assert_memory_equal(&records[i], &truth, sizeof truth);
    }
    s->records += count;
    return true;
}

/* The largest packets there are: an upload of more triangles than fit in one, and all their records. */
static void largest_packets(hp_usb_speed speed, unsigned transfer) {
    rig *r = straight(speed, 16384);
    r->def.usb_transfer = transfer;
    r->def.retries = 0;
    rig_begin(r);
    float *triangles = malloc(MANY * sizeof *r->triangles);
    assert_non_null(triangles);
    for (size_t i = 0; i < MANY; i++)
        memcpy(triangles + 9 * i, r->triangles[i % RIG_TRIANGLES], sizeof *r->triangles);
    assert_int_equal(hp_upload(r->device, HP_TRIANGLE, triangles, MANY), HP_OK);
    free(triangles);
    hp_query_def def = hp_default_query_def();
    stream s = {.r = r};
    def.mode = HP_MODE_ALL;
    def.separation = HP_SEPARATION_OFF;
    assert_int_equal(hp_query_all(r->device, &def, r->rays[0], 3, take_many, &s), HP_OK);
    assert_int_equal(s.records, 3 * MANY);
    assert_int_equal(r->device->queue.counts.again, 0);
    tear_down(NULL);
}

static void packets_of_half_a_mebibyte(void **state) {
    (void)state;
    largest_packets(HP_USB_HIGH, 0);
    largest_packets(HP_USB_SUPER, 0);
    largest_packets(HP_USB_SUPER, 65536);
}

/* A packet of 512 KiB ends with a zero-length USB packet, which belongs to it: it is not taken for a packet of its
 * own. */
typedef struct received {
    size_t moved[4];
    unsigned count;
} received;

static void note_received(hp_transfer *transfer) {
    received *all = transfer->owner;
    assert_int_equal(transfer->status, HP_OK);
    if (transfer->in) all->moved[all->count++] = transfer->moved;
}

static void forget(hp_transfer *transfer) {
    (void)transfer;
}

static hpt_fault grow_the_first(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    (void)context, (void)bytes, (void)n;
    return in && number == 0 ? (hpt_fault){HPT_FAULT_GROW, 512 * 1024} : (hpt_fault){0};
}

static size_t make_hello(uint8_t *packet, uint32_t tag) {
    const hp_header header = {
        .version = HP_PROTOCOL_VERSION, .opcode = HP_OPCODE_HELLO, .tag = tag, .length = HP_HELLO_FIXED};
    uint8_t *payload = packet + HP_HEADER_BYTES;
    hp_put16(payload + HP_AT_HELLO_version_min, HP_PROTOCOL_VERSION);
    hp_put16(payload + HP_AT_HELLO_version_max, HP_PROTOCOL_VERSION);
    return hp_packet_seal(packet, &header);
}

static void the_largest_packet_there_is(hp_usb_speed speed, unsigned transfer) {
    enum { REPLY = HP_HEADER_BYTES + HP_HELLO_REPLY_FIXED + HP_CRC_BYTES };
    uint8_t hello[2][64] = {{0}};
    received all = {0};
    hp_transfer in[3], out[2];
    hp_transport *link;
    hp_message message;
    rig *r = straight(speed, RECORDS);
    r->plug.choose = grow_the_first;
    r->def.usb_transfer = transfer;
    rig_plug(r, "HP1");
    assert_int_equal(hp_transport_usb(&r->def, NULL, &link, &message), HP_OK);
    size_t room = link->ops->in_room(link);
    for (unsigned i = 0; i < 3; i++) {
        in[i] = (hp_transfer){
            .bytes = link->ops->allocate(link, room), .room = room, .done = note_received, .owner = &all};
        assert_int_equal(link->ops->submit_in(link, &in[i]), HP_OK);
    }
    for (unsigned i = 0; i < 2; i++) {
        out[i] =
            (hp_transfer){.bytes = hello[i], .room = make_hello(hello[i], i), .done = note_received, .owner = &all};
        assert_int_equal(link->ops->submit_out(link, &out[i]), HP_OK);
    }
    for (unsigned completed; link->ops->poll(link, 50, &completed) == HP_OK;) continue;
    assert_int_equal(all.count, 2);
    assert_int_equal(all.moved[0], 512 * 1024);
    assert_int_equal(all.moved[1], REPLY);
    in[2].done = forget;
    link->ops->close(link);
    tear_down(NULL);
}

static void packets_of_512_kib_end_in_their_transfer(void **state) {
    (void)state;
    static const unsigned transfers[] = {0, 4096, 1u << 20};
    for (unsigned i = 0; i < 3; i++) {
        the_largest_packet_there_is(HP_USB_HIGH, transfers[i]);
        the_largest_packet_there_is(HP_USB_SUPER, transfers[i]);
    }
}

static void several_transfers_are_under_way(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->def.usb_depth = 5;
    rig_begin(r);
    rig_check_usable(r);
    hpt_bus_counts counts = hpt_counts(r->board);
    assert_true(counts.in_flight_most >= 6 && counts.in_flight_most <= 10); /* five to the host, some to the board */
}

/* ---- memory ---- */

static void the_kernels_memory_is_used(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    rig_begin(r);
    hpt_bus_counts before = hpt_counts(r->board);
    rig_check_usable(r);
    hpt_bus_counts after = hpt_counts(r->board);
    assert_true(after.urbs > before.urbs + 10);
    assert_int_equal(after.mapped - before.mapped, after.urbs - before.urbs); /* every one */
}

static void no_memory_of_the_kernels(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->plug.maps = false;
    rig_begin(r);
    rig_check_usable(r);
    assert_int_equal(hpt_counts(r->board).mapped, 0);
}

/* usbcore.usbfs_memory_mb is full but for a bit: transfers wait for each other, and all is well. */
static void little_memory_for_urbs(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->plug.memory = 1300 * 1024; /* two transfers to the host of the four, and a packet */
    rig_begin(r);
    rig_check_usable(r);
    assert_true(hpt_counts(r->board).memory_most <= r->plug.memory);
}

static void no_memory_for_urbs(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->plug.memory = 100 * 1024; /* enough to ask who it is */
    r->def.timeout_ms = 100;
    r->def.retries = 1;
    rig_plug(r, "HP1");
    assert_int_equal(rig_open(r), HP_ERROR_MEMORY);
    rig_says(NULL, "out of memory");
}

/* ---- what an earlier program left ---- */

static bool give_up(void *context, uint64_t done, uint64_t total) {
    (void)total;
    return !*(bool *)context || done == 0;
}

/* Answers that nobody fetched wait in the board, and survive that the interface is set. */
static void stale_packets_are_drained(void **state) {
    (void)state;
    bool stop = false;
    hp_result results[RIG_RAYS];
    now = rig_new(HP_USB_SUPER, RECORDS, true);
    now->plug.keeps = true;
    now->def.usb_depth = 1;
    now->def.progress = give_up;
    now->def.progress_context = &stop;
    rig_begin(now);
    hpt_delay(now->board, 60000); /* longer than progress is silent */
    stop = true;
    assert_int_equal(rig_ask_closest(now, results), HP_ERROR_CANCELLED);
    rig_close(now); /* with answers on their way */
    hpt_delay(now->board, 0);
    stop = false;
    assert_int_equal(rig_open(now), HP_OK);
    assert_int_equal(now->device->queue.counts.dropped, 0);
    assert_int_equal(now->device->queue.counts.damaged, 0);
    assert_int_equal(rig_upload(now), HP_OK);
    rig_check_usable(now);
    assert_int_equal(now->device->queue.counts.dropped, 0);
}

/* ---- whose loop waits ---- */

typedef struct loop {
    unsigned rounds, with_files, without;
} loop;

static void run_loop(void *context, const hp_wait_file *files, size_t count, unsigned timeout_ms) {
    loop *l = context;
    struct pollfd polled[16];
    assert_true(count <= 16);
    for (size_t i = 0; i < count; i++) polled[i] = (struct pollfd){.fd = files[i].fd, .events = files[i].events};
    poll(polled, count, (int)timeout_ms);
    l->rounds++;
    l->with_files += count > 0;
    l->without += count == 0;
}

static void a_loop_of_the_users(void **state) {
    (void)state;
    loop l = {0};
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->def.wait = run_loop;
    r->def.wait_context = &l;
    rig_begin(r);
    hpt_delay(r->board, 1000);
    l = (loop){0};
    rig_check_usable(r);
    assert_true(l.rounds > 10 && l.with_files == l.rounds);
}

typedef struct handler {
    libusb_context *context;
    pthread_t thread;
    bool stop;
    unsigned rounds;
} handler;

static void *handle_events(void *argument) {
    handler *h = argument;
    while (!__atomic_load_n(&h->stop, __ATOMIC_ACQUIRE)) {
        struct timeval most = {.tv_usec = 50000};
        libusb_handle_events_timeout(h->context, &most);
        h->rounds++;
    }
    return NULL;
}

/* Another thread handles the events of the user's context, all the time. */
static void a_thread_of_the_users(void **state) {
    (void)state;
    handler h = {0};
    rig *r = straight(HP_USB_SUPER, RECORDS);
    assert_int_equal(libusb_init(&h.context), 0);
    assert_int_equal(pthread_create(&h.thread, NULL, handle_events, &h), 0);
    r->def.usb_context = h.context;
    rig_begin(r);
    hpt_delay(r->board, 300);
    for (unsigned i = 0; i < 5; i++) rig_check_usable(r);
    rig_close(r);
    assert_int_equal(rig_open(r), HP_OK); /* the context is still good */
    rig_close(r);
    __atomic_store_n(&h.stop, true, __ATOMIC_RELEASE);
    libusb_interrupt_event_handler(h.context);
    pthread_join(h.thread, NULL);
    libusb_exit(h.context);
    assert_true(h.rounds > 5);
}

static void a_context_of_the_users_alone(void **state) {
    (void)state;
    libusb_context *context;
    loop l = {0};
    rig *r = straight(HP_USB_SUPER, RECORDS);
    assert_int_equal(libusb_init(&context), 0);
    r->def.usb_context = context;
    r->def.wait = run_loop;
    r->def.wait_context = &l;
    rig_begin(r);
    hpt_delay(r->board, 500);
    rig_check_usable(r);
    rig_close(r);
    libusb_exit(context);
    assert_true(l.with_files > 5);
}

/* A file that is open already, as Android and sandboxes hand it over. */
static void a_wrapped_file(void **state) {
    (void)state;
    libusb_context *context;
    libusb_device_handle *handle;
    hp_transport *transport;
    hp_message message;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    rig_plug(r, "HP1");
    int fd = hpt_open(r->board);
    assert_int_equal(libusb_init(&context), 0);
    assert_int_equal(libusb_wrap_sys_device(context, fd, &handle), 0);
    assert_int_equal(hp_transport_usb_wrap(&r->def, context, handle, &transport, &message), HP_OK);
    assert_string_equal(hp_transport_usb_serial(transport), "HP1");
    assert_int_equal(hp_open_transport(&r->def, transport, &r->device, &message), HP_OK);
    assert_int_equal(rig_upload(r), HP_OK);
    rig_check_usable(r);
    rig_close(r);
    close(fd);
    libusb_exit(context);
}

/* ---- the log ---- */

static unsigned log_lines; /* libusb gives its callback no context */

static void take_log(struct libusb_context *context, unsigned level, const char *text) {
    assert_non_null(context);
    assert_true(level <= 2 && strstr(text, "libusb"));
    log_lines++;
}

static void the_log_goes_to_the_callback(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->plug.denied = true;
    r->def.usb_log = take_log;
    rig_plug(r, "HP1");
    log_lines = 0;
    assert_int_equal(rig_open(r), HP_ERROR_NO_DEVICE);
    assert_true(log_lines > 0);
}

/* ---- what waiting costs ---- */

static double cpu_ms(void) {
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return 1e3 * (double)used.tv_sec + 1e-6 * (double)used.tv_nsec;
}

static bool never_mind(void *context, uint64_t done, uint64_t total) {
    (void)done, (void)total;
    ++*(unsigned *)context;
    return true;
}

/* A board that takes 100 ms for each answer: the processor has next to nothing to do meanwhile. */
static void a_slow_board_costs_nothing(void **state) {
    (void)state;
    unsigned told = 0;
    hp_result results[RIG_RAYS];
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->def.progress = never_mind;
    r->def.progress_context = &told;
    rig_begin(r);
    hpt_delay(r->board, 100000);
    told = 0;
    double start = hpt_now_ms(), used = cpu_ms();
    assert_int_equal(rig_ask_closest(r, results), HP_OK);
    double elapsed = hpt_now_ms() - start;
    used = cpu_ms() - used;
    printf("waited %.0f ms for a slow board with %.2f ms of processor time\n", elapsed, used);
    assert_true(elapsed > 200);
    assert_true(used < 0.02 * elapsed);
    assert_true(told > 3); /* and the program is kept informed */
}

/* ---- signals ---- */

static unsigned alarms;

static void take_alarm(int signal) {
    (void)signal;
    alarms++;
}

/* A signal ends a wait early, and nothing else. */
static void signals_do_no_harm(void **state) {
    (void)state;
    rig *r = straight(HP_USB_SUPER, RECORDS);
    r->def.retries = 0;
    rig_begin(r);
    hpt_delay(r->board, 20000);
    const struct sigaction ours = {.sa_handler = take_alarm};
    struct sigaction before;
    const struct itimerval often = {.it_interval = {.tv_usec = 2000}, .it_value = {.tv_usec = 2000}}, never = {0};
    sigaction(SIGALRM, &ours, &before);
    setitimer(ITIMER_REAL, &often, NULL);
    rig_check_usable(r);
    setitimer(ITIMER_REAL, &never, NULL);
    sigaction(SIGALRM, &before, NULL);
    assert_true(alarms > 10);
}

#define EACH_TEST(name) cmocka_unit_test_teardown(name, tear_down)
#define HPT_TEST(program, name, words, outcome) HPT_OF_##program(name)
#define HPT_OF_test_usb_faults(name)
#define HPT_OF_test_usb_link(name) EACH_TEST(name),
#define HPT_OF_test_usb_reconnect(name)
#define HPT_OF_test_usb_soak(name)
#define HPT_OF_test_usb_hid(name)

int main(void) {
    const struct CMUnitTest tests[] = {
#include "fault_tests.def"
        EACH_TEST(boards_are_listed),
        EACH_TEST(targets_name_boards),
        EACH_TEST(other_identifiers),
        EACH_TEST(several_boards_at_once),
        EACH_TEST(both_speeds_and_all_sizes),
        EACH_TEST(old_kernels),
        EACH_TEST(packets_of_half_a_mebibyte),
        EACH_TEST(packets_of_512_kib_end_in_their_transfer),
        EACH_TEST(several_transfers_are_under_way),
        EACH_TEST(stale_packets_are_drained),
        EACH_TEST(signals_do_no_harm),
        EACH_TEST(the_kernels_memory_is_used),
        EACH_TEST(no_memory_of_the_kernels),
        EACH_TEST(a_loop_of_the_users),
        EACH_TEST(a_thread_of_the_users),
        EACH_TEST(a_context_of_the_users_alone),
        EACH_TEST(a_wrapped_file),
        EACH_TEST(the_log_goes_to_the_callback),
        EACH_TEST(a_slow_board_costs_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
