/* The public interface as a program uses it: defs, checks at the edge, order of calls, progress, threads. */
#include <hitpipe/hitpipe.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const float triangle[9] = {-1, -1, 2, 1, -1, 2, 0, 1, 2};
static const float ray[6] = {0, 0, 0, 0, 0, 1};

static hp_device_def small_def(void) {
    hp_device_def def = hp_default_device_def();
    def.isa = "plain";
    def.threads = 1;
    hp_config_preset(&def.board, "ideal");
    return def;
}

static int open_device(void **state) {
    hp_device_def def = small_def();
    hp_device *device;
    if (hp_open(&def, &device)) return -1;
    *state = device;
    return hp_upload(device, HP_TRIANGLE, triangle, 1);
}

static int close_device(void **state) {
    hp_close(*state);
    return 0;
}

static void says(const hp_device *device, const char *words) {
    if (!strstr(hp_error_message(device), words))
        fail_msg("\"%s\" is not in \"%s\"", words, hp_error_message(device));
}

/* ---- opening ---- */

static void refuses_to_open(const hp_device_def *def, hp_status expected, const char *words) {
    hp_device *device = (hp_device *)&device;
    assert_int_equal(hp_open(def, &device), expected);
    assert_null(device);
    says(NULL, words);
}

static void opening_names_what_is_wrong(void **state) {
    (void)state;
    hp_device_def def;
    memset(&def, 0, sizeof def);
    refuses_to_open(&def, HP_ERROR_USAGE, "hp_default_device_def");
    refuses_to_open(NULL, HP_ERROR_USAGE, "no device def");
    def = small_def();
    assert_int_equal(hp_open(&def, NULL), HP_ERROR_USAGE);
    def.timeout_ms = 0;
    refuses_to_open(&def, HP_ERROR_USAGE, "timeout_ms");
    def = small_def();
    def.target = "moon";
    refuses_to_open(&def, HP_ERROR_NO_DEVICE, "no target \"moon\": there are model, usb, usb:SERIAL and null");
    def.target = "usb";
    def.usb_product = 0xFFFF; /* nobody's */
    refuses_to_open(&def, HP_ERROR_NO_DEVICE, "no board on USB with the identifiers 1209:ffff");
    def.target = "usb:HP1";
    refuses_to_open(&def, HP_ERROR_NO_DEVICE, "1209:ffff and the serial number HP1");
    def.usb_depth = 0;
    refuses_to_open(&def, HP_ERROR_USAGE, "usb_depth is 0");
    def.usb_depth = HP_USB_DEPTH_MAX + 1;
    refuses_to_open(&def, HP_ERROR_USAGE, "usb_depth is 33");
    def.usb_depth = 1;
    def.usb_transfer = 1000;
    refuses_to_open(&def, HP_ERROR_USAGE, "usb_transfer is 1000");
    def.usb_transfer = HP_USB_TRANSFER_MAX + 1024;
    refuses_to_open(&def, HP_ERROR_USAGE, "usb_transfer is 16778240");
    def.usb_transfer = 0;
    def.usb_vendor = 0x10000;
    refuses_to_open(&def, HP_ERROR_USAGE, "16 bits");
    def = small_def();
    def = small_def();
    def.board.lanes = 65;
    refuses_to_open(&def, HP_ERROR_CONFIG, "lanes = 65 is not allowed: 1 to 64");
    def = small_def();
    def.isa = "mmx";
    refuses_to_open(&def, HP_ERROR_USAGE, "mmx");
    def = small_def();
    def.target = "null";
    refuses_to_open(&def, HP_ERROR_TIMEOUT, "HELLO: board did not answer in time (retries: 3)");
    def.retries = 0;
    refuses_to_open(&def, HP_ERROR_TIMEOUT, "(retries: 0)");
}

static void drop_text(void *context, const char *text, size_t n) {
    (void)context, (void)text, (void)n;
}

static void waveforms_need_the_clocked_engine(void **state) {
    (void)state;
    hp_device_def def = small_def();
    def.vcd = drop_text;
    refuses_to_open(&def, HP_ERROR_USAGE, "clocked");
}

static void a_success_clears_the_message(void **state) {
    (void)state;
    hp_device_def def = {0};
    hp_device *device;
    assert_int_equal(hp_open(&def, &device), HP_ERROR_USAGE);
    def = small_def();
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_string_equal(hp_error_message(NULL), "");
    assert_string_equal(hp_error_message(device), "");
    hp_close(device);
    hp_close(NULL);
}

