#include "controller.h"

hp_controller hp_controller_reset(const hp_config *config) {
    return (hp_controller){.config = config, .open_row = HP_NO_ROW};
}

static void begin(hp_controller *controller, hp_ddr_state state, uint64_t clocks, uint64_t row) {
    controller->state = state;
    controller->left = clocks - 1;
    controller->open_row = row;
}

static bool move_beat(hp_controller *controller, uint64_t beat) {
    uint64_t row = beat / controller->config->ddr_row_beats;
    controller->beat = beat;
    if (row != controller->open_row && controller->config->ddr_row_clocks) {
        begin(controller, HP_DDR_ROW, controller->config->ddr_row_clocks, row);
        return false;
    }
    controller->open_row = row;
    controller->state = HP_DDR_BEAT;
    return true;
}

/* The interval counter runs whatever the controller does. Of several multiples reached, one refresh is left due. */
static void count_interval(hp_controller *controller) {
    if (controller->interval == controller->config->ddr_refresh_interval) {
        controller->interval = 0;
        controller->due = controller->config->ddr_refresh_clocks > 0;
    }
    controller->interval++;
}

bool hp_controller_tick(hp_controller *controller, bool wanted, uint64_t beat) {
    count_interval(controller);
    if (controller->left) {
        controller->left--;
        return false;
    }
    if (controller->due) {
        controller->due = false;
        begin(controller, HP_DDR_REFRESH, controller->config->ddr_refresh_clocks, HP_NO_ROW);
        return false;
    }
    controller->state = HP_DDR_IDLE;
    return wanted && move_beat(controller, beat);
}
