/* The unmodified program, with the real libusb and hidapi, on a machine of umockdev's: what a person sees with boards
 * plugged in, with none, with several, with one that misbehaves, and when the cable comes out. */
#include "child.h"
#include "mockusb.h"
#include "testbench/support/board_host.h"
#include "testbench/support/page.h"
#include <glob.h>
#include <hidapi.h>
#include <hitpipe/control.h>
#include <hitpipe/hitpipe.h>
#include <libusb.h>
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
/* cmocka wants its headers first */
#include <cmocka.h>

enum { BOARDS = 10, CHILDREN = 1 + BOARDS, SECONDS = 60, HIDRAW = 0, LIBUSB = 1, BACK_ENDS = 2 };

static const char scene[] = "vectors/terrain/jacksboro.exr --resample 30x40 --size 64x36";

/* The program with each back end of hidapi, and which this process has. */
static char programs[BACK_ENDS][256];
static unsigned here;

static bool hidraw_here(void) {
    return here == HIDRAW;
}

/* hitpipe has the back end that it was built for, hitpipe-NAME the other. */
static void find_programs(void) {
    const char *build = getenv("BUILD");
    char path[256], name[16] = "";
    if (!build) build = "build";
    snprintf(path, sizeof path, "%s/hidapi", build);
    FILE *file = fopen(path, "r");
    if (!file || fscanf(file, "%15s", name) != 1) abort();
    fclose(file);
    here = strcmp(name, "libusb") == 0 ? LIBUSB : HIDRAW;
    snprintf(programs[here], sizeof programs[here], "%s/hitpipe", build);
    snprintf(programs[!here], sizeof programs[!here], "%s/hitpipe-%s", build, here == LIBUSB ? "hidraw" : "libusb");
}

/* What happens to the packets of a direction from number `from` on, `count` of them. */
typedef struct plan {
    hpt_fault fault;
    bool in;
    unsigned from, count;
    unsigned struck; /* so many by now */
} plan;

/* One at a time: put up and taken down by each test. */
static struct machine {
    hpt_device *boards[BOARDS];
    unsigned board_count;
    hpt_child children[CHILDREN];
    hpt_claim *claim; /* of another program */
    plan plans[BOARDS];
    char work[64]; /* a directory */
} m;

/* ---- the machine ---- */

static hpt_fault choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    plan *p = context;
    (void)bytes;
    bool now = in == p->in && number >= p->from && number - p->from < p->count;
    if (now && p->fault.kind == HPT_FAULT_NO_ZERO && n % HP_USB_HIGH_PACKET) now = false; /* there is none */
    p->struck += now;
    return now ? p->fault : (hpt_fault){HPT_FAULT_NONE, 0};
}

static hpt_device_def board_def(const char *serial, hp_usb_speed speed) {
    return (hpt_device_def){
        .gadget = {.board = hpt_board("usb3", HP_ENGINE_QUICK), .serial = serial, .speed = speed}};
}

static hpt_device *plug_def(const hpt_device_def *def) {
    assert_true(m.board_count < BOARDS);
    return m.boards[m.board_count++] = hpt_plug(def);
}

static hpt_device *plug_board(const char *serial, hp_usb_speed speed, hp_subnormals subnormals) {
    hpt_device_def def = board_def(serial, speed);
    def.gadget.board.config.subnormals = subnormals;
    return plug_def(&def);
}

static hpt_device *plug(const char *serial) {
    return plug_board(serial, HP_USB_SUPER, HP_FLUSH);
}

/* A board at whose cable something happens. */
static hpt_device *plug_faulty(hpt_fault_kind kind, unsigned argument, bool in, unsigned from, unsigned count) {
    hpt_device_def def = board_def("HP-000001", HP_USB_SUPER);
    def.choose = choose;
    def.context = &m.plans[0];
    m.plans[0] = (plan){.fault = {kind, argument}, .in = in, .from = from, .count = count};
    return plug_def(&def);
}

static void release_claim(void) {
    if (m.claim) hpt_mock_release(m.claim);
    m.claim = NULL;
}

static int put_up(void **state) {
    (void)state;
    memset(&m, 0, sizeof m);
    strcpy(m.work, "/tmp/hitpipe-umockdev-XXXXXX");
    if (!mkdtemp(m.work)) return -1;
    hpt_mock_begin();
    return 0;
}

static int take_down(void **state) {
    char command[128];
    (void)state;
    for (unsigned i = 0; i < CHILDREN; i++) hpt_child_free(&m.children[i]);
    release_claim();
    if (!hpt_mock_quiet()) return -1;
    for (unsigned i = 0; i < m.board_count; i++) hpt_discard(m.boards[i]);
    hid_exit(); /* its libusb back end has a context, which is of this machine */
    hpt_mock_end();
    snprintf(command, sizeof command, "rm -rf '%s'", m.work);
    return system(command);
}

/* ---- running programs ---- */

/* Runs a command line to its end. */
#define RUN(...)                                                                                                     \
    (hpt_child_free(&m.children[0]), hpt_child_start(&m.children[0], false, __VA_ARGS__),                            \
     hpt_child_end(&m.children[0], SECONDS))

