/* Board configurations by key, from the rows of config.def. */
#include <hitpipe/config.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { PRESETS = 3, NAME_ROOM = sizeof((hp_config *)0)->name };

static const char *const preset_names[PRESETS] = {"usb3", "wscg2007", "ideal"};

/* A row of config.def. */
typedef struct knob {
    const char *key, *meaning;
    size_t offset; /* of the field in hp_config */
    uint64_t least, most;
    const char *choices; /* words with '|' between, stored as their place; NULL: a whole number */
    uint64_t preset[PRESETS];
} knob;

static const knob knobs[] = {
#define HP_KNOB(key, field, least, most, usb3, wscg2007, ideal, meaning)                                             \
    {key, meaning, offsetof(hp_config, field), least, most, NULL, {usb3, wscg2007, ideal}},
#define HP_CHOICE(key, field, choices, usb3, wscg2007, ideal, meaning)                                               \
    {key, meaning, offsetof(hp_config, field), 0, 0, choices, {usb3, wscg2007, ideal}},
#include <hitpipe/config.def>
};

enum { KNOBS = sizeof knobs / sizeof knobs[0], TEXT_KEYS = 2 };

/* The keys that are no numbers come before the knobs. */
static const struct {
    const char *key, *meaning, *range;
} text_keys[TEXT_KEYS] = {
    {"name", "what the board calls itself", "text of less than 32 bytes"},
    {"pipes", "pipes resident on the board", "names of pairs with commas between, or all, or none"},
};

static uint64_t knob_value(const hp_config *config, const knob *k) {
    uint64_t value;
    memcpy(&value, (const char *)config + k->offset, sizeof value);
    return value;
}

static void knob_store(hp_config *config, const knob *k, uint64_t value) {
    memcpy((char *)config + k->offset, &value, sizeof value);
}

static uint32_t all_pipes(void) {
    return 0
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) | UINT32_C(1) << code
#include <hitpipe/pairs.def>
#undef HP_PAIR
        ;
}

/* Word number `place` of "a|b|c" and its length; NULL past the last. */
static const char *choice_word(const char *choices, uint64_t place, size_t *length) {
    for (;; choices += *length + 1) {
        *length = strcspn(choices, "|");
        if (place-- == 0) return choices;
        if (choices[*length] == '\0') return NULL;
    }
}

static bool in_range(const knob *k, uint64_t value) {
    size_t length;
    return k->choices ? choice_word(k->choices, value, &length) != NULL : value >= k->least && value <= k->most;
}

/* ---- presets ---- */

const char *hp_config_preset_name(unsigned i) {
    return i < PRESETS ? preset_names[i] : NULL;
}

hp_status hp_config_preset(hp_config *config, const char *name) {
    unsigned preset = 0;
    while (preset < PRESETS && strcmp(name, preset_names[preset]) != 0) preset++;
    if (preset == PRESETS) return HP_ERROR_CONFIG;
    memset(config, 0, sizeof *config);
    strcpy(config->name, name);
    config->pipes = all_pipes();
    for (unsigned i = 0; i < KNOBS; i++) knob_store(config, &knobs[i], knobs[i].preset[preset]);
    return HP_OK;
}

/* ---- keys ---- */

const char *hp_config_key(unsigned i) {
    if (i < TEXT_KEYS) return text_keys[i].key;
    return i - TEXT_KEYS < KNOBS ? knobs[i - TEXT_KEYS].key : NULL;
}

const char *hp_config_meaning(unsigned i) {
    if (i < TEXT_KEYS) return text_keys[i].meaning;
    return i - TEXT_KEYS < KNOBS ? knobs[i - TEXT_KEYS].meaning : NULL;
}

/* "half or full", "a, b or c" */
static void choices_range(const char *choices, char *text, size_t room) {
    size_t length, used = 0;
    const char *word;
    for (uint64_t i = 0; (word = choice_word(choices, i, &length)) && used < room; i++) {
        const char *before = i == 0 ? "" : word[length] == '\0' ? " or " : ", ";
        used += (size_t)snprintf(text + used, room - used, "%s%.*s", before, (int)length, word);
    }
}

