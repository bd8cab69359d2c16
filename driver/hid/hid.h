/* The control plane, inside: reports as bytes, what carries them, and which board is meant.
 *
 *     control.c  what the calls of control.h mean
 *        |  reports.c   bytes <-> identity, health, command, event; damaged ones end here
 *        v
 *     hp_hid     moves whole reports: hidapi.c, or a test's own
 *
 * A report is its ID and what follows, as hidapi has it: at most HP_HID_ROOM bytes. Not part of the public
 * interface. */
#ifndef HITPIPE_HID_H
#define HITPIPE_HID_H

#include "driver/message.h"
#include <hitpipe/control.h>
#include <hitpipe/usb.h>

enum { HP_HID_ROOM = HP_USB_REPORT_PACKET };

#define HP_CONTROL_COOKIE 0x31436848u /* "HhC1" */

/* ---- what carries reports ---- */

typedef struct hp_hid hp_hid;

/* On anything but HP_OK the words are in *message. */
typedef struct hp_hid_ops {
    /* Reads the feature report bytes[0] into `bytes`, the ID again first; *n: bytes that came. Errors of a request,
     * as control.h has them, but for those that only a look at the bytes can tell. */
    hp_status (*get_feature)(hp_hid *hid, uint8_t *bytes, size_t room, size_t *n, hp_message *message);
    /* Writes a feature report of n bytes, the ID among them. */
    hp_status (*set_feature)(hp_hid *hid, const uint8_t *bytes, size_t n, hp_message *message);
    /* The next input report; waits up to timeout_ms. HP_ERROR_TIMEOUT (without words), HP_ERROR_CANCELLED: a signal
     * was handled. */
    hp_status (*next_input)(hp_hid *hid, unsigned timeout_ms, uint8_t *bytes, size_t room, size_t *n,
                            hp_message *message);
    void (*close)(hp_hid *hid);
} hp_hid_ops;

/* The head of every carrier's own struct. */
struct hp_hid {
    const hp_hid_ops *ops;
};

/* hidapi: lists boards (*boards is the caller's to free), opens one of them. */
hp_status hp_hidapi_list(uint16_t vendor, uint16_t product, hp_control_board **boards, size_t *count,
                         hp_message *message);
hp_status hp_hidapi_open(const hp_control_board *board, hp_hid **hid, hp_message *message);

/* Which of the boards has the serial, or, with NULL, is the only one. HP_ERROR_NO_DEVICE, with words on what was
 * looked for and what there is. */
hp_status hp_hid_choose(const hp_control_board *boards, size_t count, const hp_control_def *def, size_t *chosen,
                        hp_message *message);

/* ---- features ---- */

typedef struct hp_feature_row {
    const char *name;
    unsigned since;
} hp_feature_row;

extern const hp_feature_row hp_features[HP_FEATURES];

/* Makes a control over a carrier, which becomes the control's, also on error. `serial` is what its IDENTITY must
 * have, NULL or "" any; `features` lives longer than the control. */
hp_status hp_control_over(hp_hid *hid, const char *serial, const hp_feature_row *features, hp_control **control,
                          hp_message *message);

/* ---- reports ---- */

/* What report CONTROL says when it is read. */
typedef struct hp_control_outcome {
    unsigned command, status;
    uint64_t argument;
} hp_control_outcome;

/* Each looks at a report of n bytes, the ID first, and on HP_OK fills in what it says. HP_ERROR_OPCODE,
 * HP_ERROR_LENGTH, HP_ERROR_FIELD with words. `version` is the board's: values that this one does not know are let
 * pass from a later one. */
hp_status hp_parse_identity(const uint8_t *bytes, size_t n, hp_control_identity *identity, hp_message *message);
hp_status hp_parse_health(const uint8_t *bytes, size_t n, unsigned version, hp_control_health *health,
                          hp_message *message);
hp_status hp_parse_outcome(const uint8_t *bytes, size_t n, hp_control_outcome *outcome, hp_message *message);
hp_status hp_parse_event(const uint8_t *bytes, size_t n, unsigned version, hp_control_event *event,
                         hp_message *message);

/* Writes a command as report CONTROL: 1 + HP_USB_BYTES_CONTROL bytes. */
void hp_write_command(uint8_t *bytes, unsigned command, uint64_t argument);

#endif
