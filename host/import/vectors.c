#include "host/import/vectors.h"

#include "host/import/text.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const char *const numerics_names[] = {
    [HP_NUMERICS_GRADUAL] = "gradual", [HP_NUMERICS_FLUSH] = "flush", [HP_NUMERICS_ANY] = "any"};

const char *hp_numerics_name(hp_numerics numerics) {
    return numerics_names[numerics];
}

static unsigned primary_words(const hp_vectors *vectors) {
    return hp_object_words(hp_pair_primary(vectors->pair));
}
static unsigned secondary_words(const hp_vectors *vectors) {
    return hp_object_words(hp_pair_secondary(vectors->pair));
}

/* ---- building
 * -------------------------------------------------------------------------------------------------------- */

static hp_status out_of_memory(hp_fault *fault) {
    return hp_fault_set(fault, HP_ERROR_MEMORY, "out of memory for the vectors");
}

hp_status hp_vectors_begin(hp_vectors *vectors, hp_pair pair, hp_numerics numerics, const char *generator,
                           const char *oracle, hp_fault *fault) {
    *vectors = (hp_vectors){.pair = pair, .numerics = numerics};
    vectors->generator = strdup(generator);
    vectors->oracle = strdup(oracle);
    if (vectors->generator && vectors->oracle) return HP_OK;
    hp_vectors_free(vectors);
    return out_of_memory(fault);
}

void hp_vectors_free(hp_vectors *vectors) {
    for (size_t i = 0; i < vectors->group_count; i++) {
        free(vectors->groups[i].name);
        free(vectors->groups[i].why);
        free(vectors->groups[i].checked);
    }
    free(vectors->groups);
    free(vectors->generator);
    free(vectors->oracle);
    free(vectors->primaries);
    free(vectors->secondaries);
    free(vectors->answers);
    free(vectors->lines);
    *vectors = (hp_vectors){0};
}

hp_status hp_vectors_add_group(hp_vectors *vectors, const char *name, const char *why, const char *checked,
                               hp_fault *fault) {
    if (!hp_grow((void **)&vectors->groups, &vectors->group_room, vectors->group_count, sizeof *vectors->groups))
        return out_of_memory(fault);
    hp_vector_group *group = &vectors->groups[vectors->group_count++];
    *group = (hp_vector_group){.name = strdup(name),
                               .why = strdup(why),
                               .checked = checked ? strdup(checked) : NULL,
                               .first = vectors->count};
    if (!group->name || !group->why || (checked && !group->checked)) return out_of_memory(fault);
    return HP_OK;
}

/* The array with another size; when there is no memory, as it was, and *done false. */
static void *resize(void *array, size_t records, unsigned words, bool *done) {
    void *resized = reallocarray(array, records, words * sizeof(uint32_t));
    if (!resized) *done = false;
    return resized ? resized : array;
}

/* Makes room for one more record in all four arrays. */
static bool make_room(hp_vectors *vectors) {
    if (vectors->count < vectors->room) return true;
    size_t wanted = vectors->room ? 2 * vectors->room : 64;
    bool done = true;
    vectors->primaries = resize(vectors->primaries, wanted, primary_words(vectors), &done);
    vectors->secondaries = resize(vectors->secondaries, wanted, secondary_words(vectors), &done);
    vectors->answers = resize(vectors->answers, wanted, HP_VECTOR_ANSWER_WORDS, &done);
    vectors->lines = resize(vectors->lines, wanted, sizeof(size_t) / sizeof(uint32_t), &done);
    if (done) vectors->room = wanted;
    return done;
}

hp_status hp_vectors_add(hp_vectors *vectors, const uint32_t *primary, const uint32_t *secondary,
                         const uint32_t answer[HP_VECTOR_ANSWER_WORDS], size_t line, hp_fault *fault) {
    if (!make_room(vectors)) return out_of_memory(fault);
    size_t i = vectors->count++, p = primary_words(vectors), s = secondary_words(vectors);
    memcpy(vectors->primaries + i * p, primary, p * sizeof *primary);
    memcpy(vectors->secondaries + i * s, secondary, s * sizeof *secondary);
    memcpy(vectors->answers + i * HP_VECTOR_ANSWER_WORDS, answer, HP_VECTOR_ANSWER_WORDS * sizeof *answer);
    vectors->lines[i] = line;
    return HP_OK;
}

