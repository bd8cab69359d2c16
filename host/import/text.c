#include "host/import/text.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

hp_text hp_text_open(const hp_bytes *bytes) {
    static const char byte_order_mark[] = "\xEF\xBB\xBF"; /* some programs begin UTF-8 with it */
    const char *start = (const char *)bytes->data, *end = start + bytes->n;
    if (strncmp(start, byte_order_mark, 3) == 0) start += 3;
    return (hp_text){
        .name = bytes->name,
        .at = start,
        .end = end,
        .line_start = start,
        .line = 1,
        .numerals = newlocale(LC_ALL_MASK, "C", (locale_t)0),
    };
}

void hp_text_close(hp_text *text) {
    freelocale(text->numerals);
}

static bool blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

void hp_text_skip_blanks(hp_text *text) {
    while (blank(*text->at)) text->at++;
}

bool hp_text_at_end(const hp_text *text) {
    return text->at == text->end;
}

bool hp_text_at_line_end(hp_text *text) {
    hp_text_skip_blanks(text);
    return hp_text_at_end(text) || *text->at == '\n';
}

void hp_text_next_line(hp_text *text) {
    const char *newline = memchr(text->at, '\n', (size_t)(text->end - text->at));
    text->at = newline ? newline + 1 : text->end;
    if (!newline) return;
    text->line_start = text->at;
    text->line++;
}

size_t hp_text_word(hp_text *text, const char **word) {
    hp_text_skip_blanks(text);
    *word = text->at;
    while (!hp_text_at_end(text) && *text->at != '\n' && !blank(*text->at)) text->at++;
    return (size_t)(text->at - *word);
}

bool hp_text_take(hp_text *text, const char *literal) {
    hp_text before = *text;
    const char *word;
    size_t n = hp_text_word(text, &word);
    if (n == strlen(literal) && memcmp(word, literal, n) == 0) return true;
    *text = before;
    return false;
}

/* Whether a byte behind a number says that it was none. */
static bool clings(char c) {
    return isalnum((unsigned char)c) || c == '.' || c == '+' || c == '-' || c == '_';
}

bool hp_text_float(hp_text *text, float *value) {
    /* strtof would skip the line's end as white space */
    if (hp_text_at_line_end(text)) return false;
    char *after;
    *value = strtof_l(text->at, &after, text->numerals);
    bool found = after != text->at && !clings(*after);
    if (found) text->at = after;
    return found;
}

bool hp_text_integer(hp_text *text, long long *value) {
    if (hp_text_at_line_end(text)) return false;
    char *after;
    errno = 0;
    *value = strtoll(text->at, &after, 10);
    bool found = after != text->at && errno == 0;
    if (found) text->at = after;
    return found;
}

hp_status hp_text_fault(const hp_text *text, hp_fault *fault, const char *format, ...) {
    char what[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return hp_fault_set(fault, HP_ERROR_INPUT, "%s:%zu:%zu: %s", text->name, text->line,
                        (size_t)(text->at - text->line_start) + 1, what);
}

bool hp_parse_float(const char *string, float *value) {
    hp_fault ignored;
    hp_bytes bytes;
    if (hp_bytes_copy("", string, strlen(string), &bytes, &ignored) != HP_OK) return false;
    hp_text text = hp_text_open(&bytes);
    bool whole = hp_text_float(&text, value) && hp_text_at_line_end(&text) && hp_text_at_end(&text);
    hp_text_close(&text);
    hp_bytes_free(&bytes);
    return whole;
}
