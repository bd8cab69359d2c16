#include "server.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <hitpipe/pipe.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
    ADDRESS_TEXT = 80,
    BACKLOG = 32,
    PIECES = 64,       /* read, or written, for one client before the next has its turn */
    RUNS = 64,         /* steps of one board before the next has its turn */
    PAUSE_MS = 1000,   /* before accepting again when there are no file descriptors left */
    ALIVE_SECONDS = 30 /* of silence before the system asks whether a client is still there */
};

typedef struct connection {
    int fd; /* -1: free */
    hp_usbip_client *client;
    char name[ADDRESS_TEXT];
    uint64_t since;    /* milliseconds: when it last went on */
    uint64_t messages; /* by then */
    bool announced;    /* its board was told of */
} connection;

enum { POLL_STOP, POLL_LISTEN, POLL_CONNECTIONS };

struct hp_usbip_server {
    hp_usbip_export exports[HP_USBIP_BOARDS];
    size_t export_count;
    hp_usbip_limits limits;
    hp_usbip_log *log;
    void *log_context;
    bool once, ended;
    int stop[2], listener;
    char address[ADDRESS_TEXT];
    unsigned port;
    uint64_t accept_again; /* milliseconds; 0: now */
    bool busy;             /* a board has more to do */
    connection *connections;
    struct pollfd *polled;
    size_t room; /* connections: one for each board, and the guests */
};

static uint64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

__attribute__((format(printf, 2, 3))) static void say(const hp_usbip_server *server, const char *format, ...) {
    char text[300];
    va_list arguments;
    if (!server->log) return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    server->log(server->log_context, text);
}

/* ---- listening ---- */

static void name_address(const struct sockaddr *address, socklen_t bytes, char text[ADDRESS_TEXT], unsigned *port) {
    char host[INET6_ADDRSTRLEN + 20] = "?", service[8] = "0";
    getnameinfo(address, bytes, host, sizeof host, service, sizeof service, NI_NUMERICHOST | NI_NUMERICSERV);
    bool six = address->sa_family == AF_INET6;
    snprintf(text, ADDRESS_TEXT, six ? "[%s]:%s" : "%s:%s", host, service);
    *port = (unsigned)strtoul(service, NULL, 10);
}

static bool listen_at(hp_usbip_server *server, const struct addrinfo *at) {
    struct sockaddr_storage own;
    socklen_t bytes = sizeof own;
    const int yes = 1;
    server->listener = socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, at->ai_protocol);
    if (server->listener < 0) return false;
    setsockopt(server->listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (bind(server->listener, at->ai_addr, at->ai_addrlen) == 0 && listen(server->listener, BACKLOG) == 0 &&
        getsockname(server->listener, (struct sockaddr *)&own, &bytes) == 0) {
        name_address((const struct sockaddr *)&own, bytes, server->address, &server->port);
        return true;
    }
    int cause = errno;
    close(server->listener);
    server->listener = -1;
    errno = cause;
    return false;
}

static hp_status start_listening(hp_usbip_server *server, const hp_usbip_def *def, char *why) {
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE | AI_NUMERICSERV};
    const char *address = def->address ? def->address : "127.0.0.1";
    struct addrinfo *found = NULL;
    char service[12], cause[80];
    snprintf(service, sizeof service, "%u", def->port);
    int error = def->port > UINT16_MAX ? EAI_SERVICE : getaddrinfo(address, service, &hints, &found);
    if (error) {
        snprintf(why, HP_USBIP_MESSAGE, "no address %.60s, port %u: %s", address, def->port, gai_strerror(error));
        return HP_ERROR_USAGE;
    }
    const struct addrinfo *at = found;
    while (at && !listen_at(server, at)) at = at->ai_next;
    if (!at)
        snprintf(why, HP_USBIP_MESSAGE, "cannot listen on %.60s, port %u: %s", address, def->port,
                 strerror_r(errno, cause, sizeof cause));
    freeaddrinfo(found);
    return at ? HP_OK : HP_ERROR_IO;
}

/* ---- create, destroy ---- */

