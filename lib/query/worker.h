/*
 * A worker: who does a query, or some parts of one, by itself.
 *
 * SPDX-License-Identifier: MIT
 *
 * All workers of a query read the same model, frame and question. All else here is a worker's own:
 * lists of what waits to be looked at, room to look at it, what it found and what it counted. So
 * they need no locks; what they have in common and write to is the sc_share.
 */
#ifndef SC_QUERY_WORKER_H
#define SC_QUERY_WORKER_H

#include <stddef.h>

#include "base/atomic.h"
#include "base/clock.h"
#include "pose/contour_bounds.h"
#include "query/lists.h"
#include "query/simple_contour.h"

struct sc_worker;
struct sc_step_question;
struct sc_near_question;
struct sc_near_worker;
struct sc_workspace;

/* What a query is asked, checked and complete; and the caller's array. */
typedef struct sc_question {
    sc_query_options options;
    const sc_filter *filter; /* or NULL; what follows comes from it */
    int sifts;           /* it has groups, which drop pairs of triangles before they are tested */
    int drops_neighbors; /* of triangles that share a vertex nothing is wanted */
    int has_last;   /* leaf clusters by themselves wait until all else is done, as contours of two
                     tell of most that nothing in them meets; the frame has normal cones of them */
    int opens_all;  /* nodes are opened even where culling has no prospects, query/culling.c */
    int timed;      /* statistics are wanted: clocks are read */
    int ends_early; /* the first pair or a budget may end it: pairs do not wait for long */
    /* The contour test of some nodes: passed[i] says whether nothing in nodes[i] can meet. */
    void (*test)(struct sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed);
    const struct sc_step_question *step; /* what a step is asked besides, step/step_worker.h; NULL:
                                            it is none */
    const struct sc_near_question *near; /* what is asked of what is near, near/near_worker.h; then
                                            it is a step that stays where it is; or NULL */
    sc_pair *pairs;                      /* the caller's array */
    uint64_t capacity;
    int keeps; /* what is made of the pose may be needed by a later query, of an object */
    struct sc_workspace *second; /* of the second of two objects, whose pose is read and boxes made,
                                    if pairs between two are sought; or NULL */
    int one_room;    /* which has its room where the first has it, see run/workspace.h */
    uint32_t packs;  /* 1: it is one of several whose pairs go to one array: sc_pairs_pack */
    uint32_t prefix; /* what tells its pairs from theirs: twice its number, and 1 if all of its
                        pairs are turned */
} sc_question;

/* What the workers of a query have in common and write to, see run/plan.c. */
typedef struct sc_share {
    size_t claimed[2]; /* entries of the caller's array, or of the two of a step, that were given
                          out, perhaps beyond its end */
    uint32_t halt;     /* enough is known */
} sc_share;

/* What waits for tests of other nodes, since it may turn out that it need not be looked at: a patch
   that is in a node of two that was culled is culled with it, and a leaf cluster by itself is, with
   another one that shares points with it and is dropped. */
typedef struct sc_last {
    uint32_t *self;  /* patch_end: nodes of one patch to test, and those tested */
    uint32_t *alone; /* leaf_count: leaf clusters to look at by themselves, as items of lists */
    uint32_t self_count, alone_count;
    uint32_t self_first, self_end; /* those nodes that are tested now */
    uint8_t *culled; /* patch_end: 1 if in a node that passed, as far as may be looked at */
    uint8_t *marks;  /* patch_end: where that is written down; the same, if one worker does all */
} sc_last;

/* Points near a triangle or an edge in number of edges, as far as they were sought; see
   query/filter.h. */
typedef struct sc_ball {
    uint16_t *epoch_of; /* vertex_count: epoch if in the ball */
    uint32_t *queue;    /* point_count: tail points in the ball; of those from head on the neighbors
                           are not yet in it */
    uint32_t head, tail;
    uint32_t steps;  /* edges by which it may still grow */
    uint32_t center; /* the number of what it is round, or SC_NONE: of nothing */
    uint16_t epoch;
    uint16_t kind; /* as which that number is meant: SC_FILTER_... */
} sc_ball;

/* Pairs that a worker collects before it gives them to the caller's array. */
enum { SC_FOUND_MAX = 256 };

