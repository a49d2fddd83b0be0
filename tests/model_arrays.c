/*
 * See model_arrays.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model_arrays.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "build/model.h"
#include "build/csf.h"
#include "build/hierarchy.h"
#include "build/sharing_lists.h"
#include "harness.h"
#include "inputs.h"

/* Patches connected through edges, by spreading the lowest number. */
static uint32_t count_connected(const structures *s, const uint32_t *patch, uint32_t patch_count)
{
    uint32_t count = s->points.triangle_count, h, i, changed = 1, connected = 0;
    uint32_t *lowest = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    uint32_t *parts = (uint32_t *)structures_zeroed(patch_count * sizeof(uint32_t));
    for (i = 0; i < count; ++i) lowest[i] = i;
    while (changed)
        for (changed = h = 0; h < 3 * count; ++h) {
            uint32_t o = s->adjacency.opposite[h];
            if (o == SC_NONE || patch[o / 3] != patch[h / 3] || lowest[o / 3] <= lowest[h / 3])
                continue;
            lowest[o / 3] = lowest[h / 3];
            changed = 1;
        }
    for (i = 0; i < count; ++i) parts[patch[i]] += lowest[i] == i;
    for (i = 0; i < patch_count; ++i) connected += parts[i] == 1;
    free(parts);
    free(lowest);
    return connected;
}

/* What box recursion visits: the descendants of each patch, eight at most, some levels down. */
static void check_box_children(const structures *s, const sc_model *model)
{
    const uint32_t *hop = sc_model_box_child(model), *leaf = sc_model_leaf(model);
    uint32_t l, p, wrong = 0;
    for (l = 0; l + 1 < model->level_count; ++l)
        for (p = sc_model_level_first(model)[l]; p + 1 < sc_model_level_first(model)[l + 1]; ++p) {
            wrong += hop[p] <= p || hop[p + 1] <= hop[p] || hop[p + 1] - hop[p] > 16;
            wrong += leaf[hop[p]] != leaf[p] || leaf[hop[p + 1]] != leaf[p + 1];
        }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " hops wrong", s->name, wrong);
}

/* Whether some triangle has an edge between two points. */
static int are_joined(const sc_model *model, uint32_t p, uint32_t q)
{
    const uint32_t *triangles = sc_model_triangle(model);
    for (uint32_t i = 0; i < 3 * model->triangle_count; ++i) {
        uint32_t next = triangles[i % 3 == 2 ? i - 2 : i + 1];
        if ((triangles[i] == p && next == q) || (triangles[i] == q && next == p)) return 1;
    }
    return 0;
}

/* The points round each: all that edges join it with and no others; once each, if every edge has
   two triangles, which have three points. */
static void check_around(const structures *s, const sc_model *model)
{
    const uint32_t *first = sc_model_around_first(model), *around = sc_model_around(model);
    const uint32_t *t = sc_model_triangle(model);
    uint32_t irregular = model->boundary_edges + model->irregular_edges;
    uint32_t wrong = 0, twice = 0, p, q, i;
    for (i = 0; i < model->triangle_count; ++i, t += 3)
        irregular += t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    for (p = 0; p < model->vertex_count; ++p)
        for (q = 0; q < model->vertex_count; ++q) {
            uint32_t listed = 0;
            for (i = first[p]; i < first[p + 1]; ++i) listed += around[i] == q;
            wrong += (listed > 0) != are_joined(model, p, q);
            twice += listed > 1;
        }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " neighbors wrong", s->name, wrong);
    CHECK_MSG(twice == 0 || irregular, "%s: %" PRIu32 " neighbors twice", s->name, twice);
}

/* Triangles of a leaf cluster round a point of it in any order, each given as where it begins and
   where it ends: whether they can be put in a row or, all, in a circle, so that each begins where
   the one before ends, and none anywhere twice. */
