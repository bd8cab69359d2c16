/* The queue over a transport that is short of something: that does not take transfers, gives them back late or never,
 * or waits in earnest. */
#include "driver/device.h"
#include <hitpipe/packet.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

/* Passes everything on to the model but for what the fields below say. */
typedef struct stubborn {
    hp_transport head;
    hp_transport *inner;
    unsigned refuse_in;                  /* submit_in: so many with HP_ERROR_MEMORY */
    unsigned refuse_out;                 /* submit_out: likewise, with HP_ERROR_IO */
    unsigned listening;                  /* IN transfers under way */
    unsigned hold_out;                   /* OUT transfers to keep: so many */
    hp_transfer *held;                   /* one of them ... */
    bool called_back;                    /* ... which the queue wants back ... */
    unsigned late;                       /* ... and gets after so many polls; ~0: never */
    unsigned silent_ms;                  /* poll: waits so long, and nothing comes */
    void (*done)(hp_transfer *transfer); /* the queue's, of IN transfers */
} stubborn;

static stubborn *the_link; /* `done` of a transfer knows no transport */

static void in_done(hp_transfer *transfer) {
    the_link->listening--;
    the_link->done(transfer);
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    stubborn *link = (stubborn *)transport;
    if (link->refuse_in) {
        link->refuse_in--;
        return HP_ERROR_MEMORY;
    }
    if (transfer->done != in_done) link->done = transfer->done;
    transfer->done = in_done;
    link->listening++;
    return link->inner->ops->submit_in(link->inner, transfer);
}

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    stubborn *link = (stubborn *)transport;
    if (link->refuse_out) {
        link->refuse_out--;
        return HP_ERROR_IO;
    }
    if (link->hold_out && !link->held) {
        link->hold_out--;
        link->held = transfer;
        link->called_back = false;
        return HP_OK;
    }
    return link->inner->ops->submit_out(link->inner, transfer);
}

static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    stubborn *link = (stubborn *)transport;
    if (transfer != link->held) return link->inner->ops->cancel(link->inner, transfer);
    link->called_back = true;
    return HP_OK;
}

static void give_back(stubborn *link) {
    hp_transfer *transfer = link->held;
    link->held = NULL;
    transfer->status = HP_ERROR_CANCELLED;
    transfer->done(transfer);
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    stubborn *link = (stubborn *)transport;
    *completed = 0;
    if (link->called_back && link->held && link->late != ~0u) {
        if (link->late > 0) {
            link->late--;
            return HP_OK; /* woken for nothing */
        }
        give_back(link);
        *completed = 1;
        return HP_OK;
    }
    hp_status status = link->inner->ops->poll(link->inner, timeout_ms, completed);
    if (status != HP_ERROR_TIMEOUT) return status;
    unsigned ms = link->silent_ms && link->silent_ms < timeout_ms ? link->silent_ms : timeout_ms;
    const struct timespec wait = {.tv_sec = ms / 1000, .tv_nsec = (long)(ms % 1000) * 1000000};
    nanosleep(&wait, NULL);
    return ms < timeout_ms ? HP_OK : HP_ERROR_TIMEOUT;
}

static size_t transfer_max(const hp_transport *transport) {
    const stubborn *link = (const stubborn *)transport;
    return link->inner->ops->transfer_max(link->inner);
}

static void close_link(hp_transport *transport) {
    stubborn *link = (stubborn *)transport;
    if (link->held) give_back(link);
    link->inner->ops->close(link->inner);
    free(link);
    the_link = NULL;
}

static const hp_transport_ops stubborn_ops = {
    .name = "stubborn",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .waits = true,
    .transfer_max = transfer_max,
    .close = close_link,
};

/* ---- a device on it ---- */

static const float triangle[9] = {-1, -1, 2, 1, -1, 2, 0, 1, 2}, ray[6] = {0, 0, 0, 0, 0, 1};
static hp_device *device;

static hp_device *open_with(unsigned timeout_ms, hp_progress *progress, void *context) {
    hp_board_def board = {.isa = "plain", .threads = 1};
    hp_message message;
    hp_device_def def = hp_default_device_def();
    def.timeout_ms = timeout_ms;
    def.progress = progress;
    def.progress_context = context;
    hp_config_preset(&board.config, "ideal");
    the_link = calloc(1, sizeof *the_link);
    assert_non_null(the_link);
    the_link->head.ops = &stubborn_ops;
    assert_int_equal(hp_transport_model(&board, &the_link->inner), HP_OK);
    assert_int_equal(hp_open_transport(&def, &the_link->head, &device, &message), HP_OK);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_OK);
    return device;
}

