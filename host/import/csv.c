#include "host/import/csv.h"

#include "host/import/shape.h"
#include "host/import/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void hp_objects_free(hp_objects *objects) {
    free(objects->words);
    *objects = (hp_objects){0};
}

static bool line_ends(hp_text *text) {
    return hp_text_at_line_end(text) || *text->at == '#';
}

/* ---- what is wrong, in words ---- */

static const char *layout_of(hp_object object) {
    switch (object) {
#define HP_OBJECT(name, NAME, code, words, layout)                                                                   \
    case HP_##NAME:                                                                                                  \
        return layout;
#include <hitpipe/objects.def>
#undef HP_OBJECT
    }
    return "";
}

static bool ends_word(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == '#';
}

/* The word at the cursor, cut if long, with bytes that are no letters as \xNN. */
static void excerpt(const hp_text *text, char *shown, size_t room) {
    size_t n = 0;
    *shown = 0;
    for (const char *at = text->at; at < text->end && !ends_word(*at); at++) {
        bool letter = *at > ' ' && *at < 0x7f;
        if (n + 8 > room) {
            snprintf(shown + n, room - n, "...");
            return;
        }
        n += (size_t)snprintf(shown + n, room - n, letter ? "%c" : "\\x%02x", (unsigned char)*at);
    }
}

static hp_status no_number(hp_text *text, hp_fault *fault) {
    char shown[28];
    excerpt(text, shown, sizeof shown);
    if (!*shown) return hp_text_fault(text, fault, "a number is missing");
    return hp_text_fault(text, fault, "'%s' is not a number%s", shown, *shown == '"' ? ": take the quotes away" : "");
}

/* "a ray has 6 numbers: origin xyz, ...; here are 5": the fields of the line. */
static hp_status wrong_count(hp_text *text, hp_object object, hp_fault *fault) {
    const char *name = hp_object_name(object);
    hp_text line = *text;
    unsigned fields = 1;
    for (line.at = line.line_start; !line_ends(&line); line.at++) fields += *line.at == ',';
    while (line.at > line.line_start && strchr(" \t\r", line.at[-1])) line.at--;
    bool trailing = line.at > line.line_start && line.at[-1] == ',';
    if (trailing && --fields == hp_object_words(object))
        return hp_text_fault(text, fault, "a comma after the last number");
    return hp_text_fault(text, fault, "a%s %s has %u numbers: %s; here are %u", strchr("ao", name[0]) ? "n" : "",
                         name, hp_object_words(object), layout_of(object), fields);
}

/* What is wrong about an object that its numbers as they are written are not: they became binary32. */
static const char *lost_by_rounding(const hp_text *line, hp_object object) {
    double number[HP_OBJECT_WORDS_MAX];
    const char *at = line->line_start;
    for (unsigned i = 0; i < hp_object_words(object); i++) {
        char *after;
        number[i] = strtod_l(at, &after, line->numerals);
        at = after + strspn(after, " \t,");
    }
    bool ray = false, cylinder = false;
    for (unsigned i = 0; i < 3; i++) {
        ray = ray || (object == HP_RAY && number[3 + i] != 0);
        cylinder = cylinder || (object == HP_CYLINDER && number[i] != number[3 + i]);
    }
    return ray ? ": it is too small for binary32" : cylinder ? ": they are too near for binary32" : "";
}

static hp_status refuse_object(hp_text *text, hp_object object, const float *words, const char *wrong,
                               hp_fault *fault) {
    char figure[64] = "";
    bool axes = object == HP_OBB && strncmp(wrong, "axes", 4) == 0;
    if (axes || (object == HP_PLANE && strstr(wrong, "length"))) {
        hp_product worst = axes ? hp_worst_product(words + 6, 3) : hp_worst_product(words, 1);
        const char *names = axes ? "uvw" : "n";
        snprintf(figure, sizeof figure, ": %c.%c is %.7g, not %d", names[worst.i], names[worst.k], worst.value,
                 worst.i == worst.k);
    } else if (strstr(wrong, "is zero") || strstr(wrong, "the same point")) {
        snprintf(figure, sizeof figure, "%s", lost_by_rounding(text, object));
    }
    text->at = text->line_start;
    return hp_text_fault(text, fault, "%s%s", wrong, figure);
}

/* ---- reading ---- */

static hp_status read_number(hp_text *text, float *word, hp_fault *fault) {
    const char *number = text->at;
    if (!hp_text_float(text, word)) return no_number(text, fault);
    if (isfinite(*word)) return HP_OK;
    text->at = number;
    return hp_text_fault(text, fault, isnan(*word) ? "a NaN" : "an infinity, or a number past binary32");
}

