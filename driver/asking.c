/* Splitting a query into packets, and the checks at the edge. */
#include "asking.h"
#include "words.h"

static bool in_stencil(const uint32_t *stencil, size_t i) {
    return !stencil || stencil[i / 32] >> i % 32 & 1;
}

/* ---- checks ---- */

static hp_status check_def(const hp_asking *asking) {
    const hp_query_def *def = asking->def;
    hp_message *message = &asking->device->message;
    const hp_identity *board = &asking->device->identity;
    if (def->cookie != HP_QUERY_COOKIE)
        return hp_say(message, HP_ERROR_USAGE, "the query def does not come from hp_default_query_def");
    if (!hp_pair_name(def->pair)) return hp_say(message, HP_ERROR_USAGE, "no pair has the number %d", (int)def->pair);
    if (!hp_mode_name(def->mode)) return hp_say(message, HP_ERROR_USAGE, "no mode has the number %d", (int)def->mode);
    if (!(board->pairs >> def->pair & 1))
        return hp_say(message, HP_ERROR_NOT_RESIDENT, "%s is not among the pipes of board %s",
                      hp_pair_name(def->pair), board->name);
    if (def->packet > board->packet_primaries)
        return hp_say(message, HP_ERROR_USAGE, "packets of %zu primaries: the board takes %u", def->packet,
                      board->packet_primaries);
    if (def->nearest && def->mode != HP_MODE_CLOSEST)
        return hp_say(message, HP_ERROR_USAGE, "nearest is for mode closest, not for %s", hp_mode_name(def->mode));
    if (asking->n && !asking->primaries) return hp_say(message, HP_ERROR_USAGE, "no primaries given");
    if (asking->n > HP_NO_INDEX) return hp_say(message, HP_ERROR_USAGE, "too many primaries: %zu", asking->n);
    return HP_OK;
}

static hp_status check_secondaries(hp_asking *asking) {
    hp_device *device = asking->device;
    const hp_query_def *def = asking->def;
    hp_object object = hp_pair_secondary(def->pair);
    if (!device->scene) return hp_say(&device->message, HP_ERROR_CAPACITY, "no secondaries were uploaded");
    if (device->scene != object)
        return hp_say(&device->message, HP_ERROR_USAGE, "%s needs objects of type %s, the scene has type %s",
                      hp_pair_name(def->pair), hp_object_name(object), hp_object_name(device->scene));
    const char *fault =
        device->transformed && !device->def.unchecked ? hp_transform_fault(object, device->matrix) : NULL;
    if (fault) return hp_say(&device->message, HP_ERROR_INPUT, "transform: %s", fault);
    size_t rest = def->first <= device->scene_count ? device->scene_count - def->first : 0;
    size_t count = def->count;
    if (def->mode == HP_MODE_ZIP) {
        if (count && count != asking->n)
            return hp_say(&device->message, HP_ERROR_USAGE, "mode zip: %zu primaries, %zu secondaries", asking->n,
                          count);
        count = asking->n;
    } else if (count == 0) {
        count = rest;
    }
    if (def->first > device->scene_count || count > rest)
        return hp_say(&device->message, HP_ERROR_CAPACITY, "secondaries %zu and %zu more: the scene has %zu",
                      def->first, count, device->scene_count);
    asking->secondaries = (uint32_t)count;
    return HP_OK;
}

static hp_status check_primaries(const hp_asking *asking) {
    hp_device *device = asking->device;
    hp_object object = hp_pair_primary(asking->def->pair);
    unsigned words = hp_object_words(object);
    for (size_t i = 0; i < asking->n && !device->def.unchecked; i++) {
        const char *fault = hp_object_fault(object, asking->primaries + i * words);
        if (fault) return hp_say(&device->message, HP_ERROR_INPUT, "primary %zu: %s", i, fault);
    }
    return HP_OK;
}

hp_status hp_begin_asking(hp_asking *asking, hp_device *device, const hp_query_def *def, const float *primaries,
                          size_t n, hp_take_answer *take) {
    if (!device) return HP_ERROR_USAGE;
    device->completed = 0;
    hp_status status = hp_begin(device);
    if (status) return status;
    if (!def) return hp_say(&device->message, HP_ERROR_USAGE, "no query def");
    asking->device = device;
    asking->def = def;
    asking->primaries = primaries;
    asking->n = n;
    asking->take = take;
    asking->answered = 0;
    asking->had = asking->taken = 0;
    status = check_def(asking);
    if (!status) status = check_secondaries(asking);
    if (!status) status = check_primaries(asking);
    if (status) return status;
    size_t bytes = 4 * hp_object_words(hp_pair_primary(asking->def->pair));
    size_t fit = (asking->device->queue.payload_max - HP_QUERY_FIXED) / bytes;
    asking->packet = asking->def->packet ? asking->def->packet : asking->device->identity.packet_primaries;
    if (asking->packet > fit) asking->packet = fit;
    return HP_OK;
}

