/* Every fault that a cable can produce, in the midst of a query through the real libusb: what comes of it is what
 * fault_cases.def and docs/testing.md say. Whatever it is, no result is reported that was not computed, no record
 * comes twice, and the board can be used again. */
#include "driver/device.h"
#include "rig.h"
#include "testbench/support/board_host.h"
#include "testbench/support/page.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum {
    RECORDS = 53,
    ALL = 1000000,
    OUT = 0,
    IN = 1,
    TIMEOUT_MS = 60,
    MENDING_MS = 400,
    PIECE = 1024,
    HALTS_MOST = 30,
    OUTCOME = 128
};

typedef struct fault_case {
    const char *name, *words;
    hpt_fault_kind kind;
    unsigned argument;
    bool in;
    unsigned packets;
    const char *outcome;
} fault_case;

static const fault_case cases[] = {
#define HPT_CASE(name, words, KIND, argument, direction, packets, outcome)                                           \
    {#name, words, HPT_FAULT_##KIND, argument, direction, packets, outcome},
#include "fault_cases.def"
#undef HPT_CASE
};

static rig *now; /* freed by tear_down whatever happens */

static int tear_down(void **state) {
    (void)state;
    rig_free(now);
    now = NULL;
    return 0;
}

static rig *faulty(hp_usb_speed speed, unsigned records) {
    now = rig_new(speed, records, true);
    now->def.timeout_ms = TIMEOUT_MS;
    return now;
}

/* ---- one query ---- */

static const char *status_name(hp_status status) {
    switch (status) {
#define HP_STATUS(NAME, code, exit, text, cause)                                                                     \
    case code:                                                                                                       \
        return "HP_" #NAME;
#include <hitpipe/status.def>
#undef HP_STATUS
    }
    return "?";
}

static void describe(const rig *r, hp_status status, char outcome[OUTCOME]) {
    unsigned again = (unsigned)r->device->queue.counts.again;
    size_t done = hp_completed(r->device);
    if (status)
        snprintf(outcome, OUTCOME, "%s, %zu of %d primaries; %u sent again", status_name(status), done, RIG_RAYS,
                 again);
    else
        snprintf(outcome, OUTCOME, "completes; %u sent again", again);
}

/* What was answered is true, and so is what was written beyond. */
static void check_results(const rig *r, hp_status status, const hp_result *results) {
    hp_result rubbish;
    memset(&rubbish, 0xEE, sizeof rubbish);
    size_t done = hp_completed(r->device);
    assert_true(status || done == RIG_RAYS);
    rig_check_closest(r, results, done);
    for (size_t i = done; i < RIG_RAYS; i++)
        if (memcmp(&results[i], &rubbish, sizeof rubbish))
            assert_memory_equal(&results[i], &r->closest[i], sizeof rubbish);
    if (!status) return;
    char words[64];
    snprintf(words, sizeof words, "; %zu of %d primaries answered", done, RIG_RAYS);
    rig_says(r->device, words);
}

static void plan(rig *r, const fault_case *c) {
    rig_fault(r, c->kind, c->argument, c->in, 1, c->packets);
    r->device->queue.counts = (hp_link_counts){0};
}

static void check_still_usable(rig *r) {
    rig_no_faults(r);
    if (!r->device->session) assert_int_equal(rig_upload(r), HP_OK); /* it was reset */
    rig_check_usable(r);
}

/* An endpoint that fails again and again is left alone for up to 320 ms. */
static bool mended(hpt_fault_kind kind) {
    return kind == HPT_FAULT_STALL || kind == HPT_FAULT_PROTO || kind == HPT_FAULT_OVERFLOW;
}

/* No transfer was lost on the way, and an endpoint that fails all the time was not mended all the time. */
static void check_transfers(const rig *r) {
    hpt_bus_counts counts = hpt_counts(r->board);
    assert_int_equal(counts.in_flight, r->def.usb_depth); /* to the host */
    assert_true(counts.halts_cleared <= HALTS_MOST);
}

static void suffer(const fault_case *c, hp_usb_speed speed, unsigned transfer, char outcome[OUTCOME]) {
    hp_result results[RIG_RAYS];
    rig_tally tally;
    rig *r = faulty(speed, RECORDS);
    r->def.usb_transfer = transfer;
    if (c->packets == ALL) r->def.retries = 1;
    if (c->packets == ALL && mended(c->kind)) r->def.timeout_ms = MENDING_MS;
    rig_begin(r);
    plan(r, c);
    hp_status status = rig_ask_closest(r, results);
    assert_true(r->plan.faults > 0);
    describe(r, status, outcome);
    if (c->kind == HPT_FAULT_GROW && transfer) /* what is too long is one bad packet, not many */
        assert_int_equal(r->device->queue.counts.damaged, 1);
    check_results(r, status, results);
    if (status != HP_ERROR_DISCONNECTED) {
        check_still_usable(r);
    }
    if (!status) {
        plan(r, c);
        assert_int_equal(rig_ask_all(r, &tally), HP_OK);
        rig_check_all(r, &tally);
        check_still_usable(r);
    }
    if (status != HP_ERROR_DISCONNECTED) check_transfers(r);
    rig_close(r); /* whatever state it is in */
    assert_int_equal(hpt_counts(r->board).files, 0);
    tear_down(NULL);
}

static void case_in_three_ways(void **state) {
    const fault_case *c = *state;
    char at_super[OUTCOME], at_high[OUTCOME], in_pieces[OUTCOME];
    suffer(c, HP_USB_SUPER, 0, at_super);
    suffer(c, HP_USB_HIGH, 0, at_high);
    suffer(c, HP_USB_HIGH, PIECE, in_pieces);
    printf("%s: %s\n", c->name, at_super);
    assert_string_equal(at_high, at_super);
    if (c->kind == HPT_FAULT_GROW) /* while half a mebibyte comes in pieces, one more packet gets out */
        assert_memory_equal(in_pieces, at_super, strlen("completes;"));
    else
        assert_string_equal(in_pieces, at_super);
    assert_string_equal(at_super, c->outcome);
}

/* ---- zero-length packets ---- */

/* The upload of 27 triangles has 1024 bytes. */
static void lose_zero_packet_out(hp_usb_speed speed) {
    rig *r = faulty(speed, RECORDS);
    rig_begin(r);
    rig_fault(r, HPT_FAULT_NO_ZERO, 0, OUT, 0, 1);
    assert_int_equal(rig_upload(r), HP_OK);
    assert_int_equal(r->plan.faults, 1);
    assert_true(r->device->queue.counts.again > 0); /* the packet's end was missed */
    rig_check_usable(r);
    tear_down(NULL);
}

static void missing_zero_packet_out(void **state) {
    (void)state;
    lose_zero_packet_out(HP_USB_HIGH);
    lose_zero_packet_out(HP_USB_SUPER);
}

/* A RESULT of 53 records has 1536 bytes, one of 181 has 5120: the first of each packet of primaries. */
static hp_status lose_zero_packets_in(hp_usb_speed speed, unsigned records, unsigned packets, rig_tally *tally) {
    rig *r = faulty(speed, records);
    r->def.retries = packets == ALL ? 1 : 3;
    rig_begin(r);
    rig_fault(r, HPT_FAULT_NO_ZERO, 0, IN, 0, packets);
    hp_status status = rig_ask_all(r, tally);
    assert_true(r->plan.faults > 0);
    assert_true(r->device->queue.counts.again > 0);
    rig_check_some(r, tally, hp_completed(r->device));
    if (status) rig_says(r->device, "of 60 primaries answered");
    rig_check_usable(r);
    return status;
}

static void missing_zero_packet_in(void **state) {
    (void)state;
    rig_tally tally;
    assert_int_equal(lose_zero_packets_in(HP_USB_HIGH, 53, 1, &tally), HP_OK);
    rig_check_all(now, &tally);
    tear_down(NULL);
    assert_int_equal(lose_zero_packets_in(HP_USB_SUPER, 181, 1, &tally), HP_OK);
    rig_check_all(now, &tally);
}

static void missing_zero_packets_for_good(void **state) {
    (void)state;
    rig_tally tally;
    hp_status status = lose_zero_packets_in(HP_USB_HIGH, 53, ALL, &tally);
    assert_true(status == HP_ERROR_LENGTH || status == HP_ERROR_TIMEOUT);
}

/* ---- opening ---- */

static void silent_from_the_start(void **state) {
    (void)state;
    rig *r = faulty(HP_USB_SUPER, RECORDS);
    rig_plug(r, "HP1");
    rig_fault(r, HPT_FAULT_DROP, 0, IN, 0, ALL);
    assert_int_equal(rig_open(r), HP_ERROR_TIMEOUT);
    rig_says(NULL, "HELLO: board did not answer in time (retries: 3)");
    assert_int_equal(hpt_counts(r->board).files, 0);
    rig_no_faults(r);
    assert_int_equal(rig_open(r), HP_OK);
    assert_int_equal(rig_upload(r), HP_OK);
    rig_check_usable(r);
}

static void newer_protocol(void **state) {
    (void)state;
    rig *r = faulty(HP_USB_SUPER, RECORDS);
    rig_plug(r, "HP1");
    rig_fault(r, HPT_FAULT_NEWER, 2, IN, 0, ALL);
    assert_int_equal(rig_open(r), HP_ERROR_VERSION);
    rig_says(NULL,
             "protocol version not spoken: the board speaks version 2, this program version 1; a newer hitpipe");
    assert_int_equal(r->plan.faults, 1); /* it is not asked again */
}

/* ---- what must not be done twice ---- */

static void counters_once(void **state) {
    (void)state;
    hp_counters counters, rubbish;
    rig *r = faulty(HP_USB_SUPER, RECORDS);
    rig_begin(r);
    memset(&rubbish, 0xEE, sizeof rubbish);
    counters = rubbish;
    rig_fault(r, HPT_FAULT_DROP, 0, IN, 0, 1);
    hp_status status = hp_read_counters(r->device, true, &counters);
    assert_true(status == HP_ERROR_SEQUENCE || status == HP_ERROR_TIMEOUT);
    rig_says(r->device, "COUNTERS was carried out, but its answer was lost");
    assert_memory_equal(&counters, &rubbish, sizeof counters);
    rig_fault(r, HPT_FAULT_DROP, 0, OUT, 0, 1); /* the question: it may be asked again */
    assert_int_equal(hp_read_counters(r->device, true, &counters), HP_OK);
    rig_check_usable(r);
}

/* ---- the user ---- */

typedef struct patience {
    unsigned calls; /* left */
    uint64_t done, total;
} patience;

static bool until_patience_ends(void *context, uint64_t done, uint64_t total) {
    patience *p = context;
    p->done = done;
    p->total = total;
    if (p->calls == 0) return false;
    p->calls--;
    return true;
}

static rig *impatient(patience *p, unsigned delay_us) {
    rig *r = faulty(HP_USB_SUPER, RECORDS);
    r->def.progress = until_patience_ends;
    r->def.progress_context = p;
    r->def.timeout_ms = 10000;
    *p = (patience){.calls = 1000};
    rig_begin(r);
    hpt_delay(r->board, delay_us);
    return r;
}

static void abort_by_the_user(void **state) {
    (void)state;
    patience p;
    hp_result results[RIG_RAYS];
    rig_tally tally;
    rig *r = impatient(&p, 60000); /* longer than progress is silent */
    p.calls = 2;
    hp_status status = rig_ask_closest(r, results);
    assert_int_equal(status, HP_ERROR_CANCELLED);
    check_results(r, status, results);
    p.calls = 2;
    assert_int_equal(rig_ask_all(r, &tally), HP_ERROR_CANCELLED);
    assert_true(hp_completed(r->device) < RIG_RAYS);
    rig_check_some(r, &tally, hp_completed(r->device));
    hpt_delay(r->board, 0);
    p.calls = 1000;
    rig_check_usable(r); /* on the same device */
    rig_close(r);
    assert_int_equal(rig_open(r), HP_OK); /* and on a new one */
}

static void abort_while_waiting(void **state) {
    (void)state;
    patience p;
    hp_result results[RIG_RAYS];
    rig *r = impatient(&p, 2000000);
    p.calls = 0;
    double start = hpt_now_ms();
    assert_int_equal(rig_ask_closest(r, results), HP_ERROR_CANCELLED);
    double took = hpt_now_ms() - start;
    printf("cancelled after %.0f ms\n", took);
    assert_true(took < 250);
    assert_int_equal(hp_completed(r->device), 0);
    assert_true(p.done == 0 && p.total == RIG_RAYS);
    hpt_delay(r->board, 0);
    p.calls = 1000;
    rig_check_usable(r);
}

/* The kernel closes the files of a program that is killed; what the board was to say stays in it. */
static void killed_program(void **state) {
    (void)state;
    rig *r = faulty(HP_USB_SUPER, RECORDS);
    rig_begin(r);
    rig_fault(r, HPT_FAULT_HANG, 0, OUT, 1, 1); /* a packet half there */
    hp_device *killed = r->device;
    killed->queue.timeout_ms = 1;
    killed->queue.retries = 0;
    hp_result results[RIG_RAYS];
    assert_int_not_equal(rig_ask_closest(r, results), HP_OK);
    rig_close(r); /* without hearing out what is under way */
    rig_no_faults(r);
    assert_int_equal(rig_open(r), HP_OK);
    hp_query_def def = hp_default_query_def();
    assert_int_equal(hp_query(r->device, &def, r->rays[0], 1, results), HP_ERROR_CAPACITY); /* no scene of old */
    assert_int_equal(rig_upload(r), HP_OK);
    rig_check_usable(r);
}

/* ---- a cable alone ---- */

static hpt_fault no_fault(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    (void)context, (void)in, (void)number, (void)bytes, (void)n;
    return (hpt_fault){HPT_FAULT_NONE, 0};
}

/* As a kernel finds it: its endpoint halts what the cable asks it for, again and again. */
static void a_board_that_is_not_configured_is_left_alone(void **state) {
    (void)state;
    const hp_gadget_def def = {.board = hpt_board("usb3", HP_ENGINE_QUICK), .serial = "HP1", .speed = HP_USB_HIGH};
    hp_gadget *gadget;
    assert_int_equal(hp_gadget_create(&def, &gadget), HP_OK);
    hpt_cable *cable = hpt_cable_new(gadget, no_fault, NULL, NULL);
    hpt_cable_run(cable); /* comes to an end */
    hpt_cable_free(cable);
    hp_gadget_destroy(gadget);
}

/* ---- the page ---- */

static void the_page_has_every_case(void **state) {
    (void)state;
    test_page *page = page_open("docs/testing.md");
    assert_non_null(page);
    page_rows rows = page_table(page, "## Faults of a cable, at level 2");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        page_expect(&rows, "| 2 | %s | %s | `%s` |", cases[i].words, cases[i].outcome, cases[i].name);
    page_end(&rows);
    rows = page_table(page, "## Other faults, at level 2");
#define HPT_TEST(program, name, words, outcome)                                                                      \
    page_expect(&rows, "| 2 | %s | %s | `%s: %s` |", words, outcome, #program, #name);
#include "fault_tests.def"
#undef HPT_TEST
    page_end(&rows);
    page_close(page);
}

#define HPT_TEST(program, name, words, outcome) HPT_OF_##program(name)
#define HPT_OF_test_usb_faults(name) cmocka_unit_test_teardown(name, tear_down),
#define HPT_OF_test_usb_link(name)
#define HPT_OF_test_usb_reconnect(name)
#define HPT_OF_test_usb_soak(name)
#define HPT_OF_test_usb_hid(name)

int main(void) {
    enum { CASES = sizeof cases / sizeof cases[0] };
    const struct CMUnitTest others[] = {
#include "fault_tests.def"
        cmocka_unit_test(a_board_that_is_not_configured_is_left_alone),
        cmocka_unit_test(the_page_has_every_case),
    };
    struct CMUnitTest tests[CASES] = {{0}};
    for (size_t i = 0; i < CASES; i++) {
        tests[i].name = cases[i].name;
        tests[i].test_func = case_in_three_ways;
        tests[i].teardown_func = tear_down;
        tests[i].initial_state = (void *)(uintptr_t)&cases[i];
    }
    int failed = cmocka_run_group_tests_name("others", others, NULL, NULL);
    return failed + cmocka_run_group_tests_name("faults of a cable", tests, NULL, NULL);
}
