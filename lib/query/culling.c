/*
 * Culling. See culling.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * With the exact contour test, which keeps nothing from node to node, each node has its own
 * projection, and nodes can be tested in any order: those that pass the orientation test wait in
 * a short list, so that the memory for some is fetched while others are tested. Nodes of one
 * patch wait until all that hangs below their ancestors is done, since a patch that is in a node
 * of two that was culled is culled with it. A node of two patches with one parent has the
 * contour of that parent, which failed. Pairs of patches that are left to boxes wait as well:
 * tests of boxes that do not depend on each other wait for memory at the same time. Two patches
 * that share one point, as diagonally in a grid, are left to boxes, too: few overlap there, and
 * a contour costs most that passes a point twice.
 */
#include "query/culling.h"

#include "base/bits.h"
#include "pose/dnc.h"
#include "query/star.h"

/*
 * Where little can be culled, the test tree is a waste: its nodes are many, and boxes are faster by
 * themselves. A patch of more than PROSPECT_MIN leaf clusters that passes the orientation test has
 * a prospect; for fewer, a contour test and the nodes on the way to it cost as much as the pairs of
 * leaf clusters that are saved. The prospect of another patch is the number of seams between leaf
 * clusters in such patches below it, m - 1 for one of m, which must be one for PROSPECT_PART leaf
 * clusters. A node that fails the orientation test is left to boxes unless both its patches have a
 * prospect. (Tuned on single frames of scenes from smooth to crumpled.) In a step leaf clusters
 * cost more: all such nodes are opened, 0.95 of the time in the mean. So they are in a search for
 * what is near, unless masks leave most of two leaf clusters out at once (twisted cloth, one edge,
 * four rings: 0.80 to 0.85 of the time of opening all).
 */
enum { PROSPECT_MIN = 2, PROSPECT_PART = 8 };

int sc_culling_weighs_prospects(const sc_worker *w)
{
    return !w->question->opens_all;
}

/* The prospect of a patch. It is written down for those of more than PROSPECT_MIN leaf clusters
   without a cone, above which all are such. */
static uint32_t find_prospect(const sc_worker *w, uint32_t patch)
{
    const uint32_t *child = sc_model_child(w->model) + patch;
    uint32_t leaves = sc_model_leaves_of(w->model, patch), sum, c;
    if (leaves <= PROSPECT_MIN) return 0;
    if (w->frame->mask[patch]) return leaves - 1;
    for (sum = 0, c = child[0]; c < child[1]; c++) sum += find_prospect(w, c);
    return w->frame->prospect[patch] = sum;
}

void sc_culling_find_prospects(const sc_worker *w)
{
    find_prospect(w, 0);
}

static int has_prospect(const sc_worker *w, uint32_t patch)
{
    uint32_t leaves = sc_model_leaves_of(w->model, patch);
    if (leaves <= PROSPECT_MIN) return 0;
    return w->frame->mask[patch] || PROSPECT_PART * (uint64_t)w->frame->prospect[patch] >= leaves;
}

/* Two patches, the upper one first only if they share no points, or one twice, are left to boxes;
   follows: after a contour test. */
static void leave_to_boxes(sc_worker *w, uint32_t a, uint32_t b, int follows)
{
    sc_lists *l = &w->lists;
    sc_pair *pair = &l->left[l->count[SC_LIST_LEFT]++];
    pair->a = follows ? a | SC_AFTER_CONTOUR : a;
    pair->b = b;
    sc_fetch(sc_model_box_child(w->model) + a);
    sc_fetch((a == b ? sc_model_leaf(w->model) : sc_model_box_child(w->model)) + b);
}

/* A node that failed a test, or has a contour that did, mask being what its patches' cones have in
   common. */
static void put_back(sc_worker *w, uint32_t node, uint32_t mask)
{
    const sc_node *n = sc_model_node(w->model) + node;
    if (!mask && sc_culling_weighs_prospects(w) &&
        (!has_prospect(w, n->patches.a) || !has_prospect(w, n->patches.b))) {
        leave_to_boxes(w, n->patches.a, n->patches.b, 0);
        return;
    }
    w->lists.failed[w->lists.count[SC_LIST_FAILED]++] = node;
    sc_fetch(sc_model_node(w->model) + n->child);
    sc_fetch(sc_model_node(w->model) + n->child + 2);
}