const hp_vector_group *hp_vectors_group_of(const hp_vectors *vectors, size_t record) {
    const hp_vector_group *group = NULL;
    for (size_t i = 0; i < vectors->group_count && vectors->groups[i].first <= record; i++)
        group = &vectors->groups[i];
    return group;
}

/* ---- reading
 * --------------------------------------------------------------------------------------------------------- */

/* What `// key: value` lines may say, and whether they say it of the file or of a group. */
typedef enum key { PAIR, NUMERICS, GENERATOR, ORACLE, COUNT, SEPARATION, GROUP, WHY, CHECKED, KEYS } key;
static const char *const key_names[KEYS] = {
    [PAIR] = "pair",     [NUMERICS] = "numerics", [GENERATOR] = "generator",
    [ORACLE] = "oracle", [COUNT] = "count",       [GROUP] = "group",
    [WHY] = "why",       [CHECKED] = "checked",   [SEPARATION] = "separation"};

typedef struct reader {
    hp_text text;
    hp_vectors *vectors;
    char *values[KEYS]; /* those seen and not yet used; owned */
    bool begun;         /* the file's own keys are complete */
    size_t promised;    /* records, by `count` */
    hp_fault *fault;
} reader;

static hp_status read_version(reader *r) {
    static const char magic[] = "// hitpipe vectors";
    if ((size_t)(r->text.end - r->text.at) < sizeof magic - 1 || memcmp(r->text.at, magic, sizeof magic - 1) != 0)
        return hp_text_fault(&r->text, r->fault, "not a file of golden vectors: it does not begin with '%s %d'",
                             magic, HP_VECTORS_VERSION);
    r->text.at += sizeof magic - 1;
    long long version;
    if (!hp_text_integer(&r->text, &version) || version != HP_VECTORS_VERSION || !hp_text_at_line_end(&r->text))
        return hp_text_fault(&r->text, r->fault, "format version is not %d, the one this program reads",
                             HP_VECTORS_VERSION);
    hp_text_next_line(&r->text);
    return HP_OK;
}

/* Takes the rest of the line as text without blanks at either end. */
static char *take_value(hp_text *text) {
    hp_text_skip_blanks(text);
    const char *end = memchr(text->at, '\n', (size_t)(text->end - text->at));
    if (!end) end = text->end;
    while (end > text->at && (end[-1] == ' ' || end[-1] == '\t' || end[-1] == '\r')) end--;
    return strndup(text->at, (size_t)(end - text->at));
}

/* Which key the word is, with its colon; KEYS for none: the line is a remark. */
static key find_key(const char *word, size_t n) {
    for (key k = 0; k < KEYS; k++)
        if (n == strlen(key_names[k]) + 1 && word[n - 1] == ':' && memcmp(word, key_names[k], n - 1) == 0) return k;
    return KEYS;
}

/* At "//": stores the value of a key, passes over a remark. */
static hp_status read_comment(reader *r) {
    hp_text start = r->text;
    const char *word;
    r->text.at += 2;
    size_t n = hp_text_word(&r->text, &word);
    key k = find_key(word, n);
    if (k == KEYS) return HP_OK;
    if (k < GROUP && r->begun) return hp_text_fault(&start, r->fault, "'%s' after the first group", key_names[k]);
    if (r->values[k]) return hp_text_fault(&start, r->fault, "'%s' a second time", key_names[k]);
    if (k > GROUP && !r->values[GROUP])
        return hp_text_fault(&start, r->fault, "'%s' outside a group's heading", key_names[k]);
    r->values[k] = take_value(&r->text);
    if (!r->values[k]) return out_of_memory(r->fault);
    if (!*r->values[k]) return hp_text_fault(&start, r->fault, "'%s' says nothing", key_names[k]);
    return HP_OK;
}

static bool parse_count(const char *value, size_t *count) {
    char *end;
    errno = 0;
    *count = strtoull(value, &end, 10);
    return *value >= '0' && *value <= '9' && !*end && errno == 0;
}