static void identity(void **state) {
    const hp_identity *said = hp_identify(*state);
    assert_string_equal(said->name, "ideal");
    assert_string_equal(said->target, "model");
    assert_string_equal(said->engine, "quick");
    assert_string_equal(said->isa, "plain");
    assert_int_equal(said->version, 1);
    assert_int_equal(said->packet_primaries, 256);
    uint32_t all = 0;
#define HP_PAIR(name, NAME, code, typed, PRIMARY, SECONDARY, prepared) all |= 1u << HP_PAIR_##NAME;
#include <hitpipe/pairs.def>
#undef HP_PAIR
    assert_int_equal(said->pairs, all);
    assert_int_equal(said->loop_order, HP_SECONDARY_OUTER);
    assert_int_equal(said->subnormals, HP_GRADUAL);
}

static void both_engines_answer_the_same(void **state) {
    (void)state;
    hp_result results[2];
    for (unsigned clocked = 0; clocked < 2; clocked++) {
        hp_device_def def = small_def();
        hp_query_def query = hp_default_query_def();
        hp_device *device;
        def.clocked = clocked;
        assert_int_equal(hp_open(&def, &device), HP_OK);
        assert_string_equal(hp_identify(device)->engine, clocked ? "clocked" : "quick");
        assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_OK);
        assert_int_equal(hp_query(device, &query, ray, 1, &results[clocked]), HP_OK);
        hp_close(device);
    }
    assert_memory_equal(&results[0], &results[1], sizeof results[0]);
    assert_true(results[0].F == 1 && results[0].T == 2);
}

/* ---- scenes ---- */

static void an_upload_is_checked(void **state) {
    hp_device *device = *state;
    float words[18];
    memcpy(words, triangle, sizeof triangle);
    memcpy(words + 9, triangle, sizeof triangle);
    words[13] = NAN;
    assert_int_equal(hp_upload(device, HP_TRIANGLE, words, 2), HP_ERROR_INPUT);
    says(device, "triangle 1 holds a NaN");
    assert_int_equal(hp_upload(device, (hp_object)77, words, 1), HP_ERROR_USAGE);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, NULL, 1), HP_ERROR_USAGE);
    assert_int_equal(hp_upload(NULL, HP_TRIANGLE, words, 1), HP_ERROR_USAGE);
    hp_query_def query = hp_default_query_def(); /* the old scene stays */
    hp_result result;
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_int_equal(result.F, 1);
}

static void a_scene_too_large_is_refused(void **state) {
    (void)state;
    hp_device_def def = small_def();
    hp_query_def query = hp_default_query_def();
    hp_device *device;
    hp_result result;
    float words[27] = {0};
    def.board.ddr_bytes = 2 * 36;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_OK);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, words, 3), HP_ERROR_CAPACITY);
    says(device, "3 objects of type triangle: the board holds 2");
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_int_equal(result.F, 1);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, words, 2), HP_OK);
    hp_close(device);
}

static void an_empty_scene_has_only_misses(void **state) {
    hp_device *device = *state;
    hp_query_def query = hp_default_query_def();
    hp_result result;
    assert_int_equal(hp_upload(device, HP_TRIANGLE, NULL, 0), HP_OK);
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_true(result.F == 0 && result.index == HP_NO_INDEX && isinf(result.T) && result.stencil == 1);
}

/* Larger than one packet, so that it goes up in several, and each object is where it belongs. */
static void a_scene_of_many_packets(void **state) {
    hp_device *device = *state;
    enum { COUNT = 40000 };
    float(*many)[9] = malloc(COUNT * sizeof *many);
    assert_non_null(many);
    for (unsigned i = 0; i < COUNT; i++) {
        memcpy(many[i], triangle, sizeof triangle);
        for (unsigned k = 0; k < 9; k += 3) many[i][k] += 4 * (float)i;
    }
    assert_int_equal(hp_upload(device, HP_TRIANGLE, many[0], COUNT), HP_OK);
    for (unsigned i = 0; i < COUNT; i += 5000) {
        const float above[6] = {4 * (float)(i + 4999), 0, 0, 0, 0, 1};
        hp_query_def query = hp_default_query_def();
        hp_result result;
        assert_int_equal(hp_query(device, &query, above, 1, &result), HP_OK);
        assert_int_equal(result.index, i + 4999);
    }
    free(many);
}

static void the_matrix_moves_the_scene(void **state) {
    hp_device *device = *state;
    float matrix[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5};
    hp_query_def query = hp_default_query_def();
    hp_result result;
    assert_int_equal(hp_transform(device, matrix), HP_OK);
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_true(result.T == 7);
    matrix[6] = INFINITY;
    assert_int_equal(hp_transform(device, matrix), HP_ERROR_INPUT);
    says(device, "row 1, column 2 is an infinity");
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_true(result.T == 7);
    assert_int_equal(hp_transform(device, NULL), HP_OK);
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_true(result.T == 2);
}

