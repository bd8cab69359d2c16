#include "secondary.h"
#include <hitpipe/pipe.h>
#include <stdlib.h>
#include <string.h>

hp_status hp_secondary_create(hp_secondary_file *file, const hp_config *config, const hp_ddr *ddr) {
    *file = (hp_secondary_file){.config = config, .ddr = ddr};
    file->entries = malloc(config->secondary_depth * sizeof *file->entries);
    return file->entries ? HP_OK : HP_ERROR_MEMORY;
}

void hp_secondary_free(hp_secondary_file *file) {
    free(file->entries);
}

void hp_secondary_begin(hp_secondary_file *file, const hp_query *query, unsigned sweeps,
                        unsigned transformer_clocks) {
    file->query = query;
    file->transformer_clocks = query->moved ? transformer_clocks : 0;
    file->beats = hp_object_beats(query->secondary);
    file->words = hp_object_words(query->secondary);
    file->sweeps = sweeps;
    file->per_sweep = query->mode == HP_MODE_ZIP ? 1 : query->count;
    hp_secondary_restart(file, 0);
}

void hp_secondary_restart(hp_secondary_file *file, unsigned sweep) {
    file->sweep = sweep;
    file->object = 0;
    file->beat = 0;
    file->reading = (hp_secondary){.index = HP_NO_INDEX};
    file->head = file->count = 0;
}

bool hp_secondary_wants(const hp_secondary_file *file) {
    return file->sweep < file->sweeps && file->count < file->config->secondary_depth;
}

static uint32_t scene_index(const hp_secondary_file *file) {
    return hp_query_secondary(file->query, file->sweep, file->object);
}

uint64_t hp_secondary_address(const hp_secondary_file *file) {
    return (uint64_t)scene_index(file) * file->beats + file->beat;
}

void hp_secondary_held_up(hp_secondary_file *file, hp_ddr_state by) {
    if (file->sweep == file->sweeps) return;
    if (by == HP_DDR_REFRESH) file->reading.refresh++;
    if (by == HP_DDR_ROW) file->reading.row++;
}

static void next_read(hp_secondary_file *file) {
    file->reading = (hp_secondary){.index = HP_NO_INDEX};
    file->beat = 0;
    if (++file->object < file->per_sweep) return;
    file->object = 0;
    file->sweep++;
}

static void transform(const hp_secondary_file *file, hp_secondary *secondary) {
    float words[HP_OBJECT_WORDS_MAX];
    memcpy(words, secondary->words, sizeof words);
    hp_transform_object(file->query->secondary, (hp_subnormals)file->config->subnormals, file->query->matrix, words,
                        secondary->words);
}

bool hp_secondary_take(hp_secondary_file *file, uint64_t clock) {
    unsigned from = file->beat * HP_BEAT_WORDS, n = file->words - from;
    uint32_t index = scene_index(file);
    const float *object = hp_ddr_object(file->ddr, file->query->secondary, index);
    memcpy(file->reading.words + from, object + from, (n < HP_BEAT_WORDS ? n : HP_BEAT_WORDS) * sizeof(float));
    if (++file->beat < file->beats) return false;
    file->reading.index = index;
    file->reading.ready = clock + 1 + file->config->ddr_latency + file->transformer_clocks;
    if (file->query->moved) transform(file, &file->reading);
    uint64_t at = file->head + file->count++;
    if (at >= file->config->secondary_depth) at -= file->config->secondary_depth;
    file->entries[at] = file->reading;
    next_read(file);
    return true;
}

void hp_secondary_release(hp_secondary_file *file) {
    if (++file->head == file->config->secondary_depth) file->head = 0;
    file->count--;
}

hp_ddr_state hp_secondary_wait(hp_secondary_file *file) {
    hp_secondary *awaited = file->count ? &file->entries[file->head] : &file->reading;
    if (awaited->refresh) {
        awaited->refresh--;
        return HP_DDR_REFRESH;
    }
    if (awaited->row) {
        awaited->row--;
        return HP_DDR_ROW;
    }
    return HP_DDR_IDLE;
}
