/*
 * Checks a model that comes from outside. See model_check.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Loops collect what is wrong instead of stopping at it, where that lets them run several elements
 * at once. Whatever a later check takes as an index has passed an earlier one.
 */
#include "build/model_check.h"

#include <string.h>

#include "base/bits.h"

int sc_model_check_counts(const sc_model *m, uint64_t bytes)
{
    sc_model expected = *m;
    uint32_t limit = 0xfffffff0u; /* what sc_build keeps below, for numbers that are added to */
    if (!m->vertex_count || m->vertex_count == SC_NONE) return 0;
    if (!m->triangle_count || m->triangle_count > 0x55555554u) return 0;
    if (!m->point_count || m->point_count > m->vertex_count) return 0;
    if (!m->leaf_count || m->leaf_count > m->triangle_count) return 0;
    if (m->leaf_count > SC_LEAVES_MAX) return 0;
    if (!m->level_count || m->level_count > SC_DEPTH_MAX) return 0;
    if (!m->patch_end || m->segment_count < m->leaf_segment_count) return 0;
    if (sc_model_is_for_boxes(m) &&
        (m->segment_count || m->contour_max || m->contour_total || m->loop_total))
        return 0;
    if (m->patch_end > limit || m->node_count > limit || m->reserved) return 0;
    sc_model_lay_out(&expected);
    if (m->bytes != bytes || expected.bytes != bytes) return 0;
    return memcmp(m->offset, expected.offset, sizeof m->offset) == 0;
}

static int all_below(const uint32_t *array, uint64_t count, uint32_t limit)
{
    uint32_t bad = 0;
    uint64_t i;
    for (i = 0; i < count; i++) bad |= array[i] >= limit;
    return !bad;
}

static int bytes_below(const uint8_t *array, uint64_t count, uint32_t limit)
{
    uint32_t bad = 0;
    uint64_t i;
    for (i = 0; i < count; i++) bad |= array[i] >= limit;
    return !bad;
}

/* Whether `count` lists that start at first[i] in an array of total elements have from least to
   most elements each. */
static int are_lists(const uint32_t *first, uint64_t count, uint32_t total, uint32_t least,
                     uint32_t most)
{
    uint32_t bad = 0;
    uint64_t i;
    for (i = 0; i < count; i++) {
        uint32_t length = first[i + 1] - first[i];
        bad |= (first[i + 1] < first[i]) | (length < least) | (length > most);
    }
    return !bad && first[0] == 0 && first[count] == total;
}

static int check_use(const sc_model *m)
{
    const uint8_t *use = sc_model_vertex_use(m);
    uint32_t v, points = 0, bad = 0;
    for (v = 0; v < m->vertex_count; v++) {
        points += use[v] == SC_VERTEX_POINT;
        bad |= use[v] > SC_VERTEX_UNUSED;
    }
    return !bad && points == m->point_count;
}

/* Whether all of them are points: what is no point may have a position that is not finite. */
static int are_points(const sc_model *m, const uint32_t *array, uint64_t count)
{
    const uint8_t *use = sc_model_vertex_use(m);
    uint32_t bad = 0;
    uint64_t i;
    if (!all_below(array, count, m->vertex_count)) return 0;
    for (i = 0; i < count; i++) bad |= use[array[i]];
    return !bad;
}

/* Whether the corners of each cluster's triangles are where leaf_corner says. */
static int check_corners(const sc_model *m)
{
    const uint32_t *first = sc_model_leaf_first(m), *corner = sc_model_triangle(m);
    const uint32_t *point = sc_model_leaf_point(m);
    const uint8_t *where = sc_model_leaf_corner(m);
    uint32_t leaf, i, k, bad = 0;
    if (!bytes_below(where, 3 * SC_LEAF_MAX * (uint64_t)m->leaf_count, SC_LEAF_POINTS)) return 0;
    for (leaf = 0; leaf < m->leaf_count; leaf++, point += SC_LEAF_POINTS, where += 3 * SC_LEAF_MAX)
        for (i = 0; i < SC_LEAF_MAX; i++) {
            uint32_t t = first[leaf] + i < first[leaf + 1] ? first[leaf] + i : first[leaf + 1] - 1;
            for (k = 0; k < 3; k++)
                bad |= point[where[SC_LEAF_MAX * k + i]] != corner[3 * (uint64_t)t + k];
        }
    return !bad;
}

