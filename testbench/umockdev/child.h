/* Programs as a person starts them, and what came of it. */
#ifndef TESTBENCH_UMOCKDEV_CHILD_H
#define TESTBENCH_UMOCKDEV_CHILD_H

#include <stdbool.h>
#include <sys/types.h>

typedef struct hpt_child {
    pid_t pid;
    int output; /* a file in memory: standard output and standard error */
    char *text; /* of it, as far as it was looked at */
    int status; /* when it ended: exit status, or minus the signal that killed it */
} hpt_child;

/* Starts a command line. `weak`: without the right to open what its mode forbids, which root has. */
__attribute__((format(printf, 3, 4))) void hpt_child_start(hpt_child *child, bool weak, const char *format, ...);

/* Waits until it ends; after `seconds` it is killed, and the status is -SIGKILL. Returns the status. */
int hpt_child_end(hpt_child *child, unsigned seconds);

/* Waits until the output holds the words, at most 10 seconds. */
bool hpt_child_says(hpt_child *child, const char *words);

void hpt_child_free(hpt_child *child);

#endif
