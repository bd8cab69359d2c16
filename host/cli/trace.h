/* The options of `hitpipe trace`, and its three ways: a camera's picture, rays from a file, a flight. */
#ifndef HITPIPE_HOST_TRACE_H
#define HITPIPE_HOST_TRACE_H

#include "host/cli/cli.h"
#include "host/import/scene.h"
#include "host/output/report.h"
#include "host/rays/camera.h"

typedef struct trace_options {
    hp_cli cli;
    hp_scene_def scene_def;
    hp_mode mode;
    hp_separation separation;
    const char *scene_path, *out, *png, *rays;
    size_t width, height;
    hp_camera camera; /* of the options given */
    bool eye, at, up, fov, size;
    size_t flight; /* frames; 0: no flight */
    bool moving, no_shadows;
} trace_options;

/* A board with the scene on it, and what happened so far. */
typedef struct trace_run {
    const trace_options *options;
    hp_progress_bar *bar;
    hp_device *device;
    hp_scene scene;
    hp_counters upload;   /* counts of bringing up the scene */
    hp_counters counters; /* counts since then */
    double host_seconds;  /* of the board's work: upload and queries */
    json_t *report;
    bool words; /* a summary for people on standard output */
} trace_run;

/* The query for the scene's objects in a mode. */
hp_query_def trace_query(const trace_run *run, hp_mode mode);

hp_status trace_picture(trace_run *run, hp_fault *fault);
hp_status trace_rays(trace_run *run, hp_fault *fault);
hp_status trace_flight(trace_run *run, hp_fault *fault);

/* Whether a file of results is an EXR by its name; others are CSV. */
bool trace_to_exr(const char *path);

/* Says how the scene, the board and the host did, on standard output. */
void trace_summary(const trace_run *run, size_t rays, size_t hits);

#endif
