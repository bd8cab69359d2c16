/* The clocked engine: not built yet; a board that asks for it is refused. */
#include "engine.h"

static hp_status clocked_create(hp_board *board) {
    (void)board;
    return HP_ERROR_USAGE;
}

const hp_engine hp_engine_clocked = {"clocked", clocked_create, NULL, NULL, NULL, NULL};