#define EXPECT(wanted, ...)                                                                                          \
    do {                                                                                                             \
        int got = RUN(__VA_ARGS__);                                                                                  \
        if (got != (wanted)) fail_msg("status %d, not %d:\n%s", got, wanted, m.children[0].text);                    \
    } while (0)

/* The program beside those that EXPECT runs ends, with this status. */
static void child_ends(int wanted) {
    int got = hpt_child_end(&m.children[1], SECONDS);
    if (got != wanted) fail_msg("status %d, not %d:\n%s", got, wanted, m.children[1].text);
}

static void child_says(const hpt_child *child, const char *words) {
    if (!strstr(child->text, words)) fail_msg("no '%s' in:\n%s", words, child->text);
}

#define SAYS(words) child_says(&m.children[0], words)

static unsigned count_of(const char *text, const char *words) {
    unsigned count = 0;
    for (const char *at = text; (at = strstr(at, words)); at += strlen(words)) count++;
    return count;
}

static void await(bool (*holds)(void)) {
    for (unsigned ms = 0; ms < 10000; ms++) {
        if (holds()) return;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    fail_msg("waited in vain");
}

/* ---- the small scene, on the model and on a board ---- */

static void trace_on_model(void) {
    EXPECT(0, "%s trace %s --out %s/model.exr", programs[0], scene, m.work);
}

static void expect_same(const char *name) {
    EXPECT(0, "cmp %s/model.exr %s/%s", m.work, m.work, name);
}

static void trace_works(void) {
    trace_on_model();
    EXPECT(0, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    expect_same("usb.exr");
}

/* ---- no board ---- */

static void without_a_board_it_is_said_what_was_looked_for(void **state) {
    (void)state;
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        EXPECT(0, "%s info", programs[i]);
        SAYS("No board is plugged in: looked for 1209:0001 on USB and among HID devices");
        EXPECT(0, "%s info --json --usb-id abcd:12", programs[i]);
        assert_int_equal(count_of(m.children[0].text, "\"target\""), 1);
        for (unsigned verb = 0; verb < 2; verb++) {
            const char *name = verb ? "watch" : "reset";
            EXPECT(4, "%s %s", programs[i], name);
            SAYS("no board is plugged in: looked for a HID device 1209:0001\n");
            EXPECT(4, "%s %s --usb-id abcd:12 --target usb:HP-000001", programs[i], name);
            SAYS("looked for a HID device abcd:0012 with serial number HP-000001\n");
        }
    }
    EXPECT(4, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    SAYS("no board on USB with the identifiers 1209:0001");
}

/* ---- boards ---- */

static void info_shows_the_boards_that_are_plugged_in(void **state) {
    (void)state;
    plug("HP-000001");
    plug_board("HP-000002", HP_USB_HIGH, HP_FLUSH);
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        EXPECT(0, "%s info", programs[i]);
        SAYS("target     model\n");
        assert_int_equal(count_of(m.children[0].text, "\ntarget     usb:"), 2); /* not one more for the HID */
        SAYS("\ntarget     usb:HP-000001, collision board\n"
             "usb        1209:0001 release 1.00, bus 1, address 2, 5000 Mbit/s\n");
        SAYS("\ntarget     usb:HP-000002, collision board\n"
             "usb        1209:0001 release 1.00, bus 1, address 3, 480 Mbit/s\n");
        SAYS(i == HIDRAW ? "\nhid        /dev/hidraw1\n" : "\nhid        1-2:1.1\n");
        SAYS("\nboard      usb3, protocol 1, clock 100 MHz\n");
        SAYS("\ncontrol    reports of version 1: HEALTH, EVENTS, RESET, ABORT, CLOCK\n");
        assert_int_equal(count_of(m.children[0].text, "\nhealth     35.0 degrees Celsius, no session, packets: 0"),
                         2);
        EXPECT(0, "%s info --json", programs[i]);
        SAYS("\"target\": \"usb:HP-000002\"");
        assert_int_equal(count_of(m.children[0].text, "\"celsius\": 35.0"), 2);
        assert_int_equal(count_of(m.children[0].text, "\"fault\": null"), 4);
    }
}

/* hidapi's hidraw back end lists a HID once for each top-level usage, and tells its usage page. */
static void a_board_is_one_by_its_usage_page_and_only_once(void **state) {
    (void)state;
    static const uint8_t twice[] = {0x06, 0x48, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0xC0, 0x09, 0x02, 0xA1, 0x01, 0xC0};
    static const uint8_t another[] = {0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0xC0};
    hpt_device *board = plug("HP-000001");
    hpt_mock_describe_hid(board, twice, sizeof twice);
    EXPECT(0, "%s info", programs[HIDRAW]);
    assert_int_equal(count_of(m.children[0].text, "\ntarget     usb:"), 1);
    EXPECT(0, "%s reset", programs[HIDRAW]);
    hpt_mock_describe_hid(board, another, sizeof another);
    EXPECT(4, "%s reset", programs[HIDRAW]);
    SAYS("no board is plugged in");
}

static void of_several_boards_one_must_be_named(void **state) {
    (void)state;
    plug("HP-000001");
    plug("HP-000002");
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        EXPECT(4, "%s reset", programs[i]);
        SAYS("2 boards are plugged in, and none is named; there is HP-000001, HP-000002\n");
        EXPECT(4, "%s reset --target usb:HP-000003", programs[i]);
        SAYS(
            "no board with serial number HP-000003 among the HID devices 1209:0001; there is HP-000001, HP-000002\n");
        EXPECT(0, "%s reset --target usb:HP-000002", programs[i]);
        SAYS("board HP-000002 (usb3): reset done\n");
    }
    EXPECT(0, "%s info --json", programs[0]);
    assert_int_equal(count_of(m.children[0].text, "\"resets\": 2"), 1);
    assert_int_equal(count_of(m.children[0].text, "\"resets\": 0"), 1);
    EXPECT(4, "%s replay --target usb vectors/ray-triangle/random.hex", programs[0]);
    SAYS("usb:HP-000001, usb:HP-000002");
}