static void knob_range(const knob *k, char *text, size_t room) {
    if (k->choices)
        choices_range(k->choices, text, room);
    else
        snprintf(text, room, "%" PRIu64 " to %" PRIu64, k->least, k->most);
}

void hp_config_range(unsigned i, char *text, size_t room) {
    if (i < TEXT_KEYS)
        snprintf(text, room, "%s", text_keys[i].range);
    else if (i - TEXT_KEYS < KNOBS)
        knob_range(&knobs[i - TEXT_KEYS], text, room);
    else
        snprintf(text, room, "%s", "");
}

static unsigned key_number(const char *key) {
    unsigned i = 0;
    while (hp_config_key(i) && strcmp(key, hp_config_key(i)) != 0) i++;
    return i;
}

/* ---- a hint for a mistyped key ---- */

enum { KEY_ROOM = 64 };

/* Letters to insert, delete or replace to make one word of the other (Levenshtein 1966). Words under KEY_ROOM bytes.
 */
static unsigned edits(const char *a, const char *b) {
    unsigned row[KEY_ROOM];
    unsigned width = (unsigned)strlen(b);
    for (unsigned j = 0; j <= width; j++) row[j] = j;
    for (unsigned i = 0; a[i]; i++) {
        unsigned diagonal = row[0];
        row[0] = i + 1;
        for (unsigned j = 0; j < width; j++) {
            unsigned best = diagonal + (a[i] != b[j]);
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j + 1] + 1 < best) best = row[j + 1] + 1;
            diagonal = row[j + 1];
            row[j + 1] = best;
        }
    }
    return row[width];
}

/* The known key that `key` seems to mean, or NULL: at most a third of its letters differ, or its group is missing. */
static const char *nearest_key(const char *key) {
    size_t length = strlen(key);
    if (length >= KEY_ROOM) return NULL;
    const char *nearest = NULL;
    unsigned least = (unsigned)length / 3 + 1;
    for (unsigned i = 0; hp_config_key(i); i++) {
        const char *dot = strchr(hp_config_key(i), '.');
        unsigned whole = edits(key, hp_config_key(i));
        unsigned part = dot ? edits(key, dot + 1) : whole;
        unsigned distance = part < whole ? part : whole;
        if (distance < least) {
            least = distance;
            nearest = hp_config_key(i);
        }
    }
    return nearest;
}

static void unknown_key(const char *key, char *message) {
    const char *nearest = nearest_key(key);
    if (nearest)
        snprintf(message, HP_CONFIG_MESSAGE, "unknown key \"%.80s\"; did you mean \"%s\"?", key, nearest);
    else
        snprintf(message, HP_CONFIG_MESSAGE, "unknown key \"%.80s\"", key);
}

/* ---- setting ---- */

static bool read_number(const char *text, uint64_t *value) {
    *value = 0;
    if (*text == '\0') return false;
    for (; *text; text++) {
        if (*text < '0' || *text > '9') return false;
        unsigned digit = (unsigned)(*text - '0');
        if (*value > (UINT64_MAX - digit) / 10) return false;
        *value = *value * 10 + digit;
    }
    return true;
}

static bool read_choice(const char *text, const char *choices, uint64_t *value) {
    size_t length;
    const char *word;
    for (*value = 0; (word = choice_word(choices, *value, &length)); ++*value)
        if (strlen(text) == length && memcmp(text, word, length) == 0) return true;
    return false;
}

static bool read_pipes(const char *text, uint32_t *pipes) {
    char name[KEY_ROOM];
    if (strcmp(text, "all") == 0 || strcmp(text, "none") == 0) {
        *pipes = strcmp(text, "all") == 0 ? all_pipes() : 0;
        return true;
    }
    for (*pipes = 0;; text++) {
        size_t length = strcspn(text, ",");
        if (length >= sizeof name) return false;
        memcpy(name, text, length);
        name[length] = '\0';
        hp_pair pair = hp_pair_from_name(name);
        if (!pair) return false;
        *pipes |= UINT32_C(1) << pair;
        text += length;
        if (*text == '\0') return true;
    }
}

