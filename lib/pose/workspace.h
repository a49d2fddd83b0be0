/*
 * The workspace: everything that a query writes to, in one block.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_workspace | patch boxes | mask | prospect | point_at | bounds or all_ready |
 *       bounds_tick | all_known | motion | own arrays | view | view | ... |
 *
 * Own arrays are those that only one thread may write to: contour, walk,
 * some_ready, some_known, slab, far_pairs, near_list, near_pairs, candidates, neighbors, ball,
 * ball_queue, found, state, motion's from made to state. For each worker but the first there is a
 * view: an sc_workspace with the pose of the first, and own arrays.
 *
 * The star test's bounds and leaf clusters made ready are never needed by one query, so they share
 * their memory; what tells whether they are of this query stands elsewhere. There is no room for
 * all leaf clusters in a query with the star test; several workers divide that room, where it is
 * more than they have by themselves. A step needs neither of them, nor point_at, which stands next
 * to them: together they have room for all leaf clusters made ready for a step.
 *
 * Arrays start at multiples of SC_ALIGNMENT. It keeps nothing from one query to the next but clock
 * ticks, by which what an earlier query left is known to be stale.
 */
#ifndef SC_POSE_WORKSPACE_H
#define SC_POSE_WORKSPACE_H

#include "base/boxes.h"
#include "simd/kernels.h"
#include "build/model.h"

/*
 * The lower bound of a bundle of lines (paper, section 6.4): none of the lines is below
 *   the line through (ax, ay) with slope most for x <= ax,
 *   the chord from (ax, ay) to (bx, by) between,
 *   the line through (bx, by) with slope least for x >= bx;
 * and the edges that the lines prolong lie within [ax, bx]. No edges: ax > bx. Nothing known, not
 * even the extent: ay is -infinity, and [ax, bx] all there is.
 */
typedef struct sc_ray_bound {
    float ax, ay, bx, by, least, most;
} sc_ray_bound;

/* Of a contour segment under one projection, for one search line: its top edges, and its bottom
   edges turned upside down. */
typedef struct sc_segment_bounds {
    sc_ray_bound side[2];
} sc_segment_bounds;

/* A projection R^3 -> R^2: x = u . (p - origin), y = w . (p - origin), u and w small integers. */
typedef struct sc_projection {
    double u[3], w[3], origin[3];
    double x_error, y_error; /* |computed - true| at most */
} sc_projection;

/* Points of a contour are projected in blocks of SC_CONTOUR_BLOCK. A step tests edges with the next
   SC_CONTOUR_NEAR: all of their own run of SC_CONTOUR_RUN and the next. */
enum { SC_CONTOUR_BLOCK = 16, SC_CONTOUR_RUN = 4, SC_CONTOUR_NEAR = 2 * SC_CONTOUR_RUN - 1 };

/* Room for the boxes of so many spans, with those that are read beyond: full blocks, and two
   more. */
#define SC_CONTOUR_SPANS(count)                                                                    \
  (((count) + SC_CONTOUR_BLOCK - 1) / SC_CONTOUR_BLOCK * SC_CONTOUR_BLOCK + 2 * SC_CONTOUR_BLOCK)

/* Contours of a query that are looked at in turn: how many, the points of one at most, and the room
   for it: points with those that are read beyond, and boxes of spans. */
enum {
    SC_CONTOUR_TURNS = 4,
    SC_CONTOUR_SHORT = 112,
    SC_CONTOUR_ROOM = SC_CONTOUR_SHORT + SC_CONTOUR_BLOCK,
    SC_CONTOUR_SPAN_ROOM = 208,
    SC_CONTOUR_BITS_ROOM = SC_CONTOUR_ROOM / SC_CONTOUR_BLOCK + 3
};

/* Pieces of a contour that is stored as a loop are listed in so many places each, or a multiple of
   that: then spans of as many edges are of one piece. */
enum { SC_CONTOUR_GAP = 4 };

/* Sides of boxes in the plane. */
enum { SC_LOW_X, SC_HIGH_X, SC_LOW_Y, SC_HIGH_Y };

/*
 * The projected contour of a node, see query/simple.c: a list of points, of which point i and the
 * next are edge i, but where a chain ends. Room for model.contour_max points, what gaps between
 * pieces of loops add, and two blocks more; or for those that are looked at in turn, one after the
 * other.
 */
typedef struct sc_contour_edges {
    uint32_t *point;      /* what points they are */
    float *at[2];         /* x and y */
    float *span_side[4];  /* boxes of spans of 2, 4, 8... edges, see query/simple_kernel.h */
    float *run_side[4];   /* of steps: boxes of runs, and 16 more */
    float *group_side[4]; /* of steps: boxes of 16 runs, and 16 more */
    uint16_t *is_edge;    /* bit i of block b: SC_CONTOUR_BLOCK b + i is an edge */
    float *wall;          /* if there are gaps: infinity for what is no edge, -infinity for edges */
} sc_contour_edges;

