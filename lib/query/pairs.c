/*
 * The caller's array of pairs. See pairs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/pairs.h"

#include <string.h>

#include "base/atomic.h"
#include "base/jobs.h"
#include "base/sort.h"
#include "query/filter.h"

/* Entries of the caller's array are claimed for many pairs at once, so that no two workers write to
   one. */
void sc_pairs_deliver(sc_worker *w)
{
    const sc_question *q = w->question;
    const uint32_t count = w->found_count;
    const uint64_t at = sc_atomic_add(&w->share->claimed[0], count);
    uint32_t i;
    w->found_count = 0;
    for (i = 0; q->packs && i < count; i++) w->found[i] = sc_pairs_pack(q->prefix, w->found[i]);
    if (at + count > q->capacity)
        sc_atomic_write(&w->share->halt, 1); /* too short for certain */
    else if (count)
        memcpy(q->pairs + at, w->found, sizeof(sc_pair) * count);
}

static void take_shared(sc_worker *w, const sc_pair *pairs, uint32_t count)
{
    uint32_t some;
    for (; count; pairs += some, count -= some) {
        some = SC_FOUND_MAX - w->found_count < count ? SC_FOUND_MAX - w->found_count : count;
        memcpy(w->found + w->found_count, pairs, some * sizeof *pairs);
        w->found_count += some;
        if (w->found_count == SC_FOUND_MAX) sc_pairs_deliver(w);
    }
}

void sc_pairs_take(sc_worker *w, uint32_t a, uint32_t b)
{
    const sc_question *q = w->question;
    sc_pair pair;
    if (q->filter && (w->stop || !sc_filter_admits(w, a, b))) return;
    pair.a = a;
    pair.b = b;
    w->count++;
    /* the caller's function may have set the flag: it is not to be called again then */
    if (q->filter && q->options.cancel) sc_worker_ask_flag(w);
    if (q->options.output == SC_OUTPUT_ANY) {
        w->stop = 1;
        if (w->share) sc_atomic_write(&w->share->halt, 1);
    }
    if (q->options.output != SC_OUTPUT_PAIRS || q->capacity == 0) return;
    if (w->share) {
        take_shared(w, &pair, 1);
        return;
    }
    if (w->count <= q->capacity) {
        q->pairs[w->count - 1] = pair;
        return;
    }
    if (w->count == q->capacity + 1) sc_sort_heapify(q->pairs, q->capacity);
    if (sc_sort_less(pair, q->pairs[0])) {
        q->pairs[0] = pair;
        sc_sort_sift(q->pairs, q->capacity, 0);
    }
}

void sc_pairs_take_all(sc_worker *w, const sc_pair *pairs, uint32_t count)
{
    const sc_question *q = w->question;
    uint32_t i;
    if (!q->filter && q->options.output != SC_OUTPUT_ANY) {
        if (q->options.output == SC_OUTPUT_COUNT || q->capacity == 0) {
            w->count += count;
            return;
        }
        if (w->share) {
            w->count += count;
            take_shared(w, pairs, count);
            return;
        }
        if (q->capacity >= count && w->count <= q->capacity - count) {
            memcpy(q->pairs + w->count, pairs, count * sizeof *pairs);
            w->count += count;
            return;
        }
    }
    for (i = 0; i < count; i++) sc_pairs_take(w, pairs[i].a, pairs[i].b);
}

static uint64_t split_pairs(void *context, uint64_t first, uint64_t count)
{
    return sc_sort_split((sc_pair *)context + first, count);
}

static void order_pairs(void *context, uint64_t first, uint64_t count)
{
    sc_sort_pairs((sc_pair *)context + first, count);
}

/* With room besides, one thread takes no longer than two, each of which needs what the other has in
   its cache. */
void sc_pairs_finish(const sc_question *question, uint64_t found, sc_pair *spare, uint64_t room,
                     const sc_tasks *tasks)
{
    const uint64_t count = found < question->capacity ? found : question->capacity;
    if (question->options.output != SC_OUTPUT_PAIRS || count < 2) return;
    if (count <= room)
        sc_sort_with_room(question->pairs, spare, count);
    else if (tasks)
        sc_jobs_sort(tasks, count, split_pairs, order_pairs, question->pairs);
    else
        sc_sort_pairs(question->pairs, count);
}
