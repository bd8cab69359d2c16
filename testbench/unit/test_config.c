/* Board configurations: presets, keys, ranges, messages. */
#include <hitpipe/config.h>
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static hp_config usb3(void) {
    hp_config config;
    assert_int_equal(hp_config_preset(&config, "usb3"), HP_OK);
    return config;
}

static void refused(const char *key, const char *value, const char *expected) {
    hp_config config = usb3(), before = config;
    char message[HP_CONFIG_MESSAGE];
    assert_int_equal(hp_config_set(&config, key, value, message), HP_ERROR_CONFIG);
    assert_string_equal(message, expected);
    assert_memory_equal(&config, &before, sizeof config);
}

static void presets_are_those_of_the_table(void **state) {
    (void)state;
    hp_config config[3];
    for (unsigned i = 0; i < 3; i++) {
        char message[HP_CONFIG_MESSAGE];
        assert_int_equal(hp_config_preset(&config[i], hp_config_preset_name(i)), HP_OK);
        assert_string_equal(config[i].name, hp_config_preset_name(i));
        assert_int_equal(hp_config_check(&config[i], message), HP_OK);
    }
    assert_null(hp_config_preset_name(3));
    assert_string_equal(hp_config_preset_name(0), "usb3");
    assert_string_equal(hp_config_preset_name(1), "wscg2007");
    assert_string_equal(hp_config_preset_name(2), "ideal");
#define HP_KNOB(key, field, least, most, usb3, wscg2007, ideal, meaning)                                             \
    assert_true(config[0].field == usb3 && config[1].field == wscg2007 && config[2].field == ideal);
#define HP_CHOICE(key, field, choices, usb3, wscg2007, ideal, meaning)                                               \
    assert_true(config[0].field == usb3 && config[1].field == wscg2007 && config[2].field == ideal);
#include <hitpipe/config.def>
}

static void an_unknown_preset_changes_nothing(void **state) {
    (void)state;
    hp_config config = usb3(), before = config;
    assert_int_equal(hp_config_preset(&config, "usb4"), HP_ERROR_CONFIG);
    assert_memory_equal(&config, &before, sizeof config);
}

/* Every number takes its least and its most, and nothing beyond; and it is the field of its row that changes. */
static void every_knob_keeps_its_range(void **state) {
    (void)state;
    char text[32], message[HP_CONFIG_MESSAGE], range[HP_CONFIG_MESSAGE], expected[HP_CONFIG_MESSAGE];
    hp_config config;
#define HP_KNOB(key, field, least, most, usb3_value, wscg2007, ideal, meaning)                                       \
    for (unsigned end = 0; end < 2; end++) {                                                                         \
        uint64_t inside = end ? (uint64_t)most : (uint64_t)least, outside = end ? inside + 1 : inside - 1;           \
        hp_config only = usb3();                                                                                     \
        only.field = inside;                                                                                         \
        config = usb3();                                                                                             \
        snprintf(text, sizeof text, "%" PRIu64, inside);                                                             \
        assert_int_equal(hp_config_set(&config, key, text, message), HP_OK);                                         \
        assert_memory_equal(&config, &only, sizeof config);                                                          \
        assert_true(hp_config_get(&config, key, range, sizeof range));                                               \
        assert_string_equal(range, text);                                                                            \
        snprintf(text, sizeof text, "%" PRIu64, outside);                                                            \
        snprintf(expected, sizeof expected, "%s = \"%s\" is not allowed: %" PRIu64 " to %" PRIu64, key, text,        \
                 (uint64_t)least, (uint64_t)most);                                                                   \
        refused(key, text, expected);                                                                                \
        config.field = outside;                                                                                      \
        assert_int_equal(hp_config_check(&config, message), HP_ERROR_CONFIG);                                        \
        assert_non_null(strstr(message, key));                                                                       \
    }
#define HP_CHOICE(key, field, choices, usb3_value, wscg2007, ideal, meaning)                                         \
    config = usb3();                                                                                                 \
    config.field = 2;                                                                                                \
    assert_int_equal(hp_config_check(&config, message), HP_ERROR_CONFIG);                                            \
    assert_non_null(strstr(message, key));
#include <hitpipe/config.def>
}