/* ---- queries ---- */

static bool never(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                  size_t count) {
    (void)context, (void)primary, (void)secondary, (void)records, (void)count;
    return false;
}

static void a_query_is_checked(void **state) {
    hp_device *device = *state;
    hp_result result;
    hp_query_def good = hp_default_query_def(), def = good;
    float bad[12] = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0};
    assert_int_equal(hp_query(device, &def, bad, 2, &result), HP_ERROR_INPUT);
    says(device, "primary 1: direction is zero");
    def.cookie = 0;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_USAGE);
    says(device, "hp_default_query_def");
    def = good;
    def.mode = HP_MODE_ALL;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_USAGE);
    assert_int_equal(hp_query_all(device, &def, ray, 1, NULL, NULL), HP_ERROR_USAGE);
    assert_int_equal(hp_query_all(device, &good, ray, 1, never, NULL), HP_ERROR_USAGE);
    assert_int_equal(hp_query_all(device, &def, ray, 1, never, NULL), HP_ERROR_CANCELLED);
    def = good;
    def.first = 2;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_CAPACITY);
    def.first = 0;
    def.count = 2;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_CAPACITY);
    def = good;
    def.packet = 257;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_USAGE);
    def = good;
    def.pair = (hp_pair)31;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_USAGE);
    def = good;
    def.mode = (hp_mode)9;
    assert_int_equal(hp_query(device, &def, ray, 1, &result), HP_ERROR_USAGE);
    assert_int_equal(hp_query(device, NULL, ray, 1, &result), HP_ERROR_USAGE);
    assert_int_equal(hp_query(device, &good, NULL, 1, &result), HP_ERROR_USAGE);
    assert_int_equal(hp_query(device, &good, ray, 1, NULL), HP_ERROR_USAGE);
    assert_int_equal(hp_query(NULL, &good, ray, 1, &result), HP_ERROR_USAGE);
    assert_int_equal(hp_query(device, &good, NULL, 0, NULL), HP_OK);
    assert_int_equal(hp_query(device, &good, ray, 1, &result), HP_OK);
    assert_string_equal(hp_error_message(device), "");
}

static void nothing_uploaded_is_an_error(void **state) {
    (void)state;
    hp_device_def def = small_def();
    hp_query_def query = hp_default_query_def();
    hp_device *device;
    hp_result result;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_ERROR_CAPACITY);
    says(device, "no secondaries were uploaded");
    assert_int_equal(hp_upload(device, HP_SPHERE, triangle, 1), HP_OK);
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_ERROR_USAGE);
    says(device, "needs objects of type triangle");
    hp_close(device);
}

/* Unchecked, for golden vectors: the board meets a NaN and answers F 0. */
static void unchecked_objects_reach_the_board(void **state) {
    (void)state;
    hp_device_def def = small_def();
    hp_query_def query = hp_default_query_def();
    hp_device *device;
    hp_result result;
    float bad[6] = {0, NAN, 0, 0, 0, 1};
    def.unchecked = true;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_OK);
    assert_int_equal(hp_query(device, &query, bad, 1, &result), HP_OK);
    assert_int_equal(result.F, 0);
    hp_close(device);
}

static void counters_count_and_clear(void **state) {
    hp_device *device = *state;
    hp_query_def query = hp_default_query_def();
    hp_result result;
    hp_counters counters;
    assert_int_equal(hp_query(device, &query, ray, 1, &result), HP_OK);
    assert_int_equal(hp_read_counters(device, true, &counters), HP_OK);
    assert_int_equal(counters.tests_run, 1);
    assert_int_equal(hp_read_counters(device, false, &counters), HP_OK);
    assert_int_equal(counters.tests_run, 0);
    assert_int_equal(hp_read_counters(device, false, NULL), HP_ERROR_USAGE);
    assert_int_equal(hp_read_counters(NULL, false, &counters), HP_ERROR_USAGE);
}

/* ---- progress ---- */

typedef struct told {
    unsigned times;
    uint64_t done, total;
    bool go_on;
} told;

static bool note_progress(void *context, uint64_t done, uint64_t total) {
    told *heard = context;
    heard->times++;
    heard->done = done;
    heard->total = total;
    return heard->go_on;
}