/* The same bits as the model, in every golden vector. */
static void the_golden_vectors_are_met(void **state) {
    (void)state;
    plug_board("FLUSH", HP_USB_SUPER, HP_FLUSH);
    plug_board("GRADUAL", HP_USB_HIGH, HP_GRADUAL);
    glob_t all, gradual;
    assert_int_equal(glob("vectors/*-*/*.hex", 0, NULL, &all), 0);
    assert_int_equal(glob("vectors/*-*/*gradual.hex", 0, NULL, &gradual), 0);
    assert_true(all.gl_pathc > 100 && gradual.gl_pathc == 13);
    EXPECT(0, "%s replay --target usb:FLUSH $(ls vectors/*-*/*.hex | grep -v gradual)", programs[0]);
    char words[80];
    snprintf(words, sizeof words, "\n%zu files, ", all.gl_pathc - gradual.gl_pathc);
    SAYS(words);
    SAYS(" records, 0 differ\n");
    EXPECT(0, "%s replay --target usb:GRADUAL $(ls vectors/*-*/*.hex | grep -v flush)", programs[0]);
    SAYS(" records, 0 differ\n");
    assert_int_equal(count_of(m.children[0].text, "gradual.hex: 0 of "), 13);
    EXPECT(3, "%s replay --target usb:FLUSH vectors/ray-triangle/*gradual.hex", programs[0]);
    SAYS("made for subnormals gradual");
    globfree(&all);
    globfree(&gradual);
}

/* A changed expectation shows: the comparison is with what came over USB. */
static void a_changed_bit_of_a_golden_vector_shows(void **state) {
    (void)state;
    plug("HP-000001");
    EXPECT(0, "sed '0,/ 00000001 /s// 00000000 /' vectors/ray-triangle/random.hex >%s/changed.hex", m.work);
    EXPECT(1, "%s replay --target usb %s/changed.hex", programs[0], m.work);
    SAYS("1 file, 500 records, 1 differ\n");
}

static void a_picture_is_the_same_as_the_models(void **state) {
    (void)state;
    plug_board("HP-000001", HP_USB_HIGH, HP_FLUSH);
    plug("HP-000002");
    trace_on_model();
    for (unsigned i = 1; i <= 2; i++) {
        EXPECT(0, "%s trace %s --target usb:HP-00000%u --out %s/usb.exr --report %s/report.json", programs[0], scene,
               i, m.work, m.work);
        expect_same("usb.exr");
        EXPECT(0, "grep -q '\"engine\": \"hardware\"' %s/report.json", m.work);
    }
}

/* ---- watching ---- */

static bool somebody_listens(void) {
    return hpt_mock_listeners(m.boards[0]) > 0;
}

static bool nobody_listens(void) {
    return !somebody_listens();
}

/* When the one before has gone: who waits for somebody to listen is to see this one. */
static void watch_begins(unsigned i, const char *options) {
    await(nobody_listens);
    hpt_child_free(&m.children[1]);
    hpt_child_start(&m.children[1], false, "%s watch %s", programs[i], options);
}

/* Events that happened before somebody listened. */
static void fetch_old_events(unsigned i) {
    EXPECT(0, "%s watch --seconds 0.3", programs[i]);
}

static void end_with(int signal, int status) {
    kill(m.children[1].pid, signal);
    child_ends(status);
}