/* Whether outlines of two chains are of places. */
static int check_outlines(const sc_model *m)
{
    const uint8_t *outline = sc_model_leaf_outline(m);
    uint32_t bad = 0;
    uint64_t i;
    for (i = 0; i < SC_LEAF_POINTS * (uint64_t)m->leaf_count; i++) {
        const uint8_t last = outline[i | (SC_LEAF_POINTS - 1)];
        bad |= outline[i] >= (last & SC_OUTLINE_TWO ? 2 * SC_OUTLINE_NOWHERE : SC_LEAF_POINTS);
    }
    return !bad;
}

/* Every triangle of the caller's once. */
static int check_ids(const sc_model *m, uint8_t *seen)
{
    const uint32_t *id = sc_model_triangle_id(m);
    uint32_t t;
    memset(seen, 0, m->triangle_count);
    for (t = 0; t < m->triangle_count; t++) {
        if (id[t] >= m->triangle_count || seen[id[t]]) return 0;
        seen[id[t]] = 1;
    }
    return 1;
}

/* Where each of the caller's triangles is. */
static int check_places(const sc_model *m)
{
    const uint32_t *id = sc_model_triangle_id(m), *place = sc_model_place(m);
    uint32_t i, bad = 0;
    for (i = 0; i < m->triangle_count; i++) bad |= place[id[i]] != i;
    return !bad;
}

/* Each level has a patch or more, and the number behind them; the first has one, the last all
   leaves. */
static int check_levels(const sc_model *m)
{
    const uint32_t *first = sc_model_level_first(m);
    uint32_t last = m->level_count - 1;
    return are_lists(first, m->level_count, m->patch_end, 2, SC_NONE) && first[1] == 2 &&
           first[last + 1] - first[last] - 1 == m->leaf_count;
}

/* See build/xbvh.h: children are one or two, consecutive, and cover the next level. */
static int check_child(const sc_model *m)
{
    const uint32_t *first = sc_model_level_first(m), *child = sc_model_child(m);
    uint32_t level, p;
    for (level = 0; level < m->level_count; level++) {
        uint32_t begin = first[level], end = first[level + 1] - 1, bad = 0;
        if (level + 1 == m->level_count) {
            for (p = begin; p <= end; p++) bad |= child[p] != p;
        } else {
            bad = (child[begin] != end + 1) | (child[end] != first[level + 2] - 1);
            for (p = begin; p < end; p++)
                bad |= (child[p + 1] <= child[p]) | (child[p + 1] - child[p] > 2);
        }
        if (bad) return 0;
    }
    return 1;
}

/* The leaves of a patch are those of its children. */
static int check_leaf(const sc_model *m)
{
    const uint32_t *first = sc_model_level_first(m), *child = sc_model_child(m);
    const uint32_t *leaf = sc_model_leaf(m);
    uint32_t level, p;
    for (level = m->level_count; level-- > 0;) {
        uint32_t begin = first[level], end = first[level + 1] - 1, bad = 0;
        if (level + 1 == m->level_count)
            for (p = begin; p <= end; p++) bad |= leaf[p] != p - begin;
        else
            for (p = begin; p <= end; p++) bad |= leaf[p] != leaf[child[p]];
        if (bad) return 0;
    }
    return 1;
}