/* What the normal cones of a node's patches have in common. */
static uint32_t mask_of_node(const sc_worker *w, const sc_node *n)
{
    const uint16_t *mask = w->frame->mask;
    return (uint32_t)mask[n->patches.a] & mask[n->patches.b];
}

void sc_culling_orient(sc_worker *w, uint32_t node)
{
    const sc_node *n = sc_model_node(w->model) + node;
    const uint32_t mask = mask_of_node(w, n);
    w->stats.nodes_visited++;
    if (n->kind & SC_NODE_TOUCHES) {
        leave_to_boxes(w, n->patches.a, n->patches.b, 0);
        return;
    }
    w->stats.counts[SC_TASK_ORIENTATION]++;
    if (!mask) {
        put_back(w, node, mask);
        return;
    }
    w->stats.nodes_oriented++;
    if (n->patches.a == n->patches.b)
        w->last.self[w->last.self_count++] = node;
    else
        w->lists.oriented[w->lists.count[SC_LIST_ORIENTED]++] = node;
}

/* What an open node leaves to boxes: its BVTT children, and leaf clusters. */
static void leave_rest_of_node(sc_worker *w, const sc_node *n)
{
    const sc_model *model = w->model;
    const int follows = mask_of_node(w, n) != 0;
    uint32_t bits;
    for (bits = sc_node_boxes(n); bits; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(model, n, sc_bits_lowest(bits));
        leave_to_boxes(w, pair.b, pair.a, follows);
    }
    if (sc_node_is_leaf(n)) {
        const uint32_t *leaf = sc_model_leaf(model), first = sc_model_first_leaf_patch(model);
        leave_to_boxes(w, first + leaf[n->patches.a], first + leaf[n->patches.b], follows);
    }
}

static void open_failed(sc_worker *w, uint32_t node)
{
    const sc_node *nodes = sc_model_node(w->model), *n = nodes + node;
    const int of_one = n->patches.a == n->patches.b;
    const uint32_t end = sc_node_end(n);
    uint32_t c;
    for (c = n->child; c < end; c++) {
        if (of_one && nodes[c].patches.a != nodes[c].patches.b) {
            w->stats.nodes_visited++;
            put_back(w, c, mask_of_node(w, nodes + c));
        } else {
            sc_culling_orient(w, c);
        }
    }
    leave_rest_of_node(w, n);
}

void sc_culling_open(sc_worker *w, uint32_t most)
{
    uint32_t *count = w->lists.count;
    for (; most && count[SC_LIST_FAILED] && count[SC_LIST_ORIENTED] < SC_ORIENTED_ENOUGH &&
           count[SC_LIST_LEFT] < SC_LEFT_ENOUGH;
         most--)
        open_failed(w, w->lists.failed[--count[SC_LIST_FAILED]]);
}

/* No contour tests of more edges are made between looks at the caller's flag, but for one. */
enum { EDGES_AT_ONCE = 4096 };

/* How many of these nodes, the last ones, have so few edges, or one. */
static uint32_t few_edges(const sc_worker *w, const uint32_t *nodes, uint32_t count)
{
    const sc_node *node = sc_model_node(w->model);
    uint32_t edges = 0, some;
    for (some = 0; some < count; some++) {
        const sc_node *n = node + nodes[count - 1 - some];
        /* of a contour that is no loop, segments are few: they count as this */
        edges += n->loop_length ? n->loop_length : EDGES_AT_ONCE;
        if (some && edges > EDGES_AT_ONCE) break;
    }
    return some;
}

void sc_culling_test_all(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed)
{
    uint32_t i;
    w->question->test(w, nodes, count, passed);
    for (i = 0; i < count; i++) w->stats.nodes_culled += passed[i];
}

