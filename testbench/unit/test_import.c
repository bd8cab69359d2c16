/* Mesh and heightfield readers: numbers to the last bit, file order, and every way a file can be broken. */
#include "host/import/heightfield.h"
#include "host/import/scene.h"
#include "host/import/text.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

typedef hp_status mesh_reader(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault);

/* Texts whose nearest binary32 is hard to find: ties, a hair off a tie, subnormals, many digits, the ends of the
 * range. */
static const struct {
    const char *text;
    uint32_t bits;
} decimals[] = {
    {"0.1", 0x3DCCCCCD},
    {"16777217", 0x4B800000},                                 /* tie, to even */
    {"16777217.0000000000000000000000000000001", 0x4B800001}, /* above the tie */
    {"16777219", 0x4B800002},                                 /* tie, to even upwards */
    {"1.00000005960464477539062500000", 0x3F800000},          /* 1 + 2^-24: tie */
    {"1.00000005960464477539062500001", 0x3F800001},
    {"1.17549435e-38", 0x00800000}, /* smallest normal */
    {"1.17549421e-38", 0x007FFFFF}, /* largest subnormal */
    {"1.4e-45", 0x00000001},
    {"7.006492321624085354618e-46", 0x00000000}, /* half the smallest: tie, to zero */
    {"7.006492321624085354619e-46", 0x00000001},
    {"3.4028234663852886e38", 0x7F7FFFFF},
    {"-0.0", 0x80000000},
    {"8.589973e9", 0x50000026}, /* 8589973000: tie */
    {"0."
     "000000000000000000000000000000000000011754943508222875079687365372222456778186655567720875215087517062784172594"
     "547271728515625",
     0x00800000},
    {"123456.789", 0x47F12065},
    {"3.14159265358979323846", 0x40490FDB},
};

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Reads a text as a mesh file. The mesh is the caller's. */
static hp_status read_text(mesh_reader *read, const char *text, hp_mesh *mesh, hp_fault *fault) {
    hp_bytes bytes;
    *mesh = (hp_mesh){0};
    assert_int_equal(hp_bytes_copy("file", text, strlen(text), &bytes, fault), HP_OK);
    hp_status status = read(&bytes, mesh, fault);
    hp_bytes_free(&bytes);
    return status;
}

/* The text is refused with words that contain `words`. */
static void refused(mesh_reader *read, const char *text, const char *words) {
    hp_mesh mesh;
    hp_fault fault = {0};
    assert_int_equal(read_text(read, text, &mesh, &fault), HP_ERROR_INPUT);
    if (!strstr(fault.message, words)) fail_msg("'%s' is not in '%s'", words, fault.message);
    hp_mesh_free(&mesh);
}

/* The first n bytes of a file alone are refused. */
static void refused_cut(mesh_reader *read, const uint8_t *file, size_t n) {
    hp_bytes bytes;
    hp_mesh mesh = {0};
    hp_fault fault;
    assert_int_equal(hp_bytes_copy("file", file, n, &bytes, &fault), HP_OK);
    if (read(&bytes, &mesh, &fault) != HP_ERROR_INPUT) fail_msg("accepted when cut to %zu bytes", n);
    hp_mesh_free(&mesh);
    hp_bytes_free(&bytes);
}

static void check_words(const hp_mesh *mesh, const float *words, size_t triangles) {
    assert_int_equal(mesh->count, triangles);
    assert_memory_equal(mesh->words, words, triangles * HP_TRIANGLE_WORDS * sizeof(float));
}

/* ---- numbers ---- */

static void decimals_become_the_nearest_binary32(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof decimals / sizeof decimals[0]; i++) {
        float value;
        assert_true(hp_parse_float(decimals[i].text, &value));
        if (bits_of(value) != decimals[i].bits)
            fail_msg("%s: %08X, not %08X", decimals[i].text, bits_of(value), decimals[i].bits);
    }
}

