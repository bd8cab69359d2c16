/* Objects from CSV, and results to CSV: the same bits both ways, and errors with their place. */
#include "host/import/csv.h"
#include "host/output/result_csv.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hp_status read_text(const char *text, hp_object object, hp_objects *objects, hp_fault *fault) {
    hp_bytes bytes;
    assert_int_equal(hp_bytes_copy("f.csv", text, strlen(text), &bytes, fault), HP_OK);
    hp_status status = hp_csv_read(&bytes, object, objects, fault);
    hp_bytes_free(&bytes);
    return status;
}

static void refused_as(hp_object object, const char *text, const char *words) {
    hp_objects objects;
    hp_fault fault = {0};
    assert_int_equal(read_text(text, object, &objects, &fault), HP_ERROR_INPUT);
    if (!strstr(fault.message, words)) fail_msg("'%s' is not in '%s'", words, fault.message);
    assert_null(objects.words);
}

static void refused(const char *text, const char *words) {
    refused_as(HP_RAY, text, words);
}

static void lines_become_objects(void **state) {
    (void)state;
    static const char text[] = "ox,oy,oz,dx,dy,dz\n# comment\n\n 1, 2 ,3,4,5,6 # why\r\n0x1p-149,-0,1e-3,+7,8.5,9";
    static const float words[] = {1, 2, 3, 4, 5, 6, 0x1p-149f, -0.0f, 1e-3f, 7, 8.5f, 9};
    hp_objects objects;
    hp_fault fault = {0};
    if (read_text(text, HP_RAY, &objects, &fault) != HP_OK) fail_msg("%s", fault.message);
    assert_int_equal(objects.count, 2);
    assert_memory_equal(objects.words, words, sizeof words);
    hp_objects_free(&objects);
}

static void broken_lines_are_refused_with_their_place(void **state) {
    (void)state;
    refused("", "f.csv: no ray in the file");
    refused("\n  \n# a\n", "f.csv: no ray in the file");
    refused("a,b,c\n", "f.csv: no ray in the file: its only line has no numbers, which makes it a header");
    refused("1,2,3,4,5,6\na,b,c\n", "f.csv:2:1: 'a' is not a number");
    refused("1,2,3,4,5\n",
            "f.csv:1:10: a ray has 6 numbers: origin xyz, direction xyz (any length but zero); here are 5");
    refused("1,2,3,4,5,6,7\n", "f.csv:1:12: a ray has 6 numbers");
    refused("1,2,3,4,5,6,7 , 8 # nine\n", "here are 8");
    refused("1,2,3,4,5,\n", "here are 5");
    refused("1,2,3,4,5,6,\n", "f.csv:1:12: a comma after the last number");
    refused("1,2,3,4,5,6, \r\n", "f.csv:1:12: a comma after the last number");
    refused("1,2,,4,5,6\n", "f.csv:1:5: a number is missing");
    refused("1 2 3 4 5 6\n", "f.csv:1:3: expected a comma after number 1, not '2'");
    refused("1;2;3;4;5;6\n", "f.csv:1:2: expected a comma after number 1, not ';2;3;4;5;6'");
    refused("1,2,3,4,5,6 // seven\n", "f.csv:1:13: expected the line's end after number 6, not '//'");
    refused("\n1,2,3,0,-0,0\n", "f.csv:2:1: direction is zero");
    refused("1,2, nan,4,5,6\n", "f.csv:1:6: a NaN");
    refused("1,2,1e39,4,5,6\n", "f.csv:1:5: an infinity, or a number past binary32");
    refused("1,2,3,4,5,6\n1,2,3,4,-inf,6\n", "f.csv:2:9: an infinity");
    refused("1.5.2,2,3,4,5,6\n", "f.csv:1:1: '1.5.2' is not a number");
    refused("1,2,3x,4,5,6\n", "f.csv:1:5: '3x' is not a number");
    refused("1,2,a-word-that-goes-on-and-on-and-on,4,5,6\n", "f.csv:1:5: 'a-word-that-goes-on-a...' is not");
}

