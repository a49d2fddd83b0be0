/*
 * The workspace: everything that a query writes to, in one block.
 *
 * SPDX-License-Identifier: MIT
 *
 *     | sc_workspace | arrays of the frame | point_at |   and its room:   | bounds or all_derived |
 *       epochs of these | arrays of the plan | sc_worker, sc_worker, ... | arrays of a worker |
 *       arrays of a worker | ... |
 *
 * What is of a pose and may be needed again is in the frame. All else is the room. A workspace may
 * use that of another one of its model; then it ends behind point_at, and one question at a time
 * has the room, or several of one call, each by one worker with a part of the room. Epochs are
 * given out by the room, so that what was made of one frame is never taken for that of another. Two
 * objects in one room are asked about by a worker and another one, of a second set, which has the
 * second object; the part of the room is halved.
 *
 * Arrays start at multiples of SC_ALIGNMENT. How long they are depends on sc_workspace_sizes alone.
 * The star test's bounds and derived data of leaf clusters are never needed by one query, so they
 * share their memory; what tells whether they are of this query stands elsewhere. There is no room
 * for all leaf clusters in a query with the star test; several workers divide that room, where it
 * is more than they have by themselves. A step needs neither of them, nor point_at, which stands
 * next to them: together they have room for what a step keeps of all leaf clusters. In a room that
 * is shared point_at is not used for that, as it may be of a pose that stays.
 *
 * It keeps nothing from one query to the next but epochs, by which what an earlier query left is
 * known to be stale.
 */
#ifndef SC_RUN_WORKSPACE_H
#define SC_RUN_WORKSPACE_H

#include "near/near_worker.h"
#include "query/pairs.h"

/* A part of a query for a worker to do by itself: an item of a list, see run/plan.c. */
typedef struct sc_part {
    uint32_t list, a, b;
} sc_part;

/* How many parts are listed at once, and large pairs of patches; and units. */
enum { SC_PARTS_MAX = 4096, SC_PLAN_PAIRS = 512, SC_UNITS_MAX = SC_PACKED_QUESTIONS };

/* An object with itself (a = b), or two, for a worker to do by itself, see run/objects_units.h. */
typedef struct sc_unit {
    uint32_t a, b;       /* their numbers */
    uint64_t count[2];   /* pairs found, of the caller's lists */
    uint64_t turned;     /* of the first of these, those in which b comes first */
    double earliest;     /* of a step, the least time of one, else 1 */
    uint32_t incomplete; /* it was to end early */
} sc_unit;

/* What is to be done, where there are several workers. */
typedef struct sc_plan_room {
    sc_unit *units;  /* SC_UNITS_MAX, while there are no parts */
    sc_part *parts;  /* SC_PARTS_MAX */
    uint32_t *tests; /* SC_PARTS_MAX: nodes to test */
    uint32_t *open;  /* SC_PARTS_MAX: nodes that failed */
    sc_pair *pairs;  /* SC_PLAN_PAIRS: of patches whose boxes overlap, as items */
    uint8_t *passed; /* SC_PARTS_MAX: whether they passed */
    uint8_t *culled; /* patch_end: what the workers' marks say together */
} sc_plan_room;

/* All that the lengths of a workspace's arrays are made of: numbers of a model, and what the
   workspace was made for. */
typedef struct sc_workspace_sizes {
    uint32_t vertices, leaves, patches, nodes, levels, segments, contour;
    uint32_t workers; /* 1 or more */
    uint32_t flags;   /* SC_WORKSPACE_... */
} sc_workspace_sizes;

/* Of how many objects behind it an object knows that their boxes come near its own. */
enum { SC_MEETS_MAX = 15 };

/* Of an object, while a call about several lasts. */
typedef struct sc_in_scene {
    struct sc_workspace *next;    /* the next object as they are swept, see run/objects_sweep.h */
    uint32_t number;              /* its own, counted from 1 */
    uint32_t meet_count;          /* how many objects behind it come near it; and their numbers, */
    uint32_t meets[SC_MEETS_MAX]; /* in order, unless they are more */
    uint32_t asks;                /* the caller's function is asked of its pairs with itself */
    uint32_t item;                /* its place in a list of a job, counted from 1; 0: in none */
} sc_in_scene;