static int end_test(void **state) {
    (void)state;
    hp_close(device);
    device = NULL;
    return 0;
}

static double now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static hp_status ask(void) {
    hp_query_def def = hp_default_query_def();
    hp_result result;
    hp_status status = hp_query(device, &def, ray, 1, &result);
    if (!status) assert_true(result.F == 1 && result.index == 0 && result.T == 2);
    return status;
}

static void says(const char *words) {
    if (!strstr(hp_error_message(device), words)) fail_msg("no \"%s\" in \"%s\"", words, hp_error_message(device));
}

/* ---- tests ---- */

static void what_was_not_taken_is_submitted_again(void **state) {
    (void)state;
    open_with(50, NULL, NULL);
    assert_int_equal(the_link->listening, HP_IN_TRANSFERS);
    the_link->refuse_in = 2;
    assert_int_equal(ask(), HP_ERROR_MEMORY);
    says("cannot read from the board: out of memory");
    the_link->refuse_in = 0;
    assert_int_equal(ask(), HP_OK);
    assert_int_equal(the_link->listening, HP_IN_TRANSFERS); /* no ear is lost */
}

static void what_is_not_sent_is_sent_again_at_once(void **state) {
    (void)state;
    open_with(10000, NULL, NULL);
    double start = now_ms();
    the_link->refuse_out = 2;
    assert_int_equal(ask(), HP_OK);
    assert_int_equal(device->queue.counts.again, 2);
    the_link->refuse_out = 100;
    assert_int_equal(ask(), HP_ERROR_IO);
    says("QUERY: input or output failed (retries: 3)");
    assert_true(now_ms() - start < 5000); /* nothing was waited for */
    the_link->refuse_out = 0;
    assert_int_equal(ask(), HP_OK);
}

static void a_transfer_that_comes_back_late(void **state) {
    (void)state;
    open_with(50, NULL, NULL);
    the_link->hold_out = 1;
    the_link->late = 1000; /* polls, far more than the window has commands */
    assert_int_equal(ask(), HP_OK);
    assert_null(the_link->held);
}

static void a_transfer_that_never_comes_back(void **state) {
    (void)state;
    open_with(50, NULL, NULL);
    the_link->hold_out = 1;
    the_link->late = ~0u;
    assert_int_equal(ask(), HP_ERROR_DISCONNECTED);
    says("the link neither sends a packet nor gives it back; 0 of 1 primaries answered");
    assert_int_equal(ask(), HP_ERROR_DISCONNECTED); /* the queue would write into what it does not own */
}

static bool count_calls(void *context, uint64_t done, uint64_t total) {
    unsigned *calls = context;
    (void)done, (void)total;
    return ++*calls < 5;
}

/* A link that waits is waited for in steps, between which the program hears of it and can end the call. */
static void the_program_is_heard_in_long_waits(void **state) {
    (void)state;
    unsigned calls = 0;
    open_with(60000, count_calls, &calls);
    the_link->hold_out = 1;
    the_link->late = 0;
    calls = 0;
    assert_int_equal(ask(), HP_ERROR_CANCELLED);
    assert_int_equal(calls, 5);
}

/* Being woken early, for nothing, is no silence. */
static void early_waking_is_no_silence(void **state) {
    (void)state;
    open_with(200, NULL, NULL);
    the_link->hold_out = 1;
    the_link->silent_ms = 5;
    double start = now_ms();
    assert_int_equal(ask(), HP_OK);
    assert_true(now_ms() - start >= 190);
    assert_int_equal(device->queue.counts.again, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(what_was_not_taken_is_submitted_again, end_test),
        cmocka_unit_test_teardown(what_is_not_sent_is_sent_again_at_once, end_test),
        cmocka_unit_test_teardown(a_transfer_that_comes_back_late, end_test),
        cmocka_unit_test_teardown(a_transfer_that_never_comes_back, end_test),
        cmocka_unit_test_teardown(the_program_is_heard_in_long_waits, end_test),
        cmocka_unit_test_teardown(early_waking_is_no_silence, end_test),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
