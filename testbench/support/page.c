#include "page.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { LINES = 2000 };

struct test_page {
    size_t lines;
    char *line[LINES];
};

test_page *page_open(const char *path) {
    FILE *file = fopen(path, "r");
    if (!file) return NULL;
    test_page *made = calloc(1, sizeof *made);
    size_t room = 0;
    ssize_t n;
    while (made && made->lines < LINES && (n = getline(&made->line[made->lines], &room, file)) >= 0) {
        made->line[made->lines++][n - 1] = '\0';
        room = 0;
    }
    fclose(file);
    return made;
}

void page_close(test_page *page) {
    for (size_t i = 0; i < LINES; i++) free(page->line[i]);
    free(page);
}

static const char *line_at(const test_page *page, size_t i) {
    return i < page->lines ? page->line[i] : "#";
}

page_rows page_table(const test_page *page, const char *heading) {
    size_t i = 0;
    while (i < page->lines && strcmp(page->line[i], heading) != 0) i++;
    if (i == page->lines) fail_msg("the page has no line \"%s\"", heading);
    if (line_at(page, i)[0] != '|') i++;
    while (line_at(page, i)[0] != '|' && line_at(page, i)[0] != '#') i++;
    return (page_rows){page, line_at(page, i)[0] == '|' ? i + 2 : i}; /* past the titles and the rule */
}

void page_expect(page_rows *rows, const char *format, ...) {
    char text[500];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    assert_string_equal(line_at(rows->page, rows->line), text);
    rows->line++;
}

void page_end(const page_rows *rows) {
    const char *line = line_at(rows->page, rows->line);
    if (line[0] == '|') fail_msg("a row too many: %s", line);
}

size_t page_count(const test_page *page, const char *text) {
    size_t count = 0;
    for (size_t i = 0; i < page->lines; i++) count += strstr(page->line[i], text) != NULL;
    return count;
}

static size_t read_bytes(const char *line, uint8_t *bytes, size_t room) {
    size_t n = 0;
    unsigned value;
    int used;
    for (line += 4; n < room && sscanf(line, " %2x%n", &value, &used) == 1; line += used) bytes[n++] = (uint8_t)value;
    return n;
}

size_t page_bytes(const test_page *page, unsigned i, uint8_t *bytes, size_t room, const char **direction) {
    size_t at = 0, n = 0;
    for (at = 0; at < page->lines; at++)
        if (strncmp(page->line[at], "```hex ", 7) == 0 && i-- == 0) break;
    if (at == page->lines) return 0;
    *direction = page->line[at] + 7;
    for (at++; at < page->lines && page->line[at][0] != '`'; at++)
        n += read_bytes(page->line[at], bytes + n, room - n);
    return n;
}
