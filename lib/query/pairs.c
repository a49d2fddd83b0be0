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
static void deliver(sc_query_state *state)
{
    sc_workspace *w = state->workspace;
    uint64_t at = sc_atomic_add(&state->share->claimed, SC_FOUND_MAX);
    w->found_count = 0;
    if (at + SC_FOUND_MAX <= state->capacity)
        memcpy(state->pairs + at, w->found, sizeof(sc_pair) * SC_FOUND_MAX);
    else
        sc_atomic_write(&state->share->halt, 1); /* too short for certain */
}

static void take_shared(sc_query_state *state, const sc_pair *pairs, uint32_t count)
{
    sc_workspace *w = state->workspace;
    uint32_t some;
    for (; count; pairs += some, count -= some) {
        some = SC_FOUND_MAX - w->found_count < count ? SC_FOUND_MAX - w->found_count : count;
        memcpy(w->found + w->found_count, pairs, some * sizeof *pairs);
        w->found_count += some;
        if (w->found_count == SC_FOUND_MAX) deliver(state);
    }
}

void sc_pairs_take(sc_query_state *state, uint32_t a, uint32_t b)
{
    sc_pair pair;
    if (state->filter && (state->stop || !sc_filter_admits(state, a, b))) return;
    pair.a = a;
    pair.b = b;
    state->count++;
    if (state->options.output == SC_OUTPUT_ANY) {
        state->stop = 1;
        if (state->share) sc_atomic_write(&state->share->halt, 1);
    }
    if (state->options.output != SC_OUTPUT_PAIRS || state->capacity == 0) return;
    if (state->share) {
        take_shared(state, &pair, 1);
        return;
    }
    if (state->count <= state->capacity) {
        state->pairs[state->count - 1] = pair;
        return;
    }
    if (state->count == state->capacity + 1) sc_sort_heapify(state->pairs, state->capacity);
    if (sc_sort_less(pair, state->pairs[0])) {
        state->pairs[0] = pair;
        sc_sort_sift(state->pairs, state->capacity, 0);
    }
}

void sc_pairs_take_all(sc_query_state *state, const sc_pair *pairs, uint32_t count)
{
    uint32_t i;
    if (!state->filter && state->options.output != SC_OUTPUT_ANY) {
        if (state->options.output == SC_OUTPUT_COUNT || state->capacity == 0) {
            state->count += count;
            return;
        }
        if (state->share) {
            state->count += count;
            take_shared(state, pairs, count);
            return;
        }
        if (state->capacity >= count && state->count <= state->capacity - count) {
            memcpy(state->pairs + state->count, pairs, count * sizeof *pairs);
            state->count += count;
            return;
        }
    }
    for (i = 0; i < count; i++) sc_pairs_take(state, pairs[i].a, pairs[i].b);
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
void sc_pairs_finish(sc_query_state *state, const sc_tasks *tasks)
{
    const uint64_t count = state->count < state->capacity ? state->count : state->capacity;
    uint64_t room;
    sc_pair *spare = sc_workspace_spare(state->model, state->workspace, &room);
    if (state->options.output != SC_OUTPUT_PAIRS || count < 2) return;
    if (count <= room)
        sc_sort_with_room(state->pairs, spare, count);
    else if (tasks)
        sc_jobs_sort(tasks, count, split_pairs, order_pairs, state->pairs);
    else
        sc_sort_pairs(state->pairs, count);
}
