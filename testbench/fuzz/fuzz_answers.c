/* Hostile answers into the driver. Input: answers of the form
 *
 *     flags (1 byte), n (2 bytes), n bytes
 *
 * with flag bit 0: made a whole packet (magic, length, CRCs); bit 1: given the tag of the last packet sent; bit 2:
 * given sequence and limit as a good board would; bit 3: the link is lost instead. One comes each time the driver
 * waits, and silence after the last. Every call must end, and whatever it reports as an answer must be one that can
 * be true. */
#include "driver/device.h"
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

enum { WHOLE = 1, OUR_TAG = 2, IN_ORDER = 4, LOST = 8, RAYS = 5, TRIANGLES = 3, ROOM = 1 << 17 };

typedef struct script {
    hp_transport head;
    const uint8_t *data;
    size_t n;
    hp_transfer *out, *in;
    uint32_t tag, sequence; /* of the last packet sent */
    uint8_t packet[ROOM];
} script;

static void require(bool holds) {
    if (!holds) abort();
}

static void put_last(hp_transfer **list, hp_transfer *transfer) {
    while (*list) list = &(*list)->next;
    transfer->next = NULL;
    *list = transfer;
}

static void finish_first(hp_transfer **list, hp_status status, size_t moved) {
    hp_transfer *transfer = *list;
    *list = transfer->next;
    transfer->status = status;
    transfer->moved = moved;
    transfer->done(transfer);
}

static hp_status submit_out(hp_transport *transport, hp_transfer *transfer) {
    script *s = (script *)transport;
    s->tag = hp_get32(transfer->bytes + HP_AT_HEADER_tag);
    s->sequence = hp_get32(transfer->bytes + HP_AT_HEADER_sequence);
    put_last(&s->out, transfer);
    return HP_OK;
}

static hp_status submit_in(hp_transport *transport, hp_transfer *transfer) {
    put_last(&((script *)transport)->in, transfer);
    return HP_OK;
}

static hp_status cancel(hp_transport *transport, hp_transfer *transfer) {
    (void)transport, (void)transfer;
    return HP_OK;
}

/* The next packet of the script; its bytes in s->packet. */
static size_t next_packet(script *s, uint8_t flags, size_t n) {
    uint8_t *packet = s->packet;
    memset(packet, 0, HP_HEADER_BYTES);
    memcpy(packet, s->data, n);
    s->data += n;
    s->n -= n;
    if (!(flags & WHOLE)) return n;
    hp_header header = {.version = packet[HP_AT_HEADER_version],
                        .opcode = packet[HP_AT_HEADER_opcode],
                        .flags = hp_get16(packet + HP_AT_HEADER_flags),
                        .tag = flags & OUR_TAG ? s->tag : hp_get32(packet + HP_AT_HEADER_tag),
                        .length = n > HP_HEADER_BYTES ? (uint32_t)n - HP_HEADER_BYTES : 0,
                        .sequence = hp_get32(packet + HP_AT_HEADER_sequence),
                        .limit = hp_get32(packet + HP_AT_HEADER_limit),
                        .status = hp_get16(packet + HP_AT_HEADER_status)};
    if (flags & IN_ORDER) {
        header.sequence = s->sequence + 1;
        header.limit = s->sequence + 3;
    }
    return hp_packet_seal(packet, &header);
}

static hp_status poll(hp_transport *transport, unsigned timeout_ms, unsigned *completed) {
    script *s = (script *)transport;
    (void)timeout_ms;
    *completed = 1;
    if (s->out) {
        finish_first(&s->out, HP_OK, s->out->room);
        return HP_OK;
    }
    *completed = 0;
    if (s->n < 3 || !s->in) return HP_ERROR_TIMEOUT;
    uint8_t flags = s->data[0];
    size_t n = hp_get16(s->data + 1);
    s->data += 3;
    s->n -= 3;
    if (flags & LOST) return HP_ERROR_DISCONNECTED;
    n = next_packet(s, flags, n < s->n ? n : s->n);
    memcpy(s->in->bytes, s->packet, n);
    *completed = 1;
    finish_first(&s->in, HP_OK, n);
    return HP_OK;
}

static size_t transfer_max(const hp_transport *transport) {
    (void)transport;
    return ROOM;
}

static void close_script(hp_transport *transport) {
    script *s = (script *)transport;
    while (s->out) finish_first(&s->out, HP_ERROR_CANCELLED, 0);
    while (s->in) finish_first(&s->in, HP_ERROR_CANCELLED, 0);
    free(s);
}

static const hp_transport_ops ops = {
    .name = "script",
    .submit_out = submit_out,
    .submit_in = submit_in,
    .cancel = cancel,
    .poll = poll,
    .transfer_max = transfer_max,
    .close = close_script,
};

static void check(const hp_result *result) {
    require(result->F <= 1 && (result->F ? result->index < TRIANGLES : result->index == HP_NO_INDEX));
}

static bool take(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                 size_t count) {
    for (size_t i = 0; i < count; i++) {
        unsigned *times = (unsigned *)context + primary[i] * TRIANGLES + secondary[i];
        require(primary[i] < RAYS && secondary[i] < TRIANGLES && ++*times == 1);
        check(&records[i]);
    }
    return true;
}

static void call_everything(hp_device *device) {
    static const float triangles[TRIANGLES * 9] = {1};
    float rays[RAYS * 6];
    unsigned times[RAYS * TRIANGLES] = {0};
    hp_result results[RAYS];
    hp_counters counters;
    hp_query_def def = hp_default_query_def();
    for (unsigned i = 0; i < RAYS * 6; i++) rays[i] = 1;
    hp_upload(device, HP_TRIANGLE, triangles, TRIANGLES);
    def.packet = hp_identify(device)->packet_primaries < 2 ? 1 : 2;
    if (hp_query(device, &def, rays, RAYS, results) == HP_OK)
        for (unsigned i = 0; i < RAYS; i++) check(&results[i]);
    def.mode = HP_MODE_ALL;
    if (hp_query_all(device, &def, rays, RAYS, take, times) == HP_OK)
        for (unsigned i = 0; i < RAYS * TRIANGLES; i++) require(times[i] == 1);
    hp_transform(device, NULL);
    hp_read_counters(device, true, &counters);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n) {
    hp_device_def def = hp_default_device_def();
    hp_message message = {{0}};
    hp_device *device;
    script *s = calloc(1, sizeof *s);
    require(s != NULL);
    s->head.ops = &ops;
    s->data = data;
    s->n = n;
    def.retries = 2;
    hp_status status = hp_open_transport(&def, &s->head, &device, &message);
    require((status == HP_OK) == (device != NULL));
    require(status == HP_OK || message.text[0]);
    if (device) call_everything(device);
    hp_close(device);
    return 0;
}
