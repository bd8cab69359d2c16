/* STL: binary (80 bytes of anything, a 32-bit count, then 50 bytes a facet, little endian) or text. Text files begin
 * with "solid", as careless binary ones do: a file whose length fits its count is binary. */
#include "host/import/text.h"
#include "host/import/vertices.h"

#include <string.h>

enum { STL_HEADER = 84, STL_FACET = 50 };

static uint32_t little32(const uint8_t *bytes) {
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static uint64_t binary_length(const hp_bytes *bytes) {
    return STL_HEADER + (uint64_t)STL_FACET * little32(bytes->data + 80);
}

static hp_status read_binary(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault) {
    uint32_t count = little32(bytes->data + 80);
    if (bytes->n != binary_length(bytes))
        return hp_fault_set(fault, HP_ERROR_INPUT, "%s: truncated or corrupt: %zu bytes, but %llu for its %u facets",
                            bytes->name, bytes->n, (unsigned long long)binary_length(bytes), count);
    for (uint32_t i = 0; i < count; i++) {
        const uint8_t *facet = bytes->data + STL_HEADER + (size_t)STL_FACET * i + 12; /* after the normal */
        float xyz[3][3];
        for (int k = 0; k < 9; k++) {
            uint32_t word = little32(facet + 4 * k);
            memcpy(&xyz[k / 3][k % 3], &word, sizeof word);
        }
        for (int corner = 0; corner < 3; corner++) {
            const char *wrong = hp_vertex_fault(xyz[corner]);
            if (wrong) return hp_fault_set(fault, HP_ERROR_INPUT, "%s: facet %u: %s", bytes->name, i, wrong);
        }
        if (!hp_mesh_add(mesh, xyz[0], xyz[1], xyz[2]))
            return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", bytes->name);
    }
    return HP_OK;
}

/* Takes the words of a phrase ("outer loop"), over line ends. */
static bool take(hp_text *text, const char *first, const char *second) {
    while (hp_text_at_line_end(text) && !hp_text_at_end(text)) hp_text_next_line(text);
    return hp_text_take(text, first) && (!second || hp_text_take(text, second));
}

static hp_status read_facet(hp_text *text, hp_mesh *mesh, hp_fault *fault) {
    float xyz[3][3], normal;
    for (int i = 0; i < 3; i++)
        if (!hp_text_float(text, &normal)) return hp_text_fault(text, fault, "a normal needs three numbers");
    if (!take(text, "outer", "loop")) return hp_text_fault(text, fault, "expected 'outer loop'");
    for (int corner = 0; corner < 3; corner++) {
        if (!take(text, "vertex", NULL)) return hp_text_fault(text, fault, "expected 'vertex'");
        for (int i = 0; i < 3; i++)
            if (!hp_text_float(text, &xyz[corner][i]))
                return hp_text_fault(text, fault, "a vertex needs three numbers");
        const char *wrong = hp_vertex_fault(xyz[corner]);
        if (wrong) return hp_text_fault(text, fault, "facet %zu: %s", mesh->count, wrong);
    }
    if (!take(text, "endloop", NULL)) return hp_text_fault(text, fault, "expected 'endloop'");
    if (!take(text, "endfacet", NULL)) return hp_text_fault(text, fault, "expected 'endfacet'");
    if (!hp_mesh_add(mesh, xyz[0], xyz[1], xyz[2]))
        return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", text->name);
    return HP_OK;
}

static hp_status read_solids(hp_text *text, hp_mesh *mesh, hp_fault *fault) {
    while (take(text, "solid", NULL)) {
        hp_text_next_line(text); /* the rest is a name */
        while (take(text, "facet", "normal")) {
            hp_status status = read_facet(text, mesh, fault);
            if (status != HP_OK) return status;
        }
        if (!hp_text_take(text, "endsolid"))
            return hp_text_fault(text, fault, "expected 'facet normal' or 'endsolid'");
        hp_text_next_line(text);
    }
    if (!hp_text_at_end(text)) return hp_text_fault(text, fault, "expected 'solid'");
    return HP_OK;
}

hp_status hp_mesh_read_stl(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault) {
    bool fits = bytes->n >= STL_HEADER && bytes->n == binary_length(bytes);
    if (fits) return read_binary(bytes, mesh, fault);
    hp_text text = hp_text_open(bytes);
    hp_status status;
    if (take(&text, "solid", NULL)) {
        hp_text_close(&text);
        text = hp_text_open(bytes);
        status = read_solids(&text, mesh, fault);
    } else if (bytes->n >= STL_HEADER) {
        status = read_binary(bytes, mesh, fault);
    } else {
        status =
            hp_text_fault(&text, fault, "neither a binary STL, which has %d bytes at least, nor 'solid'", STL_HEADER);
    }
    hp_text_close(&text);
    return status;
}