static int is_fan(const uint32_t (*turn)[2], uint32_t count, int circle)
{
    uint32_t first, i, k, row;
    for (i = 0; i < count; ++i)
        for (k = 0; k < i; ++k)
            if (turn[i][0] == turn[k][0] || turn[i][1] == turn[k][1]) return 0;
    for (first = 0; first < count; ++first) {
        uint32_t now = first;
        for (row = 1; row < count; ++row) {
            for (i = 0; i < count && turn[i][0] != turn[now][1]; ++i) continue;
            if (i == count || i == first) break;
            now = i;
        }
        if (row == count && (turn[now][1] == turn[first][0]) == circle) return 1;
    }
    return 0;
}

static void check_fans(const structures *s, const sc_model *model)
{
    const uint32_t *first = sc_model_leaf_first(model), *triangle = sc_model_triangle(model);
    uint32_t leaf, p, i, k, wrong = 0;
    for (leaf = 0; leaf < model->leaf_count; ++leaf) {
        const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * leaf;
        const uint16_t *fan = sc_model_leaf_fan(model) + 2 * leaf;
        for (p = 0; p < SC_LEAF_POINTS; ++p) {
            uint32_t turn[3 * SC_LEAF_MAX][2], count = 0;
            int again = p > 0 && point[p] == point[p - 1]; /* fills the row */
            for (i = first[leaf]; i < first[leaf + 1] && !again; ++i)
                for (k = 0; k < 3; ++k) {
                    if (triangle[3 * i + k] != point[p]) continue;
                    turn[count][0] = triangle[3 * i + (k + 1) % 3];
                    turn[count++][1] = triangle[3 * i + (k + 2) % 3];
                }
            wrong += (fan[0] >> p & 1) != (count && is_fan((const uint32_t(*)[2])turn, count, 1));
            wrong += (fan[1] >> p & 1) != (count && is_fan((const uint32_t(*)[2])turn, count, 0));
        }
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " fans of leaf clusters wrong", s->name, wrong);
}

/* The edges of a leaf cluster that no opposite one makes up for, by their points: how many; or 0 if
   two begin at one point, or one is there twice. */
static uint32_t list_outline(const sc_model *model, uint32_t leaf, uint32_t edge[][2])
{
    const uint32_t *first = sc_model_leaf_first(model), *triangle = sc_model_triangle(model);
    uint32_t edges = 0, is_chain = 1, h, g;
    for (h = 3 * first[leaf]; h < 3 * first[leaf + 1]; ++h) {
        uint32_t from = triangle[h], to = triangle[h / 3 * 3 + (h + 1) % 3], opposite = 0;
        for (g = 3 * first[leaf]; g < 3 * first[leaf + 1]; ++g) {
            uint32_t begin = triangle[g], end = triangle[g / 3 * 3 + (g + 1) % 3];
            opposite |= begin == to && end == from;
            is_chain &= g == h || begin != from || end != to;
        }
        if (opposite) continue;
        edge[edges][0] = from;
        edge[edges++][1] = to;
    }
    for (h = 0; h < edges; ++h)
        for (g = 0; g < h; ++g) is_chain &= edge[h][0] != edge[g][0];
    return is_chain ? edges : 0;
}

/* Moves the edges of a chain, that of one of them, before the others; returns how many. */
static uint32_t sort_chain(uint32_t edge[][2], uint32_t edges)
{
    uint32_t count = 1, h;
    while (count < edges && edge[count - 1][1] != edge[0][0]) {
        for (h = count; edge[h][0] != edge[count - 1][1]; ++h) continue;
        for (uint32_t k = 0; k < 2; ++k) {
            uint32_t point = edge[h][k];
            edge[h][k] = edge[count][k];
            edge[count][k] = point;
        }
        ++count;
    }
    return count;
}

/* Outlines of leaf clusters: each edge that no opposite one makes up for once, if these are two
   circles that come to no point twice. */
