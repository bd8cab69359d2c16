/* hitpipe serve: the simulated board as a USB device over USB/IP, for this PC or another. */
#include "driver/usbip/server.h"
#include "host/cli/cli.h"
#include "host/output/file.h"
#include "host/output/report.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_LISTEN = 'l', KEY_PORT = 'p', KEY_SERIAL = 's', KEY_COUNT = 'c', KEY_SPEED = 0x100, KEY_ONCE };

typedef struct serve_options {
    hp_cli cli;
    hp_usbip_def def;
    hp_usb_speed speed;
    const char *serials[HP_USBIP_BOARDS];
    size_t serial_count, count;
} serve_options;

static const struct argp_option option_table[] = {
    {"listen", KEY_LISTEN, "ADDRESS", 0, "where clients reach the server (default 127.0.0.1: this machine alone)", 1},
    {"port", KEY_PORT, "N", 0, "its TCP port (default 3240); 0: any that is free", 1},
    {"serial", KEY_SERIAL, "S", 0, "serial number of a board, 1 to 12 characters; again for another board", 1},
    {"count", KEY_COUNT, "N", 0, "so many boards, with serial numbers HP-000001 and on (default 1)", 1},
    {"speed", KEY_SPEED, "high|super", 0, "high speed or SuperSpeed (default super)", 1},
    {"once", KEY_ONCE, NULL, 0, "end when the first client that attached a board is gone", 1},
    {0},
};

/* ---- options ---- */

static size_t number(const char *text, const char *option, size_t least, size_t most, struct argp_state *state) {
    size_t n;
    if (!hp_cli_whole(text, most, &n) || n < least)
        argp_error(state, "--%s takes a number from %zu to %zu, not '%s'", option, least, most, text);
    return n;
}

static void add_serial(serve_options *serve, const char *serial, struct argp_state *state) {
    if (serve->serial_count == HP_USBIP_BOARDS) argp_error(state, "at most %d boards", HP_USBIP_BOARDS);
    serve->serials[serve->serial_count++] = serial;
}

static void set_speed(serve_options *serve, const char *text, struct argp_state *state) {
    bool high = strcmp(text, "high") == 0;
    if (!high && strcmp(text, "super") != 0) argp_error(state, "--speed is high or super, not '%s'", text);
    serve->speed = high ? HP_USB_HIGH : HP_USB_SUPER;
}

/* What a board that others use cannot have. */
static void check(const serve_options *serve, struct argp_state *state) {
    const hp_cli *cli = &serve->cli;
    if (serve->count && serve->serial_count) argp_error(state, "--count and --serial exclude each other");
    if (cli->device.target && strcmp(cli->device.target, "model") != 0)
        argp_error(state, "serve has the simulated board behind it: no --target");
    if (cli->report || cli->vcd_path) argp_error(state, "serve writes neither --report nor --vcd");
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    serve_options *serve = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &serve->cli;
        return 0;
    case KEY_LISTEN:
        serve->def.address = argument;
        return 0;
    case KEY_PORT:
        serve->def.port = (unsigned)number(argument, "port", 0, UINT16_MAX, state);
        return 0;
    case KEY_SERIAL:
        add_serial(serve, argument, state);
        return 0;
    case KEY_COUNT:
        serve->count = number(argument, "count", 1, HP_USBIP_BOARDS, state);
        return 0;
    case KEY_SPEED:
        set_speed(serve, argument, state);
        return 0;
    case KEY_ONCE:
        serve->def.once = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "serve takes no argument, but here is '%s'", argument);
        return 0;
    case ARGP_KEY_END:
        check(serve, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&hp_cli_argp, 0, "Board and output:", 90}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc =
        "Presents simulated boards as USB devices over USB/IP, until it is interrupted.\vA Linux PC attaches one "
        "with\n"
        "`usbip attach -r ADDRESS -b 1-1', and has it like a board at its own port. One client at a time has a "
        "board; "
        "others may have other boards. USB/IP knows no passwords: listen to others only in a network that you trust.",
    .children = children,
};

/* ---- boards ---- */

typedef struct boards {
    hp_gadget_def gadgets[HP_USBIP_BOARDS];
    char serials[HP_USBIP_BOARDS][24]; /* of those that were only counted */
    size_t count;
} boards;

