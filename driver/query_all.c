/* hp_query_all: a record for each pair, handed on as it comes.
 *
 * Records come in the order of issue. Primary-outer: for each group of `lanes` active primaries, for each secondary,
 * for each primary of the group. Secondary-outer: for each secondary, for each active primary; that is the same with
 * one group of all. */
#include "asking.h"
#include "words.h"
#include <stdlib.h>

/* Where in that order a record stands. */
typedef struct place {
    unsigned group, size; /* first of the group's primaries, and how many it has */
    unsigned lane;        /* primary in the group */
    uint32_t secondary;   /* from 0 */
} place;

static unsigned group_size(const hp_asking *asking, const hp_part *part, unsigned group) {
    const hp_identity *board = &asking->device->identity;
    unsigned lanes = board->loop_order == HP_SECONDARY_OUTER ? part->active : board->lanes;
    return part->active - group < lanes ? part->active - group : lanes;
}

static place place_at(const hp_asking *asking, const hp_part *part, uint64_t position) {
    place at = {.size = group_size(asking, part, 0)};
    if (part->records == 0) return at;
    uint64_t group_records = (uint64_t)at.size * part->secondaries;
    at.group = (unsigned)(position / group_records) * at.size;
    position %= group_records;
    at.size = group_size(asking, part, at.group);
    if (at.size == 0) return at; /* behind the last record */
    at.secondary = (uint32_t)(position / at.size);
    at.lane = (unsigned)(position % at.size);
    return at;
}

static void next_place(const hp_asking *asking, const hp_part *part, place *at) {
    if (++at->lane < at->size) return;
    at->lane = 0;
    if (++at->secondary < part->secondaries) return;
    at->secondary = 0;
    at->group += at->size;
    at->size = group_size(asking, part, at->group);
}

static hp_status take_records(hp_command *command, const uint8_t *payload, uint32_t length, bool last) {
    hp_asking *asking = command->owner;
    hp_device *device = asking->device;
    const hp_part *part = &asking->parts[command->slot];
    uint32_t count;
    const uint8_t *records = hp_next_records(command, part, payload, length, last, &count);
    if (!records) return HP_ERROR_LENGTH;
    place at = place_at(asking, part, command->position);
    for (uint32_t i = 0; i < count; i++, next_place(asking, part, &at)) {
        hp_result record = hp_get_result(records + (size_t)i * HP_RESULT_BYTES);
        uint32_t secondary = part->first_secondary + at.secondary;
        if (!hp_plausible(asking, &record) || (record.F && record.index != secondary)) return HP_ERROR_FIELD;
        device->batch_records[i] = record;
        device->batch_primary[i] = (uint32_t)(part->first + part->order[at.group + at.lane]);
        device->batch_secondary[i] = secondary;
    }
    /* When this was asked before, on this link or one that is lost, the taker has the first records already. */
    uint64_t had = asking->had > command->position ? asking->had - command->position : 0;
    uint32_t skip = had < count ? (uint32_t)had : count;
    command->position += count;
    asking->had += count - skip;
    asking->taken += count - skip;
    if (skip < count && !asking->taker(asking->context, device->batch_primary + skip, device->batch_secondary + skip,
                                       device->batch_records + skip, count - skip))
        return HP_ERROR_CANCELLED;
    if (last) asking->answered += part->primaries;
    if (last) asking->had = 0;
    return hp_tell_progress(device, asking->answered, asking->n) ? HP_OK : HP_ERROR_CANCELLED;
}

static hp_status make_batch(hp_device *device) {
    size_t most = device->queue.in[0].room / HP_RESULT_BYTES;
    if (!device->batch_primary) device->batch_primary = malloc(most * sizeof *device->batch_primary);
    if (!device->batch_secondary) device->batch_secondary = malloc(most * sizeof *device->batch_secondary);
    if (!device->batch_records) device->batch_records = malloc(most * sizeof *device->batch_records);
    if (device->batch_primary && device->batch_secondary && device->batch_records) return HP_OK;
    return hp_say(&device->message, HP_ERROR_MEMORY, "no memory for a packet of records");
}

hp_status hp_query_all(hp_device *device, const hp_query_def *def, const float *primaries, size_t n,
                       hp_records_taker *take, void *context) {
    hp_asking asking;
    hp_status status = hp_begin_asking(&asking, device, def, primaries, n, take_records);
    asking.taker = take;
    asking.context = context;
    if (!status && def->mode != HP_MODE_ALL)
        status = hp_say(&device->message, HP_ERROR_USAGE, "hp_query_all is for mode all");
    if (!status && !take) status = hp_say(&device->message, HP_ERROR_USAGE, "nobody takes the records");
    if (!status) status = make_batch(device);
    return status ? status : hp_ask_all(&asking);
}
