/*
 * Shortens the border between two sides of a patch. See refinement.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/refinement.h"

#include "base/assume.h"
#include "base/sort.h"

enum { PASSES_MAX = 4 };

/* A pass ends after this many moves without a shorter border. Tuned on the bunny: with 16, 51 instead of
   53 % of the patches of level 10 pass the tests in the rest pose; 256 changes nothing. */
enum { PATIENCE = 64 };

/* By how much the border shortens if t changes sides; *at_border: whether t has a neighbor there. */
static float gain_of(const sc_refinement *r, uint32_t t, int *at_border)
{
    float gain = 0;
    uint32_t k;
    *at_border = 0;
    for (k = 0; k < 3; k++) {
        uint32_t h = r->opposite[3 * (uint64_t)t + k];
        float length = r->lengths[3 * (uint64_t)t + k];
        if (h == SC_NONE || r->patch[h / 3] != r->patch[t]) continue;
        if (r->side[h / 3] == r->side[t]) {
            gain -= length;
        } else {
            gain += length;
            *at_border = 1;
        }
    }
    return gain;
}

static void push(sc_refinement *r, uint32_t *heap_count, uint32_t t)
{
    uint64_t at = (*heap_count)++;
    sc_pair entry;
    entry.a = sc_sort_key(r->gain[t]);
    entry.b = t;
    for (; at > 0 && sc_sort_less(r->heap[(at - 1) / 2], entry); at = (at - 1) / 2)
        r->heap[at] = r->heap[(at - 1) / 2];
    r->heap[at] = entry;
}

/* The triangle of greatest gain that may move; entries that are out of date are dropped. */
static uint32_t pop(sc_refinement *r, uint32_t *heap_count, const uint32_t size[2],
                    const uint32_t capacity[2])
{
    while (*heap_count) {
        sc_pair top = r->heap[0];
        uint32_t t = top.b, from = r->side[t];
        r->heap[0] = r->heap[--*heap_count];
        if (*heap_count) sc_sort_sift(r->heap, *heap_count, 0);
        if (r->moved[t] || top.a != sc_sort_key(r->gain[t])) continue;
        if (size[!from] >= capacity[!from]) continue;
        if (SC_NEVER(size[from] == 1))
            continue; /* no side may take all but one, see refinement.h */
        return t;
    }
    return SC_NONE;
}

static void move(sc_refinement *r, uint32_t t, uint32_t size[2])
{
    size[r->side[t]]--;
    r->side[t] = !r->side[t];
    size[r->side[t]]++;
}

/* One pass; returns whether the border became shorter. */
static int run_pass(sc_refinement *r, const uint32_t *triangles, uint32_t count, uint32_t size[2],
                    const uint32_t capacity[2])
{
    uint32_t heap_count = 0, done = 0, best_done = 0, i, k, t;
    double gained = 0, best = 1e-4;
    int at_border;
    for (i = 0; i < count; i++) {
        t = triangles[i];
        r->gain[t] = gain_of(r, t, &at_border);
        if (at_border) push(r, &heap_count, t);
    }
    while (done - best_done < PATIENCE) {
        t = pop(r, &heap_count, size, capacity);
        if (t == SC_NONE) break;
        gained += (double)r->gain[t];
        move(r, t, size);
        r->moved[t] = 1;
        r->moves[done++] = t;
        if (gained > best) {
            best = gained;
            best_done = done;
        }
        for (k = 0; k < 3; k++) {
            uint32_t h = r->opposite[3 * (uint64_t)t + k];
            if (h == SC_NONE || r->patch[h / 3] != r->patch[t] || r->moved[h / 3]) continue;
            r->gain[h / 3] = gain_of(r, h / 3, &at_border);
            if (at_border) push(r, &heap_count, h / 3);
        }
    }
    for (i = 0; i < done; i++) r->moved[r->moves[i]] = 0;
    for (i = done; i > best_done; i--) move(r, r->moves[i - 1], size);
    return best_done > 0;
}

void sc_refinement_run(sc_refinement *refinement, const uint32_t *triangles, uint32_t count,
                       uint32_t size[2], const uint32_t capacity[2])
{
    int pass;
    for (pass = 0; pass < PASSES_MAX; pass++)
        if (!run_pass(refinement, triangles, count, size, capacity)) break;
}
