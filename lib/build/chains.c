/*
 * Chains of segments. See chains.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/chains.h"

sc_status sc_chains_take(sc_scratch *scratch, uint64_t point_count, uint64_t most,
                         sc_chains *chains)
{
    chains->next = (uint32_t *)sc_scratch_take(scratch, most, sizeof *chains->next);
    chains->old = (uint32_t *)sc_scratch_take(scratch, most, sizeof *chains->old);
    chains->start = (uint32_t *)sc_scratch_take(scratch, most, sizeof *chains->start);
    chains->end = (uint32_t *)sc_scratch_take(scratch, most, sizeof *chains->end);
    chains->starting_at =
        (uint32_t *)sc_scratch_take_filled(scratch, point_count, sizeof *chains->starting_at, 0xff);
    return chains->next && chains->old && chains->start && chains->end && chains->starting_at
               ? SC_OK
               : SC_ERROR_MEMORY;
}

void sc_chains_give(sc_scratch *scratch, sc_chains *chains)
{
    sc_scratch_give(scratch, chains->next);
    sc_scratch_give(scratch, chains->old);
    sc_scratch_give(scratch, chains->start);
    sc_scratch_give(scratch, chains->end);
    sc_scratch_give(scratch, chains->starting_at);
}

/* Links what follows segment i, which is in no list any more; returns the last that does. *left:
   how many are in lists. */
static uint32_t walk(const sc_chains *c, uint32_t i, uint32_t *left)
{
    for (;; --*left) {
        uint32_t *list = &c->starting_at[c->end[i]], j = *list;
        if (j == SC_NONE) return i;
        *list = c->next[j];
        c->next[i] = j;
        i = j;
    }
}

/* Takes the first of the segments that start at a point, and what follows it; returns the last. */
static uint32_t take_chain(const sc_chains *c, uint32_t point, uint32_t *first, uint32_t *left)
{
    *first = c->starting_at[point];
    c->starting_at[point] = c->next[*first];
    --*left;
    return walk(c, *first, left);
}

/* Orders segments of which no two start at one point: each has one way on. */
static uint32_t order_loops(const sc_chains *c, uint32_t *segments, uint32_t count)
{
    uint32_t i, at, n = 0, chains = 0;
    for (i = 0; n < count; i++) {
        if (c->starting_at[c->start[i]] == SC_NONE) continue;
        chains++;
        for (at = i; at != SC_NONE; at = c->starting_at[c->end[at]]) {
            c->starting_at[c->start[at]] = SC_NONE;
            segments[n++] = c->old[at];
        }
    }
    return chains;
}

uint32_t sc_chains_order(const sc_chains *c, uint32_t *segments, uint32_t count)
{
    uint32_t i, at, before, last, inserted, n = 0, chains = 0, left = count, twice = 0;
    for (i = count; i-- > 0;) {
        uint32_t segment = segments[i], start = c->points[c->first[segment]];
        uint32_t *list = &c->starting_at[start];
        c->old[i] = segment;
        c->start[i] = start;
        c->end[i] = c->points[c->last[segment]];
        c->next[i] = *list;
        twice |= *list != SC_NONE;
        *list = i;
    }
    if (!twice) return order_loops(c, segments, count);
    for (i = 0; left; i++) {
        uint32_t point = c->start[i];
        if (c->starting_at[point] == SC_NONE) continue;
        chains++;
        last = take_chain(c, point, &at, &left);
        c->next[last] = SC_NONE;
        segments[n] = c->old[at];
        for (before = at, at = c->next[at]; at != SC_NONE; before = at, at = c->next[at]) {
            point = c->start[at];
            if (left && c->starting_at[point] != SC_NONE) {
                last = take_chain(c, point, &inserted, &left);
                c->next[last] = at;
                c->next[before] = inserted;
                at = inserted;
            }
            segments[++n] = c->old[at];
        }
        n++;
    }
    return chains;
}
