/*
 * Partitions that the caller makes, and are wrong: orders, trees, bisections, weld maps.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "input_fixture.h"
#include "inputs.h"
#include "starcontour.h"

static void weld_maps(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        uint32_t count = f.mesh.vertex_count;
        uint32_t *map = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_build_options options = input_fixture_no_build_options();
        options.weld = SC_WELD_MAP;
        options.weld_map = map;
        for (uint32_t v = 0; v < count; ++v) map[v] = v;
        input_fixture_check_build(&f, &f.input, &options, SC_OK, "identity");
        map[3] = count;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "just out of range");
        map[3] = SC_NONE;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "far out of range");
        map[3] = 2;
        map[2] = 1;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "a chain");
        map[2] = 3;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP, "a circle");
        map[2] = 2;
        map[3] = 3;
        map[count - 1] = 0;
        map[0] = 1;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_WELD_MAP,
                                  "a chain from the last");
        CHECK(input_fixture_is_still_right(&f));
        free(map);
    }
    input_fixture_stop(&f);
}

static void orders(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        uint32_t count = f.mesh.triangle_count;
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_build_options options = input_fixture_no_build_options();
        options.partition = SC_PARTITION_ORDER;
        options.order = order;
        for (uint32_t t = 0; t < count; ++t) order[t] = count - 1 - t;
        input_fixture_check_build(&f, &f.input, &options, SC_OK, "backwards");
        order[5] = order[6];
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a triangle twice");
        order[5] = count;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "just out of range");
        order[5] = SC_NONE;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "far out of range");
        memset(order, 0, count * sizeof(uint32_t));
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE,
                                  "nothing but one triangle");
        CHECK(input_fixture_is_still_right(&f));
        free(order);
    }
    input_fixture_stop(&f);
}

static sc_tree_node leaf(uint32_t first, uint32_t count)
{
    sc_tree_node n;
    n.left = n.right = SC_NONE;
    n.first = first;
    n.count = count;
    return n;
}

static sc_tree_node inner(uint32_t left, uint32_t right)
{
    sc_tree_node n;
    n.left = left;
    n.right = right;
    n.first = n.count = 0;
    return n;
}

/* A tree of leaves of one triangle that is depth nodes deep; the last leaf has the rest. */
static uint32_t make_ladder(sc_tree_node *tree, uint32_t depth, uint32_t count)
{
    uint32_t node = 0;
    for (uint32_t d = 1; d < depth; ++d) {
        tree[node] = inner(node + 1, node + 2);
        tree[node + 1] = leaf(d - 1, 1);
        node += 2;
    }
    tree[node] = leaf(depth - 1, count - depth + 1);
    return node + 1;
}

