/*
 * Work that a process of its own does, so that whatever becomes of it ends nothing else: a reader
 * that crashes on a file, runs without end or takes all memory.
 *
 * SPDX-License-Identifier: MIT
 *
 * The process is a copy of this one (fork), without its other threads. What it prints to standard
 * output is what comes of the work; its standard input is empty, and its messages go nowhere.
 */
#ifndef TOOLS_APART_H
#define TOOLS_APART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct apart_limits {
    uint32_t seconds;   /* of processor time, and ten times as many by the clock; 0: none */
    uint32_t megabytes; /* of address space; 0: none */
} apart_limits;

typedef struct apart {
    pid_t process;
    int pipe;   /* to read from; to be polled */
    char *text; /* size bytes that it printed so far; kept for the next process */
    size_t size, capacity;
    double deadline; /* tool_clock(); 0: none */
    bool is_late;    /* it was ended for that */
    bool is_full;    /* there was no memory for what it printed */
    int status;      /* of waitpid, once it has ended */
} apart;

/* Starts work(user, index), the result of which is the process's exit status. False if there are
   no more processes or files; errno says why. */
bool apart_start(apart *self, int (*work)(void *user, uint64_t index), void *user, uint64_t index,
                 const apart_limits *limits);

/* Takes what it has printed, if there is something (is_ready, as poll says); true if it has
   ended. */
bool apart_take(apart *self, bool is_ready);

/* Ends it. */
void apart_kill(apart *self);

/* Why it came to no good end, in words, given that it printed no answer. */
void apart_why(const apart *self, const apart_limits *limits, char *text, size_t size);

#endif /* TOOLS_APART_H */
