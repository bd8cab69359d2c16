/* The HID: what the board is, how it is, what to do with it, and what happened. */
#include "internal.h"
#include <math.h>
#include <string.h>

enum { KIND_INPUT = 1, KIND_FEATURE = 3, REPORTS_VERSION = 1 };

#define AT(REPORT, name) HP_USB_AT_##REPORT##_##name

/* ---- identity, health ---- */

static void put_identity(const hp_gadget *gadget, uint8_t *to) {
    const hp_config *config = hp_board_config(gadget->board);
    hp_put16(to + AT(IDENTITY, protocol), HP_PROTOCOL_VERSION);
    hp_put16(to + AT(IDENTITY, reports), REPORTS_VERSION);
    hp_put32(to + AT(IDENTITY, pairs), config->pipes);
    hp_put64(to + AT(IDENTITY, clock_hz), config->clock_hz);
    memcpy(to + AT(IDENTITY, serial), gadget->serial, strlen(gadget->serial));
    memcpy(to + AT(IDENTITY, name), config->name, strnlen(config->name, sizeof config->name));
}

/* Counters of 32 bits stay at their most, so that one that went over does not look like a small one. */
static uint32_t clipped(uint64_t count) {
    return count < UINT32_MAX ? (uint32_t)count : UINT32_MAX;
}

static void put_health(hp_gadget *gadget, uint8_t *to) {
    hp_health health = hp_board_health(gadget->board);
    hp_put16(to + AT(HEALTH, temperature), (uint16_t)(int16_t)lrint(256 * health.celsius));
    to[AT(HEALTH, link)] = health.session;
    to[AT(HEALTH, speed)] = (uint8_t)gadget->speed;
    hp_put64(to + AT(HEALTH, packets), health.packets);
    hp_put32(to + AT(HEALTH, refused), clipped(health.refused));
    hp_put32(to + AT(HEALTH, crc), clipped(health.crc));
    hp_put32(to + AT(HEALTH, sequence), clipped(health.sequence));
    hp_put32(to + AT(HEALTH, events_lost), gadget->reports.lost);
    hp_put32(to + AT(HEALTH, resets), gadget->reports.resets);
}

/* ---- control ---- */

static hp_status reset(hp_gadget *gadget) {
    hp_gadget_reset_board(gadget);
    gadget->reports.resets++;
    return HP_OK;
}

static hp_status abort_waiting(hp_gadget *gadget) {
    hp_board_abort(gadget->board);
    hp_bulk_drop(gadget, false);
    return HP_OK;
}

static hp_status command(hp_gadget *gadget, unsigned code, uint64_t argument) {
    if (code != HP_USB_CONTROL_CLOCK && argument != 0) return HP_ERROR_FIELD;
    switch (code) {
    case HP_USB_CONTROL_RESET:
        return reset(gadget);
    case HP_USB_CONTROL_ABORT:
        return abort_waiting(gadget);
    case HP_USB_CONTROL_CLOCK:
        return hp_board_set_clock(gadget->board, argument);
    default:
        return HP_ERROR_OPCODE;
    }
}

bool hp_hid_set(hp_gadget *gadget, unsigned kind, unsigned id, const uint8_t *bytes, size_t n) {
    uint8_t *control = gadget->reports.control;
    if (kind != KIND_FEATURE || id != HP_USB_REPORT_CONTROL) return false;
    if (n != 1 + HP_USB_BYTES_CONTROL || bytes[0] != id) return false;
    unsigned code = hp_get16(bytes + 1 + AT(CONTROL, command)), status = hp_get16(bytes + 1 + AT(CONTROL, status));
    uint64_t argument = hp_get64(bytes + 1 + AT(CONTROL, argument));
    memcpy(control, bytes + 1, HP_USB_BYTES_CONTROL);
    hp_put16(control + AT(CONTROL, status), status ? HP_ERROR_FIELD : (uint16_t)command(gadget, code, argument));
    return true;
}

/* ---- getting ---- */

static size_t get_feature(hp_gadget *gadget, unsigned id, uint8_t *to) {
    switch (id) {
    case HP_USB_REPORT_IDENTITY:
        put_identity(gadget, to);
        return HP_USB_BYTES_IDENTITY;
    case HP_USB_REPORT_HEALTH:
        put_health(gadget, to);
        return HP_USB_BYTES_HEALTH;
    case HP_USB_REPORT_CONTROL:
        memcpy(to, gadget->reports.control, HP_USB_BYTES_CONTROL);
        return HP_USB_BYTES_CONTROL;
    default:
        return 0;
    }
}

/* An input report that is asked for is the newest event, which is not taken from those that wait. Before the first
 * one its kind is 0. */
size_t hp_hid_get(hp_gadget *gadget, unsigned kind, unsigned id, uint8_t room[HP_REPLY_ROOM]) {
    memset(room, 0, HP_REPLY_ROOM);
    room[0] = (uint8_t)id;
    if (kind == KIND_FEATURE) {
        size_t bytes = get_feature(gadget, id, room + 1);
        return bytes ? 1 + bytes : 0;
    }
    if (kind != KIND_INPUT || id != HP_USB_REPORT_EVENT) return 0;
    memcpy(room + 1, gadget->reports.last + 1, HP_USB_BYTES_EVENT);
    return HP_EVENT_BYTES;
}

/* ---- events ---- */

void hp_events_lose(hp_reports *reports) {
    reports->lost += reports->count;
    reports->count = 0;
}

/* When nobody fetches them, the oldest are lost: who looks again wants to know how things are now. */
void hp_event_add(hp_gadget *gadget, unsigned kind, hp_status status, uint32_t tag) {
    hp_reports *reports = &gadget->reports;
    uint8_t *report = reports->last, *event = report + 1;
    report[0] = HP_USB_REPORT_EVENT;
    hp_put16(event + AT(EVENT, kind), (uint16_t)kind);
    hp_put16(event + AT(EVENT, status), (uint16_t)status);
    hp_put32(event + AT(EVENT, number), reports->number++);
    hp_put32(event + AT(EVENT, tag), tag);
    hp_put64(event + AT(EVENT, clocks), hp_board_clock(gadget->board));
    if (reports->count == HP_EVENTS) {
        reports->head = (reports->head + 1) % HP_EVENTS;
        reports->count--;
        reports->lost++;
    }
    memcpy(reports->events[(reports->head + reports->count++) % HP_EVENTS], report, HP_EVENT_BYTES);
}

bool hp_event_run(hp_gadget *gadget) {
    hp_reports *reports = &gadget->reports;
    hp_urb *urb = gadget->queues[HP_ENDPOINT_EVENT].first;
    bool stalled;
    if (!urb) return false;
    if (!hp_endpoint_works(gadget, HP_ENDPOINT_EVENT, &stalled)) return stalled;
    if (!reports->count) return false;
    if (urb->length < HP_EVENT_BYTES) {
        hp_urb_finish(gadget, HP_ENDPOINT_EVENT, HP_URB_OVERFLOW, 0);
        return true;
    }
    memcpy(urb->bytes, reports->events[reports->head], HP_EVENT_BYTES);
    reports->head = (reports->head + 1) % HP_EVENTS;
    reports->count--;
    hp_urb_finish(gadget, HP_ENDPOINT_EVENT, HP_URB_OK, HP_EVENT_BYTES);
    return true;
}