static void check_outlines(const structures *s, const sc_model *model)
{
    uint32_t leaf, h, i, wrong = 0;
    for (leaf = 0; leaf < model->leaf_count; ++leaf) {
        const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * leaf;
        const uint8_t *outline = sc_model_leaf_outline(model) + SC_LEAF_POINTS * leaf;
        uint32_t edge[3 * SC_LEAF_MAX][2], found = 0, of_first = ~0u;
        uint32_t edges = list_outline(model, leaf, edge),
                 chain = edges ? sort_chain(edge, edges) : 0;
        uint32_t second = chain < edges ? sort_chain(edge + chain, edges - chain) : 0;
        if (!(outline[SC_LEAF_POINTS - 1] & SC_OUTLINE_TWO)) {
            for (i = 0; i < SC_LEAF_POINTS; ++i) wrong += outline[i] != 0;
            wrong += second && chain + second == edges;
            continue;
        }
        for (i = 0; i < SC_LEAF_POINTS; ++i) {
            uint32_t is_second = (outline[i] & SC_OUTLINE_SECOND) != 0;
            if (outline[i] & SC_OUTLINE_NOWHERE) continue;
            for (h = 0; h < edges; ++h)
                if (edge[h][0] == point[i] && edge[h][1] == point[outline[i] & 15]) {
                    if (of_first == ~0u) of_first = (h < chain) ^ is_second;
                    wrong += ((h < chain) ^ is_second) != of_first;
                    ++found;
                }
        }
        wrong += !second || chain + second != edges || found != edges;
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " outlines of leaf clusters wrong", s->name, wrong);
}

/* Leaf clusters that share a whole chain of an outline of two. */
static void check_shared_chains(const structures *s, const sc_model *model)
{
    const uint32_t *first = sc_model_share_first(model), *other = sc_model_share_leaf(model);
    uint32_t wrong = 0;
    for (uint32_t leaf = 0; leaf < model->leaf_count; ++leaf)
        for (uint32_t i = first[leaf]; i < first[leaf + 1]; ++i) {
            const uint32_t *p = sc_model_leaf_point(model) + SC_LEAF_POINTS * leaf;
            const uint32_t *q = sc_model_leaf_point(model) + SC_LEAF_POINTS * other[i];
            uint32_t edge[2][3 * SC_LEAF_MAX][2], edges[2], chain[2], shared = 0, expected = 0;
            for (uint32_t k = 0; k < 2; ++k) {
                edges[k] = list_outline(model, k ? other[i] : leaf, edge[k]);
                chain[k] = edges[k] ? sort_chain(edge[k], edges[k]) : 0;
                if (chain[k] < edges[k])
                    expected +=
                        chain[k] + sort_chain(edge[k] + chain[k], edges[k] - chain[k]) == edges[k];
            }
            for (uint32_t k = 0; k < SC_LEAF_POINTS; ++k) {
                uint32_t same = 0;
                for (uint32_t h = 0; h < SC_LEAF_POINTS; ++h) same |= p[k] == q[h];
                shared += same && (k == 0 || p[k] != p[k - 1]);
            }
            expected = expected == 2;
            if (expected) { /* edges of a chain of both, and no other shared point */
                uint32_t most = 0;
                for (uint32_t k = 0; k < 4; ++k) {
                    uint32_t from[2] = {k & 1 ? chain[0] : 0, k & 2 ? chain[1] : 0}, same = 0;
                    uint32_t to[2] = {k & 1 ? edges[0] : chain[0], k & 2 ? edges[1] : chain[1]};
                    for (uint32_t h = from[0]; h < to[0]; ++h)
                        for (uint32_t g = from[1]; g < to[1]; ++g)
                            same +=
                                edge[0][h][0] == edge[1][g][1] && edge[0][h][1] == edge[1][g][0];
                    most |= same == shared && to[0] - from[0] == same && to[1] - from[1] == same;
                }
                expected = most;
            }
            wrong += expected != ((sc_model_share_touch(model)[i] & SC_TOUCH_CHAIN) != 0);
        }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " pairs of leaf clusters share a chain or not", s->name,
              wrong);
}

