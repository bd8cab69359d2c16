#include "targets.h"
#include "usb.h"
#include <hitpipe/pipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static hp_status open_model(const hp_device_def *def, hp_transport **transport, hp_message *message) {
    char why[HP_CONFIG_MESSAGE];
    if (hp_config_check(&def->board, why)) return hp_say(message, HP_ERROR_CONFIG, "%s", why);
    if (!hp_isa_choose(def->isa))
        return hp_say(message, HP_ERROR_USAGE, "the instruction set %.20s is not to be had here",
                      def->isa ? def->isa : getenv("HP_ISA"));
    if (def->vcd && !def->clocked) return hp_say(message, HP_ERROR_USAGE, "only the clocked engine writes waveforms");
    const hp_board_def board = {
        .config = def->board,
        .engine = def->clocked ? HP_ENGINE_CLOCKED : HP_ENGINE_QUICK,
        .isa = def->isa,
        .threads = def->threads,
        .vcd = def->vcd,
        .vcd_context = def->vcd_context,
    };
    hp_status status = hp_transport_model(&board, transport);
    return status ? hp_say(message, status, "cannot make the board: %s", hp_status_text(status)) : HP_OK;
}

static hp_status open_null(hp_transport **transport, hp_message *message) {
    hp_status status = hp_transport_null(transport);
    return status ? hp_say(message, status, "%s", hp_status_text(status)) : HP_OK;
}

hp_status hp_target_open(const hp_device_def *def, hp_transport **transport, hp_message *message) {
    if (!def->target || strcmp(def->target, "model") == 0) return open_model(def, transport, message);
    if (strcmp(def->target, "null") == 0) return open_null(transport, message);
    if (strcmp(def->target, "usb") == 0) return hp_transport_usb(def, NULL, transport, message);
    if (strncmp(def->target, "usb:", 4) == 0) return hp_transport_usb(def, def->target + 4, transport, message);
    return hp_say(message, HP_ERROR_NO_DEVICE, "no target \"%.60s\": there are model, usb, usb:SERIAL and null",
                  def->target);
}

void hp_target_again(hp_transport *transport, const hp_device_def *def, char *target, size_t room) {
    const char *serial = hp_transport_usb_serial(transport);
    if (serial && serial[0])
        snprintf(target, room, "usb:%s", serial);
    else
        snprintf(target, room, "%s", def->target ? def->target : "model");
}

void hp_target_identify(hp_transport *transport, const hp_device_def *def, hp_identity *identity) {
    hp_board *board = hp_transport_model_board(transport);
    identity->target = transport->ops->name;
    identity->engine = !board ? "hardware" : def->clocked ? "clocked" : "quick";
    identity->isa = board ? hp_board_isa(board) : "";
    const char *serial = hp_transport_usb_serial(transport);
    snprintf(identity->serial, sizeof identity->serial, "%s", serial ? serial : "");
}
