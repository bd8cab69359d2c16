#include "client.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An urb of the client, and then the reply to it; or a reply alone. */
typedef struct message {
    struct message *next;
    hp_usbip_client *client;
    uint32_t seqnum;
    bool in, short_not_ok;
    bool forgotten; /* its urb was unlinked: there is no reply */
    hp_urb urb;
    size_t head_bytes; /* of the reply */
    uint8_t head[HP_USBIP_URB_BYTES];
    size_t bytes_used; /* bytes of the urb that came, or bytes behind the reply's head */
    size_t room;
    uint8_t bytes[];
} message;

typedef struct fifo {
    message *first, **end;
    unsigned count;
    size_t bytes; /* of memory */
} fifo;

struct hp_usbip_client {
    hp_usbip_export *exports;
    size_t export_count;
    const hp_usbip_limits *limits;
    hp_usbip_export *board;
    uint64_t messages;
    uint8_t head[HP_USBIP_URB_BYTES]; /* of the message that is coming in */
    size_t head_got, head_bytes;
    message *filling; /* an urb whose bytes are coming in */
    fifo pending;     /* urbs that the gadget has */
    fifo replies;
    size_t sent; /* bytes of the first reply */
    char fault[120];
};

hp_usbip_limits hp_usbip_default_limits(void) {
    return (hp_usbip_limits){1 << 20, 2048, 32 << 20, 16, 10000, 60000};
}

__attribute__((format(printf, 2, 3))) static void end(hp_usbip_client *client, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(client->fault, sizeof client->fault, format, arguments);
    va_end(arguments);
}

/* ---- messages ---- */

static message *new_message(hp_usbip_client *client, size_t room) {
    message *made = malloc(sizeof *made + room);
    if (made)
        *made = (message){.client = client, .room = room};
    else
        end(client, "out of memory for %zu bytes", room);
    return made;
}

static size_t memory_of(const message *m) {
    return sizeof *m + m->room;
}

static void append(fifo *list, message *m) {
    m->next = NULL;
    *list->end = m;
    list->end = &m->next;
    list->count++;
    list->bytes += memory_of(m);
}

static void take_out(fifo *list, message *m) {
    message **at = &list->first;
    while (*at != m) at = &(*at)->next;
    *at = m->next;
    if (!m->next) list->end = at;
    list->count--;
    list->bytes -= memory_of(m);
}

static message *find(const fifo *list, uint32_t seqnum) {
    message *m = list->first;
    while (m && m->seqnum != seqnum) m = m->next;
    return m;
}

static void reply_op(hp_usbip_client *client, message *m, hp_usbip_code code, hp_usbip_outcome outcome) {
    hp_usbip_write_op(m->head, code, outcome);
    m->head_bytes = HP_USBIP_OP_BYTES;
    append(&client->replies, m);
}

/* ---- list and import ---- */

static size_t listed_bytes(const hp_usbip_export *board) {
    return HP_USBIP_DEVICE_BYTES + (size_t)hp_usbip_interfaces(board->gadget) * HP_USBIP_INTERFACE_BYTES;
}

static void list_boards(hp_usbip_client *client) {
    size_t room = HP_USBIP_COUNT_BYTES;
    for (size_t i = 0; i < client->export_count; i++) room += listed_bytes(&client->exports[i]);
    message *m = new_message(client, room);
    if (!m) return;
    uint8_t *at = m->bytes + HP_USBIP_COUNT_BYTES;
    hp_usbip_write_count(m->bytes, (uint32_t)client->export_count);
    for (size_t i = 0; i < client->export_count; i++) {
        const hp_usbip_export *board = &client->exports[i];
        hp_usbip_write_device(at, board->gadget, &board->place);
        at += HP_USBIP_DEVICE_BYTES;
        for (unsigned k = 0; k < hp_usbip_interfaces(board->gadget); k++, at += HP_USBIP_INTERFACE_BYTES)
            hp_usbip_write_interface(at, board->gadget, k);
    }
    m->bytes_used = room;
    reply_op(client, m, HP_OP_REP_DEVLIST, HP_USBIP_OK);
}

static hp_usbip_export *board_at(const hp_usbip_client *client, const uint8_t *busid) {
    for (size_t i = 0; i < client->export_count; i++)
        if (strncmp(client->exports[i].place.busid, (const char *)busid, HP_USBIP_BUSID_BYTES) == 0)
            return &client->exports[i];
    return NULL;
}

