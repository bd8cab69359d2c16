#include "host/output/progress.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { BAR_WIDTH = 40, PAINT_NS = 100000000 };

double hp_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

hp_progress_bar hp_progress_bar_new(void) {
    return (hp_progress_bar){.terminal = isatty(STDERR_FILENO) == 1};
}

/* Share of the work that is done, 0 to 1. */
static double share_of(const hp_progress_bar *bar) {
    double part = bar->total > 0 ? (double)bar->done / (double)bar->total : 0;
    return ((double)bar->part + part) / (double)bar->parts;
}

static void paint(const hp_progress_bar *bar, double elapsed) {
    double share = share_of(bar);
    char cells[BAR_WIDTH + 1];
    memset(cells, '.', BAR_WIDTH);
    memset(cells, '#', (size_t)(share * BAR_WIDTH));
    cells[BAR_WIDTH] = 0;
    fprintf(stderr, "\r%-10s [%s] %3.0f %%  ", bar->what, cells, 100 * share);
    if (share > 0)
        fprintf(stderr, "%.0f s left \033[K", elapsed / share - elapsed);
    else
        fprintf(stderr, "since %.0f s \033[K", elapsed);
}

static void *paint_till_end(void *context) {
    hp_progress_bar *bar = context;
    bool shown = false;
    pthread_mutex_lock(&bar->lock);
    while (!bar->ending) {
        double elapsed = hp_seconds() - bar->start;
        if (elapsed >= 1) paint(bar, elapsed);
        shown |= elapsed >= 1;
        struct timespec next;
        clock_gettime(CLOCK_REALTIME, &next);
        next.tv_nsec += PAINT_NS;
        if (next.tv_nsec >= 1000000000) next.tv_sec++, next.tv_nsec -= 1000000000;
        pthread_cond_timedwait(&bar->ended, &bar->lock, &next);
    }
    pthread_mutex_unlock(&bar->lock);
    if (shown) fputs("\r\033[K", stderr);
    return NULL;
}

void hp_progress_bar_begin(hp_progress_bar *bar, const char *what) {
    if (!bar->terminal) return;
    bool running = bar->running;
    if (!running) {
        pthread_mutex_init(&bar->lock, NULL);
        pthread_cond_init(&bar->ended, NULL);
        bar->ending = false;
    }
    pthread_mutex_lock(&bar->lock);
    bar->what = what;
    bar->start = hp_seconds();
    bar->done = bar->total = bar->part = 0;
    bar->parts = 1;
    pthread_mutex_unlock(&bar->lock);
    /* without a thread there is no bar, and the work goes on */
    if (!running) bar->running = pthread_create(&bar->painter, NULL, paint_till_end, bar) == 0;
}

void hp_progress_bar_part(hp_progress_bar *bar, uint64_t part, uint64_t parts) {
    if (!bar->running) return;
    pthread_mutex_lock(&bar->lock);
    bar->part = part;
    bar->parts = parts;
    bar->done = bar->total = 0;
    pthread_mutex_unlock(&bar->lock);
}

bool hp_progress_bar_show(void *context, uint64_t done, uint64_t total) {
    hp_progress_bar *bar = context;
    if (!bar->running) return true;
    pthread_mutex_lock(&bar->lock);
    bar->done = done;
    bar->total = total;
    pthread_mutex_unlock(&bar->lock);
    return true;
}

void hp_progress_bar_end(hp_progress_bar *bar) {
    if (!bar->running) return;
    pthread_mutex_lock(&bar->lock);
    bar->ending = true;
    pthread_cond_signal(&bar->ended);
    pthread_mutex_unlock(&bar->lock);
    pthread_join(bar->painter, NULL);
    pthread_mutex_destroy(&bar->lock);
    pthread_cond_destroy(&bar->ended);
    bar->running = false;
}
