/*
 * The caller's array of pairs. See pairs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/pairs.h"

#include "base/sort.h"
#include "query/filter.h"

void sc_pairs_take(sc_query_state *state, uint32_t a, uint32_t b)
{
    sc_pair pair;
    if (state->filter && (state->stop || !sc_filter_admits(state, a, b))) return;
    pair.a = a;
    pair.b = b;
    state->count++;
    if (state->options.output == SC_OUTPUT_ANY) state->stop = 1;
    if (state->options.output != SC_OUTPUT_PAIRS || state->capacity == 0) return;
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

void sc_pairs_finish(sc_query_state *state)
{
    if (state->options.output == SC_OUTPUT_PAIRS)
        sc_sort_pairs(state->pairs,
                      state->count < state->capacity ? state->count : state->capacity);
}
