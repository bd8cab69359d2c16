#include "host/import/pgm.h"

#include "host/import/text.h"

#include <stdlib.h>

/* The next whole number, over blanks, line ends and comments. */
static bool take(hp_text *text, long long *value) {
    while (!hp_text_at_end(text) && (hp_text_at_line_end(text) || *text->at == '#')) hp_text_next_line(text);
    return hp_text_integer(text, value);
}

static hp_status read_binary(hp_text *text, long long most, float *samples, size_t n, hp_fault *fault) {
    size_t size = most > 255 ? 2 : 1;
    const uint8_t *at = (const uint8_t *)text->at + 1; /* one white space after the maximum */
    for (size_t i = 0; i < n; i++, at += size) {
        unsigned value = size == 2 ? (unsigned)at[0] << 8 | at[1] : at[0];
        if (value > most)
            return hp_fault_set(fault, HP_ERROR_INPUT, "%s: sample %zu is %u, above the maximum %lld", text->name, i,
                                value, most);
        samples[i] = (float)value;
    }
    return HP_OK;
}

static hp_status read_decimal(hp_text *text, long long most, float *samples, size_t n, hp_fault *fault) {
    for (size_t i = 0; i < n; i++) {
        long long value;
        if (!take(text, &value)) return hp_text_fault(text, fault, "truncated: sample %zu of %zu is missing", i, n);
        if (value < 0 || value > most)
            return hp_text_fault(text, fault, "sample %zu is %lld; 0 to %lld are allowed", i, value, most);
        samples[i] = (float)value;
    }
    return HP_OK;
}

hp_status hp_pgm_read(const hp_bytes *bytes, size_t *rows, size_t *columns, float **samples, hp_fault *fault) {
    hp_text text = hp_text_open(bytes);
    bool decimal = hp_text_take(&text, "P2");
    long long width, height, most;
    hp_status status = HP_OK;
    if (!decimal && !hp_text_take(&text, "P5"))
        status = hp_text_fault(&text, fault, "a PGM begins with P2 or P5");
    else if (!take(&text, &width) || !take(&text, &height) || !take(&text, &most))
        status = hp_text_fault(&text, fault, "a PGM needs a width, a height and a maximum");
    else if (width < 1 || height < 1 || most < 1 || most > 65535)
        status = hp_text_fault(&text, fault, "%lld x %lld samples up to %lld is no PGM", width, height, most);
    else {
        /* a sample takes a byte at least: what the file cannot hold is not allocated */
        size_t left = (size_t)(text.end - text.at), size = decimal || most < 256 ? 1 : 2;
        if (left == 0 || (size_t)height > (left - 1) / size / (size_t)width)
            status = hp_text_fault(&text, fault, "truncated: no room for %lld x %lld samples", width, height);
    }
    if (status == HP_OK) {
        size_t n = (size_t)width * (size_t)height;
        *samples = malloc(n * sizeof(float));
        if (!*samples)
            status = hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", bytes->name);
        else
            status = (decimal ? read_decimal : read_binary)(&text, most, *samples, n, fault);
        if (status != HP_OK) free(*samples), *samples = NULL;
        *rows = (size_t)height;
        *columns = (size_t)width;
    }
    hp_text_close(&text);
    return status;
}
