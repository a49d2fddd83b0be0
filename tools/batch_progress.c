/*
 * How far a run is; see batch_progress.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "batch_progress.h"

#include "tool.h"

#include <string.h>
#include <unistd.h>

enum { BAR = 20 };

void batch_progress_begin(batch_progress *state, uint64_t first, uint64_t end)
{
    memset(state, 0, sizeof *state);
    state->is_shown = isatty(STDERR_FILENO) == 1;
    state->start = tool_clock();
    state->shown = state->start - 1000;
    state->first = first;
    state->end = end;
}

void batch_progress_show(batch_progress *state, uint64_t done, uint64_t colliding, uint64_t refused)
{
    const double now = tool_clock();
    if (!state->is_shown || (now - state->shown < 100 && done < state->end)) return;
    state->shown = now;
    char bar[BAR + 1];
    const double part = state->end ? (double)done / (double)state->end : 1;
    const int full = (int)(part * BAR);
    memset(bar, '-', BAR);
    memset(bar, '#', (size_t)full);
    bar[BAR] = '\0';
    fprintf(stderr, "\r[%s] %.0f/%.0f", bar, (double)done, (double)state->end);
    if (done > state->first && now > state->start) {
        const double rate = (double)(done - state->first) / (1e-3 * (now - state->start));
        const double left = (double)(state->end - done) / rate;
        fprintf(stderr, "  %.1f/s  %.0f:%02d:%02d left", rate, (double)(uint64_t)(left / 3600),
                (int)((uint64_t)(left / 60) % 60), (int)((uint64_t)left % 60));
    }
    fprintf(stderr, "  %.0f colliding, %.0f refused\033[K", (double)colliding, (double)refused);
    fflush(stderr);
}

void batch_progress_end(batch_progress *state)
{
    if (state->is_shown) fputs("\r\033[K", stderr);
}