static void choices_are_words(void **state) {
    (void)state;
    hp_config config = usb3();
    char message[HP_CONFIG_MESSAGE], text[40];
    assert_int_equal(hp_config_set(&config, "loop_order", "primary-outer", message), HP_OK);
    assert_int_equal(config.loop_order, HP_PRIMARY_OUTER);
    assert_true(hp_config_get(&config, "loop_order", text, sizeof text));
    assert_string_equal(text, "primary-outer");
    assert_int_equal(hp_config_set(&config, "loop_order", "secondary-outer", message), HP_OK);
    assert_int_equal(config.loop_order, HP_SECONDARY_OUTER);
    refused("loop_order", "secondary", "loop_order = \"secondary\" is not allowed: primary-outer or secondary-outer");
    refused("link.duplex", "0", "link.duplex = \"0\" is not allowed: half or full");
    refused("link.duplex", "", "link.duplex = \"\" is not allowed: half or full");
}

static void numbers_are_decimal(void **state) {
    (void)state;
    refused("lanes", "", "lanes = \"\" is not allowed: 1 to 64");
    refused("lanes", "4x", "lanes = \"4x\" is not allowed: 1 to 64");
    refused("lanes", "-1", "lanes = \"-1\" is not allowed: 1 to 64");
    refused("lanes", "0x10", "lanes = \"0x10\" is not allowed: 1 to 64");
    refused("lanes", "18446744073709551617", "lanes = \"18446744073709551617\" is not allowed: 1 to 64");
}

static void an_unknown_key_is_named_with_its_neighbour(void **state) {
    (void)state;
    refused("lane", "1", "unknown key \"lane\"; did you mean \"lanes\"?");
    refused("ddr_bytes", "1", "unknown key \"ddr_bytes\"; did you mean \"ddr.bytes\"?");
    refused("duplex", "full", "unknown key \"duplex\"; did you mean \"link.duplex\"?");
    refused("operators.subtract", "1", "unknown key \"operators.subtract\"; did you mean \"operators.sub\"?");
    refused("colour", "1", "unknown key \"colour\"");
    refused("", "1", "unknown key \"\"");
}

static void long_words_do_not_overflow(void **state) {
    (void)state;
    char word[2000], message[HP_CONFIG_MESSAGE];
    hp_config config = usb3();
    memset(word, 'a', sizeof word);
    word[sizeof word - 1] = '\0';
    assert_int_equal(hp_config_set(&config, word, "1", message), HP_ERROR_CONFIG);
    for (unsigned i = 0; hp_config_key(i); i++) {
        assert_int_equal(hp_config_set(&config, hp_config_key(i), word, message), HP_ERROR_CONFIG);
        assert_true(strlen(message) < HP_CONFIG_MESSAGE);
        assert_non_null(strstr(message, hp_config_key(i)));
    }
}

static void name_and_pipes(void **state) {
    (void)state;
    hp_config config = usb3();
    char message[HP_CONFIG_MESSAGE], text[HP_CONFIG_MESSAGE];
    assert_int_equal(hp_config_set(&config, "name", "thirty-one bytes of name.......", message), HP_OK);
    assert_int_equal(strlen(config.name), 31);
    refused("name", "thirty-two bytes of name........",
            "name = \"thirty-two bytes of name........\" is not allowed: text of less than 32 bytes");
    uint32_t all = 0;
#define HP_PAIR(lower, NAME, code, typed, PRIMARY, SECONDARY, prepared) all |= UINT32_C(1) << code;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    assert_int_equal(config.pipes, all);
    assert_int_equal(hp_config_set(&config, "pipes", "ray-triangle", message), HP_OK);
    assert_int_equal(config.pipes, 1u << HP_PAIR_RAY_TRIANGLE);
    assert_true(hp_config_get(&config, "pipes", text, sizeof text));
    assert_string_equal(text, "ray-triangle");
    refused("pipes", "ray-tringle",
            "pipes = \"ray-tringle\" is not allowed: names of pairs with commas between, or all, or none");
    refused("pipes", "ray-triangle,",
            "pipes = \"ray-triangle,\" is not allowed: names of pairs with commas between, or all, or none");
    assert_int_equal(hp_config_set(&config, "pipes", "all", message), HP_OK);
    assert_int_equal(hp_config_set(&config, "pipes", "none", message), HP_OK);
    assert_int_equal(config.pipes, 0);
    assert_true(hp_config_get(&config, "pipes", text, sizeof text));
    assert_string_equal(text, "none");
    assert_int_equal(hp_config_check(&config, message), HP_OK);
    config.pipes = UINT32_C(1) << 31;
    assert_int_equal(hp_config_check(&config, message), HP_ERROR_CONFIG);
    config = usb3();
    memset(config.name, 'x', sizeof config.name);
    assert_int_equal(hp_config_check(&config, message), HP_ERROR_CONFIG);
}

