/* HELLO: agreeing on a version, and what the board says of itself. */
#include "device.h"
#include <string.h>

enum { OBJECT_BYTES_MAX = 4 * HP_OBJECT_WORDS_MAX };

static hp_identity read_identity(const uint8_t *reply) {
    hp_identity said = {
        .version = hp_get16(reply + HP_AT_HELLO_REPLY_version),
        .lanes = hp_get16(reply + HP_AT_HELLO_REPLY_lanes),
        .packet_primaries = hp_get32(reply + HP_AT_HELLO_REPLY_packet_size),
        .packet_buffers = hp_get32(reply + HP_AT_HELLO_REPLY_packet_buffers),
        .clock_hz = hp_get64(reply + HP_AT_HELLO_REPLY_clock_hz),
        .ddr_bytes = hp_get64(reply + HP_AT_HELLO_REPLY_ddr_bytes),
        .pairs = hp_get32(reply + HP_AT_HELLO_REPLY_pairs),
        .loop_order = (hp_loop_order)hp_get32(reply + HP_AT_HELLO_REPLY_loop_order),
        .subnormals = (hp_subnormals)hp_get32(reply + HP_AT_HELLO_REPLY_subnormals),
    };
    memcpy(said.name, reply + HP_AT_HELLO_REPLY_name, sizeof said.name - 1);
    return said;
}

/* Whether a driver can work with what the board says of itself. */
static bool sensible(const hp_identity *said, uint32_t payload_max) {
    return said->lanes >= 1 && said->packet_primaries >= 1 && said->packet_primaries <= HP_PACKET_PRIMARIES &&
           said->packet_buffers >= 1 && payload_max >= HP_QUERY_FIXED + OBJECT_BYTES_MAX &&
           (uint32_t)said->loop_order <= HP_SECONDARY_OUTER && (uint32_t)said->subnormals <= HP_FLUSH;
}

/* The window is reshaped once the answer is out of it: what the board said waits here. */
typedef struct reply {
    hp_identity said;
    uint32_t payload_max;
} reply;

static hp_status take_reply(hp_command *command, const uint8_t *payload, uint32_t length, bool last) {
    reply *into = command->owner;
    if (length != HP_HELLO_REPLY_FIXED || !last) return HP_ERROR_LENGTH;
    into->said = read_identity(payload);
    into->payload_max = hp_get32(payload + HP_AT_HELLO_REPLY_payload_max);
    if (into->said.version != HP_PROTOCOL_VERSION) return HP_ERROR_VERSION;
    return sensible(&into->said, into->payload_max) ? HP_OK : HP_ERROR_FIELD;
}

static void accept_reply(hp_device *device, const reply *from) {
    hp_identity said = from->said;
    const hp_identity *known = &device->identity;
    said.target = known->target;
    said.engine = known->engine;
    said.isa = known->isa;
    memcpy(said.serial, known->serial, sizeof said.serial);
    device->identity = said;
    unsigned window = device->def.in_flight ? device->def.in_flight : said.packet_buffers;
    if (window > said.packet_buffers) window = said.packet_buffers;
    if (window > HP_WINDOW_MAX) window = HP_WINDOW_MAX;
    size_t payload_max = device->queue.payload_max;
    if (payload_max > from->payload_max) payload_max = from->payload_max;
    hp_queue_shape(&device->queue, window, payload_max);
    device->session = true;
}

hp_status hp_say_hello(hp_device *device) {
    hp_command *command;
    reply from;
    hp_status status = hp_queue_reserve(&device->queue, &command);
    if (status) return status;
    command->opcode = HP_OPCODE_HELLO;
    command->reply = HP_OPCODE_HELLO_REPLY;
    command->length = HP_HELLO_FIXED;
    command->take = take_reply;
    command->owner = &from;
    hp_put16(command->payload + HP_AT_HELLO_version_min, HP_PROTOCOL_VERSION);
    hp_put16(command->payload + HP_AT_HELLO_version_max, HP_PROTOCOL_VERSION);
    hp_put32(command->payload + HP_AT_HELLO_features, 0);
    status = hp_ask(device, command);
    if (status) return status;
    accept_reply(device, &from);
    device->transform_due = device->transformed;
    return HP_OK;
}
