#include "host/import/board_json.h"

#include <jansson.h>

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Writes a value as text for hp_config_set. False: a kind of value that no knob takes, or too long. */
static bool value_text(json_t *value, char *text, size_t room) {
    int n = -1;
    if (json_is_integer(value))
        n = snprintf(text, room, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (json_is_string(value))
        n = snprintf(text, room, "%s", json_string_value(value));
    else if (json_is_array(value)) {
        size_t i, at = 0;
        json_t *item;
        json_array_foreach(value, i, item) {
            if (!json_is_string(item) || at >= room) return false;
            at += (size_t)snprintf(text + at, room - at, "%s%s", i ? "," : "", json_string_value(item));
        }
        n = at < room && at > 0 ? (int)at : -1;
    }
    return n >= 0 && (size_t)n < room;
}

static hp_status set(const char *name, const char *key, json_t *value, hp_config *config, hp_fault *fault) {
    char text[HP_CONFIG_MESSAGE], message[HP_CONFIG_MESSAGE];
    if (!value_text(value, text, sizeof text))
        return hp_fault_set(fault, HP_ERROR_CONFIG, "%s: %s: a whole number or a word is needed", name, key);
    if (hp_config_set(config, key, text, message) == HP_OK) return HP_OK;
    return hp_fault_set(fault, HP_ERROR_CONFIG, "%s: %s", name, message);
}

/* Every value below `object`, under the dotted key made of the keys on the way to it. */
static hp_status set_all(const char *name, const char *prefix, json_t *object, hp_config *config, hp_fault *fault) {
    const char *part;
    json_t *value;
    json_object_foreach(object, part, value) {
        char key[96];
        if ((size_t)snprintf(key, sizeof key, "%s%s%s", prefix, *prefix ? "." : "", part) >= sizeof key)
            return hp_fault_set(fault, HP_ERROR_CONFIG, "%s: %.64s...: no such key", name, key);
        if (strcmp(key, "preset") == 0) continue;
        hp_status status =
            json_is_object(value) ? set_all(name, key, value, config, fault) : set(name, key, value, config, fault);
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
    hp_config made = *config;
    hp_status status = HP_OK;
    json_t *preset = json_object_get(root, "preset");
    if (!json_is_object(root))
        status = hp_fault_set(fault, HP_ERROR_CONFIG, "%s: a board is a JSON object of knobs", bytes->name);
    else if (preset)
        status = set_preset(bytes->name, json_string_value(preset), &made, fault);
    if (status == HP_OK) status = set_all(bytes->name, "", root, &made, fault);
    json_decref(root);
    char message[HP_CONFIG_MESSAGE];
    if (status == HP_OK && hp_config_check(&made, message) != HP_OK)
        status = hp_fault_set(fault, HP_ERROR_CONFIG, "%s: %s", bytes->name, message);
    if (status == HP_OK) *config = made;
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