/* The nodes of two leaf clusters that share points. */
static void check_share_nodes(const structures *s, const sc_model *model)
{
    const uint32_t *first = sc_model_share_first(model), *leaf = sc_model_leaf(model);
    uint32_t wrong = 0, known = 0, found = 0;
    for (uint32_t i = 0; i < model->share_count; ++i)
        known += sc_model_share_node(model)[i] != SC_NONE;
    for (uint32_t n = 0; n < model->node_count; ++n) {
        sc_pair pair = sc_model_node(model)[n].patches;
        uint32_t a = leaf[pair.a], b = leaf[pair.b];
        if (pair.a == pair.b || leaf[pair.a + 1] > a + 1 || leaf[pair.b + 1] > b + 1) continue;
        for (uint32_t i = first[a]; i < first[a + 1]; ++i) {
            if (sc_model_share_leaf(model)[i] != b) continue;
            wrong += sc_model_share_node(model)[i] != n;
            found++;
        }
    }
    CHECK_MSG(wrong == 0 && known == found, "%s: %" PRIu32 " nodes of leaf clusters wrong", s->name,
              wrong);
}

/* The edges of a piece of a node's loop, from point to point; writes as many as there are. */
static void list_loop(const structures *s, const sc_model *m, uint32_t n, const uint16_t *loop,
                      uint32_t count, sc_pair *edges)
{
    sc_pair pair = sc_model_node(m)[n].patches;
    const uint32_t *leaf = sc_model_leaf(m);
    uint32_t split = leaf[pair.a + 1] - leaf[pair.a];
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t number = loop[i], at = number / SC_LEAF_POINTS;
        at = at < split ? leaf[pair.a] + at : leaf[pair.b] + at - split;
        CHECK(at < leaf[(at < leaf[pair.a + 1] ? pair.a : pair.b) + 1]);
        number =
            sc_model_leaf_point(m)[SC_LEAF_POINTS * at + sc_loops_turn(number % SC_LEAF_POINTS)];
        edges[i].a = edges[(i + count - 1) % count].b = s->points.slot[number];
    }
}

/* Lists the edges of all pieces of a node's loop, and counts what is wrong with them. Returns how
   many edges there are. */
static uint32_t list_loops(const structures *s, const sc_model *m, uint32_t n, sc_pair *edges,
                           uint32_t *wrong)
{
    const uint16_t *loop = sc_model_loop(m) + sc_model_node(m)[n].loop;
    uint32_t count = sc_model_node(m)[n].loop_length, pieces = loop[0], total = 0;
    if (!s->csf.in_pieces[n]) {
        list_loop(s, m, n, loop, count, edges);
        return count;
    }
    *wrong += pieces < 2;
    for (uint32_t p = 0; p < pieces; ++p) {
        uint32_t length = loop[1 + p];
        *wrong += length == 0;
        list_loop(s, m, n, loop + 1 + pieces + total, length, edges + total);
        total += length;
    }
    *wrong += 1 + pieces + total != count;
    return total;
}

/* The loop of each node has the edges of its segments, one leading to the next, piece by piece;
   there is one unless they are in many pieces, or long ones. */
static void check_loops(const structures *s, const sc_model *m)
{
    const sc_csf *csf = &s->csf;
    uint32_t most = 0, wrong = 0;
    sc_pair *loop, *edges;
    for (uint32_t n = 0; n < m->node_count; ++n)
        if (most < sc_model_node(m)[n].loop_length) most = sc_model_node(m)[n].loop_length;
    loop = (sc_pair *)test_allocate((most + 1) * sizeof(sc_pair));
    edges = (sc_pair *)test_allocate((most + 1) * sizeof(sc_pair));
    for (uint32_t n = 0; n < m->node_count; ++n) {
        uint32_t looped = sc_model_node(m)[n].loop_length, count = 0;
        uint32_t i = csf->contour_first[n] + (s->sctt.touch[n] == SC_NONE ? 0 : 2);
        sc_pair *end = edges;
        if (looped == 0) {
            wrong +=
                !csf->in_pieces[n] && csf->contour_first[n + 1] > i && s->sctt.touch[n] == SC_NONE;
            continue;
        }
        wrong += s->sctt.touch[n] != SC_NONE;
        looped = list_loops(s, m, n, loop, &wrong);
        for (uint32_t k = i; k < csf->contour_first[n + 1]; ++k)
            count += structures_count_edges(csf, csf->contours[k]);
        wrong += count != looped;
        if (count != looped) continue;
        for (; i < csf->contour_first[n + 1]; ++i)
            end = structures_flatten(csf, csf->contours[i], end);
        qsort(loop, looped, sizeof(sc_pair), structures_compare_pairs);
        qsort(edges, looped, sizeof(sc_pair), structures_compare_pairs);
        wrong += memcmp(loop, edges, looped * sizeof(sc_pair)) != 0;
    }
    CHECK_MSG(wrong == 0, "%s: loops of %" PRIu32 " nodes wrong", s->name, wrong);
    free(loop);
    free(edges);
}

