#include "host/cli/cli.h"

#include "host/cli/interrupt.h"
#include "host/import/board_json.h"
#include "host/output/file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_TARGET = 0x1000,
    KEY_BOARD,
    KEY_ENGINE,
    KEY_ISA,
    KEY_THREADS,
    KEY_REPORT,
    KEY_VCD,
    KEY_JSON,
    KEY_RECONNECT,
    KEY_USB_ID,
    KEY_USB_DEPTH,
    KEY_USB_TRANSFER
};

enum { RECONNECT_MOST = 3600 * 24 };

static const struct argp_option option_table[] = {
    {"target", KEY_TARGET, "TARGET", 0,
     "where packets go: model (default), usb (the only board on USB), usb:SERIAL, null", 90},
    {"reconnect", KEY_RECONNECT, "SECONDS", 0, "wait so long for a board that is lost, and go on (default 0)", 90},
    {"usb-id", KEY_USB_ID, "VID:PID", 0, "identifiers of the board on USB, hexadecimal (default 1209:0001)", 90},
    {"usb-depth", KEY_USB_DEPTH, "N", 0, "transfers under way in each direction, 1 to 32 (default 4)", 90},
    {"usb-transfer", KEY_USB_TRANSFER, "BYTES", 0,
     "most bytes of one transfer, a multiple of 1024 (default 0: whole packets)", 90},
    {"board", KEY_BOARD, "NAME|FILE.json", 0, "the board to simulate: usb3 (default), wscg2007, ideal, or a file",
     90},
    {"engine", KEY_ENGINE, "quick|clocked", 0, "how board time is found; both give the same counts (default quick)",
     90},
    {"isa", KEY_ISA, "NAME", 0, "instruction set of the model's arithmetic: plain, sse2, avx2, avx512, neon", 90},
    {"threads", KEY_THREADS, "N", 0, "threads of the model's arithmetic (default: one a processor)", 90},
    {"report", KEY_REPORT, "FILE.json", 0, "write counts and times; - is standard output", 90},
    {"vcd", KEY_VCD, "FILE", 0, "write the board's waveform (clocked engine)", 90},
    {"json", KEY_JSON, NULL, 0, "print for machines, as JSON", 90},
    {0},
};

static const struct argp_option control_table[] = {
    {"target", KEY_TARGET, "usb[:SERIAL]", 0,
     "which board: the only one that is plugged in (default), or one of several", 90},
    {"usb-id", KEY_USB_ID, "VID:PID", 0, "its identifiers, hexadecimal (default 1209:0001)", 90},
    {"json", KEY_JSON, NULL, 0, "print for machines, as JSON", 90},
    {0},
};

static void set_board(hp_cli *cli, const char *name, struct argp_state *state) {
    hp_fault fault;
    if (hp_board_load(name, &cli->device.board, &fault) != HP_OK)
        argp_failure(state, hp_status_exit(fault.status), 0, "%s", fault.message);
}

static void set_usb_id(hp_cli *cli, const char *text, struct argp_state *state) {
    int end = 0;
    unsigned vendor, product;
    if (sscanf(text, "%4x:%4x%n", &vendor, &product, &end) != 2 || text[end] || strpbrk(text, "+-xX "))
        argp_error(state, "--usb-id takes two hexadecimal numbers such as 1209:0001, not '%s'", text);
    cli->device.usb_vendor = vendor;
    cli->device.usb_product = product;
}

static unsigned whole(const char *option, const char *text, size_t least, size_t most, struct argp_state *state) {
    size_t number = 0;
    if (!hp_cli_whole(text, most, &number) || number < least)
        argp_error(state, "%s takes a number from %zu to %zu, not '%s'", option, least, most, text);
    return (unsigned)number;
}

