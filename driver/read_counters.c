/* The counter registers over the link. */
#include "device.h"

static hp_status take_counters(hp_command *command, const uint8_t *payload, uint32_t length, bool last) {
    if (length != 8 * HP_REGISTER_COUNT || !last) return HP_ERROR_LENGTH;
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++) hp_register_set(command->owner, i, hp_get64(payload + 8 * i));
    return HP_OK;
}

static hp_status ask(hp_device *device, bool clear, hp_counters *counters) {
    hp_command *command;
    hp_status status = hp_queue_reserve(&device->queue, &command);
    if (status) return status;
    command->opcode = HP_OPCODE_COUNTERS;
    command->reply = HP_OPCODE_COUNTERS_REPLY;
    command->length = HP_COUNTERS_FIXED;
    command->once = clear; /* what a lost answer held is gone: asking again would report zeros */
    command->take = take_counters;
    command->owner = counters;
    hp_put32(command->payload + HP_AT_COUNTERS_clear, clear);
    return hp_ask(device, command);
}

hp_status hp_read_counters(hp_device *device, bool clear, hp_counters *counters) {
    if (!device) return HP_ERROR_USAGE;
    hp_status status = hp_begin(device);
    if (status) return status;
    if (!counters) return hp_say(&device->message, HP_ERROR_USAGE, "no place for the counters");
    do status = ask(device, clear, counters);
    while (status && hp_recover(device, &status, 0));
    return status;
}
