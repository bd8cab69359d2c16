#include "host/output/divergence.h"

#include "host/output/report.h"

#include <inttypes.h>
#include <string.h>

_Static_assert(offsetof(hp_result, stencil) == 4 * HP_VECTOR_ANSWER_WORDS, "F, index, T, CP come first");

static const char *const answer_names[HP_VECTOR_ANSWER_WORDS] = {"F", "index", "T", "CP.x", "CP.y", "CP.z"};
enum { FIRST_FLOAT = 2 }; /* F and index are whole numbers */

static const uint32_t *expected_of(const hp_vectors *vectors, size_t record) {
    return vectors->answers + record * HP_VECTOR_ANSWER_WORDS;
}

hp_divergence hp_diverge(const hp_vectors *vectors, const hp_result *answers) {
    hp_divergence divergence = {0};
    for (size_t i = vectors->count; i-- > 0;) {
        if (memcmp(&answers[i], expected_of(vectors, i), 4 * HP_VECTOR_ANSWER_WORDS) == 0) continue;
        divergence.count++;
        divergence.first = i;
    }
    return divergence;
}

/* One record, taken apart into bits. */
typedef struct record {
    hp_object primary, secondary;
    uint32_t primary_words[HP_OBJECT_WORDS_MAX], secondary_words[HP_OBJECT_WORDS_MAX];
    uint32_t expected[HP_VECTOR_ANSWER_WORDS], got[HP_VECTOR_ANSWER_WORDS];
} record;

static void take_object(uint32_t *words, hp_object object, const float *objects, size_t i) {
    unsigned n = hp_object_words(object);
    memcpy(words, objects + i * n, n * sizeof *words);
}

static record take(const hp_vectors *vectors, size_t i, const hp_result *answer) {
    record r = {.primary = hp_pair_primary(vectors->pair), .secondary = hp_pair_secondary(vectors->pair)};
    take_object(r.primary_words, r.primary, vectors->primaries, i);
    take_object(r.secondary_words, r.secondary, vectors->secondaries, i);
    memcpy(r.expected, expected_of(vectors, i), sizeof r.expected);
    memcpy(r.got, answer, sizeof r.got);
    return r;
}

/* A word as a float that reads back to the same bits, or as a whole number. */
static void describe(uint32_t word, bool is_float, char *text, size_t room) {
    float value;
    memcpy(&value, &word, sizeof value);
    if (is_float)
        snprintf(text, room, "%.9g", (double)value);
    else
        snprintf(text, room, "%" PRIu32, word);
}

static void print_object(FILE *file, const char *name, const uint32_t *words, unsigned n) {
    char value[24];
    for (unsigned i = 0; i < n; i++) {
        describe(words[i], true, value, sizeof value);
        if (i % 3 == 0) fprintf(file, "  %-10s", i == 0 ? name : "");
        bool last = i % 3 == 2 || i + 1 == n;
        fprintf(file, "%08" PRIx32 " %-*s%s", words[i], last ? 0 : 17, value, last ? "\n" : "");
    }
}

void hp_divergence_print(FILE *file, const char *path, const hp_vectors *vectors, size_t i, const hp_result *answer) {
    record r = take(vectors, i, answer);
    const hp_vector_group *group = hp_vectors_group_of(vectors, i);
    char wanted[24], got[24];
    fprintf(file, "%s:%zu: record %zu differs, group '%s' (%s)\n", path, vectors->lines[i], i, group->name,
            group->why);
    print_object(file, hp_object_name(r.primary), r.primary_words, hp_object_words(r.primary));
    print_object(file, hp_object_name(r.secondary), r.secondary_words, hp_object_words(r.secondary));
    fprintf(file, "  %-10s%-26s%s\n", "", "expected", "got");
    for (unsigned k = 0; k < HP_VECTOR_ANSWER_WORDS; k++) {
        describe(r.expected[k], k >= FIRST_FLOAT, wanted, sizeof wanted);
        describe(r.got[k], k >= FIRST_FLOAT, got, sizeof got);
        bool same = r.expected[k] == r.got[k];
        fprintf(file, "  %-10s%08" PRIx32 " %-17s%08" PRIx32 " %-*s%s\n", answer_names[k], r.expected[k], wanted,
                r.got[k], same ? 0 : 17, got, same ? "" : "differs");
    }
}

static json_t *hex_list(const uint32_t *words, unsigned n) {
    json_t *list = json_array();
    for (unsigned i = 0; i < n; i++) json_array_append_new(list, json_sprintf("%08" PRIx32, words[i]));
    return list;
}

json_t *hp_divergence_json(const hp_vectors *vectors, size_t i, const hp_result *answer) {
    record r = take(vectors, i, answer);
    const hp_vector_group *group = hp_vectors_group_of(vectors, i);
    json_t *differs = json_array();
    for (unsigned k = 0; k < HP_VECTOR_ANSWER_WORDS; k++)
        if (r.expected[k] != r.got[k]) json_array_append_new(differs, json_string(answer_names[k]));
    return json_pack("{s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "record", (json_int_t)i, "line",
                     (json_int_t)vectors->lines[i], "group", hp_report_string(group->name), "why",
                     hp_report_string(group->why), "primary", hex_list(r.primary_words, hp_object_words(r.primary)),
                     "secondary", hex_list(r.secondary_words, hp_object_words(r.secondary)), "expected",
                     hex_list(r.expected, HP_VECTOR_ANSWER_WORDS), "got", hex_list(r.got, HP_VECTOR_ANSWER_WORDS),
                     "differs", differs);
}
