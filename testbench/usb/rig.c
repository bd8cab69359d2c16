#include "rig.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- faults ---- */

static hpt_fault happens(rig_plan *plan, hpt_fault fault) {
    plan->faults++;
    plan->of_kind[fault.kind]++;
    return fault;
}

static hpt_fault choose(void *context, bool in, unsigned number, const uint8_t *bytes, size_t n) {
    rig_plan *plan = context;
    (void)bytes, (void)n;
    if (plan->rate && (unsigned)hpt_random_below(&plan->random, plan->rate) == 0) {
        hpt_fault_kind kind = plan->kinds[hpt_random_below(&plan->random, plan->kind_count)];
        unsigned argument = (unsigned)hpt_random_below(&plan->random, kind == HPT_FAULT_GROW ? 600000 : 400);
        if (kind == HPT_FAULT_STALL || kind == HPT_FAULT_PROTO) argument %= 2;
        if (kind == HPT_FAULT_UNPLUG) argument = 1; /* back at once */
        return happens(plan, (hpt_fault){kind, argument});
    }
    if (in != plan->in || number < plan->from || number - plan->from >= plan->count) return (hpt_fault){0};
    return happens(plan, plan->fault);
}

void rig_fault(rig *r, hpt_fault_kind kind, unsigned argument, bool in, unsigned skip, unsigned count) {
    r->plan = (rig_plan){
        .fault = {kind, argument},
        .in = in,
        .from = hpt_counts(r->board).packets[in] + skip,
        .count = count,
    };
}

void rig_random_faults(rig *r, uint64_t seed, unsigned rate, const hpt_fault_kind *kinds, unsigned count) {
    r->plan = (rig_plan){.rate = rate, .random = hpt_random_seed(seed), .kind_count = count};
    memcpy(r->plan.kinds, kinds, count * sizeof *kinds);
}

void rig_no_faults(rig *r) {
    r->plan = (rig_plan){0};
}

/* ---- truth ---- */

static bool note_truth(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                       size_t count) {
    rig *r = context;
    for (size_t i = 0; i < count; i++) r->all[primary[i]][secondary[i]] = records[i];
    return true;
}

static hp_query_def all_def(void) {
    hp_query_def def = hp_default_query_def();
    def.mode = HP_MODE_ALL;
    def.separation = HP_SEPARATION_OFF;
    return def;
}

static void ask_the_model(rig *r) {
    hp_device_def def = hp_default_device_def();
    hp_device *model;
    def.board = r->config;
    def.threads = 1;
    hp_query_def query = hp_default_query_def(), all = all_def();
    assert_int_equal(hp_open(&def, &model), HP_OK);
    assert_int_equal(hp_upload(model, HP_TRIANGLE, r->triangles[0], RIG_TRIANGLES), HP_OK);
    assert_int_equal(hp_query(model, &query, r->rays[0], RIG_RAYS, r->closest), HP_OK);
    assert_int_equal(hp_query_all(model, &all, r->rays[0], RIG_RAYS, note_truth, r), HP_OK);
    hp_close(model);
}

static void make_scene(rig *r) {
    hpt_random random = hpt_random_seed(11);
    for (unsigned i = 0; i < RIG_RAYS; i++)
        for (unsigned k = 0; k < 6; k++) r->rays[i][k] = (float)hpt_random_below(&random, 2001) / 1000 - 1;
    for (unsigned i = 0; i < RIG_TRIANGLES; i++)
        for (unsigned k = 0; k < 9; k++) r->triangles[i][k] = (float)hpt_random_below(&random, 4001) / 1000 - 2;
}

/* ---- the rig ---- */