static int check_box_child(const sc_model *m)
{
    const uint32_t *first = sc_model_level_first(m), *child = sc_model_child(m);
    const uint32_t *box_child = sc_model_box_child(m);
    uint32_t level, p, step;
    for (level = 0; level < m->level_count; level++) {
        uint32_t steps = sc_model_box_steps(m->level_count, level);
        for (p = first[level]; p < first[level + 1]; p++) {
            uint32_t to = p;
            for (step = 0; step < steps; step++) to = child[to];
            if (box_child[p] != to) return 0;
        }
    }
    return 1;
}

/* Whether a node's next child is of two patches. */
static int is_node_of(const sc_model *m, uint32_t node, uint32_t a, uint32_t b)
{
    return node < m->node_count && sc_model_node(m)[node].patches.a == a &&
           sc_model_node(m)[node].patches.b == b;
}

/* Whether a node's children, of which *next is the first, and what it leaves to boxes are all pairs
   of children of its patches, each once; *next becomes what follows them. */
static int check_children_of_node(const sc_model *m, const sc_node *node, uint32_t *next)
{
    const uint32_t *child = sc_model_child(m);
    const uint32_t a = node->patches.a, b = node->patches.b;
    uint32_t pairs = 0, c, d, bit;
    if (sc_model_is_leaf(m, a) && sc_model_is_leaf(m, b)) return !node->pairs;
    for (c = child[a]; a == b && c < child[a + 1]; c++) {
        if (!is_node_of(m, (*next)++, c, c)) return 0;
        pairs |= 1u << 3 * (c - child[a]);
    }
    for (c = child[a]; c < child[a + 1]; c++)
        for (d = a == b ? c + 1 : child[b]; d < child[b + 1]; d++) {
            bit = 1u << (2 * (c - child[a]) + d - child[b]);
            if (node->pairs & bit) {
                if (!is_node_of(m, (*next)++, c, d)) return 0;
            } else {
                bit <<= SC_PAIR_BOXES;
            }
            pairs |= bit;
        }
    return node->pairs == pairs;
}

/* Behind the last node. */
static int check_last_node(const sc_model *m)
{
    sc_node expected;
    memset(&expected, 0, sizeof expected);
    expected.child = m->node_count;
    expected.contour = m->contour_total;
    return memcmp(&expected, &sc_model_node(m)[m->node_count], sizeof expected) == 0;
}

/* An empty test tree. */
static const char *check_no_nodes(const sc_model *m)
{
    uint32_t level;
    for (level = 0; level < m->level_count; level++) {
        sc_level expected;
        memset(&expected, 0, sizeof expected);
        expected.patch_count = sc_model_patches(m, level);
        if (memcmp(&expected, &sc_model_level_info(m)[level], sizeof expected) != 0)
            return "level_info";
    }
    return check_last_node(m) ? NULL : "node";
}

/*
 * The self-collision test tree (build/sctt.h). Node 0 is the mesh against itself, and the children
 * of each node are all pairs of children of its patches, each once, be it as a node or for boxes.
 * So nodes are of patches of one level, no deeper than the hierarchy. Lists of segments follow each
 * other, and so do loops.
 */
static const char *check_nodes(const sc_model *m)
{
    const sc_node *node = sc_model_node(m);
    const sc_level *info = sc_model_level_info(m);
    uint32_t n, level, level_end, selves, next = 1;
    uint64_t loops = 0;
    if (sc_model_is_for_boxes(m)) return check_no_nodes(m);
    if (node->patches.a != 0 || node->patches.b != 0 || node->contour != 0) return "node";
    for (n = 0, level = 0; level < m->level_count; level++) {
        uint32_t begin = n;
        for (level_end = next, selves = 0; n < level_end; n++, node++) {
            if (node->child != next || !check_children_of_node(m, node, &next)) return "node";
            if (node->loop != loops || node[1].contour < node->contour) return "node";
            if (node->loop_length > m->contour_max + 1 || node->kind > 15) return "node";
            loops += node->loop_length;
            selves += node->patches.a == node->patches.b;
        }
        if (info[level].patch_count != sc_model_patches(m, level) ||
            info[level].connected_patches > info[level].patch_count ||
            info[level].self_nodes != selves || info[level].pair_nodes != n - begin - selves)
            return "level_info";
    }
    return n == m->node_count && loops == m->loop_total && check_last_node(m) ? NULL : "node";
}

