/*
 * Processes of their own; see apart.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _XOPEN_SOURCE 700

#include "apart.h"

#include "tool.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#  include <sys/prctl.h>
#endif

/* What a process may take at most; spare more, and it is killed without a reason (SIGKILL, where
   SIGXCPU says that it was for time). A lower limit that there is already stays. */
static void limit(int what, rlim_t most, rlim_t spare)
{
    struct rlimit old, limits = {most, most + spare};
    if (getrlimit(what, &old) == 0 && old.rlim_max != RLIM_INFINITY &&
        old.rlim_max < limits.rlim_max)
        limits.rlim_max = old.rlim_max;
    if (limits.rlim_cur > limits.rlim_max) limits.rlim_cur = limits.rlim_max;
    setrlimit(what, &limits);
}

/* In the new process. */
static void become_worker(pid_t parent, int out, const apart_limits *limits)
{
#ifdef __linux__
    /* whoever ends the run ends its readers, too */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(TOOL_FAILED);
#else
    (void)parent;
#endif
    const int nothing = open("/dev/null", O_RDWR);
    if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(nothing, STDERR_FILENO) < 0 ||
        dup2(out, STDOUT_FILENO) < 0)
        _exit(TOOL_FAILED);
    limit(RLIMIT_CORE, 0, 0);
    /* of processor time: a busy machine does not change what is refused */
    if (limits->seconds) limit(RLIMIT_CPU, limits->seconds, 5);
#ifdef RLIMIT_AS
    if (limits->megabytes) limit(RLIMIT_AS, (rlim_t)limits->megabytes << 20, 0);
#endif
}

bool apart_start(apart *self, int (*work)(void *user, uint64_t index), void *user, uint64_t index,
                 const apart_limits *limits)
{
    int ends[2];
    const pid_t parent = getpid();
    if (pipe(ends) != 0) return false;
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fflush(stdout);
    fflush(stderr);
    const pid_t process = fork();
    if (process == 0) {
        close(ends[0]);
        become_worker(parent, ends[1], limits);
        const int status = work(user, index);
        _exit(fflush(stdout) == 0 ? status : TOOL_FAILED);
    }
    const int error = errno;
    close(ends[1]);
    if (process < 0) {
        close(ends[0]);
        errno = error;
        return false;
    }
    self->process = process;
    self->pipe = ends[0];
    self->size = 0;
    self->is_late = self->is_full = false;
    self->deadline = limits->seconds ? tool_clock() + 1e4 * limits->seconds : 0;
    return true;
}

/* Room for more of what it prints. */
static bool make_room(apart *self)
{
    if (self->size < self->capacity) return true;
    const size_t capacity = self->capacity ? 2 * self->capacity : 4096;
    char *text = capacity < self->capacity ? NULL : (char *)realloc(self->text, capacity);
    if (!text) return false;
    self->text = text;
    self->capacity = capacity;
    return true;
}

bool apart_take(apart *self, bool is_ready)
{
    if (self->deadline > 0 && tool_clock() > self->deadline && !self->is_late) {
        self->is_late = true;
        kill(self->process, SIGKILL);
    }
    if (!is_ready) return false;
    if (!make_room(self)) {
        self->is_full = true;
        self->size = 0;
        kill(self->process, SIGKILL);
    }
    /* what does not fit any more is dropped */
    char dropped[1];
    const bool has_room = self->size < self->capacity;
    const ssize_t got = has_room
                            ? read(self->pipe, self->text + self->size, self->capacity - self->size)
                            : read(self->pipe, dropped, sizeof dropped);
    if (got > 0 && has_room) self->size += (size_t)got;
    if (got > 0 || (got < 0 && errno == EINTR)) return false;
    close(self->pipe);
    while (waitpid(self->process, &self->status, 0) < 0 && errno == EINTR) {
    }
    return true;
}

void apart_kill(apart *self)
{
    kill(self->process, SIGKILL);
    close(self->pipe);
    while (waitpid(self->process, &self->status, 0) < 0 && errno == EINTR) {
    }
}

static const struct {
    int number;
    const char *name;
} signals[] = {{SIGABRT, "SIGABRT"}, {SIGBUS, "SIGBUS"},   {SIGFPE, "SIGFPE"},
               {SIGILL, "SIGILL"},   {SIGKILL, "SIGKILL"}, {SIGSEGV, "SIGSEGV"}};

void apart_why(const apart *self, const apart_limits *limits, char *text, size_t size)
{
    if (self->is_full) {
        snprintf(text, size, "no memory for what was found");
    } else if (self->is_late) {
        snprintf(text, size, "took longer than %.0f seconds", 10. * limits->seconds);
    } else if (WIFSIGNALED(self->status) && WTERMSIG(self->status) == SIGXCPU) {
        snprintf(text, size, "took longer than %lu seconds of processor time",
                 (unsigned long)limits->seconds);
    } else if (WIFSIGNALED(self->status)) {
        const char *name = "";
        for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
            if (signals[i].number == WTERMSIG(self->status)) name = signals[i].name;
        }
        snprintf(text, size, "ended its reader by signal %d%s%s%s", WTERMSIG(self->status),
                 name[0] ? " (" : "", name, name[0] ? ")" : "");
    } else {
        snprintf(text, size, "ended its reader without an answer, by status %d",
                 WEXITSTATUS(self->status));
    }
}