static void watching_shows_every_packet_once(void **state) {
    (void)state;
    char words[40];
    plug("HP-000001");
    trace_on_model();
    fetch_old_events(HIDRAW);
    watch_begins(HIDRAW, "");
    await(somebody_listens);
    EXPECT(0, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    expect_same("usb.exr");
    EXPECT(0, "%s reset", programs[HIDRAW]);
    assert_true(hpt_child_says(&m.children[1], "RESET"));
    end_with(SIGINT, 0);
    const char *text = m.children[1].text;
    unsigned done = count_of(text, "PACKET_DONE");
    assert_true(done >= 11); /* HELLO, the scene, nine packets of 256 rays */
    unsigned resets = count_of(text, "RESET");
    assert_true(resets >= 1 && resets <= 2); /* opening the link may reset the board too */
    assert_int_equal(count_of(text, "\n"), done + resets);
    EXPECT(0, "%s info --json", programs[HIDRAW]);
    snprintf(words, sizeof words, "\"packets\": %u,", done);
    SAYS(words);
}

static void watching_ends_when_it_is_told_to(void **state) {
    (void)state;
    plug("HP-000001");
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        fetch_old_events(i);
        watch_begins(i, "--count 3 --json");
        await(somebody_listens);
        EXPECT(0, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
        child_ends(0);
        assert_int_equal(count_of(m.children[1].text, "\n"), 3);
        assert_true(count_of(m.children[1].text, "\"kind\":\"PACKET_DONE\",\"status\":\"HP_OK\",\"tag\":") >= 2);
        assert_int_equal(count_of(m.children[1].text, "\"lost\":0,"), 3);
        fetch_old_events(i);
        watch_begins(i, "");
        await(somebody_listens);
        end_with(SIGINT, 0);
        assert_string_equal(m.children[1].text, "");
    }
}

/* Adds up the events that were printed and those that were said to be lost. */
static void add_up(const char *text, unsigned *events, unsigned *lost, unsigned *last) {
    *events = *lost = 0;
    for (const char *line = text; *line; line = strchr(line, '\n') + 1) {
        unsigned number;
        if (sscanf(line, "-- %u event", &number) == 1) {
            *lost += number;
        } else {
            assert_int_equal(sscanf(line, "%u ", last), 1);
            ++*events;
        }
    }
}

/* A watcher that sleeps while hundreds of packets pass: hidraw keeps 64 reports. */
static void lost_events_are_counted_where_they_are_missing(void **state) {
    (void)state;
    unsigned events, lost, last;
    plug("HP-000001");
    watch_begins(HIDRAW, "");
    assert_true(hpt_child_says(&m.children[1], "0  RESET")); /* the configuration, when it was plugged in */
    kill(m.children[1].pid, SIGSTOP);
    EXPECT(0, "%s trace %s --size 400x225 --target usb --out %s/usb.exr", programs[0], scene, m.work);
    kill(m.children[1].pid, SIGCONT);
    assert_true(hpt_child_says(&m.children[1], "\n64  PACKET_DONE"));
    EXPECT(0, "%s reset", programs[HIDRAW]);
    assert_true(hpt_child_says(&m.children[1], " lost\n"));
    end_with(SIGINT, 0);
    assert_non_null(strstr(strstr(m.children[1].text, " lost\n"), "  RESET"));
    add_up(m.children[1].text, &events, &lost, &last);
    assert_int_equal(events, 1 + 64 + 1);
    assert_true(lost > 250);
    assert_int_equal(events + lost, last + 1);
}

static void watching_ends_when_the_board_is_unplugged(void **state) {
    (void)state;
    hpt_device *board = plug("HP-000001");
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        watch_begins(i, "");
        await(somebody_listens);
        hpt_pull(board);
        child_ends(4);
        child_says(&m.children[1], i == HIDRAW ? "hitpipe watch: board HP-000001 (/dev/hidraw0) was unplugged\n"
                                               : "hitpipe watch: board HP-000001 (1-1:1.1) was unplugged\n");
        EXPECT(4, "%s watch", programs[i]);
        SAYS("no board is plugged in");
        hpt_push(board);
    }
}

/* ---- reset ---- */

static void the_clock_is_chosen(void **state) {
    (void)state;
    plug("HP-000001");
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        EXPECT(0, "%s reset --clock %u", programs[i], 125000000 + i);
        SAYS(" Hz from the next session on, reset done\n");
        EXPECT(0, "%s info --target usb --json", programs[i]); /* a session */
        assert_int_equal(count_of(m.children[0].text, i ? "\"clock_hz\": 125000001" : "\"clock_hz\": 125000000"), 2);
        EXPECT(4, "%s reset --clock 1", programs[i]);
        SAYS("the board refused CLOCK 1: packet field out of range\n");
        EXPECT(0, "%s reset --json", programs[i]);
        SAYS("\"done\": \"reset\"");
    }
    EXPECT(0, "%s info --json", programs[0]);
    SAYS("\"resets\": 4"); /* none where the clock was refused */
}

static void an_abort_leaves_the_session(void **state) {
    (void)state;
    plug("HP-000001");
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        EXPECT(0, "%s info --target usb", programs[i]);
        EXPECT(0, "%s reset --abort", programs[i]);
        SAYS("board HP-000001 (usb3): abort done\n");
        EXPECT(0, "%s info --json", programs[i]);
        SAYS("\"resets\": 0");
        SAYS("\"session\": true");
    }
    EXPECT(0, "%s reset", programs[0]);
    EXPECT(0, "%s info --json", programs[0]);
    SAYS("\"session\": false");
}

/* ---- in the midst of a run ---- */

enum { DELAY_US = 30000 };

static bool a_run_is_under_way(void) {
    return hpt_counts(m.boards[0]).urbs > 12;
}

/* A run that takes its time, and has begun. */
static void slow_run(const char *options) {
    hpt_delay(m.boards[0], DELAY_US);
    hpt_child_start(&m.children[1], false, "%s trace %s --target usb --out %s/usb.exr %s", programs[0], scene, m.work,
                    options);
    await(a_run_is_under_way);
}

