#include "host/import/csv.h"

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

/* The scalar product of `vectors` that is furthest from what it is of unit vectors at right angles, in words. */
static void worst_product(const float *vectors, const char *names, char *text, size_t room) {
    double worst = -1;
    for (size_t i = 0; names[i]; i++)
        for (size_t k = i; names[k]; k++) {
            const float *a = vectors + 3 * i, *b = vectors + 3 * k;
            double product = (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
            if (fabs(product - (i == k)) <= worst) continue;
            worst = fabs(product - (i == k));
            snprintf(text, room, ": %c.%c is %.7g", names[i], names[k], product);
        }
}

static hp_status refuse_object(hp_text *text, hp_object object, const float *words, const char *wrong,
                               hp_fault *fault) {
    char figure[64] = "";
    if (object == HP_OBB && strncmp(wrong, "axes", 4) == 0) worst_product(words + 6, "uvw", figure, sizeof figure);
    if (object == HP_PLANE && strstr(wrong, "length")) worst_product(words, "n", figure, sizeof figure);
    text->at = text->line_start;
    return hp_text_fault(text, fault, "%s%s", wrong, figure);
}

/* "a ray has 6 numbers, here are 5": `found` is "5" or "more" */
static hp_status wrong_count(hp_text *text, hp_object object, const char *found, hp_fault *fault) {
    const char *name = hp_object_name(object);
    return hp_text_fault(text, fault, "a%s %s has %u numbers, here are %s", strchr("ao", name[0]) ? "n" : "", name,
                         hp_object_words(object), found);
}

static hp_status read_object(hp_text *text, hp_object object, float *words, hp_fault *fault) {
    unsigned n = hp_object_words(object);
    for (unsigned i = 0; i < n; i++) {
        if (i > 0 && !line_ends(text)) {
            if (*text->at != ',') return hp_text_fault(text, fault, "expected a comma after number %u", i);
            text->at++;
        }
        if (line_ends(text)) {
            char found[16];
            snprintf(found, sizeof found, "%u", i);
            return wrong_count(text, object, found, fault);
        }
        const char *number = text->at;
        if (!hp_text_float(text, &words[i])) return hp_text_fault(text, fault, "not a number");
        if (isfinite(words[i])) continue;
        text->at = number;
        return hp_text_fault(text, fault, isnan(words[i]) ? "a NaN" : "an infinity, or a number past binary32");
    }
    if (!line_ends(text)) return wrong_count(text, object, "more", fault);
    const char *wrong = hp_object_fault(object, words);
    return wrong ? refuse_object(text, object, words, wrong, fault) : HP_OK;
}

/* A first line of which no field is a number: one that holds some is an object gone wrong. */
static bool at_header(hp_text text) {
    while (!line_ends(&text)) {
        float value;
        if (hp_text_float(&text, &value)) return false;
        while (!line_ends(&text) && *text.at++ != ',') continue;
    }
    return true;
}

static hp_status read_lines(hp_text *text, hp_object object, hp_objects *objects, hp_fault *fault) {
    unsigned n = hp_object_words(object);
    bool first = true;
    for (; !hp_text_at_end(text); hp_text_next_line(text)) {
        if (line_ends(text)) continue;
        bool header = first && at_header(*text);
        first = false;
        if (header) continue;
        if (!hp_grow((void **)&objects->words, &objects->room, objects->count, n * sizeof(float)))
            return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", text->name);
        hp_status status = read_object(text, object, objects->words + objects->count * n, fault);
        if (status != HP_OK) return status;
        objects->count++;
    }
    if (objects->count > 0) return HP_OK;
    return hp_fault_set(fault, HP_ERROR_INPUT, "%s: no %s in the file", text->name, hp_object_name(object));
}

hp_status hp_csv_read(const hp_bytes *bytes, hp_object object, hp_objects *objects, hp_fault *fault) {
    *objects = (hp_objects){0};
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
