/* hitpipe trace with a camera, or with rays from a file. */
#include "host/cli/trace.h"

#include "host/import/csv.h"
#include "host/output/file.h"
#include "host/output/picture.h"
#include "host/output/result_csv.h"
#include "host/output/result_exr.h"

#include <stdlib.h>
#include <string.h>

static hp_status no_memory(hp_fault *fault, size_t n) {
    return hp_fault_set(fault, HP_ERROR_MEMORY, "no memory for %zu rays", n);
}

/* Asks the board, and adds what it counted to the run. */
static hp_status ask(trace_run *run, hp_mode mode, const float *rays, size_t n, hp_result *results, hp_fault *fault) {
    hp_query_def query = trace_query(run, mode);
    double start = hp_seconds();
    hp_status status = hp_query(run->device, &query, rays, n, results);
    run->host_seconds += hp_seconds() - start;
    hp_counters counters;
    if (status == HP_OK) status = hp_read_counters(run->device, true, &counters);
    if (status != HP_OK) return hp_cli_device_fault(run->device, status, run->options->rays, fault);
    hp_counters_add(&run->counters, &counters);
    return HP_OK;
}

static size_t count_hits(const hp_result *results, size_t n) {
    size_t hits = 0;
    for (size_t i = 0; i < n; i++) hits += results[i].F;
    return hits;
}

static hp_status write_csv(const char *path, const hp_result *results, size_t n, hp_fault *fault) {
    FILE *file = hp_file_create(path, fault);
    if (!file) return fault->status;
    hp_result_csv_header(file);
    for (size_t i = 0; i < n; i++) hp_result_csv_line(file, i, results[i].index, &results[i]);
    return hp_file_finish(file, path, fault);
}

static hp_status write_results(const trace_run *run, const hp_result *results, size_t width, size_t height,
                               hp_fault *fault) {
    const char *path = run->options->out;
    if (!path) return HP_OK;
    if (!trace_to_exr(path)) return write_csv(path, results, width * height, fault);
    const hp_exr_text texts[] = {
        {"comments",
         "T: distance along the ray; index: object, 4294967295 for none; F: 1 hit; CP: collision position"},
        {"scene", run->options->scene_path},
        {"board", hp_identify(run->device)->name},
        {NULL, NULL},
    };
    return hp_result_exr_write(path, results, width, height, texts, fault);
}

/* ---- a camera ---- */

static hp_camera camera_of(const trace_run *run) {
    const trace_options *options = run->options;
    hp_camera camera = hp_camera_for(&run->scene.bounds, options->width, options->height);
    if (options->eye) memcpy(camera.eye, options->camera.eye, sizeof camera.eye);
    if (options->at) memcpy(camera.at, options->camera.at, sizeof camera.at);
    if (options->up) memcpy(camera.up, options->camera.up, sizeof camera.up);
    if (options->fov) camera.fov = options->camera.fov;
    return camera;
}

/* One byte a pixel, which the caller frees. NULL with `fault` set. What the shadows cost is reported apart. */
static uint8_t *find_shadows(trace_run *run, const hp_picture *picture, hp_fault *fault) {
    size_t n = picture->width * picture->height;
    uint8_t *shadows = calloc(n, 1);
    float *rays = malloc(n * HP_RAY_WORDS * sizeof *rays);
    uint32_t *pixels = malloc(n * sizeof *pixels);
    hp_result *results = calloc(n, sizeof *results);
    hp_status status = HP_OK;
    if (!shadows || !rays || !pixels || !results) status = no_memory(fault, n);
    if (status == HP_OK) {
        size_t count = hp_picture_shadow_rays(picture, rays, pixels);
        hp_progress_bar_begin(run->bar, "shadows");
        if (count > 0) status = ask(run, HP_MODE_ANY, rays, count, results, fault);
        for (size_t i = 0; i < count && status == HP_OK; i++) shadows[pixels[i]] = (uint8_t)results[i].F;
        hp_report_set(run->report, "picture.shadow_rays", json_integer((json_int_t)count));
    }
    free(rays);
    free(pixels);
    free(results);
    if (status == HP_OK) return shadows;
    free(shadows);
    return NULL;
}

static hp_status write_png(trace_run *run, hp_picture *picture, hp_fault *fault) {
    uint8_t *shadows = run->options->no_shadows ? NULL : find_shadows(run, picture, fault);
    if (!shadows && !run->options->no_shadows) return fault->status;
    picture->shadows = shadows;
    uint8_t *rgb = malloc(picture->width * picture->height * 3);
    hp_status status = rgb ? HP_OK : no_memory(fault, picture->width * picture->height);
    if (rgb) {
        hp_picture_shade(picture, rgb);
        status = hp_png_write(run->options->png, rgb, picture->width, picture->height, fault);
    }
    free(rgb);
    free(shadows);
    return status;
}

static hp_status trace_camera(trace_run *run, const hp_camera *camera, float *rays, hp_result *results,
                              hp_fault *fault) {
    size_t n = camera->width * camera->height;
    hp_progress_bar_begin(run->bar, "tracing");
    hp_status status = hp_camera_rays(camera, rays, fault);
    if (status == HP_OK) status = ask(run, run->options->mode, rays, n, results, fault);
    hp_progress_bar_begin(run->bar, "writing");
    if (status == HP_OK) status = write_results(run, results, camera->width, camera->height, fault);
    if (status == HP_OK && run->options->png) {
        hp_picture picture = {camera->width, camera->height, rays, results, &run->scene, NULL};
        status = write_png(run, &picture, fault);
    }
    if (status != HP_OK) return status;
    hp_progress_bar_end(run->bar);
    size_t hits = count_hits(results, n);
    hp_report_set(run->report, "rays", json_integer((json_int_t)n));
    hp_report_set(run->report, "hits", json_integer((json_int_t)hits));
    if (run->words) trace_summary(run, n, hits);
    return HP_OK;
}

hp_status trace_picture(trace_run *run, hp_fault *fault) {
    hp_camera camera = camera_of(run);
    size_t n = camera.width * camera.height;
    float *rays = malloc(n * HP_RAY_WORDS * sizeof *rays);
    hp_result *results = calloc(n, sizeof *results);
    hp_status status = rays && results ? trace_camera(run, &camera, rays, results, fault) : no_memory(fault, n);
    free(rays);
    free(results);
    return status;
}

/* ---- rays from a file ---- */

hp_status trace_rays(trace_run *run, hp_fault *fault) {
    hp_objects rays;
    hp_status status = hp_csv_load(run->options->rays, HP_RAY, &rays, fault);
    if (status != HP_OK) return status;
    hp_result *results = calloc(rays.count, sizeof *results);
    hp_progress_bar_begin(run->bar, "tracing");
    status =
        results ? ask(run, run->options->mode, rays.words, rays.count, results, fault) : no_memory(fault, rays.count);
    if (status == HP_OK) status = write_results(run, results, rays.count, 1, fault);
    hp_progress_bar_end(run->bar);
    if (status == HP_OK) {
        size_t hits = count_hits(results, rays.count);
        hp_report_set(run->report, "rays", json_integer((json_int_t)rays.count));
        hp_report_set(run->report, "hits", json_integer((json_int_t)hits));
        if (run->words) trace_summary(run, rays.count, hits);
    }
    free(results);
    hp_objects_free(&rays);
    return status;
}
