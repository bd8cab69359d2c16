/* What the calls of control.h mean, over whatever carries the reports. */
#include "hid.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct hp_control {
    hp_hid *hid;
    const hp_feature_row *features;
    hp_message message;
    hp_control_identity identity;
    bool counting;       /* an event came: */
    uint32_t next_event; /* the number of the one after it */
};

/* ---- features ---- */

const hp_feature_row hp_features[HP_FEATURES] = {
    [HP_FEATURE_HEALTH] = {"HEALTH", 1},
    [HP_FEATURE_EVENTS] = {"EVENTS", 1},
#define HP_USB_CONTROL(NAME, code, since, meaning) [HP_FEATURE_##NAME] = {#NAME, since},
#include <hitpipe/usb.def>
};

const char *hp_feature_name(hp_feature feature) {
    return (unsigned)feature < HP_FEATURES ? hp_features[feature].name : NULL;
}

unsigned hp_feature_since(hp_feature feature) {
    return (unsigned)feature < HP_FEATURES ? hp_features[feature].since : 0;
}

bool hp_control_can(const hp_control *control, hp_feature feature) {
    return (unsigned)feature < HP_FEATURES && control->identity.reports >= control->features[feature].since;
}

/* Every call on a control begins so. */
static hp_status begin(hp_control *control, hp_feature feature) {
    control->message.text[0] = '\0';
    if (hp_control_can(control, feature)) return HP_OK;
    const hp_feature_row *row = &control->features[feature];
    return hp_say(&control->message, HP_ERROR_VERSION,
                  "board %s lacks %s: it has version %u of the reports, and %s came with version %u",
                  control->identity.serial, row->name, control->identity.reports, row->name, row->since);
}

/* ---- requests ---- */

static hp_status get(hp_control *control, unsigned id, uint8_t bytes[HP_HID_ROOM], size_t *n) {
    bytes[0] = (uint8_t)id;
    return control->hid->ops->get_feature(control->hid, bytes, HP_HID_ROOM, n, &control->message);
}

static hp_status read_identity(hp_control *control) {
    uint8_t bytes[HP_HID_ROOM];
    size_t n;
    hp_status status = get(control, HP_USB_REPORT_IDENTITY, bytes, &n);
    return status ? status : hp_parse_identity(bytes, n, &control->identity, &control->message);
}

hp_status hp_control_read_identity(hp_control *control) {
    control->message.text[0] = '\0';
    return read_identity(control);
}

hp_status hp_control_read_health(hp_control *control, hp_control_health *health) {
    uint8_t bytes[HP_HID_ROOM];
    size_t n;
    hp_status status = begin(control, HP_FEATURE_HEALTH);
    if (!status) status = get(control, HP_USB_REPORT_HEALTH, bytes, &n);
    return status ? status : hp_parse_health(bytes, n, control->identity.reports, health, &control->message);
}

/* ---- commands ---- */

static hp_status judge(hp_control *control, const char *name, unsigned command, uint64_t argument,
                       const hp_control_outcome *outcome) {
    if (outcome->command != command || outcome->argument != argument)
        return hp_say(&control->message, HP_ERROR_TAG,
                      "the outcome of %s is not known: the board tells of command %u %" PRIu64
                      ", which another program gave it meanwhile",
                      name, outcome->command, outcome->argument);
    if (outcome->status == HP_OK) return HP_OK;
    const char *text = hp_status_text((hp_status)outcome->status);
    if (!text)
        return hp_say(&control->message, HP_ERROR_FIELD,
                      "the board refused %s %" PRIu64 " with the unknown status %u", name, argument, outcome->status);
    return hp_say(&control->message, (hp_status)outcome->status, "the board refused %s %" PRIu64 ": %s", name,
                  argument, text);
}

static hp_status command(hp_control *control, hp_feature feature, unsigned code, uint64_t argument) {
    uint8_t bytes[HP_HID_ROOM];
    size_t n;
    hp_control_outcome outcome;
    hp_status status = begin(control, feature);
    if (status) return status;
    hp_write_command(bytes, code, argument);
    status = control->hid->ops->set_feature(control->hid, bytes, 1 + HP_USB_BYTES_CONTROL, &control->message);
    if (!status) status = get(control, HP_USB_REPORT_CONTROL, bytes, &n);
    if (!status) status = hp_parse_outcome(bytes, n, &outcome, &control->message);
    return status ? status : judge(control, control->features[feature].name, code, argument, &outcome);
}

hp_status hp_control_reset(hp_control *control) {
    return command(control, HP_FEATURE_RESET, HP_USB_CONTROL_RESET, 0);
}

hp_status hp_control_abort(hp_control *control) {
    return command(control, HP_FEATURE_ABORT, HP_USB_CONTROL_ABORT, 0);
}

hp_status hp_control_set_clock(hp_control *control, uint64_t hz) {
    return command(control, HP_FEATURE_CLOCK, HP_USB_CONTROL_CLOCK, hz);
}

/* ---- events ---- */

static uint64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

