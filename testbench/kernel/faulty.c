/* faulty: serves boards over USB/IP as `hitpipe serve` does, each at the end of a cable with a fault of its own, and
 * says on standard error when it strikes. Runs in the guest of testbench/kernel/run, until it is ended.
 *
 *     faulty           a line for each board on standard output: bus id, serial number, fault
 *     faulty --rows    the rows of docs/testing.md instead
 */
#include "cabled.h"
#include "driver/usbip/server.h"
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

enum { SERIAL = 13, RECORDS = 53 };

static const struct fault {
    const char *name, *words, *outcome;
    hpt_fault fault;
    bool in;
    unsigned from, count; /* packets */
} faults[] = {
#define HPT_BOARD(name, KIND, argument, in, words, outcome)                                                          \
    {#name, words, outcome, {HPT_FAULT_##KIND, argument}, in, 0, UINT_MAX},
#include "faults.def"
#define HPT_SINGLE(name, KIND, argument, in, packet, words)                                                          \
    {#name, words, "completes, the model's picture", {HPT_FAULT_##KIND, argument}, in, packet, 1},
#include "testbench/usb/single_faults.def"
#undef HPT_SINGLE
};

enum { BOARDS = sizeof faults / sizeof faults[0] };
_Static_assert(BOARDS <= (int)HP_USBIP_BOARDS, "one server has room for all");

static char serials[BOARDS][SERIAL];

/* ---- the faults ---- */

static const struct fault *fault_of(const hp_gadget *gadget) {
    unsigned i = 0;
    while (strcmp(serials[i], hp_gadget_serial(gadget)) != 0) i++;
    return &faults[i];
}

static bool strikes(const struct fault *fault, bool in, unsigned number, size_t n) {
    if (fault->fault.kind == HPT_FAULT_NO_ZERO && n % HP_USB_HIGH_PACKET) return false; /* there is none */
    return in == fault->in && number >= fault->from && number - fault->from < fault->count;
}

hpt_fault hpt_cabled_choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    const struct fault *fault = fault_of(context);
    (void)bytes;
    if (!strikes(fault, in, number, n)) return (hpt_fault){HPT_FAULT_NONE, 0};
    fprintf(stderr, "%s: packet %u %s, %zu bytes\n", fault->name, number, in ? "to the host" : "to the board", n);
    return fault->fault;
}

/* ---- the boards ---- */

/* RESULT packets of 53 records are multiples of 512 bytes: a zero-length packet ends each, at high speed. */
static hp_status make_boards(hp_gadget_def boards[BOARDS]) {
    hp_board_def board = {.engine = HP_ENGINE_QUICK, .threads = 1};
    hp_status status = hp_config_preset(&board.config, "usb3");
    board.config.packet_results = RECORDS;
    for (unsigned i = 0; i < BOARDS; i++) {
        snprintf(serials[i], sizeof serials[i], "F-%u", i + 1);
        boards[i] = (hp_gadget_def){.board = board, .serial = serials[i], .speed = HP_USB_HIGH};
    }
    return status;
}

static hp_usbip_server *served; /* for the signal handler, which can be told nothing */

static void stop(int signal) {
    (void)signal;
    hp_usbip_stop(served);
}

static void print_line(void *context, const char *text) {
    (void)context;
    fprintf(stderr, "%s\n", text);
}

static int serve(void) {
    static hp_gadget_def boards[BOARDS]; /* large */
    char why[HP_USBIP_MESSAGE] = "no such preset";
    const hp_usbip_def def = {.gadgets = boards,
                              .count = BOARDS,
                              .port = HP_USBIP_PORT,
                              .limits = hp_usbip_default_limits(),
                              .log = print_line};
    if (make_boards(boards) || hp_usbip_create(&def, &served, why)) {
        fprintf(stderr, "faulty: %s\n", why);
        return 1;
    }
    sigaction(SIGTERM, &(struct sigaction){.sa_handler = stop}, NULL);
    for (unsigned i = 0; i < BOARDS; i++) printf("%s %s %s\n", hp_usbip_busid(served, i), serials[i], faults[i].name);
    fflush(stdout);
    hp_status status = hp_usbip_serve(served);
    hp_usbip_destroy(served);
    return status ? 1 : 0;
}

/* ---- the page ---- */

static void print_rows(void) {
    for (unsigned i = 0; i < BOARDS; i++)
        printf("| 4 | %s | %s | `test_faults: %s` |\n", faults[i].words, faults[i].outcome, faults[i].name);
#define HPT_TEST(script, check, words, outcome)                                                                      \
    printf("| 4 | %s | %s | `test_%s: %s` |\n", words, outcome, #script, check);
#include "faults.def"
}

int main(int argc, char **argv) {
    if (argc == 1) return serve();
    if (argc != 2 || strcmp(argv[1], "--rows") != 0) {
        fprintf(stderr, "usage: faulty [--rows]\n");
        return 2;
    }
    print_rows();
    return 0;
}
