#include "host/cli/interrupt.h"

#include <signal.h>

static volatile sig_atomic_t interrupted; /* of the process, as signals are */

static void note(int signal) {
    (void)signal;
    interrupted = 1;
}

void hp_interrupt_watch(void) {
    if (interrupted) return;
    /* once: the next one finds the default again; and calls that wait are to notice it */
    struct sigaction once = {.sa_handler = note, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&once.sa_mask);
    sigaction(SIGINT, &once, NULL);
}

bool hp_interrupted(void) {
    return interrupted;
}
