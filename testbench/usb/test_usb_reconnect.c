/* Boards that are pulled off the bus, or reset, and come back: the call goes on as if nothing had been, or ends in an
 * error that says how far it came. Through the real libusb, its enumeration and its hotplug. */
#include "driver/device.h"
#include "rig.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { RECORDS = 53, OUT = 0, IN = 1, TIMEOUT_MS = 60, BACK_MS = 2, AWAIT_MS = 3000 };

static rig *now; /* freed by tear_down whatever happens */

static int tear_down(void **state) {
    (void)state;
    rig_free(now);
    now = NULL;
    return 0;
}

static rig *patient(unsigned reconnect_ms) {
    now = rig_new(HP_USB_SUPER, RECORDS, true);
    now->def.timeout_ms = TIMEOUT_MS;
    now->def.reconnect_ms = reconnect_ms;
    rig_begin(now);
    return now;
}

/* ---- it comes back ---- */

/* A query has eight packets to the board and eight to the host. */
static void replug_in_a_query(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig *r = patient(AWAIT_MS);
    for (unsigned in = 0; in < 2; in++)
        for (unsigned packet = 0; packet < 8; packet++) {
            unsigned before = hp_reconnections(r->device);
            rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, in, packet, 1);
            assert_int_equal(rig_ask_closest(r, results), HP_OK);
            assert_int_equal(r->plan.faults, 1);
            assert_int_equal(hp_completed(r->device), RIG_RAYS);
            assert_int_equal(hp_reconnections(r->device), before + 1);
            rig_check_closest(r, results, RIG_RAYS);
        }
    rig_check_usable(r);
}

/* With eight to the board and 38 to the host: five for eight primaries, three for the last four. */
static void replug_in_mode_all(void **state) {
    (void)state;
    rig_tally tally;
    rig *r = patient(AWAIT_MS);
    for (unsigned in = 0; in < 2; in++)
        for (unsigned packet = 0; packet < (in ? 38 : 8); packet += in ? 3 : 1) {
            rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, in, packet, 1);
            assert_int_equal(rig_ask_all(r, &tally), HP_OK);
            assert_int_equal(r->plan.faults, 1);
            rig_check_all(r, &tally);
        }
    rig_check_usable(r);
}

static void replug_in_an_upload(void **state) {
    (void)state;
    rig *r = patient(AWAIT_MS);
    for (unsigned in = 0; in < 2; in++) {
        rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, in, 0, 1);
        assert_int_equal(rig_upload(r), HP_OK);
        assert_int_equal(r->plan.faults, 1);
        rig_check_usable(r);
    }
    assert_int_equal(hp_reconnections(r->device), 2);
}

static void replug_with_a_matrix(void **state) {
    (void)state;
    const float matrix[12] = {1, 0, 0, 0.25f, 0, 1, 0, -0.5f, 0, 0, 1, 0.125f};
    hp_result moved[RIG_RAYS], results[RIG_RAYS];
    rig *r = patient(AWAIT_MS);
    assert_int_equal(hp_transform(r->device, matrix), HP_OK);
    assert_int_equal(rig_ask_closest(r, moved), HP_OK);
    assert_memory_not_equal(moved, r->closest, sizeof moved);
    for (unsigned in = 0; in < 2; in++) {
        rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, in, 3, 1);
        assert_int_equal(rig_ask_closest(r, results), HP_OK);
        assert_memory_equal(results, moved, sizeof moved);
        rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, in, 0, 1); /* while the matrix is set, too */
        assert_int_equal(hp_transform(r->device, matrix), HP_OK);
        assert_int_equal(rig_ask_closest(r, results), HP_OK);
        assert_memory_equal(results, moved, sizeof moved);
    }
    assert_int_equal(hp_reconnections(r->device), 4);
}

static void replug_between_calls(void **state) {
    (void)state;
    rig *r = patient(AWAIT_MS);
    hpt_pull(r->board);
    hpt_push(r->board);
    rig_check_usable(r);
    assert_int_equal(hp_reconnections(r->device), 1);
    hpt_pull(r->board);
    hpt_push(r->board);
    assert_int_equal(rig_upload(r), HP_OK);
    rig_check_usable(r);
}

