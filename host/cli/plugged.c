#include "host/cli/plugged.h"

#include "driver/transport/usb.h"
#include "host/cli/pair.h"
#include "host/output/report.h"

#include <inttypes.h>

#include <stdlib.h>
#include <string.h>

/* ---- USB ---- */

static hp_plugged_board from_usb(const hp_usb_board *found) {
    hp_plugged_board board = {
        .on_usb = true,
        .usb = {.vendor = found->vendor,
                .product = found->product_id,
                .release = found->release,
                .bus = found->bus,
                .address = found->address,
                .mbits = found->mbits},
    };
    snprintf(board.serial, sizeof board.serial, "%s", found->serial);
    snprintf(board.product, sizeof board.product, "%s", found->product);
    if (found->error)
        snprintf(board.usb.fault, sizeof board.usb.fault, "cannot be opened: %s%s", hp_usb_words(found->error),
                 hp_usb_advice(found->error));
    return board;
}

static hp_status find_usb(const hp_cli *cli, hp_plugged *plugged, hp_usb_board **found, size_t *count) {
    hp_message message = {""};
    hp_status status = hp_usb_list(&cli->device, found, count, &message);
    if (status) snprintf(plugged->usb_fault, sizeof plugged->usb_fault, "%s", message.text);
    return status == HP_ERROR_MEMORY ? status : HP_OK;
}

/* ---- HID ---- */

static void ask_health(hp_control *control, hp_plugged_hid *hid) {
    if (!hid->features[HP_FEATURE_HEALTH]) return;
    hid->healthy = hp_control_read_health(control, &hid->health) == HP_OK;
    if (!hid->healthy) snprintf(hid->fault, sizeof hid->fault, "%s", hp_control_message(control));
}

/* By its serial number: a board that has none to tell is only opened where it is the only one. */
static void ask(const hp_control_def *def, const hp_control_board *found, hp_plugged_hid *hid) {
    hp_control_def one = *def;
    hp_control *control;
    one.serial = found->serial;
    if (hp_control_open(&one, &control)) {
        snprintf(hid->fault, sizeof hid->fault, "%s", hp_control_message(NULL));
        return;
    }
    hid->asked = true;
    hid->identity = *hp_control_identify(control);
    for (int i = 0; i < HP_FEATURES; i++) hid->features[i] = hp_control_can(control, (hp_feature)i);
    ask_health(control, hid);
    hp_control_close(control);
}

/* The board that USB told of with this serial number, or a new one. */
static hp_plugged_board *place(hp_plugged *plugged, const hp_control_board *found) {
    for (size_t i = 0; i < plugged->count && found->serial[0]; i++)
        if (!plugged->boards[i].on_hid && strcmp(plugged->boards[i].serial, found->serial) == 0)
            return &plugged->boards[i];
    hp_plugged_board *board = &plugged->boards[plugged->count++];
    snprintf(board->serial, sizeof board->serial, "%s", found->serial);
    snprintf(board->product, sizeof board->product, "%s", found->name);
    return board;
}

static void add_hid(const hp_control_def *def, const hp_control_board *found, hp_plugged *plugged) {
    hp_plugged_board *board = place(plugged, found);
    board->on_hid = true;
    snprintf(board->hid.path, sizeof board->hid.path, "%s", found->path);
    ask(def, found, &board->hid);
}

static hp_status find_hid(const hp_control_def *def, hp_plugged *plugged, hp_control_board **found, size_t *count) {
    hp_status status = hp_control_list(def, NULL, 0, count);
    size_t room = *count;
    *found = calloc(room + 1, sizeof **found);
    if (!*found) return HP_ERROR_MEMORY;
    if (!status && room) status = hp_control_list(def, *found, room, count);
    if (status) snprintf(plugged->hid_fault, sizeof plugged->hid_fault, "%s", hp_control_message(NULL));
    if (status || *count > room) *count = status ? 0 : room; /* plugged in meanwhile: for the next time */
    return HP_OK;
}

/* ---- both ---- */

static hp_status put_together(const hp_control_def *def, const hp_usb_board *usbs, size_t usb_count,
                              const hp_control_board *hids, size_t hid_count, hp_plugged *plugged) {
    plugged->boards = calloc(usb_count + hid_count + 1, sizeof *plugged->boards);
    if (!plugged->boards) return HP_ERROR_MEMORY;
    for (size_t i = 0; i < usb_count; i++) plugged->boards[plugged->count++] = from_usb(&usbs[i]);
    for (size_t i = 0; i < hid_count; i++) add_hid(def, &hids[i], plugged);
    return HP_OK;
}

hp_status hp_plugged_find(const hp_cli *cli, hp_plugged *plugged, hp_fault *fault) {
    hp_control_def def = hp_default_control_def();
    hp_usb_board *usbs = NULL;
    hp_control_board *hids = NULL;
    size_t usb_count = 0, hid_count = 0;
    *plugged = (hp_plugged){0};
    def.vendor = (uint16_t)cli->device.usb_vendor;
    def.product = (uint16_t)cli->device.usb_product;
    hp_status status = find_usb(cli, plugged, &usbs, &usb_count);
    if (!status) status = find_hid(&def, plugged, &hids, &hid_count);
    if (!status) status = put_together(&def, usbs, usb_count, hids, hid_count, plugged);
    free(usbs);
    free(hids);
    return status ? hp_fault_set(fault, status, "out of memory") : HP_OK;
}

void hp_plugged_free(hp_plugged *plugged) {
    free(plugged->boards);
    *plugged = (hp_plugged){0};
}

/* ---- for people ---- */

