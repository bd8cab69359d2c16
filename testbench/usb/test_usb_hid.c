/* The control plane through the real hidapi, its libusb back end, beside the packets of the same board: both are
 * asked at a time, and whatever happens to the one or the cable, the other says what is true. */
#include "rig.h"
#include <hidapi.h>
#include <hitpipe/control.h>
#include <hitpipe/packet.h>
#include <hitpipe/usb.h>
#include <linux/usbdevice_fs.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { PACKETS = (RIG_RAYS + RIG_PACKET - 1) / RIG_PACKET, PATIENCE_MS = 5000, ASKED = 100 };

static void says(const hp_control *control, const char *words) {
    if (!strstr(hp_control_message(control), words)) fail_msg("no \"%s\" in: %s", words, hp_control_message(control));
}

static hp_control *open_control(const char *serial) {
    hp_control_def def = hp_default_control_def();
    hp_control *control;
    def.serial = serial;
    hp_status status = hp_control_open(&def, &control);
    if (status) fail_msg("status %d: %s", status, hp_control_message(NULL));
    return control;
}

static void cannot_open(const char *words) {
    hp_control_def def = hp_default_control_def();
    hp_control *control;
    assert_int_equal(hp_control_open(&def, &control), HP_ERROR_NO_DEVICE);
    assert_null(control);
    says(NULL, words);
}

static hp_control_health health_of(hp_control *control) {
    hp_control_health health;
    assert_int_equal(hp_control_read_health(control, &health), HP_OK);
    return health;
}

/* ---- a board and its control ---- */

static struct {
    rig *r;
    hp_control *control;
    atomic_bool end;
    atomic_uint asked;
} b;

static int put_up(void **state) {
    memset(&b, 0, sizeof b);
    b.r = rig_new((hp_usb_speed) * (const unsigned *)*state, RIG_PACKET, false);
    rig_begin(b.r);
    b.control = open_control(NULL);
    return 0;
}

static int take_down(void **state) {
    (void)state;
    hp_control_close(b.control);
    rig_free(b.r);
    return 0;
}

static void close_control(void) {
    hp_control_close(b.control);
    b.control = NULL;
}

static void ask(void) {
    hp_result results[RIG_RAYS];
    assert_int_equal(rig_ask_closest(b.r, results), HP_OK);
    rig_check_closest(b.r, results, RIG_RAYS);
}

/* ---- what a sound board answers ---- */

static void boards_are_listed(void **state) {
    (void)state;
    hp_control_def def = hp_default_control_def();
    hp_control_board boards[4];
    size_t count;
    assert_int_equal(hp_control_list(&def, boards, 4, &count), HP_OK);
    assert_int_equal(count, 0);
    cannot_open("no board is plugged in");
    hpt_device_def plug = {.gadget = {.serial = "HP2", .speed = HP_USB_SUPER}};
    hp_config_preset(&plug.gadget.board.config, "usb3");
    hpt_device *second = hpt_plug(&plug);
    plug.gadget.serial = "HP1";
    hpt_device *first = hpt_plug(&plug);
    assert_int_equal(hp_control_list(&def, boards, 4, &count), HP_OK);
    assert_int_equal(count, 2);
    assert_string_equal(boards[0].serial, "HP1");
    assert_string_equal(boards[0].path, "1-2:1.1");
    assert_string_equal(boards[1].serial, "HP2");
    assert_string_equal(boards[1].path, "1-1:1.1");
    cannot_open("HP1");
    hp_control *control = open_control("HP2");
    assert_string_equal(hp_control_identify(control)->serial, "HP2");
    hp_control_close(control);
    hpt_discard(first);
    hpt_discard(second);
}

static void a_board_says_who_and_how_it_is(void **state) {
    (void)state;
    const hp_control_identity *identity = hp_control_identify(b.control);
    assert_int_equal(identity->protocol, HP_PROTOCOL_VERSION);
    assert_string_equal(identity->serial, hp_identify(b.r->device)->serial);
    assert_string_equal(identity->name, b.r->config.name);
    assert_int_equal(identity->clock_hz, b.r->config.clock_hz);
    hp_control_health before = health_of(b.control);
    assert_true(before.session);
    assert_int_equal(before.speed, b.r->plug.gadget.speed);
    ask();
    hp_control_health after = health_of(b.control);
    assert_int_equal(after.packets, before.packets + PACKETS);
    assert_int_equal(after.refused, 0);
}

/* What happened before the control was opened may come first. */
static void every_packet_is_an_event(void **state) {
    (void)state;
    hp_control_event event;
    while (hp_control_next_event(b.control, 50, &event) == HP_OK) continue;
    ask();
    for (unsigned i = 0; i < PACKETS; i++) {
        assert_int_equal(hp_control_next_event(b.control, PATIENCE_MS, &event), HP_OK);
        assert_int_equal(event.kind, HP_USB_EVENT_PACKET_DONE);
        assert_int_equal(event.status, HP_OK);
        assert_int_equal(event.lost, 0);
    }
    assert_int_equal(hp_control_next_event(b.control, 20, &event), HP_ERROR_TIMEOUT);
}

static void *keep_asking(void *argument) {
    (void)argument;
    hp_control_health health;
    while (!atomic_load(&b.end) && hp_control_read_health(b.control, &health) == HP_OK) atomic_fetch_add(&b.asked, 1);
    return NULL;
}