static hp_status check_boards(const hp_usbip_def *def, char *why) {
    if (def->count < 1 || def->count > HP_USBIP_BOARDS) {
        snprintf(why, HP_USBIP_MESSAGE, "%zu boards: there may be 1 to %d", def->count, HP_USBIP_BOARDS);
        return HP_ERROR_USAGE;
    }
    for (size_t i = 0; i < def->count; i++)
        for (size_t k = 0; k < i; k++) {
            const char *one = def->gadgets[i].serial, *other = def->gadgets[k].serial;
            if (!one || !other || strcmp(one, other) != 0) continue;
            snprintf(why, HP_USBIP_MESSAGE, "two boards with serial number %.20s", one);
            return HP_ERROR_USAGE;
        }
    return HP_OK;
}

static void say_why(const hp_gadget_def *def, hp_status status, char *why) {
    bool isa = hp_isa_choose(def->board.isa) != NULL;
    if (!isa)
        snprintf(why, HP_USBIP_MESSAGE, "the instruction set %.20s is not to be had here",
                 def->board.isa ? def->board.isa : getenv("HP_ISA"));
    else if (status == HP_ERROR_USAGE)
        snprintf(why, HP_USBIP_MESSAGE, "serial number \"%.20s\": 1 to 12 ASCII characters, no blanks",
                 def->serial ? def->serial : "");
    else
        snprintf(why, HP_USBIP_MESSAGE, "cannot make the board: %s", hp_status_text(status));
}

static hp_status make_boards(hp_usbip_server *server, const hp_usbip_def *def, char *why) {
    for (size_t i = 0; i < def->count; i++) {
        hp_usbip_export *made = &server->exports[i];
        hp_status status = hp_gadget_create(&def->gadgets[i], &made->gadget);
        if (status) {
            say_why(&def->gadgets[i], status, why);
            return status;
        }
        made->place.busnum = 1;
        made->place.devnum = (unsigned)i + 2; /* 1 is the hub's */
        snprintf(made->place.busid, sizeof made->place.busid, "1-%zu", i + 1);
        server->export_count++;
    }
    return HP_OK;
}

static hp_status make_room(hp_usbip_server *server, char *why) {
    server->room = server->export_count + server->limits.guests;
    server->connections = malloc(server->room * sizeof *server->connections);
    server->polled = malloc((POLL_CONNECTIONS + server->room) * sizeof *server->polled);
    if (!server->connections || !server->polled) {
        server->room = 0;
        snprintf(why, HP_USBIP_MESSAGE, "%s", hp_status_text(HP_ERROR_MEMORY));
        return HP_ERROR_MEMORY;
    }
    for (size_t i = 0; i < server->room; i++) server->connections[i] = (connection){.fd = -1};
    if (pipe2(server->stop, O_CLOEXEC | O_NONBLOCK) == 0) return HP_OK;
    snprintf(why, HP_USBIP_MESSAGE, "no pipe to be had from the system");
    return HP_ERROR_IO;
}

hp_status hp_usbip_create(const hp_usbip_def *def, hp_usbip_server **server, char *why) {
    *server = NULL;
    hp_status status = check_boards(def, why);
    if (status) return status;
    hp_usbip_server *made = calloc(1, sizeof *made);
    if (!made) {
        snprintf(why, HP_USBIP_MESSAGE, "%s", hp_status_text(HP_ERROR_MEMORY));
        return HP_ERROR_MEMORY;
    }
    made->stop[0] = made->stop[1] = made->listener = -1;
    made->limits = def->limits;
    made->log = def->log;
    made->log_context = def->log_context;
    made->once = def->once;
    status = make_boards(made, def, why);
    if (!status) status = make_room(made, why);
    if (!status) status = start_listening(made, def, why);
    if (status)
        hp_usbip_destroy(made);
    else
        *server = made;
    return status;
}

static void close_connection(connection *at) {
    hp_usbip_client_destroy(at->client);
    close(at->fd);
    *at = (connection){.fd = -1};
}

void hp_usbip_destroy(hp_usbip_server *server) {
    if (!server) return;
    for (size_t i = 0; i < server->room; i++)
        if (server->connections[i].fd >= 0) close_connection(&server->connections[i]);
    for (size_t i = 0; i < server->export_count; i++) hp_gadget_destroy(server->exports[i].gadget);
    for (unsigned i = 0; i < 2; i++)
        if (server->stop[i] >= 0) close(server->stop[i]);
    if (server->listener >= 0) close(server->listener);
    free(server->connections);
    free(server->polled);
    free(server);
}

