/* Many packets over a bad cable, through the real libusb: every result is that of a sound one. */
#include "driver/device.h"
#include "rig.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum {
    RECORDS = 53,
    TIMEOUT_MS = 60,
    RETRIES = 60,
    PACKETS = 12000,
    PACKETS_WITH_REPLUGS = 3000,
    ROUNDS_MOST = 2000
};

static rig *now; /* freed by tear_down whatever happens */

static int tear_down(void **state) {
    (void)state;
    rig_free(now);
    now = NULL;
    return 0;
}

/* A round of both questions; the upload now and then. */
static void one_round(rig *r, unsigned round) {
    hp_result results[RIG_RAYS];
    rig_tally tally;
    if (round % 8 == 7) assert_int_equal(rig_upload(r), HP_OK);
    hp_status status = rig_ask_closest(r, results);
    if (status) fail_msg("round %u: %s", round, hp_error_message(r->device));
    rig_check_closest(r, results, RIG_RAYS);
    status = rig_ask_all(r, &tally);
    if (status) fail_msg("round %u: %s", round, hp_error_message(r->device));
    rig_check_all(r, &tally);
}

static unsigned packets_of(const rig *r) {
    hpt_bus_counts counts = hpt_counts(r->board);
    return counts.packets[0] + counts.packets[1];
}

static void print_counts(const rig *r, unsigned rounds) {
    static const char *const names[] = {
#define HPT_FAULT(NAME, words) #NAME,
#include "faults.def"
#undef HPT_FAULT
    };
    const hp_link_counts *counts = &r->device->queue.counts;
    printf("%u rounds, %u packets, %u faults (", rounds, packets_of(r), r->plan.faults);
    for (unsigned i = 1; i < HPT_FAULT_KINDS; i++)
        if (r->plan.of_kind[i]) printf(" %s %u", names[i], r->plan.of_kind[i]);
    printf(" ); sent again %u times, %u came damaged, %u were dropped, %u reconnections, %u halts cleared\n",
           (unsigned)counts->again, (unsigned)counts->damaged, (unsigned)counts->dropped, hp_reconnections(r->device),
           hpt_counts(r->board).halts_cleared);
}

static rig *begin(hp_usb_speed speed, unsigned transfer) {
    now = rig_new(speed, RECORDS, true);
    now->def.usb_transfer = transfer;
    now->def.timeout_ms = TIMEOUT_MS;
    now->def.retries = RETRIES;
    now->def.reconnect_ms = 10000;
    rig_begin(now);
    return now;
}

static void soak(rig *r, unsigned packets, unsigned rate, const hpt_fault_kind *kinds, unsigned count) {
    unsigned round = 0;
    rig_random_faults(r, 2026, rate, kinds, count);
    for (; packets_of(r) < packets && round < ROUNDS_MOST; round++) one_round(r, round);
    print_counts(r, round);
    assert_true(packets_of(r) >= packets);
    for (unsigned i = 0; i < count; i++) assert_true(r->plan.of_kind[kinds[i]] > 0); /* each kind had its turn */
    rig_check_usable(r);
}

static void soak_with_faults(void **state) {
    (void)state;
    static const hpt_fault_kind kinds[] = {
        HPT_FAULT_DROP,  HPT_FAULT_DUPLICATE, HPT_FAULT_SWAP,  HPT_FAULT_FLIP,     HPT_FAULT_SHORT, HPT_FAULT_GROW,
        HPT_FAULT_STALL, HPT_FAULT_NO_ZERO,   HPT_FAULT_PROTO, HPT_FAULT_OVERFLOW, HPT_FAULT_HANG,
    };
    enum { KINDS = sizeof kinds / sizeof kinds[0] };
    rig *r = begin(HP_USB_HIGH, 0);
    soak(r, PACKETS, 100, kinds, KINDS);
    assert_int_equal(hp_reconnections(r->device), 0);
    tear_down(NULL);
    r = begin(HP_USB_HIGH, 1024); /* in pieces, copied */
    soak(r, PACKETS, 100, kinds, KINDS);
    assert_int_equal(hp_reconnections(r->device), 0);
}

static void soak_with_replugs(void **state) {
    (void)state;
    static const hpt_fault_kind kinds[] = {HPT_FAULT_UNPLUG, HPT_FAULT_RESET, HPT_FAULT_DROP, HPT_FAULT_STALL,
                                           HPT_FAULT_FLIP};
    rig *r = begin(HP_USB_SUPER, 0);
    soak(r, PACKETS_WITH_REPLUGS, 100, kinds, sizeof kinds / sizeof kinds[0]);
    assert_true(hp_reconnections(r->device) > 5);
}

#define HPT_TEST(program, name, words, outcome) HPT_OF_##program(name)
#define HPT_OF_test_usb_faults(name)
#define HPT_OF_test_usb_link(name)
#define HPT_OF_test_usb_reconnect(name)
#define HPT_OF_test_usb_soak(name) cmocka_unit_test_teardown(name, tear_down),
#define HPT_OF_test_usb_hid(name)

int main(void) {
    const struct CMUnitTest tests[] = {
#include "fault_tests.def"
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