static void trees(void)
{
    input_fixture f;
    if (input_fixture_start(&f)) {
        uint32_t count = f.mesh.triangle_count;
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_tree_node tree[300];
        sc_build_options options = input_fixture_no_build_options();
        for (uint32_t t = 0; t < count; ++t) order[t] = t;
        options.partition = SC_PARTITION_TREE;
        options.order = order;
        options.tree = tree;
        options.tree_count = 0;
        tree[0] = leaf(0, count);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "no nodes");
        options.tree_count = 1;
        input_fixture_check_build(&f, &f.input, &options, SC_OK, "one leaf");
        tree[0] = leaf(0, count - 1);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a triangle in no leaf");
        tree[0] = leaf(1, count);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a leaf beyond the end");
        tree[0] = leaf(0xffffff00u, 0x100u + count);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a leaf that overflows");
        tree[0] = leaf(0, 0);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "an empty leaf");
        tree[0] = inner(0, 0);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "its own child");
        tree[0] = inner(1, 2);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE,
                                  "children that do not exist");

        options.tree_count = 3;
        tree[1] = leaf(0, 70);
        tree[2] = leaf(70, count - 70);
        input_fixture_check_build(&f, &f.input, &options, SC_OK, "two leaves");
        tree[0] = inner(2, 1);
        input_fixture_check_build(&f, &f.input, &options, SC_OK, "two leaves, the other way round");
        tree[0] = inner(1, 1);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "the same child twice");
        tree[0] = inner(1, SC_NONE);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "no right child");
        tree[0] = inner(SC_NONE, 2);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "no left child");
        tree[0] = inner(1, 3);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a child out of range");
        tree[0] = inner(1, 2);
        tree[2] = leaf(69, count - 69);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "overlap");
        tree[2] = leaf(71, count - 71);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a gap");
        tree[2] = leaf(0, 70);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "twice the same leaf");
        tree[2] = inner(0, 1);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "a circle");
        options.tree_count = 5;
        tree[1] = inner(3, 4);
        tree[2] = inner(3, 4);
        tree[3] = leaf(0, 70);
        tree[4] = leaf(70, count - 70);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE,
                                  "children with two parents");

        options.tree_count = make_ladder(tree, 60, count);
        input_fixture_check_build(&f, &f.input, &options, SC_OK, "as deep as allowed");
        options.tree_count = make_ladder(tree, 61, count);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "one node too deep");
        options.tree_count = make_ladder(tree, 140, count);
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "much too deep");
        options.tree_count = make_ladder(tree, 20, count);
        order[7] = 8;
        input_fixture_check_build(&f, &f.input, &options, SC_ERROR_TREE, "an order that is none");
        CHECK(input_fixture_is_still_right(&f));
        free(order);
    }
    input_fixture_stop(&f);
}

/* How the function below fails, from which call on; and what it spoils meanwhile. */
typedef struct wrong {
    int how, calls_before;
    double *positions;
} wrong;

static sc_status wrong_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target,
                              uint8_t *side)
{
    wrong *w = (wrong *)user;
    input_bisect(NULL, graph, left_target, side);
    if (w->calls_before-- > 0) return SC_OK;
    if (w->how == 0) return SC_ERROR_PARTITION;
    if (w->how == 1) return SC_ERROR_UNSUPPORTED;
    if (w->how == 2) return SC_ERROR_MEMORY;
    if (w->how == 3) side[graph->node_count - 1] = 2;
    if (w->how == 4) memset(side, 0, graph->node_count);
    if (w->how == 5) memset(side, 1, graph->node_count);
    if (w->how == 6) w->positions[1] = (double)NAN;
    if (w->how == 7) w->positions[1] = HUGE_VAL;
    return SC_OK;
}

static void bisections(void)
{
    static const sc_status expected[] = {
        SC_ERROR_PARTITION,  SC_ERROR_UNSUPPORTED, SC_ERROR_MEMORY,
        SC_ERROR_PARTITION,  SC_ERROR_PARTITION,   SC_ERROR_PARTITION,
        SC_ERROR_NOT_FINITE, SC_ERROR_NOT_FINITE,  SC_OK};
    input_fixture f;
    if (input_fixture_start(&f)) {
        sc_build_options options = input_fixture_no_build_options();
        double old = f.mesh.positions[1];
        wrong w;
        w.positions = f.mesh.positions;
        options.partition = SC_PARTITION_BISECT;
        options.rest = SC_REST_MARKED; /* reads positions again */
        options.bisect = wrong_bisect;
        options.bisect_user = &w;
        for (w.how = 0; w.how < 9; ++w.how)
            for (int before = 0; before < 4; ++before) {
                w.calls_before = before;
                input_fixture_check_build(&f, &f.input, &options, expected[w.how], "bisect");
                CHECK_MSG(w.calls_before < 0, "%d", before);
                f.mesh.positions[1] = old;
            }
        CHECK(input_fixture_is_still_right(&f));
    }
    input_fixture_stop(&f);
}

SC_TEST_MAIN(SC_TEST(weld_maps), SC_TEST(orders), SC_TEST(trees), SC_TEST(bisections))
