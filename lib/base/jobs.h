/*
 * Loops and sorting that are shared out among the host's tasks.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_BASE_JOBS_H
#define SC_BASE_JOBS_H

#include <stddef.h>

#include "starcontour.h"

/*
 * Which parts of a job which worker does. Each has a range of its own, first to last as workers are
 * numbered, and begins with that; then it takes what is left of others'. So what one pass has
 * brought into a core's cache, the next finds there, if what is near in the list of parts is near
 * in memory.
 */
typedef struct sc_jobs_ranges {
    uint32_t count, workers;
    size_t taken[SC_WORKERS_MAX]; /* parts of each range, and more once it is used up; of these */
    size_t by_owner[SC_WORKERS_MAX];  /* by its worker, */
    size_t by_others[SC_WORKERS_MAX]; /* and by others, where these begin at the other end */
} sc_jobs_ranges;

void sc_jobs_divide(uint32_t workers, uint32_t count, sc_jobs_ranges *ranges);

/* The part to do for a worker that the host has given that part: each of count once, if so often
   asked. Workers begin in turn at the first and at the last of their range, and others at the other
   end: two have all between them, and meet. */
uint32_t sc_jobs_take(sc_jobs_ranges *ranges, uint32_t part, uint32_t worker);

/* The same of parts that are taken some at once, fewer when few are left, so that the last do not
   take long. How often they are to be asked for; and the first of those to do, of which there are
   *some. All begin with the first of a range: what is near takes about as long, so that none is
   left with long ones in the end. */
uint32_t sc_jobs_takes(const sc_jobs_ranges *ranges);
uint32_t sc_jobs_take_some(sc_jobs_ranges *ranges, uint32_t worker, uint32_t *some);

/* Whether each part is taken: then a worker may see what is left to do besides. */
int sc_jobs_are_taken(const sc_jobs_ranges *ranges);

/* A part of a job, from 0; worker: a number below the tasks' workers that no other running part
   has. */
typedef void (*sc_jobs_part)(void *context, uint32_t part, uint32_t worker);

/* Does so many parts, one or more: without tasks in order, by worker 0. */
void sc_jobs_run(const sc_tasks *tasks, uint32_t parts, sc_jobs_part run, void *context);

/* A loop is cut into so many parts at most. */
enum { SC_JOBS_PARTS = 32 };

/* Does first to end - 1, which is the part of that number. */
typedef void (*sc_jobs_body)(void *context, uint32_t part, uint32_t first, uint32_t end);

/*
 * Does 0 to count - 1 in parts of about equal length, none shorter than least but the last. How
 * they are cut depends on these two numbers only, unless tasks is NULL: then all is one part.
 * Returns how many there are.
 */
uint32_t sc_jobs_loop(const sc_tasks *tasks, uint32_t count, uint32_t least, sc_jobs_body body,
                      void *context);

/* A list is sorted in so many runs, unless they would be shorter than that. */
enum { SC_JOBS_RUNS = 32, SC_JOBS_RUN_MIN = 500 };

/* How entries first to first + count - 1 of a list are moved so that none of the first n is greater
   than one of the rest, which returns n; and how they are sorted. */
typedef uint64_t (*sc_jobs_split)(void *context, uint64_t first, uint64_t count);
typedef void (*sc_jobs_order)(void *context, uint64_t first, uint64_t count);

/* Sorts a list of so many entries by halves of halves: only the first split is done by one
   worker. */
void sc_jobs_sort(const sc_tasks *tasks, uint64_t count, sc_jobs_split split, sc_jobs_order order,
                  void *context);

#endif
