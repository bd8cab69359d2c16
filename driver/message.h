/* Words on an error, for hp_error_message. */
#ifndef HITPIPE_MESSAGE_H
#define HITPIPE_MESSAGE_H

#include <hitpipe/types.h>

enum { HP_MESSAGE_ROOM = 384 };

typedef struct hp_message {
    char text[HP_MESSAGE_ROOM];
} hp_message;

/* Writes the words and returns the status, so that a check reads `return hp_say(...)`. */
__attribute__((format(printf, 3, 4))) hp_status hp_say(hp_message *message, hp_status status, const char *format,
                                                       ...);

/* Adds words behind those that are there. */
__attribute__((format(printf, 2, 3))) void hp_say_also(hp_message *message, const char *format, ...);

#endif
