/* The program's own verbs, in this process, with boards on the bus: golden vectors bit for bit, pictures byte for
 * byte the same as the model's, over sound cables and bad ones; and Ctrl-C. */
#include "host/cli/cli.h"
#include "rig.h"
#include <fcntl.h>
#include <glob.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { ARGUMENTS_MOST = 256, TEXT = 1 << 16 };

typedef int verb(int argc, char **argv);

static char work[64], said[TEXT]; /* a directory; what the last verb printed, errors too */

/* ---- running verbs ---- */

static int redirected(int to, int fd) {
    int old = dup(fd);
    assert_true(old >= 0 && dup2(to, fd) >= 0);
    return old;
}

static void restore(int old, int fd) {
    dup2(old, fd);
    close(old);
}

static int run(verb *v, const char *const *arguments, size_t count) {
    char *argv[ARGUMENTS_MOST + 1] = {NULL};
    assert_true(count <= ARGUMENTS_MOST);
    for (size_t i = 0; i < count; i++) assert_non_null(argv[i] = strdup(arguments[i]));
    FILE *out = tmpfile();
    assert_non_null(out);
    fflush(stdout);
    int old_out = redirected(fileno(out), STDOUT_FILENO), old_err = redirected(fileno(out), STDERR_FILENO);
    int status = v((int)count, argv);
    fflush(stdout);
    restore(old_out, STDOUT_FILENO);
    restore(old_err, STDERR_FILENO);
    rewind(out);
    said[fread(said, 1, sizeof said - 1, out)] = '\0';
    fclose(out);
    for (size_t i = 0; i < count; i++) free(argv[i]);
    return status;
}

static void says(const char *words) {
    if (!strstr(said, words)) fail_msg("no \"%s\" in: %s", words, said);
}

static char *path_of(const char *name, char path[128]) {
    snprintf(path, 128, "%s/%s", work, name);
    return path;
}

static char *bytes_of(const char *path, size_t *n) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    struct stat about;
    assert_int_equal(fstat(fileno(file), &about), 0);
    char *bytes = malloc((size_t)about.st_size + 1);
    assert_non_null(bytes);
    *n = fread(bytes, 1, (size_t)about.st_size, file);
    bytes[*n] = '\0';
    fclose(file);
    return bytes;
}

static void same_files(const char *one, const char *other) {
    size_t n, m;
    char *a = bytes_of(one, &n), *b = bytes_of(other, &m);
    assert_true(n > 0 && n == m);
    assert_memory_equal(a, b, n);
    free(a);
    free(b);
}

/* ---- boards ---- */

static hpt_device *board;

static void plug(const char *preset, hp_usb_speed speed, hp_subnormals subnormals, hpt_choose *choose,
                 void *context) {
    hpt_device_def def = {.gadget = {.board = {.isa = "plain", .threads = 1}, .serial = "HP1", .speed = speed}};
    hp_config_preset(&def.gadget.board.config, preset);
    def.gadget.board.config.subnormals = subnormals;
    def.maps = true;
    def.choose = choose;
    def.context = context;
    board = hpt_plug(&def);
}

static int tear_down(void **state) {
    (void)state;
    hpt_discard(board);
    board = NULL;
    return 0;
}

/* ---- golden vectors ---- */

/* The vector files that a board of this kind can answer. */
static size_t vector_files(bool flush, const char **files, size_t most, glob_t *found) {
    size_t count = 0;
    assert_int_equal(glob("vectors/*/*.hex", 0, NULL, found), 0);
    for (size_t i = 0; i < found->gl_pathc; i++) {
        size_t n;
        char *text = bytes_of(found->gl_pathv[i], &n);
        bool other = strstr(text, flush ? "// numerics: gradual" : "// numerics: flush") != NULL;
        free(text);
        if (other) continue;
        assert_true(count < most);
        files[count++] = found->gl_pathv[i];
    }
    return count;
}