/*
 * Where a query with the exact contour test is, see query/traversal.c. The stack holds what failed
 * of some full queues, each from deeper levels than the one before; and for each of these, brothers
 * of what is looked at.
 */
enum { SC_WALK_QUEUE = 60, SC_WALK_CHILDREN = 4, SC_WALK_PAIRS = 64 };

typedef struct sc_walk {
    uint32_t
        *stack; /* n (SC_WALK_QUEUE + n SC_WALK_CHILDREN), n = level_count + 1: nodes that failed */
    uint32_t *queue; /* SC_WALK_QUEUE + SC_WALK_CHILDREN: nodes to test */
    uint32_t *self;  /* leaf_count: nodes of one patch to test, if need be, after all others */
    uint8_t *culled; /* patch_end: 1 if in a node that passed, as far as may be looked at */
    uint8_t *marks;  /* patch_end: where that is written down; the same, if one worker does all */
    uint32_t *alone; /* leaf_count: twice the leaf clusters to look at by themselves, if need be,
                        after all others; and 1 after a contour test */
    uint32_t stack_count, queue_count, self_count, alone_count;
    uint32_t selfs_wait;
    sc_pair pairs[2]
                 [SC_WALK_PAIRS]; /* of patches that are left to boxes; [1] after a contour test */
    uint32_t pair_count[2];
} sc_walk;

enum { SC_CANDIDATES_MAX = 1024 };

/* A leaf cluster made ready for tests of its triangles, in the unit box; see query/ready_kernel.h.
   Rows are filled with the last triangle. */
typedef struct sc_leaf_ready {
    float side[6][SC_LEAF_MAX]; /* boxes; what is no triangle is NaN and overlaps nothing */
    float normal[3][SC_LEAF_MAX];
    float offset[SC_LEAF_MAX]; /* where the first corner is along the normal */
    float size[SC_LEAF_MAX];   /* |e|1 + |f|1, e and f the edges from the first corner */
} sc_leaf_ready;

enum { SC_READY_ROWS = sizeof(sc_leaf_ready) / (SC_LEAF_MAX * sizeof(float)) };

/* Which leaf cluster is kept ready, and in which pose it was made so, 0 for never; and the largest
   extent of its box. */
typedef struct sc_leaf_known {
    uint32_t leaf, tick;
    float extent;
} sc_leaf_known;

/* Where the points of a leaf cluster are along its mean normal, about, at least and at most. */
typedef struct sc_leaf_slab {
    float direction[3], ends[2];
    uint32_t tick; /* of the pose; 0: nothing yet */
} sc_leaf_slab;

/* Where not all leaf clusters are kept ready, so many are at most, of each side of pairs: a power
   of two. */
enum { SC_READY_KEPT = 32 };

/* As ready_mask: every leaf cluster has a place. */
#define SC_KEEPS_ALL 0xffffffffu

/* Pairs of leaf clusters that wait to be looked at, at most, of each kind. */
enum { SC_LEAF_QUEUE = 1024 };

/* Two leaf clusters, a <= b, and where sc_model_share_leaf has them, or SC_NONE if they are one;
   and what sc_model_share_touch has, or SC_TOUCH_CHAIN if they are one that goes round a tube, with
   SC_NEAR_DROPPED when nothing is left to be looked at. */
typedef struct sc_near_pair {
    uint32_t a, b, shared, known;
} sc_near_pair;

enum { SC_NEAR_DROPPED = 1 << 16 };

/* Sides of boxes that move, three each: x, y, z. */
enum { SC_START_LOW = 0, SC_START_HIGH = 3, SC_END_LOW = 6, SC_END_HIGH = 9, SC_MOTION_SIDES = 12 };

/* A box that moves: its three lows at the start, from the fourth on at the end, and likewise its
   highs. */
typedef struct sc_moving_box {
    float low[8], high[8];
} sc_moving_box;

/* A leaf cluster made ready for a step, in the unit box; see step/leaf_motion_kernel.h. Rows are
   filled with the last point or triangle. */
typedef struct sc_leaf_motion {
    float at[2][3][SC_LEAF_POINTS]; /* points at the start and at the end */
    float normal[3][SC_LEAF_MAX];
    float slab[4][SC_LEAF_MAX]; /* of triangles along their normals: the lower and upper ends at the
                                   start, then at the end */
    sc_moving_box box;          /* of all points; it keeps the margin */
    float direction[3], ends[4]; /* the slab of all points, likewise */
    uint32_t leaf;
    uint16_t owned[3];   /* bit i of k: triangle i names its side k */
    uint16_t own;        /* bit i: the leaf cluster is the first to have point i */
    uint16_t triangles;  /* bit i: there is a triangle i */
    uint16_t unused[11]; /* so that rows begin where cache lines do */
} sc_leaf_motion;