struct sc_workspace {
    uint64_t bytes;
    uint64_t topology_hash; /* of the model it is for */
    sc_workspace_sizes sizes;
    sc_allocator allocator;
    uint32_t owned; /* allocated by sc_workspace_create or _create_for */
    sc_hooks hooks;
    sc_frame frame;
    uint64_t pose_version; /* as an object: of the pose that the frame is of, or 0, see
                              run/objects_frame.h */
    uint32_t pose_about;   /* and for which questions, SC_QUESTION_... */
    sc_in_scene scene;
    struct sc_workspace *room;    /* whose the rest is, which a pose need not keep: itself, or one
                                     that was made with SC_WORKSPACE_ROOM */
    size_t epochs;                /* of a room: how many were given out; */
    uint32_t rounds;              /* and how often that began anew */
    uint32_t round;               /* in which of these rounds the frame has its epoch */
    int spoiled;                  /* of a room: of derived data of all leaf clusters, what is known
                                     does not hold */
    sc_contour_bounds bounds;     /* the first worker's */
    sc_leaf_derived *all_derived; /* leaf_count; 0 if there are no segments */
    sc_leaf_known *all_known;     /* the same */
    sc_plan_room plan;
    sc_worker *worker;    /* sizes.workers; and of a room that others may use as many more: */
    sc_worker *others;    /* for the second of two objects in one room; else the same */
    sc_step_worker *step; /* as many as there are in all, of workspaces for steps */
    sc_near_worker *near; /* and for what is near */
};

/* Bytes for a workspace, which fit size_t if it is for one worker. options are complete and
   checked; NULL: for plain queries by one worker. */
uint64_t sc_workspace_bytes(const sc_model *model, const sc_workspace_options *options);

/* Makes a workspace in aligned memory of that many bytes. */
sc_workspace *sc_workspace_place(const sc_model *model, const sc_workspace_options *options,
                                 void *memory);

/* Whether a workspace is for models of this topology hash, and each of its arrays as long as the
   model needs it: the hash alone does not tell, for it leaves out the rest shape, and may be
   forged. */
int sc_workspace_fits(const sc_workspace *workspace, const sc_model *model);

/* Starts a query or a step by one worker, and returns it: what earlier ones left is stale. */
sc_worker *sc_workspace_begin(const sc_model *model, sc_workspace *workspace,
                              const sc_question *question);

/* The same of a query whose pose has been read and may have been looked at before: what is known
   of it stays. */
sc_worker *sc_workspace_resume(const sc_model *model, sc_workspace *workspace,
                               const sc_question *question);

/* To be called by one thread before a pose is read: makes sure that there are epochs. If these had
   to begin anew, what is known of an earlier pose is stale. keeps: the room for derived data of all
   leaf clusters is not used for anything else until the next call. */
void sc_workspace_renew(sc_workspace *workspace, int keeps);

/* What is known of an earlier pose is stale; sc_workspace_begin does both, too. */
void sc_workspace_forget(sc_workspace *workspace);

/* Whether its room is, or may be, that of others, too. */
static inline int sc_workspace_is_shared(const sc_workspace *w)
{
    return (w->room->sizes.flags & SC_WORKSPACE_ROOM) != 0;
}

/* Starts a query by one worker of several, each of which asks something else, whose pose has been
   read, and returns the worker. What it finds goes to the share. Of leaf clusters it keeps what one
   of so many parts of the room for all has room for. */
sc_worker *sc_workspace_join(const sc_model *model, sc_workspace *workspace,
                             const sc_question *question, sc_share *share, uint32_t worker,
                             uint32_t part, uint32_t parts);

/* Lets so many workers share in the query that was begun, with this question and a share that is
   zero; what the first has counted stays. */
void sc_workspace_share(const sc_model *model, sc_workspace *workspace, const sc_question *question,
                        sc_share *share, uint32_t workers);

/* Lets so many workers of a workspace serve those of another one that ask this question about two
   objects, of which the model is the second: they have its frame, and keep what is made of its leaf
   clusters. */
void sc_workspace_lend(const sc_model *model, sc_workspace *workspace, const sc_question *question,
                       uint32_t workers);

/* Lets the first worker keep the derived data of all leaf clusters in this query, in which no star
   test is made, if there is room. */
void sc_workspace_keep_all(sc_workspace *workspace);

/* Memory for so many pairs, at a time when no more of the pose is needed in this query: all that
   collide are found. */
sc_pair *sc_workspace_spare(const sc_workspace *workspace, uint64_t *count);

#endif