static void a_reset_in_its_midst_ends_a_run_or_not(void **state) {
    (void)state;
    plug("HP-000001");
    trace_on_model();
    slow_run("");
    EXPECT(0, "%s reset", programs[HIDRAW]);
    child_ends(4);
    hpt_child_free(&m.children[1]);
    slow_run("--reconnect 10");
    EXPECT(0, "%s reset", programs[HIDRAW]);
    hpt_delay(m.boards[0], 0);
    child_ends(0);
    expect_same("usb.exr");
}

/* Whatever ends the program, the next one finds the board as it was. */
static void ended_by(int signal, int status) {
    plug("HP-000001");
    slow_run("");
    kill(m.children[1].pid, signal);
    child_ends(status);
    hpt_delay(m.boards[0], 0);
    trace_works();
    EXPECT(0, "%s reset", programs[0]);
}

static void ctrl_c_leaves_the_board_usable(void **state) {
    (void)state;
    ended_by(SIGINT, 4);
    child_says(&m.children[1], "cancelled");
}

static void a_killed_program_leaves_the_board_usable(void **state) {
    (void)state;
    ended_by(SIGKILL, -SIGKILL);
}

static void unplugged_in_its_midst_a_run_ends_and_says_so(void **state) {
    (void)state;
    hpt_device *board = plug_faulty(HPT_FAULT_UNPLUG, 0, true, 6, 1);
    trace_on_model();
    EXPECT(4, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    SAYS("disconnected");
    EXPECT(0, "test ! -e %s/usb.exr", m.work);
    EXPECT(4, "%s info --target usb", programs[0]);
    hpt_push(board);
    EXPECT(0, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    expect_same("usb.exr");
}

static void unplugged_and_plugged_in_again_a_run_goes_on(void **state) {
    (void)state;
    trace_on_model();
    for (unsigned in = 0; in < 2; in++) {
        hpt_device *board = plug_faulty(HPT_FAULT_UNPLUG, 200, in, 6, 1);
        EXPECT(0, "%s trace %s --target usb --reconnect 10 --out %s/usb.exr", programs[0], scene, m.work);
        expect_same("usb.exr");
        assert_true(hpt_mock_quiet());
        hpt_discard(board);
        m.board_count--;
    }
}

/* ---- faults of the cable ---- */

static const struct single_fault {
    const char *name;
    hpt_fault fault;
    bool in;
    unsigned packet;
} single_faults[] = {
#define HPT_SINGLE(name, KIND, argument, in, packet, words) {#name, {HPT_FAULT_##KIND, argument}, in, packet},
#include "testbench/usb/single_faults.def"
#undef HPT_SINGLE
};

enum { SINGLE_FAULTS = sizeof single_faults / sizeof single_faults[0] };

static void trace_triangles_on_model(void) {
    EXPECT(0, "awk -f testbench/support/triangles.awk >%s/triangles.csv", m.work);
    EXPECT(0, "%s trace %s/triangles.csv --size 64x36 --out %s/model.exr", programs[0], m.work, m.work);
}

/* RESULT packets of 53 records are multiples of 512 bytes: a zero-length packet ends each, at high speed. */
static void begin_with_fault(unsigned at, const struct single_fault *one) {
    enum { RECORDS = 53 };
    char serial[13];
    snprintf(serial, sizeof serial, "FAULT%u", at);
    hpt_device_def def = board_def(serial, HP_USB_HIGH);
    def.gadget.board.config.packet_results = RECORDS;
    def.choose = choose;
    def.context = &m.plans[at];
    m.plans[at] = (plan){.fault = one->fault, .in = one->in, .from = one->packet, .count = 1};
    plug_def(&def);
    hpt_child_start(&m.children[1 + at], false,
                    "%s trace %s/triangles.csv --size 64x36 --target usb:%s --out %s/%s.exr", programs[0], m.work,
                    serial, m.work, one->name);
}

static void end_with_fault(unsigned at, const struct single_fault *one) {
    hpt_child *child = &m.children[1 + at];
    if (hpt_child_end(child, SECONDS)) fail_msg("%s: status %d:\n%s", one->name, child->status, child->text);
    if (m.plans[at].struck != 1) fail_msg("%s: struck %u times, not once", one->name, m.plans[at].struck);
    EXPECT(0, "cmp %s/model.exr %s/%s.exr", m.work, m.work, one->name);
    hpt_child_free(child);
}

/* Many boards at a time, since some of their programs wait for a timeout. */
static void every_fault_of_a_cable_is_mended(void **state) {
    (void)state;
    trace_triangles_on_model();
    for (unsigned from = 0; from < SINGLE_FAULTS; from += BOARDS) {
        unsigned n = SINGLE_FAULTS - from < BOARDS ? SINGLE_FAULTS - from : BOARDS;
        for (unsigned i = 0; i < n; i++) begin_with_fault(i, &single_faults[from + i]);
        for (unsigned i = 0; i < n; i++) end_with_fault(i, &single_faults[from + i]);
        assert_true(hpt_mock_quiet());
        while (m.board_count) hpt_discard(m.boards[--m.board_count]);
    }
}

/* ---- what must not be, or not yet ---- */

static void without_permission_the_udev_rule_is_named(void **state) {
    (void)state;
    hpt_device *board = plug("HP-000001");
    hpt_mock_chmod(board, 0);
    static const char *const commands[] = {"reset", "watch", "info", "info --target usb"};
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        for (unsigned k = 0; k < sizeof commands / sizeof commands[0]; k++) {
            hpt_child_free(&m.children[1]);
            hpt_child_start(&m.children[1], true, "%s %s", programs[i], commands[k]);
            child_ends(k == 2 ? 0 : 4);
            child_says(&m.children[1], "no permission");
            child_says(&m.children[1], "60-hitpipe.rules");
            assert_int_equal(count_of(m.children[1].text, "60-hitpipe.rules"), k == 2 ? 2 : 1); /* USB and HID */
        }
    }
    hpt_mock_chmod(board, 0666);
    hpt_child_free(&m.children[1]);
    hpt_child_start(&m.children[1], true, "%s reset", programs[0]);
    child_ends(0);
}

static void a_busy_interface_is_said_to_be(void **state) {
    (void)state;
    hpt_device *board = plug("HP-000001");
    m.claim = hpt_mock_claim(board, HP_USB_DATA_INTERFACE);
    EXPECT(4, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    SAYS("another program has its data interface");
    EXPECT(0, "%s reset", programs[HIDRAW]); /* the control plane is another interface */
    release_claim();
    trace_works();
    m.claim = hpt_mock_claim(board, HP_USB_HID_INTERFACE);
    EXPECT(4, "%s reset", programs[LIBUSB]);
    SAYS("board HP-000001 (1-1:1.1) cannot be opened: another program holds its HID interface\n");
    EXPECT(4, "%s reset", programs[HIDRAW]);
    SAYS("no board is plugged in: looked for a HID device"); /* usbhid has lost it */
    EXPECT(0, "%s info", programs[LIBUSB]);
    SAYS("another program holds its HID interface");
    release_claim();
    EXPECT(0, "%s reset", programs[LIBUSB]);
}

/* libusb takes the HID from usbhid, and gives it back. */
static void the_kernels_driver_is_back_after_the_libusb_back_end(void **state) {
    (void)state;
    char path[HPT_MOCK_PATH];
    hpt_device *board = plug("HP-000001");
    watch_begins(LIBUSB, "");
    await(somebody_listens);
    EXPECT(4, "%s reset", programs[HIDRAW]);
    end_with(SIGINT, 0);
    assert_string_equal(hpt_mock_hid_node(board, path), "/dev/hidraw0");
    EXPECT(0, "%s reset", programs[HIDRAW]);
}

static void a_board_that_never_answers_is_given_up(void **state) {
    (void)state;
    hpt_device *board = plug_faulty(HPT_FAULT_DROP, 0, true, 0, UINT32_MAX);
    hp_device_def def = hp_default_device_def();
    hp_device *device;
    def.target = "usb";
    def.timeout_ms = 100;
    def.retries = 1;
    assert_int_equal(hp_open(&def, &device), HP_ERROR_TIMEOUT);
    hpt_mock_mute(board, true);
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        EXPECT(4, "%s reset", programs[i]);
        SAYS("board HP-000001 did not answer to read report 1 in ");
        EXPECT(0, "%s info", programs[i]);
        SAYS("; board HP-000001 did not answer to read report 1 in ");
    }
    hpt_mock_mute(board, false);
    EXPECT(0, "%s reset", programs[0]);
}

/* ---- other versions, damage ---- */

static size_t set_version(void *context, uint8_t *bytes, size_t n) {
    if (bytes[0] == HP_USB_REPORT_IDENTITY) hp_put16(bytes + 1 + HP_USB_AT_IDENTITY_reports, *(uint16_t *)context);
    return n;
}

static size_t cut(void *context, uint8_t *bytes, size_t n) {
    (void)context, (void)bytes;
    return n / 2;
}

static size_t make_foreign(void *context, uint8_t *bytes, size_t n) {
    (void)context;
    bytes[0] = 9;
    return n;
}

static void a_board_of_another_version_does_what_it_can(void **state) {
    (void)state;
    uint16_t version = 7;
    hpt_device *board = plug("HP-000001");
    hpt_mock_twist_reports(board, set_version, &version);
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        version = 7;
        EXPECT(0, "%s info", programs[i]);
        SAYS("reports of version 7: HEALTH, EVENTS, RESET, ABORT, CLOCK\nhealth ");
        EXPECT(0, "%s reset --clock 125000000", programs[i]);
        version = 0;
        EXPECT(0, "%s info", programs[i]);
        SAYS("reports of version 0:\n");
        assert_int_equal(count_of(m.children[0].text, "health "), 0);
        EXPECT(4, "%s reset", programs[i]);
        SAYS("board HP-000001 lacks RESET: it has version 0 of the reports, and RESET came with version 1\n");
        EXPECT(4, "%s watch", programs[i]);
        SAYS("board HP-000001 lacks EVENTS");
    }
}

