/*
 * The contour segment forest (CSF; paper, section 6.1): the contours of all patches, shared between
 * levels.
 *
 * SPDX-License-Identifier: MIT
 *
 * A contour segment is a maximal run of half-edges of a patch that all border on the same other
 * patch of its level, or on the outside, one half-edge leading to the next. Invariant: the
 * half-edges of a segment are the ordered union of its children's, which are segments of the level
 * below; a segment that a level leaves as it was is the same segment.
 *
 * Two cuts are added, at every level from the first that needs them downwards: a run that is a
 * closed loop starts somewhere, and such a loop and the free boundary are cut where the rest shape
 * turns by more than about 75 degrees from the run's start, for a segment that turns right round
 * fails every contour test.
 *
 * Half-edges of irregular edges border on the outside, so a contour may hold an edge and its
 * reverse; that culls less and loses nothing, since they cancel in every winding number.
 *
 * Segments 0 to leaf_count - 1 have no children; the others are lists of two or more with lower
 * numbers. The points of every segment, n + 1 for n half-edges, are one range of an array, in which
 * the ranges of its children follow each other, the last point of one being the first of the next.
 */
#ifndef SC_BUILD_CSF_H
#define SC_BUILD_CSF_H

#include "build/sctt.h"

/* So many leaf clusters have numbers for their points in 16 bits, and the length of a loop has as
   many. Loops in pieces have so many of these, and of edges, at most: others are long contours of
   large patches, which seldom pass. */
enum {
    SC_LOOP_LEAVES = 65536 / SC_LEAF_POINTS,
    SC_LOOP_MAX = 65535,
    SC_LOOP_PIECES = 16,
    SC_LOOP_PIECES_EDGES = 100
};

/* Scratch memory. */
typedef struct sc_csf {
    uint32_t segment_count, leaf_count;
    uint32_t *point_first; /* segment_count: place of the segment's first point in points */
    uint32_t *point_last;  /* segment_count: place of its last */
    uint32_t *points;      /* point_count */
    uint32_t *half_edges; /* point_count: one that starts there; the segment's own, if it goes on */
    uint32_t point_count;
    uint32_t *child_first; /* segment_count - leaf_count + 1: children of segment leaf_count + i */
    uint32_t *children;    /* child_first[segment_count - leaf_count] */
    /* The segments round the patches of each node of the self-collision test tree: around their
       union, or, for a pair that shares one point (sctt.touch), that point, the number of segments
       of its first patch, those, and those of its second. Each list is of closed chains, see
       build/chains.h. */
    uint32_t *contour_first; /* node_count + 1 */
    uint32_t *contours;      /* contour_first[node_count] */
    uint8_t *in_pieces;      /* node_count: 1 if there is more than one chain */
    /* Loops: how long each node's is; 0 for those in many pieces or long ones, and those of more
       than SC_LOOP_LEAVES leaf clusters or SC_LOOP_MAX edges. See build/loops.h. */
    uint32_t *loop_first;     /* node_count + 1 */
    uint32_t *level_segments; /* level_count: segments of each level */
    uint32_t contour_max;     /* points of the segments round a node, at most */
} sc_csf;

sc_status sc_csf_build(const sc_points *points, const sc_adjacency *adjacency,
                       const uint32_t *order, const sc_xbvh *xbvh, const sc_sctt *sctt,
                       sc_scratch *scratch, sc_csf *csf);

/* For debug builds and tests: 1 if children lead into each other and have one parent at most. */
int sc_csf_validate(const sc_csf *csf, const sc_sctt *sctt, sc_scratch *scratch);

#endif
