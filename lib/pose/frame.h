/*
 * The frame of a query: one pose, or the two of a step, and all that is derived of it.
 *
 * SPDX-License-Identifier: MIT
 *
 * Passes over the whole mesh fill it, from the box of all positions to the boxes of all patches;
 * then all workers read it, and none writes to it. What only some queries need is made when it is
 * first needed, by the thread that asked the query: `..._ready` says whether it is there.
 */
#ifndef SC_POSE_FRAME_H
#define SC_POSE_FRAME_H

#include "base/boxes.h"
#include "build/model.h"
#include "simd/kernels.h"

/* The caller's positions of a pose, where they are. */
typedef struct sc_positions {
    const unsigned char *at; /* of vertex 0 */
    uint64_t stride;         /* in bytes */
    uint32_t type;           /* SC_FLOAT or SC_DOUBLE */
    uint32_t in_place;       /* vertices below this can be read as four doubles where they are */
    uint32_t last; /* the vertex that may be the last thing in the caller's memory: of the mesh */
} sc_positions;

/* What there is of a step besides. See step/step_motion.h. */
typedef struct sc_motion {
    float *unit;       /* 8 * vertex_count: start, 0, end, 0 in the unit box of both */
    sc_boxes boxes[2]; /* patch_end: of patches at the start and at the end */
    uint16_t
        *own_points; /* leaf_count: bit i: the leaf cluster is the first to have leaf_point i */
    sc_group *vertex_groups; /* vertex_count: room for groups of vertices, see step/step_filter.h */
    float distance;          /* in the unit box: what is farther apart does not collide */
    float margin;   /* how far apart two sets of unit must be, so that the true ones are more than
                        that distance apart */
    uint32_t rings; /* what is fewer edges of the mesh apart is not wanted; 0 or 1: all is */
    float altitude; /* what projected triangles must be higher than: distance; with rings less */
    uint32_t swept; /* boxes are those of the whole motion */
    uint32_t ends;  /* 2; 1 where nothing moves, and what is of the end need not be there, but for
                        unit */
} sc_motion;

typedef struct sc_frame {
    const sc_kernels *kernels; /* for the query at hand */
    const sc_tasks *tasks;     /* who shares in passes over the mesh, or NULL */
    uint32_t epoch;            /* of this query; what was made in another one is stale */

    sc_positions positions[2]; /* valid only in a query; the second is the end of a step */
    double low[3], high[3];    /* the box of all points; of a query */
    double center[3];          /* of that box; between objects one for all of them */
    double radius;             /* largest distance of a coordinate from center */
    double scale;   /* a power of two: scale * radius <= 1, and more than 1/2 if radius > 0 and the
                       center is that of the box */
    int fits_float; /* that and what it scales are well within the range of floats */

    float *point_at; /* 4 SC_LEAF_POINTS per leaf: x, y, z of its points in the unit box, that is
                        scale * (position - center), at most 1, and 0; in transposed places, see
                        build/loops.h */
    uint32_t leaves_ready;
    sc_boxes patch_boxes; /* patch_end */
    uint32_t boxes_ready;
    uint32_t cones_ready;
    uint16_t *mask;     /* patch_end: discrete normal cones, see pose/dnc.h */
    uint32_t *prospect; /* patch_end: where culling has prospects, see query/culling.c */
    sc_motion motion;   /* where the workspace is for steps */
} sc_frame;

#endif