/* What passes for a header is never looked at again, so nothing that holds a number may. */
static void a_broken_first_line_is_no_header(void **state) {
    (void)state;
    refused("l,2,3,4,5,6\n1,2,3,4,5,6\n", "f.csv:1:1: 'l' is not a number");
    refused(",2,3,4,5,6\n1,2,3,4,5,6\n", "f.csv:1:1: a number is missing");
    refused("\"1\",2,3,4,5,6\n1,2,3,4,5,6\n", "f.csv:1:1: '\"1\"' is not a number: take the quotes away");
    refused("\"1\",\"2\",\"3\",\"4\",\"5\",\"6\"\n1,2,3,4,5,6\n", "f.csv:1:1: '\"1\"' is not a number");
    refused("x,y,z,1\n1,2,3,4,5,6\n", "f.csv:1:1: 'x' is not a number");
    refused("\x7f"
            "ELF\x02\n1,2,3,4,5,6\n",
            "f.csv:1:1: '\\x7fELF\\x02' is not a number");
}

/* From other systems, and other programs. */
static void lines_of_other_systems_are_read_or_named(void **state) {
    (void)state;
    hp_objects objects;
    hp_fault fault = {0};
    if (read_text("1,2,3,4,5,6\r\n1,2,3,4,5,6\r\n\r\n", HP_RAY, &objects, &fault) != HP_OK)
        fail_msg("%s", fault.message);
    assert_int_equal(objects.count, 2);
    hp_objects_free(&objects);
    if (read_text("\"ox\",\"oy\",\"oz\",\"dx\",\"dy\",\"dz\"\n1,2,3,4,5,6", HP_RAY, &objects, &fault) != HP_OK)
        fail_msg("%s", fault.message);
    assert_int_equal(objects.count, 1);
    hp_objects_free(&objects);
    refused("1,2,3,4,5,6\r1,2,3,4,5,6\r", "f.csv:1:12: a carriage return alone ends no line");
    refused("x,y,z,dx,dy,dz\r1,2,3,4,5,6\r", "f.csv:1:15: a carriage return alone ends no line");
    refused("\xFF\xFE\x31", "f.csv: text in UTF-16: save it as UTF-8");
    refused("\xFE\xFF\x31", "f.csv: text in UTF-16: save it as UTF-8");
    refused("1,2,\xE2\x88\x92"
            "3,4,5,6\n",
            "f.csv:1:5: '\\xe2\\x88\\x923' is not a number");
    hp_bytes bytes;
    assert_int_equal(hp_bytes_copy("f.csv", "1,2,3\0,4,5,6\n", 14, &bytes, &fault), HP_OK);
    assert_int_equal(hp_csv_read(&bytes, HP_RAY, &objects, &fault), HP_ERROR_INPUT);
    assert_string_equal(fault.message, "f.csv:1:6: expected a comma after number 3, not '\\x00'");
    hp_bytes_free(&bytes);
}

static void a_byte_order_mark_is_no_header(void **state) {
    (void)state;
    hp_objects objects;
    hp_fault fault = {0};
    if (read_text("\xEF\xBB\xBF"
                  "1,2,3,4,5,6\n",
                  HP_RAY, &objects, &fault) != HP_OK)
        fail_msg("%s", fault.message);
    assert_int_equal(objects.count, 1);
    assert_true(objects.words[0] == 1);
    hp_objects_free(&objects);
    refused("\xEF\xBB\xBFone,2,3,4,5,6\n", "f.csv:1:1: 'one' is not a number");
}

static const struct {
    hp_object object;
    const char *name, *line; /* one that is taken */
} lines[] = {
    {HP_RAY, "ray", "1,2,3,0,0,-1"},
    {HP_TRIANGLE, "triangle", "0,0,0,1,0,0,0,1,0"},
    {HP_SPHERE, "sphere", "1,2,3,0"},
    {HP_AABB, "aabb", "-1,-2,-3,-1,2,3"},
    {HP_OBB, "obb", "1,2,3,0,1,2,0.6,0.8,0,-0.8,0.6,0,0,0,1"},
    {HP_CYLINDER, "cylinder", "0,0,0,0,0,1e-3,0"},
    {HP_PLANE, "plane", "0,0.6,-0.8,7"},
};