static void progress_can_cancel_and_the_device_goes_on(void **state) {
    (void)state;
    enum { RAYS = 3000 };
    hp_device_def def = small_def();
    hp_query_def query = hp_default_query_def();
    told heard = {.go_on = true};
    hp_device *device;
    float(*rays)[6] = malloc(RAYS * sizeof *rays);
    hp_result *results = malloc(RAYS * sizeof *results);
    assert_true(rays && results);
    for (unsigned i = 0; i < RAYS; i++) memcpy(rays[i], ray, sizeof ray);
    def.progress = note_progress;
    def.progress_context = &heard;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_OK); /* the first call is always told */
    assert_true(heard.times == 1 && heard.done == 36 && heard.total == 36);
    hp_close(device);
    assert_int_equal(hp_open(&def, &device), HP_OK);
    heard.go_on = false;
    assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_ERROR_CANCELLED);
    says(device, "cancelled");
    assert_int_equal(hp_query(device, &query, rays[0], RAYS, results), HP_ERROR_CAPACITY);
    heard.go_on = true;
    assert_int_equal(hp_upload(device, HP_TRIANGLE, triangle, 1), HP_OK);
    assert_int_equal(hp_query(device, &query, rays[0], RAYS, results), HP_OK);
    for (unsigned i = 0; i < RAYS; i++) assert_true(results[i].F == 1 && results[i].T == 2);
    hp_close(device);
    free(rays);
    free(results);
}

/* Cancelled in the midst of records: what was abandoned does not show up in the next call. */
static bool stop_after_one(void *context, const uint32_t *primary, const uint32_t *secondary,
                           const hp_result *records, size_t count) {
    (void)primary, (void)secondary, (void)records, (void)count;
    ++*(unsigned *)context;
    return false;
}

static void an_abandoned_query_leaves_nothing_behind(void **state) {
    (void)state;
    hp_device_def def = small_def();
    hp_query_def query = hp_default_query_def(), closest = query;
    hp_device *device;
    float scene[40][9], rays[20][6];
    hp_result results[20];
    unsigned calls = 0;
    for (unsigned i = 0; i < 40; i++) memcpy(scene[i], triangle, sizeof triangle);
    for (unsigned i = 0; i < 20; i++) memcpy(rays[i], ray, sizeof ray);
    def.board.packet_results = 16;
    def.board.packet_primaries = 4;
    query.mode = HP_MODE_ALL;
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_upload(device, HP_TRIANGLE, scene[0], 40), HP_OK);
    assert_int_equal(hp_query_all(device, &query, rays[0], 20, stop_after_one, &calls), HP_ERROR_CANCELLED);
    assert_int_equal(calls, 1);
    assert_int_equal(hp_query(device, &closest, rays[0], 20, results), HP_OK);
    for (unsigned i = 0; i < 20; i++) assert_true(results[i].F == 1 && results[i].index == 0);
    hp_close(device);
}

/* ---- threads ---- */

static void *work(void *context) {
    (void)context;
    for (unsigned round = 0; round < 5; round++) {
        void *state;
        hp_query_def query = hp_default_query_def();
        hp_result result;
        hp_device_def broken = {0};
        if (open_device(&state)) return NULL;
        for (unsigned i = 0; i < 20; i++) {
            if (hp_query(state, &query, ray, 1, &result) || result.T != 2) return NULL;
            if (hp_open(&broken, &(hp_device *){NULL}) != HP_ERROR_USAGE || !*hp_error_message(NULL)) return NULL;
        }
        close_device(&state);
    }
    return (void *)triangle;
}

static void devices_in_two_threads(void **state) {
    (void)state;
    pthread_t threads[2];
    for (unsigned i = 0; i < 2; i++) assert_int_equal(pthread_create(&threads[i], NULL, work, NULL), 0);
    for (unsigned i = 0; i < 2; i++) {
        void *done;
        pthread_join(threads[i], &done);
        assert_non_null(done);
    }
}

#define WITH_DEVICE(name) cmocka_unit_test_setup_teardown(name, open_device, close_device)

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_names_what_is_wrong),
        cmocka_unit_test(waveforms_need_the_clocked_engine),
        cmocka_unit_test(a_success_clears_the_message),
        WITH_DEVICE(identity),
        cmocka_unit_test(both_engines_answer_the_same),
        WITH_DEVICE(an_upload_is_checked),
        cmocka_unit_test(a_scene_too_large_is_refused),
        WITH_DEVICE(an_empty_scene_has_only_misses),
        WITH_DEVICE(a_scene_of_many_packets),
        WITH_DEVICE(the_matrix_moves_the_scene),
        WITH_DEVICE(a_query_is_checked),
        cmocka_unit_test(nothing_uploaded_is_an_error),
        cmocka_unit_test(unchecked_objects_reach_the_board),
        WITH_DEVICE(counters_count_and_clear),
        cmocka_unit_test(progress_can_cancel_and_the_device_goes_on),
        cmocka_unit_test(an_abandoned_query_leaves_nothing_behind),
        cmocka_unit_test(devices_in_two_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