static bool read_name(const char *text, char *name) {
    if (strlen(text) >= NAME_ROOM) return false;
    memset(name, 0, NAME_ROOM);
    strcpy(name, text);
    return true;
}

static bool set_key(hp_config *config, unsigned key, const char *text) {
    if (key == 0) return read_name(text, config->name);
    if (key == 1) return read_pipes(text, &config->pipes);
    const knob *k = &knobs[key - TEXT_KEYS];
    uint64_t value;
    bool read = k->choices ? read_choice(text, k->choices, &value) : read_number(text, &value);
    if (!read || !in_range(k, value)) return false;
    knob_store(config, k, value);
    return true;
}

hp_status hp_config_set(hp_config *config, const char *key, const char *value, char *message) {
    unsigned number = key_number(key);
    if (!hp_config_key(number)) {
        unknown_key(key, message);
        return HP_ERROR_CONFIG;
    }
    hp_config changed = *config;
    if (!set_key(&changed, number, value)) {
        char range[HP_CONFIG_MESSAGE / 2];
        hp_config_range(number, range, sizeof range);
        snprintf(message, HP_CONFIG_MESSAGE, "%s = \"%.60s\" is not allowed: %s", key, value, range);
        return HP_ERROR_CONFIG;
    }
    *config = changed;
    return HP_OK;
}

/* ---- getting ---- */

static void pipes_text(uint32_t pipes, char *text, size_t room) {
    size_t used = 0;
    snprintf(text, room, "%s", pipes ? "" : "none");
    for (unsigned code = 0; code < 32; code++) {
        const char *name = pipes >> code & 1 ? hp_pair_name((hp_pair)code) : NULL;
        if (name && used < room) used += (size_t)snprintf(text + used, room - used, "%s%s", used ? "," : "", name);
    }
}

bool hp_config_get(const hp_config *config, const char *key, char *text, size_t room) {
    unsigned number = key_number(key);
    if (!hp_config_key(number) || room == 0) return false;
    if (number == 0) {
        snprintf(text, room, "%.*s", (int)NAME_ROOM, config->name);
    } else if (number == 1) {
        pipes_text(config->pipes, text, room);
    } else {
        const knob *k = &knobs[number - TEXT_KEYS];
        uint64_t value = knob_value(config, k);
        size_t length;
        const char *word = k->choices ? choice_word(k->choices, value, &length) : NULL;
        if (word)
            snprintf(text, room, "%.*s", (int)length, word);
        else
            snprintf(text, room, "%" PRIu64, value);
    }
    return true;
}

/* ---- rules ---- */

static hp_status refuse(char *message, const char *why) {
    snprintf(message, HP_CONFIG_MESSAGE, "%s", why);
    return HP_ERROR_CONFIG;
}

hp_status hp_config_check(const hp_config *config, char *message) {
    if (!memchr(config->name, '\0', NAME_ROOM)) return refuse(message, "name: text of less than 32 bytes");
    if (config->pipes & ~all_pipes()) return refuse(message, "pipes: known ones only");
    for (unsigned i = 0; i < KNOBS; i++) {
        uint64_t value = knob_value(config, &knobs[i]);
        if (in_range(&knobs[i], value)) continue;
        char range[HP_CONFIG_MESSAGE / 2];
        knob_range(&knobs[i], range, sizeof range);
        snprintf(message, HP_CONFIG_MESSAGE, "%s = %" PRIu64 " is not allowed: %s", knobs[i].key, value, range);
        return HP_ERROR_CONFIG;
    }
    /* A refresh closes the row: without a clock to spare after reopening it, no beat would ever move. */
    if (config->ddr_refresh_clocks &&
        config->ddr_refresh_clocks + config->ddr_row_clocks >= config->ddr_refresh_interval)
        return refuse(message, "ddr.refresh_clocks + ddr.row_clocks must be less than ddr.refresh_interval");
    return HP_OK;
}
