/* Which of the boards that are plugged in is meant. */
#include "hid.h"
#include <string.h>

/* The serial numbers that there are, behind the words so far: ": there are A, B". */
static void say_serials(const hp_control_board *boards, size_t count, hp_message *message) {
    size_t hidden = 0, shown = 0;
    for (size_t i = 0; i < count; i++) {
        hidden += !boards[i].serial[0];
        if (boards[i].serial[0]) hp_say_also(message, "%s%s", shown++ ? ", " : "; there is ", boards[i].serial);
    }
    if (hidden)
        hp_say_also(message,
                    "; of %zu the serial number cannot be read without permission to open them, which the udev rule "
                    "60-hitpipe.rules gives",
                    hidden);
}

static hp_status named(const hp_control_board *boards, size_t count, const hp_control_def *def, size_t *chosen,
                       hp_message *message) {
    for (size_t i = 0; i < count; i++) {
        if (strcmp(boards[i].serial, def->serial) != 0) continue;
        *chosen = i;
        return HP_OK;
    }
    hp_say(message, HP_ERROR_NO_DEVICE, "no board with serial number %.40s among the HID devices %04x:%04x",
           def->serial, def->vendor, def->product);
    say_serials(boards, count, message);
    return HP_ERROR_NO_DEVICE;
}

hp_status hp_hid_choose(const hp_control_board *boards, size_t count, const hp_control_def *def, size_t *chosen,
                        hp_message *message) {
    if (def->serial && *def->serial && count) return named(boards, count, def, chosen, message);
    *chosen = 0;
    if (count == 1) return HP_OK;
    if (count == 0) {
        hp_say(message, HP_ERROR_NO_DEVICE, "no board is plugged in: looked for a HID device %04x:%04x", def->vendor,
               def->product);
        if (def->serial && *def->serial) hp_say_also(message, " with serial number %.40s", def->serial);
        return HP_ERROR_NO_DEVICE;
    }
    hp_say(message, HP_ERROR_NO_DEVICE, "%zu boards are plugged in, and none is named", count);
    say_serials(boards, count, message);
    return HP_ERROR_NO_DEVICE;
}
