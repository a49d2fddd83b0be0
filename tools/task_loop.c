/*
 * Loops by several threads; see task_loop.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "task_loop.h"

/* Ranges of a loop for each thread: one that comes late, or is slower, takes fewer. */
enum { RANGES_EACH = 8 };

typedef struct ranges {
    void (*run)(void *context, size_t begin, size_t end);
    void *context;
    size_t count; /* items */
    uint32_t parts;
} ranges;

uint32_t task_workers(const sc_tasks *tasks)
{
    return tasks && tasks->workers > 1 ? tasks->workers : 1;
}

void task_parts(const sc_tasks *tasks, uint32_t count,
                void (*run)(void *context, uint32_t part, uint32_t worker), void *context)
{
    if (task_workers(tasks) > 1 && count > 1) {
        tasks->finish(tasks->user, tasks->enqueue(tasks->user, run, context, count));
        return;
    }
    for (uint32_t part = 0; part < count; part++) run(context, part, 0);
}

static size_t range_begin(const ranges *all, uint32_t part)
{
    return (size_t)((uint64_t)all->count * part / all->parts);
}

static void run_range(void *context, uint32_t part, uint32_t worker)
{
    const ranges *all = (const ranges *)context;
    (void)worker;
    all->run(all->context, range_begin(all, part), range_begin(all, part + 1));
}

void task_loop(const sc_tasks *tasks, size_t count,
               void (*run)(void *context, size_t begin, size_t end), void *context)
{
    const uint32_t workers = task_workers(tasks);
    ranges all = {run, context, count, workers > 1 ? RANGES_EACH * workers : 1};
    task_parts(tasks, all.parts, run_range, &all);
}
