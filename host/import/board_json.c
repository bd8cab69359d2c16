#include "host/import/board_json.h"

#include <jansson.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A board being made of a file. */
typedef struct board_file {
    const char *name;
    hp_config config;
    json_t *seen; /* an object with the keys that have been set */
    hp_fault *fault;
} board_file;

/* Writes names with commas between, "none" for no name. False: not an array of names, or too long. */
static bool names_text(json_t *names, char *text, size_t room) {
    size_t i, at = 0;
    json_t *item;
    json_array_foreach(names, i, item) {
        if (!json_is_string(item) || at >= room) return false;
        at += (size_t)snprintf(text + at, room - at, "%s%s", i ? "," : "", json_string_value(item));
    }
    if (i == 0) return (size_t)snprintf(text, room, "none") < room;
    return at > 0 && at < room;
}

/* Writes a value as text for hp_config_set. False: a kind of value that no knob takes, or too long; then the text is
 * for a message. */
static bool value_text(json_t *value, char *text, size_t room) {
    if (json_is_integer(value)) return snprintf(text, room, "%" JSON_INTEGER_FORMAT, json_integer_value(value)) > 0;
    if (json_is_string(value)) return (size_t)snprintf(text, room, "%s", json_string_value(value)) < room;
    if (json_is_array(value) && names_text(value, text, room)) return true;
    char *dump = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY);
    snprintf(text, room, "%s", dump ? dump : "?");
    free(dump);
    return false;
}

static hp_status set(board_file *file, const char *key, json_t *value) {
    char text[HP_CONFIG_MESSAGE], message[HP_CONFIG_MESSAGE];
    bool fits = value_text(value, text, sizeof text);
    /* what does not fit is set all the same: the refusal names the key and what it allows */
    if (hp_config_set(&file->config, key, text, message) != HP_OK)
        return hp_fault_set(file->fault, HP_ERROR_CONFIG, "%s: %s", file->name, message);
    if (!fits) return hp_fault_set(file->fault, HP_ERROR_CONFIG, "%s: %s takes text in quotes", file->name, key);
    if (json_object_get(file->seen, key))
        return hp_fault_set(file->fault, HP_ERROR_CONFIG, "%s: %s stands there twice", file->name, key);
    json_object_set_new(file->seen, key, json_true());
    return HP_OK;
}

/* Every value below `object`, under the dotted key made of the keys on the way to it. */
static hp_status set_all(board_file *file, const char *prefix, json_t *object) {
    const char *part;
    json_t *value;
    json_object_foreach(object, part, value) {
        char key[96];
        if ((size_t)snprintf(key, sizeof key, "%s%s%s", prefix, *prefix ? "." : "", part) >= sizeof key)
            return hp_fault_set(file->fault, HP_ERROR_CONFIG, "%s: unknown key \"%.64s...\"", file->name, key);
        if (strcmp(key, "preset") == 0) continue;
        bool group = json_object_size(value) > 0;
        hp_status status = group ? set_all(file, key, value) : set(file, key, value);
        if (status != HP_OK) return status;
    }
    return HP_OK;
}

static hp_status set_preset(const char *name, const char *preset, hp_config *config, hp_fault *fault) {
    if (preset && hp_config_preset(config, preset) == HP_OK) return HP_OK;
    char known[128] = "";
    for (unsigned i = 0; hp_config_preset_name(i); i++) {
        size_t at = strlen(known);
        snprintf(known + at, sizeof known - at, "%s%s", i ? ", " : "", hp_config_preset_name(i));
    }
    return hp_fault_set(fault, HP_ERROR_CONFIG, "%s: no such preset; there are %s (a file's name ends in .json)",
                        name, known);
}

hp_status hp_board_json_read(const hp_bytes *bytes, hp_config *config, hp_fault *fault) {
    json_error_t error;
    json_t *root = json_loadb((const char *)bytes->data, bytes->n, JSON_REJECT_DUPLICATES, &error);
    if (!root)
        return hp_fault_set(fault, HP_ERROR_CONFIG, "%s:%d:%d: %s", bytes->name, error.line, error.column,
                            error.text);
    board_file file = {.name = bytes->name, .config = *config, .seen = json_object(), .fault = fault};
    hp_status status = HP_OK;
    json_t *preset = json_object_get(root, "preset");
    if (!json_is_object(root))
        status = hp_fault_set(fault, HP_ERROR_CONFIG, "%s: a board is a JSON object of knobs", bytes->name);
    else if (preset)
        status = set_preset(bytes->name, json_string_value(preset), &file.config, fault);
    if (status == HP_OK) status = set_all(&file, "", root);
    json_decref(root);
    json_decref(file.seen);
    char message[HP_CONFIG_MESSAGE];
    if (status == HP_OK && hp_config_check(&file.config, message) != HP_OK)
        status = hp_fault_set(fault, HP_ERROR_CONFIG, "%s: %s", bytes->name, message);
    if (status == HP_OK) *config = file.config;
    return status;
}

hp_status hp_board_load(const char *name_or_path, hp_config *config, hp_fault *fault) {
    const char *dot = strrchr(name_or_path, '.');
    if (!dot || strcasecmp(dot, ".json") != 0) return set_preset(name_or_path, name_or_path, config, fault);
    hp_bytes bytes;
    hp_status status = hp_bytes_read(name_or_path, &bytes, fault);
    if (status != HP_OK) return status;
    status = hp_board_json_read(&bytes, config, fault);
    hp_bytes_free(&bytes);
    return status;
}
