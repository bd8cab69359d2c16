#include "ddr.h"
#include <stdlib.h>

hp_status hp_ddr_reserve(hp_ddr *ddr, hp_object object, uint64_t objects) {
    size_t need = (size_t)objects * hp_object_words(object);
    if (need <= ddr->room) return HP_OK;
    size_t room = need > ddr->room + ddr->room / 2 ? need : ddr->room + ddr->room / 2;
    float *words = realloc(ddr->words, room * sizeof *words);
    if (!words) return HP_ERROR_MEMORY;
    ddr->words = words;
    ddr->room = room;
    return HP_OK;
}

void hp_ddr_free(hp_ddr *ddr) {
    free(ddr->words);
}

uint64_t hp_ddr_capacity(const hp_config *config, hp_object object) {
    return config->ddr_bytes / (4 * HP_BEAT_WORDS) / hp_object_beats(object);
}
