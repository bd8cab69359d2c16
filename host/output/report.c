#include "host/output/report.h"

#include "host/output/file.h"

#include <stdlib.h>
#include <string.h>

json_t *hp_report_new(const hp_device *device) {
    const hp_identity *board = hp_identify(device);
    return json_pack("{s:s, s:s, s:s, s:s}", "board", board->name, "engine", board->engine, "target", board->target,
                     "isa", board->isa);
}

json_t *hp_report_string(const char *text) {
    json_t *string = json_string(text);
    if (string) return string;
    char *plain = strdup(text);
    for (char *c = plain; c && *c; c++)
        if (*c & 0x80) *c = '?';
    string = json_string(plain);
    free(plain);
    return string;
}

void hp_report_set(json_t *report, const char *key, json_t *value) {
    const char *dot = strchr(key, '.');
    if (!dot) {
        json_object_set_new(report, key, value);
        return;
    }
    char group[64] = "";
    memcpy(group, key, (size_t)(dot - key) < sizeof group ? (size_t)(dot - key) : sizeof group - 1);
    json_t *below = json_object_get(report, group);
    if (!below) json_object_set_new(report, group, below = json_object());
    hp_report_set(below, dot + 1, value);
}

void hp_report_counters(json_t *report, const hp_counters *counters, uint64_t clock_hz) {
    double total = (double)counters->clocks_total, hz = (double)clock_hz;
    char key[64];
    for (unsigned i = 0; hp_register_name(i); i++) {
        const char *name = hp_register_name(i);
        uint64_t value = hp_register_value(counters, i);
        hp_report_set(report, name, json_integer((json_int_t)value));
        if (strncmp(name, "clocks.", 7) == 0 && strcmp(name, "clocks.total") != 0) {
            snprintf(key, sizeof key, "utilisation.%s", name + 7);
            hp_report_set(report, key, json_real(total > 0 ? (double)value / total : 0));
        } else if (strncmp(name, "phase.", 6) == 0) {
            snprintf(key, sizeof key, "seconds.%s", name + 6);
            hp_report_set(report, key, json_real((double)value / hz));
        }
    }
    hp_report_set(report, "seconds.board", json_real(total / hz));
    hp_report_set(report, "clock_hz", json_integer((json_int_t)clock_hz));
}

void hp_report_host(json_t *report, const hp_counters *counters, double seconds) {
    double safe = seconds > 0 ? seconds : 1e-9;
    hp_report_set(report, "seconds.host", json_real(seconds));
    hp_report_set(report, "simulated_cycles_per_host_second", json_real((double)counters->clocks_total / safe));
    hp_report_set(report, "tests_per_host_second", json_real((double)counters->tests_run / safe));
}

void hp_counters_add(hp_counters *a, const hp_counters *b) {
    for (unsigned i = 0; i < HP_REGISTER_COUNT; i++)
        hp_register_set(a, i, hp_register_value(a, i) + hp_register_value(b, i));
}

hp_status hp_report_write(const json_t *report, const char *path, hp_fault *fault) {
    char *text = json_dumps(report, JSON_INDENT(2));
    if (!text) return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", path);
    FILE *file = hp_file_create(path, fault);
    if (file) fprintf(file, "%s\n", text);
    free(text);
    return file ? hp_file_finish(file, path, fault) : fault->status;
}