/* What is got can be set again, for every key and preset. */
static void every_key_round_trips(void **state) {
    (void)state;
    for (unsigned preset = 0; preset < 3; preset++) {
        hp_config config, copy = usb3();
        char text[HP_CONFIG_MESSAGE], message[HP_CONFIG_MESSAGE];
        hp_config_preset(&config, hp_config_preset_name(preset));
        for (unsigned i = 0; hp_config_key(i); i++) {
            assert_true(hp_config_get(&config, hp_config_key(i), text, sizeof text));
            assert_int_equal(hp_config_set(&copy, hp_config_key(i), text, message), HP_OK);
            assert_true(strlen(hp_config_meaning(i)) > 3);
        }
        assert_memory_equal(&copy, &config, sizeof config);
    }
    hp_config config = usb3();
    char text[4];
    assert_false(hp_config_get(&config, "colour", text, sizeof text));
    assert_true(hp_config_get(&config, "clock_hz", text, sizeof text));
    assert_string_equal(text, "100"); /* cut, and terminated */
}

static void ranges_in_words(void **state) {
    (void)state;
    char text[HP_CONFIG_MESSAGE];
    assert_string_equal(hp_config_key(0), "name");
    assert_string_equal(hp_config_key(1), "pipes");
    for (unsigned i = 0; hp_config_key(i); i++) {
        hp_config_range(i, text, sizeof text);
        if (strcmp(hp_config_key(i), "lanes") == 0) assert_string_equal(text, "1 to 64");
        if (strcmp(hp_config_key(i), "subnormals") == 0) assert_string_equal(text, "gradual or flush");
        assert_true(strlen(text) > 3);
    }
}

/* At refresh + row = interval - 1 a beat moves in each interval; at interval none ever would. */
static void a_refresh_leaves_time_for_a_beat(void **state) {
    (void)state;
    hp_config config = usb3();
    char message[HP_CONFIG_MESSAGE];
    config.ddr_refresh_interval = 20;
    config.ddr_refresh_clocks = 13;
    config.ddr_row_clocks = 6;
    assert_int_equal(hp_config_check(&config, message), HP_OK);
    config.ddr_row_clocks = 7;
    assert_int_equal(hp_config_check(&config, message), HP_ERROR_CONFIG);
    assert_string_equal(message, "ddr.refresh_clocks + ddr.row_clocks must be less than ddr.refresh_interval");
    config.ddr_refresh_clocks = 0;
    assert_int_equal(hp_config_check(&config, message), HP_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(presets_are_those_of_the_table),
        cmocka_unit_test(an_unknown_preset_changes_nothing),
        cmocka_unit_test(every_knob_keeps_its_range),
        cmocka_unit_test(choices_are_words),
        cmocka_unit_test(numbers_are_decimal),
        cmocka_unit_test(an_unknown_key_is_named_with_its_neighbour),
        cmocka_unit_test(long_words_do_not_overflow),
        cmocka_unit_test(name_and_pipes),
        cmocka_unit_test(every_key_round_trips),
        cmocka_unit_test(ranges_in_words),
        cmocka_unit_test(a_refresh_leaves_time_for_a_beat),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