/* The triangles of a patch. */
static uint32_t patch_size(const sc_model *m, uint32_t patch)
{
    const uint32_t *leaf = sc_model_leaf(m), *first = sc_model_leaf_first(m);
    return first[leaf[patch + 1]] - first[leaf[patch]];
}

/* A workspace has room for the points round a node, of which contour_max is exactly the most. No
   node has more edges than its triangles have sides: so a test is no slower than for any mesh. */
static int check_contours(const sc_model *m)
{
    const uint32_t *begin = sc_model_segment_first(m), *end = sc_model_segment_last(m);
    const uint32_t *contours = sc_model_contours(m);
    const sc_node *node = sc_model_node(m);
    uint64_t most = 0;
    uint32_t n, i;
    for (n = 0; n < m->node_count; n++, node++) {
        uint64_t edges = 0, listed;
        i = node->contour;
        if (node->kind & SC_NODE_TOUCHES) {
            if (node[1].contour - i < 2 || contours[i] >= m->vertex_count ||
                contours[i + 1] > node[1].contour - i - 2)
                return 0;
            i += 2;
        }
        for (listed = node[1].contour - i; i < node[1].contour; i++) {
            if (contours[i] >= m->segment_count) return 0;
            edges += end[contours[i]] - begin[contours[i]];
        }
        listed += edges;
        if (listed > most) most = listed;
        if (edges > 3 * ((uint64_t)patch_size(m, node->patches.a) + patch_size(m, node->patches.b)))
            return 0;
    }
    return most == m->contour_max;
}

/* How many numbers of a loop in pieces come before its points, all of which are in a piece; 0: that
   is wrong. */
static uint32_t check_pieces(const uint16_t *loop, uint32_t count)
{
    uint32_t pieces = loop[0], sum = 0, i;
    if (pieces < 2 || pieces > SC_LOOP_PIECES || 1 + pieces > count) return 0;
    for (i = 1; i <= pieces; i++) {
        if (!loop[i]) return 0;
        sum += loop[i];
    }
    return sum == count - 1 - pieces ? 1 + pieces : 0;
}

/* The points of each loop are of the node's leaf clusters, and no more than its triangles have
   sides. */
static int check_loops(const sc_model *m)
{
    const uint32_t *leaf = sc_model_leaf(m);
    const sc_node *node = sc_model_node(m);
    uint32_t n, i;
    for (n = 0; n < m->node_count; n++, node++) {
        const uint16_t *loop = sc_model_loop(m) + node->loop;
        uint32_t a = node->patches.a, b = node->patches.b, count = node->loop_length, bad = 0;
        uint64_t leaves = leaf[a + 1] - leaf[a], triangles = patch_size(m, a);
        if (a != b) {
            leaves += leaf[b + 1] - leaf[b];
            triangles += patch_size(m, b);
        }
        i = 0;
        if (count && node->kind & SC_NODE_PIECES) {
            i = check_pieces(loop, count);
            if (!i) return 0;
        }
        if (count - i > 3 * triangles) return 0;
        for (; i < count; i++) bad |= loop[i] >= SC_LEAF_POINTS * leaves;
        if (bad) return 0;
    }
    return 1;
}

/* The points of each segment. */
static int check_segments(const sc_model *m)
{
    const uint32_t *first = sc_model_segment_first(m), *last = sc_model_segment_last(m);
    uint32_t s, bad = 0;
    for (s = 0; s < m->segment_count; s++)
        bad |= (first[s] >= last[s]) | (last[s] >= m->segment_point_total);
    return !bad;
}

/* The contour segment forest (build/csf.h): children have lower numbers, one parent at most, and
   are nowhere deeper than the hierarchy, and their points are those of the parent, in order. */
