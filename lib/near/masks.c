/*
 * Masks of what is near on the mesh. See masks.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * From each point of a leaf cluster the mesh is walked round it, as filters do, and each point that
 * is reached marked in all leaf clusters that have it. That is done twice: first to count the
 * masks, as they are in one block of memory.
 */
#include "near/masks.h"

#include <string.h>

#include "base/assume.h"
#include "base/memory.h"

typedef struct mask_walk {
    const sc_model *model;
    uint32_t rings;
    const uint32_t *owner_first; /* vertex_count + 1: of each point, */
    const uint32_t *owner;       /* which places of leaf clusters have it, as 16 leaf + i */
    uint32_t *epoch_of;          /* vertex_count: epoch where the walk has been */
    uint32_t *queue;             /* vertex_count */
    uint32_t *place;             /* leaf_count: of a leaf cluster in those found, by epoch */
    uint32_t *found;             /* leaf_count: those with which the one at hand has a mask */
    uint32_t found_count, epoch;
    sc_leaf_mask *mask; /* of those found; NULL: they are only counted */
} mask_walk;

/* Of each point, which places in leaf clusters have it. */
static int find_owners(mask_walk *w, sc_scratch *scratch)
{
    const sc_model *model = w->model;
    const uint64_t places = SC_LEAF_POINTS * (uint64_t)model->leaf_count;
    const uint32_t *point = sc_model_leaf_point(model);
    uint32_t *first = (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)model->vertex_count + 2,
                                                         sizeof *first, 0);
    uint32_t *owner = (uint32_t *)sc_scratch_take(scratch, places, sizeof *owner), v;
    uint64_t i;
    if (!first || !owner) return 0;
    for (i = 0; i < places; i++) first[(uint64_t)point[i] + 2]++;
    for (v = 0; v < model->vertex_count; v++) first[(uint64_t)v + 2] += first[(uint64_t)v + 1];
    for (i = 0; i < places; i++) owner[first[(uint64_t)point[i] + 1]++] = (uint32_t)i;
    w->owner_first = first;
    w->owner = owner;
    return 1;
}

static int begin_walk(mask_walk *w, sc_scratch *scratch)
{
    const uint32_t vertices = w->model->vertex_count, leaves = w->model->leaf_count;
    w->epoch_of = (uint32_t *)sc_scratch_take_filled(scratch, vertices, sizeof(uint32_t), 0);
    w->queue = (uint32_t *)sc_scratch_take(scratch, vertices, sizeof(uint32_t));
    w->place = (uint32_t *)sc_scratch_take_filled(scratch, leaves, sizeof(uint32_t), 0);
    w->found = (uint32_t *)sc_scratch_take(scratch, leaves, sizeof(uint32_t));
    return w->epoch_of && w->queue && w->place && w->found && find_owners(w, scratch);
}

/* Marks point i of a leaf cluster in all that have a point near it. */
static void mark_owners(mask_walk *w, uint32_t leaf, uint32_t i, uint32_t point)
{
    uint32_t k;
    for (k = w->owner_first[point]; k < w->owner_first[point + 1]; k++) {
        const uint32_t other = w->owner[k] / SC_LEAF_POINTS, j = w->owner[k] % SC_LEAF_POINTS;
        uint32_t at;
        if (other < leaf) continue;
        at = w->place[other];
        if (at >= w->found_count || w->found[at] != other) {
            at = w->place[other] = w->found_count;
            w->found[w->found_count++] = other;
            if (w->mask) memset(&w->mask[at], 0, sizeof *w->mask);
        }
        if (!w->mask) continue;
        w->mask[at].near[0][i] = (uint16_t)(w->mask[at].near[0][i] | 1u << j);
        w->mask[at].near[1][j] = (uint16_t)(w->mask[at].near[1][j] | 1u << i);
    }
}

/* Walks round point i of a leaf cluster. */
static void walk_round(mask_walk *w, uint32_t leaf, uint32_t i)
{
    const uint32_t *first = sc_model_around_first(w->model), *around = sc_model_around(w->model);
    uint32_t head = 0, tail = 0, end, step, k;
    w->epoch++;
    w->queue[tail++] = sc_model_leaf_point(w->model)[SC_LEAF_POINTS * (uint64_t)leaf + i];
    w->epoch_of[w->queue[0]] = w->epoch;
    for (step = 0;; step++) {
        for (k = head, end = tail; k < end; k++) mark_owners(w, leaf, i, w->queue[k]);
        if (step + 1 >= w->rings || head == end) return;
        for (; head < end; head++)
            for (k = first[w->queue[head]]; k < first[w->queue[head] + 1]; k++)
                if (w->epoch_of[around[k]] != w->epoch) {
                    w->epoch_of[around[k]] = w->epoch;
                    w->queue[tail++] = around[k];
                }
    }
}

/* Sorts what was found of a leaf cluster, by insertion: neighbors were mostly found in order. The
   first is the leaf cluster itself, the lowest: it has the point where the first walk begins. */
static void sort_found(mask_walk *w)
{
    uint32_t i, k;
    for (i = 1; i < w->found_count; i++) {
        const uint32_t other = w->found[i];
        sc_leaf_mask mask;
        if (w->found[i - 1] <= other) continue;
        mask = w->mask[i];
        for (k = i; SC_ALWAYS(k > 0) && w->found[k - 1] > other; k--) {
            w->found[k] = w->found[k - 1];
            w->mask[k] = w->mask[k - 1];
        }
        w->found[k] = other;
        w->mask[k] = mask;
    }
}