void model_arrays_check(const structures *s, const structures_patches *p, const soup *mesh,
                        const sc_build_options *options)
{
    sc_mesh m = input_plain_mesh(mesh);
    sc_model *model = NULL;
    uint32_t *now = (uint32_t *)test_allocate(p->triangles * sizeof(uint32_t));
    uint32_t *before = (uint32_t *)test_allocate(p->triangles * sizeof(uint32_t));
    uint32_t l, i, k, n, wrong = 0;
    sc_model_info info;
    sc_level_info level;
    sc_build_options marked = *options;
    marked.struct_size = sizeof(marked);
    marked.rest = mesh->vertex_count % 2 ? SC_REST_MARKED : SC_REST_UNMARKED;
    if (!CHECK(sc_build(&m, &marked, &model) == SC_OK)) goto end;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    CHECK(info.edge_count == s->adjacency.edge_count && info.level_count == p->levels &&
          info.component_count == s->adjacency.component_count &&
          info.boundary_edges == s->adjacency.boundary_edges &&
          info.irregular_edges == s->adjacency.irregular_edges &&
          info.leaf_count == p->count[p->levels - 1] && info.node_count == s->sctt.node_count &&
          info.segment_count == s->csf.segment_count && info.point_count == s->points.point_count);
    for (l = 0; l < p->levels; ++l) {
        const uint32_t *patch = p->patch + l * p->triangles;
        uint32_t selves = 0, pairs = 0, self_marks[2] = {0, 0}, pair_marks[2] = {0, 0};
        memset(&level, 0, sizeof(level));
        level.struct_size = sizeof(level);
        CHECK(sc_model_get_level(model, l, &level) == SC_OK);
        CHECK(sc_model_get_patches(model, l, now, p->triangles) == SC_OK);
        for (i = 0; i < p->triangles; ++i) wrong += now[s->points.id[i]] != patch[i];
        for (i = 0; l > 0 && i < p->triangles; ++i) /* a patch of this level lies in one above */
            for (k = 0; k < i && k < 50; ++k) wrong += now[i] == now[k] && before[i] != before[k];
        for (n = s->sctt.level_first[l]; n < s->sctt.level_first[l + 1]; ++n) {
            int self = s->sctt.patches[n].a == s->sctt.patches[n].b;
            int flags = sc_model_node(model)[n].kind & (SC_NODE_REST_TURNED | SC_NODE_REST_CROSSED);
            *(self ? &selves : &pairs) += 1;
            if (marked.rest == SC_REST_UNMARKED) {
                wrong += flags != 0;
                continue;
            }
            (self ? self_marks : pair_marks)[0] += !(flags & SC_NODE_REST_TURNED);
            (self ? self_marks : pair_marks)[1] += flags == 0;
        }
        CHECK_MSG(level.patch_count == p->count[l] && level.self_nodes == selves &&
                      level.pair_nodes == pairs && level.self_oriented == self_marks[0] &&
                      level.self_culled == self_marks[1] && level.pair_oriented == pair_marks[0] &&
                      level.pair_culled == pair_marks[1],
                  "%s: level %" PRIu32, s->name, l);
        CHECK_MSG(level.connected_patches == count_connected(s, patch, p->count[l]),
                  "%s: level %" PRIu32 " has %" PRIu32 " connected patches", s->name, l,
                  level.connected_patches);
        memcpy(before, now, p->triangles * sizeof(uint32_t));
    }
    CHECK_MSG(wrong == 0, "%s: patches of the model are wrong", s->name);
    for (wrong = i = 0; i < p->triangles; ++i) { /* triangles in leaf order */
        uint32_t id = sc_model_triangle_id(model)[i], t = s->hierarchy.order[i];
        wrong += id != s->points.id[t];
        wrong += sc_model_edge_owned(model)[i] != s->adjacency.owned[t];
        for (k = 0; k < 3; ++k) {
            uint32_t v = mesh->triangles[3 * id + k];
            if (sc_model_vertex_use(model)[v] == SC_VERTEX_POINT)
                wrong += sc_model_triangle(model)[3 * i + k] != v;
        }
    }
    CHECK_MSG(wrong == 0, "%s: triangles of the model are wrong", s->name);
    check_box_children(s, model);
    check_loops(s, model);
    if (model->triangle_count < 120) check_around(s, model);
    check_fans(s, model);
    check_outlines(s, model);
    check_shared_chains(s, model);
    check_share_nodes(s, model);
end:
    sc_model_free(model);
    free(before);
    free(now);
}