typedef struct sc_worker {
    const sc_model *model;
    sc_frame *frame;
    const sc_question *question;
    const sc_hooks *hooks;
    sc_share *share;          /* NULL, if one worker does all */
    struct sc_worker *second; /* who has the model, the frame and what is kept of leaf clusters for
                                 the second of pairs: itself; between two objects a worker of the
                                 other's workspace */

    sc_contour_edges contour;  /* room for a contour under the projection at hand */
    sc_contour_bounds *bounds; /* for the star test; only one worker makes it */
    sc_lists lists;
    sc_last last;
    sc_kept_leaves kept;
    sc_ball ball;
    struct sc_step_worker *step; /* step/step_worker.h; NULL where the workspace is not for steps */
    struct sc_near_worker *near; /* near/near_worker.h; NULL where it is not for what is near */

    sc_pair *found; /* SC_FOUND_MAX pairs that are not yet in the caller's array */
    uint32_t found_count;
    uint64_t count; /* pairs found */

    int stop;       /* enough is known, or the query is to end early */
    int incomplete; /* it is to end early */
    uint32_t task;  /* what the clock runs for */
    uint64_t last_time;
    double follow_part; /* of the last box or primitive tests, those that follow a contour test */
    sc_stats stats;
    sc_stats total; /* of questions that it answered by itself, each in some workspace */
    unsigned char apart[SC_ALIGNMENT]; /* no two workers write to one line of the cache */
} sc_worker;

/* Whether pairs are of two objects, and so have nothing in common, whatever their numbers. */
static inline int sc_worker_is_between(const sc_worker *w)
{
    return w->second != w;
}

/* Asks the caller's flag, and the budget. Sets stop and incomplete, and returns stop. */
int sc_worker_ask_flag(sc_worker *worker);
int sc_worker_ask_budget(sc_worker *worker);

/* Whether to stop. To be asked at least every 100 us or so. */
static inline int sc_worker_is_cancelled(sc_worker *w)
{
    if (w->share && sc_atomic_read(&w->share->halt)) w->stop = 1;
    return w->stop || (w->question->options.cancel && sc_worker_ask_flag(w));
}

/* The same, and whether the budget is used up: only where it does not depend on the flag or on
   statistics that asking comes after the same work in each run. */
static inline int sc_worker_stops(sc_worker *w)
{
    return sc_worker_is_cancelled(w) || (w->question->options.budget && sc_worker_ask_budget(w));
}

/* Lets the clock run for another task; returns the one it ran for. */
static inline uint32_t sc_worker_switch(sc_worker *w, uint32_t task)
{
    uint32_t previous = w->task;
    if (w->question->timed && task != previous) {
        uint64_t now = sc_clock_nanoseconds();
        w->stats.nanoseconds[previous] += now - w->last_time;
        w->last_time = now;
        w->task = task;
    }
    return previous;
}

/* Whether items, or what is left of them in some arithmetic, follow a failed contour test: 1 or
   0. */
static inline uint32_t sc_item_follows(uint32_t item)
{
    return item >> 31;
}

/* Adds what was counted. */
void sc_worker_add_stats(sc_stats *sum, const sc_stats *stats);

/* Counts box tests or primitive tests. */
static inline void sc_worker_count_boxes(sc_worker *w, uint32_t follows, uint64_t tests)
{
    w->stats.counts[SC_TASK_BOXES_ORIENTATION +
                    (SC_TASK_BOXES_CONTOUR - SC_TASK_BOXES_ORIENTATION) * follows] += tests;
}
static inline void sc_worker_count_primitives(sc_worker *w, uint32_t follows, uint64_t tests)
{
    w->stats.counts[SC_TASK_PRIMITIVES_ORIENTATION +
                    (SC_TASK_PRIMITIVES_CONTOUR - SC_TASK_PRIMITIVES_ORIENTATION) * follows] +=
        tests;
}

/* Lists a leaf cluster to be looked at by itself; or two, where only their boxes are left to be
   looked at before. Items, of which the former follow a contour test or not. */
static inline void sc_worker_add_leaf(sc_worker *w, uint32_t leaf)
{
    sc_lists *l = &w->lists;
    w->stats.leaf_pairs++;
    if (w->question->has_last) {
        w->last.alone[w->last.alone_count++] = leaf;
        return;
    }
    l->near[0][l->count[SC_LIST_NEAR]] = leaf;
    l->near[1][l->count[SC_LIST_NEAR]++] = SC_NONE;
}
static inline void sc_worker_add_leaf_pair(sc_worker *w, uint32_t a, uint32_t b)
{
    sc_lists *l = &w->lists;
    const uint32_t at = l->count[SC_LIST_ROWS]++;
    l->row[0][at] = a;
    l->row[1][at] = b;
    l->row[2][at] = 1;
}

#endif
