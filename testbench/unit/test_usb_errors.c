/* libusb's outcomes as statuses and words: every one that libusb.h names has its row, and no two read alike. */
#include "driver/transport/usb_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* libusb numbers its errors from -1 down without a gap, but for OTHER. */
enum { ERRORS = 12, OUTCOMES = LIBUSB_TRANSFER_OVERFLOW + 1 };

static void every_error_has_words(void **state) {
    (void)state;
    const char *nameless = hp_usb_words(-50);
    for (int i = -ERRORS; i < 0; i++) {
        assert_string_not_equal(hp_usb_words(i), nameless);
        assert_int_not_equal(hp_usb_status(i), HP_OK);
        for (int k = -ERRORS; k < i; k++) assert_string_not_equal(hp_usb_words(i), hp_usb_words(k));
    }
    assert_string_not_equal(hp_usb_words(LIBUSB_ERROR_OTHER), nameless);
    assert_string_equal(hp_usb_words(-ERRORS - 1), nameless);
    assert_int_equal(hp_usb_status(LIBUSB_SUCCESS), HP_OK);
    assert_int_equal(hp_usb_status(-50), HP_ERROR_IO);
}

static void every_outcome_has_a_status(void **state) {
    (void)state;
    for (int i = 0; i < OUTCOMES; i++)
        assert_int_equal(hp_usb_outcome((enum libusb_transfer_status)i) == HP_OK, i == LIBUSB_TRANSFER_COMPLETED);
    assert_int_equal(hp_usb_outcome(LIBUSB_TRANSFER_NO_DEVICE), HP_ERROR_DISCONNECTED);
    assert_int_equal(hp_usb_outcome(LIBUSB_TRANSFER_CANCELLED), HP_ERROR_CANCELLED);
    assert_int_equal(hp_usb_outcome(LIBUSB_TRANSFER_OVERFLOW), HP_ERROR_LENGTH);
    assert_int_equal(hp_usb_outcome((enum libusb_transfer_status)OUTCOMES), HP_ERROR_IO);
}

/* Without any USB in the machine the list is empty, not an error. */
static void a_list_can_be_had(void **state) {
    (void)state;
    hp_device_def def = hp_default_device_def();
    hp_usb_board *boards;
    size_t count;
    hp_message message = {{0}};
    def.usb_product = 0xFFFF; /* nobody's */
    assert_int_equal(hp_usb_list(&def, &boards, &count, &message), HP_OK);
    assert_int_equal(count, 0);
    assert_non_null(boards);
    free(boards);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_error_has_words),
        cmocka_unit_test(every_outcome_has_a_status),
        cmocka_unit_test(a_list_can_be_had),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