static void a_board_with_a_newer_protocol_is_refused_in_words(void **state) {
    (void)state;
    plug_faulty(HPT_FAULT_NEWER, 2, true, 0, UINT32_MAX);
    EXPECT(4, "%s trace %s --target usb --out %s/usb.exr", programs[0], scene, m.work);
    SAYS("the board speaks version 2, this program version 1");
    EXPECT(0, "%s reset", programs[0]); /* its control plane is not newer */
}

static void a_damaged_report_is_refused_in_words(void **state) {
    (void)state;
    hpt_device *board = plug("HP-000001");
    for (unsigned i = 0; i < BACK_ENDS; i++) {
        hpt_mock_twist_reports(board, cut, NULL);
        EXPECT(4, "%s reset", programs[i]);
        SAYS("report IDENTITY has 29 bytes behind its ID, not 60\n");
        hpt_mock_twist_reports(board, make_foreign, NULL);
        EXPECT(4, "%s reset", programs[i]);
        SAYS("report 9 came, not IDENTITY, which is 1: no hitpipe board, or damaged\n");
    }
    hpt_mock_twist_reports(board, NULL, NULL);
    EXPECT(0, "%s info --json", programs[0]);
    SAYS("\"resets\": 0");
}

/* ---- the library in this process ---- */