/* ---- clients come ---- */

static size_t guests(const hp_usbip_server *server) {
    size_t n = 0;
    for (size_t i = 0; i < server->room; i++) {
        const connection *at = &server->connections[i];
        n += at->fd >= 0 && !hp_usbip_client_board(at->client);
    }
    return n;
}

/* Replies are small and awaited; and a client whose machine is gone must not keep its board for ever. */
static void prepare_socket(int fd) {
    const int yes = 1, seconds = ALIVE_SECONDS;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
    setsockopt(fd, IPPROTO_TCP, TCP_KEEPIDLE, &seconds, sizeof seconds);
    setsockopt(fd, IPPROTO_TCP, TCP_KEEPINTVL, &seconds, sizeof seconds);
}

static void accept_client(hp_usbip_server *server) {
    struct sockaddr_storage peer;
    socklen_t bytes = sizeof peer;
    unsigned port;
    connection *at = server->connections;
    int fd = accept4(server->listener, (struct sockaddr *)&peer, &bytes, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) {
        bool gone = errno == EAGAIN || errno == EINTR || errno == ECONNABORTED;
        if (!gone) server->accept_again = now_ms() + PAUSE_MS;
        return;
    }
    while (at->fd >= 0) at++; /* there is room, or nobody would have been accepted */
    hp_usbip_client *client = hp_usbip_client_create(server->exports, server->export_count, &server->limits);
    if (!client) {
        close(fd);
        return;
    }
    prepare_socket(fd);
    *at = (connection){.fd = fd, .client = client, .since = now_ms()};
    name_address((const struct sockaddr *)&peer, bytes, at->name, &port);
}

/* ---- and go ---- */

/* What is said of a client that never asked for anything would fill logs. */
static void end_connection(hp_usbip_server *server, connection *at, const char *why) {
    const hp_usbip_export *board = hp_usbip_client_board(at->client);
    if (board)
        say(server, "%s: detached from %s (%s): %s", at->name, board->place.busid, hp_gadget_serial(board->gadget),
            why);
    else if (hp_usbip_client_fault(at->client))
        say(server, "%s: ended: %s", at->name, why);
    if (board && server->once) server->ended = true;
    close_connection(at);
}

static bool is_patient(const hp_usbip_server *server, const connection *at, uint64_t now) {
    if (!hp_usbip_client_board(at->client)) return now < at->since + server->limits.handshake_ms;
    return hp_usbip_client_rests(at->client) || now < at->since + server->limits.stuck_ms;
}

/* ---- bytes ---- */

