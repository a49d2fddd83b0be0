/*
 * The exact contour test of one node, and of many together. See simple.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Small contours are looked at eight at a time (query/small_kernel.h); what these leave, long ones,
 * and those without a loop, one by one (query/simple_kernel.h). Whichever way, the memory that a
 * test reads is asked for while others are made.
 */
#include <string.h>

#include "base/bits.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "query/query_kernels.h"
#include "query/simple.h"

/* Asks for memory that the test of a node will read, in steps 0 to FETCHES - 1, of which each reads
   what the one before asked for. */
enum { FETCHES = 4 };
static void fetch(const sc_model *model, uint32_t node, int step)
{
    const sc_node *n = sc_model_node(model) + node;
    const uint32_t *segments, *first, *last;
    uint32_t i, count;
    if (step == 0) {
        sc_fetch(n);
        return;
    }
    if (n->loop_length) {
        const uint16_t *loop = sc_model_loop(model) + n->loop;
        count = n->loop_length < 256 ? n->loop_length : 256;
        if (step == 1)
            for (i = 0; i < count; i += 32) sc_fetch(loop + i);
        return;
    }
    segments = sc_model_contours(model) + n->contour;
    count = n[1].contour - n->contour < 64 ? n[1].contour - n->contour : 64;
    if (step == 1) {
        for (i = 0; i < count; i += 16) sc_fetch(segments + i);
        return;
    }
    first = sc_model_segment_first(model);
    last = sc_model_segment_last(model);
    for (i = 0; i < count; i++) {
        if (step == 2) {
            sc_fetch(first + segments[i]);
            sc_fetch(last + segments[i]);
        } else {
            sc_fetch(sc_model_points(model) + first[segments[i]]);
        }
    }
}

/* Sets from, to about the middle of the contour. */
static void find_middle(sc_simple_contour *c, const sc_frame *frame)
{
    float one[3], other[3];
    int k;
    if (c->loop) {
        const float *p = frame->point_at + 4 * (uint64_t)sc_simple_place(c, c->loop[0]);
        const float *q = frame->point_at + 4 * (uint64_t)sc_simple_place(c, c->loop[c->looped / 2]);
        for (k = 0; k < 3; k++) c->from[k] = p[k] / 2 + q[k] / 2;
        return;
    }
    sc_positions_unit(frame, c->edges->point[0], one);
    sc_positions_unit(frame, c->edges->point[c->count / 2], other);
    for (k = 0; k < 3; k++) c->from[k] = one[k] / 2 + other[k] / 2;
}

/* Projects a contour that was started. */
static void place_contour(sc_worker *w, sc_simple_contour *c)
{
    find_middle(c, w->frame);
    w->frame->kernels->query->project(c, w->frame);
    w->stats.counts[SC_TASK_UPDATE_CONTOURS] += c->count;
}

/* Tests a contour that was started, and has axes. */
static int test_contour(sc_worker *w, sc_simple_contour *c)
{
    place_contour(w, c);
    sc_worker_switch(w, SC_TASK_CONTOUR);
    w->stats.counts[SC_TASK_CONTOUR]++;
    return w->frame->kernels->query->look_at_edges(c) &&
           ((!c->pinch_count && !c->in_pieces) || sc_simple_is_wound_well(c));
}

int sc_simple_test(sc_worker *w, const sc_projection *projection, uint32_t node)
{
    uint32_t previous = sc_worker_switch(w, SC_TASK_UPDATE_CONTOURS);
    sc_simple_contour c;
    int passed = sc_simple_start(&c, w->model, &w->contour, node);
    if (passed) {
        sc_simple_axes(&c, projection);
        passed = test_contour(w, &c);
    }
    sc_worker_switch(w, previous);
    return passed;
}

/* What the normal cones of a node's patches have in common. */
static uint16_t mask_of(const sc_worker *w, uint32_t node)
{
    const sc_pair *patches = &sc_model_node(w->model)[node].patches;
    return w->frame->mask[patches->a] & w->frame->mask[patches->b];
}

/* The axes of the projections of some nodes. */
static void find_axes(const sc_worker *w, sc_simple_some_axes *axes, const uint32_t *nodes,
                      uint32_t count)
{
    uint16_t mask[SC_DNC_VECTORS] = {0};
    uint32_t i;
    for (i = 0; i < SC_DNC_VECTORS && i < count; i++) mask[i] = mask_of(w, nodes[i]);
    sc_simple_axes_of(mask, axes);
}

/* How many sixteens of edges a small contour has, see query/small_kernel.h; 0: it is not small. */
static uint32_t small_blocks(const sc_node *node)
{
    const uint32_t edges = node->loop_length;
    if (edges < SC_SMALL_EDGES || edges > SC_SMALL_BLOCKS * SC_CONTOUR_BLOCK ||
        (node->kind & SC_NODE_PIECES))
        return 0;
    return (edges - 1) / SC_CONTOUR_BLOCK + 1;
}

/* Some nodes, by their numbers, and the axes of their projections, SC_DNC_VECTORS each together. */
enum { SOME_NODES = 64 };
typedef struct some_nodes {
    const uint32_t *nodes;
    uint32_t count[SC_SMALL_BLOCKS + 1];
    uint8_t number[SC_SMALL_BLOCKS + 1][SOME_NODES]; /* of those with so many sixteens of edges */
    sc_simple_some_axes axes[SOME_NODES / SC_DNC_VECTORS];
} some_nodes;