static void reset_in_a_query(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig_tally tally;
    rig *r = patient(AWAIT_MS);
    for (unsigned in = 0; in < 2; in++)
        for (unsigned packet = 0; packet < 7; packet++) {
            rig_fault(r, HPT_FAULT_RESET, 0, in, packet, 1);
            assert_int_equal(rig_ask_closest(r, results), HP_OK);
            assert_int_equal(r->plan.faults, 1);
            rig_check_closest(r, results, RIG_RAYS);
            rig_fault(r, HPT_FAULT_RESET, 0, in, packet, 1);
            assert_int_equal(rig_ask_all(r, &tally), HP_OK);
            assert_int_equal(r->plan.faults, 1);
            rig_check_all(r, &tally);
        }
    assert_true(hp_reconnections(r->device) >= 20);
}

/* ---- it does not ---- */

static void lost_without_reconnection(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig_tally tally;
    rig *r = patient(0);
    rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, IN, 23, 1); /* in the fifth packet of primaries */
    assert_int_equal(rig_ask_all(r, &tally), HP_ERROR_DISCONNECTED);
    assert_int_equal(hp_completed(r->device), 4 * RIG_PACKET);
    rig_says(r->device, "board disconnected; 32 of 60 primaries answered");
    rig_check_some(r, &tally, 4 * RIG_PACKET);
    assert_true(tally.total <= 4 * RIG_PACKET * RIG_TRIANGLES + 3 * RECORDS);
    assert_int_equal(rig_ask_closest(r, results), HP_ERROR_DISCONNECTED); /* and so it stays */
    assert_int_equal(hp_completed(r->device), 0);
    hp_counters counters;
    assert_int_equal(hp_read_counters(r->device, false, &counters), HP_ERROR_DISCONNECTED);
}

/* Before the kernel notices that a cable was pulled, urbs fail one after the other. That is not taken for a bad
 * endpoint, and does not keep the processor busy. */
static void errors_before_the_unplug(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig *r = patient(0);
    r->device->queue.timeout_ms = 10000;
    unsigned before = hpt_counts(r->board).urbs;
    hpt_pull_slowly(r->board, 300);
    double start = hpt_now_ms();
    assert_int_equal(rig_ask_closest(r, results), HP_ERROR_DISCONNECTED);
    double took = hpt_now_ms() - start;
    unsigned urbs = hpt_counts(r->board).urbs - before;
    printf("%.0f ms and %u urbs until the kernel noticed\n", took, urbs);
    assert_true(took >= 250 && took < 1000);
    assert_true(urbs < 100);
    assert_int_equal(hp_completed(r->device), 0);
}

static void not_back_in_time(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig *r = patient(150);
    rig_fault(r, HPT_FAULT_UNPLUG, 0, IN, 2, 1);
    double start = hpt_now_ms();
    assert_int_equal(rig_ask_closest(r, results), HP_ERROR_DISCONNECTED);
    double took = hpt_now_ms() - start;
    assert_true(took >= 140 && took < 1000);
    assert_int_equal(hp_completed(r->device), 2 * RIG_PACKET);
    rig_check_closest(r, results, 2 * RIG_PACKET);
    rig_says(r->device, "board disconnected, and not back within 150 ms: no board on USB");
    rig_says(r->device, "; 16 of 60 primaries answered");
    hp_counters counters;
    assert_int_equal(hp_read_counters(r->device, false, &counters), HP_ERROR_DISCONNECTED);
    hpt_push(r->board);
    rig_check_usable(r); /* the next call finds it, scene and all */
}

static void another_board_is_not_taken(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig *r = patient(150);
    hpt_device_def other = r->plug;
    other.gadget.serial = "HP2";
    hpt_device *second = hpt_plug(&other);
    rig_fault(r, HPT_FAULT_UNPLUG, 0, IN, 2, 1);
    hp_status status = rig_ask_closest(r, results);
    hpt_discard(second);
    assert_int_equal(status, HP_ERROR_DISCONNECTED);
    rig_says(r->device, "serial number HP1; there are usb:HP2");
}

static void configured_otherwise(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig *r = patient(AWAIT_MS);
    hpt_device_def other = r->plug;
    other.gadget.board.config.lanes = RIG_LANES + 1;
    other.choose = NULL;
    hpt_pull(r->board);
    hpt_device *second = hpt_plug(&other);
    hp_status status = rig_ask_closest(r, results);
    rig_says(r->device, "configured otherwise");
    rig_close(r);
    hpt_discard(second);
    assert_int_equal(status, HP_ERROR_DISCONNECTED);
}