static hp_status expected(hp_text *text, const char *what, unsigned n, hp_fault *fault) {
    char shown[28];
    excerpt(text, shown, sizeof shown);
    return hp_text_fault(text, fault, "expected %s after number %u, not '%s'", what, n, shown);
}

static hp_status read_object(hp_text *text, hp_object object, float *words, hp_fault *fault) {
    unsigned n = hp_object_words(object);
    for (unsigned i = 0; i < n; i++) {
        if (i > 0 && !line_ends(text)) {
            if (*text->at != ',') return expected(text, "a comma", i, fault);
            text->at++;
        }
        if (line_ends(text)) return wrong_count(text, object, fault);
        hp_status status = read_number(text, &words[i], fault);
        if (status != HP_OK) return status;
    }
    if (!line_ends(text))
        return *text->at == ',' ? wrong_count(text, object, fault) : expected(text, "the line's end", n, fault);
    const char *wrong = hp_object_fault(object, words);
    return wrong ? refuse_object(text, object, words, wrong, fault) : HP_OK;
}

/* A first line of which no field is a number, in quotes or not, and that is text: one that holds some is an object
 * gone wrong. */
static bool at_header(hp_text text) {
    while (!line_ends(&text)) {
        float value;
        if (*text.at == '"') text.at++;
        if (hp_text_float(&text, &value)) return false;
        for (; !line_ends(&text) && *text.at != ','; text.at++)
            if ((unsigned char)*text.at < ' ') return false;
        if (*text.at == ',') text.at++;
    }
    return true;
}

/* A carriage return in the middle of a line of text; of what is no text other things are wrong. */
static hp_status check_line_end(const hp_text *text, hp_fault *fault) {
    hp_text at = *text;
    for (; at.at < at.end && ((unsigned char)*at.at >= ' ' || *at.at == '\t') && *at.at != '#'; at.at++) continue;
    if (*at.at != '\r' || at.at + 1 >= at.end || at.at[1] == '\n') return HP_OK;
    return hp_text_fault(&at, fault, "a carriage return alone ends no line: save the file with newlines");
}

static hp_status read_lines(hp_text *text, hp_object object, hp_objects *objects, hp_fault *fault) {
    unsigned n = hp_object_words(object);
    bool first = true, headed = false;
    for (; !hp_text_at_end(text); hp_text_next_line(text)) {
        hp_status status = check_line_end(text, fault);
        if (status != HP_OK) return status;
        if (line_ends(text)) continue;
        bool header = first && at_header(*text);
        first = false;
        headed = headed || header;
        if (header) continue;
        if (!hp_grow((void **)&objects->words, &objects->room, objects->count, n * sizeof(float)))
            return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", text->name);
        status = read_object(text, object, objects->words + objects->count * n, fault);
        if (status != HP_OK) return status;
        objects->count++;
    }
    if (objects->count > 0) return HP_OK;
    return hp_fault_set(fault, HP_ERROR_INPUT, "%s: no %s in the file%s", text->name, hp_object_name(object),
                        headed ? ": its only line has no numbers, which makes it a header" : "");
}

/* The byte order marks that begin UTF-16. */
static bool is_utf16(const hp_bytes *bytes) {
    return bytes->n >= 2 && (memcmp(bytes->data, "\xFF\xFE", 2) == 0 || memcmp(bytes->data, "\xFE\xFF", 2) == 0);
}

hp_status hp_csv_read(const hp_bytes *bytes, hp_object object, hp_objects *objects, hp_fault *fault) {
    *objects = (hp_objects){0};
    if (is_utf16(bytes))
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: text in UTF-16: save it as UTF-8", bytes->name);
    hp_text text = hp_text_open(bytes);
    hp_status status = read_lines(&text, object, objects, fault);
    hp_text_close(&text);
    if (status != HP_OK) hp_objects_free(objects);
    return status;
}

unsigned hp_csv_numbers(const hp_bytes *bytes) {
    hp_text text = hp_text_open(bytes);
    unsigned fields = 0;
    for (bool first = true; fields == 0 && !hp_text_at_end(&text); hp_text_next_line(&text)) {
        if (line_ends(&text)) continue;
        bool header = first && at_header(text);
        first = false;
        if (header) continue;
        for (fields = 1; !line_ends(&text); text.at++) fields += *text.at == ',';
    }
    hp_text_close(&text);
    return fields;
}

hp_status hp_csv_load(const char *path, hp_object object, hp_objects *objects, hp_fault *fault) {
    *objects = (hp_objects){0};
    hp_bytes bytes;
    hp_status status = hp_bytes_read(path, &bytes, fault);
    if (status != HP_OK) return status;
    status = hp_csv_read(&bytes, object, objects, fault);
    hp_bytes_free(&bytes);
    return status;
}
