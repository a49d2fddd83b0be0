/*
 * The caller's lists of a step. See step_pairs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_pairs.h"

#include "base/sort.h"

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

static void swap(const sc_step_list *list, uint64_t i, uint64_t j)
{
    sc_pair pair = list->pairs[i];
    list->pairs[i] = list->pairs[j];
    list->pairs[j] = pair;
    if (list->times) {
        double time = list->times[i];
        list->times[i] = list->times[j];
        list->times[j] = time;
    }
}

void sc_step_pairs_take(sc_step_state *state, int kind, uint32_t a, uint32_t b, double time)
{
    sc_step_list *list = &state->list[kind];
    sc_pair pair;
    pair.a = a;
    pair.b = b;
    list->count++;
    if (time < state->earliest) state->earliest = time;
    if (state->options.output == SC_OUTPUT_ANY && state->options.times == SC_STEP_TIMES_NONE)
        state->query.stop = 1;
    if (state->options.output != SC_OUTPUT_PAIRS || list->capacity == 0) return;
    if (list->count <= list->capacity) {
        list->pairs[list->count - 1] = pair;
        if (list->times) list->times[list->count - 1] = time;
        return;
    }
    if (list->count == list->capacity + 1) heapify(list, list->capacity);
    if (sc_sort_less(pair, list->pairs[0])) {
        list->pairs[0] = pair;
        if (list->times) list->times[0] = time;
        sift(list, list->capacity, 0);
    }
}

void sc_step_pairs_finish(sc_step_state *state)
{
    int kind;
    if (state->options.output != SC_OUTPUT_PAIRS) return;
    for (kind = 0; kind < 2; kind++) {
        const sc_step_list *list = &state->list[kind];
        uint64_t count = list->count < list->capacity ? list->count : list->capacity;
        if (!list->times) {
            sc_sort_pairs(list->pairs, count);
            continue;
        }
        heapify(list, count);
        while (count > 1) {
            swap(list, 0, --count);
            sift(list, count, 0);
        }
    }
}