static void import_board(hp_usbip_client *client, const uint8_t *busid) {
    hp_usbip_export *board = board_at(client, busid);
    hp_usbip_outcome outcome = !board ? HP_USBIP_NO_DEVICE : board->user ? HP_USBIP_BUSY : HP_USBIP_OK;
    message *m = new_message(client, outcome == HP_USBIP_OK ? HP_USBIP_DEVICE_BYTES : 0);
    if (!m) return;
    m->bytes_used = m->room;
    if (outcome == HP_USBIP_OK) {
        hp_usbip_write_device(m->bytes, board->gadget, &board->place);
        client->board = board;
        board->user = client;
    }
    reply_op(client, m, HP_OP_REP_IMPORT, outcome);
}

static void take_op(hp_usbip_client *client) {
    hp_usbip_op op = hp_usbip_read_op(client->head);
    if (op.version != HP_USBIP_VERSION) {
        end(client, "USB/IP version %04x, not %04x", op.version, HP_USBIP_VERSION);
    } else if (op.status != 0) {
        end(client, "a request with status %u", op.status);
    } else if (op.code == HP_OP_REQ_IMPORT && client->head_bytes == HP_USBIP_OP_BYTES) {
        client->head_bytes = HP_USBIP_IMPORT_BYTES; /* the bus id is still to come */
        return;
    } else if (op.code == HP_OP_REQ_IMPORT) {
        import_board(client, client->head + HP_USBIP_OP_BYTES);
    } else if (op.code == HP_OP_REQ_DEVLIST) {
        list_boards(client);
    } else {
        end(client, "request %04x", op.code);
    }
    client->head_got = 0;
    client->head_bytes = client->board ? HP_USBIP_URB_BYTES : HP_USBIP_OP_BYTES;
    client->messages++;
}

/* ---- urbs ---- */

/* An urb that is over becomes its own reply. */
static void done(hp_urb *urb) {
    message *m = urb->owner;
    hp_usbip_client *client = m->client;
    take_out(&client->pending, m);
    if (m->forgotten) {
        free(m);
        return;
    }
    bool cut = m->in && m->short_not_ok && urb->moved < urb->length;
    hp_usbip_write_return(m->head, HP_RET_SUBMIT, m->seqnum, hp_usbip_status(urb->status, cut), (uint32_t)urb->moved);
    m->head_bytes = HP_USBIP_URB_BYTES;
    m->bytes_used = m->in ? urb->moved : 0;
    append(&client->replies, m);
}

static void submit(hp_usbip_client *client, message *m) {
    client->filling = NULL;
    client->messages++;
    append(&client->pending, m);
    hp_gadget_submit(client->board->gadget, &m->urb);
}

/* The direction that an urb has on the wire must be the one that the device sees. */
static bool directions_agree(const hp_usbip_urb *urb) {
    return urb->endpoint != 0 || urb->length == 0 || (urb->setup[0] >> 7) == urb->direction;
}

static bool fits(hp_usbip_client *client, const hp_usbip_urb *urb) {
    enum { ENDPOINTS = 16, NO_PACKETS = -1 };
    const hp_usbip_limits *limits = client->limits;
    if (urb->endpoint >= ENDPOINTS)
        end(client, "endpoint %u", urb->endpoint);
    else if (urb->packets != 0 && urb->packets != (uint32_t)NO_PACKETS)
        end(client, "an isochronous urb of %u packets", urb->packets);
    else if (urb->length > limits->urb_bytes)
        end(client, "an urb of %u bytes: at most %zu", urb->length, limits->urb_bytes);
    else if (!directions_agree(urb))
        end(client, "a control request that is no request of its direction");
    else if (client->pending.count >= limits->urbs)
        end(client, "more than %u urbs pending", limits->urbs);
    else if (client->pending.bytes + sizeof(message) + urb->length > limits->bytes)
        end(client, "more than %zu bytes of urbs pending", limits->bytes);
    else if (find(&client->pending, urb->seqnum))
        end(client, "two urbs with number %u", urb->seqnum);
    return !client->fault[0];
}

static void take_submit(hp_usbip_client *client, const hp_usbip_urb *urb) {
    if (!fits(client, urb)) return;
    message *m = new_message(client, urb->length);
    if (!m) return;
    m->in = urb->direction;
    m->seqnum = urb->seqnum;
    m->short_not_ok = urb->flags & HP_USBIP_SHORT_NOT_OK;
    m->urb = (hp_urb){.endpoint = (uint8_t)(urb->endpoint | (urb->endpoint && m->in ? 0x80 : 0)),
                      .bytes = m->bytes,
                      .length = urb->length,
                      .zero_packet = urb->flags & HP_USBIP_ZERO_PACKET,
                      .done = done,
                      .owner = m};
    memcpy(m->urb.setup, urb->setup, sizeof urb->setup);
    if (!m->in && urb->length)
        client->filling = m;
    else
        submit(client, m);
}