static error_t parse_link(int key, const char *argument, struct argp_state *state) {
    hp_device_def *def = &((hp_cli *)state->input)->device;
    switch (key) {
    case KEY_TARGET:
        def->target = argument;
        return 0;
    case KEY_RECONNECT:
        def->reconnect_ms = 1000 * whole("--reconnect", argument, 0, RECONNECT_MOST, state);
        return 0;
    case KEY_USB_ID:
        set_usb_id(state->input, argument, state);
        return 0;
    case KEY_USB_DEPTH:
        def->usb_depth = whole("--usb-depth", argument, 1, HP_USB_DEPTH_MAX, state);
        return 0;
    case KEY_USB_TRANSFER:
        def->usb_transfer = whole("--usb-transfer", argument, 0, HP_USB_TRANSFER_MAX, state);
        if (def->usb_transfer % 1024)
            argp_error(state, "--usb-transfer takes a multiple of 1024, not '%s'", argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    hp_cli *cli = state->input;
    switch (key) {
    case KEY_BOARD:
        set_board(cli, argument, state);
        return 0;
    case KEY_ENGINE:
        cli->device.clocked = strcmp(argument, "clocked") == 0;
        if (!cli->device.clocked && strcmp(argument, "quick") != 0)
            argp_error(state, "--engine is quick or clocked, not '%s'", argument);
        return 0;
    case KEY_ISA:
        cli->device.isa = argument;
        return 0;
    case KEY_THREADS:
        cli->device.threads = whole("--threads", argument, 0, 1024, state);
        return 0;
    case KEY_REPORT:
        cli->report = argument;
        return 0;
    case KEY_VCD:
        cli->vcd_path = argument;
        return 0;
    case KEY_JSON:
        cli->json = true;
        return 0;
    case ARGP_KEY_END:
        if (cli->vcd_path && !cli->device.clocked) argp_error(state, "--vcd needs --engine clocked");
        hp_cli_claim(cli, cli->json ? "-" : NULL, state);
        hp_cli_claim(cli, cli->report, state);
        hp_cli_claim(cli, cli->vcd_path, state);
        return 0;
    default:
        return parse_link(key, argument, state);
    }
}

void hp_cli_claim(hp_cli *cli, const char *path, struct argp_state *state) {
    if (!path || strcmp(path, "-") != 0) return;
    if (cli->taken) argp_error(state, "standard output takes one thing only: JSON, or one file named -");
    cli->taken = true;
}

const struct argp hp_cli_argp = {.options = option_table, .parser = parse};

/* ---- verbs of the control plane ---- */

static const char usb_target[] = "usb";

/* The serial number in usb:SERIAL, NULL for usb alone. False: it is another target. */
static bool serial_of(const char *target, const char **serial) {
    size_t n = sizeof usb_target - 1;
    *serial = NULL;
    if (strncmp(target, usb_target, n) != 0 || (target[n] != ':' && target[n] != '\0')) return false;
    if (target[n] == ':') *serial = target + n + 1;
    return !*serial || **serial;
}

static error_t parse_control(int key, char *argument, struct argp_state *state) {
    hp_cli *cli = state->input;
    const char *serial;
    if (key == ARGP_KEY_INIT) cli->device.target = usb_target;
    if (key == KEY_TARGET && !serial_of(argument, &serial))
        argp_error(state, "--target is usb or usb:SERIAL here, not '%s': the control plane is on USB", argument);
    return parse(key, argument, state);
}

const struct argp hp_cli_control_argp = {.options = control_table, .parser = parse_control};

hp_status hp_cli_control_open(const hp_cli *cli, hp_control **control, hp_fault *fault) {
    hp_control_def def = hp_default_control_def();
    serial_of(cli->device.target, &def.serial);
    def.vendor = (uint16_t)cli->device.usb_vendor;
    def.product = (uint16_t)cli->device.usb_product;
    hp_status status = hp_control_open(&def, control);
    return status ? hp_fault_set(fault, status, "%s", hp_control_message(NULL)) : HP_OK;
}

/* ---- opening and closing ---- */

hp_cli hp_cli_begin(const char *verb) {
    return (hp_cli){.verb = verb, .device = hp_default_device_def(), .bar = hp_progress_bar_new()};
}

static void take_waveform(void *context, const char *text, size_t n) {
    fwrite(text, 1, n, context); /* a failure shows in hp_cli_close */
}

static bool go_on(void *context, uint64_t done, uint64_t total) {
    hp_cli *cli = context;
    return hp_progress_bar_show(&cli->bar, done, total) && !hp_interrupted();
}

/* libusb's log, which it keeps only when the environment's LIBUSB_DEBUG asks for it. */
static void show_log(struct libusb_context *context, unsigned level, const char *text) {
    (void)context, (void)level;
    fputs(text, stderr);
}

hp_status hp_cli_open(hp_cli *cli, hp_device **device, hp_fault *fault) {
    *device = NULL;
    hp_interrupt_watch();
    if (hp_file_probe(cli->report, fault) != HP_OK) return fault->status;
    if (cli->vcd_path) {
        cli->vcd = hp_file_create(cli->vcd_path, fault);
        if (!cli->vcd) return fault->status;
        cli->device.vcd = take_waveform;
        cli->device.vcd_context = cli->vcd;
    }
    cli->device.progress = go_on;
    cli->device.progress_context = cli;
    if (getenv("LIBUSB_DEBUG")) cli->device.usb_log = show_log;
    hp_status status = hp_open(&cli->device, device);
    return status == HP_OK ? HP_OK : hp_cli_device_fault(NULL, status, NULL, fault);
}

hp_status hp_cli_close(hp_cli *cli, hp_device *device, hp_fault *fault) {
    hp_close(device);
    hp_progress_bar_end(&cli->bar);
    FILE *vcd = cli->vcd;
    cli->vcd = NULL;
    return vcd ? hp_file_finish(vcd, cli->vcd_path, fault) : HP_OK;
}

hp_status hp_cli_device_fault(const hp_device *device, hp_status status, const char *place, hp_fault *fault) {
    const char *words = hp_error_message(device);
    if (!words || !*words) words = hp_status_text(status);
    return hp_fault_set(fault, status, "%s%s%s", place ? place : "", place ? ": " : "", words);
}

int hp_cli_end(hp_cli *cli, hp_status status, const hp_fault *fault) {
    hp_progress_bar_end(&cli->bar);
    if (status != HP_OK) fprintf(stderr, "%s: %s\n", cli->verb, fault->message);
    return hp_status_exit(status);
}

/* The digits at the start of `text`; what stands behind them, or NULL if there are none, or too many. */
static const char *digits(const char *text, size_t most, size_t *number) {
    *number = 0;
    const char *at = text;
    for (; *at >= '0' && *at <= '9' && *number <= most; at++) *number = 10 * *number + (size_t)(*at - '0');
    return at > text && *number <= most ? at : NULL;
}

bool hp_cli_whole(const char *text, size_t most, size_t *number) {
    const char *end = digits(text, most, number);
    return end && *end == 0;
}

/* What stands behind a number that ends at `end`; a comma before another number is passed over. */
static const char *behind(const char *end, bool more) {
    end += strspn(end, " \t");
    return *end == ',' && more ? end + 1 : end;
}

bool hp_cli_numbers(const char *text, double *numbers, size_t n) {
    for (size_t i = 0; i < n; i++) {
        char *end;
        numbers[i] = strtod(text, &end);
        if (end == text) return false;
        text = behind(end, i + 1 < n);
    }
    return *text == 0;
}

bool hp_cli_floats(const char *text, float *numbers, size_t n) {
    for (size_t i = 0; i < n; i++) {
        char *end;
        numbers[i] = strtof(text, &end);
        if (end == text) return false;
        text = behind(end, i + 1 < n);
    }
    return *text == 0;
}

hp_separation hp_cli_separation(const char *text, struct argp_state *state) {
    bool on = strcmp(text, "on") == 0;
    if (!on && strcmp(text, "off") != 0) argp_error(state, "--separation is on or off, not '%s'", text);
    return on ? HP_SEPARATION_ON : HP_SEPARATION_OFF;
}

bool hp_cli_pair(const char *text, size_t most, size_t *first, size_t *second) {
    const char *end = digits(text, most, first);
    return end && *end == 'x' && hp_cli_whole(end + 1, most, second) && *first > 0 && *second > 0;
}

const char *hp_cli_count(uint64_t count, char text[HP_COUNT_TEXT]) {
    char digits[24];
    int n = snprintf(digits, sizeof digits, "%" PRIu64, count), at = 0;
    for (int i = 0; i < n; i++) {
        if (i > 0 && (n - i) % 3 == 0) text[at++] = ',';
        text[at++] = digits[i];
    }
    text[at] = 0;
    return text;
}
