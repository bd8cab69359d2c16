#include "controller.h"

hp_controller hp_controller_reset(const hp_config *config) {
    return (hp_controller){.config = config};
}

static void begin(hp_controller *controller, hp_ddr_state state, uint64_t clocks) {
    controller->state = state;
    controller->left = clocks - 1;
    controller->row_open = state == HP_DDR_ROW;
}

/* Beats of the open row are told by their distance from its first: a division a clock would cost more than the rest.
 */
static bool in_open_row(const hp_controller *controller, uint64_t beat) {
    return controller->row_open && beat - controller->row_first < controller->config->ddr_row_beats;
}

static bool move_beat(hp_controller *controller, uint64_t beat) {
    controller->beat = beat;
    controller->state = HP_DDR_BEAT;
    if (in_open_row(controller, beat)) return true;
    controller->row_first = beat - beat % controller->config->ddr_row_beats;
    controller->row_open = true;
    if (!controller->config->ddr_row_clocks) return true;
    begin(controller, HP_DDR_ROW, controller->config->ddr_row_clocks);
    return false;
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
        begin(controller, HP_DDR_REFRESH, controller->config->ddr_refresh_clocks);
        return false;
    }
    controller->state = HP_DDR_IDLE;
    return wanted && move_beat(controller, beat);
}
