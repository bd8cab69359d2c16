/* hp_query: one result a primary. */
#include "asking.h"
#include "words.h"
#include <math.h>

static const hp_result masked = {.F = 0, .index = HP_NO_INDEX, .T = INFINITY};

static bool in_range(const hp_asking *asking, const hp_part *part, unsigned primary, const hp_result *record) {
    if (record->index == HP_NO_INDEX) return !record->F;
    uint32_t index = record->index - part->first_secondary;
    return asking->def->mode == HP_MODE_ZIP ? index == primary : index < part->secondaries;
}

/* Results reach the caller's array only when all records of the packet are right. */
static hp_status take_results(hp_command *command, const uint8_t *payload, uint32_t length, bool last) {
    hp_asking *asking = command->owner;
    const hp_part *part = &asking->parts[command->slot];
    const uint8_t *order = part->order + command->position;
    hp_result *results = asking->results + part->first;
    uint32_t count;
    const uint8_t *records = hp_next_records(command, part, payload, length, last, &count);
    if (!records) return HP_ERROR_LENGTH;
    for (uint32_t i = 0; i < count; i++) {
        hp_result record = hp_get_result(records + i * HP_RESULT_BYTES);
        if (!hp_plausible(asking, &record) || !in_range(asking, part, order[i], &record)) return HP_ERROR_FIELD;
    }
    for (uint32_t i = 0; i < count; i++) results[order[i]] = hp_get_result(records + i * HP_RESULT_BYTES);
    command->position += count;
    if (!last) return HP_OK;
    for (unsigned i = 0, active = 0; i < part->primaries; i++) {
        if (active < part->active && part->order[active] == i)
            active++;
        else
            results[i] = masked;
    }
    asking->answered += part->primaries;
    asking->taken += part->primaries;
    return hp_tell_progress(asking->device, asking->answered, asking->n) ? HP_OK : HP_ERROR_CANCELLED;
}

hp_status hp_query(hp_device *device, const hp_query_def *def, const float *primaries, size_t n, hp_result *results) {
    hp_asking asking;
    hp_status status = hp_begin_asking(&asking, device, def, primaries, n, take_results);
    if (status) return status;
    asking.results = results;
    if (def->mode == HP_MODE_ALL)
        return hp_say(&device->message, HP_ERROR_USAGE, "mode all goes through hp_query_all");
    if (n && !results) return hp_say(&device->message, HP_ERROR_USAGE, "no place for the results");
    return hp_ask_all(&asking);
}
