/* A client of the USB/IP server: the bytes it sends and gets, and the board that it has imported. Knows no socket:
 * the server asks where the next bytes go and what is to be sent.
 *
 *   bytes --> ops --> import --> urbs --> gadget --> replies --> bytes
 *
 * Whatever comes, memory stays within the limits: who has more urbs pending is ended; who does not fetch replies is
 * not listened to until it does. One thread at a time. */
#ifndef HITPIPE_USBIP_CLIENT_H
#define HITPIPE_USBIP_CLIENT_H

#include "wire.h"

typedef struct hp_usbip_client hp_usbip_client;

/* A board that clients may import, one at a time. */
typedef struct hp_usbip_export {
    hp_gadget *gadget;
    hp_usbip_place place;
    hp_usbip_client *user; /* NULL: free */
} hp_usbip_export;

typedef struct hp_usbip_limits {
    size_t urb_bytes;      /* of one urb */
    unsigned urbs;         /* pending, and replies not sent */
    size_t bytes;          /* of urbs pending, and of replies not sent */
    unsigned guests;       /* connections that have imported no board */
    unsigned handshake_ms; /* for a connection to ask for something */
    unsigned stuck_ms;     /* for the rest of a message to come, or a reply to be fetched */
} hp_usbip_limits;

/* 1 MiB, 2048 urbs, 32 MiB, 16 connections, 10 seconds, 60 seconds. */
hp_usbip_limits hp_usbip_default_limits(void);

/* NULL: out of memory. Exports and limits stay the caller's, until the client is destroyed. */
hp_usbip_client *hp_usbip_client_create(hp_usbip_export *exports, size_t count, const hp_usbip_limits *limits);

/* Resets the board that the client had, and sets it free. */
void hp_usbip_client_destroy(hp_usbip_client *client);

/* Where the next bytes of the client go, and how many; 0: none now. Tell how many came. */
size_t hp_usbip_client_wants(hp_usbip_client *client, uint8_t **to);
void hp_usbip_client_got(hp_usbip_client *client, size_t n);

/* The next bytes for the client; 0: none now. Tell how many were sent. `more`: others follow at once. */
size_t hp_usbip_client_has(const hp_usbip_client *client, const uint8_t **from, bool *more);
void hp_usbip_client_sent(hp_usbip_client *client, size_t n);

/* Carries the client's board on. False: nothing can happen before more bytes come. */
bool hp_usbip_client_run(hp_usbip_client *client);

/* What the client did that ends it, or NULL. Nothing but destroy is of use then. */
const char *hp_usbip_client_fault(const hp_usbip_client *client);

/* The board it has imported, or NULL; whole messages that came; whether there is neither half a message nor a reply
 * that waits. */
const hp_usbip_export *hp_usbip_client_board(const hp_usbip_client *client);
uint64_t hp_usbip_client_messages(const hp_usbip_client *client);
bool hp_usbip_client_rests(const hp_usbip_client *client);

#endif
