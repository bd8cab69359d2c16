/* A progress bar on standard error: on a terminal alone, and only for work that takes more than a second.
 *
 * A thread of its own paints it, so that it moves on while one call takes long and tells nothing. The functions below
 * are called from one thread. */
#ifndef HITPIPE_HOST_PROGRESS_H
#define HITPIPE_HOST_PROGRESS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct hp_progress_bar {
    bool terminal; /* false: nothing is ever shown */
    bool running;  /* the painter is there, and what follows is under the lock */
    pthread_t painter;
    pthread_mutex_t lock;
    pthread_cond_t ended;
    bool ending;
    const char *what;
    double start;         /* of the present work, in seconds */
    uint64_t done, total; /* of the present part; 0, 0: nothing is known */
    uint64_t part, parts;
} hp_progress_bar;

hp_progress_bar hp_progress_bar_new(void);

/* Begins a piece of work: "tracing". The words must outlive the bar. */
void hp_progress_bar_begin(hp_progress_bar *bar, const char *what);

/* Begins part number `part`, from 0, of `parts` equal ones of the work. */
void hp_progress_bar_part(hp_progress_bar *bar, uint64_t part, uint64_t parts);

/* How much of the part is done. An hp_progress; the context is the bar. Always true: the bar cancels nothing. */
bool hp_progress_bar_show(void *bar, uint64_t done, uint64_t total);

/* Wipes the bar off the terminal. Before anything else is printed there. */
void hp_progress_bar_end(hp_progress_bar *bar);

/* Seconds on a clock that never goes back. */
double hp_seconds(void);

#endif
