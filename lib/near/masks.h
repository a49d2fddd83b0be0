/*
 * Masks of what is near on the mesh: which points of two leaf clusters are fewer than so many edges
 * apart.
 *
 * SPDX-License-Identifier: MIT
 *
 * A vertex and a face are within the rings of a filter if one of the face's corners is that near to
 * the vertex, and two edges if an end of one is to an end of the other. So masks of points are
 * enough, and take the place of those of points that are the same (near/near_kernel.h): these are 0
 * edges apart. What no mask is listed of is farther apart, whatever the pose.
 */
#ifndef SC_NEAR_MASKS_H
#define SC_NEAR_MASKS_H

#include "build/model.h"

/* Of two leaf clusters: bit j of near[0][i] says that point i of the lower one is that near to
   point j of the other, near[1] the same the other way round. */
typedef struct sc_leaf_mask {
    uint16_t near[2][SC_LEAF_POINTS];
} sc_leaf_mask;

struct sc_near_masks {
    uint64_t bytes;
    sc_allocator allocator;
    const sc_model *model; /* which they are of */
    uint64_t topology_hash;
    uint32_t leaf_count, rings;
    const uint32_t *first; /* leaf_count + 1: of each leaf cluster, where its masks begin */
    const uint32_t *other; /* with which leaf cluster, itself or higher ones, in order, each twice;
                                 odd: nothing of the two is left */
    const sc_leaf_mask *mask; /* as many */
};

/* Masks for a number of rings, 1 or more, in one block; SC_ERROR_MEMORY if there is none. */
sc_status sc_masks_make(const sc_model *model, uint32_t rings, const sc_allocator *allocator,
                        sc_near_masks **masks);

/* Whether they are of this model. */
int sc_masks_fit(const sc_near_masks *masks, const sc_model *model);

/* The mask of two leaf clusters, a <= b; NULL: all points are farther apart. *leaves is 0 if the
   mask leaves nothing of the two. */
static inline const sc_leaf_mask *sc_masks_find(const sc_near_masks *m, uint32_t a, uint32_t b,
                                                int *leaves)
{
    uint32_t low = m->first[a], end = m->first[a + 1], high = end;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (m->other[middle] / 2 < b)
            low = middle + 1;
        else
            high = middle;
    }
    *leaves = 1;
    if (low == end || m->other[low] / 2 != b) return NULL;
    *leaves = !(m->other[low] & 1u);
    return &m->mask[low];
}

#endif