static void both_answer_at_a_time(void **state) {
    (void)state;
    pthread_t thread;
    unsigned queries = 0;
    uint64_t before = health_of(b.control).packets;
    double start = hpt_now_ms();
    assert_int_equal(pthread_create(&thread, NULL, keep_asking, NULL), 0);
    for (; atomic_load(&b.asked) < ASKED && hpt_now_ms() - start < PATIENCE_MS; queries++) ask();
    atomic_store(&b.end, true);
    pthread_join(thread, NULL);
    assert_true(atomic_load(&b.asked) >= ASKED && queries > 1);
    assert_int_equal(health_of(b.control).packets, before + queries * PACKETS);
}

/* ---- commands ---- */

static void a_reset_ends_the_session(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    assert_int_equal(hp_control_reset(b.control), HP_OK);
    hp_control_health health = health_of(b.control);
    assert_false(health.session);
    assert_int_equal(health.resets, 1);
    assert_int_equal(rig_ask_closest(b.r, results), HP_ERROR_SEQUENCE);
    rig_says(b.r->device, "the board was reset");
    rig_close(b.r);
    assert_int_equal(rig_open(b.r), HP_OK);
    assert_int_equal(rig_upload(b.r), HP_OK);
    rig_check_usable(b.r);
}

static void an_abort_leaves_it(void **state) {
    (void)state;
    assert_int_equal(hp_control_abort(b.control), HP_OK);
    assert_true(health_of(b.control).session);
    ask();
}

static void the_clock_is_chosen(void **state) {
    (void)state;
    assert_int_equal(hp_control_set_clock(b.control, 1), HP_ERROR_FIELD);
    says(b.control, "refused CLOCK 1");
    assert_int_equal(hp_control_set_clock(b.control, 125000000), HP_OK);
    rig_close(b.r);
    assert_int_equal(rig_open(b.r), HP_OK); /* from the next session on */
    assert_int_equal(hp_control_read_identity(b.control), HP_OK);
    assert_int_equal(hp_control_identify(b.control)->clock_hz, 125000000);
}

/* ---- the cable ---- */

static void *pull_soon(void *argument) {
    nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    hpt_pull(argument);
    return NULL;
}

/* And is back under another address: a control of before stays lost. */
static void unplugged_while_events_are_awaited(void **state) {
    (void)state;
    pthread_t thread;
    hp_control_event event;
    while (hp_control_next_event(b.control, 50, &event) == HP_OK) continue;
    assert_int_equal(pthread_create(&thread, NULL, pull_soon, b.r->board), 0);
    double start = hpt_now_ms();
    assert_int_equal(hp_control_next_event(b.control, PATIENCE_MS, &event), HP_ERROR_DISCONNECTED);
    says(b.control, "board HP1 (1-1:1.1) was unplugged");
    assert_true(hpt_now_ms() - start < 1000);
    pthread_join(thread, NULL);
    hpt_push(b.r->board);
    assert_int_equal(hp_control_next_event(b.control, 0, &event), HP_ERROR_DISCONNECTED);
    close_control();
    b.control = open_control("HP1");
    assert_false(health_of(b.control).session);
    rig_close(b.r);
}

/* Requests fail for a while before the kernel notices that a cable was pulled; that is no refusal of the board. */
static void unplugged_slowly(void **state) {
    (void)state;
    hp_control_health health;
    hpt_pull_slowly(b.r->board, 200);
    double start = hpt_now_ms();
    assert_int_equal(hp_control_read_health(b.control, &health), HP_ERROR_DISCONNECTED);
    says(b.control, "was unplugged");
    double took = hpt_now_ms() - start;
    assert_true(took >= 150 && took < 1000);
    rig_close(b.r);
}

static void another_program_has_the_interface(void **state) {
    (void)state;
    close_control();
    int other = hpt_open(b.r->board);
    unsigned interface = HP_USB_HID_INTERFACE;
    assert_int_equal(ioctl(other, USBDEVFS_CLAIMINTERFACE, &interface), 0);
    cannot_open("another program holds its HID interface");
    rig_check_usable(b.r);
    close(other);
    b.control = open_control("HP1");
}

static void without_permission_the_rule_is_named(void **state) {
    (void)state;
    close_control();
    hpt_deny(b.r->board, true);
    cannot_open("no permission");
    says(NULL, "/dev/bus/usb/001/");
    says(NULL, "60-hitpipe.rules");
    rig_check_usable(b.r); /* who has it open keeps it */
    hpt_deny(b.r->board, false);
    b.control = open_control("HP1");
}

static int leave_hidapi(void **state) {
    (void)state;
    return hid_exit();
}

#define BOTH(name)                                                                                                   \
    {#name ", high speed", name, put_up, take_down, &speeds[0]},                                                     \
        {#name ", SuperSpeed", name, put_up, take_down, &speeds[1]},
#define HPT_TEST(program, name, words, outcome) HPT_OF_##program(name)
#define HPT_OF_test_usb_faults(name)
#define HPT_OF_test_usb_link(name)
#define HPT_OF_test_usb_reconnect(name)
#define HPT_OF_test_usb_soak(name)
#define HPT_OF_test_usb_hid(name) BOTH(name)

int main(void) {
    static unsigned speeds[] = {HP_USB_HIGH, HP_USB_SUPER};
    const struct CMUnitTest tests[] = {
        BOTH(a_board_says_who_and_how_it_is) BOTH(every_packet_is_an_event) BOTH(both_answer_at_a_time)
            BOTH(an_abort_leaves_it) BOTH(the_clock_is_chosen)
#include "fault_tests.def"
                cmocka_unit_test(boards_are_listed),
    };
    return cmocka_run_group_tests(tests, NULL, leave_hidapi);
}
