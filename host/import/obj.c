/* Wavefront OBJ: the lines `v x y z` and `f v[/vt[/vn]] ...`; indices count from 1, or back from -1. Faces may come
 * before their vertices, so the text is gone through twice. */
#include "host/import/text.h"
#include "host/import/vertices.h"

#include <string.h>

/* Statements that say nothing about polygons. Anything else is no OBJ. */
static bool ignored(const char *word, size_t n) {
    static const char known[] = " vt vn vp g o s mg usemtl mtllib usemap maplib l p cstype deg bmat step curv curv2 "
                                "surf parm trim hole scrv sp "
                                "end con bevel c_interp d_interp lod shadow_obj trace_obj ctech stech call csh ";
    char key[16];
    if (n + 3 > sizeof key) return false;
    key[0] = ' ';
    memcpy(key + 1, word, n);
    key[n + 1] = ' ';
    key[n + 2] = 0;
    return strstr(known, key);
}

/* As hp_text_at_line_end, where a line ends at a comment too and goes on after a backslash. */
static bool statement_ends(hp_text *text) {
    while (!hp_text_at_line_end(text) && *text->at == '\\') {
        text->at++;
        if (!hp_text_at_line_end(text)) return false;
        hp_text_next_line(text);
    }
    return hp_text_at_line_end(text) || *text->at == '#';
}

static hp_status read_vertex(hp_text *text, hp_vertices *vertices, hp_fault *fault) {
    float xyz[3];
    for (int i = 0; i < 3; i++)
        if (statement_ends(text) || !hp_text_float(text, &xyz[i]))
            return hp_text_fault(text, fault, "a vertex needs three numbers");
    const char *wrong = hp_vertex_fault(xyz);
    if (wrong) return hp_text_fault(text, fault, "vertex %zu: %s", vertices->count + 1, wrong);
    if (!hp_vertices_add(vertices, xyz)) return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", text->name);
    return HP_OK;
}

/* One corner "v/vt/vn": its vertex, given how many stood above this line. NULL: `fault` is set. */
static const float *read_corner(hp_text *text, const hp_vertices *vertices, size_t above, hp_fault *fault) {
    long long index;
    if (!hp_text_integer(text, &index)) {
        hp_text_fault(text, fault, "a face needs vertex indices");
        return NULL;
    }
    long long from_zero = index < 0 ? (long long)above + index : index - 1;
    if (index == 0 || from_zero < 0 || from_zero >= (long long)vertices->count) {
        hp_text_fault(text, fault, "vertex index %lld is not among the %zu vertices", index, vertices->count);
        return NULL;
    }
    const char *texture_and_normal;
    if (*text->at == '/') hp_text_word(text, &texture_and_normal);
    return vertices->xyz[from_zero];
}

static hp_status read_face(hp_text *text, const hp_vertices *vertices, size_t above, hp_mesh *mesh, hp_fault *fault) {
    hp_fan fan = {0};
    while (!statement_ends(text)) {
        const float *corner = read_corner(text, vertices, above, fault);
        if (!corner) return fault->status;
        if (!hp_fan_corner(&fan, mesh, corner))
            return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", text->name);
    }
    if (fan.corners < 3)
        return hp_text_fault(text, fault, "a face needs three corners, this one has %zu", fan.corners);
    return HP_OK;
}

static hp_status read_vertices(hp_text text, hp_vertices *vertices, hp_fault *fault) {
    for (; !hp_text_at_end(&text); hp_text_next_line(&text)) {
        const char *word;
        if (statement_ends(&text)) continue;
        if (hp_text_take(&text, "v")) {
            hp_status status = read_vertex(&text, vertices, fault);
            if (status != HP_OK) return status;
        } else if (!hp_text_take(&text, "f")) {
            size_t n = hp_text_word(&text, &word);
            if (!ignored(word, n)) {
                text.at = word;
                return hp_text_fault(&text, fault, "'%.*s' is no OBJ statement", (int)(n < 32 ? n : 32), word);
            }
        }
        while (!statement_ends(&text)) hp_text_word(&text, &word);
    }
    return HP_OK;
}

static hp_status read_faces(hp_text text, const hp_vertices *vertices, hp_mesh *mesh, hp_fault *fault) {
    size_t above = 0;
    for (; !hp_text_at_end(&text); hp_text_next_line(&text)) {
        const char *word;
        if (statement_ends(&text)) continue;
        if (hp_text_take(&text, "f")) {
            hp_status status = read_face(&text, vertices, above, mesh, fault);
            if (status != HP_OK) return status;
        } else {
            above += hp_text_take(&text, "v");
        }
        while (!statement_ends(&text)) hp_text_word(&text, &word);
    }
    return HP_OK;
}

hp_status hp_mesh_read_obj(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault) {
    hp_vertices vertices = {0};
    hp_text text = hp_text_open(bytes);
    hp_status status = read_vertices(text, &vertices, fault);
    if (status == HP_OK) status = read_faces(text, &vertices, mesh, fault);
    hp_text_close(&text);
    hp_vertices_free(&vertices);
    return status;
}