/* ---- packets ---- */

static uint64_t records_of(const hp_asking *asking, const hp_part *part) {
    return asking->def->mode == HP_MODE_ALL ? (uint64_t)part->active * part->secondaries : part->active;
}

static void fill_part(const hp_asking *asking, size_t first, hp_part *part) {
    bool zip = asking->def->mode == HP_MODE_ZIP;
    size_t left = asking->n - first;
    part->first = first;
    part->primaries = (unsigned)(left < asking->packet ? left : asking->packet);
    part->active = 0;
    for (unsigned i = 0; i < part->primaries; i++)
        if (in_stencil(asking->def->stencil, first + i)) part->order[part->active++] = (uint8_t)i;
    part->first_secondary = (uint32_t)(asking->def->first + (zip ? first : 0));
    part->secondaries = zip ? part->primaries : asking->secondaries;
    part->records = records_of(asking, part);
}

static uint32_t options_of(const hp_query_def *def) {
    bool shows = def->mode == HP_MODE_ALL || def->mode == HP_MODE_ZIP || def->nearest;
    bool separation = def->separation == HP_SEPARATION_AUTO ? shows : def->separation == HP_SEPARATION_ON;
    return (separation ? HP_OPTION_SEPARATION : 0) | (def->nearest ? HP_OPTION_NEAREST : 0);
}

static void fill_query(const hp_asking *asking, const hp_part *part, hp_command *command) {
    uint8_t *payload = command->payload;
    unsigned words = hp_object_words(hp_pair_primary(asking->def->pair));
    memset(payload, 0, HP_QUERY_FIXED);
    hp_put32(payload + HP_AT_QUERY_pair, (uint32_t)asking->def->pair);
    hp_put32(payload + HP_AT_QUERY_mode, (uint32_t)asking->def->mode);
    hp_put32(payload + HP_AT_QUERY_options, options_of(asking->def));
    hp_put32(payload + HP_AT_QUERY_first, part->first_secondary);
    hp_put32(payload + HP_AT_QUERY_count, part->secondaries);
    hp_put32(payload + HP_AT_QUERY_primaries, part->primaries);
    for (unsigned i = 0; i < part->active; i++)
        payload[HP_AT_QUERY_stencil + part->order[i] / 8] |= (uint8_t)(1 << part->order[i] % 8);
    hp_put_words(payload + HP_QUERY_FIXED, asking->primaries + part->first * words, (size_t)part->primaries * words);
    command->opcode = HP_OPCODE_QUERY;
    command->reply = HP_OPCODE_RESULT;
    command->length = HP_QUERY_FIXED + 4 * words * part->primaries;
}

static hp_status ask_rest(hp_asking *asking) {
    hp_queue *queue = &asking->device->queue;
    hp_status status = HP_OK;
    for (size_t first = asking->answered; first < asking->n && !status; first += asking->packet) {
        hp_command *command;
        status = hp_queue_reserve(queue, &command);
        if (status) break;
        hp_part *part = &asking->parts[command->slot];
        fill_part(asking, first, part);
        fill_query(asking, part, command);
        command->take = asking->take;
        command->owner = asking;
        hp_queue_post(queue, command);
    }
    return hp_end(asking->device, hp_queue_finish(queue));
}

hp_status hp_ask_all(hp_asking *asking) {
    hp_device *device = asking->device;
    hp_status status;
    device->progress_total = asking->n;
    do status = ask_rest(asking);
    while (status && hp_recover(device, &status, asking->taken));
    device->completed = asking->answered;
    if (status) hp_say_also(&device->message, "; %zu of %zu primaries answered", asking->answered, asking->n);
    return status;
}

/* ---- answers ---- */

const uint8_t *hp_next_records(const hp_command *command, const hp_part *part, const uint8_t *payload,
                               uint32_t length, bool last, uint32_t *count) {
    if (length < HP_RESULT_FIXED) return NULL;
    *count = hp_get32(payload + HP_AT_RESULT_count);
    uint64_t left = part->records - command->position;
    bool whole = length - HP_RESULT_FIXED == (uint64_t)*count * HP_RESULT_BYTES;
    bool next = hp_get64(payload + HP_AT_RESULT_first) == command->position && *count <= left;
    return whole && next && (!last || *count == left) ? payload + HP_RESULT_FIXED : NULL;
}

bool hp_plausible(const hp_asking *asking, const hp_result *record) {
    return record->F <= 1 && (record->F || record->index == HP_NO_INDEX || asking->def->nearest);
}