/* Where there is no room for all leaf clusters, so many are kept ready at least: a power of two. */
enum { SC_LEAVES_KEPT = 64 };

/* What an sc_contour_edges lacks for the end of a step. */
typedef struct sc_moving_edges {
    float *at[2], *run_side[4], *group_side[4];
} sc_moving_edges;

/* What the query of a step writes to besides, if the workspace is for those. See
   step/step_motion.h. */
typedef struct sc_motion {
    const unsigned char
        *positions[2]; /* the caller's, at the start and at the end; valid only in a query */
    uint64_t stride[2];
    uint32_t type[2];  /* SC_FLOAT or SC_DOUBLE */
    float *unit;       /* 8 * vertex_count: start, 0, end, 0 in the unit box of both */
    sc_boxes boxes[2]; /* patch_end: of patches at the start and at the end */
    uint16_t
        *own_points;  /* leaf_count: bit i: the leaf cluster is the first to have leaf_point i */
    uint8_t *reached; /* node_count, for several workers: see step/step_parallel.c */
    sc_leaf_motion *leaves;     /* leaf cluster i made ready is at i & leaves_mask */
    uint8_t *made;              /* leaf_count + SC_LEAVES_KEPT: 1 if there is one at that place */
    sc_leaf_motion *own_leaves; /* 1 + SC_LEAVES_KEPT, or fewer in small models: the first is for
                                   the second of two that have one place */
    sc_moving_edges contour;
    sc_pair *found[2];     /* SC_FOUND_MAX each: pairs that are not yet in the caller's lists */
    double *found_time[2]; /* theirs */
    uint32_t found_count[2];
    unsigned char *state; /* SC_STEP_STATE_ROOM: this worker's sc_step_state */
    float distance;       /* in the unit box: what is farther apart does not collide */
    float margin;   /* how far apart two sets of sc_motion.unit must be, so that the true ones are
                               more than that distance apart */
    uint32_t swept; /* boxes are those of the whole motion */
    uint32_t leaves_mask; /* SC_KEEPS_ALL if all leaf clusters have a place of their own */
} sc_motion;

/* A part of a query for a worker to do by itself, see query/parallel.c. */
typedef struct sc_part {
    uint32_t kind, a, b;
} sc_part;

/* How many parts are listed at once; pairs that a worker collects; bytes for its sc_query_state. */
enum { SC_PARTS_MAX = 4096, SC_FOUND_MAX = 256, SC_STATE_ROOM = 1024 };

/* Bytes for a worker's sc_step_state. */
enum { SC_STEP_STATE_ROOM = 4096 };

struct sc_workspace {
    uint64_t bytes;
    uint64_t topology_hash; /* of the model it is for */
    sc_allocator allocator;
    uint32_t owned;            /* allocated by sc_workspace_create or _create_for */
    uint32_t flags;            /* SC_WORKSPACE_..., as it was made for */
    uint32_t workers;          /* as it was made for, 1 or more */
    unsigned char *views;      /* workers - 1 */
    uint64_t view_bytes;       /* of one; 0 if there is none */
    const sc_kernels *kernels; /* for the query at hand */
    sc_hooks hooks;

    const sc_tasks
        *tasks; /* who shares in passes over the pose; NULL but in a query, and in views */

    /* the pose; valid only in a query */
    const unsigned char *positions; /* the caller's, see pose/positions.h */
    uint64_t stride;                /* in bytes */
    uint32_t position_type;         /* SC_FLOAT or SC_DOUBLE */
    uint32_t in_place;    /* points below this can be read as four doubles where they are */
    double center[3];     /* of the box of all points */
    double radius;        /* largest distance of a coordinate from center */
    double scale;         /* a power of two: scale * radius <= 1, and more than 1/2 if radius > 0 */
    int fits_float;       /* that and what it scales are well within the range of floats */
    uint32_t last_vertex; /* of the mesh, which may be the last thing in the caller's memory */
    float *point_at; /* 4 SC_LEAF_POINTS per leaf: x, y, z of its points in the unit box, that is
                          scale * (position - center), at most 1, and 0; in turned places, see
                          build/loops.h */
    uint32_t leaves_ready, boxes_ready;
    sc_boxes patch_boxes; /* patch_end */
    uint16_t *mask;       /* patch_end: discrete normal cones, see pose/dnc.h */
    uint32_t *prospect;   /* patch_end: where culling has prospects, see query/traversal.c */
    uint32_t pose_tick;

