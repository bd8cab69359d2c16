/* The USB/IP server: simulated boards that any Linux PC attaches as USB devices (`usbip attach`). Sockets and time;
 * what the bytes mean is the matter of client.h.
 *
 * One thread runs the server and all its boards; only hp_usbip_stop may be called from elsewhere. A client that sends
 * what it must not is ended, and nobody else notices. Not part of the public interface. */
#ifndef HITPIPE_USBIP_SERVER_H
#define HITPIPE_USBIP_SERVER_H

#include "client.h"

enum { HP_USBIP_PORT = 3240, HP_USBIP_BOARDS = 64, HP_USBIP_MESSAGE = 200 };

typedef struct hp_usbip_server hp_usbip_server;

/* Takes a line of text, without its end. */
typedef void hp_usbip_log(void *context, const char *text);

typedef struct hp_usbip_def {
    const hp_gadget_def *gadgets; /* 1 to HP_USBIP_BOARDS, no two of the same serial; copied */
    size_t count;
    const char *address; /* NULL: loopback */
    unsigned port;       /* 0: any that is free */
    bool once;           /* ends when the first client that imported a board is gone */
    hp_usbip_limits limits;
    hp_usbip_log *log; /* NULL: nobody listens */
    void *log_context;
} hp_usbip_def;

/* Makes the boards and listens. On error `why` (HP_USBIP_MESSAGE bytes) has the cause in words: HP_ERROR_USAGE (no
 * such address, too many boards, a serial that is none or twice there), HP_ERROR_IO (the port is taken, or not
 * allowed), HP_ERROR_MEMORY, or what hp_board_create says. */
hp_status hp_usbip_create(const hp_usbip_def *def, hp_usbip_server **server, char *why);

/* Ends all connections. */
void hp_usbip_destroy(hp_usbip_server *server);

/* "127.0.0.1:3240", the port alone, and where board number i is ("1-1"); NULL past the last. */
const char *hp_usbip_address(const hp_usbip_server *server);
unsigned hp_usbip_port(const hp_usbip_server *server);
const char *hp_usbip_busid(const hp_usbip_server *server, size_t i);

/* Serves until hp_usbip_stop, or `once` is fulfilled: HP_OK. HP_ERROR_IO: the system does not let it wait. */
hp_status hp_usbip_serve(hp_usbip_server *server);

/* Makes hp_usbip_serve return. From any thread, or a signal handler. */
void hp_usbip_stop(hp_usbip_server *server);

#endif
