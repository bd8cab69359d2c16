/* PLY ("Polygon File Format", Turk 1994): a header that declares elements and their properties, then their rows as
 * text or as binary of either byte order. Elements and properties of other names are stepped over. Nothing is
 * allocated by what the header claims: arrays grow with the rows that are really there. */
#include "host/import/text.h"
#include "host/import/vertices.h"

#include <string.h>

enum { MOST_ELEMENTS = 16, MOST_PROPERTIES = 64 };

typedef enum ply_format { PLY_ASCII, PLY_LITTLE, PLY_BIG } ply_format;
typedef enum ply_type { PLY_NONE, PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64 } ply_type;
typedef enum ply_role { PLY_OTHER, PLY_X, PLY_Y, PLY_Z, PLY_CORNERS } ply_role;

typedef struct ply_property {
    ply_role role;
    ply_type count; /* of a list; else PLY_NONE */
    ply_type type;
} ply_property;

typedef struct ply_element {
    char name[16];
    unsigned long long rows;
    size_t first, last; /* its properties */
} ply_element;

typedef struct ply_file {
    hp_text text; /* in binary rows only `at` moves */
    hp_fault *fault;
    ply_format format;
    ply_element elements[MOST_ELEMENTS];
    ply_property properties[MOST_PROPERTIES];
    size_t element_count, property_count;
    hp_vertices vertices;
    bool vertices_read;
} ply_file;

static const struct {
    const char *name, *sized_name;
    size_t size;
} types[] = {
    [PLY_NONE] = {"", "", 0},          [PLY_I8] = {"char", "int8", 1},      [PLY_U8] = {"uchar", "uint8", 1},
    [PLY_I16] = {"short", "int16", 2}, [PLY_U16] = {"ushort", "uint16", 2}, [PLY_I32] = {"int", "int32", 4},
    [PLY_U32] = {"uint", "uint32", 4}, [PLY_F32] = {"float", "float32", 4}, [PLY_F64] = {"double", "float64", 8},
};

/* ---- header ---- */

static ply_type take_type(ply_file *ply) {
    for (ply_type type = PLY_I8; type <= PLY_F64; type++)
        if (hp_text_take(&ply->text, types[type].name) || hp_text_take(&ply->text, types[type].sized_name))
            return type;
    return PLY_NONE;
}

static bool read_format(ply_file *ply) {
    if (hp_text_take(&ply->text, "ascii"))
        ply->format = PLY_ASCII;
    else if (hp_text_take(&ply->text, "binary_little_endian"))
        ply->format = PLY_LITTLE;
    else if (hp_text_take(&ply->text, "binary_big_endian"))
        ply->format = PLY_BIG;
    else
        return false;
    return hp_text_take(&ply->text, "1.0");
}

static bool read_element(ply_file *ply) {
    if (ply->element_count == MOST_ELEMENTS) return false;
    const char *name;
    long long rows;
    size_t n = hp_text_word(&ply->text, &name);
    if (n == 0 || !hp_text_integer(&ply->text, &rows) || rows < 0) return false;
    ply_element *element = &ply->elements[ply->element_count++];
    element->rows = (unsigned long long)rows;
    element->first = element->last = ply->property_count;
    if (n < sizeof element->name) memcpy(element->name, name, n);
    return true;
}

static bool read_property(ply_file *ply) {
    if (ply->element_count == 0 || ply->property_count == MOST_PROPERTIES) return false;
    ply_property *property = &ply->properties[ply->property_count++];
    ply->elements[ply->element_count - 1].last = ply->property_count;
    bool list = hp_text_take(&ply->text, "list");
    if (list) {
        property->count = take_type(ply);
        if (property->count == PLY_NONE || property->count >= PLY_F32) return false;
    }
    property->type = take_type(ply);
    if (property->type == PLY_NONE) return false;
    if (list) {
        if (hp_text_take(&ply->text, "vertex_indices") || hp_text_take(&ply->text, "vertex_index"))
            property->role = PLY_CORNERS;
    } else if (hp_text_take(&ply->text, "x"))
        property->role = PLY_X;
    else if (hp_text_take(&ply->text, "y"))
        property->role = PLY_Y;
    else if (hp_text_take(&ply->text, "z"))
        property->role = PLY_Z;
    return true;
}

static hp_status read_header(ply_file *ply) {
    hp_text *text = &ply->text;
    if (!hp_text_take(text, "ply")) return hp_text_fault(text, ply->fault, "a PLY file begins with 'ply'");
    bool formatted = false;
    for (hp_text_next_line(text); !hp_text_at_end(text); hp_text_next_line(text)) {
        bool fine = true;
        if (hp_text_take(text, "end_header")) {
            if (!formatted) return hp_text_fault(text, ply->fault, "the header has no 'format'");
            hp_text_next_line(text);
            return HP_OK;
        }
        if (hp_text_take(text, "format"))
            fine = formatted = read_format(ply);
        else if (hp_text_take(text, "element"))
            fine = read_element(ply);
        else if (hp_text_take(text, "property"))
            fine = read_property(ply);
        else
            fine = hp_text_at_line_end(text) || hp_text_take(text, "comment") || hp_text_take(text, "obj_info");
        if (!fine) return hp_text_fault(text, ply->fault, "not a PLY header line that hitpipe knows");
    }
    return hp_text_fault(text, ply->fault, "truncated: the header has no 'end_header'");
}

/* ---- rows ---- */

