#include "update.h"
#include <math.h>

void hp_update_begin(hp_update *update, const hp_query *query) {
    update->query = query;
    update->any = query->mode == HP_MODE_ANY;
    for (unsigned i = 0; i < query->active; i++) {
        update->newest[i] = 0;
        update->stencil_T[0][i] = (hp_stencil_T){INFINITY, 1};
        update->F_index[i] = (hp_F_index){0, HP_NO_INDEX, {0, 0, 0}};
    }
}

bool hp_closer(const hp_query *query, const hp_result *result, const hp_result *kept) {
    if (!result->F) return query->nearest && !kept->F && result->T < kept->T;
    if (!kept->F) return true;
    return hp_pair_keeps_deepest(query->pair) ? result->T > kept->T : result->T < kept->T;
}

/* One lane. Tests come in the order of their secondaries, so of equals the one that is there already is kept. */
static bool keep_better(hp_update *update, unsigned i, uint32_t index, const hp_result *result) {
    unsigned read = update->newest[i], write = 1 - read;
    hp_stencil_T old = update->stencil_T[read][i], kept = old;
    hp_result best = {.F = update->F_index[i].F, .T = old.T};
    bool better = old.stencil && hp_closer(update->query, result, &best);
    if (better) {
        kept = (hp_stencil_T){result->T, !(update->any && result->F)};
        update->F_index[i] = (hp_F_index){result->F, index, {result->CP[0], result->CP[1], result->CP[2]}};
    }
    update->stencil_T[write][i] = kept;
    update->newest[i] = (uint8_t)write;
    return better;
}

/* The waveform has room for one lane: the first that was a test. The others may hold no result at all. */
static unsigned lane_shown(uint64_t tested) {
    unsigned lane = 0;
    while (tested >> lane > 1 && !(tested >> lane & 1)) lane++;
    return lane;
}

static void show(hp_update *update, unsigned i, const hp_result *result) {
    update->address = i;
    update->reads = update->newest[i];
    update->T_in = result->T;
    update->T_read = update->stencil_T[update->reads][i].T;
}

uint64_t hp_update_take(hp_update *update, unsigned first, unsigned lanes, uint64_t tested, uint32_t index,
                        const hp_result *results) {
    unsigned shown = lane_shown(tested);
    show(update, first + shown, &results[shown]);
    update->kept = 0;
    for (unsigned lane = 0; lane < lanes; lane++)
        if (tested >> lane & 1 && keep_better(update, first + lane, index, &results[lane]))
            update->kept |= UINT64_C(1) << lane;
    update->T_written = update->stencil_T[update->newest[first + shown]][first + shown].T;
    return update->any ? update->kept : 0;
}

hp_result hp_update_record(const hp_update *update, unsigned i) {
    const hp_F_index *found = &update->F_index[i];
    const hp_stencil_T *newest = &update->stencil_T[update->newest[i]][i];
    return (hp_result){
        found->F, found->index, newest->T, {found->CP[0], found->CP[1], found->CP[2]}, newest->stencil};
}
