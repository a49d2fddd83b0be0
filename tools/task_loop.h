/*
 * Loops that the threads of a program share (sc_tasks), and the same loops without threads.
 *
 * SPDX-License-Identifier: MIT
 *
 * What is done must not depend on which thread does it, nor on what is done first: so that a
 * program prints the same with any number of threads.
 */
#ifndef TOOLS_TASK_LOOP_H
#define TOOLS_TASK_LOOP_H

#include "starcontour.h"

#include <stddef.h>

/* How many threads there are: 1 if tasks is NULL. */
uint32_t task_workers(const sc_tasks *tasks);

/* Calls run for each part from 0 to count - 1 and returns when all are done. If tasks is NULL, one
   after the other. */
void task_parts(const sc_tasks *tasks, uint32_t count,
                void (*run)(void *context, uint32_t part, uint32_t worker), void *context);

/* Calls run for ranges, which together hold each item from 0 to count - 1 once. If tasks is NULL,
   for one range. */
void task_loop(const sc_tasks *tasks, size_t count,
               void (*run)(void *context, size_t begin, size_t end), void *context);

#endif /* TOOLS_TASK_LOOP_H */
