/* The report of a run as JSON: what the board counted, and what that is in seconds.
 *
 * Keys are those of registers.def ("clocks.total" is {"clocks": {"total": ...}}), and
 *   utilisation.BLOCK               share of all clocks in which a block did work
 *   seconds.board, .upload, .compute, .read_back, .idle    board time, and where it went
 *   seconds.host                    time of the host computer
 *   board, engine, target, isa      who answered */
#ifndef HITPIPE_HOST_REPORT_H
#define HITPIPE_HOST_REPORT_H

#include "host/import/fault.h"

#include <hitpipe/hitpipe.h>
#include <jansson.h>

/* A report that names the board. The caller frees it with json_decref. NULL: out of memory. */
json_t *hp_report_new(const hp_device *device);

/* Text of any bytes: a file's name need not be UTF-8, which JSON is; then its bytes beyond ASCII become '?'. */
json_t *hp_report_string(const char *text);

/* Sets a value under a dotted key, making the objects on the way; takes over `value`. */
void hp_report_set(json_t *report, const char *key, json_t *value);

/* Counts, utilisation and seconds of a whole run. */
void hp_report_counters(json_t *report, const hp_counters *counters, uint64_t clock_hz);

/* Seconds of the host, and simulated cycles and tests a second of them. */
void hp_report_host(json_t *report, const hp_counters *counters, double seconds);

/* Sum of counts: a += b. */
void hp_counters_add(hp_counters *a, const hp_counters *b);

/* Writes to a file or, for "-", to standard output. HP_ERROR_IO. */
hp_status hp_report_write(const json_t *report, const char *path, hp_fault *fault);

#endif