static void readers_take_the_nearest_binary32(void **state) {
    (void)state;
    static const struct {
        mesh_reader *read;
        const char *format;
    } readers[] = {
        {hp_mesh_read_obj, "v %s 0 0\nv 1 2 3\nv 4 5 9\nf 1 2 3\n"},
        {hp_mesh_read_ply,
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
         "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n%s 0 0\n1 2 3\n4 5 9\n3 "
         "0 1 2\n"},
        {hp_mesh_read_ply,
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty "
         "double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n%s 0 0\n1 2 "
         "3\n4 5 9\n3 0 1 2\n"},
        {hp_mesh_read_stl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex %s 0 0\nvertex 1 2 3\nvertex 4 5 "
                           "9\nendloop\nendfacet\nendsolid a\n"},
    };
    for (size_t r = 0; r < sizeof readers / sizeof readers[0]; r++)
        for (size_t i = 0; i < sizeof decimals / sizeof decimals[0]; i++) {
            char text[1024];
            snprintf(text, sizeof text, readers[r].format, decimals[i].text);
            hp_mesh mesh;
            hp_fault fault = {0};
            if (read_text(readers[r].read, text, &mesh, &fault) != HP_OK) fail_msg("%s", fault.message);
            if (bits_of(mesh.words[0]) != decimals[i].bits) fail_msg("reader %zu: %s", r, decimals[i].text);
            hp_mesh_free(&mesh);
        }
}

/* Why OBJ, PLY and STL do not go through assimp. If this ever fails, assimp has learned to parse, and they could. */
static void assimp_misses_the_nearest_binary32(void **state) {
    (void)state;
    size_t missed = 0;
    for (size_t i = 0; i < sizeof decimals / sizeof decimals[0]; i++) {
        char path[] = "/tmp/hitpipe-import-XXXXXX.obj";
        FILE *file = fdopen(mkstemps(path, 4), "w");
        fprintf(file, "v %s 0 0\nv 1 2 3\nv 4 5 9\nf 1 2 3\n", decimals[i].text);
        fclose(file);
        hp_mesh mesh = {0};
        hp_fault fault;
        if (hp_mesh_read_assimp(path, &mesh, &fault) != HP_OK || bits_of(mesh.words[0]) != decimals[i].bits) missed++;
        hp_mesh_free(&mesh);
        remove(path);
    }
    assert_true(missed > 0);
}

/* ---- file order and polygons ---- */

static void obj_keeps_file_order(void **state) {
    (void)state;
    /* faces before their vertices, a polygon, an index from the end, a repeated vertex, a continued line */
    static const char text[] = "# comment\no thing\nv 0 0 0\nv 1 0 0 # corner\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n"
                               "f 1/1/1 2//1 \\\n 3 4\nf -1 -2 -3\nf 5 1 2\nv 0 0 0\ns off\n";
    static const float words[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0,
                                  0, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0};
    hp_mesh mesh;
    hp_fault fault;
    assert_int_equal(read_text(hp_mesh_read_obj, text, &mesh, &fault), HP_OK);
    check_words(&mesh, words, 4);
    assert_int_equal(mesh.degenerate, 1);
    hp_mesh_free(&mesh);
}