static void print_usb(const hp_plugged_board *board) {
    const hp_plugged_usb *usb = &board->usb;
    printf("usb        %04x:%04x release %x.%02x, bus %u, address %u", usb->vendor, usb->product, usb->release >> 8,
           usb->release & 0xFF, usb->bus, usb->address);
    if (usb->mbits) printf(", %u Mbit/s", usb->mbits);
    printf("%s%s\n", usb->fault[0] ? "; " : "", usb->fault);
}

static void print_health(const hp_control_health *health) {
    printf("health     %.1f degrees Celsius, %s, packets: %" PRIu64 ", refused: %" PRIu32 " (CRC: %" PRIu32
           ", order: %" PRIu32 "), resets: %" PRIu32 ", events lost: %" PRIu32 "\n",
           health->celsius, health->session ? "session open" : "no session", health->packets, health->refused,
           health->crc, health->sequence, health->resets, health->events_lost);
}

static void print_hid(const hp_plugged_hid *hid) {
    char names[512];
    printf("hid        %s", hid->path);
    if (hid->fault[0]) printf("; %s", hid->fault);
    putchar('\n');
    if (!hid->asked) return;
    hp_cli_pair_names(hid->identity.pairs, names, sizeof names);
    printf("board      %s, protocol %u, clock %.6g MHz\npipes      %s\ncontrol    reports of version %u:",
           hid->identity.name, hid->identity.protocol, (double)hid->identity.clock_hz / 1e6, names,
           hid->identity.reports);
    for (int i = 0, shown = 0; i < HP_FEATURES; i++)
        if (hid->features[i]) printf("%s %s", shown++ ? "," : "", hp_feature_name((hp_feature)i));
    putchar('\n');
    if (hid->healthy) print_health(&hid->health);
}

static void print_one(const hp_plugged_board *board) {
    printf("\ntarget     usb%s%s, %s\n", board->serial[0] ? ":" : " ", board->serial[0] ? board->serial : "?",
           board->product[0] ? board->product : "name not known");
    if (board->on_usb) print_usb(board);
    if (board->on_hid) print_hid(&board->hid);
}

void hp_plugged_print(const hp_cli *cli, const hp_plugged *plugged) {
    if (plugged->usb_fault[0]) printf("\nUSB boards cannot be listed: %s\n", plugged->usb_fault);
    if (plugged->hid_fault[0]) printf("\nHID boards cannot be listed: %s\n", plugged->hid_fault);
    if (!plugged->count)
        printf("\nNo board is plugged in: looked for %04x:%04x on USB and among HID devices.\n",
               cli->device.usb_vendor, cli->device.usb_product);
    for (size_t i = 0; i < plugged->count; i++) print_one(&plugged->boards[i]);
}

/* ---- for machines ---- */

static json_t *text_or_null(const char *text) {
    return text[0] ? hp_report_string(text) : json_null();
}

static json_t *usb_json(const hp_plugged_usb *usb) {
    char vendor[16], product[16], release[16];
    snprintf(vendor, sizeof vendor, "%04x", usb->vendor);
    snprintf(product, sizeof product, "%04x", usb->product);
    snprintf(release, sizeof release, "%x.%02x", usb->release >> 8, usb->release & 0xFF);
    return json_pack("{s:s, s:s, s:s, s:i, s:i, s:i, s:o}", "vendor", vendor, "product", product, "release", release,
                     "bus", (int)usb->bus, "address", (int)usb->address, "mbits", (int)usb->mbits, "fault",
                     text_or_null(usb->fault));
}

static json_t *health_json(const hp_control_health *health) {
    return json_pack("{s:f, s:b, s:i, s:I, s:I, s:I, s:I, s:I, s:I}", "celsius", health->celsius, "session",
                     health->session, "speed", (int)health->speed, "packets", (json_int_t)health->packets, "refused",
                     (json_int_t)health->refused, "crc", (json_int_t)health->crc, "sequence",
                     (json_int_t)health->sequence, "events_lost", (json_int_t)health->events_lost, "resets",
                     (json_int_t)health->resets);
}

static json_t *hid_json(const hp_plugged_hid *hid) {
    char names[512];
    json_t *json = json_pack("{s:o, s:o}", "path", hp_report_string(hid->path), "fault", text_or_null(hid->fault));
    if (!hid->asked) return json;
    hp_cli_pair_names(hid->identity.pairs, names, sizeof names);
    hp_report_set(json, "board", hp_report_string(hid->identity.name));
    hp_report_set(json, "protocol", json_integer(hid->identity.protocol));
    hp_report_set(json, "reports", json_integer(hid->identity.reports));
    hp_report_set(json, "clock_hz", json_integer((json_int_t)hid->identity.clock_hz));
    hp_report_set(json, "pairs", json_string(names));
    json_t *features = json_array();
    for (int i = 0; i < HP_FEATURES; i++)
        if (hid->features[i]) json_array_append_new(features, json_string(hp_feature_name((hp_feature)i)));
    hp_report_set(json, "features", features);
    if (hid->healthy) hp_report_set(json, "health", health_json(&hid->health));
    return json;
}

void hp_plugged_json(const hp_plugged *plugged, json_t *boards) {
    for (size_t i = 0; i < plugged->count; i++) {
        const hp_plugged_board *board = &plugged->boards[i];
        char target[80];
        snprintf(target, sizeof target, "usb%s%s", board->serial[0] ? ":" : "", board->serial);
        json_t *json = json_pack("{s:s, s:o, s:o}", "target", target, "serial", text_or_null(board->serial),
                                 "product", text_or_null(board->product));
        if (board->on_usb) hp_report_set(json, "usb", usb_json(&board->usb));
        if (board->on_hid) hp_report_set(json, "hid", hid_json(&board->hid));
        json_array_append_new(boards, json);
    }
}