static int has_crowd(const structures *s, uint32_t leaf)
{
    int found = 0;
    for (uint32_t i = 3 * s->xbvh.leaf_first[leaf]; i < 3 * s->xbvh.leaf_first[leaf + 1]; ++i) {
        uint32_t p = s->points.triangles[3 * s->hierarchy.order[i / 3] + i % 3];
        found |= s->adjacency.corner_first[p + 1] - s->adjacency.corner_first[p] > SC_SHARING_CROWD;
    }
    return found;
}

static int share_point(const structures *s, uint32_t t, uint32_t u)
{
    int found = 0;
    for (uint32_t i = 0; i < 9; ++i)
        found |= s->points.triangles[3 * t + i / 3] == s->points.triangles[3 * u + i % 3];
    return found;
}

/* The corner of triangle t that is shared and the one before not, of one or two; how many are in
   *count. */
static uint32_t first_shared(const structures *s, uint32_t t, uint32_t u, uint32_t *count)
{
    const uint32_t *a = s->points.triangles + 3 * t, *b = s->points.triangles + 3 * u;
    int shared[3];
    uint32_t first = 0;
    *count = 0;
    for (int k = 0; k < 3; ++k) {
        shared[k] = a[k] == b[0] || a[k] == b[1] || a[k] == b[2];
        *count += (uint32_t)shared[k];
    }
    for (uint32_t k = 0; k < 3; ++k)
        if (shared[k] && !shared[(k + 2) % 3]) first = k;
    return first;
}

/* The lists that are made of the masks. */
static void check_sharing_lists(structures *s, const sc_sharing *sharing)
{
    const uint32_t *first = s->xbvh.leaf_first, *order = s->hierarchy.order;
    uint32_t leaves = s->xbvh.leaf_count, entries = sharing->first[leaves], wrong = 0;
    uint32_t triangles = first[leaves];
    sc_sharing_parts parts;
    uint64_t words = sc_sharing_lists_count(sharing, &s->xbvh, NULL, &parts), at = 0;
    uint32_t *begin = (uint32_t *)test_allocate((entries + 1) * sizeof(uint32_t));
    uint32_t *corners = (uint32_t *)test_allocate(3 * (size_t)triangles * sizeof(uint32_t));
    uint16_t *list = (uint16_t *)test_allocate((size_t)words * sizeof(uint16_t));
    for (uint32_t i = 0; i < 3 * triangles; ++i)
        corners[i] = s->points.triangles[3 * order[i / 3] + i % 3];
    sc_sharing_lists_write(sharing, &s->xbvh, corners, NULL, &parts, begin, list);
    for (uint32_t a = 0; a < leaves; ++a)
        for (uint32_t i = sharing->first[a]; i < sharing->first[a + 1]; ++i) {
            const uint32_t b = sharing->leaf[i];
            const uint16_t *rows = sharing->rows + SC_LEAF_MAX * i, *run = list + begin[i];
            const uint16_t *pair = run + SC_SHARE_ROWS, *end = list + begin[i + 1];
            uint16_t seen[SC_LEAF_MAX] = {0};
            uint32_t number = 0, points = sc_share_points(run), edges = sc_share_edges(run), full;
            wrong += begin[i] != at;
            at = begin[i + 1];
            for (uint32_t t = 0; t < SC_LEAF_MAX; ++t) {
                wrong += (run[SC_SHARE_TRIANGLES] >> t & 1) != (rows[t] != 0);
                if (rows[t]) wrong += *pair++ != rows[t];
            }
            for (; pair < end; ++pair, ++number) {
                uint32_t t = *pair & 15, u = *pair >> 4 & 15, of_t, of_u, kind;
                uint32_t from_t = first_shared(s, order[first[a] + t], order[first[b] + u], &of_t);
                uint32_t from_u = first_shared(s, order[first[b] + u], order[first[a] + t], &of_u);
                kind = number >= points + edges ? 3 : number >= points ? 2 : 1;
                full = (of_t == 1 ? points : edges) == SC_SHARE_EDGE - 1;
                wrong +=
                    kind == 3 ? of_t == of_u && of_t < 3 && !full : of_t != kind || of_u != kind;
                wrong += kind < 3 && ((*pair >> 8 & 15) != from_t || *pair >> 12 != from_u);
                wrong += seen[t] >> u & 1;
                seen[t] |= (uint16_t)(1u << u);
            }
            wrong += memcmp(seen, rows, sizeof(seen)) != 0;
        }
    wrong += at + SC_SHARE_BEHIND != words;
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " lists of pairs that share points wrong", s->name, wrong);
    free(begin);
    free(corners);
    free(list);
}