void sc_culling_test(sc_worker *w, uint32_t most)
{
    uint8_t passed[SC_ORIENTED_MAX];
    uint32_t *left = &w->lists.count[SC_LIST_ORIENTED], count = *left < most ? *left : most, i;
    const uint32_t *nodes;
    count = few_edges(w, w->lists.oriented + *left - count, count);
    nodes = w->lists.oriented + (*left -= count);
    sc_culling_test_all(w, nodes, count, passed);
    for (i = 0; i < count; i++) {
        const sc_pair *patches = &sc_model_node(w->model)[nodes[i]].patches;
        if (!passed[i])
            put_back(w, nodes[i], 1);
        else
            w->last.marks[patches->a] = w->last.marks[patches->b] = 1;
    }
}

/* What a node leaves, where leaf clusters are left at once. */
static void leave_all_of_node(sc_worker *w, const sc_node *n, int follows)
{
    const uint32_t bit = follows ? SC_AFTER_CONTOUR : 0, *leaf = sc_model_leaf(w->model);
    uint32_t bits;
    for (bits = sc_node_boxes(n); bits; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(w->model, n, sc_bits_lowest(bits));
        leave_to_boxes(w, pair.b, pair.a, follows);
    }
    if (!sc_node_is_leaf(n)) return;
    if (n->patches.a == n->patches.b)
        sc_worker_add_leaf(w, leaf[n->patches.a] | bit);
    else
        sc_worker_add_leaf_pair(w, leaf[n->patches.a] | bit, leaf[n->patches.b]);
}

/* Whether there is room for what one more of such nodes leaves. */
static int have_room_for_node(const sc_worker *w)
{
    const uint32_t *count = w->lists.count;
    return count[SC_LIST_LEFT] < SC_LEFT_ENOUGH && count[SC_LIST_ROWS] < SC_ROWS_ENOUGH;
}

void sc_culling_take_spans(sc_worker *w, uint32_t most)
{
    uint32_t *count = &w->lists.count[SC_LIST_SPANS];
    sc_pair *span = w->lists.spans + *count - 1;
    for (; most && span->a < span->b && have_room_for_node(w); most--, span->a++) {
        w->stats.nodes_visited++;
        leave_all_of_node(w, sc_model_node(w->model) + span->a, 0);
    }
    *count -= span->a == span->b;
}

/* The orientation test, and then a projection for all that is below: returns whether there is
   one. */
static int begin_projection(sc_worker *w, const sc_node *n)
{
    uint32_t mask = 0;
    sc_projection projection;
    if (w->question->options.rest_cache == SC_REST_CACHE_OFF ||
        (n->kind & SC_NODE_REST_TURNED) == 0) {
        w->stats.counts[SC_TASK_ORIENTATION]++;
        mask = mask_of_node(w, n);
    }
    if (!mask) return 0;
    w->stats.nodes_oriented++;
    if (w->question->options.contour == SC_CONTOUR_NONE) return 1;
    sc_dnc_projection(w->frame, mask, &projection);
    sc_contour_bounds_begin(w->model, &w->frame->positions[0], &projection, w->bounds);
    return 1;
}

static int star_culls(sc_worker *w, const sc_node *n)
{
    const uint32_t node = (uint32_t)(n - sc_model_node(w->model));
    if (w->question->options.contour == SC_CONTOUR_NONE) return 1;
    if (w->question->options.rest_cache == SC_REST_CACHE_ON && n->kind & SC_NODE_REST_CROSSED)
        return 0;
    if (!sc_star_test(w, node)) return 0;
    w->stats.nodes_culled++;
    return 1;
}

/* The list is a stack: nodes that have the projection at hand, of which the bit for what follows a
   contour test is set, are above all others. */
void sc_culling_take_stars(sc_worker *w, uint32_t most)
{
    sc_lists *l = &w->lists;
    uint32_t *count = &l->count[SC_LIST_STARS], c;
    for (; most && *count && have_room_for_node(w); most--) {
        const uint32_t item = l->stars[--*count];
        const sc_node *n = sc_model_node(w->model) + (item & SC_ITEM);
        uint32_t bit = item & SC_AFTER_CONTOUR;
        w->stats.nodes_visited++;
        if (!bit && begin_projection(w, n)) bit = SC_AFTER_CONTOUR;
        if (bit && star_culls(w, n)) continue;
        for (c = sc_node_end(n); c-- > n->child;) l->stars[(*count)++] = c | bit;
        leave_all_of_node(w, n, bit != 0);
    }
}
