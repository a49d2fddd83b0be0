/*
 * How many patches of each level are connected through edges.
 *
 * SPDX-License-Identifier: MIT
 *
 * The triangles of a leaf cluster fall into parts that hang together. Edges between parts of
 * different leaf clusters, fewer at each level up, wait for a patch that has both of their
 * triangles. Cost: linear in triangles, and in these edges at each level.
 */
#ifndef SC_BUILD_CONNECTED_H
#define SC_BUILD_CONNECTED_H

#include "build/adjacency.h"
#include "build/xbvh.h"

/* What is needed to find out; scratch memory. */
typedef struct sc_connected {
    uint32_t *place;    /* triangle_count: of each triangle in the hierarchy's order */
    uint32_t *parent;   /* of each part, one before it of the same piece, or itself */
    uint32_t *patch_at; /* leaf_count: the patch, of the level at hand, of each leaf cluster */
    uint32_t *pieces;   /* patch_end: of each patch, how many there are; 0 at first */
    uint32_t *of;       /* triangle_count: the part of the triangle at a place */
    uint32_t *leaf;     /* of each part, as many as triangles at most */
    uint32_t count;     /* parts */
    sc_pair *joints;    /* two parts of different leaf clusters for each edge between those */
    uint64_t joint_count;
} sc_connected;

/* Takes the memory: SC_OK or SC_ERROR_MEMORY. */
sc_status sc_connected_take(const sc_xbvh *xbvh, sc_scratch *scratch, sc_connected *c);

/* The connected patches of each level. order: the hierarchy's. */
void sc_connected_count(const sc_adjacency *adjacency, const uint32_t *order, const sc_xbvh *xbvh,
                        sc_connected *c, uint32_t *connected);

void sc_connected_give(sc_scratch *scratch, sc_connected *c);

#endif