static void lost_again_and_again(void **state) {
    (void)state;
    hp_result results[RIG_RAYS];
    rig *r = patient(AWAIT_MS);
    rig_fault(r, HPT_FAULT_UNPLUG, BACK_MS, OUT, 4, 1000000);
    assert_int_equal(rig_ask_closest(r, results), HP_ERROR_DISCONNECTED);
    rig_check_closest(r, results, hp_completed(r->device));
    assert_true(r->plan.faults >= 4 && r->plan.faults < 200);
    rig_no_faults(r);
    rig_check_usable(r);
    assert_int_equal(rig_upload(r), HP_OK);
    rig_fault(r, HPT_FAULT_RESET, 0, OUT, 0, 1000000); /* and a board that is reset all the time */
    assert_int_not_equal(rig_ask_closest(r, results), HP_OK);
    rig_no_faults(r);
    rig_check_usable(r);
}

/* ---- the user ---- */

typedef struct waiter {
    unsigned waits, calls;
    bool stop;
} waiter;

static bool tell(void *context, uint64_t done, uint64_t total) {
    waiter *w = context;
    (void)done, (void)total;
    w->calls++;
    return !w->stop;
}

static void abort_while_the_board_is_away(void **state) {
    (void)state;
    waiter w = {0};
    hp_result results[RIG_RAYS];
    now = rig_new(HP_USB_SUPER, RECORDS, true);
    now->def.reconnect_ms = 60000;
    now->def.progress = tell;
    now->def.progress_context = &w;
    rig_begin(now);
    rig_fault(now, HPT_FAULT_UNPLUG, 0, IN, 1, 1);
    hpt_pull(now->board);
    w.stop = true;
    double start = hpt_now_ms();
    assert_int_equal(rig_ask_closest(now, results), HP_ERROR_CANCELLED);
    assert_true(hpt_now_ms() - start < 250);
    w.stop = false;
    hpt_push(now->board);
    rig_check_usable(now);
}

static void wait_a_moment(void *context, const hp_wait_file *files, size_t count, unsigned timeout_ms) {
    waiter *w = context;
    const struct timespec moment = {.tv_nsec = 1000000};
    (void)files;
    w->waits += count == 0;
    assert_true(timeout_ms > 0);
    nanosleep(&moment, NULL);
}

/* The program's loop goes on while a board is awaited; progress tells of it. */
static void the_program_goes_on_meanwhile(void **state) {
    (void)state;
    waiter w = {0};
    hp_result results[RIG_RAYS];
    now = rig_new(HP_USB_SUPER, RECORDS, true);
    now->def.reconnect_ms = AWAIT_MS;
    now->def.wait = wait_a_moment;
    now->def.wait_context = &w;
    now->def.progress = tell;
    now->def.progress_context = &w;
    rig_begin(now);
    rig_fault(now, HPT_FAULT_UNPLUG, 200, IN, 1, 1);
    w = (waiter){0};
    assert_int_equal(rig_ask_closest(now, results), HP_OK);
    rig_check_closest(now, results, RIG_RAYS);
    assert_true(w.waits > 10 && w.calls > 1);
}

static void nothing_is_kept_without_need(void **state) {
    (void)state;
    rig *r = patient(0);
    assert_null(r->device->scene_words);
    tear_down(NULL);
    r = patient(1);
    assert_non_null(r->device->scene_words);
    assert_ptr_not_equal(r->device->scene_words, r->triangles); /* the user may free his */
}

#define EACH_TEST(name) cmocka_unit_test_teardown(name, tear_down)
#define HPT_TEST(program, name, words, outcome) HPT_OF_##program(name)
#define HPT_OF_test_usb_faults(name)
#define HPT_OF_test_usb_link(name)
#define HPT_OF_test_usb_reconnect(name) EACH_TEST(name),
#define HPT_OF_test_usb_soak(name)
#define HPT_OF_test_usb_hid(name)

int main(void) {
    const struct CMUnitTest tests[] = {
#include "fault_tests.def"
        EACH_TEST(the_program_goes_on_meanwhile),
        EACH_TEST(nothing_is_kept_without_need),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
