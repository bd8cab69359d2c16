/* An open device as the calls of hitpipe.h see it. Not part of the public interface. */
#ifndef HITPIPE_DEVICE_H
#define HITPIPE_DEVICE_H

#include "queue.h"
#include <hitpipe/hitpipe.h>

#define HP_DEVICE_COOKIE 0x31446848u /* "HhD1" */
#define HP_QUERY_COOKIE 0x31516848u  /* "HhQ1" */

/* Opens the device's board again after it was lost. Errors as hp_open. */
typedef hp_status hp_reopen(void *context, hp_transport **transport, hp_message *message);

struct hp_device {
    hp_transport *transport; /* NULL: lost, and not back yet */
    hp_queue queue;
    hp_message message;
    hp_identity identity;
    hp_device_def def;                      /* as it was opened with; only what is no string */
    char target[128];                       /* what to open again */
    uint64_t progress_ms;                   /* when it was last called; 0: never */
    uint64_t progress_done, progress_total; /* what it was told */

    bool session;    /* the board answered HELLO and was not reset since */
    hp_object scene; /* type of the resident secondaries; 0: none */
    size_t scene_count;
    bool transformed; /* the transformer is on, with this matrix */
    float matrix[12];
    bool transform_due; /* the board may not have it yet: it is sent before anything else */

    /* Reconnection (reconnect.c). */
    hp_reopen *reopen; /* NULL: it cannot be opened again */
    void *reopen_context;
    float *scene_words;             /* a copy of the scene */
    hp_object scene_lost;           /* type of the scene that the board does not have any more and is to get again */
    unsigned reconnections, losses; /* since open; since the present call last got on */
    uint64_t taken;                 /* how far it had got when it lost the board */
    size_t completed;               /* primaries of the last query that were answered */

    uint32_t *batch_primary, *batch_secondary; /* of one RESULT packet of mode all */
    hp_result *batch_records;
};

/* Opens a device over a transport, which becomes the device's, also on error. */
hp_status hp_open_transport(const hp_device_def *def, hp_transport *transport, hp_device **device,
                            hp_message *message);

/* Begins a call: settles what an earlier one left, opens a session if there is none, and sends what
 * the board must know; a board that is lost is awaited. */
hp_status hp_begin(hp_device *device);

/* The same without waiting for a board that is lost. */
hp_status hp_make_ready(hp_device *device);

/* Ends a call: forgets the scene when the board did. Returns `status`. */
hp_status hp_end(hp_device *device, hp_status status);

/* HELLO: opens a session. The transformer is then due if the user had set it. */
hp_status hp_say_hello(hp_device *device);

/* One command, asked and answered; `take` may be NULL for an answer without a payload. */
hp_status hp_ask(hp_device *device, hp_command *command);

/* For commands answered by ACK. */
hp_status hp_take_nothing(hp_command *command, const uint8_t *payload, uint32_t length, bool last);

/* Sends TRANSFORM with the device's matrix; no longer due when the board took it. */
hp_status hp_send_transform(hp_device *device);

/* Sends the copy of the scene to a board that has lost it. */
hp_status hp_restore_scene(hp_device *device);

/* After a call ended with *status: whether the board was lost, or reset, and is back, and the call can go on with
 * what is not answered. `taken`: how far the call has got; a board that is lost again and again without getting on is
 * given up after hp_device_def.retries times. False: the call is over with *status, whose words are set. */
bool hp_recover(hp_device *device, hp_status *status, uint64_t taken);

/* Lets go of the transport. */
void hp_drop_link(hp_device *device);

/* A queue over the transport that device->transport is. */
hp_status hp_open_link(hp_device *device);

/* Calls the user's progress function if its time has come. False: the user cancels. */
bool hp_tell_progress(hp_device *device, uint64_t done, uint64_t total);

#endif
