/* The paper's third experiment on the simulated board: a thousand spheres move in every frame, and each is tested
 * against all of them. swarm BOARD any|all|once [FRAMES]: prints milliseconds of board time a frame, mean of the
 * frames, as upload, compute, read-back and sum, and the pairs that collide (no sphere with itself, each pair once;
 * any: the spheres that collide with one before).
 *
 * all: a record for each of the million pairs. once: a packet of primaries only against the secondaries from its own
 * first sphere on, so that each pair is tested and sent at least once. any: one record a sphere, its first collision;
 * a sphere that collides with none before it finds itself.
 *
 * In every frame the spheres are uploaded anew and sent as primaries too: nothing of the frame before is kept. */
#include "host/import/board_json.h"
#include "testbench/support/random.h"
#include <hitpipe/hitpipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SPHERES = 1000, FRAMES = 20 };

static const double box = 20, radius_least = 0.2, radius_most = 0.8, speed = 0.2;

typedef struct swarm {
    double position[SPHERES][3], velocity[SPHERES][3];
    float words[SPHERES * HP_SPHERE_WORDS];
} swarm;

static void draw(swarm *s) {
    hpt_random random = hpt_random_seed(3);
    for (unsigned i = 0; i < SPHERES; i++) {
        for (unsigned axis = 0; axis < 3; axis++) {
            s->position[i][axis] = hpt_random_between(&random, -box / 2, box / 2);
            s->velocity[i][axis] = hpt_random_between(&random, -speed, speed);
        }
        s->words[4 * i + 3] = (float)hpt_random_between(&random, radius_least, radius_most);
    }
}

/* One frame on; the walls of the box throw spheres back. */
static void move(swarm *s) {
    for (unsigned i = 0; i < SPHERES; i++)
        for (unsigned axis = 0; axis < 3; axis++) {
            double *x = &s->position[i][axis], *v = &s->velocity[i][axis];
            if (*x + *v > box / 2 || *x + *v < -box / 2) *v = -*v;
            *x += *v;
            s->words[4 * i + axis] = (float)*x;
        }
}

typedef struct counting {
    uint64_t hits;
    uint32_t from; /* the sphere that is primary 0 */
} counting;

static bool count_hits(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                       size_t count) {
    counting *c = context;
    for (size_t i = 0; i < count; i++) c->hits += records[i].F && c->from + primary[i] < secondary[i];
    return true;
}

/* A packet after another against the spheres from its first on. */
static hp_status ask_once(hp_device *device, hp_query_def *def, const swarm *s, counting *c) {
    uint32_t packet = hp_identify(device)->packet_primaries;
    for (c->from = 0; c->from < SPHERES; c->from += packet) {
        uint32_t n = SPHERES - c->from < packet ? SPHERES - c->from : packet;
        def->first = c->from;
        hp_status status = hp_query_all(device, def, s->words + c->from * HP_SPHERE_WORDS, n, count_hits, c);
        if (status) return status;
    }
    return HP_OK;
}

static hp_status ask_any(hp_device *device, const hp_query_def *def, const swarm *s, counting *c) {
    hp_result results[SPHERES];
    hp_status status = hp_query(device, def, s->words, SPHERES, results);
    for (uint32_t i = 0; i < SPHERES && !status; i++) c->hits += results[i].index < i;
    return status;
}

static hp_status frame(hp_device *device, const char *way, const swarm *s, counting *c) {
    hp_query_def def = hp_default_query_def();
    def.pair = HP_PAIR_SPHERE_SPHERE;
    def.mode = strcmp(way, "any") == 0 ? HP_MODE_ANY : HP_MODE_ALL;
    def.separation = HP_SEPARATION_OFF;
    hp_status status = hp_upload(device, HP_SPHERE, s->words, SPHERES);
    if (status) return status;
    if (def.mode == HP_MODE_ANY) return ask_any(device, &def, s, c);
    if (strcmp(way, "once") == 0) return ask_once(device, &def, s, c);
    return hp_query_all(device, &def, s->words, SPHERES, count_hits, c);
}

/* Board time of one frame, less what reading the counters costs, is added to *sum. */
static hp_status timed_frame(hp_device *device, const char *way, const swarm *s, hp_counters *sum, counting *c) {
    hp_counters reading, counters;
    hp_status status = hp_read_counters(device, true, &counters);
    if (!status) status = hp_read_counters(device, true, &reading);
    if (!status) status = frame(device, way, s, c);
    if (!status) status = hp_read_counters(device, true, &counters);
    sum->phase_upload += counters.phase_upload - reading.phase_upload;
    sum->phase_compute += counters.phase_compute - reading.phase_compute;
    sum->phase_read_back += counters.phase_read_back - reading.phase_read_back;
    return status;
}

int main(int argc, char **argv) {
    static swarm s;
    hp_device_def def = hp_default_device_def();
    hp_device *device = NULL;
    hp_counters sum = {0};
    counting c = {0, 0};
    unsigned frames = argc > 3 ? (unsigned)strtoul(argv[3], NULL, 10) : FRAMES;
    const char *way = argc > 2 ? argv[2] : "";
    bool known = strcmp(way, "any") == 0 || strcmp(way, "all") == 0 || strcmp(way, "once") == 0;
    hp_fault fault;
    if (!known || !frames) return hp_status_exit(HP_ERROR_USAGE);
    if (hp_board_load(argv[1], &def.board, &fault) != HP_OK) {
        fprintf(stderr, "swarm: %s\n", fault.message);
        return hp_status_exit(fault.status);
    }
    hp_status status = hp_open(&def, &device);
    draw(&s);
    for (unsigned i = 0; i < frames && !status; i++) {
        move(&s);
        status = timed_frame(device, way, &s, &sum, &c);
    }
    if (status) {
        fprintf(stderr, "swarm: %s: %s\n", hp_status_text(status), hp_error_message(device));
        return hp_status_exit(status);
    }
    double ms = 1e3 / (double)hp_identify(device)->clock_hz / frames;
    double upload = ms * (double)sum.phase_upload, compute = ms * (double)sum.phase_compute,
           read_back = ms * (double)sum.phase_read_back;
    printf("%.3f %.3f %.3f %.3f %.0f\n", upload, compute, read_back, upload + compute + read_back,
           (double)c.hits / frames);
    hp_close(device);
    return 0;
}
