#include "targets.h"
#include <hitpipe/pipe.h>
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
    return hp_say(message, HP_ERROR_NO_DEVICE, "no target \"%.60s\": there are model and null", def->target);
}

void hp_target_identify(hp_transport *transport, const hp_device_def *def, hp_identity *identity) {
    hp_board *board = hp_transport_model_board(transport);
    identity->target = transport->ops->name;
    identity->engine = !board ? "hardware" : def->clocked ? "clocked" : "quick";
    identity->isa = board ? hp_board_isa(board) : "";
}
