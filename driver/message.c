#include "message.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

hp_status hp_say(hp_message *message, hp_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message->text, sizeof message->text, format, arguments);
    va_end(arguments);
    return status;
}

void hp_say_also(hp_message *message, const char *format, ...) {
    size_t used = strlen(message->text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message->text + used, sizeof message->text - used, format, arguments);
    va_end(arguments);
}