static bool would_wait(void) {
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

/* False: the client is gone. */
static bool read_some(connection *at, bool *moved) {
    for (unsigned i = 0; i < PIECES; i++) {
        uint8_t *to;
        size_t n = hp_usbip_client_wants(at->client, &to);
        if (n == 0) return true;
        ssize_t got = recv(at->fd, to, n, 0);
        if (got < 0) return would_wait();
        if (got == 0) return false;
        hp_usbip_client_got(at->client, (size_t)got);
        *moved = true;
    }
    return true;
}

static bool write_some(connection *at, bool *moved) {
    for (unsigned i = 0; i < PIECES; i++) {
        const uint8_t *from;
        bool more;
        size_t n = hp_usbip_client_has(at->client, &from, &more);
        if (n == 0) return true;
        ssize_t sent = send(at->fd, from, n, MSG_NOSIGNAL | (more ? MSG_MORE : 0));
        if (sent < 0) return would_wait();
        hp_usbip_client_sent(at->client, (size_t)sent);
        *moved = true;
    }
    return true;
}

/* True: there is more to do for it at once. */
static bool run_board(connection *at) {
    bool more = true;
    for (unsigned i = 0; i < RUNS && more; i++) more = hp_usbip_client_run(at->client);
    return more;
}

/* A guest goes on when it has asked for something, a client with a board with every byte. */
static void note_time(connection *at, bool moved, uint64_t now) {
    uint64_t messages = hp_usbip_client_messages(at->client);
    bool guest = !hp_usbip_client_board(at->client);
    if (guest ? messages != at->messages : moved || hp_usbip_client_rests(at->client)) at->since = now;
    at->messages = messages;
}

static void announce(const hp_usbip_server *server, connection *at) {
    const hp_usbip_export *board = hp_usbip_client_board(at->client);
    if (!board || at->announced) return;
    at->announced = true;
    say(server, "%s: attached to %s (%s)", at->name, board->place.busid, hp_gadget_serial(board->gadget));
}

static void serve_connection(hp_usbip_server *server, connection *at, bool readable) {
    bool moved = false, there = !readable || read_some(at, &moved);
    announce(server, at);
    if (there) server->busy |= run_board(at);
    there = write_some(at, &moved) && there; /* who has said all that it wants may still listen */
    uint64_t now = now_ms();
    note_time(at, moved, now);
    const char *fault = hp_usbip_client_fault(at->client);
    if (fault)
        end_connection(server, at, fault);
    else if (!there)
        end_connection(server, at, "the client has closed the connection");
    else if (!is_patient(server, at, now))
        end_connection(server, at, "the client does not go on");
}

/* ---- the loop ---- */

static bool accepts(hp_usbip_server *server, uint64_t now) {
    if (server->accept_again && now < server->accept_again) return false;
    server->accept_again = 0;
    return guests(server) < server->limits.guests;
}

static short events_wanted(const connection *at) {
    const uint8_t *from;
    uint8_t *to;
    bool more;
    return (short)((hp_usbip_client_wants(at->client, &to) ? POLLIN : 0) |
                   (hp_usbip_client_has(at->client, &from, &more) ? POLLOUT : 0));
}

static void sooner(int *timeout, uint64_t at, uint64_t now) {
    uint64_t left = at > now ? at - now : 0;
    if (*timeout < 0 || left < (uint64_t)*timeout) *timeout = left < INT32_MAX ? (int)left : INT32_MAX;
}

/* Fills server->polled; returns how long to wait, in milliseconds, or -1. */
static int plan(hp_usbip_server *server) {
    uint64_t now = now_ms();
    int timeout = server->busy ? 0 : -1;
    server->polled[POLL_STOP] = (struct pollfd){.fd = server->stop[0], .events = POLLIN};
    server->polled[POLL_LISTEN] =
        (struct pollfd){.fd = accepts(server, now) ? server->listener : -1, .events = POLLIN};
    if (server->accept_again) sooner(&timeout, server->accept_again, now);
    for (size_t i = 0; i < server->room; i++) {
        const connection *at = &server->connections[i];
        server->polled[POLL_CONNECTIONS + i] = (struct pollfd){.fd = at->fd};
        if (at->fd < 0) continue;
        server->polled[POLL_CONNECTIONS + i].events = events_wanted(at);
        bool guest = !hp_usbip_client_board(at->client);
        if (guest || !hp_usbip_client_rests(at->client))
            sooner(&timeout, at->since + (guest ? server->limits.handshake_ms : server->limits.stuck_ms), now);
    }
    return timeout;
}

hp_status hp_usbip_serve(hp_usbip_server *server) {
    while (!server->ended) {
        int timeout = plan(server);
        int n = poll(server->polled, POLL_CONNECTIONS + server->room, timeout);
        if (n < 0 && errno != EINTR) return HP_ERROR_IO;
        if (n < 0) continue;
        if (server->polled[POLL_STOP].revents) break;
        server->busy = false;
        for (size_t i = 0; i < server->room; i++)
            if (server->connections[i].fd >= 0)
                serve_connection(server, &server->connections[i],
                                 server->polled[POLL_CONNECTIONS + i].revents & (POLLIN | POLLERR | POLLHUP));
        if (server->polled[POLL_LISTEN].revents) accept_client(server);
    }
    return HP_OK;
}

void hp_usbip_stop(hp_usbip_server *server) {
    int cause = errno;
    ssize_t ignored = write(server->stop[1], "", 1); /* full: it is told already */
    (void)ignored;
    errno = cause;
}

/* ---- what there is ---- */

const char *hp_usbip_address(const hp_usbip_server *server) {
    return server->address;
}

unsigned hp_usbip_port(const hp_usbip_server *server) {
    return server->port;
}

const char *hp_usbip_busid(const hp_usbip_server *server, size_t i) {
    return i < server->export_count ? server->exports[i].place.busid : NULL;
}
