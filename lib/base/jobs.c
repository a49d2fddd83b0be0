/*
 * Loops and sorting that are shared out among the host's tasks. See jobs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/jobs.h"

#include "base/assume.h"
#include "base/atomic.h"

void sc_jobs_divide(uint32_t workers, uint32_t count, sc_jobs_ranges *ranges)
{
    uint32_t i;
    ranges->count = count;
    ranges->workers = workers;
    for (i = 0; i < workers; i++) ranges->taken[i] = ranges->by_owner[i] = ranges->by_others[i] = 0;
}

static uint32_t range_begin(const sc_jobs_ranges *ranges, uint32_t owner)
{
    return (uint32_t)((uint64_t)ranges->count * owner / ranges->workers);
}

uint32_t sc_jobs_take(sc_jobs_ranges *ranges, uint32_t part, uint32_t worker)
{
    uint32_t i, owner = worker;
    /* there are as many parts as calls, so one is left */
    for (i = 0; SC_ATOMIC && SC_ALWAYS(i < ranges->workers);
         i++, owner = owner + 1 < ranges->workers ? owner + 1 : 0) {
        const uint32_t begin = range_begin(ranges, owner), end = range_begin(ranges, owner + 1);
        const int is_own = owner == worker, is_odd = owner % 2 != 0;
        size_t before;
        if (sc_atomic_add(&ranges->taken[owner], 1) >= end - begin) continue;
        before = is_own ? ranges->by_owner[owner]++ : sc_atomic_add(&ranges->by_others[owner], 1);
        return is_own == is_odd ? end - 1 - (uint32_t)before : begin + (uint32_t)before;
    }
    return part;
}

/* One of so many parts of a range that are left is taken at once, and so many at most. */
enum { SOME_PART = 16, SOME_MAX = 8 };

static uint32_t some_of(uint32_t left)
{
    uint32_t some = (left - 1) / SOME_PART + 1;
    return some < SOME_MAX ? some : SOME_MAX;
}

uint32_t sc_jobs_takes(const sc_jobs_ranges *ranges)
{
    uint32_t owner, left, takes = 0;
    for (owner = 0; owner < ranges->workers; owner++) {
        left = range_begin(ranges, owner + 1) - range_begin(ranges, owner);
        for (; left; left -= some_of(left)) takes++;
    }
    return takes;
}

uint32_t sc_jobs_take_some(sc_jobs_ranges *ranges, uint32_t worker, uint32_t *some)
{
    uint32_t i, owner = worker;
    /* it is called sc_jobs_takes times, so that something is left */
    for (i = 0; SC_ALWAYS(i < ranges->workers);
         i++, owner = owner + 1 < ranges->workers ? owner + 1 : 0) {
        uint32_t begin = range_begin(ranges, owner),
                 length = range_begin(ranges, owner + 1) - begin;
        size_t taken = sc_atomic_get(&ranges->taken[owner]);
        while (taken < length) {
            *some = some_of(length - (uint32_t)taken);
            if (sc_atomic_claim(&ranges->taken[owner], &taken, taken + *some))
                return begin + (uint32_t)taken;
        }
    }
    *some = 0;
    return 0;
}

int sc_jobs_are_taken(const sc_jobs_ranges *ranges)
{
    uint32_t owner;
    for (owner = 0; owner < ranges->workers; owner++)
        if (sc_atomic_get(&ranges->taken[owner]) <
            range_begin(ranges, owner + 1) - range_begin(ranges, owner))
            return 0;
    return 1;
}

void sc_jobs_run(const sc_tasks *tasks, uint32_t parts, sc_jobs_part run, void *context)
{
    uint32_t part;
    if (tasks && parts > 1)
        tasks->finish(tasks->user, tasks->enqueue(tasks->user, run, context, parts));
    else
        for (part = 0; part < parts; part++) run(context, part, 0);
}

typedef struct loop {
    sc_jobs_body body;
    void *context;
    uint32_t count, length;
    sc_jobs_ranges ranges;
} loop;

static void run_range(void *context, uint32_t part, uint32_t worker)
{
    loop *l = (loop *)context;
    uint32_t first;
    part = sc_jobs_take(&l->ranges, part, worker);
    first = part * l->length;
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
    if (parts == 1 || SC_NEVER(!tasks)) { /* without tasks there is one part */
        body(context, 0, 0, count);
        return 1;
    }
    sc_jobs_divide(tasks->workers, parts, &l.ranges);
    tasks->finish(tasks->user, tasks->enqueue(tasks->user, run_range, &l, parts));
    return parts;
}

/* Runs of a list, each of which is sorted by itself: all of one are before all of the next. */
typedef struct runs {
    sc_jobs_split split;
    sc_jobs_order order;
    void *context;
    uint64_t first[SC_JOBS_RUNS + 1]; /* of each run, and the end */
    uint64_t middle[SC_JOBS_RUNS];    /* where it is split */
} runs;

static void run_split(void *context, uint32_t part, uint32_t worker)
{
    runs *r = (runs *)context;
    uint64_t first = r->first[part];
    (void)worker;
    r->middle[part] = first + r->split(r->context, first, r->first[part + 1] - first);
}

static void run_order(void *context, uint32_t part, uint32_t worker)
{
    runs *r = (runs *)context;
    (void)worker;
    r->order(r->context, r->first[part], r->first[part + 1] - r->first[part]);
}

void sc_jobs_sort(const sc_tasks *tasks, uint64_t count, sc_jobs_split split, sc_jobs_order order,
                  void *context)
{
    runs r;
    uint32_t n, i;
    r.split = split;
    r.order = order;
    r.context = context;
    r.first[0] = 0;
    r.first[1] = count;
    for (n = 1; n < SC_JOBS_RUNS && count / n >= SC_JOBS_RUN_MIN; n *= 2) {
        sc_jobs_run(tasks, n, run_split, &r);
        for (i = n; i > 0; i--) {
            r.first[2 * i] = r.first[i];
            r.first[2 * i - 1] = r.middle[i - 1];
        }
    }
    sc_jobs_run(tasks, n, run_order, &r);
}