static void make_boards(boards *made, const serve_options *serve) {
    const hp_device_def *device = &serve->cli.device;
    made->count = serve->serial_count ? serve->serial_count : serve->count ? serve->count : 1;
    for (size_t i = 0; i < made->count; i++) {
        snprintf(made->serials[i], sizeof made->serials[i], "HP-%06zu", i + 1);
        made->gadgets[i] = (hp_gadget_def){
            .board = {.config = device->board,
                      .engine = device->clocked ? HP_ENGINE_CLOCKED : HP_ENGINE_QUICK,
                      .isa = device->isa,
                      .threads = device->threads},
            .serial = serve->serial_count ? serve->serials[i] : made->serials[i],
            .speed = serve->speed,
            .vendor = device->usb_vendor,
            .product = device->usb_product,
        };
    }
}

/* ---- what a person is told ---- */

static void print_line(void *context, const char *text) {
    fprintf(stderr, "%s: %s\n", (const char *)context, text);
}

static const char *speed_name(hp_usb_speed speed) {
    return speed == HP_USB_SUPER ? "super" : "high";
}

static hp_status show_json(const hp_usbip_server *server, const boards *made, hp_fault *fault) {
    json_t *list = json_array();
    for (size_t i = 0; i < made->count; i++)
        json_array_append_new(list, json_pack("{s:s, s:s, s:s}", "busid", hp_usbip_busid(server, i), "serial",
                                              made->gadgets[i].serial, "speed", speed_name(made->gadgets[i].speed)));
    json_t *json = json_pack("{s:s, s:I, s:o}", "address", hp_usbip_address(server), "port",
                             (json_int_t)hp_usbip_port(server), "boards", list);
    hp_status status = hp_report_write(json, "-", fault);
    json_decref(json);
    return status;
}

static hp_status show(const hp_usbip_server *server, const serve_options *serve, const boards *made,
                      hp_fault *fault) {
    if (serve->cli.json) return show_json(server, made, fault);
    printf("serving on %s\n", hp_usbip_address(server));
    for (size_t i = 0; i < made->count; i++)
        printf("%s  %s, %s\n", hp_usbip_busid(server, i), made->gadgets[i].serial,
               made->gadgets[i].speed == HP_USB_SUPER ? "SuperSpeed" : "high speed");
    return fflush(stdout) == 0 ? HP_OK : hp_fault_set(fault, HP_ERROR_IO, "cannot write to standard output");
}

/* ---- serving ---- */

static hp_usbip_server *interrupted; /* for the signal handler, which can be told nothing */

static void interrupt(int signal) {
    (void)signal;
    hp_usbip_stop(interrupted);
}

static void stop_on_signals(hp_usbip_server *server) {
    struct sigaction action = {.sa_handler = interrupt};
    interrupted = server;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

static void leave_signals(void) {
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
}

static hp_status serve_boards(serve_options *serve, hp_fault *fault) {
    static boards made; /* large */
    char why[HP_USBIP_MESSAGE];
    hp_usbip_server *server;
    make_boards(&made, serve);
    serve->def.gadgets = made.gadgets;
    serve->def.count = made.count;
    hp_status status = hp_usbip_create(&serve->def, &server, why);
    if (status) return hp_fault_set(fault, status, "%s", why);
    stop_on_signals(server);
    status = show(server, serve, &made, fault);
    if (status == HP_OK && (status = hp_usbip_serve(server)) != HP_OK)
        hp_fault_set(fault, status, "the system does not let the server wait for its clients");
    leave_signals();
    hp_usbip_destroy(server);
    return status;
}

int hp_verb_serve(int argc, char **argv) {
    serve_options serve = {.cli = hp_cli_begin(argv[0]), .speed = HP_USB_SUPER};
    serve.def = (hp_usbip_def){
        .port = HP_USBIP_PORT, .limits = hp_usbip_default_limits(), .log = print_line, .log_context = argv[0]};
    argp_parse(&argp, argc, argv, 0, NULL, &serve);
    hp_fault fault = {0};
    hp_status status = serve_boards(&serve, &fault);
    return hp_cli_end(&serve.cli, status, &fault);
}