static int check_children(const sc_model *m, uint8_t *depth)
{
    const uint32_t *begin = sc_model_segment_first(m), *end = sc_model_segment_last(m);
    const uint32_t *first = sc_model_segment_children(m), *children = sc_model_children(m);
    uint32_t s, i;
    memset(depth, 1, m->leaf_segment_count);
    for (s = m->leaf_segment_count; s < m->segment_count; s++, first++) {
        uint32_t deepest = 0, at = begin[s];
        for (i = first[0]; i < first[1]; i++) {
            uint32_t child = children[i];
            if (child >= s || depth[child] == 0 || begin[child] != at) return 0;
            at = end[child];
            if (depth[child] > deepest) deepest = depth[child];
            depth[child] = 0; /* has a parent */
        }
        if (at != end[s] || deepest >= m->level_count) return 0;
        depth[s] = (uint8_t)(deepest + 1);
    }
    return 1;
}

/* Which clusters a cluster shares points with (build/sharing.h): higher ones, ascending, and no
   more than a cluster can have, as a query looks through them. */
static int check_share_leaf(const sc_model *m)
{
    const uint32_t *first = sc_model_share_first(m), *other = sc_model_share_leaf(m);
    uint32_t leaf, i, bad = 0;
    for (leaf = 0; leaf < m->leaf_count; leaf++) {
        uint32_t last = leaf;
        for (i = first[leaf]; i < first[leaf + 1]; i++) {
            bad |= (other[i] <= last) | (other[i] >= m->leaf_count);
            last = other[i];
        }
    }
    return !bad;
}

/* A list of pairs that share points (build/sharing_lists.h), in so many words, of clusters of so
   many triangles: pairs are of these, each once, and rows tell the same. */
static int is_share_list(const uint16_t *list, uint32_t words, uint32_t of_a, uint32_t of_b)
{
    const uint32_t some = list[SC_SHARE_TRIANGLES], rows = sc_bits_count(some);
    const uint16_t *row = list + SC_SHARE_ROWS, *pair = row + rows;
    uint32_t seen[SC_LEAF_MAX] = {0}, bad, i;
    if (words < SC_SHARE_ROWS + rows) return 0;
    words -= SC_SHARE_ROWS + rows;
    bad = sc_share_points(list) + sc_share_edges(list) > words;
    for (i = 0; i < words; i++) {
        uint32_t t = pair[i] & 15u, u = pair[i] >> 4 & 15u;
        bad |= (t >= of_a) | (u >= of_b) | (seen[t] >> u & 1u);
        bad |= ((pair[i] >> 8 & 15u) > 2) | (pair[i] >> 12 > 2);
        seen[t] |= 1u << u;
    }
    for (i = 0; i < SC_LEAF_MAX; i++) bad |= seen[i] != (some >> i & 1u ? *row++ : 0u);
    return !bad;
}

/* Those of all clusters, and nothing behind them. */
static int check_share_list(const sc_model *m)
{
    const uint32_t *share = sc_model_share_first(m), *other = sc_model_share_leaf(m);
    const uint32_t *first = sc_model_leaf_first(m), *begin = sc_model_share_begin(m);
    const uint16_t *list = sc_model_share_list(m);
    uint32_t leaf, i, bad = 0;
    for (leaf = 0; leaf < m->leaf_count; leaf++)
        for (i = share[leaf]; i < share[leaf + 1]; i++)
            if (!is_share_list(list + begin[i], begin[i + 1] - begin[i],
                               first[leaf + 1] - first[leaf],
                               first[other[i] + 1] - first[other[i]]))
                return 0;
    for (i = begin[m->share_count]; i < m->share_total; i++) bad |= list[i];
    return !bad;
}

/* Of each two of them the node; none in models for boxes. That there is one matters: a query does
   not ask which triangles share points of pairs that nodes leave to boxes. */
