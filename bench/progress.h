/*
 * A progress bar on standard error, if that is a terminal; otherwise nothing at all.
 *
 * SPDX-License-Identifier: MIT
 *
 * Drawn ten times a second at most, and wiped out at the end.
 */
#ifndef BENCH_PROGRESS_H
#define BENCH_PROGRESS_H

#include <stdint.h>

/* Shows done out of all, with a word about what is going on. */
void progress_show(const char *what, uint64_t done, uint64_t all);

/* Wipes the bar out, if there is one. */
void progress_end(void);

#endif /* BENCH_PROGRESS_H */
