/* A board configuration from a JSON file: the keys of config.def, dotted ("ddr.row_beats": 512) or nested
 * ("ddr": {"row_beats": 512}), over the preset that "preset" names (default: the one the caller gives).
 * "pipes" is a list of pair names, or text as hp_config_set takes it. */
#ifndef HITPIPE_HOST_BOARD_JSON_H
#define HITPIPE_HOST_BOARD_JSON_H

#include "host/import/bytes.h"

#include <hitpipe/config.h>

/* Changes *config, which holds the defaults. HP_ERROR_CONFIG names file, key and allowed range, and leaves *config as
 * it was: no JSON, an unknown key, a value out of its range, the same key twice, knobs that contradict each other. */
hp_status hp_board_json_read(const hp_bytes *bytes, hp_config *config, hp_fault *fault);

/* A preset by name, or a file if the name ends in ".json". HP_ERROR_CONFIG; HP_ERROR_INPUT: unreadable file. */
hp_status hp_board_load(const char *name_or_path, hp_config *config, hp_fault *fault);

#endif
