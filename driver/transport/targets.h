/* The targets of hp_open: which transport carries a device's packets. The only place beside the model transport that
 * knows of the simulated board. Not part of the public interface. */
#ifndef HITPIPE_TARGETS_H
#define HITPIPE_TARGETS_H

#include "driver/message.h"
#include "transport.h"
#include <hitpipe/hitpipe.h>

/* Opens def->target. On success *transport is the caller's to close. Errors as hp_open, with words in *message. */
hp_status hp_target_open(const hp_device_def *def, hp_transport **transport, hp_message *message);

/* The target that names the board behind this transport again, and no other: "usb" becomes "usb:SERIAL". */
void hp_target_again(hp_transport *transport, const hp_device_def *def, char *target, size_t room);

/* Fills in target, engine, isa and serial. */
void hp_target_identify(hp_transport *transport, const hp_device_def *def, hp_identity *identity);

#endif
