/*
 * Flattening a hierarchy: leaves and their order stay, and so do all patches but few; what is deep
 * for no good reason becomes less deep.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "build/flattening.h"
#include "harness.h"

enum { LEAVES_MAX = 3000 };

/* Triangles of one point, so that runs of any sixteen fit into a leaf; here each is a leaf. */
static uint32_t corners[3 * LEAVES_MAX];

static sc_hierarchy start(sc_scratch *scratch, uint32_t leaves)
{
    sc_hierarchy h;
    sc_points points;
    memset(&points, 0, sizeof(points));
    points.triangles = corners;
    points.triangle_count = leaves;
    points.point_count = 1;
    CHECK(sc_hierarchy_init(&h, &points, scratch) == SC_OK);
    for (uint32_t i = 0; i < leaves; ++i) h.order[i] = i;
    h.leaf_count = leaves;
    return h;
}

/* Of which kind the nodes are: halves; halves with an island here and there; anywhere; one leaf and
   the rest. */
enum { HALVES, ISLANDS, ANYWHERE, CHAIN, KINDS };

static uint32_t add_tree(sc_hierarchy *h, uint32_t first, uint32_t count, uint32_t depth, int kind)
{
    uint32_t node = sc_hierarchy_add(h, first, count, depth), left = count / 2, child;
    if (count == 1) return node;
    if (kind == ISLANDS && test_random_below(8) == 0)
        left = test_random_below(2) ? 1 : count - 1;
    else if (kind == ANYWHERE)
        left = 1 + test_random_below(count - 1);
    else if (kind == CHAIN)
        left = 1;
    if (depth > 60) left = count / 2;
    child = add_tree(h, first, left, depth + 1, kind);
    h->nodes[node].left = child;
    child = add_tree(h, first + left, count - left, depth + 1, kind);
    h->nodes[node].right = child;
    return node;
}

static uint32_t depth_below(const sc_tree_node *nodes, uint32_t node)
{
    uint32_t left, right;
    if (nodes[node].left == SC_NONE) return 1;
    left = depth_below(nodes, nodes[node].left);
    right = depth_below(nodes, nodes[node].right);
    return 1 + (left > right ? left : right);
}

/* The leaves of the topmost patches that the two trees divide differently. */
static uint32_t compare(const sc_tree_node *before, uint32_t a, const sc_tree_node *after,
                        uint32_t b)
{
    CHECK(before[a].first == after[b].first && before[a].count == after[b].count);
    if (before[a].left == SC_NONE || after[b].left == SC_NONE) {
        CHECK(before[a].left == after[b].left && before[a].right == after[b].right);
        return 0;
    }
    if (before[before[a].left].count != after[after[b].left].count) return before[a].count;
    return compare(before, before[a].left, after, after[b].left) +
           compare(before, before[a].right, after, after[b].right);
}

/* Returns the levels that went. */
static uint32_t check(uint32_t leaves, int kind)
{
    sc_allocator allocator = sc_memory_allocator(NULL);
    sc_scratch scratch;
    sc_hierarchy h;
    sc_tree_node *before;
    uint32_t depth, went = 0, least = 1;
    sc_scratch_init(&scratch, &allocator);
    h = start(&scratch, leaves);
    add_tree(&h, 0, leaves, 1, kind);
    CHECK(sc_hierarchy_finish(&h, &scratch) == SC_OK);
    depth = h.depth;
    before = (sc_tree_node *)malloc(h.node_count * sizeof(*before));
    memcpy(before, h.nodes, h.node_count * sizeof(*before));
    if (CHECK(sc_flattening_run(&scratch, &h) == SC_OK)) {
        while (1u << (least - 1) < leaves) ++least;
        CHECK(sc_hierarchy_validate(&h, &scratch) == 1);
        CHECK(h.node_count == 2 * leaves - 1 && h.leaf_count == leaves);
        CHECK(h.depth <= depth && h.depth >= least && h.depth == depth_below(h.nodes, 0));
        CHECK(compare(before, 0, h.nodes, 0) <= leaves / 16);
        if (kind == HALVES) CHECK(memcmp(before, h.nodes, h.node_count * sizeof(*before)) == 0);
        went = depth - h.depth;
    }
    free(before);
    sc_scratch_clear(&scratch);
    return went;
}

