/* A progress bar on standard error: on a terminal alone, and only for work that takes more than a second. */
#ifndef HITPIPE_HOST_PROGRESS_H
#define HITPIPE_HOST_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct hp_progress_bar {
    const char *what; /* set by the caller before each piece of work: "tracing" */
    double start;     /* seconds; of the present piece */
    const char *started;
    bool terminal, shown;
} hp_progress_bar;

hp_progress_bar hp_progress_bar_new(void);

/* An hp_progress; the context is the bar. Always true: the bar cancels nothing. */
bool hp_progress_bar_show(void *bar, uint64_t done, uint64_t total);

/* Wipes the bar off the terminal. */
void hp_progress_bar_end(hp_progress_bar *bar);

/* Seconds on a clock that never goes back. */
double hp_seconds(void);

#endif
