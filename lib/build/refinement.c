/*
 * Shortens the border between two sides of a patch. See refinement.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/refinement.h"

#include "base/assume.h"
#include "base/sort.h"

enum { PASSES_MAX = 3 };

/* A pass ends after this many moves without a shorter border: so many, one more for so many
   triangles, so many at most. With 4 passes rather than 3 and 64 rather than 32, and 4 rather than
   2 passes in build/small_refinement.c, builds take 3 % longer, and queries on horse, bunnies and
   cats the same within the noise of 2 %. */
enum { PATIENCE_LEAST = 8, PATIENCE_TRIANGLES = 64, PATIENCE_MOST = 32 };

/* Of a triangle: it is in the list of the border, or was; it has changed sides in this pass. */
enum { LISTED = 1, MOVED = 2 };

static int is_at_border(const sc_refinement *r, uint32_t t)
{
    const uint32_t *u = r->neighbor + 3 * (uint64_t)t, across = r->label[t] ^ 1u;
    return (r->label[u[0]] == across) | (r->label[u[1]] == across) | (r->label[u[2]] == across);
}

/* By how much the border shortens if t changes sides; *at_border: whether t has a neighbor
   there. */
static float gain_of(const sc_refinement *r, uint32_t t, int *at_border)
{
    const uint32_t *u = r->neighbor + 3 * (uint64_t)t;
    const float *length = r->lengths + 3 * (uint64_t)t;
    float gain = 0;
    uint32_t k;
    *at_border = 0;
    for (k = 0; k < 3; k++) {
        static const float part[3] = {-1, 1, 0}; /* on the same side, across, of another patch */
        uint32_t difference = r->label[u[k]] ^ r->label[t];
        gain += part[difference < 2 ? difference : 2] * length[k];
        *at_border |= difference == 1;
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
        uint32_t t = top.b, from = r->label[t] & 1;
        r->heap[0] = r->heap[--*heap_count];
        if (*heap_count) sc_sort_sift(r->heap, *heap_count, 0);
        if (r->state[t] & MOVED || top.a != sc_sort_key(r->gain[t])) continue;
        if (size[!from] >= capacity[!from]) continue;
        if (SC_NEVER(size[from] == 1))
            continue; /* no side may take all but one, see refinement.h */
        return t;
    }
    return SC_NONE;
}

static void move(sc_refinement *r, uint32_t t, uint32_t size[2])
{
    size[r->label[t] & 1]--;
    r->label[t] ^= 1;
    size[r->label[t] & 1]++;
}

static void list(sc_refinement *r, uint32_t t)
{
    if (r->state[t] & LISTED) return;
    r->state[t] |= LISTED;
    r->border[r->border_count++] = t;
}

/* One pass; returns whether the border became shorter. */
static int run_pass(sc_refinement *r, uint32_t size[2], const uint32_t capacity[2],
                    uint32_t patience)
{
    uint32_t heap_count = 0, done = 0, best_done = 0, i, k, t;
    double gained = 0, best = 1e-4;
    int at_border;
    for (i = 0; i < r->border_count; i++) {
        t = r->border[i];
        r->gain[t] = gain_of(r, t, &at_border);
        if (at_border) push(r, &heap_count, t);
    }
    while (done - best_done < patience) {
        t = pop(r, &heap_count, size, capacity);
        if (t == SC_NONE) break;
        gained += (double)r->gain[t];
        move(r, t, size);
        r->state[t] |= MOVED;
        r->moves[done++] = t;
        if (gained > best) {
            best = gained;
            best_done = done;
        }
        for (k = 0; k < 3; k++) {
            uint32_t u = r->neighbor[3 * (uint64_t)t + k];
            if ((r->label[u] ^ r->label[t]) > 1 || r->state[u] & MOVED) continue;
            list(r, u);
            r->gain[u] = gain_of(r, u, &at_border);
            if (at_border) push(r, &heap_count, u);
        }
    }
    for (i = 0; i < done; i++) r->state[r->moves[i]] &= (uint8_t)~MOVED;
    for (i = done; i > best_done; i--) move(r, r->moves[i - 1], size);
    return best_done > 0;
}

void sc_refinement_run(sc_refinement *r, const uint32_t *triangles, uint32_t count,
                       uint32_t size[2], const uint32_t capacity[2])
{
    uint32_t patience = PATIENCE_LEAST + count / PATIENCE_TRIANGLES, i, n = 0;
    int pass;
    if (patience > PATIENCE_MOST) patience = PATIENCE_MOST;
    r->border_count = 0;
    for (i = 0; i < count; i++)
        if (is_at_border(r, triangles[i])) list(r, triangles[i]);
    for (pass = 0; pass < PASSES_MAX; pass++)
        if (!run_pass(r, size, capacity, patience)) break;
    for (i = 0; i < r->border_count; i++) {
        uint32_t t = r->border[i];
        r->state[t] = 0;
        if (is_at_border(r, t)) r->border[n++] = t;
    }
    r->border_count = n;
}
