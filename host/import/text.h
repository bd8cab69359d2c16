/* A cursor over text that is read number by number and line by line.
 *
 * Numbers come out as the nearest binary32 (ties to even), whatever the locale: strtof in the "C" locale, which glibc
 * rounds correctly. Hexadecimal floats, "inf" and "nan" are numbers here; who must not take them checks the value. */
#ifndef HITPIPE_HOST_TEXT_H
#define HITPIPE_HOST_TEXT_H

#include "host/import/bytes.h"

#include <locale.h>

typedef struct hp_text {
    const char *name;
    const char *at, *end;   /* *end is a zero byte */
    const char *line_start; /* of the line that `at` is in */
    size_t line;            /* counted from 1 */
    locale_t numerals;
} hp_text;

/* A cursor at the start of bytes, after a byte order mark of UTF-8. They must outlive it. Close it to give back the
 * locale. */
hp_text hp_text_open(const hp_bytes *bytes);
void hp_text_close(hp_text *text);

void hp_text_skip_blanks(hp_text *text);  /* spaces and tabs, and a '\r' before the line's end */
bool hp_text_at_end(const hp_text *text); /* of the text */
bool hp_text_at_line_end(hp_text *text);  /* or of the text, after blanks */
void hp_text_next_line(hp_text *text);    /* past the next '\n' */

/* Takes a word (bytes up to a blank or the line's end) after blanks; its length, 0 at the line's end. */
size_t hp_text_word(hp_text *text, const char **word);

/* Takes `literal` if the next word is exactly that. */
bool hp_text_take(hp_text *text, const char *literal);

/* Takes a number after blanks, on this line. False: there is none, or something clings to it, as in 1.5.2 and 3x; the
 * cursor stays after the blanks. */
bool hp_text_float(hp_text *text, float *value);
bool hp_text_integer(hp_text *text, long long *value);

/* HP_ERROR_INPUT "name:line:column: ..." */
hp_status hp_text_fault(const hp_text *text, hp_fault *fault, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The nearest binary32 of a whole string (a command-line argument). False: the string is not a number. */
bool hp_parse_float(const char *string, float *value);

#endif
