#include "selector.h"
#include <string.h>

void hp_selector_begin(hp_selector *selector, const hp_query *query, const hp_config *config, unsigned interval) {
    bool zip = query->mode == HP_MODE_ZIP;
    *selector = (hp_selector){.query = query, .interval = interval};
    selector->secondary_outer = !zip && config->loop_order == HP_SECONDARY_OUTER;
    selector->lanes = zip ? 1 : (unsigned)config->lanes;
    selector->groups = (query->active + selector->lanes - 1) / selector->lanes;
    selector->over = query->active == 0 || query->count == 0;
}

unsigned hp_selector_sweeps(const hp_selector *selector) {
    return selector->secondary_outer ? 1 : selector->groups;
}

unsigned hp_selector_size(const hp_selector *selector) {
    unsigned left = selector->query->active - hp_selector_first(selector);
    return left < selector->lanes ? left : selector->lanes;
}

static bool is_stopped(const hp_selector *selector, unsigned group) {
    unsigned from = group * selector->lanes, to = from + selector->lanes;
    for (unsigned p = from; p < to && p < selector->query->active; p++)
        if (!selector->stopped[p]) return false;
    return true;
}

static unsigned next_group(const hp_selector *selector, unsigned group) {
    while (group < selector->groups && is_stopped(selector, group)) group++;
    return group;
}

/* The oldest secondary has met every group. */
static void next_secondary(hp_selector *selector, hp_secondary_file *file) {
    hp_secondary_release(file);
    selector->group = next_group(selector, 0);
    if (++selector->object == selector->query->count) selector->over = true;
}

static void next_primaries(hp_selector *selector) {
    selector->object = 0;
    if (++selector->group == selector->groups) selector->over = true;
}

void hp_selector_issued(hp_selector *selector, hp_secondary_file *file) {
    selector->rest = selector->interval - 1;
    if (selector->secondary_outer) {
        selector->group = next_group(selector, selector->group + 1);
        if (selector->group == selector->groups) next_secondary(selector, file);
    } else {
        hp_secondary_release(file);
        if (++selector->object == file->per_sweep) next_primaries(selector);
    }
}

void hp_selector_pass_over(hp_selector *selector, hp_secondary_file *file) {
    if (selector->over) return;
    if (selector->secondary_outer) {
        bool all = next_group(selector, 0) == selector->groups;
        selector->group = next_group(selector, selector->group);
        if (all)
            selector->over = true;
        else if (selector->group == selector->groups)
            next_secondary(selector, file);
    } else if (is_stopped(selector, selector->group)) {
        next_primaries(selector);
        hp_secondary_restart(file, selector->group);
    }
    if (selector->over) hp_secondary_restart(file, file->sweeps);
}