static void trees(void)
{
    uint32_t went[KINDS] = {0};
    for (uint32_t leaves = 1; leaves < 40; ++leaves)
        for (int kind = 0; kind < KINDS; ++kind) went[kind] += check(leaves, kind);
    for (int round = 0; round < 60; ++round)
        for (int kind = 0; kind < KINDS; ++kind)
            went[kind] += check(1 + test_random_below(LEAVES_MAX), kind);
    CHECK(went[HALVES] == 0 && went[CHAIN] == 0);
    CHECK_MSG(went[ISLANDS] > 30 && went[ANYWHERE] > 30, "%" PRIu32 " %" PRIu32, went[ISLANDS],
              went[ANYWHERE]);
}

/* Some leaves one by one, then 200 in halves, and islands beside the first of these: three levels
   more, of which the one goes that changes few patches. */
static void add_islands(sc_hierarchy *h, uint32_t singles)
{
    uint32_t node = 0, single, below, depth = singles;
    for (uint32_t i = 0; i <= singles; ++i) {
        below = sc_hierarchy_add(h, i, 203 + singles - i, i + 1);
        if (i > 0) h->nodes[node].right = below;
        node = below;
        if (i == singles) break;
        single = sc_hierarchy_add(h, i, 1, i + 2);
        h->nodes[node].left = single;
    }
    h->node_count--; /* which add_tree adds itself */
    add_tree(h, singles + 3, 200, singles + 1, HALVES);
    for (; h->nodes[node].left != SC_NONE; node = h->nodes[node].left) {
        h->nodes[node].first = singles;
        h->nodes[node].count += 3;
        ++depth;
    }
    for (uint32_t i = 3; i > 0; --i) { /* the leaf's place is taken by an island and what is left */
        uint32_t island, rest;
        h->nodes[node].first = singles + 3 - i;
        h->nodes[node].count = i + 1;
        island = sc_hierarchy_add(h, singles + 3 - i, 1, depth + 5 - i);
        rest = sc_hierarchy_add(h, singles + 4 - i, i, depth + 5 - i);
        h->nodes[node].left = island;
        h->nodes[node].right = rest;
        node = rest;
    }
}

static void islands(void)
{
    static const uint32_t singles[] = {0, 1, 22, 23, 24, 30};
    for (size_t i = 0; i < sizeof(singles) / sizeof(singles[0]); ++i) {
        sc_allocator allocator = sc_memory_allocator(NULL);
        sc_scratch scratch;
        sc_hierarchy h;
        uint32_t depth = 11 + singles[i];
        sc_scratch_init(&scratch, &allocator);
        h = start(&scratch, 203 + singles[i]);
        add_islands(&h, singles[i]);
        CHECK(h.depth == depth && sc_hierarchy_validate(&h, &scratch) == 1);
        CHECK(sc_hierarchy_finish(&h, &scratch) == SC_OK);
        CHECK(sc_flattening_run(&scratch, &h) == SC_OK);
        CHECK_MSG(h.depth == depth - 1 && h.depth == depth_below(h.nodes, 0), "%" PRIu32, h.depth);
        CHECK(sc_hierarchy_validate(&h, &scratch) == 1);
        sc_scratch_clear(&scratch);
    }
}

/* An allocator that fails from some call on, and counts what it gave. */
typedef struct limited {
    uint32_t left, given;
} limited;

static void *allocate_limited(void *user, uint64_t size, uint64_t alignment)
{
    limited *l = (limited *)user;
    (void)alignment;
    if (l->left == 0) return NULL;
    --l->left;
    ++l->given;
    return malloc((size_t)size);
}

static void release_limited(void *user, void *memory, uint64_t size)
{
    (void)size;
    --((limited *)user)->given;
    free(memory);
}

static void every_allocation_fails(void)
{
    uint32_t failed = 0, enough = 0;
    for (uint32_t left = 0; left < 40 && !enough; ++left) {
        limited l = {UINT32_MAX, 0};
        sc_allocator allocator = {allocate_limited, release_limited, NULL};
        sc_scratch scratch;
        sc_hierarchy h;
        allocator.user = &l;
        sc_scratch_init(&scratch, &allocator);
        h = start(&scratch, 203);
        add_islands(&h, 0);
        CHECK(sc_hierarchy_finish(&h, &scratch) == SC_OK);
        l.left = left;
        if (sc_hierarchy_validate(&h, &scratch) == 1) {
            sc_status status;
            l.left = left;
            status = sc_flattening_run(&scratch, &h);
            enough = status == SC_OK;
            CHECK(enough || status == SC_ERROR_MEMORY);
            failed += !enough;
        }
        sc_scratch_clear(&scratch);
        CHECK(l.given == 0);
    }
    CHECK(enough && failed > 1);
}

SC_TEST_MAIN(SC_TEST(trees), SC_TEST(islands), SC_TEST(every_allocation_fails))
