/* Reading a page of docs/ in a test: its tables and its blocks of bytes. Failures are cmocka failures. */
#ifndef HITPIPE_PAGE_H
#define HITPIPE_PAGE_H

#include <stddef.h>
#include <stdint.h>

typedef struct test_page test_page;

/* The page, or NULL when it cannot be read. The path is from the project's root. */
test_page *page_open(const char *path);
void page_close(test_page *page);

/* The rows of the first table behind the line `heading`, which may be the table's own first line. A section without a
 * table before the next heading has no rows. */
typedef struct page_rows {
    const test_page *page;
    size_t line;
} page_rows;
page_rows page_table(const test_page *page, const char *heading);

/* The next row is exactly this; there is no further row. */
__attribute__((format(printf, 2, 3))) void page_expect(page_rows *rows, const char *format, ...);
void page_end(const page_rows *rows);

/* How many lines hold `text`. */
size_t page_count(const test_page *page, const char *text);

/* Bytes of block number i (from 0) that opens with the line "```hex DIRECTION"; 0 past the last. `direction` gets a
 * pointer to the word, terminated. */
size_t page_bytes(const test_page *page, unsigned i, uint8_t *bytes, size_t room, const char **direction);

#endif
