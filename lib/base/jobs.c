/*
 * Loops that are shared out among the host's tasks. See jobs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/jobs.h"

typedef struct loop {
    sc_jobs_body body;
    void *context;
    uint32_t count, length;
} loop;

static void run_range(void *context, uint32_t part, uint32_t worker)
{
    const loop *l = (const loop *)context;
    uint32_t first = part * l->length;
    (void)worker;
    l->body(l->context, part, first, l->count - first < l->length ? l->count : first + l->length);
}

uint32_t sc_jobs_loop(const sc_tasks *tasks, uint32_t count, uint32_t least, sc_jobs_body body,
                      void *context)
{
    loop l;
    uint32_t parts;
    l.body = body;
    l.context = context;
    l.count = count;
    l.length = tasks ? (count - 1) / SC_JOBS_PARTS + 1 : count;
    if (l.length < least) l.length = least;
    parts = (count - 1) / l.length + 1;
    if (parts == 1 || !tasks) {
        body(context, 0, 0, count);
        return 1;
    }
    tasks->finish(tasks->user, tasks->enqueue(tasks->user, run_range, &l, parts));
    return parts;
}