static void replay_all(hp_usb_speed speed, bool flush) {
    const char *arguments[ARGUMENTS_MOST] = {"hitpipe replay", "--target", "usb:HP1"};
    glob_t found;
    char words[64];
    size_t files = vector_files(flush, arguments + 3, ARGUMENTS_MOST - 3, &found);
    assert_true(files > 90);
    plug("usb3", speed, flush ? HP_FLUSH : HP_GRADUAL, NULL, NULL);
    int status = run(hp_verb_replay, arguments, 3 + files);
    if (status) fail_msg("exit %d: %s", status, said);
    snprintf(words, sizeof words, "%zu files, ", files);
    says(words);
    says(" records, 0 differ");
    printf("%s", strstr(said, words));
    globfree(&found);
    tear_down(NULL);
}

static void golden_vectors(void **state) {
    (void)state;
    replay_all(HP_USB_SUPER, false);
    replay_all(HP_USB_HIGH, true);
}

static void a_changed_bit_is_seen(void **state) {
    (void)state;
    char path[128];
    size_t n;
    char *text = bytes_of("vectors/sphere-sphere/random.hex", &n);
    char *record = strstr(text, "\n");
    while (record && strncmp(record, "\n//", 3) == 0) record = strstr(record + 1, "\n");
    char *end = record ? strstr(record + 1, "\n") : NULL;
    assert_non_null(end);
    end[-1] = end[-1] == '0' ? '1' : '0'; /* of CP.z */
    FILE *changed = fopen(path_of("changed.hex", path), "w");
    assert_non_null(changed);
    fwrite(text, 1, n, changed);
    fclose(changed);
    free(text);
    plug("usb3", HP_USB_SUPER, HP_GRADUAL, NULL, NULL);
    const char *arguments[] = {"hitpipe replay", "--target", "usb", path};
    assert_int_equal(run(hp_verb_replay, arguments, 4), 1);
    says(" 1 differ");
}

/* ---- pictures and tables ---- */

#define SCENE "vectors/terrain/jacksboro.exr", "--resample", "20x30", "--size", "40x24"

static void trace(const char *target, const char *depth, const char *transfer, const char *exr) {
    char path[128];
    const char *arguments[] = {
        "hitpipe trace", SCENE,   "--target",        target, "--usb-depth", depth, "--usb-transfer",
        transfer,        "--out", path_of(exr, path)};
    int status = run(hp_verb_trace, arguments, sizeof arguments / sizeof *arguments);
    if (status) fail_msg("exit %d: %s", status, said);
    says("board    usb3");
}

static void a_picture(void **state) {
    (void)state;
    char model[128], usb[128];
    trace("model", "4", "0", "model.exr");
    path_of("model.exr", model);
    plug("usb3", HP_USB_SUPER, HP_GRADUAL, NULL, NULL);
    trace("usb:HP1", "4", "0", "usb.exr");
    same_files(model, path_of("usb.exr", usb));
    tear_down(NULL);
    plug("usb3", HP_USB_HIGH, HP_GRADUAL, NULL, NULL);
    trace("usb", "2", "16384", "high.exr");
    same_files(model, path_of("high.exr", usb));
}

/* Faults after which nothing has to wait for ten seconds of silence. */
static hpt_fault now_and_then(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    static const hpt_fault faults[2][4] = {
        {{HPT_FAULT_FLIP, 1}, {HPT_FAULT_STALL, 0}, {HPT_FAULT_UNPLUG, 1}, {HPT_FAULT_PROTO, 0}},
        {{HPT_FAULT_STALL, 0}, {HPT_FAULT_DUPLICATE, 0}, {HPT_FAULT_UNPLUG, 1}, {HPT_FAULT_PROTO, 1}},
    };
    unsigned *count = context;
    (void)bytes, (void)n;
    if (number % 3 != 2) return (hpt_fault){0};
    return faults[in][(*count)++ % 4];
}

