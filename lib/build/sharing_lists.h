/*
 * Lists of the pairs of triangles of two leaf clusters that share points, so that a query need not
 * look for them.
 *
 * SPDX-License-Identifier: MIT
 *
 * Of each two clusters in build/sharing.h a run of words, which begins with those that
 * sc_share_word names. They tell how many pairs share just a point, and an edge or else; a row for
 * each triangle of the lower cluster that shares any: the mask of the other's; and the pairs, first
 * of points, then of edges, then what is neither (see query/neighbor_kernel.h). A pair is four
 * numbers of four bits, lowest first: both triangles, and of each the corner to begin with: the one
 * that is shared, or of two the one before the other. About 10 bytes a triangle in all.
 */
#ifndef SC_BUILD_SHARING_LISTS_H
#define SC_BUILD_SHARING_LISTS_H

#include "base/jobs.h"
#include "build/sharing.h"

enum sc_share_word {
    SC_SHARE_TRIANGLES, /* mask of those of the lower cluster that have a row */
    SC_SHARE_KINDS,     /* pairs that share a point; SC_SHARE_EDGE times those that share an edge */
    SC_SHARE_ROWS /* the first row; the first pair is behind the last, the last ends the run */
};

/* More pairs of one kind, as there may be of triangles that are the same, are among those that are
   neither. */
enum { SC_SHARE_EDGE = 256 };

static inline unsigned sc_share_points(const uint16_t *run)
{
    return run[SC_SHARE_KINDS] % SC_SHARE_EDGE;
}

static inline unsigned sc_share_edges(const uint16_t *run)
{
    return run[SC_SHARE_KINDS] / SC_SHARE_EDGE;
}

/* So many words behind the last run may be read. */
enum { SC_SHARE_BEHIND = 16 };

/* Where the lists begin that each part of a job writes, as many as there may be. */
typedef struct sc_sharing_parts {
    uint64_t begin[SC_JOBS_PARTS];
} sc_sharing_parts;

/* Words of all lists, with those behind; fills parts, for the same sharing and tasks. */
uint64_t sc_sharing_lists_count(const sc_sharing *sharing, const sc_xbvh *xbvh,
                                const sc_tasks *tasks, sc_sharing_parts *parts);

/* Writes them: where they begin, and one more, and the words. triangle has three points a place, in
   leaf order. */
void sc_sharing_lists_write(const sc_sharing *sharing, const sc_xbvh *xbvh,
                            const uint32_t *triangle, const sc_tasks *tasks,
                            sc_sharing_parts *parts, uint32_t *begin, uint16_t *list);

#endif
