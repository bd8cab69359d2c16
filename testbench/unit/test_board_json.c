/* Board files: presets, nested and dotted keys, and every way they can be wrong. */
#include "host/import/board_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static hp_status read_text(const char *text, hp_config *config, hp_fault *fault) {
    hp_bytes bytes;
    assert_int_equal(hp_bytes_copy("b.json", text, strlen(text), &bytes, fault), HP_OK);
    hp_status status = hp_board_json_read(&bytes, config, fault);
    hp_bytes_free(&bytes);
    return status;
}

static void refused(const char *text, const char *words) {
    hp_config config, before;
    hp_fault fault = {0};
    assert_int_equal(hp_config_preset(&config, "usb3"), HP_OK);
    before = config;
    assert_int_equal(read_text(text, &config, &fault), HP_ERROR_CONFIG);
    assert_memory_equal(fault.message, "b.json", 6);
    if (!strstr(fault.message, words)) fail_msg("'%s' is not in '%s'", words, fault.message);
    assert_memory_equal(&config, &before, sizeof config);
}

static void keys_are_nested_or_dotted(void **state) {
    (void)state;
    hp_config config;
    hp_fault fault = {0};
    hp_config_preset(&config, "usb3");
    if (read_text("{\"lanes\": 4, \"ddr\": {\"row_beats\": 77}, \"ddr.latency\": 9, \"name\": \"mine\","
                  " \"preset\": \"wscg2007\", \"loop_order\": \"secondary-outer\", \"pipes\": [\"ray-triangle\"],"
                  " \"ddr.bytes\": 1099511627776}",
                  &config, &fault) != HP_OK)
        fail_msg("%s", fault.message);
    assert_int_equal(config.lanes, 4);
    assert_int_equal(config.ddr_row_beats, 77);
    assert_int_equal(config.ddr_latency, 9);
    assert_int_equal(config.ddr_bytes, 1099511627776);
    assert_int_equal(config.loop_order, HP_SECONDARY_OUTER);
    assert_int_equal(config.link_to_board_rate, 330000000); /* the preset's, wherever "preset" stands */
    assert_int_equal(config.pipes, 1u << HP_PAIR_RAY_TRIANGLE);
    assert_string_equal(config.name, "mine");
    assert_int_equal(read_text("{\"pipes\": []}", &config, &fault), HP_OK);
    assert_int_equal(config.pipes, 0);
}

static void wrong_boards_are_refused(void **state) {
    (void)state;
    refused("", "b.json:");
    refused("{\"lanes\": }", "b.json:1:");
    refused("[]", "a board is a JSON object");
    refused("{\"lanes\": 4, \"lanes\": 5}", "duplicate");
    refused("{\"wings\": 2}", "wings");
    refused("{\"ddr\": {\"wings\": 2}}", "ddr.wings");
    refused("{\"lanes\": 65}", "lanes");
    refused("{\"lanes\": 65}", "64"); /* what is allowed */
    refused("{\"lanes\": -1}", "lanes");
    refused("{\"lanes\": 1.5}", "lanes = \"1.5\" is not allowed: 1 to 64");
    refused("{\"lanes\": null}", "lanes = \"null\" is not allowed: 1 to 64");
    refused("{\"lanes\": {}}", "lanes = \"{}\" is not allowed: 1 to 64");
    refused("{\"subnormals\": true}", "gradual or flush");
    refused("{\"wings\": {}}", "unknown key \"wings\"");
    refused("{\"name\": null}", "name takes text");
    refused("{\"ddr\": {\"latency\": 1}, \"ddr.latency\": 2}", "ddr.latency stands there twice");
    refused("{\"loop_order\": \"sideways\"}", "secondary-outer");
    refused("{\"preset\": \"wscg2008\"}", "wscg2007");
    refused("{\"preset\": 7}", "preset");
    refused("{\"pipes\": [\"ray-moon\"]}", "ray-moon");
    refused("{\"pipes\": [1]}", "pipes = \"[1]\" is not allowed: names of pairs");
    refused("{\"ddr\": {\"refresh_interval\": 10, \"refresh_clocks\": 9}}", "ddr.refresh_interval");
}

static void boards_are_named_or_files(void **state) {
    (void)state;
    hp_config config;
    hp_fault fault;
    assert_int_equal(hp_board_load("ideal", &config, &fault), HP_OK);
    assert_int_equal(config.subnormals, HP_GRADUAL);
    assert_int_equal(hp_board_load("no-such-board", &config, &fault), HP_ERROR_CONFIG);
    assert_non_null(strstr(fault.message, "usb3"));
    assert_int_equal(hp_board_load("no-such-file.json", &config, &fault), HP_ERROR_INPUT);
    char path[] = "/tmp/hitpipe-board-XXXXXX.json";
    FILE *file = fdopen(mkstemps(path, 5), "w");
    fputs("{\"preset\": \"usb3\", \"lanes\": 8}", file);
    fclose(file);
    assert_int_equal(hp_board_load(path, &config, &fault), HP_OK);
    assert_int_equal(config.lanes, 8);
    remove(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_nested_or_dotted),
        cmocka_unit_test(wrong_boards_are_refused),
        cmocka_unit_test(boards_are_named_or_files),
    };
    return cmocka_run_group_tests_name("board_json", tests, NULL, NULL);
}
