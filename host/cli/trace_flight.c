/* hitpipe trace --flight: the paper's experiment. A frame is one ray against every triangle; with --moving the
 * transformer is given a new matrix before it. Board time of each frame comes from the counters, less what reading
 * them costs. */
#include "host/cli/trace.h"

#include "host/output/file.h"
#include "host/output/result_csv.h"
#include "host/rays/flight.h"

#include <inttypes.h>
#include <string.h>

/* Where the clocks of a frame go. */
typedef struct phase {
    const char *name;
    size_t offset; /* in hp_counters */
    uint64_t least, most, sum;
} phase;

enum { PHASES = 5 };

typedef struct flight {
    trace_run *run;
    FILE *out; /* NULL: records are counted, not written */
    size_t frame, hits;
    hp_counters reading; /* what one hp_read_counters costs */
    phase phases[PHASES];
} flight;

static uint64_t value_of(const hp_counters *counters, const phase *p) {
    uint64_t value;
    memcpy(&value, (const char *)counters + p->offset, sizeof value);
    return value;
}

static void add_frame(flight *f, const hp_counters *counters) {
    for (phase *p = f->phases; p < f->phases + PHASES; p++) {
        uint64_t whole = value_of(counters, p), reading = value_of(&f->reading, p);
        uint64_t clocks = whole > reading ? whole - reading : 0;
        if (f->frame == 0 || clocks < p->least) p->least = clocks;
        if (clocks > p->most) p->most = clocks;
        p->sum += clocks;
    }
}

static bool take_records(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                         size_t count) {
    flight *f = context;
    (void)primary; /* always 0: a frame has one ray */
    for (size_t i = 0; i < count; i++) {
        f->hits += records[i].F;
        if (f->out) hp_result_csv_line(f->out, f->frame, secondary[i], &records[i]);
    }
    return !f->out || !ferror(f->out);
}

static hp_status fly_frame(flight *f) {
    const trace_run *run = f->run;
    float ray[HP_RAY_WORDS], matrix[12];
    size_t frames = run->options->flight;
    hp_flight_ray(&run->scene.bounds, f->frame, frames, ray);
    if (run->options->moving) {
        hp_flight_motion(&run->scene.bounds, f->frame, frames, matrix);
        hp_status status = hp_transform(run->device, matrix);
        if (status != HP_OK) return status;
    }
    hp_query_def query = trace_query(run, run->options->mode);
    if (query.mode == HP_MODE_ALL) return hp_query_all(run->device, &query, ray, 1, take_records, f);
    hp_result result;
    hp_status status = hp_query(run->device, &query, ray, 1, &result);
    if (status != HP_OK) return status;
    f->hits += result.F;
    if (f->out) hp_result_csv_line(f->out, f->frame, result.index, &result);
    return HP_OK;
}

static hp_status fly(flight *f, hp_fault *fault) {
    trace_run *run = f->run;
    hp_counters counters;
    hp_status status = hp_read_counters(run->device, true, &counters);
    if (status == HP_OK) status = hp_read_counters(run->device, true, &f->reading);
    for (f->frame = 0; f->frame < run->options->flight && status == HP_OK; f->frame++) {
        double start = hp_seconds();
        status = fly_frame(f);
        run->host_seconds += hp_seconds() - start;
        if (status == HP_OK) status = hp_read_counters(run->device, true, &counters);
        if (status != HP_OK) break;
        hp_counters_add(&run->counters, &counters);
        add_frame(f, &counters);
        hp_progress_bar_part(run->bar, f->frame + 1, run->options->flight);
    }
    return status == HP_OK ? HP_OK : hp_cli_device_fault(run->device, status, NULL, fault);
}

static void report_frames(const flight *f) {
    json_t *report = f->run->report;
    double n = (double)f->run->options->flight, hz = (double)hp_identify(f->run->device)->clock_hz;
    for (const phase *p = f->phases; p < f->phases + PHASES; p++) {
        const struct {
            const char *name;
            double clocks;
        } figures[] = {{"mean", (double)p->sum / n}, {"min", (double)p->least}, {"max", (double)p->most}};
        for (int i = 0; i < 3; i++) {
            char key[64];
            snprintf(key, sizeof key, "frame.clocks.%s.%s", p->name, figures[i].name);
            hp_report_set(report, key, json_real(figures[i].clocks));
            snprintf(key, sizeof key, "frame.seconds.%s.%s", p->name, figures[i].name);
            hp_report_set(report, key, json_real(figures[i].clocks / hz));
        }
    }
    hp_report_set(report, "frame.count", json_integer((json_int_t)f->run->options->flight));
    hp_report_set(report, "frame.moving", json_boolean(f->run->options->moving));
    hp_report_set(report, "hits", json_integer((json_int_t)f->hits));
}

static void print_frames(const flight *f) {
    double n = (double)f->run->options->flight, ms = 1e3 / (double)hp_identify(f->run->device)->clock_hz;
    printf("\n%zu frames, %s, mode %s; board milliseconds a frame (uploading the scene before: %.3f ms)\n",
           f->run->options->flight, f->run->options->moving ? "moving" : "static",
           hp_mode_name(f->run->options->mode), (double)f->run->upload.clocks_total * ms);
    printf("%-12s %12s %12s %12s\n", "", "mean", "min", "max");
    for (const phase *p = f->phases; p < f->phases + PHASES; p++)
        printf("%-12s %12.6f %12.6f %12.6f\n", p->name, (double)p->sum / n * ms, (double)p->least * ms,
               (double)p->most * ms);
}

hp_status trace_flight(trace_run *run, hp_fault *fault) {
    flight f = {
        .run = run,
        .phases = {{.name = "upload", .offset = offsetof(hp_counters, phase_upload)},
                   {.name = "compute", .offset = offsetof(hp_counters, phase_compute)},
                   {.name = "read_back", .offset = offsetof(hp_counters, phase_read_back)},
                   {.name = "idle", .offset = offsetof(hp_counters, phase_idle)},
                   {.name = "total", .offset = offsetof(hp_counters, clocks_total)}},
    };
    const char *path = run->options->out;
    if (path && !(f.out = hp_file_create(path, fault))) return fault->status;
    if (f.out) hp_result_csv_header(f.out);
    hp_progress_bar_begin(run->bar, "flying");
    hp_status status = fly(&f, fault);
    hp_progress_bar_end(run->bar);
    if (f.out) {
        hp_fault broken;
        hp_status finished = hp_file_finish(f.out, path, &broken);
        if (finished != HP_OK && (status == HP_OK || status == HP_ERROR_CANCELLED))
            status = finished, *fault = broken;
    }
    if (status != HP_OK) return status;
    report_frames(&f);
    if (!run->words) return HP_OK;
    trace_summary(run, run->options->flight, f.hits);
    print_frames(&f);
    return HP_OK;
}
