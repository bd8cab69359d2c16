#include "host/import/fault.h"

#include <stdarg.h>
#include <stdio.h>

hp_status hp_fault_set(hp_fault *fault, hp_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(fault->message, sizeof fault->message, format, arguments);
    va_end(arguments);
    fault->status = status;
    return status;
}
