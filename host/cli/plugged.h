/* The boards that are plugged in: what USB tells of each, and what its control plane does, matched by serial number.
 * For `info`. */
#ifndef HITPIPE_HOST_PLUGGED_H
#define HITPIPE_HOST_PLUGGED_H

#include "host/cli/cli.h"

#include <jansson.h>

/* What the control plane of a board said. */
typedef struct hp_plugged_hid {
    char path[128];
    char fault[512]; /* why it said nothing, or no more; "" when it said everything */
    bool asked;      /* identity and features are known */
    hp_control_identity identity;
    bool features[HP_FEATURES];
    bool healthy; /* health is known */
    hp_control_health health;
} hp_plugged_hid;

/* What USB tells of the device. */
typedef struct hp_plugged_usb {
    unsigned vendor, product, release; /* idVendor, idProduct, bcdDevice */
    unsigned bus, address, mbits;      /* mbits 0: unknown */
    char fault[512];                   /* why it cannot be opened; "" when it can */
} hp_plugged_usb;

typedef struct hp_plugged_board {
    char serial[64]; /* "" when it cannot be read */
    char product[64];
    bool on_usb, on_hid; /* which of these are there */
    hp_plugged_usb usb;
    hp_plugged_hid hid;
} hp_plugged_board;

typedef struct hp_plugged {
    hp_plugged_board *boards;
    size_t count;
    char usb_fault[512], hid_fault[512]; /* why there is no list of them; "" when there is */
} hp_plugged;

/* Looks for all boards with the identifiers that the options name, and asks each for its identity and health. No
 * session is opened: who uses a board does not notice. HP_ERROR_MEMORY; what cannot be asked is no error. */
hp_status hp_plugged_find(const hp_cli *cli, hp_plugged *plugged, hp_fault *fault);
void hp_plugged_free(hp_plugged *plugged);

/* For people, on standard output; and for machines, an object for each board appended to an array. */
void hp_plugged_print(const hp_cli *cli, const hp_plugged *plugged);
void hp_plugged_json(const hp_plugged *plugged, json_t *boards);

#endif