static void boards_come_and_go_in_the_list(void **state) {
    (void)state;
    hp_control_def def = hp_default_control_def();
    hp_control_board boards[2];
    size_t count;
    assert_int_equal(hp_control_list(&def, boards, 2, &count), HP_OK);
    assert_int_equal(count, 0);
    hpt_device *one = plug("HP-000001");
    plug("HP-000002");
    memset(boards, 0xEE, sizeof boards);
    assert_int_equal(hp_control_list(&def, boards, 1, &count), HP_OK);
    assert_int_equal(count, 2);
    assert_int_equal((unsigned char)boards[1].serial[0], 0xEE);
    assert_int_equal(hp_control_list(&def, boards, 2, &count), HP_OK);
    bool swapped = strcmp(boards[0].serial, "HP-000001") != 0;
    assert_string_equal(boards[swapped].serial, "HP-000001");
    assert_string_equal(boards[!swapped].serial, "HP-000002");
    assert_string_equal(boards[0].name, "collision board");
    assert_int_equal(boards[0].vendor, 0x1209);
    assert_int_equal(boards[0].product, 1);
    assert_int_equal(boards[0].release, 0x100);
    hpt_pull(one);
    assert_int_equal(hp_control_list(&def, boards, 2, &count), HP_OK);
    assert_int_equal(count, 1);
    assert_string_equal(boards[0].serial, "HP-000002");
    hpt_push(one);
    assert_int_equal(hp_control_list(&def, boards, 2, &count), HP_OK);
    assert_int_equal(count, 2);
}

static int count_hotplug(libusb_context *context, libusb_device *device, libusb_hotplug_event event, void *counts) {
    (void)context, (void)device;
    ((unsigned *)counts)[event == LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT]++;
    return 0;
}

static void expect_hotplug(libusb_context *context, const unsigned counts[2], unsigned arrived, unsigned left) {
    for (unsigned i = 0; i < 200 && (counts[0] != arrived || counts[1] != left); i++) {
        struct timeval wait = {.tv_usec = 50000};
        libusb_handle_events_timeout_completed(context, &wait, NULL);
    }
    assert_int_equal(counts[0], arrived);
    assert_int_equal(counts[1], left);
}

static void libusb_is_told_of_boards_that_come_and_go(void **state) {
    (void)state;
    libusb_context *context;
    libusb_hotplug_callback_handle handle;
    unsigned counts[2] = {0, 0};
    assert_int_equal(libusb_init(&context), 0);
    assert_int_equal(libusb_hotplug_register_callback(
                         context, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0,
                         HP_USB_VENDOR, HP_USB_PRODUCT, LIBUSB_HOTPLUG_MATCH_ANY, count_hotplug, counts, &handle),
                     0);
    hpt_device *board = plug("HP-000001");
    expect_hotplug(context, counts, 1, 0);
    hpt_pull(board);
    expect_hotplug(context, counts, 1, 1);
    hpt_push(board);
    expect_hotplug(context, counts, 2, 1);
    libusb_exit(context);
}

static hp_control *control_of_the_board(void) {
    hp_control_def def = hp_default_control_def();
    hp_control *control;
    if (hp_control_open(&def, &control)) fail_msg("%s", hp_control_message(NULL));
    return control;
}

static void an_open_control_notices_that_the_board_is_gone(void **state) {
    (void)state;
    hpt_device *board = plug("HP-000001");
    hp_control_health health;
    hp_control_event event;
    hp_control *control = control_of_the_board();
    assert_int_equal(hp_control_read_health(control, &health), HP_OK);
    assert_int_equal(health.speed, 5);
    hpt_pull(board);
    hp_status status = hp_control_read_health(control, &health);
    hp_status event_status;
    do {
        event_status = hp_control_next_event(control, 1000, &event);
    } while (event_status == HP_OK); /* what had come before */
    hpt_push(board);
    hp_status later = hp_control_reset(control); /* that is another one, to the kernel */
    hp_control_close(control);
    assert_int_equal(status, HP_ERROR_DISCONNECTED);
    assert_int_equal(event_status, HP_ERROR_DISCONNECTED);
    assert_true(later == HP_ERROR_DISCONNECTED || later == HP_ERROR_IO);
    control = control_of_the_board();
    status = hp_control_reset(control);
    hp_control_close(control);
    assert_int_equal(status, HP_OK);
}