/* An event's number against the one before. */
static hp_status count_event(hp_control *control, hp_control_event *event) {
    uint32_t expected = control->counting ? control->next_event : event->number;
    control->counting = true;
    control->next_event = event->number + 1;
    event->lost = event->number - expected;
    if (event->lost <= INT32_MAX) return HP_OK;
    return hp_say(&control->message, HP_ERROR_SEQUENCE,
                  "event %" PRIu32 " came after event %" PRIu32 ": the board was powered up anew, or repeats itself",
                  event->number, expected - 1);
}

/* A later version may have further input reports: they are no events. */
static hp_status next_report(hp_control *control, unsigned timeout_ms, uint8_t bytes[HP_HID_ROOM], size_t *n) {
    uint64_t end = now_ms() + timeout_ms;
    for (;;) {
        uint64_t now = now_ms();
        unsigned left = now < end ? (unsigned)(end - now) : 0;
        hp_status status =
            control->hid->ops->next_input(control->hid, left, bytes, HP_HID_ROOM, n, &control->message);
        bool later = control->identity.reports > hp_features[HP_FEATURE_EVENTS].since;
        if (status || *n == 0 || bytes[0] == HP_USB_REPORT_EVENT || !later) return status;
    }
}

hp_status hp_control_next_event(hp_control *control, unsigned timeout_ms, hp_control_event *event) {
    uint8_t bytes[HP_HID_ROOM];
    size_t n;
    hp_control_event came;
    hp_status status = begin(control, HP_FEATURE_EVENTS);
    if (!status) status = next_report(control, timeout_ms, bytes, &n);
    if (status == HP_ERROR_TIMEOUT) return hp_say(&control->message, status, "nothing happened in %u ms", timeout_ms);
    if (!status) status = hp_parse_event(bytes, n, control->identity.reports, &came, &control->message);
    if (!status) status = count_event(control, &came);
    if (!status) *event = came;
    return status;
}

/* ---- open and close ---- */

hp_control_def hp_default_control_def(void) {
    return (hp_control_def){.cookie = HP_CONTROL_COOKIE, .vendor = HP_USB_VENDOR, .product = HP_USB_PRODUCT};
}

static hp_status greet(hp_control *control, const char *serial) {
    hp_status status = read_identity(control);
    if (status || !serial || !*serial || strcmp(serial, control->identity.serial) == 0) return status;
    return hp_say(&control->message, HP_ERROR_FIELD,
                  "report IDENTITY is damaged: it has the serial number %s, and the device has %s",
                  control->identity.serial, serial);
}

hp_status hp_control_over(hp_hid *hid, const char *serial, const hp_feature_row *features, hp_control **out,
                          hp_message *message) {
    *out = NULL;
    hp_control *control = calloc(1, sizeof *control);
    if (!control) {
        hid->ops->close(hid);
        return hp_say(message, HP_ERROR_MEMORY, "%s", hp_status_text(HP_ERROR_MEMORY));
    }
    control->hid = hid;
    control->features = features;
    hp_status status = greet(control, serial);
    *message = control->message;
    if (status)
        hp_control_close(control);
    else
        *out = control;
    return status;
}

static _Thread_local hp_message open_message; /* of this thread's last hp_control_list or hp_control_open */

static hp_status check_def(const hp_control_def *def, const void *place) {
    open_message.text[0] = '\0';
    if (!place) return hp_say(&open_message, HP_ERROR_USAGE, "no place for the answer");
    if (!def || def->cookie != HP_CONTROL_COOKIE)
        return hp_say(&open_message, HP_ERROR_USAGE, "the control def does not come from hp_default_control_def");
    return HP_OK;
}

hp_status hp_control_list(const hp_control_def *def, hp_control_board *boards, size_t room, size_t *count) {
    hp_control_board *found;
    hp_status status = check_def(def, count);
    if (!status) status = hp_hidapi_list(def->vendor, def->product, &found, count, &open_message);
    if (status) return status;
    if (room > *count) room = *count;
    if (room) memcpy(boards, found, room * sizeof *boards);
    free(found);
    return HP_OK;
}

hp_status hp_control_open(const hp_control_def *def, hp_control **control) {
    hp_control_board *boards = NULL;
    hp_hid *hid;
    size_t count, chosen = 0;
    hp_status status = check_def(def, control);
    if (status && !control) return status;
    *control = NULL;
    if (!status) status = hp_hidapi_list(def->vendor, def->product, &boards, &count, &open_message);
    if (!status) status = hp_hid_choose(boards, count, def, &chosen, &open_message);
    if (!status) status = hp_hidapi_open(&boards[chosen], &hid, &open_message);
    if (!status) status = hp_control_over(hid, boards[chosen].serial, hp_features, control, &open_message);
    free(boards);
    return status;
}

void hp_control_close(hp_control *control) {
    if (!control) return;
    control->hid->ops->close(control->hid);
    free(control);
}

const hp_control_identity *hp_control_identify(const hp_control *control) {
    return &control->identity;
}

const char *hp_control_message(const hp_control *control) {
    return control ? control->message.text : open_message.text;
}
