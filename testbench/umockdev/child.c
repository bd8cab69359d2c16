#include "child.h"
#include <linux/capability.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { STEP_MS = 2, SAYS_MS = 10000 };

static void pause_ms(unsigned ms) {
    nanosleep(&(struct timespec){.tv_nsec = (long)ms * 1000000}, NULL);
}

/* ---- starting ---- */

static void become_weak(void) {
    prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0);
    prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH, 0, 0, 0);
}

/* `exec`, so that signals reach the program and not a shell. */
static _Noreturn void run(const char *command, int output, bool weak) {
    char line[1200];
    snprintf(line, sizeof line, "exec %s", command);
    if (dup2(output, STDOUT_FILENO) < 0 || dup2(output, STDERR_FILENO) < 0 || !freopen("/dev/null", "r", stdin))
        _exit(126);
    if (weak) become_weak();
    execl("/bin/sh", "sh", "-c", line, (char *)NULL);
    _exit(127);
}

void hpt_child_start(hpt_child *child, bool weak, const char *format, ...) {
    char command[1100];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    *child = (hpt_child){.output = memfd_create("output", MFD_CLOEXEC)};
    if (child->output < 0) abort();
    fflush(NULL);
    child->pid = fork();
    if (child->pid < 0) abort();
    if (child->pid == 0) run(command, child->output, weak);
}

/* ---- what it said ---- */

static void look(hpt_child *child) {
    struct stat stat;
    if (fstat(child->output, &stat)) abort();
    child->text = realloc(child->text, (size_t)stat.st_size + 1);
    if (!child->text) abort();
    ssize_t n = pread(child->output, child->text, (size_t)stat.st_size, 0);
    child->text[n < 0 ? 0 : n] = '\0';
}

bool hpt_child_says(hpt_child *child, const char *words) {
    for (unsigned ms = 0; ms < SAYS_MS; ms += STEP_MS) {
        look(child);
        if (strstr(child->text, words)) return true;
        pause_ms(STEP_MS);
    }
    return false;
}

/* ---- the end ---- */

static bool has_ended(hpt_child *child) {
    int status;
    if (child->pid == 0) return true;
    if (waitpid(child->pid, &status, WNOHANG) != child->pid) return false;
    child->status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    child->pid = 0;
    return true;
}

int hpt_child_end(hpt_child *child, unsigned seconds) {
    for (unsigned ms = 0; !has_ended(child) && ms < 1000 * seconds; ms += STEP_MS) pause_ms(STEP_MS);
    if (child->pid) kill(child->pid, SIGKILL);
    while (!has_ended(child)) pause_ms(STEP_MS);
    look(child);
    return child->status;
}

void hpt_child_free(hpt_child *child) {
    if (child->pid) hpt_child_end(child, 0);
    if (child->output > 0) close(child->output);
    free(child->text);
    *child = (hpt_child){0};
}
