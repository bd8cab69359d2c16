#include "host/output/progress.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { BAR_WIDTH = 40 };

double hp_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

hp_progress_bar hp_progress_bar_new(void) {
    return (hp_progress_bar){.what = "", .terminal = isatty(STDERR_FILENO) == 1};
}

bool hp_progress_bar_show(void *context, uint64_t done, uint64_t total) {
    hp_progress_bar *bar = context;
    if (!bar->terminal || total == 0) return true;
    double now = hp_seconds();
    if (bar->started != bar->what) {
        bar->started = bar->what;
        bar->start = now;
    }
    double elapsed = now - bar->start, share = (double)done / (double)total;
    if (elapsed < 1) return true;
    char cells[BAR_WIDTH + 1];
    memset(cells, '.', BAR_WIDTH);
    memset(cells, '#', (size_t)(share * BAR_WIDTH));
    cells[BAR_WIDTH] = 0;
    fprintf(stderr, "\r%-10s [%s] %3.0f %%  %.0f s left \033[K", bar->what, cells, 100 * share,
            share > 0 ? elapsed / share - elapsed : 0);
    bar->shown = true;
    return true;
}

void hp_progress_bar_end(hp_progress_bar *bar) {
    if (bar->shown) fputs("\r\033[K", stderr);
    bar->shown = false;
    bar->started = NULL;
}