rig *rig_new(hp_usb_speed speed, unsigned records, bool faulty) {
    rig *r = calloc(1, sizeof *r);
    assert_non_null(r);
    hp_config_preset(&r->config, "ideal");
    r->config.packet_primaries = RIG_PACKET;
    r->config.packet_buffers = RIG_BUFFERS;
    r->config.lanes = RIG_LANES;
    r->config.packet_results = records;
    r->plug.gadget = (hp_gadget_def){.board = {.isa = "plain", .threads = 1}, .speed = speed};
    r->plug.maps = true;
    r->plug.choose = faulty ? choose : NULL;
    r->plug.context = &r->plan;
    r->def = hp_default_device_def();
    r->def.target = "usb";
    make_scene(r);
    ask_the_model(r);
    return r;
}

void rig_free(rig *r) {
    if (!r) return;
    rig_close(r);
    hpt_discard(r->board);
    free(r);
}

void rig_plug(rig *r, const char *serial) {
    r->plug.gadget.board.config = r->config;
    r->plug.gadget.serial = serial;
    r->board = hpt_plug(&r->plug);
}

hp_status rig_open(rig *r) {
    return hp_open(&r->def, &r->device);
}

void rig_close(rig *r) {
    hp_close(r->device);
    r->device = NULL;
}

hp_status rig_upload(rig *r) {
    return hp_upload(r->device, HP_TRIANGLE, r->triangles[0], RIG_TRIANGLES);
}

void rig_begin(rig *r) {
    rig_plug(r, "HP1");
    hp_status status = rig_open(r);
    if (status) fail_msg("cannot open: %s", hp_error_message(NULL));
    assert_int_equal(rig_upload(r), HP_OK);
}

hp_status rig_ask_closest(rig *r, hp_result *results) {
    hp_query_def def = hp_default_query_def();
    memset(results, 0xEE, RIG_RAYS * sizeof *results);
    return hp_query(r->device, &def, r->rays[0], RIG_RAYS, results);
}

typedef struct listener {
    const rig *r;
    rig_tally *tally;
} listener;

static bool count_records(void *context, const uint32_t *primary, const uint32_t *secondary, const hp_result *records,
                          size_t count) {
    const listener *now = context;
    for (size_t i = 0; i < count; i++) {
        now->tally->times[primary[i]][secondary[i]]++;
        now->tally->total++;
        now->tally->wrong += memcmp(&records[i], &now->r->all[primary[i]][secondary[i]], sizeof *records) != 0;
    }
    return true;
}

hp_status rig_ask_all(rig *r, rig_tally *tally) {
    hp_query_def def = all_def();
    memset(tally, 0, sizeof *tally);
    return hp_query_all(r->device, &def, r->rays[0], RIG_RAYS, count_records, &(listener){r, tally});
}

/* ---- checks ---- */

void rig_check_closest(const rig *r, const hp_result *results, size_t count) {
    for (size_t i = 0; i < count; i++) assert_memory_equal(&results[i], &r->closest[i], sizeof results[i]);
}

void rig_check_some(const rig *r, const rig_tally *tally, size_t primaries) {
    (void)r;
    assert_int_equal(tally->wrong, 0);
    for (size_t i = 0; i < RIG_RAYS; i++)
        for (unsigned k = 0; k < RIG_TRIANGLES; k++) {
            assert_true(tally->times[i][k] <= 1);
            assert_true(i >= primaries || tally->times[i][k] == 1);
        }
}

void rig_check_all(const rig *r, const rig_tally *tally) {
    assert_int_equal(tally->total, RIG_RAYS * RIG_TRIANGLES);
    rig_check_some(r, tally, RIG_RAYS);
}

void rig_check_usable(rig *r) {
    hp_result results[RIG_RAYS];
    rig_tally tally;
    rig_no_faults(r);
    assert_int_equal(rig_ask_closest(r, results), HP_OK);
    rig_check_closest(r, results, RIG_RAYS);
    assert_int_equal(rig_ask_all(r, &tally), HP_OK);
    rig_check_all(r, &tally);
}

void rig_says(const hp_device *device, const char *words) {
    const char *message = hp_error_message(device);
    if (!strstr(message, words)) fail_msg("no \"%s\" in \"%s\"", words, message);
}
