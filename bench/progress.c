/*
 * A progress bar; see progress.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "progress.h"

#include "tool.h"

#include <stdio.h>
#include <unistd.h>

static double last_drawn = -1e9;
static bool is_drawn = false;

void progress_show(const char *what, uint64_t done, uint64_t all)
{
    enum { WIDTH = 30 };
    static const char bar[] = "##############################";
    if (!isatty(STDERR_FILENO) || all == 0) return;
    const double now = tool_clock();
    if (now - last_drawn < 100.0) return;
    last_drawn = now;
    is_drawn = true;
    const int filled = done >= all ? WIDTH : (int)(done * WIDTH / all);
    fprintf(stderr, "\r[%-*.*s] %3d %%  %-30.30s", WIDTH, filled, bar,
            (int)((double)done / (double)all * 100.0), what);
    fflush(stderr);
}

void progress_end(void)
{
    if (!is_drawn) return;
    fputs("\r\033[K", stderr);
    fflush(stderr);
    is_drawn = false;
    last_drawn = -1e9;
}