/* Lists nodes by the sizes of their contours: what is done for as many edges is told beforehand by
   branches. Asks for memory that their tests will read. */
static void sort_nodes(const sc_worker *w, const uint32_t *nodes, uint32_t count, some_nodes *some)
{
    const sc_model *model = w->model;
    uint32_t i;
    some->nodes = nodes;
    memset(some->count, 0, sizeof some->count);
    for (i = 0; i < count; i++) sc_fetch(sc_model_node(model) + nodes[i]);
    for (i = 0; i < count; i++) {
        const sc_node *n = sc_model_node(model) + nodes[i];
        const uint16_t *loop = sc_model_loop(model) + n->loop;
        const uint32_t blocks = small_blocks(n);
        some->number[blocks][some->count[blocks]++] = (uint8_t)i;
        sc_fetch(loop);
        sc_fetch(loop + 32);
        sc_fetch(sc_model_leaf(model) + n->patches.a);
        sc_fetch(sc_model_leaf(model) + n->patches.b);
        sc_fetch(w->frame->mask + n->patches.a);
        sc_fetch(w->frame->mask + n->patches.b);
    }
    for (i = 0; i < count; i += SC_DNC_VECTORS)
        find_axes(w, &some->axes[i / SC_DNC_VECTORS], nodes + i, count - i);
}

/* Tests nodes of small contours of so many sixteens of edges. */
static void test_small(sc_worker *w, const some_nodes *some, uint32_t blocks, uint8_t *passed)
{
    const sc_node *node = sc_model_node(w->model);
    const uint32_t end = some->count[blocks];
    uint32_t i, k;
    for (i = 0; i < end && !sc_worker_stops(w); i += SC_DNC_VECTORS) {
        const uint8_t *number = some->number[blocks] + i;
        const uint32_t count = end - i < SC_DNC_VECTORS ? end - i : SC_DNC_VECTORS;
        uint32_t nodes[SC_DNC_VECTORS];
        const float *axes[SC_DNC_VECTORS];
        unsigned simple;
        for (k = 0; k < count; k++) {
            nodes[k] = some->nodes[number[k]];
            axes[k] = some->axes[number[k] / SC_DNC_VECTORS].at[0][0] + number[k] % SC_DNC_VECTORS;
        }
        simple = w->frame->kernels->query->find_simple(w, nodes, count, blocks, axes);
        for (; simple; simple &= simple - 1) {
            k = sc_bits_lowest(simple);
            passed[number[k]] = 1;
            w->stats.counts[SC_TASK_CONTOUR]++;
            w->stats.counts[SC_TASK_UPDATE_CONTOURS] += node[nodes[k]].loop_length;
        }
    }
}

/* How many tests pass between two steps of fetching what a test reads. */
enum { FETCH_DISTANCE = 2 };

/* Tests those of some nodes that have not passed, one by one. */
static void test_rest(sc_worker *w, const some_nodes *some, const uint8_t *number, uint32_t count,
                      uint8_t *passed)
{
    sc_simple_contour c;
    int i, step, k, m;
    for (i = -FETCH_DISTANCE * FETCHES; i < (int)count && !sc_worker_stops(w); i++) {
        for (step = 0; step < FETCHES; step++) {
            int ahead = i + FETCH_DISTANCE * (FETCHES - step);
            if (ahead >= 0 && ahead < (int)count) fetch(w->model, some->nodes[number[ahead]], step);
        }
        if (i < 0) continue;
        sc_worker_switch(w, SC_TASK_UPDATE_CONTOURS);
        if (!sc_simple_start(&c, w->model, &w->contour, some->nodes[number[i]])) continue;
        for (m = 0; m < 2; m++)
            for (k = 0; k < 3; k++)
                c.axis[m][k] =
                    some->axes[number[i] / SC_DNC_VECTORS].at[m][k][number[i] % SC_DNC_VECTORS];
        passed[number[i]] = (uint8_t)test_contour(w, &c);
    }
}

/* Tests no more than SOME_NODES, none of which has passed yet: small contours, and then what is
   left. */
static void test_some(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed)
{
    uint8_t left[SOME_NODES];
    uint32_t left_count = 0, i;
    some_nodes some;
    sort_nodes(w, nodes, count, &some);
    for (i = 1; i <= SC_SMALL_BLOCKS; i++) test_small(w, &some, i, passed);
    for (i = 0; i < count; i++) {
        left[left_count] = (uint8_t)i;
        left_count += !passed[i];
    }
    test_rest(w, &some, left, left_count, passed);
}

void sc_simple_tests(sc_worker *w, const uint32_t *nodes, uint32_t count, uint8_t *passed)
{
    uint32_t previous = sc_worker_switch(w, SC_TASK_UPDATE_CONTOURS), i;
    memset(passed, 0, count);
    for (i = 0; i < count; i += SOME_NODES)
        test_some(w, nodes + i, count - i < SOME_NODES ? count - i : SOME_NODES, passed + i);
    sc_worker_switch(w, previous);
}
