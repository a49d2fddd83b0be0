/*
 * The lists of a worker: what waits for each stage of a query.
 *
 * SPDX-License-Identifier: MIT
 *
 * A stage takes items from the end of its list, writes what it cannot classify to lists further on,
 * and what it found to the worker's results; it calls no other stage. The runner calls stages
 * (run/runner.h): the last one whose list is long enough to be worth it, so that what is found is
 * decided soon, lists are short, and each stage has many items at a time: then few branches depend
 * on how many there are of one kind, and memory is asked for ahead.
 *
 * Of an item the highest bit says that a contour test failed on its way: for statistics, which tell
 * the work that follows such tests from the rest.
 */
#ifndef SC_QUERY_LISTS_H
#define SC_QUERY_LISTS_H

#include "query/kept_leaves.h"
#include "starcontour.h"

/* In the order in which items go through them; see the stages for what each is. */
typedef enum sc_list_id {
    SC_LIST_SPANS,      /* nodes of the test tree, all taken as colliding: first, and behind */
    SC_LIST_STARS,      /* nodes for the paper's star test */
    SC_LIST_FAILED,     /* nodes that failed a test, to be opened */
    SC_LIST_ORIENTED,   /* nodes with a normal cone, for the contour test */
    SC_LIST_LEFT,       /* pairs of patches that the test tree leaves to boxes */
    SC_LIST_PATCHES,    /* pairs of patches whose boxes overlap, or one twice */
    SC_LIST_ROWS,       /* leaf clusters, each with up to sixteen others */
    SC_LIST_FAR,        /* pairs of leaf clusters that share no points */
    SC_LIST_NEAR,       /* pairs of leaf clusters that share points, and leaf clusters themselves */
    SC_LIST_CLUSTERS,   /* pairs of leaf clusters that no proof has separated */
    SC_LIST_TRIANGLES,  /* triangles of one of two leaf clusters, each with some of the other */
    SC_LIST_OPEN,       /* pairs of triangles that share points */
    SC_LIST_CANDIDATES, /* pairs of triangles that share nothing */
    SC_LIST_NEIGHBORS,  /* pairs of triangles that share one point */
    SC_LIST_EXACT,      /* pairs of triangles for the exact primitives */
    SC_LIST_FACE_ROWS,  /* of a step: triangles, each with some points of a leaf cluster */
    SC_LIST_EDGE_ROWS,  /* edges, each with some sides of a leaf cluster's triangles */
    SC_LIST_FACES,      /* pairs of a vertex and a triangle for its narrow phase */
    SC_LIST_EDGES,      /* pairs of edges for that */
    SC_LIST_COUNT
} sc_list_id;

/* The highest bit of an item, and the rest of it: its number is below 2^31. */
#define SC_AFTER_CONTOUR 0x80000000u
#define SC_ITEM 0x7fffffffu

/*
 * How long lists are: so many items are worth a stage (see run/runner.c), which may add more than
 * that to the next. What is written sixteen at a time needs as much room behind the last.
 */
enum {
    SC_SPANS_MAX = 16,
    /* nodes that wait for contour tests; so many may be added at once */
    SC_NODE_CHILDREN = 4,
    SC_NODES_AT_ONCE = 16,
    SC_ORIENTED_ENOUGH = 60,
    SC_ORIENTED_MAX = SC_ORIENTED_ENOUGH + SC_NODES_AT_ONCE,
    /* pairs that nodes leave, which have no more than their children */
    SC_LEFT_ENOUGH = 64,
    SC_LEFT_MAX = SC_LEFT_ENOUGH + SC_NODE_CHILDREN,
    /* two patches have 256 pairs of descendants at the next level */
    SC_PATCHES_CHILDREN = 256,
    /* of two objects each visits every fourth level, and opening one of a pair adds 15 */
    SC_PATCHES_BETWEEN = 2 * (SC_DEPTH_MAX / 4 + 1) * 15 + 1,
    SC_ROWS_ENOUGH = 128,
    SC_ROWS_MAX = SC_ROWS_ENOUGH + SC_LEAF_MAX,
    /* pairs of leaf clusters: a row adds sixteen */
    SC_LEAF_LIST_ENOUGH = 512,
    SC_LEAF_LIST_MAX = 640,
    SC_LEAF_LIST_AT_ONCE = 256,
    SC_CLUSTERS_ENOUGH = 32,
    SC_CLUSTERS_MAX = SC_CLUSTERS_ENOUGH + SC_LEAF_LIST_AT_ONCE,
    /* pairs of triangles: two leaf clusters have 256 */
    SC_LEAF_PAIRS = SC_LEAF_MAX * SC_LEAF_MAX,
    SC_OPEN_ENOUGH = 16,
    SC_OPEN_MAX = SC_LEAF_PAIRS + 64,
    SC_CANDIDATES_ENOUGH = SC_LEAF_PAIRS,
    SC_CANDIDATES_MAX = 4 * SC_LEAF_PAIRS,
    SC_NEIGHBORS_ENOUGH = 64,
    SC_EXACT_ENOUGH = 32,
    SC_FEW_MAX = SC_LEAF_PAIRS + 64, /* of neighbors, and of pairs for exact primitives */
    /* what slabs leave of two leaf clusters in a step: triangles of both, edges of one with three
       sides of the other's triangles; and what rows list at once, or one row more */
    SC_MOVING_ROWS_ENOUGH = 64,
    SC_FACE_ROWS_MAX = SC_MOVING_ROWS_ENOUGH + 2 * SC_LEAF_MAX,
    SC_EDGE_ROWS_MAX = SC_MOVING_ROWS_ENOUGH + 9 * SC_LEAF_MAX,
    SC_MOVING_LISTED = 128,
    SC_MOVING_ENOUGH = 16,
    SC_MOVING_MAX = SC_MOVING_ENOUGH + SC_MOVING_LISTED + SC_LEAF_MAX,
    /* and what distances leave open of two: points with triangles, edges with edges */
    SC_NEAR_FACES_MAX = SC_MOVING_ENOUGH + 2 * SC_LEAF_PAIRS,
    SC_NEAR_EDGES_MAX = SC_MOVING_ENOUGH + 9 * SC_LEAF_PAIRS
};