static int check_share_node(const sc_model *m)
{
    const uint32_t *share_node = sc_model_share_node(m), *leaf = sc_model_leaf(m);
    const uint32_t *first = sc_model_share_first(m), *other = sc_model_share_leaf(m);
    const sc_node *node = sc_model_node(m);
    uint32_t a, i, n, bad = 0;
    for (a = 0; a < m->leaf_count; a++)
        for (i = first[a]; i < first[a + 1]; i++) {
            n = share_node[i];
            if (sc_model_is_for_boxes(m)) {
                bad |= n != SC_NONE;
            } else {
                if (n >= m->node_count || !sc_node_is_leaf(&node[n])) return 0;
                bad |= (leaf[node[n].patches.a] != a) | (leaf[node[n].patches.b] != other[i]);
            }
        }
    return !bad;
}

static const char *check_arrays(const sc_model *m, uint8_t *bytes)
{
    const char *wrong;
    uint32_t count = m->triangle_count;
#define CHECK(name, condition)                                                                     \
  if (!(condition)) return #name
    CHECK(vertex_use, check_use(m));
    CHECK(triangle, are_points(m, sc_model_triangle(m), 3 * (uint64_t)count));
    CHECK(triangle_id, check_ids(m, bytes));
    CHECK(place, check_places(m));
    CHECK(edge_owned, bytes_below(sc_model_edge_owned(m), count, 8));
    CHECK(leaf_first, are_lists(sc_model_leaf_first(m), m->leaf_count, count, 1, SC_LEAF_MAX));
    CHECK(leaf_point,
          are_points(m, sc_model_leaf_point(m), SC_LEAF_POINTS * (uint64_t)m->leaf_count));
    CHECK(leaf_corner, check_corners(m));
    CHECK(leaf_outline, check_outlines(m));
    CHECK(level_first, check_levels(m));
    CHECK(child, check_child(m));
    CHECK(leaf, check_leaf(m));
    CHECK(box_child, check_box_child(m));
    CHECK(around_first,
          are_lists(sc_model_around_first(m), m->vertex_count, m->around_total, 0, SC_NONE));
    CHECK(around, are_points(m, sc_model_around(m), m->around_total));
    CHECK(share_first, are_lists(sc_model_share_first(m), m->leaf_count, m->share_count, 0,
                                 3 * SC_LEAF_MAX * SC_SHARING_CROWD));
    CHECK(share_leaf, check_share_leaf(m));
    CHECK(share_begin,
          m->share_total >= SC_SHARE_BEHIND &&
              are_lists(sc_model_share_begin(m), m->share_count, m->share_total - SC_SHARE_BEHIND,
                        SC_SHARE_ROWS, SC_SHARE_ROWS + SC_LEAF_MAX * (SC_LEAF_MAX + 1)));
    CHECK(share_list, check_share_list(m));
    CHECK(share_crowded, bytes_below(sc_model_share_crowded(m), m->leaf_count, 2));
    wrong = check_nodes(m);
    if (wrong) return wrong;
    CHECK(share_node, check_share_node(m));
    CHECK(loop, check_loops(m));
    CHECK(segment_first, check_segments(m));
    CHECK(points, are_points(m, sc_model_points(m), m->segment_point_total));
    CHECK(segment_children,
          are_lists(sc_model_segment_children(m), m->segment_count - m->leaf_segment_count,
                    m->segment_child_total, 2, SC_NONE));
    CHECK(children, check_children(m, bytes));
    CHECK(contours, check_contours(m));
#undef CHECK
    return NULL;
}

sc_status sc_model_check(const sc_model *m, sc_scratch *scratch, const char **wrong)
{
    uint32_t most = m->triangle_count;
    uint8_t *bytes;
    if (m->segment_count > most) most = m->segment_count;
    bytes = (uint8_t *)sc_scratch_take(scratch, most, 1);
    if (!bytes) return SC_ERROR_MEMORY;
    *wrong = check_arrays(m, bytes);
    sc_scratch_give(scratch, bytes);
    return *wrong ? SC_ERROR_INCONSISTENT : SC_OK;
}