/* An urb that is over by now has its reply before this one. */
static void take_unlink(hp_usbip_client *client, const hp_usbip_urb *urb) {
    message *unlinked = find(&client->pending, urb->unlinked), *m = new_message(client, 0);
    if (!m) return;
    hp_urb_status status = unlinked ? HP_URB_CANCELLED : HP_URB_OK;
    if (unlinked) {
        unlinked->forgotten = true;
        hp_gadget_unlink(client->board->gadget, &unlinked->urb);
    }
    hp_usbip_write_return(m->head, HP_RET_UNLINK, urb->seqnum, hp_usbip_status(status, false), 0);
    m->head_bytes = HP_USBIP_URB_BYTES;
    append(&client->replies, m);
    client->messages++;
}

static void take_urb(hp_usbip_client *client) {
    hp_usbip_urb urb = hp_usbip_read_urb(client->head);
    const hp_usbip_place *place = &client->board->place;
    client->head_got = 0;
    if (urb.devid != (place->busnum << 16 | place->devnum))
        end(client, "device %u, which it has not imported", urb.devid);
    else if (urb.direction > 1)
        end(client, "direction %u", urb.direction);
    else if (urb.command == HP_CMD_SUBMIT)
        take_submit(client, &urb);
    else if (urb.command == HP_CMD_UNLINK)
        take_unlink(client, &urb);
    else
        end(client, "command %u", urb.command);
}

/* ---- bytes ---- */

static bool is_full(const fifo *list, const hp_usbip_limits *limits) {
    return list->count >= limits->urbs || list->bytes >= limits->bytes;
}

size_t hp_usbip_client_wants(hp_usbip_client *client, uint8_t **to) {
    message *m = client->filling;
    if (client->fault[0] || is_full(&client->replies, client->limits)) return 0;
    *to = m ? m->bytes + m->bytes_used : client->head + client->head_got;
    return m ? m->room - m->bytes_used : client->head_bytes - client->head_got;
}

void hp_usbip_client_got(hp_usbip_client *client, size_t n) {
    message *m = client->filling;
    if (m) {
        m->bytes_used += n;
        if (m->bytes_used == m->room) submit(client, m);
        return;
    }
    client->head_got += n;
    if (client->head_got < client->head_bytes) return;
    if (client->board)
        take_urb(client);
    else
        take_op(client);
}

size_t hp_usbip_client_has(const hp_usbip_client *client, const uint8_t **from, bool *more) {
    const message *m = client->replies.first;
    if (client->fault[0] || !m) return 0;
    bool in_head = client->sent < m->head_bytes;
    *more = m->next || (in_head && m->bytes_used);
    *from = in_head ? m->head + client->sent : m->bytes + (client->sent - m->head_bytes);
    return in_head ? m->head_bytes - client->sent : m->head_bytes + m->bytes_used - client->sent;
}

void hp_usbip_client_sent(hp_usbip_client *client, size_t n) {
    message *m = client->replies.first;
    client->sent += n;
    if (client->sent < m->head_bytes + m->bytes_used) return;
    client->sent = 0;
    take_out(&client->replies, m);
    free(m);
}

bool hp_usbip_client_run(hp_usbip_client *client) {
    return client->board && !client->fault[0] && hp_gadget_run(client->board->gadget);
}

/* ---- beginning and end ---- */

hp_usbip_client *hp_usbip_client_create(hp_usbip_export *exports, size_t count, const hp_usbip_limits *limits) {
    hp_usbip_client *client = calloc(1, sizeof *client);
    if (!client) return NULL;
    client->exports = exports;
    client->export_count = count;
    client->limits = limits;
    client->head_bytes = HP_USBIP_OP_BYTES;
    client->pending.end = &client->pending.first;
    client->replies.end = &client->replies.first;
    return client;
}

void hp_usbip_client_destroy(hp_usbip_client *client) {
    if (!client) return;
    for (message *m = client->pending.first; m; m = m->next) m->forgotten = true;
    if (client->board) {
        hp_gadget_reset(client->board->gadget);
        client->board->user = NULL;
    }
    while (client->replies.first) {
        message *m = client->replies.first;
        take_out(&client->replies, m);
        free(m);
    }
    free(client->filling);
    free(client);
}

const char *hp_usbip_client_fault(const hp_usbip_client *client) {
    return client->fault[0] ? client->fault : NULL;
}

const hp_usbip_export *hp_usbip_client_board(const hp_usbip_client *client) {
    return client->board;
}

uint64_t hp_usbip_client_messages(const hp_usbip_client *client) {
    return client->messages;
}

bool hp_usbip_client_rests(const hp_usbip_client *client) {
    return client->head_got == 0 && !client->filling && !client->replies.first;
}
