#include "sram.h"
#include <stdlib.h>

hp_status hp_sram_reserve(hp_sram *sram, uint64_t records) {
    uint64_t room = records < sram->capacity ? records : sram->capacity;
    if (room <= sram->room) return HP_OK;
    hp_result *wider = malloc(room * sizeof *wider);
    if (!wider) return HP_ERROR_MEMORY;
    uint64_t count = sram->count;
    for (uint64_t i = 0; i < count; i++) wider[i] = hp_sram_read(sram);
    free(sram->records);
    *sram = (hp_sram){wider, room, 0, count, sram->capacity};
    return HP_OK;
}

void hp_sram_free(hp_sram *sram) {
    free(sram->records);
}