    /* contours under the projection at hand */
    uint16_t tick;
    sc_segment_bounds *bounds[2]; /* segment_count, for the vertical and the horizontal line */
    uint16_t *bounds_tick[2];     /* segment_count: tick at which they were computed */

    sc_contour_edges contour;
    sc_walk walk;

    /* leaf cluster i is at i & ready_mask, as the upper one of two ready_upper behind. Where that
       is 0 and not all are kept, two may have one place */
    sc_leaf_ready *ready;             /* all_ready or some_ready */
    sc_leaf_known *known;             /* all_known or some_known */
    uint32_t ready_mask, ready_upper; /* the former SC_KEEPS_ALL if all are */
    sc_leaf_ready *all_ready;         /* leaf_count; 0 if there are no segments */
    sc_leaf_known *all_known;         /* the same */
    sc_leaf_ready *some_ready;        /* 2 * SC_READY_KEPT, fewer in small models */
    sc_leaf_known *some_known;        /* as many */
    sc_leaf_slab *slab;               /* leaf_count */
    uint32_t *far_pairs
        [2]; /* SC_LEAF_QUEUE that share no points and wait: the lower of two, and the other */
    uint32_t *near_list
        [2]; /* SC_LEAF_QUEUE that share points and wait, or leaf clusters against themselves: the lower of two, and shared;
                and SC_LEAF_MAX that may be written to behind */
    sc_near_pair *near_pairs; /* SC_LEAF_QUEUE: these, when they are looked at */
    uint32_t far_count, near_count;
    sc_pair *candidates; /* SC_CANDIDATES_MAX places of triangles whose boxes overlap */
    sc_pair *neighbors;  /* SC_CANDIDATES_MAX of such that share one point */
    uint32_t candidate_count, neighbor_count, found_count;

    /* points near a triangle in number of edges, see query/filter.c */
    uint16_t *ball;       /* vertex_count: ball_tick if in the ball */
    uint32_t *ball_queue; /* point_count */
    uint32_t ball_center; /* the caller's number of the triangle, or SC_NONE */
    uint16_t ball_tick;

    sc_motion motion;

    sc_pair *found; /* SC_FOUND_MAX pairs that are not yet in the caller's array: found_count */
    unsigned char *state; /* SC_STATE_ROOM: this worker's sc_query_state */

    /* for several workers */
    sc_part *parts;  /* SC_PARTS_MAX */
    uint32_t *tests; /* SC_PARTS_MAX: nodes to test */
    uint32_t *open;  /* SC_PARTS_MAX: nodes that failed */
    uint8_t *passed; /* SC_PARTS_MAX: whether they passed */
    uint8_t *culled; /* patch_end: what the workers' walk.marks say together */
};

/* Has each of so many workers keep leaf clusters ready for a step where there is room, and makes it
   forget those of the last. */
void sc_workspace_keep_motions(const sc_model *model, sc_workspace *workspace, uint32_t workers);

/* Bytes for a workspace, which fit size_t if it is for one worker. options are complete and
   checked; NULL: for plain queries by one worker. */
uint64_t sc_workspace_bytes(const sc_model *model, const sc_workspace_options *options);

/* Makes a workspace in aligned memory of that many bytes. */
sc_workspace *sc_workspace_place(const sc_model *model, const sc_workspace_options *options,
                                 void *memory);

/* Whether a workspace is for models of this topology hash, and each of its arrays as long as the
   model needs it: the hash alone does not tell, for it leaves out the rest shape, and may be
   forged. */
int sc_workspace_fits(sc_workspace *workspace, const sc_model *model);

/* That of a worker: the workspace itself, or a view. */
sc_workspace *sc_workspace_of_worker(sc_workspace *workspace, uint32_t worker);

/* Gives the views of so many workers the pose that is in the workspace. */
void sc_workspace_share(const sc_model *model, sc_workspace *workspace, uint32_t workers);

/* Memory for so many pairs, at a time when no more of the pose is needed in this query: all that
   collide are found. */
sc_pair *sc_workspace_spare(const sc_model *model, const sc_workspace *workspace, uint64_t *count);

/* Starts a pose and a projection, whose ticks make everything older stale. */
void sc_workspace_new_pose(const sc_model *model, sc_workspace *workspace);
void sc_workspace_new_projection(const sc_model *model, sc_workspace *workspace);

/* Has some leaf clusters kept ready, in arrays of the worker's own: of each pair the lower and the
   upper one at different places. */
void sc_workspace_keep_some(const sc_model *model, sc_workspace *workspace);

/* Has all leaf clusters kept ready in this pose, for which no star test is made, if there is
   room. */
void sc_workspace_keep_all(const sc_model *model, sc_workspace *workspace);

#endif
