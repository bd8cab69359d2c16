/* An open device as the calls of hitpipe.h see it. Not part of the public interface. */
#ifndef HITPIPE_DEVICE_H
#define HITPIPE_DEVICE_H

#include "queue.h"
#include <hitpipe/hitpipe.h>

#define HP_DEVICE_COOKIE 0x31446848u /* "HhD1" */
#define HP_QUERY_COOKIE 0x31516848u  /* "HhQ1" */

struct hp_device {
    hp_transport *transport;
    hp_queue queue;
    hp_message message;
    hp_identity identity;
    bool unchecked;
    unsigned in_flight;
    hp_progress *progress;
    void *progress_context;
    uint64_t progress_ms; /* when it was last called; 0: never */

    bool session;    /* the board answered HELLO and was not reset since */
    hp_object scene; /* type of the resident secondaries; 0: none */
    size_t scene_count;
    bool transformed; /* the transformer is on, with this matrix */
    float matrix[12];
    bool transform_due; /* the board may not have it yet: it is sent before anything else */

    uint32_t *batch_primary, *batch_secondary; /* of one RESULT packet of mode all */
    hp_result *batch_records;
};

/* Opens a device over a transport, which becomes the device's, also on error. */
hp_status hp_open_transport(const hp_device_def *def, hp_transport *transport, hp_device **device,
                            hp_message *message);

/* Begins a call: settles what an earlier one left, opens a session if there is none, and sends what
 * the board must know. */
hp_status hp_begin(hp_device *device);

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

/* Calls the user's progress function if its time has come. False: the user cancels. */
bool hp_tell_progress(hp_device *device, uint64_t done, uint64_t total);

#endif