static void every_type_is_read_by_its_number_of_words(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        char text[512], words[128];
        snprintf(text, sizeof text, "# %s\n%s\n%s # twice\n", lines[i].name, lines[i].line, lines[i].line);
        hp_objects objects;
        hp_fault fault;
        unsigned n = hp_object_words(lines[i].object);
        if (read_text(text, lines[i].object, &objects, &fault) != HP_OK) fail_msg("%s", fault.message);
        assert_int_equal(objects.count, 2);
        assert_memory_equal(objects.words, objects.words + n, n * sizeof(float));
        hp_objects_free(&objects);
        snprintf(text, sizeof text, "%s\n%s,4", lines[i].line, lines[i].line);
        snprintf(words, sizeof words, "f.csv:2:%zu: a%s %s has %u numbers: ", strlen(lines[i].line) + 1,
                 strchr("ao", lines[i].name[0]) ? "n" : "", lines[i].name, n);
        refused_as(lines[i].object, text, words);
        snprintf(words, sizeof words, "; here are %u", n + 1);
        refused_as(lines[i].object, text, words);
        snprintf(text, sizeof text, "%s", lines[i].line);
        *strrchr(text, ',') = 0;
        snprintf(words, sizeof words, "; here are %u", n - 1);
        refused_as(lines[i].object, text, words);
    }
}

static void what_a_type_forbids_is_refused_with_its_cause(void **state) {
    (void)state;
    refused_as(HP_SPHERE, "1,2,3,4\n1,2,3,-1e-30\n", "f.csv:2:1: radius is negative");
    refused_as(HP_AABB, "0,0,0,1,1,1\n\n0,0,1,1,1,0.999\n", "f.csv:3:1: min is greater than max");
    refused_as(HP_CYLINDER, "1,2,3,1,2,3,1\n", "f.csv:1:1: p0 and p1 are the same point");
    refused_as(HP_CYLINDER, "1,2,3,1,2,4,-1\n", "f.csv:1:1: radius is negative");
    refused_as(HP_OBB, "0,0,0,1,-1,1,1,0,0,0,1,0,0,0,1\n", "f.csv:1:1: half extent is negative");
    refused_as(HP_OBB, "0,0,0,1,1,1,1,0,0,0,1,0,0,0,0\n", "f.csv:1:1: axes are not orthonormal: w.w is 0, not 1");
    refused_as(HP_OBB, "0,0,0,1,1,1,0.707,0.707,0,-0.707,0.707,0,0,0,1\n",
               "axes are not orthonormal: u.u is 0.999698, not 1");
    refused_as(HP_OBB, "0,0,0,1,1,1,1,0,0,0,1,0,0.6,0,0.8\n", "axes are not orthonormal: u.w is 0.6, not 0");
    refused_as(HP_PLANE, "0,0,2,1\n", "f.csv:1:1: normal is not of length 1: n.n is 4, not 1");
    refused_as(HP_PLANE, "0,0,0,1\n", "f.csv:1:1: normal is zero");
    /* what became so in binary32 */
    refused_as(HP_RAY, "1,2,3,0,0,1e-60\n", "f.csv:1:1: direction is zero: it is too small for binary32");
    refused_as(HP_CYLINDER, "1,1,1,1,1,1.00000001,2\n",
               "f.csv:1:1: p0 and p1 are the same point: they are too near for binary32");
}

static void results_read_back_to_the_same_bits(void **state) {
    (void)state;
    uint32_t last = 1;
    for (int i = 0; i < 100000; i++) {
        last = last * 1664525 + 1013904223;
        float value, back;
        memcpy(&value, &last, sizeof value);
        if (!isfinite(value)) continue;
        hp_result result = {1, 42, value, {1, 2, 3}, 1};
        char line[256];
        FILE *file = fmemopen(line, sizeof line, "w");
        hp_result_csv_line(file, 7, 42, &result);
        fclose(file);
        assert_memory_equal(line, "7,42,1,", 7);
        back = strtof(line + 7, NULL);
        assert_memory_equal(&back, &value, sizeof value);
    }
    char line[256];
    FILE *file = fmemopen(line, sizeof line, "w");
    hp_result_csv_header(file);
    hp_result_csv_line(file, 0, HP_NO_INDEX, &(hp_result){0, HP_NO_INDEX, INFINITY, {0, 0, 0}, 1});
    fclose(file);
    assert_string_equal(line, "primary,secondary,F,T,cpx,cpy,cpz\n0,4294967295,0,inf,0,0,0\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_become_objects),
        cmocka_unit_test(broken_lines_are_refused_with_their_place),
        cmocka_unit_test(a_broken_first_line_is_no_header),
        cmocka_unit_test(lines_of_other_systems_are_read_or_named),
        cmocka_unit_test(a_byte_order_mark_is_no_header),
        cmocka_unit_test(every_type_is_read_by_its_number_of_words),
        cmocka_unit_test(what_a_type_forbids_is_refused_with_its_cause),
        cmocka_unit_test(results_read_back_to_the_same_bits),
    };
    return cmocka_run_group_tests_name("csv", tests, NULL, NULL);
}