static void stl_reads_several_solids(void **state) {
    (void)state;
    static const char facet[] = "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n"
                                " endloop\nendfacet\n";
    char text[1024];
    snprintf(text, sizeof text, "solid one\n%s%sendsolid one\n\nsolid\n%sendsolid\n", facet, facet, facet);
    static const float words[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    hp_mesh mesh;
    hp_fault fault;
    assert_int_equal(read_text(hp_mesh_read_stl, text, &mesh, &fault), HP_OK);
    check_words(&mesh, words, 3);
    hp_mesh_free(&mesh);
}

static void put32(uint8_t *at, uint32_t value, bool big) {
    for (int i = 0; i < 4; i++) at[i] = (uint8_t)(value >> 8 * (big ? 3 - i : i));
}

static const float square[4][3] = {{0, 0, 0.1f}, {1, 0, -0.0f}, {1, 1, 1e-42f}, {0, 1, 3e38f}};

/* A binary STL of the first `count` fan triangles of the square, in `file` (84 + 50 count bytes). */
static size_t make_stl(uint8_t *file, uint32_t count) {
    memset(file, ' ', 84);
    memcpy(file, "solid of a careless writer", 26);
    put32(file + 80, count, false);
    for (uint32_t i = 0; i < count; i++) {
        const float *corners[] = {square[0], square[i + 1], square[i + 2]};
        memset(file + 84 + 50 * i, 0, 50);
        for (int k = 0; k < 9; k++) put32(file + 84 + 50 * i + 12 + 4 * k, bits_of(corners[k / 3][k % 3]), false);
    }
    return 84 + 50 * count;
}

static void binary_stl_keeps_bits(void **state) {
    (void)state;
    uint8_t file[84 + 100];
    size_t n = make_stl(file, 2);
    hp_bytes bytes;
    hp_mesh mesh = {0};
    hp_fault fault;
    hp_bytes_copy("file", file, n, &bytes, &fault);
    assert_int_equal(hp_mesh_read_stl(&bytes, &mesh, &fault), HP_OK);
    assert_int_equal(mesh.count, 2);
    for (int k = 0; k < 9; k++)
        assert_int_equal(bits_of(mesh.words[9 + k]), bits_of(square[k < 3 ? 0 : k / 3 + 1][k % 3]));
    hp_mesh_free(&mesh);
    for (size_t cut = 0; cut < n; cut++) refused_cut(hp_mesh_read_stl, file, cut);
    file[0] = 'b'; /* nobody takes it for text now */
    for (size_t cut = 0; cut < n; cut++) refused_cut(hp_mesh_read_stl, file, cut);
    put32(bytes.data + 84 + 12, 0x7FC00000, false);
    assert_int_equal(hp_mesh_read_stl(&bytes, &mesh, &fault), HP_ERROR_INPUT);
    assert_non_null(strstr(fault.message, "facet 0"));
    hp_mesh_free(&mesh);
    hp_bytes_free(&bytes);
}

/* A binary PLY of the square as one polygon; a property and an element to step over. */
static size_t make_ply(uint8_t *file, bool big) {
    int n = sprintf(
        (char *)file,
        "ply\nformat binary_%s_endian 1.0\ncomment c\nelement vertex 4\nproperty uchar red\nproperty float x\n"
        "property float y\nproperty float z\nelement other 2\nproperty list uchar short s\nelement face 1\n"
        "property list uchar uint vertex_index\nend_header\n",
        big ? "big" : "little");
    uint8_t *at = file + n;
    for (int v = 0; v < 4; v++) {
        *at++ = 77;
        for (int k = 0; k < 3; k++, at += 4) put32(at, bits_of(square[v][k]), big);
    }
    *at++ = 0;
    *at++ = 1;
    *at++ = 9;
    *at++ = 9;
    *at++ = 4;
    for (uint32_t v = 0; v < 4; v++, at += 4) put32(at, v, big);
    return (size_t)(at - file);
}

static void binary_ply_keeps_bits(void **state) {
    (void)state;
    for (int big = 0; big < 2; big++) {
        uint8_t file[1024];
        size_t n = make_ply(file, big);
        hp_bytes bytes;
        hp_mesh mesh = {0};
        hp_fault fault = {0};
        hp_bytes_copy("file", file, n, &bytes, &fault);
        if (hp_mesh_read_ply(&bytes, &mesh, &fault) != HP_OK) fail_msg("%s", fault.message);
        assert_int_equal(mesh.count, 2);
        for (int k = 0; k < 9; k++) assert_int_equal(bits_of(mesh.words[k]), bits_of(square[k / 3][k % 3]));
        hp_mesh_free(&mesh);
        for (size_t cut = 0; cut < n; cut++) refused_cut(hp_mesh_read_ply, file, cut);
        put32(bytes.data + n - 4, 4, big); /* a vertex past the last */
        assert_int_equal(hp_mesh_read_ply(&bytes, &mesh, &fault), HP_ERROR_INPUT);
        assert_non_null(strstr(fault.message, "out of range"));
        hp_mesh_free(&mesh);
        hp_bytes_free(&bytes);
    }
}

static void assimp_reads_other_formats_in_order(void **state) {
    (void)state;
    char path[] = "/tmp/hitpipe-import-XXXXXX.off";
    FILE *file = fdopen(mkstemps(path, 4), "w");
    fputs("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 3 2 1\n", file);
    fclose(file);
    static const float words[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0};
    hp_mesh mesh;
    hp_fault fault = {0};
    if (hp_mesh_load(path, &mesh, &fault) != HP_OK) fail_msg("%s", fault.message);
    check_words(&mesh, words, 3);
    hp_mesh_free(&mesh);
    remove(path);
}

/* ---- broken files ---- */

static void broken_obj_is_refused_with_its_place(void **state) {
    (void)state;
    refused(hp_mesh_read_obj, "v 1 2\n", "file:1:6: a vertex needs three numbers");
    refused(hp_mesh_read_obj, "v 1.0.5 2 3\n", "file:1:3: a vertex needs three numbers");
    refused(hp_mesh_read_obj, "v 0 0 0\nv nan 0 0\n", "file:2:10: vertex 2: a coordinate is NaN");
    refused(hp_mesh_read_obj, "v 0 0 1e39\n", "a coordinate is infinite");
    refused(hp_mesh_read_obj, "v 0 0 -inf\n", "a coordinate is infinite");
    refused(hp_mesh_read_obj, "v 0 0 0\nf 1 1 2\n", "file:2:8: vertex index 2 is not among the 1 vertices");
    refused(hp_mesh_read_obj, "v 0 0 0\nf 1 1 -2\n", "vertex index -2");
    refused(hp_mesh_read_obj, "v 0 0 0\nf 1 1 0\n", "vertex index 0");
    refused(hp_mesh_read_obj, "v 0 0 0\nf 1 1\n", "three corners, this one has 2");
    refused(hp_mesh_read_obj, "v 0 0 0\nf 1 1 99999999999999999999\n", "vertex indices");
    refused(hp_mesh_read_obj, "v 0 0 0\nPK\003\004junk\n", "no OBJ statement");
}

#define PLY_HEADER(vertices, faces)                                                                                  \
    "ply\nformat ascii 1.0\nelement vertex " vertices "\nproperty float x\nproperty float y\nproperty float z\n"     \
    "element face " faces "\nproperty list uchar int vertex_indices\nend_header\n"

static void broken_ply_is_refused_with_its_place(void **state) {
    (void)state;
    refused(hp_mesh_read_ply, "plx\n", "begins with 'ply'");
    refused(hp_mesh_read_ply, "ply\nformat ascii 1.0\n", "no 'end_header'");
    refused(hp_mesh_read_ply, "ply\nelement vertex 1\nend_header\n", "no 'format'");
    refused(hp_mesh_read_ply, "ply\nformat ascii 2.0\n", "file:2:");
    refused(hp_mesh_read_ply, "ply\nformat ascii 1.0\nelement vertex 3\nproperty quaternion x\n", "file:4:");
    refused(hp_mesh_read_ply, PLY_HEADER("1", "1") "0 0 nan\n", "vertex 0: a coordinate is NaN");
    refused(hp_mesh_read_ply, PLY_HEADER("2", "1") "0 0 0\n", "vertex 1: truncated");
    refused(hp_mesh_read_ply, PLY_HEADER("1", "1") "0 0 0\n3 0 0 1\n", "face 0: a vertex index out of range");
    refused(hp_mesh_read_ply, PLY_HEADER("1", "1") "0 0 0\n2 0 0\n", "fewer than three corners");
    refused(hp_mesh_read_ply, PLY_HEADER("1", "1") "0 0 0 0\n", "more numbers");
    refused(hp_mesh_read_ply, PLY_HEADER("1", "4000000000") "0 0 0\n3 0 0 0\n", "face 1: truncated");
    refused(hp_mesh_read_ply, PLY_HEADER("4000000000", "1") "0 0 0\n", "vertex 1: truncated");
    refused(hp_mesh_read_ply, "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
            "without x, y and z");
    refused(hp_mesh_read_ply,
            "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 0 0\n",
            "faces before vertices");
}

static void broken_stl_is_refused_with_its_place(void **state) {
    (void)state;
    refused(hp_mesh_read_stl, "", "neither a binary STL");
    refused(hp_mesh_read_stl, "solid a\nfacet normal 0 0 1\n", "expected 'outer loop'");
    refused(hp_mesh_read_stl, "solid a\n", "expected 'facet normal' or 'endsolid'");
    refused(hp_mesh_read_stl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "file:4:11: a vertex needs");
    refused(hp_mesh_read_stl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n", "a coordinate is NaN");
    refused(hp_mesh_read_stl, "solid a\nendsolid\nliquid b\n", "file:3:1: expected 'solid'");
}

static void empty_and_missing_files_are_refused(void **state) {
    (void)state;
    char path[] = "/tmp/hitpipe-import-XXXXXX.obj";
    FILE *file = fdopen(mkstemps(path, 4), "w");
    fputs("v 0 0 0\n", file);
    fclose(file);
    hp_mesh mesh;
    hp_fault fault;
    assert_int_equal(hp_mesh_load(path, &mesh, &fault), HP_ERROR_INPUT);
    assert_non_null(strstr(fault.message, "no triangles"));
    remove(path);
    assert_int_equal(hp_mesh_load(path, &mesh, &fault), HP_ERROR_INPUT);
    assert_non_null(strstr(fault.message, "No such file"));
    assert_int_equal(hp_mesh_load("/", &mesh, &fault), HP_ERROR_INPUT);
}

/* ---- degenerate triangles ---- */

static void degenerate_triangles_are_found_exactly(void **state) {
    (void)state;
    static const struct {
        float words[9];
        bool degenerate;
    } cases[] = {
        {{0, 0, 0, 1, 0, 0, 0, 1, 0}, false},
        {{1, 2, 3, 1, 2, 3, 7, 8, 9}, true},
        {{0, 0, 0, 1, 1, 1, 3, 3, 3}, true},
        {{5, 5, 5, 5, 5, 5, 5, 5, 5}, true},
        {{0, 0, 0, 1e-45f, 0, 0, 0, 1e-45f, 0}, false},                      /* area far below any double's square */
        {{1e38f, 1e38f, 0, -1e38f, -1e38f, 0, 3e38f, 3e38f, 1e-45f}, false}, /* a hair off the line */
        {{1e38f, 1e38f, 0, -1e38f, -1e38f, 0, 3e38f, 3e38f, 0}, true},
        {{0.1f, 0.1f, 0.1f, 0.2f, 0.2f, 0.2f, 0.3f, 0.3f, 0.3f}, true},
        {{0.1f, 0.2f, 0, 0.3f, 0.6f, 0, 0.7f, 1.4f, 0}, true}, /* y is exactly 2 x, though differences round */
        {{1, 0, 0, 1, 0x1p60f, 0, 1, 0x1p-30f, 0}, true},      /* 2^60 comes and goes; 2^-30 must stay meanwhile */
        {{16777216, 1, 0, 16777218, 2, 0, 16777222, 4, 0}, true},
        {{16777216, 1, 0, 16777218, 2, 0, 16777222, 4.0000005f, 0}, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int turn = 0; turn < 3; turn++) { /* whichever axis or corner comes first */
            float words[9];
            for (int k = 0; k < 9; k++) words[k] = cases[i].words[(k / 3 + turn) % 3 * 3 + (k % 3 + turn) % 3];
            if (hp_triangle_degenerate(words) != cases[i].degenerate) fail_msg("case %zu, turn %d", i, turn);
        }
}

/* ---- heightfields ---- */

static hp_status read_pgm(const char *text, size_t n, hp_heightfield *field, hp_fault *fault) {
    hp_bytes bytes;
    assert_int_equal(hp_bytes_copy("file", text, n, &bytes, fault), HP_OK);
    hp_status status = hp_heightfield_read_pgm(&bytes, field, fault);
    hp_bytes_free(&bytes);
    return status;
}

static void pgm_reads_text_and_binary(void **state) {
    (void)state;
    static const char text[] = "P2\n# a comment\n3 # columns\n2\n600\n1 2 3\n400 500 # heights\n600\n";
    static const char bytes[] = "P5\n3 2\n600\n\0\1\0\2\0\3\1\220\1\364\2\130";
    static const char narrow[] = "P5 3 2 255\n\1\2\3\4\5\377";
    static const float heights[] = {1, 2, 3, 400, 500, 600}, low[] = {1, 2, 3, 4, 5, 255};
    hp_heightfield field;
    hp_fault fault = {0};
    const struct {
        const char *file;
        size_t n;
        const float *heights;
    } cases[] = {
        {text, sizeof text - 1, heights}, {bytes, sizeof bytes - 1, heights}, {narrow, sizeof narrow - 1, low}};
    for (int i = 0; i < 3; i++) {
        if (read_pgm(cases[i].file, cases[i].n, &field, &fault) != HP_OK) fail_msg("%s", fault.message);
        assert_int_equal(field.rows, 2);
        assert_int_equal(field.columns, 3);
        assert_memory_equal(field.heights, cases[i].heights, sizeof heights);
        hp_heightfield_free(&field);
    }
    for (size_t n = 0; n < sizeof bytes - 1; n++) {
        assert_int_equal(read_pgm(bytes, n, &field, &fault), HP_ERROR_INPUT);
        assert_null(field.heights);
    }
}

static void broken_pgm_is_refused(void **state) {
    (void)state;
    static const char *const files[] = {
        "P3\n2 2\n1\n0 0 0 0\n",      "P2\n2 2\n1\n0 0 0 2\n",     "P2\n2 2\n1\n0 0 0\n",
        "P2\n2 2\n70000\n0 0 0 0\n",  "P2\n-2 2\n1\n0 0 0 0\n",    "P2\n1 4\n1\n0 0 0 0\n",
        "P2\n2 2\n1\n0 0 x 0\n",      "P5\n65536 65536\n255\nabc", "P5\n4294967296 4294967296\n9\n",
        "P5 2 2 9\n\x01\x02\x03\x0A",
    };
    hp_heightfield field;
    hp_fault fault;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (read_pgm(files[i], strlen(files[i]), &field, &fault) != HP_ERROR_INPUT) fail_msg("%s", files[i]);
}

static void heightfield_makes_triangles_in_row_major_order(void **state) {
    (void)state;
    float heights[] = {10, 11, 12, 13, 14, 15};
    hp_heightfield field = {.rows = 2, .columns = 3, .heights = heights, .spacing = {2, -5}};
    static const float words[] = {0, 0, 10, 2, 0, 11, 0, -5, 13, 2, 0, 11, 2, -5, 14, 0, -5, 13,
                                  2, 0, 11, 4, 0, 12, 2, -5, 14, 4, 0, 12, 4, -5, 15, 2, -5, 14};
    hp_mesh mesh;
    hp_fault fault;
    assert_int_equal(hp_heightfield_mesh(&field, &mesh, &fault), HP_OK);
    assert_int_equal(mesh.room, 4); /* asked for at once, and not a triangle more */
    check_words(&mesh, words, 4);
    hp_mesh_free(&mesh);
    field.spacing[0] = 3e38;
    assert_int_equal(hp_heightfield_mesh(&field, &mesh, &fault), HP_ERROR_INPUT);
}

static void resampling_keeps_corners_and_is_bilinear(void **state) {
    (void)state;
    hp_heightfield field = {.rows = 2, .columns = 2, .heights = malloc(4 * sizeof(float)), .spacing = {8, 4}};
    memcpy(field.heights, (float[]){0, 4, 8, 16}, 4 * sizeof(float));
    hp_fault fault;
    assert_int_equal(hp_heightfield_resample(&field, 3, 5, &fault), HP_OK);
    static const float heights[] = {0, 1, 2, 3, 4, 4, 5.5f, 7, 8.5f, 10, 8, 10, 12, 14, 16};
    assert_int_equal(field.rows, 3);
    assert_int_equal(field.columns, 5);
    assert_memory_equal(field.heights, heights, sizeof heights);
    assert_true(field.spacing[0] == 2 && field.spacing[1] == 2);
    hp_heightfield_free(&field);
}

static void the_terrain_has_the_papers_triangles(void **state) {
    (void)state;
    hp_scene scene;
    hp_fault fault = {0};
    hp_scene_def def = {.rows = 292, .columns = 447};
    if (hp_scene_load("vectors/terrain/jacksboro.exr", &def, &scene, &fault) != HP_OK) fail_msg("%s", fault.message);
    assert_int_equal(scene.count, 259572);
    assert_int_equal(scene.degenerate, 0);
    assert_true(scene.bounds.low[2] >= 236 && scene.bounds.high[2] <= 1076);
    assert_true(scene.bounds.high[0] == 402 * 72 && scene.bounds.low[1] == -343 * 90);
    hp_scene_free(&scene);
    def = (hp_scene_def){.rows = 1, .columns = 5};
    assert_int_equal(hp_scene_load("vectors/terrain/jacksboro.exr", &def, &scene, &fault), HP_ERROR_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decimals_become_the_nearest_binary32),
        cmocka_unit_test(readers_take_the_nearest_binary32),
        cmocka_unit_test(assimp_misses_the_nearest_binary32),
        cmocka_unit_test(obj_keeps_file_order),
        cmocka_unit_test(stl_reads_several_solids),
        cmocka_unit_test(binary_stl_keeps_bits),
        cmocka_unit_test(binary_ply_keeps_bits),
        cmocka_unit_test(assimp_reads_other_formats_in_order),
        cmocka_unit_test(broken_obj_is_refused_with_its_place),
        cmocka_unit_test(broken_ply_is_refused_with_its_place),
        cmocka_unit_test(broken_stl_is_refused_with_its_place),
        cmocka_unit_test(empty_and_missing_files_are_refused),
        cmocka_unit_test(degenerate_triangles_are_found_exactly),
        cmocka_unit_test(pgm_reads_text_and_binary),
        cmocka_unit_test(broken_pgm_is_refused),
        cmocka_unit_test(heightfield_makes_triangles_in_row_major_order),
        cmocka_unit_test(resampling_keeps_corners_and_is_bilinear),
        cmocka_unit_test(the_terrain_has_the_papers_triangles),
    };
    return cmocka_run_group_tests_name("import", tests, NULL, NULL);
}