static void walk_leaf(mask_walk *w, uint32_t leaf)
{
    uint32_t i;
    w->found_count = 0;
    for (i = 0; i < SC_LEAF_POINTS; i++) walk_round(w, leaf, i);
}

/* Points that are near to one of two corners of a triangle, side k, or to one of all three: -1. */
static unsigned near_corners(const uint16_t *near, const uint8_t *corner, uint32_t i, int k)
{
    unsigned points = near[corner[SC_LEAF_MAX * (k < 0 ? 0 : k) + (int)i]] |
                      (unsigned)near[corner[SC_LEAF_MAX * (k < 0 ? 1 : (k + 1) % 3) + (int)i]];
    if (k < 0) points |= near[corner[SC_LEAF_MAX * 2 + (int)i]];
    return points;
}

static uint32_t triangles_of(const sc_model *model, uint32_t leaf)
{
    return sc_model_leaf_first(model)[leaf + 1] - sc_model_leaf_first(model)[leaf];
}

/* Whether a side of a leaf cluster has both ends among some points. */
static int has_side(const sc_model *model, uint32_t leaf, unsigned points)
{
    const uint8_t *corner = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)leaf;
    uint32_t i;
    int k;
    for (i = 0; i < triangles_of(model, leaf); i++)
        for (k = 0; k < 3; k++)
            if (points >> corner[SC_LEAF_MAX * k + (int)i] &
                points >> corner[SC_LEAF_MAX * ((k + 1) % 3) + (int)i] & 1u)
                return 1;
    return 0;
}

/* Whether a mask leaves any triangle of a with a point of b, or, if sides are asked about, a side
   of a with one of b. near: points of b near to those of a. */
static int leaves_some(const sc_model *model, uint32_t a, uint32_t b, const uint16_t *near,
                       int sides)
{
    const uint8_t *corner = sc_model_leaf_corner(model) + 3 * SC_LEAF_MAX * (uint64_t)a;
    uint32_t i;
    int k;
    for (i = 0; i < triangles_of(model, a); i++) {
        if (near_corners(near, corner, i, -1) != 0xffffu) return 1;
        for (k = 0; k < 3 && sides; k++)
            if (has_side(model, b, ~near_corners(near, corner, i, k) & 0xffffu)) return 1;
    }
    return 0;
}

/* Writes down of a leaf cluster with which others it has masks, and which leave nothing. */
static void name_others(const mask_walk *w, uint32_t leaf, uint32_t *other)
{
    uint32_t k;
    for (k = 0; k < w->found_count; k++) {
        const uint32_t b = w->found[k];
        const int leaves = leaves_some(w->model, leaf, b, w->mask[k].near[0], 1) ||
                           leaves_some(w->model, b, leaf, w->mask[k].near[1], 0);
        other[k] = 2 * b + (leaves ? 0 : 1);
    }
}

/* Counts the masks, makes room for them and fills it. */
static sc_status fill_masks(mask_walk *w, sc_near_masks **made)
{
    const sc_model *model = w->model;
    const uint64_t head = (sizeof(sc_near_masks) + SC_ALIGNMENT - 1) / SC_ALIGNMENT * SC_ALIGNMENT;
    sc_near_masks *m = *made;
    const sc_allocator a = m->allocator;
    uint64_t count = 0, bytes;
    uint32_t leaf, *first, *other;
    sc_leaf_mask *mask;
    unsigned char *block;
    for (leaf = 0; leaf < model->leaf_count; leaf++) {
        walk_leaf(w, leaf);
        count += w->found_count;
    }
    bytes = head + count * (sizeof *mask + sizeof *other) +
            ((uint64_t)model->leaf_count + 1) * sizeof *first;
    if (SC_HARDLY(count > 0xffffffffu || bytes > SIZE_MAX)) /* 290 gigabytes; 32-bit addresses */
        return SC_ERROR_MEMORY;
    block = (unsigned char *)a.allocate(a.user, bytes, SC_ALIGNMENT);
    if (!block) return SC_ERROR_MEMORY;
    *made = (sc_near_masks *)(void *)block;
    **made = *m;
    m = *made;
    m->bytes = bytes;
    m->mask = mask = (sc_leaf_mask *)(void *)(block + head);
    m->first = first = (uint32_t *)(void *)(mask + count);
    m->other = other = first + model->leaf_count + 1;
    for (first[0] = leaf = 0; leaf < model->leaf_count; leaf++) {
        w->mask = mask + first[leaf];
        walk_leaf(w, leaf);
        sort_found(w);
        name_others(w, leaf, other + first[leaf]);
        first[leaf + 1] = first[leaf] + w->found_count;
    }
    return SC_OK;
}

sc_status sc_masks_make(const sc_model *model, uint32_t rings, const sc_allocator *allocator,
                        sc_near_masks **masks)
{
    sc_scratch scratch;
    sc_near_masks head, *made = &head;
    mask_walk w;
    sc_status status;
    memset(&head, 0, sizeof head);
    head.allocator = *allocator;
    head.model = model;
    head.topology_hash = model->topology_hash;
    head.leaf_count = model->leaf_count;
    head.rings = rings;
    memset(&w, 0, sizeof w);
    w.model = model;
    w.rings = rings;
    sc_scratch_init(&scratch, allocator);
    status = begin_walk(&w, &scratch) ? fill_masks(&w, &made) : SC_ERROR_MEMORY;
    sc_scratch_clear(&scratch);
    if (!status) *masks = made;
    return status;
}

int sc_masks_fit(const sc_near_masks *m, const sc_model *model)
{
    return m->model == model && m->topology_hash == model->topology_hash &&
           m->leaf_count == model->leaf_count;
}
