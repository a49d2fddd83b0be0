/*
 * The half-edges of contours, level by level, and where contour segments start among them.
 *
 * SPDX-License-Identifier: MIT
 *
 * Loops over them are shared out among the host's tasks: parts are cut between patches where what
 * is done follows loops, for those stay in their patch.
 */
#ifndef SC_BUILD_CONTOUR_EDGES_H
#define SC_BUILD_CONTOUR_EDGES_H

#include "base/jobs.h"
#include "build/adjacency.h"
#include "build/xbvh.h"

/* Loops over half-edges, triangles and the like are cut into parts of so many at least. */
enum { SC_CONTOUR_PART_MIN = 4096 };

/* The contour half-edges of one level; a place is a number below count. What leads from level to
   level are places, so that work at a level touches only what belongs to it. */
typedef struct sc_contour_level {
    uint32_t count;
    uint32_t *half_edges; /* count */
    uint32_t *below,
        *above; /* count: places one level down and up, SC_NONE where it is none there */
    uint32_t *opposite, *next;  /* count: places; opposite: SC_NONE at the outside */
    uint32_t *inside, *outside; /* count: patches on its side and across, SC_NONE for the outside */
    uint32_t *segment, *end; /* count: of the run that starts here: its segment, its last place */
    uint8_t *cut, *start;    /* count: whether a run starts here, regardless or at all */
} sc_contour_level;

/* Does 0 to count - 1, which may be none, in parts, see sc_jobs_loop; returns how many parts. */
static inline uint32_t sc_contour_parts(const sc_scratch *scratch, uint32_t count, uint32_t least,
                                        sc_jobs_body body, void *context)
{
    return count ? sc_jobs_loop(scratch->tasks, count, least, body, context) : 0;
}

/* From what each part has to what those before it have; returns what all have. */
uint64_t sc_contour_add_up(uint64_t counts[SC_JOBS_PARTS + 1], uint32_t parts);

/* Where the first patch begins that begins at place e or after it. The places of a patch follow
   each other, so from one such place to another there are whole patches, with their loops. */
uint32_t sc_contour_patch_begin(const sc_contour_level *level, uint32_t e);

/* Collects the half-edges of all levels, which are zeroed before. */
sc_status sc_contour_edges_collect(const sc_points *points, const sc_adjacency *adjacency,
                                   const uint32_t *order, const sc_xbvh *xbvh, sc_scratch *scratch,
                                   sc_contour_level *levels);

/* Decides where runs start, from the cuts of the level above, which is NULL for the first, and the
   level's own. */
sc_status sc_contour_edges_find_starts(const sc_points *points, sc_scratch *scratch,
                                       sc_contour_level *level, sc_contour_level *above);

void sc_contour_level_give(sc_scratch *scratch, const sc_contour_level *level);

#endif