static bool parse_numerics(const char *value, hp_numerics *numerics) {
    for (unsigned i = 0; i < sizeof numerics_names / sizeof *numerics_names; i++) {
        *numerics = (hp_numerics)i;
        if (strcmp(value, numerics_names[i]) == 0) return true;
    }
    return false;
}

/* The first record is there: makes the vectors from the file's keys. */
static hp_status begin(reader *r) {
    for (key k = 0; k <= COUNT; k++)
        if (!r->values[k])
            return hp_text_fault(&r->text, r->fault, "no line '// %s: ...' before the first record", key_names[k]);
    hp_pair pair = hp_pair_from_name(r->values[PAIR]);
    hp_numerics numerics;
    if (!pair) return hp_text_fault(&r->text, r->fault, "no pair is called '%s'", r->values[PAIR]);
    if (!parse_numerics(r->values[NUMERICS], &numerics))
        return hp_text_fault(&r->text, r->fault, "numerics are gradual, flush or any, not '%s'", r->values[NUMERICS]);
    if (!parse_count(r->values[COUNT], &r->promised))
        return hp_text_fault(&r->text, r->fault, "count is no whole number: '%s'", r->values[COUNT]);
    const char *separation = r->values[SEPARATION] ? r->values[SEPARATION] : "off";
    bool on = strcmp(separation, "on") == 0;
    if (!on && strcmp(separation, "off") != 0)
        return hp_text_fault(&r->text, r->fault, "separation is on or off, not '%s'", separation);
    r->begun = true;
    hp_status status =
        hp_vectors_begin(r->vectors, pair, numerics, r->values[GENERATOR], r->values[ORACLE], r->fault);
    r->vectors->separation = on;
    return status;
}

static void drop(reader *r, key k) {
    free(r->values[k]);
    r->values[k] = NULL;
}

static hp_status begin_group(reader *r) {
    if (!r->values[WHY])
        return hp_text_fault(&r->text, r->fault, "group '%s' does not say why it exists", r->values[GROUP]);
    hp_status status =
        hp_vectors_add_group(r->vectors, r->values[GROUP], r->values[WHY], r->values[CHECKED], r->fault);
    for (key k = GROUP; k < KEYS; k++) drop(r, k);
    return status;
}

/* Eight hex digits. */
static bool parse_word(const char *at, size_t n, uint32_t *word) {
    static const char digits[] = "0123456789abcdef";
    *word = 0;
    for (size_t i = 0; i < n; i++) {
        const char *digit = at[i] ? strchr(digits, at[i] | 0x20) : NULL;
        if (!digit || at[i] < '0') return false;
        *word = *word << 4 | (uint32_t)(digit - digits);
    }
    return n == 8;
}

static hp_status read_words(reader *r, uint32_t *words, unsigned wanted) {
    for (unsigned i = 0; i < wanted; i++) {
        if (hp_text_at_line_end(&r->text))
            return hp_text_fault(&r->text, r->fault, "the record ends after %u of its %u words", i, wanted);
        hp_text start = r->text;
        const char *word;
        size_t n = hp_text_word(&r->text, &word);
        if (!parse_word(word, n, &words[i]))
            return hp_text_fault(&start, r->fault, "word %u of the record is not eight hex digits", i + 1);
    }
    if (!hp_text_at_line_end(&r->text))
        return hp_text_fault(&r->text, r->fault, "the record goes on after its %u words", wanted);
    return HP_OK;
}

static hp_status read_record(reader *r) {
    hp_status status = HP_OK;
    if (!r->begun) status = begin(r);
    if (status == HP_OK && r->values[GROUP]) status = begin_group(r);
    if (status != HP_OK) return status;
    if (r->vectors->group_count == 0)
        return hp_text_fault(&r->text, r->fault, "a record before the first line '// group: ...'");
    if (r->vectors->count == r->promised)
        return hp_text_fault(&r->text, r->fault, "more records than the %zu the header promises", r->promised);
    uint32_t words[2 * HP_OBJECT_WORDS_MAX + HP_VECTOR_ANSWER_WORDS];
    unsigned p = primary_words(r->vectors), s = secondary_words(r->vectors);
    status = read_words(r, words, p + s + HP_VECTOR_ANSWER_WORDS);
    if (status != HP_OK) return status;
    return hp_vectors_add(r->vectors, words, words + p, words + p + s, r->text.line, r->fault);
}