static void a_picture_over_a_bad_cable(void **state) {
    (void)state;
    unsigned faults = 0;
    char model[128], usb[128];
    trace("model", "4", "0", "model.exr");
    path_of("model.exr", model);
    plug("usb3", HP_USB_SUPER, HP_GRADUAL, now_and_then, &faults);
    path_of("bad.exr", usb);
    const char *arguments[] = {"hitpipe trace", SCENE, "--target", "usb:HP1", "--reconnect", "10", "--out", usb};
    int status = run(hp_verb_trace, arguments, sizeof arguments / sizeof *arguments);
    if (status) fail_msg("exit %d: %s", status, said);
    printf("a picture with %u faults of the cable\n", faults);
    assert_true(faults > 3);
    same_files(model, usb);
}

static void query(const char *target, const char *mode, const char *csv) {
    char path[128];
    const char *arguments[] = {
        "hitpipe query", "ray-triangle", "-p",    "examples/rays.csv", "-s", "examples/triangles.csv", "--mode", mode,
        "--target",      target,         "--out", path_of(csv, path)};
    int status = run(hp_verb_query, arguments, sizeof arguments / sizeof *arguments);
    if (status) fail_msg("exit %d: %s", status, said);
}

static void a_table(void **state) {
    (void)state;
    char model[128], usb[128];
    static const char *const modes[] = {"closest", "any", "all"};
    plug("usb3", HP_USB_SUPER, HP_GRADUAL, NULL, NULL);
    for (unsigned i = 0; i < 3; i++) {
        query("model", modes[i], "model.csv");
        query("usb", modes[i], "usb.csv");
        same_files(path_of("model.csv", model), path_of("usb.csv", usb));
    }
}

/* ---- Ctrl-C ---- */

static void *press(void *nothing) {
    const struct timespec moment = {.tv_nsec = 200000000};
    (void)nothing;
    nanosleep(&moment, NULL);
    kill(getpid(), SIGINT);
    return NULL;
}

/* The last test: a program that was interrupted ends. */
static void interrupted(void **state) {
    (void)state;
    pthread_t finger;
    const char *arguments[] = {"hitpipe query",          "ray-triangle", "-p", "examples/rays.csv", "-s",
                               "examples/triangles.csv", "--target",     "usb"};
    plug("usb3", HP_USB_SUPER, HP_GRADUAL, NULL, NULL);
    hpt_delay(board, 3000000);
    assert_int_equal(pthread_create(&finger, NULL, press, NULL), 0);
    double start = hpt_now_ms();
    int status = run(hp_verb_query, arguments, sizeof arguments / sizeof *arguments);
    double took = hpt_now_ms() - start;
    pthread_join(finger, NULL);
    assert_int_equal(status, 4);
    says("hitpipe query: cancelled");
    assert_true(took >= 190 && took < 2000);
    hpt_delay(board, 0);
    hp_device_def def = hp_default_device_def(); /* the board is as good as before */
    hp_device *device;
    hp_counters counters;
    def.target = "usb";
    assert_int_equal(hp_open(&def, &device), HP_OK);
    assert_int_equal(hp_read_counters(device, false, &counters), HP_OK);
    hp_close(device);
}

static int begin(void **state) {
    (void)state;
    snprintf(work, sizeof work, "/tmp/test_usb_verbs.XXXXXX");
    return mkdtemp(work) ? 0 : -1;
}

static int finish(void **state) {
    static const char *const names[] = {"changed.hex", "model.exr", "usb.exr", "high.exr",
                                        "bad.exr",     "model.csv", "usb.csv"};
    char path[128];
    (void)state;
    for (unsigned i = 0; i < sizeof names / sizeof *names; i++) unlink(path_of(names[i], path));
    return rmdir(work);
}

#define EACH_TEST(name) cmocka_unit_test_teardown(name, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        EACH_TEST(golden_vectors), EACH_TEST(a_changed_bit_is_seen),      EACH_TEST(a_picture),
        EACH_TEST(a_table),        EACH_TEST(a_picture_over_a_bad_cable), EACH_TEST(interrupted),
    };
    return cmocka_run_group_tests(tests, begin, finish);
}
