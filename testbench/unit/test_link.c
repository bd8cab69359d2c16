/* The link: who may start a transfer, and how long it takes. */
#include "rtl_model/link/link.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
/* cmocka wants its headers first */
#include <cmocka.h>

/* All sixteen states of a link of either kind. */
static void one_channel_or_two(void **state) {
    (void)state;
    for (unsigned i = 0; i < 32; i++) {
        hp_config config = {.link_duplex = i >> 4};
        bool waits[HP_DIRECTIONS] = {i & 1, i >> 1 & 1}, busy[HP_DIRECTIONS] = {i >> 2 & 1, i >> 3 & 1},
             grant[HP_DIRECTIONS];
        bool half = config.link_duplex == 0, any = busy[0] || busy[1];
        if (half && busy[0] && busy[1]) continue;
        hp_link_grant(&config, waits, busy, grant);
        assert_int_equal(grant[HP_TO_HOST], waits[HP_TO_HOST] && !(half ? any : busy[HP_TO_HOST]));
        bool first = half && waits[HP_TO_HOST]; /* the host is served first */
        assert_int_equal(grant[HP_TO_BOARD], waits[HP_TO_BOARD] && !first && !(half ? any : busy[HP_TO_BOARD]));
    }
}

/* Worked by hand: 100 MHz. 36 bytes at 350 MB/s are 10.29 clocks; 20 us are 2000; 15 ns are 1.5. */
static void transfers_round_up(void **state) {
    (void)state;
    hp_config config = {
        .clock_hz = 100000000, .link_to_board_rate = 350000000, .link_to_host_rate = 1000000000000000};
    assert_int_equal(hp_link_clocks(&config, HP_TO_BOARD, 36), 11);
    assert_int_equal(hp_link_clocks(&config, HP_TO_BOARD, 35), 10);
    assert_int_equal(hp_link_clocks(&config, HP_TO_HOST, 36), 1);
    assert_int_equal(hp_link_clocks(&config, HP_TO_HOST, 0), 1);
    config.link_turnaround_ns = 15;
    assert_int_equal(hp_link_clocks(&config, HP_TO_BOARD, 36), 13);
    config.link_turnaround_ns = 20000;
    assert_int_equal(hp_link_clocks(&config, HP_TO_BOARD, 0), 2000);
    config.clock_hz = 10000000000, config.link_turnaround_ns = 1000000000, config.link_to_board_rate = 1000;
    assert_int_equal(hp_link_clocks(&config, HP_TO_BOARD, 524288), 10000000000 + 5242880000000);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_channel_or_two), cmocka_unit_test(transfers_round_up)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