static hp_status read_lines(reader *r) {
    hp_status status = read_version(r);
    for (; status == HP_OK && !hp_text_at_end(&r->text); hp_text_next_line(&r->text)) {
        hp_text_skip_blanks(&r->text);
        bool comment = r->text.at[0] == '/' && r->text.at[1] == '/';
        if (comment)
            status = read_comment(r);
        else if (!hp_text_at_line_end(&r->text))
            status = read_record(r);
    }
    if (status != HP_OK) return status;
    if (!r->begun) return hp_text_fault(&r->text, r->fault, "no record: the file is empty or cut off");
    if (r->vectors->count < r->promised)
        return hp_text_fault(&r->text, r->fault, "the file ends after %zu of the %zu records its header promises",
                             r->vectors->count, r->promised);
    return HP_OK;
}

hp_status hp_vectors_parse(const hp_bytes *bytes, hp_vectors *vectors, hp_fault *fault) {
    *vectors = (hp_vectors){0};
    reader r = {.text = hp_text_open(bytes), .vectors = vectors, .fault = fault};
    hp_status status = read_lines(&r);
    for (key k = 0; k < KEYS; k++) drop(&r, k);
    hp_text_close(&r.text);
    if (status != HP_OK) hp_vectors_free(vectors);
    return status;
}

hp_status hp_vectors_read(const char *path, hp_vectors *vectors, hp_fault *fault) {
    hp_bytes bytes;
    *vectors = (hp_vectors){0};
    hp_status status = hp_bytes_read(path, &bytes, fault);
    if (status != HP_OK) return status;
    status = hp_vectors_parse(&bytes, vectors, fault);
    hp_bytes_free(&bytes);
    return status;
}

/* ---- writing
 * --------------------------------------------------------------------------------------------------------- */

/* n words of 32 bits, floats or not, as bits. */
static void write_words(FILE *file, const void *words, unsigned n, const char *after) {
    for (unsigned i = 0; i < n; i++) {
        uint32_t word;
        memcpy(&word, (const char *)words + i * sizeof word, sizeof word);
        fprintf(file, "%08" PRIx32 "%s", word, i + 1 < n ? " " : after);
    }
}

static void write_heading(const hp_vector_group *group, FILE *file) {
    fprintf(file, "//\n// group: %s\n// why: %s\n", group->name, group->why);
    if (group->checked) fprintf(file, "// checked: %s\n", group->checked);
}

hp_status hp_vectors_write(const hp_vectors *vectors, FILE *file, hp_fault *fault) {
    unsigned p = primary_words(vectors), s = secondary_words(vectors);
    fprintf(file,
            "// hitpipe vectors %d\n// pair: %s\n// numerics: %s\n// generator: %s\n// oracle: %s\n// count: %zu\n",
            HP_VECTORS_VERSION, hp_pair_name(vectors->pair), hp_numerics_name(vectors->numerics), vectors->generator,
            vectors->oracle, vectors->count);
    if (vectors->separation) fprintf(file, "// separation: on\n");
    fprintf(file, "// a record, %u words: %s (%u), %s (%u), F, index, T, CP (3)\n", p + s + HP_VECTOR_ANSWER_WORDS,
            hp_object_name(hp_pair_primary(vectors->pair)), p, hp_object_name(hp_pair_secondary(vectors->pair)), s);
    size_t group = 0;
    for (size_t i = 0; i < vectors->count; i++) {
        if (group < vectors->group_count && vectors->groups[group].first == i)
            write_heading(&vectors->groups[group++], file);
        write_words(file, vectors->primaries + i * p, p, "  ");
        write_words(file, vectors->secondaries + i * s, s, "  ");
        write_words(file, vectors->answers + i * HP_VECTOR_ANSWER_WORDS, HP_VECTOR_ANSWER_WORDS, "\n");
    }
    if (fflush(file) != 0 || ferror(file))
        return hp_fault_set(fault, HP_ERROR_IO, "cannot write the vectors: %s", strerror(errno));
    return HP_OK;
}
