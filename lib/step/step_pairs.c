/*
 * The caller's lists of a step. See step_pairs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_pairs.h"

#include <string.h>

#include "base/assume.h"
#include "base/atomic.h"
#include "base/jobs.h"
#include "base/sort.h"
#include "query/pairs.h"

/* Restores the heap, greatest pair first, where entry at alone may be too small. */
static void sift(const sc_step_list *list, uint64_t count, uint64_t at)
{
    sc_pair moved = list->pairs[at];
    double time = list->times ? list->times[at] : 0;
    for (;;) {
        uint64_t child = 2 * at + 1;
        if (child >= count) break;
        if (child + 1 < count && sc_sort_less(list->pairs[child], list->pairs[child + 1])) child++;
        if (!sc_sort_less(moved, list->pairs[child])) break;
        list->pairs[at] = list->pairs[child];
        if (list->times) list->times[at] = list->times[child];
        at = child;
    }
    list->pairs[at] = moved;
    if (list->times) list->times[at] = time;
}

static void heapify(const sc_step_list *list, uint64_t count)
{
    uint64_t at = count / 2;
    while (at > 0) sift(list, count, --at);
}

/* In lists with times. */
static void swap(const sc_step_list *list, uint64_t i, uint64_t j)
{
    sc_pair pair = list->pairs[i];
    double time = list->times[i];
    list->pairs[i] = list->pairs[j];
    list->pairs[j] = pair;
    list->times[i] = list->times[j];
    list->times[j] = time;
}

/* Entries of a list are claimed for many pairs at once, as in query/pairs.c. */
static void deliver_kind(const sc_worker *w, int kind)
{
    sc_step_worker *step = w->step;
    const sc_question *q = w->question;
    const sc_step_list *list = &step->question->list[kind];
    const uint32_t count = step->found_count[kind];
    const uint64_t at = sc_atomic_add(&w->share->claimed[kind], count);
    sc_pair *found = step->found[kind];
    uint32_t i;
    step->found_count[kind] = 0;
    if (at + count > list->capacity) {
        sc_atomic_write(&w->share->halt, 1); /* too short for certain */
        return;
    }
    for (i = 0; q->packs && i < count; i++) found[i] = sc_pairs_pack(q->prefix, found[i]);
    if (count) memcpy(list->pairs + at, found, sizeof(sc_pair) * count);
    if (count && list->times)
        memcpy(list->times + at, step->found_time[kind], sizeof(double) * count);
}

void sc_step_pairs_deliver(const sc_worker *w)
{
    deliver_kind(w, SC_STEP_VERTEX_FACE);
    deliver_kind(w, SC_STEP_EDGE_EDGE);
}

static void take_shared_of_step(const sc_worker *w, int kind, sc_pair pair, double time)
{
    sc_step_worker *step = w->step;
    step->found[kind][step->found_count[kind]] = pair;
    step->found_time[kind][step->found_count[kind]++] = time;
    if (step->found_count[kind] == SC_FOUND_MAX) deliver_kind(w, kind);
}

void sc_step_pairs_take(sc_worker *w, int kind, uint32_t a, uint32_t b, double time)
{
    sc_step_worker *step = w->step;
    const sc_step_options *o = &step->question->options;
    const sc_step_list *list = &step->question->list[kind];
    const uint64_t count = ++step->count[kind];
    sc_pair pair;
    if (kind == SC_STEP_VERTEX_FACE) step->turned += a >= SC_STEP_TURNED;
    pair.a = a;
    pair.b = b;
    if (time < step->earliest) step->earliest = time;
    if (o->output == SC_OUTPUT_ANY && o->times == SC_STEP_TIMES_NONE) {
        w->stop = 1;
        if (w->share) sc_atomic_write(&w->share->halt, 1);
    }
    if (o->output != SC_OUTPUT_PAIRS || list->capacity == 0) return;
    if (w->share) {
        take_shared_of_step(w, kind, pair, time);
        return;
    }
    if (count <= list->capacity) {
        list->pairs[count - 1] = pair;
        if (list->times) list->times[count - 1] = time;
        return;
    }
    if (count == list->capacity + 1) heapify(list, list->capacity);
    if (sc_sort_less(pair, list->pairs[0])) {
        list->pairs[0] = pair;
        if (list->times) list->times[0] = time;
        sift(list, list->capacity, 0);
    }
}

/* Entries of a list by themselves. */
static sc_step_list slice(const sc_step_list *list, uint64_t first, uint64_t count)
{
    sc_step_list part = *list;
    part.pairs += first;
    if (part.times) part.times += first;
    part.capacity = count;
    return part;
}

/* Moves entries so that none of the first is greater than one of the rest, and returns how many
   these are; as sc_sort_split, which does it where there are no times. */