/* Two leaf clusters, a < b if they share points, or one twice; and where sc_model_share_leaf has
   them, or SC_NONE, with what sc_model_share_touch has, and the bits below. */
typedef struct sc_cluster_pair {
    uint32_t a, b, shared, known;
} sc_cluster_pair;

enum {
    SC_CLUSTERS_DROPPED = 1 << 16,  /* nothing is left to be looked at */
    SC_CLUSTERS_FAR = 1 << 17,      /* they share no points, or are crowded */
    SC_CLUSTERS_UNSLABBED = 1 << 18 /* slabs may tell them apart, and were not looked at */
};

/* Pairs of leaf clusters whose triangles are compared together; and rows, triangles of one of two
   with a mask of the other's. Those of one pair are together. */
enum { SC_ROWS_PAIRS = SC_CLUSTERS_ENOUGH, SC_TRIANGLES_MAX = SC_ROWS_PAIRS * SC_LEAF_MAX + 16 };

typedef struct sc_triangle_rows {
    uint32_t leaf[2][SC_ROWS_PAIRS]; /* the former with the bit for what follows a contour test */
    const sc_leaf_derived *derived[2][SC_ROWS_PAIRS]; /* kept, as long as there are rows */
    const uint16_t *list[SC_ROWS_PAIRS];              /* as in sc_leaf_pair */
    float extent[SC_ROWS_PAIRS];                      /* of both */
    uint8_t pair[SC_TRIANGLES_MAX];
    uint8_t row[SC_TRIANGLES_MAX];
    uint16_t mask[SC_TRIANGLES_MAX];
} sc_triangle_rows;

/* Numbers that tell of two triangles that share a point how they are looked at, see
   query/neighbor_kernel.h: of all points, and of all triangles. */
enum { SC_OPEN_NUMBERS = 7 };
typedef struct sc_open_pairs {
    uint32_t number[SC_OPEN_NUMBERS][SC_OPEN_MAX + 16];
    float extent[SC_OPEN_MAX + 16]; /* of both clusters */
} sc_open_pairs;

/* A triangle, by its place, and points of a leaf cluster; or an edge, as 3 place + k, and sides k
   of its triangles, with k in the upper half of bits. */
typedef struct sc_moving_row {
    uint32_t of;
    uint32_t leaf; /* with the bit for what follows a contour test */
    uint32_t bits;
} sc_moving_row;

typedef struct sc_lists {
    uint32_t count[SC_LIST_COUNT];
    uint32_t room[SC_LIST_COUNT]; /* of how many items, as follows */
    sc_pair *spans;               /* SC_SPANS_MAX */
    uint32_t *stars;              /* (level_count + 1) SC_NODE_CHILDREN: a stack */
    uint32_t *failed;   /* n (SC_ORIENTED_MAX + n SC_NODE_CHILDREN), n = level_count + 1: a stack of
                           what failed of some full lists of nodes to test, each from deeper levels
                           than the one before; and for each of these, brothers of what is looked
                           at */
    uint32_t *oriented; /* SC_ORIENTED_MAX */
    sc_pair *left;      /* SC_LEFT_MAX */
    sc_pair *patches;   /* SC_LEFT_MAX + n SC_PATCHES_CHILDREN, n the levels that box recursion
                           visits between the first and the last one: a stack */
    uint32_t *row[3];   /* SC_ROWS_MAX: a leaf cluster, the first of the others, and a bit for each
                           of these */
    uint32_t *far[2];   /* SC_LEAF_LIST_MAX: one of two, and the other */
    uint32_t *near[2];  /* SC_LEAF_LIST_MAX: the lower of two, and where sc_model_share_leaf has
                           them; or SC_NONE */
    sc_cluster_pair *clusters; /* SC_CLUSTERS_MAX */
    sc_triangle_rows *triangles;
    sc_open_pairs *open;
    sc_pair *candidates;           /* SC_CANDIDATES_MAX places of triangles */
    sc_pair *neighbors;            /* SC_FEW_MAX of the same */
    sc_pair *exact;                /* SC_FEW_MAX of the same */
    sc_moving_row *moving_rows[2]; /* SC_FACE_ROWS_MAX, SC_EDGE_ROWS_MAX */
    sc_pair *moving[2];            /* SC_MOVING_MAX each: a point and the place of a triangle; two
                                      edges as 3 place + k */
    uint32_t *scratch;             /* SC_LEAF_LIST_AT_ONCE, for a stage while it runs */
} sc_lists;

/* Whether no list has more than it has room for. */
static inline int sc_lists_have_room(const sc_lists *l)
{
    int k;
    for (k = 0; k < SC_LIST_COUNT; k++)
        if (l->count[k] > l->room[k]) return 0;
    return 1;
}

#endif