static void wake(int signal) {
    (void)signal;
}

static void *signal_soon(void *thread) {
    nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    pthread_kill(*(pthread_t *)thread, SIGUSR1);
    return NULL;
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void waiting_for_events_has_an_end(void **state) {
    (void)state;
    plug("HP-000001");
    hp_control_event event;
    pthread_t self = pthread_self(), other;
    const struct sigaction action = {.sa_handler = wake};
    sigaction(SIGUSR1, &action, NULL);
    hp_control *control = control_of_the_board();
    while (hp_control_next_event(control, 100, &event) == HP_OK) continue;
    double start = seconds();
    hp_status quiet = hp_control_next_event(control, 150, &event);
    double took = seconds() - start;
    pthread_create(&other, NULL, signal_soon, &self);
    hp_status ended = hp_control_next_event(control, 500, &event);
    pthread_join(other, NULL);
    hp_control_reset(control);
    hp_status after = hp_control_next_event(control, 5000, &event);
    hp_control_close(control);
    assert_int_equal(quiet, HP_ERROR_TIMEOUT);
    assert_true(took >= 0.149 && took < 5);
    assert_true(ended == HP_ERROR_CANCELLED || (ended == HP_ERROR_TIMEOUT && !hidraw_here()));
    assert_int_equal(after, HP_OK);
    assert_int_equal(event.kind, HP_USB_EVENT_RESET);
}

enum { THREADS = 4, TIMES = 10 };

/* With the libusb back end only one of them has it at a time. */
static void *open_often(void *failures) {
    hp_control_def def = hp_default_control_def();
    for (unsigned i = 0; i < TIMES; i++) {
        hp_control *control;
        hp_control_board board;
        hp_control_health health;
        size_t count;
        hp_status status = hp_control_list(&def, &board, 1, &count);
        if (!status) status = hp_control_open(&def, &control);
        if (!status) status = hp_control_read_health(control, &health);
        if (status && (hidraw_here() || status != HP_ERROR_NO_DEVICE)) ++*(unsigned *)failures;
        if (!status) hp_control_close(control);
    }
    return NULL;
}

static void threads_list_and_open_side_by_side(void **state) {
    (void)state;
    plug("HP-000001");
    pthread_t threads[THREADS];
    unsigned failures[THREADS] = {0};
    for (unsigned i = 0; i < THREADS; i++) pthread_create(&threads[i], NULL, open_often, &failures[i]);
    for (unsigned i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
    for (unsigned i = 0; i < THREADS; i++) assert_int_equal(failures[i], 0);
}

/* ---- the page ---- */

static void the_page_has_every_fault(void **state) {
    (void)state;
    test_page *page = page_open("docs/testing.md");
    assert_non_null(page);
    page_rows rows = page_table(page, "## Faults at level 3");
#define HPT_SINGLE(name, KIND, argument, in, packet, words)                                                          \
    page_expect(&rows, "| 3 | %s | completes, the model's picture | `%s` |", words, #name);
#include "testbench/usb/single_faults.def"
#undef HPT_SINGLE
#define HPT_TEST(name, words, outcome) page_expect(&rows, "| 3 | %s | %s | `%s` |", words, outcome, #name);
#include "faults.def"
#undef HPT_TEST
    page_end(&rows);
    page_close(page);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, put_up, take_down)

/* The programs are there with both back ends of hidapi, this one with the one that the library was built for. With
 * ONLY=library in the environment, for a build with the other, only what depends on that. */
int main(int argc, char **argv) {
    const char *only = getenv("ONLY");
    (void)argc;
    hpt_mock_under_wrapper(argv);
    find_programs();
    const struct CMUnitTest library[] = {
        TEST(boards_come_and_go_in_the_list),
        TEST(libusb_is_told_of_boards_that_come_and_go),
        TEST(an_open_control_notices_that_the_board_is_gone),
        TEST(waiting_for_events_has_an_end),
        TEST(threads_list_and_open_side_by_side),
    };
    const struct CMUnitTest programs_with_boards[] = {
        TEST(without_a_board_it_is_said_what_was_looked_for),
        TEST(info_shows_the_boards_that_are_plugged_in),
        TEST(a_board_is_one_by_its_usage_page_and_only_once),
        TEST(of_several_boards_one_must_be_named),
        TEST(the_golden_vectors_are_met),
        TEST(a_changed_bit_of_a_golden_vector_shows),
        TEST(a_picture_is_the_same_as_the_models),
        TEST(watching_shows_every_packet_once),
        TEST(watching_ends_when_it_is_told_to),
        TEST(the_clock_is_chosen),
        TEST(an_abort_leaves_the_session),
        TEST(the_kernels_driver_is_back_after_the_libusb_back_end),
        TEST(every_fault_of_a_cable_is_mended),
#define HPT_TEST(name, words, outcome) TEST(name),
#include "faults.def"
        cmocka_unit_test(the_page_has_every_fault),
    };
    bool all = !only || strcmp(only, "library") != 0;
    int failed = all ? cmocka_run_group_tests(programs_with_boards, NULL, NULL) : 0;
    return failed + cmocka_run_group_tests(library, NULL, NULL);
}