/* Masks of triangles within a leaf cluster, as the model has them and unfolded: each with itself
   and lower ones is 0. */
static void check_own_rows(const structures *s, const sc_sharing *sharing)
{
    uint32_t wrong = 0;
    for (uint32_t leaf = 0; leaf < s->xbvh.leaf_count; ++leaf) {
        const uint16_t *rows = sharing->own_rows + SC_LEAF_MAX * leaf;
        uint16_t words[SC_OWN_WORDS], unfolded[SC_LEAF_MAX];
        sc_sharing_fold(rows, words);
        sc_sharing_unfold(words, unfolded);
        for (uint32_t i = 0; i < SC_LEAF_MAX; ++i)
            wrong += unfolded[i] != rows[i] || (rows[i] & ((2u << i) - 1)) != 0;
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " masks within leaf clusters are lost", s->name, wrong);
}

void model_arrays_check_sharing(structures *s)
{
    const uint32_t *first = s->xbvh.leaf_first, *order = s->hierarchy.order;
    uint32_t leaves = s->xbvh.leaf_count, wrong = 0, entry;
    sc_sharing sharing;
    if (!CHECK(sc_sharing_build(&s->points, &s->adjacency, order, &s->xbvh, &s->scratch,
                                &sharing) == SC_OK))
        return;
    for (uint32_t a = 0; a < leaves; ++a) {
        wrong += sharing.crowded[a] != has_crowd(s, a);
        for (entry = sharing.first[a]; entry < sharing.first[a + 1]; ++entry)
            wrong +=
                sharing.leaf[entry] <= (entry > sharing.first[a] ? sharing.leaf[entry - 1] : a);
        for (uint32_t b = a; b < leaves; ++b) {
            const uint16_t *rows = b == a ? sharing.own_rows + SC_LEAF_MAX * a : NULL;
            if (sharing.crowded[a] && sharing.crowded[b]) continue;
            for (entry = sharing.first[a]; entry < sharing.first[a + 1]; ++entry)
                if (sharing.leaf[entry] == b) rows = sharing.rows + SC_LEAF_MAX * entry;
            for (uint32_t i = first[a]; i < first[a + 1]; ++i)
                for (uint32_t j = a == b ? i + 1 : first[b]; j < first[b + 1]; ++j)
                    wrong += share_point(s, order[i], order[j]) !=
                             (rows != NULL && rows[i - first[a]] >> (j - first[b]) & 1);
        }
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " masks of shared points wrong", s->name, wrong);
    check_own_rows(s, &sharing);
    CHECK(sc_sharing_validate(&s->points, order, &s->xbvh, &sharing));
    check_sharing_lists(s, &sharing);
    if (sharing.first[leaves] > 0 && !sharing.crowded[0]) {
        sharing.rows[0] ^= 1;
        CHECK(!sc_sharing_validate(&s->points, order, &s->xbvh, &sharing));
    }
}