static double decode(ply_type type, uint64_t bits) {
    float f;
    double d;
    uint32_t low = (uint32_t)bits;
    switch (type) {
    case PLY_I8:
        return (int8_t)low;
    case PLY_I16:
        return (int16_t)low;
    case PLY_I32:
        return (int32_t)low;
    case PLY_F32:
        memcpy(&f, &low, sizeof f);
        return f;
    case PLY_F64:
        memcpy(&d, &bits, sizeof d);
        return d;
    default:
        return low;
    }
}

/* The next number. Doubles hold every type exactly; text becomes the nearest binary32 at once, not by way of a
 * double. */
static bool take_number(ply_file *ply, ply_type type, double *value) {
    if (ply->format == PLY_ASCII) {
        float real;
        long long whole;
        bool found = type >= PLY_F32 ? hp_text_float(&ply->text, &real) : hp_text_integer(&ply->text, &whole);
        if (found) *value = type >= PLY_F32 ? (double)real : (double)whole;
        return found;
    }
    size_t size = types[type].size;
    if ((size_t)(ply->text.end - ply->text.at) < size) return false;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)(uint8_t)ply->text.at[i] << 8 * (ply->format == PLY_LITTLE ? i : size - 1 - i);
    ply->text.at += size;
    *value = decode(type, bits);
    return true;
}

static hp_status row_fault(ply_file *ply, const ply_element *element, unsigned long long row, const char *what) {
    if (ply->format == PLY_ASCII)
        return hp_text_fault(&ply->text, ply->fault, "%s %llu: %s", element->name, row, what);
    return hp_fault_set(ply->fault, HP_ERROR_INPUT, "%s: %s %llu: %s", ply->text.name, element->name, row, what);
}

static hp_status read_list(ply_file *ply, const ply_property *property, const ply_element *element,
                           unsigned long long row, hp_mesh *mesh) {
    static const char cut[] = "truncated, or not the numbers that the header promises";
    double count, index;
    if (!take_number(ply, property->count, &count) || count < 0) return row_fault(ply, element, row, cut);
    bool corners = property->role == PLY_CORNERS && strcmp(element->name, "face") == 0;
    if (corners && count < 3) return row_fault(ply, element, row, "fewer than three corners");
    hp_fan fan = {0};
    for (double i = 0; i < count; i++) {
        if (!take_number(ply, property->type, &index)) return row_fault(ply, element, row, cut);
        if (!corners) continue;
        if (!(index >= 0 && index < (double)ply->vertices.count))
            return row_fault(ply, element, row, "a vertex index out of range");
        if (!hp_fan_corner(&fan, mesh, ply->vertices.xyz[(size_t)index]))
            return hp_fault_set(ply->fault, HP_ERROR_MEMORY, "%s: out of memory", ply->text.name);
    }
    return HP_OK;
}

static hp_status read_row(ply_file *ply, const ply_element *element, unsigned long long row, hp_mesh *mesh) {
    float xyz[3] = {0, 0, 0};
    for (size_t i = element->first; i < element->last; i++) {
        const ply_property *property = &ply->properties[i];
        if (property->count != PLY_NONE) {
            hp_status status = read_list(ply, property, element, row, mesh);
            if (status != HP_OK) return status;
            continue;
        }
        double value;
        if (!take_number(ply, property->type, &value))
            return row_fault(ply, element, row, "truncated, or not the numbers that the header promises");
        if (property->role != PLY_OTHER) xyz[property->role - PLY_X] = (float)value;
    }
    if (ply->format == PLY_ASCII) {
        if (!hp_text_at_line_end(&ply->text))
            return row_fault(ply, element, row, "more numbers than the header promises");
        hp_text_next_line(&ply->text);
    }
    if (strcmp(element->name, "vertex") != 0) return HP_OK;
    const char *wrong = hp_vertex_fault(xyz);
    if (wrong) return row_fault(ply, element, row, wrong);
    if (!hp_vertices_add(&ply->vertices, xyz))
        return hp_fault_set(ply->fault, HP_ERROR_MEMORY, "%s: out of memory", ply->text.name);
    return HP_OK;
}

static bool has_coordinates(const ply_file *ply, const ply_element *element) {
    unsigned found = 0;
    for (size_t i = element->first; i < element->last; i++) found |= 1u << ply->properties[i].role;
    return (found >> PLY_X & 7) == 7;
}

static hp_status read_rows(ply_file *ply, hp_mesh *mesh) {
    for (size_t e = 0; e < ply->element_count; e++) {
        const ply_element *element = &ply->elements[e];
        bool vertices = strcmp(element->name, "vertex") == 0;
        if (vertices && !has_coordinates(ply, element))
            return hp_fault_set(ply->fault, HP_ERROR_INPUT, "%s: vertices without x, y and z", ply->text.name);
        if (strcmp(element->name, "face") == 0 && !ply->vertices_read)
            return hp_fault_set(ply->fault, HP_ERROR_INPUT, "%s: faces before vertices", ply->text.name);
        ply->vertices_read |= vertices;
        for (unsigned long long row = 0; row < element->rows && element->first < element->last; row++) {
            hp_status status = read_row(ply, element, row, mesh);
            if (status != HP_OK) return status;
        }
    }
    return HP_OK;
}

hp_status hp_mesh_read_ply(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault) {
    ply_file ply = {.text = hp_text_open(bytes), .fault = fault};
    hp_status status = read_header(&ply);
    if (status == HP_OK) status = read_rows(&ply, mesh);
    hp_text_close(&ply.text);
    hp_vertices_free(&ply.vertices);
    return status;
}
