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

static void refused(const char *text, const char *words) {
    hp_objects objects;
    hp_fault fault = {0};
    assert_int_equal(read_text(text, HP_RAY, &objects, &fault), HP_ERROR_INPUT);
    if (!strstr(fault.message, words)) fail_msg("'%s' is not in '%s'", words, fault.message);
    assert_null(objects.words);
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
    refused("", "no ray in the file");
    refused("a,b,c\n", "no ray in the file");
    refused("1,2,3,4,5,6\na,b,c\n", "f.csv:2:1: not a number");
    refused("1,2,3,4,5\n", "f.csv:1:10: a ray has 6 numbers, here are 5");
    refused("1,2,3,4,5,6,7\n", "f.csv:1:12: a ray has 6 numbers, here are more");
    refused("1,2,3,4,5,\n", "here are 5");
    refused("1,2,,4,5,6\n", "f.csv:1:5: not a number");
    refused("1 2 3 4 5 6\n", "expected a comma after number 1");
    refused("\n1,2,3,0,-0,0\n", "f.csv:2:1: direction is zero");
    refused("1,2,nan,4,5,6\n", "f.csv:1:1: ");
    refused("1,2,1e39,4,5,6\n", "f.csv:1:1: ");
    refused("1,2,3,4,5,6\n1,2,3,4,inf,6\n", "f.csv:2:1: ");
    refused("1.5.2,2,3,4,5,6\n", "f.csv:1:1: not a number");
    refused("1,2,3x,4,5,6\n", "f.csv:1:5: not a number");
}

/* What passes for a header is never looked at again, so nothing that holds a number may. */
static void a_broken_first_line_is_no_header(void **state) {
    (void)state;
    refused("l,2,3,4,5,6\n1,2,3,4,5,6\n", "f.csv:1:1: not a number");
    refused(",2,3,4,5,6\n1,2,3,4,5,6\n", "f.csv:1:1: not a number");
    refused("\"1\",2,3,4,5,6\n1,2,3,4,5,6\n", "f.csv:1:1: not a number");
    refused("x,y,z,1\n1,2,3,4,5,6\n", "f.csv:1:1: not a number");
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
    refused("\xEF\xBB\xBFone,2,3,4,5,6\n", "f.csv:1:1: not a number");
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
        cmocka_unit_test(a_byte_order_mark_is_no_header),
        cmocka_unit_test(results_read_back_to_the_same_bits),
    };
    return cmocka_run_group_tests_name("csv", tests, NULL, NULL);
}
