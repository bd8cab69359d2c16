/* Once it is under way, the driver allocates nothing, whatever it is asked and whoever waits. The linker turns malloc
 * and its like in this program into the functions below; libusb's own (an urb for each transfer) is in another
 * library. What the bus and the board do inside of system calls does not count: a real board has memory of its own.
 */
#include "rig.h"
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { RECORDS = 53, WARM = 3, ROUNDS = 40 };

static bool counting;
static unsigned allocations;

static void count(void) {
    if (counting && !hpt_inside()) allocations++;
}

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t n, size_t bytes);
void *__real_realloc(void *old, size_t bytes);
void *__real_aligned_alloc(size_t alignment, size_t bytes);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t n, size_t bytes);
void *__wrap_realloc(void *old, size_t bytes);
void *__wrap_aligned_alloc(size_t alignment, size_t bytes);

void *__wrap_malloc(size_t bytes) {
    count();
    return __real_malloc(bytes);
}
void *__wrap_calloc(size_t n, size_t bytes) {
    count();
    return __real_calloc(n, bytes);
}
void *__wrap_realloc(void *old, size_t bytes) {
    count();
    return __real_realloc(old, bytes);
}
void *__wrap_aligned_alloc(size_t alignment, size_t bytes) {
    count();
    return __real_aligned_alloc(alignment, bytes);
}

static rig *now; /* freed by tear_down whatever happens */

static int tear_down(void **state) {
    (void)state;
    counting = false;
    rig_free(now);
    now = NULL;
    return 0;
}

static void run(rig *r, unsigned rounds) {
    for (unsigned i = 0; i < rounds; i++) {
        assert_int_equal(rig_upload(r), HP_OK);
        rig_check_usable(r);
    }
}

static unsigned allocations_with(unsigned transfer, hp_wait *wait) {
    now = rig_new(HP_USB_SUPER, RECORDS, false);
    now->def.usb_transfer = transfer;
    now->def.wait = wait;
    rig_begin(now);
    allocations = 0;
    counting = true;
    run(now, WARM);
    assert_true(allocations > 0); /* of buffers, at first: they are counted */
    allocations = 0;
    unsigned urbs = hpt_counts(now->board).urbs;
    run(now, ROUNDS);
    counting = false;
    urbs = hpt_counts(now->board).urbs - urbs;
    printf("%u allocations in %u transfers\n", allocations, urbs);
    assert_true(urbs > 1000);
    tear_down(NULL);
    return allocations;
}

static void wait_for_files(void *context, const hp_wait_file *files, size_t n, unsigned timeout_ms) {
    struct pollfd polled[16];
    (void)context;
    assert_true(n <= 16);
    for (size_t i = 0; i < n; i++) polled[i] = (struct pollfd){.fd = files[i].fd, .events = files[i].events};
    poll(polled, n, (int)timeout_ms);
}

static void nothing_is_allocated(void **state) {
    (void)state;
    assert_int_equal(allocations_with(0, NULL), 0);
    assert_int_equal(allocations_with(2048, NULL), 0); /* transfers smaller than packets */
    assert_int_equal(allocations_with(0, wait_for_files), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test_teardown(nothing_is_allocated, tear_down)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
