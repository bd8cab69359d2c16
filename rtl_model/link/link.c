#include "link.h"

static unsigned __int128 ceil_div(unsigned __int128 a, uint64_t b) {
    return (a + b - 1) / b;
}

uint64_t hp_link_clocks(const hp_config *config, hp_direction direction, size_t n) {
    uint64_t rate = direction == HP_TO_BOARD ? config->link_to_board_rate : config->link_to_host_rate;
    unsigned __int128 turnaround =
        ceil_div((unsigned __int128)config->link_turnaround_ns * config->clock_hz, 1000000000);
    unsigned __int128 moving = ceil_div((unsigned __int128)n * config->clock_hz, rate);
    uint64_t clocks = (uint64_t)(turnaround + moving);
    return clocks ? clocks : 1;
}

void hp_link_grant(const hp_config *config, const bool waits[HP_DIRECTIONS], const bool busy[HP_DIRECTIONS],
                   bool grant[HP_DIRECTIONS]) {
    bool half = config->link_duplex == 0;
    bool taken = busy[HP_TO_BOARD] || busy[HP_TO_HOST];
    grant[HP_TO_HOST] = waits[HP_TO_HOST] && !(half ? taken : busy[HP_TO_HOST]);
    grant[HP_TO_BOARD] = waits[HP_TO_BOARD] && !(half ? taken || grant[HP_TO_HOST] : busy[HP_TO_BOARD]);
}
