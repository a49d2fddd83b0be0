/*
 * A line on a terminal that says how far a long run is; nothing where there is no terminal.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_BATCH_PROGRESS_H
#define TOOLS_BATCH_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct batch_progress {
    bool is_shown;
    double start, shown; /* tool_clock() */
    uint64_t first, end; /* where this run begins, and how many there are */
} batch_progress;

/* Begins, first of end being done already. It is shown if standard error is a terminal. */
void batch_progress_begin(batch_progress *state, uint64_t first, uint64_t end);

/* Shows how many are done and how long the rest will take, and some counts; ten times a second at
   most. */
void batch_progress_show(batch_progress *state, uint64_t done, uint64_t colliding,
                         uint64_t refused);

/* Takes the line away. */
void batch_progress_end(batch_progress *state);

#endif /* TOOLS_BATCH_PROGRESS_H */