static uint64_t split_list(void *context, uint64_t first, uint64_t count)
{
    sc_step_list list = slice((const sc_step_list *)context, first, count);
    uint64_t i, j, k;
    sc_pair some[9];
    if (!list.times) return sc_sort_split(list.pairs, count);
    if (SC_HARDLY(count < 9)) return 0; /* left over by unlucky splits */
    for (k = 0; k < 9; k++) some[k] = list.pairs[k * (count / 9)];
    sc_sort_pairs(some, 9);
    for (i = 0, j = count - 1;; i++, j--) { /* both ends stop at the pivot */
        while (sc_sort_less(list.pairs[i], some[4])) i++;
        while (sc_sort_less(some[4], list.pairs[j])) j--;
        if (i >= j) return i;
        swap(&list, i, j);
    }
}

/* Fewer entries are sorted by a heap, which needs no luck. */
enum { HEAP_MAX = 32 };

/* Sorts entries that have times; splits at most so many times after each other. */
static void order_timed(sc_step_list *list, uint64_t first, uint64_t count, int splits)
{
    sc_step_list rest;
    while (count > HEAP_MAX &&
           !SC_HARDLY(splits <= 0)) { /* the shorter part first, then the longer */
        uint64_t n = split_list(list, first, count);
        splits--;
        if (n < count - n) {
            order_timed(list, first, n, splits);
            first += n;
            count -= n;
        } else {
            order_timed(list, first + n, count - n, splits);
            count = n;
        }
    }
    rest = slice(list, first, count);
    heapify(&rest, count);
    while (count > 1) {
        swap(&rest, 0, --count);
        sift(&rest, count, 0);
    }
}

/* A list to be sorted, and room for some pairs. */
typedef struct list_order {
    sc_step_list list;
    uint64_t count; /* of all of it */
    sc_pair *spare;
    uint64_t room;
} list_order;

static uint64_t split_some(void *context, uint64_t first, uint64_t count)
{
    return split_list(&((list_order *)context)->list, first, count);
}

/* What is sorted by several workers has its part of the room. */
static void order_list(void *context, uint64_t first, uint64_t count)
{
    list_order *o = (list_order *)context;
    const double part = (double)o->room / (double)o->count;
    const uint64_t from = (uint64_t)(part * (double)first);
    int splits = 2;
    uint64_t n;
    for (n = count; n > 1; n >>= 1) splits += 2;
    if (o->list.times)
        order_timed(&o->list, first, count, splits);
    else
        sc_sort_in_room(o->list.pairs + first, o->spare + from,
                        (uint64_t)(part * (double)(first + count)) - from, count);
}

/* From so many pairs on, one split into parts takes less time than several into halves. */
enum { PARTS_PAY = 1 << 15 };

/* A list without times, in parts that several workers sort. */
typedef struct list_parts {
    sc_pair *pairs, *spare;
    uint64_t room; /* of each worker */
    uint64_t end[SC_SORT_PARTS];
} list_parts;

static void order_part(void *context, uint32_t part, uint32_t worker)
{
    const list_parts *p = (const list_parts *)context;
    const uint64_t first = part ? p->end[part - 1] : 0;
    sc_sort_in_room(p->pairs + first, p->spare + worker * p->room, p->room, p->end[part] - first);
}

/* Splits a list into parts and sorts them; 0: most of it is in one part. */
static int order_in_parts(const list_order *o, const sc_tasks *tasks)
{
    list_parts p;
    uint32_t part;
    if (o->list.times || o->count < PARTS_PAY) return 0;
    p.pairs = o->list.pairs;
    p.spare = o->spare;
    p.room = o->room / tasks->workers;
    sc_sort_in_parts(p.pairs, o->count, p.end);
    for (part = 0; part < SC_SORT_PARTS; part++)
        if (p.end[part] - (part ? p.end[part - 1] : 0) > o->count / 2) return 0;
    sc_jobs_run(tasks, SC_SORT_PARTS, order_part, &p);
    return 1;
}

void sc_step_pairs_finish(const sc_step_question *question, const uint64_t found[2], sc_pair *spare,
                          uint64_t room, const sc_tasks *tasks)
{
    int kind;
    if (question->options.output != SC_OUTPUT_PAIRS) return;
    for (kind = 0; kind < 2; kind++) {
        list_order o;
        o.list = question->list[kind];
        o.count = found[kind] < o.list.capacity ? found[kind] : o.list.capacity;
        o.spare = spare;
        o.room = room;
        if (!o.count) continue; /* there may be no array */
        if (!tasks)
            order_list(&o, 0, o.count);
        else if (!order_in_parts(&o, tasks))
            sc_jobs_sort(tasks, o.count, split_some, order_list, &o);
    }
}
