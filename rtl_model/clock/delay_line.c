#include "delay_line.h"
#include <stdlib.h>

static hp_status make_room(hp_delay_line *line, unsigned latency, unsigned lanes) {
    hp_delay_line_free(line);
    *line = (hp_delay_line){0};
    line->stages = malloc(latency * sizeof *line->stages);
    line->results = malloc((size_t)(latency + 1) * lanes * sizeof *line->results);
    if (!line->stages || !line->results) return HP_ERROR_MEMORY;
    line->room = latency;
    for (unsigned i = 0; i < latency; i++) line->stages[i] = (hp_stage){.results = line->results + (size_t)i * lanes};
    line->output = (hp_stage){.results = line->results + (size_t)latency * lanes};
    return HP_OK;
}

void hp_delay_line_free(hp_delay_line *line) {
    free(line->stages);
    free(line->results);
}

hp_status hp_delay_line_begin(hp_delay_line *line, unsigned latency, unsigned lanes) {
    if (latency > line->room && make_room(line, latency, lanes) != HP_OK) return HP_ERROR_MEMORY;
    line->length = latency;
    line->at = line->inside = 0;
    for (unsigned i = 0; i < latency; i++) line->stages[i].valid = false;
    line->output.valid = false;
    return HP_OK;
}

static void swap(hp_stage *a, hp_stage *b) {
    hp_stage c = *a;
    *a = *b;
    *b = c;
}

void hp_delay_line_move(hp_delay_line *line) {
    line->inside += line->stages[line->at].valid;
    line->at = line->at + 1 == line->length ? 0 : line->at + 1;
    swap(&line->output, &line->stages[line->at]);
    line->inside -= line->output.valid;
    line->stages[line->at].valid = false;
}
