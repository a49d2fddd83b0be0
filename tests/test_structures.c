/*
 * What sc_build makes, step by step, against counts made anew from the definitions: patches,
 * adjacency, the self-collision test tree (SCTT) and its children in the bounding-volume test tree
 * (BVTT), the contour segment forest (CSF), what the model reports. And validators, on sound
 * structures and on corrupted ones.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/locality.h"
#include "build/model_check.h"
#include "build/partition.h"
#include "build/sharing_lists.h"
#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour_metis.h"

/* The steps of sc_build. */
typedef struct steps {
    sc_scratch scratch;
    sc_points points;
    sc_adjacency adjacency;
    sc_hierarchy hierarchy;
    sc_xbvh xbvh;
    sc_neighbors neighbors;
    sc_sctt sctt;
    sc_csf csf;
    const char *name;
} steps;

static sc_status make_steps(steps *s, const soup *mesh, const sc_build_options *options)
{
    sc_mesh m = input_plain_mesh(mesh);
    const uint32_t *order;
    sc_status status;
    sc_allocator allocator = sc_memory_allocator(NULL);
    memset(s, 0, sizeof(*s));
    sc_scratch_init(&s->scratch, &allocator);
    status = sc_mesh_read(&m, options, &s->scratch, &s->points);
    if (!status &&
        (options->partition == SC_PARTITION_FAST || options->partition == SC_PARTITION_BISECT))
        status = sc_locality_sort(&s->points, SC_LOCALITY_Z, &s->scratch);
    if (!status) status = sc_adjacency_build(&s->points, &s->scratch, &s->adjacency);
    if (!status)
        status = sc_partition_build(&s->points, &s->adjacency, options, &s->scratch, &s->hierarchy);
    if (!status) status = sc_xbvh_build(&s->hierarchy, &s->scratch, &s->xbvh);
    order = s->hierarchy.order;
    if (!status)
        status = sc_neighbors_build(&s->points, &s->adjacency, order, &s->xbvh, &s->scratch,
                                    &s->neighbors);
    if (!status) status = sc_sctt_build(&s->xbvh, &s->neighbors, &s->scratch, &s->sctt);
    if (!status)
        status = sc_csf_build(&s->points, &s->adjacency, order, &s->xbvh, &s->sctt, &s->scratch,
                              &s->csf);
    return status;
}

static void free_steps(steps *s)
{
    sc_scratch_clear(&s->scratch);
}

static void *zeroed(size_t size)
{
    void *memory = test_allocate(size);
    memset(memory, 0, size);
    return memory;
}

/* ---- triangles, edges ---- */

typedef struct side {
    uint32_t low, high, half_edge;
} side;

static int compare_sides(const void *x, const void *y)
{
    const side *a = (const side *)x, *b = (const side *)y;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->half_edge < b->half_edge ? -1 : a->half_edge > b->half_edge;
}

static uint32_t end_of(const steps *s, uint32_t h)
{
    return s->points.triangles[h % 3 == 2 ? h - 2 : h + 1];
}

/* Edges, their owners and opposite half-edges, by sorting all half-edges. */
static void check_edges(const steps *s)
{
    uint32_t corners = 3 * s->points.triangle_count, n = 0, i, j, k;
    uint32_t edges = 0, boundary = 0, irregular = 0, wrong = 0;
    uint32_t *opposite = (uint32_t *)test_allocate(corners * sizeof(uint32_t));
    uint8_t *owned = (uint8_t *)zeroed(s->points.triangle_count);
    side *sides = (side *)test_allocate(corners * sizeof(side));
    for (i = 0; i < corners; ++i) {
        uint32_t a = s->points.triangles[i], b = end_of(s, i);
        opposite[i] = SC_NONE;
        if (a == b) continue;
        sides[n].low = a < b ? a : b;
        sides[n].high = a < b ? b : a;
        sides[n++].half_edge = i;
    }
    qsort(sides, n, sizeof(side), compare_sides);
    for (i = 0; i < n; i = j) {
        uint32_t forward = 0, owner = sides[i].half_edge;
        for (j = i; j < n && sides[j].low == sides[i].low && sides[j].high == sides[i].high; ++j) {
            uint32_t h = sides[j].half_edge;
            forward += s->points.triangles[h] == sides[i].low;
            if (s->points.id[h / 3] < s->points.id[owner / 3]) owner = h; /* in a triangle: first */
        }
        ++edges;
        owned[owner / 3] |= (uint8_t)(1 << owner % 3);
        boundary += j - i == 1;
        if (j - i == 2 && forward == 1) {
            opposite[sides[i].half_edge] = sides[i + 1].half_edge;
            opposite[sides[i + 1].half_edge] = sides[i].half_edge;
        } else if (j - i > 1) {
            ++irregular;
        }
    }
    for (i = 0; i < corners; ++i) wrong += opposite[i] != s->adjacency.opposite[i];
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " opposite half-edges wrong", s->name, wrong);
    for (wrong = i = 0; i < s->points.triangle_count; ++i)
        wrong += owned[i] != s->adjacency.owned[i];
    CHECK_MSG(wrong == 0, "%s: edges of %" PRIu32 " triangles wrongly owned", s->name, wrong);
    CHECK(edges == s->adjacency.edge_count && boundary == s->adjacency.boundary_edges &&
          irregular == s->adjacency.irregular_edges);
    for (wrong = i = 0; i < s->points.point_count; ++i)
        for (k = s->adjacency.corner_first[i]; k < s->adjacency.corner_first[i + 1]; ++k)
            wrong += s->points.triangles[s->adjacency.corners[k]] != i;
    CHECK(wrong == 0 && s->adjacency.corner_first[s->points.point_count] == corners);
    free(sides);
    free(owned);
    free(opposite);
}

/* Components that share points, by spreading the lowest triangle number. */
static void check_components(const steps *s)
{
    uint32_t count = s->points.triangle_count, t, k, changed = 1, components = 0;
    uint32_t *of_point = (uint32_t *)test_allocate(s->points.point_count * sizeof(uint32_t));
    uint32_t *of_triangle = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    for (t = 0; t < s->points.point_count; ++t) of_point[t] = SC_NONE;
    for (t = 0; t < count; ++t) of_triangle[t] = t;
    while (changed)
        for (changed = t = 0; t < count; ++t)
            for (k = 0; k < 3; ++k) {
                uint32_t *p = &of_point[s->points.triangles[3 * t + k]];
                changed += *p != of_triangle[t];
                if (*p > of_triangle[t]) *p = of_triangle[t];
                if (*p < of_triangle[t]) of_triangle[t] = *p;
            }
    for (t = 0; t < count; ++t) components += of_triangle[t] == t;
    CHECK_MSG(components == s->adjacency.component_count, "%s", s->name);
    free(of_triangle);
    free(of_point);
}

/* ---- patches ---- */

/* patch[level * triangle_count + t]: the patch of triangle t, counted from 0 at each level. Leaf
   clusters reached early are repeated. */
typedef struct patches {
    uint32_t levels, triangles;
    uint32_t *patch;
    uint32_t *count;   /* levels */
    uint8_t *finished; /* levels * triangles, by patch: a leaf cluster */
    uint32_t *parent;  /* levels * triangles, by patch */
} patches;

/* Different points of some triangles. */
static uint32_t count_points(const sc_hierarchy *h, uint32_t first, uint32_t count)
{
    uint32_t points = 0;
    for (uint32_t i = 0; i < 3 * count; ++i) {
        uint32_t point = h->corner[3 * h->order[first + i / 3] + i % 3], j = 0;
        while (h->corner[3 * h->order[first + j / 3] + j % 3] != point) ++j;
        points += i == j;
    }
    return points;
}

static void visit(const sc_hierarchy *h, uint32_t node, uint32_t level, patches *out)
{
    const sc_tree_node *n = &h->nodes[node];
    uint32_t l, i, leaf = n->left == SC_NONE;
    uint32_t last = leaf ? out->levels - 1 : level;
    for (l = level; l <= last; ++l) {
        for (i = n->first; i < n->first + n->count; ++i)
            out->patch[l * out->triangles + h->order[i]] = out->count[l];
        out->finished[l * out->triangles + out->count[l]] = (uint8_t)leaf;
        out->parent[l * out->triangles + out->count[l]] = l > 0 ? out->count[l - 1] - 1 : 0;
        ++out->count[l];
    }
    if (leaf) {
        CHECK(n->count >= 1 && n->count <= SC_LEAF_MAX);
        CHECK(count_points(h, n->first, n->count) <= SC_LEAF_POINTS);
        return;
    }
    visit(h, n->left, level + 1, out);
    visit(h, n->right, level + 1, out);
}

static patches find_patches(const steps *s)
{
    patches p;
    size_t size;
    p.levels = s->hierarchy.depth;
    p.triangles = s->points.triangle_count;
    size = (size_t)p.levels * p.triangles;
    p.patch = (uint32_t *)zeroed(size * sizeof(uint32_t));
    p.parent = (uint32_t *)zeroed(size * sizeof(uint32_t));
    p.finished = (uint8_t *)zeroed(size);
    p.count = (uint32_t *)zeroed(p.levels * sizeof(uint32_t));
    visit(&s->hierarchy, 0, 0, &p);
    return p;
}

static void free_patches(patches *p)
{
    free(p->patch);
    free(p->parent);
    free(p->finished);
    free(p->count);
}

static void check_xbvh(const steps *s, const patches *p)
{
    const sc_xbvh *x = &s->xbvh;
    uint32_t l, i, k, c, wrong = 0;
    if (!CHECK(x->level_count == p->levels && x->leaf_count == p->count[p->levels - 1])) return;
    for (l = 0; l < p->levels; ++l) {
        uint32_t first = x->level_first[l];
        if (!CHECK(sc_xbvh_patches(x, l) == p->count[l])) return;
        for (i = 0; i < p->count[l]; ++i) {
            for (k = x->leaf_first[x->leaf[first + i]]; k < x->leaf_first[x->leaf[first + i + 1]];
                 ++k)
                wrong += p->patch[l * p->triangles + s->hierarchy.order[k]] != i;
            wrong += sc_xbvh_is_leaf(x, first + i) != p->finished[l * p->triangles + i];
            if (l + 1 == p->levels) continue;
            for (c = x->child[first + i]; c < x->child[first + i + 1]; ++c)
                wrong += p->parent[(l + 1) * p->triangles + c - x->level_first[l + 1]] != i;
        }
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " patches, leaves or children wrong", s->name, wrong);
}

/* shared[a * count + b], a < b: how many points two patches of a level share, up to 2, and 0 if all
   of these are hubs; one that is no hub in which. */
static void find_shared(const steps *s, const patches *p, uint32_t level, uint8_t *shared,
                        uint32_t *which)
{
    uint32_t count = p->count[level], point, i, j, n;
    uint8_t *seen = (uint8_t *)test_allocate(count);
    uint32_t *met = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    memset(shared, 0, (size_t)count * count);
    for (int hubs = 0; hubs < 2; ++hubs)
        for (point = 0; point < s->points.point_count; ++point) {
            const uint32_t *first = s->adjacency.corner_first + point;
            memset(seen, 0, count);
            for (n = 0, i = first[0]; i < first[1]; ++i)
                seen[p->patch[level * p->triangles + s->adjacency.corners[i] / 3]] = 1;
            for (i = 0; i < count; ++i)
                if (seen[i]) met[n++] = i;
            if ((n > SC_NEIGHBORS_HUB) != hubs) continue;
            for (i = 0; i < n; ++i)
                for (j = i + 1; j < n; ++j) {
                    size_t at = (size_t)met[i] * count + met[j];
                    if (hubs ? shared[at] == 1 : shared[at] < 2) ++shared[at];
                    if (!hubs) which[at] = point;
                }
        }
    free(met);
    free(seen);
}

/* ---- the test tree ---- */

/* Whether a pair of children of a node's patches is left to boxes, and which two these are. */
static int is_for_boxes(const steps *s, uint32_t node, uint32_t bit, uint32_t *a, uint32_t *b)
{
    *a = s->xbvh.child[s->sctt.patches[node].a] + bit / 2;
    *b = s->xbvh.child[s->sctt.patches[node].b] + bit % 2;
    return s->sctt.pairs[node] >> (SC_PAIR_BOXES + bit) & 1;
}

/* Every adjacent pair of a level is one node, every other pair of children of a tested pair one
   BVTT child, all of them below the right parents. */
static void check_sctt(const steps *s, const patches *p)
{
    const sc_sctt *t = &s->sctt;
    size_t most = (size_t)p->count[p->levels - 1] * p->count[p->levels - 1];
    uint8_t *shared = (uint8_t *)test_allocate(most), *above = (uint8_t *)test_allocate(most);
    uint8_t *nodes = (uint8_t *)test_allocate(most), *boxes = (uint8_t *)test_allocate(most);
    uint32_t *which = (uint32_t *)test_allocate(most * sizeof(uint32_t));
    uint32_t l, n, i, k, wrong = 0, lost = 0;
    for (l = 0; l < p->levels; ++l) {
        uint32_t count = p->count[l], base = s->xbvh.level_first[l],
                 up = l > 0 ? p->count[l - 1] : 0;
        const uint32_t *parent = p->parent + l * p->triangles;
        const uint8_t *finished = p->finished + (l > 0 ? l - 1 : 0) * p->triangles;
        uint8_t *swap = above;
        above = shared;
        shared = swap;
        find_shared(s, p, l, shared, which);
        memset(nodes, 0, (size_t)count * count);
        memset(boxes, 0, (size_t)count * count);
        for (n = t->level_first[l]; n < t->level_first[l + 1]; ++n) {
            uint32_t a = t->patches[n].a - base, b = t->patches[n].b - base;
            size_t at = (size_t)a * count + b;
            if (!CHECK(a <= b && b < count)) goto end;
            ++nodes[at];
            wrong += t->touch[n] != (a != b && shared[at] == 1 ? which[at] : SC_NONE);
        }
        if (l > 0)
            for (n = t->level_first[l - 1]; n < t->level_first[l]; ++n) {
                uint32_t a = t->patches[n].a - s->xbvh.level_first[l - 1];
                uint32_t b = t->patches[n].b - s->xbvh.level_first[l - 1];
                for (k = t->child[n]; k < t->child[n + 1]; ++k)
                    wrong +=
                        parent[t->patches[k].a - base] != a || parent[t->patches[k].b - base] != b;
                for (k = 0; k < 4; ++k) {
                    uint32_t c, d;
                    if (!is_for_boxes(s, n, k, &c, &d)) continue;
                    c -= base;
                    d -= base;
                    if (!CHECK(c < d && d < count)) goto end;
                    wrong += parent[c] != a || parent[d] != b;
                    ++boxes[(size_t)c * count + d];
                }
            }
        for (i = 0; i < count; ++i)
            for (k = i; k < count; ++k) {
                size_t at = (size_t)i * count + k;
                uint32_t over = l > 0, node = 1;
                if (l > 0) { /* not below two leaf clusters, nor below patches that are apart */
                    size_t at_above = (size_t)parent[i] * up + parent[k];
                    over = !(finished[parent[i]] && finished[parent[k]]) &&
                           (parent[i] == parent[k] || above[at_above] > 0);
                    node = over && (i == k || shared[at] > 0);
                    over = over && !node;
                    /* sharing a point is inherited by parents, so nothing adjacent is left out */
                    lost += i != k && shared[at] > 0 && !node &&
                            !(finished[parent[i]] && finished[parent[k]]);
                }
                wrong += nodes[at] != node || boxes[at] != over;
            }
    }
    CHECK_MSG(wrong == 0 && lost == 0,
              "%s: %" PRIu32 " nodes wrong, %" PRIu32 " adjacent pairs lost", s->name, wrong, lost);
    CHECK(t->level_first[p->levels] == t->node_count && t->child[0] == 1);
end:
    free(shared);
    free(above);
    free(nodes);
    free(boxes);
    free(which);
}

/* Nodes of leaf clusters and everything below BVTT children: each pair of leaf clusters once. */
static void check_leaf_pairs(const steps *s)
{
    const sc_sctt *t = &s->sctt;
    const uint32_t *leaf = s->xbvh.leaf;
    size_t leaves = s->xbvh.leaf_count;
    uint8_t *reached = (uint8_t *)zeroed(leaves * leaves);
    uint32_t n, k, i, j, wrong = 0;
    for (n = 0; n < t->node_count; ++n) {
        uint32_t a = t->patches[n].a, b = t->patches[n].b;
        if (t->child[n] == t->child[n + 1] && sc_xbvh_is_leaf(&s->xbvh, a) &&
            sc_xbvh_is_leaf(&s->xbvh, b))
            ++reached[leaf[a] * leaves + leaf[b]];
        for (k = 0; k < 4; ++k)
            if (is_for_boxes(s, n, k, &a, &b))
                for (i = leaf[a]; i < leaf[a + 1]; ++i)
                    for (j = leaf[b]; j < leaf[b + 1]; ++j) ++reached[i * leaves + j];
    }
    for (i = 0; i < leaves; ++i)
        for (j = 0; j < leaves; ++j) wrong += reached[i * leaves + j] != (i <= j);
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " of %zu leaf clusters' pairs not reached once", s->name,
              wrong, leaves);
    free(reached);
}

/* ---- contours ---- */

static uint32_t count_edges(const sc_csf *csf, uint32_t segment)
{
    return csf->point_last[segment] - csf->point_first[segment];
}

/* Writes a segment's edges in order. */
static sc_pair *flatten(const sc_csf *csf, uint32_t segment, sc_pair *out)
{
    uint32_t i;
    for (i = csf->point_first[segment]; i < csf->point_last[segment]; ++i, ++out) {
        out->a = csf->points[i];
        out->b = csf->points[i + 1];
    }
    return out;
}

static int compare_pairs(const void *x, const void *y)
{
    const sc_pair *a = (const sc_pair *)x, *b = (const sc_pair *)y;
    if (a->a != b->a) return a->a < b->a ? -1 : 1;
    return a->b < b->b ? -1 : a->b > b->b;
}

/* Whether segments hold, as a multiset, the half-edges of the triangles with patch a or b that do
   not meet their opposite within these. */
static int is_contour(const steps *s, const uint32_t *patch, uint32_t a, uint32_t b,
                      const uint32_t *segments, uint32_t segment_count)
{
    uint32_t corners = 3 * s->points.triangle_count, h, expected = 0, found = 0, i;
    sc_pair *want = (sc_pair *)test_allocate(corners * sizeof(sc_pair)), *have, *end;
    int same;
    for (h = 0; h < corners; ++h) {
        uint32_t o = s->adjacency.opposite[h], p = patch[h / 3];
        if (p != a && p != b) continue;
        if (o != SC_NONE && (patch[o / 3] == a || patch[o / 3] == b)) continue;
        want[expected].a = s->points.triangles[h];
        want[expected++].b = end_of(s, h);
    }
    for (i = 0; i < segment_count; ++i) found += count_edges(&s->csf, segments[i]);
    have = end = (sc_pair *)test_allocate(found * sizeof(sc_pair));
    for (i = 0; i < segment_count; ++i) end = flatten(&s->csf, segments[i], end);
    if (expected) qsort(want, expected, sizeof(sc_pair), compare_pairs);
    if (found) qsort(have, found, sizeof(sc_pair), compare_pairs);
    same = found == expected && memcmp(have, want, found * sizeof(sc_pair)) == 0;
    free(have);
    free(want);
    return same;
}

/* Whether each segment leads into the one after it, or into none of those that come later. */
static int is_chained(const sc_csf *csf, const uint32_t *segments, uint32_t count)
{
    for (uint32_t i = 0; i + 1 < count; ++i) {
        uint32_t end = csf->points[csf->point_last[segments[i]]], k;
        if (end == csf->points[csf->point_first[segments[i + 1]]]) continue;
        for (k = i + 2; k < count; ++k)
            if (end == csf->points[csf->point_first[segments[k]]]) return 0;
    }
    return 1;
}

static void check_contours(const steps *s, const patches *p)
{
    const sc_csf *csf = &s->csf;
    uint32_t l, n, wrong = 0, i, gaps = 0;
    for (l = 0; l < p->levels; ++l) {
        const uint32_t *patch = p->patch + l * p->triangles;
        for (n = s->sctt.level_first[l]; n < s->sctt.level_first[l + 1]; ++n) {
            const uint32_t *list = csf->contours + csf->contour_first[n];
            uint32_t count = csf->contour_first[n + 1] - csf->contour_first[n];
            uint32_t a = s->sctt.patches[n].a - s->xbvh.level_first[l];
            uint32_t b = s->sctt.patches[n].b - s->xbvh.level_first[l];
            if (s->sctt.touch[n] == SC_NONE) {
                wrong += !is_contour(s, patch, a, b, list, count) || !is_chained(csf, list, count);
            } else {
                wrong += list[0] != s->sctt.touch[n];
                wrong += !is_contour(s, patch, a, a, list + 2, list[1]);
                wrong += !is_contour(s, patch, b, b, list + 2 + list[1], count - 2 - list[1]);
                wrong += !is_chained(csf, list + 2, list[1]);
                wrong += !is_chained(csf, list + 2 + list[1], count - 2 - list[1]);
            }
        }
    }
    CHECK_MSG(wrong == 0, "%s: contours of %" PRIu32 " nodes wrong", s->name, wrong);
    for (i = 0; i < csf->segment_count; ++i) { /* one half-edge leads to the next */
        uint32_t edges = count_edges(csf, i), e;
        sc_pair *list = (sc_pair *)test_allocate(edges * sizeof(sc_pair));
        gaps += flatten(csf, i, list) != list + edges || edges == 0;
        for (e = 0; e + 1 < edges; ++e) gaps += list[e].b != list[e + 1].a;
        free(list);
    }
    CHECK_MSG(gaps == 0, "%s: %" PRIu32 " gaps within segments", s->name, gaps);
}

/* ---- the model ---- */

/* Patches connected through edges, by spreading the lowest number. */
static uint32_t count_connected(const steps *s, const uint32_t *patch, uint32_t patch_count)
{
    uint32_t count = s->points.triangle_count, h, i, changed = 1, connected = 0;
    uint32_t *lowest = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    uint32_t *parts = (uint32_t *)zeroed(patch_count * sizeof(uint32_t));
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
static void check_hops(const steps *s, const sc_model *model)
{
    const uint32_t *hop = sc_model_hop(model), *leaf = sc_model_leaf(model);
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
static void check_around(const steps *s, const sc_model *model)
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

static void check_fans(const steps *s, const sc_model *model)
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

/* Outlines of leaf clusters: each edge that no opposite one makes up for once, in a circle, if
   there is one that comes to no point twice; or in two. */
static void check_outlines(const steps *s, const sc_model *model)
{
    uint32_t leaf, h, i, wrong = 0;
    for (leaf = 0; leaf < model->leaf_count; ++leaf) {
        const uint32_t *point = sc_model_leaf_point(model) + SC_LEAF_POINTS * leaf;
        const uint8_t *outline = sc_model_leaf_outline(model) + SC_LEAF_POINTS * leaf;
        uint32_t last = outline[SC_LEAF_POINTS - 1], edge[3 * SC_LEAF_MAX][2], found = 0;
        uint32_t edges = list_outline(model, leaf, edge),
                 chain = edges ? sort_chain(edge, edges) : 0;
        uint32_t second = chain < edges ? sort_chain(edge + chain, edges - chain) : 0;
        uint32_t count = last < SC_LEAF_POINTS ? SC_LEAF_POINTS : last - SC_LEAF_POINTS;
        if (last & SC_OUTLINE_TWO) {
            uint32_t of_first = ~0u;
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
            continue;
        }
        for (i = 0; i < count; ++i) {
            uint32_t from = point[outline[i]], to = point[outline[i + 1 < count ? i + 1 : 0]];
            for (h = 0; h < edges; ++h) found += edge[h][0] == from && edge[h][1] == to;
        }
        wrong += edges && chain == edges ? found != edges || count != edges : count != 0;
        wrong += second && chain + second == edges;
    }
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " outlines of leaf clusters wrong", s->name, wrong);
}

/* Leaf clusters that share a whole chain of an outline of two. */
static void check_shared_chains(const steps *s, const sc_model *model)
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
            if (expected) { /* opposite edges of some chain of either: all of both, and no other shared point */
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
static void check_share_nodes(const steps *s, const sc_model *model)
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
static void list_loop(const steps *s, const sc_model *m, uint32_t n, const uint16_t *loop,
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
static uint32_t list_loops(const steps *s, const sc_model *m, uint32_t n, sc_pair *edges,
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
static void check_loops(const steps *s, const sc_model *m)
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
            count += count_edges(csf, csf->contours[k]);
        wrong += count != looped;
        if (count != looped) continue;
        for (; i < csf->contour_first[n + 1]; ++i) end = flatten(csf, csf->contours[i], end);
        qsort(loop, looped, sizeof(sc_pair), compare_pairs);
        qsort(edges, looped, sizeof(sc_pair), compare_pairs);
        wrong += memcmp(loop, edges, looped * sizeof(sc_pair)) != 0;
    }
    CHECK_MSG(wrong == 0, "%s: loops of %" PRIu32 " nodes wrong", s->name, wrong);
    free(loop);
    free(edges);
}

static void check_model(const steps *s, const patches *p, const soup *mesh,
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
    check_hops(s, model);
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

/* ---- shared points ---- */

static int has_crowd(const steps *s, uint32_t leaf)
{
    int found = 0;
    for (uint32_t i = 3 * s->xbvh.leaf_first[leaf]; i < 3 * s->xbvh.leaf_first[leaf + 1]; ++i) {
        uint32_t p = s->points.triangles[3 * s->hierarchy.order[i / 3] + i % 3];
        found |= s->adjacency.corner_first[p + 1] - s->adjacency.corner_first[p] > SC_SHARING_CROWD;
    }
    return found;
}

static int share_point(const steps *s, uint32_t t, uint32_t u)
{
    int found = 0;
    for (uint32_t i = 0; i < 9; ++i)
        found |= s->points.triangles[3 * t + i / 3] == s->points.triangles[3 * u + i % 3];
    return found;
}

/* The corner of triangle t that is shared and the one before not, of one or two; how many are in
   *count. */
static uint32_t first_shared(const steps *s, uint32_t t, uint32_t u, uint32_t *count)
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
static void check_sharing_lists(steps *s, const sc_sharing *sharing)
{
    const uint32_t *first = s->xbvh.leaf_first, *order = s->hierarchy.order;
    uint32_t leaves = s->xbvh.leaf_count, entries = sharing->first[leaves], wrong = 0;
    uint32_t triangles = first[leaves];
    uint64_t words = sc_sharing_lists_count(sharing, &s->xbvh), at = 0;
    uint32_t *begin = (uint32_t *)test_allocate((entries + 1) * sizeof(uint32_t));
    uint32_t *corners = (uint32_t *)test_allocate(3 * (size_t)triangles * sizeof(uint32_t));
    uint16_t *list = (uint16_t *)test_allocate((size_t)words * sizeof(uint16_t));
    for (uint32_t i = 0; i < 3 * triangles; ++i)
        corners[i] = s->points.triangles[3 * order[i / 3] + i % 3];
    sc_sharing_lists_write(sharing, &s->xbvh, corners, begin, list);
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
static void check_own_rows(const steps *s, const sc_sharing *sharing)
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

/* The masks of all pairs of leaf clusters that are not both crowded, and the validator on them. */
static void check_sharing(steps *s)
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

/* ---- all of it ---- */

static void check_all(const char *name, const soup *mesh, const sc_build_options *options)
{
    steps s;
    uint64_t state = test_random_state();
    sc_status status = make_steps(&s, mesh, options);
    s.name = name;
    if (CHECK_MSG(status == SC_OK, "%s: status %d", name, (int)status)) {
        patches p = find_patches(&s);
        CHECK_MSG(sc_hierarchy_validate(&s.hierarchy, &s.scratch) == 1, "%s", name);
        CHECK_MSG(sc_xbvh_validate(&s.xbvh) == 1, "%s", name);
        CHECK_MSG(sc_sctt_validate(&s.xbvh, &s.neighbors, &s.sctt) == 1, "%s", name);
        CHECK_MSG(sc_csf_validate(&s.csf, &s.sctt, &s.scratch) == 1, "%s", name);
        check_edges(&s);
        check_components(&s);
        check_xbvh(&s, &p);
        check_sctt(&s, &p);
        check_leaf_pairs(&s);
        check_contours(&s, &p);
        if (p.triangles < 500) check_sharing(&s);
        test_random_reset(state); /* a bisection may be random */
        check_model(&s, &p, mesh, options);
        free_patches(&p);
    }
    free_steps(&s);
}

/* A caller's tree that is a chain: one triangle leaves at each of 59 nodes, the rest is the
   last. */
static void check_chain(const char *name, const soup *mesh, int to_the_left)
{
    uint32_t count = mesh->triangle_count, inner = count - 1 < 59 ? count - 1 : 59, i;
    uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    sc_tree_node *tree = (sc_tree_node *)zeroed((2 * (size_t)inner + 1) * sizeof(sc_tree_node));
    sc_build_options options;
    for (i = 0; i < count; ++i) order[i] = i;
    for (i = 0; i < inner; ++i) { /* node 2 i is inner, 2 i + 1 a leaf */
        tree[2 * i].left = to_the_left ? 2 * i + 2 : 2 * i + 1;
        tree[2 * i].right = to_the_left ? 2 * i + 1 : 2 * i + 2;
        tree[2 * i + 1].left = tree[2 * i + 1].right = SC_NONE;
        tree[2 * i + 1].first = i;
        tree[2 * i + 1].count = 1;
    }
    tree[2 * inner].left = tree[2 * inner].right = SC_NONE;
    tree[2 * inner].first = inner;
    tree[2 * inner].count = count - inner;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = 2 * inner + 1;
    /* below the chain at most 4 more levels: the mesh must be small */
    check_all(name, mesh, &options);
    free(tree);
    free(order);
}

static void check_every_partition(const char *name, const soup *mesh)
{
    sc_build_options options;
    for (uint32_t partition = SC_PARTITION_FAST; partition <= SC_PARTITION_BISECT; ++partition) {
        input_choices c = input_choose(mesh, test_random_below(3), partition);
        check_all(name, mesh, &c.options);
        input_free_choices(&c);
    }
    check_chain(name, mesh, (int)test_random_below(2));
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_BISECT;
    options.bisect = sc_metis_bisect;
#ifdef SC_WITH_METIS
    check_all(name, mesh, &options);
#else
    if (mesh->triangle_count > SC_LEAF_MAX && mesh->triangle_count < 20) {
        sc_mesh m = input_plain_mesh(mesh);
        sc_model *model = NULL;
        sc_status status = sc_build(&m, &options, &model);
        CHECK(status == SC_ERROR_UNSUPPORTED || status == SC_OK); /* OK: nothing had to be cut */
        sc_model_free(model);
    }
#endif
}

static void named_meshes(void)
{
    soup s;
#define ON(name, make)                                                                             \
  s = make;                                                                                        \
  check_every_partition(name, &s);                                                                 \
  soup_free(&s)
    ON("one triangle", soup_many(0 + 1));
    ON("two triangles", soup_cloth(1, 1));
    ON("a leaf", soup_cloth(1, 4));
    ON("just more than a leaf", soup_pinched(2));
    ON("cloth", soup_cloth(9, 11));
    ON("long cloth", soup_cloth(1, 60));
    ON("annulus", soup_annulus(20, 4));
    ON("tube", soup_tube(12, 9));
    ON("thin tube", soup_tube(8, 30));
    ON("sphere", soup_sphere(12, 10));
    ON("moebius", soup_moebius(30, 3));
    ON("pinched", soup_pinched(6));
    ON("fins", soup_fins(20));
    ON("fan of sheets", shape_fan_of_sheets(20));
    ON("many", soup_many(30));
    ON("slivers", soup_slivers(150));
    ON("seams", soup_seams(8));
    ON("spiral", shape_spiral(40, 3, 1.6, 0));
    ON("body", shape_body(12, 12));
    ON("broken cloth", shape_broken_cloth(9));
    ON("grid soup", soup_on_grid(2));
    ON("scattered", soup_scattered());
#undef ON
}

/* Points at which more patches meet than are called adjacent. */
static void hubs(void)
{
    soup s = shape_hub(600);
    uint32_t partition, hubs_met = 0;
    for (partition = SC_PARTITION_FAST; partition <= SC_PARTITION_BISECT; ++partition) {
        input_choices c = input_choose(&s, SC_WELD_REST, partition);
        steps made;
        check_all("hub", &s, &c.options);
        if (CHECK(make_steps(&made, &s, &c.options) == SC_OK)) {
            patches p = find_patches(&made);
            const uint32_t *patch = p.patch + (p.levels - 1) * p.triangles;
            uint8_t *seen = (uint8_t *)zeroed(p.count[p.levels - 1]);
            uint32_t i, n = 0;
            for (i = 0; i < p.triangles; ++i) {
                const uint32_t *v = made.points.triangles + 3 * i, hub = made.points.slot[0];
                if (v[0] != hub && v[1] != hub && v[2] != hub) continue;
                n += !seen[patch[i]];
                seen[patch[i]] = 1;
            }
            hubs_met += n > SC_NEIGHBORS_HUB;
            free(seen);
            free_patches(&p);
        }
        free_steps(&made);
        input_free_choices(&c);
    }
    CHECK(hubs_met == 4);
    soup_free(&s);
}

/* More pairs of leaf clusters' triangles that share one point, or two, than a list tells. */
static void copies(void)
{
    for (uint32_t shared = 1; shared <= 2; ++shared) {
        soup s = shape_copies(shared);
        sc_mesh m = input_plain_mesh(&s);
        sc_model *model = NULL;
        const uint16_t *run;
        check_every_partition("copies", &s);
        if (CHECK(sc_build(&m, NULL, &model) == SC_OK && model->share_count == 1)) {
            run = sc_model_share_list(model);
            CHECK(sc_share_points(run) == (shared == 1 ? 255 : 0));
            CHECK(sc_share_edges(run) == (shared == 2 ? 255 : 0));
            CHECK(sc_model_share_begin(model)[1] ==
                  SC_SHARE_ROWS + SC_LEAF_MAX * (SC_LEAF_MAX + 1));
        }
        sc_model_free(model);
        soup_free(&s);
    }
}

/* What cuts cost along the edges of a mesh, as the caller's function is told first. */
typedef struct costs {
    uint32_t arcs, lowest; /* how many, and of how many the cost is least */
    int32_t least, most;
} costs;

static sc_status note_costs(void *user, const sc_dual_graph *graph, uint32_t left_target,
                            uint8_t *sides)
{
    costs *c = (costs *)user;
    if (c->arcs == 0) {
        c->arcs = (uint32_t)graph->offsets[graph->node_count];
        c->least = c->most = graph->weights[0];
        for (uint32_t i = 0; i < c->arcs; ++i) {
            if (graph->weights[i] < c->least) c->lowest = 0;
            if (graph->weights[i] < c->least) c->least = graph->weights[i];
            if (graph->weights[i] > c->most) c->most = graph->weights[i];
            c->lowest += graph->weights[i] == c->least;
        }
    }
    return input_bisect(NULL, graph, left_target, sides);
}

/* A cloth folded by no, a right, and two right angles, at any scale: at the crease a cut costs
   half, and a third. */
static void creases(void)
{
    enum { SIDE = 8 };
    static const double sizes[] = {1, 0x1p+1000, 0x1p-1000};
    for (int size = 0; size < 3; ++size) {
        costs found[3];
        for (int fold = 0; fold < 3; ++fold) {
            soup mesh = soup_cloth(SIDE, SIDE);
            sc_build_options options;
            sc_model *model = NULL;
            for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
                double *p = mesh.positions + 3 * v, over = p[0] - 0.5;
                if (fold == 0 || over < 0) continue;
                p[0] = fold == 1 ? 0.5 : 0.5 - over;
                if (fold == 1) p[2] = over;
            }
            soup_scale(mesh.positions, mesh.vertex_count, sizes[size]);
            memset(&options, 0, sizeof(options));
            memset(&found[fold], 0, sizeof(found[fold]));
            options.struct_size = sizeof(options);
            options.partition = SC_PARTITION_BISECT;
            options.weld = SC_WELD_NONE;
            options.bisect = note_costs;
            options.bisect_user = &found[fold];
            sc_mesh m = input_plain_mesh(&mesh);
            CHECK(sc_build(&m, &options, &model) == SC_OK);
            sc_model_free(model);
            soup_free(&mesh);
        }
        CHECK(found[0].arcs == 2 * (3 * SIDE * SIDE - 2 * SIDE));
        CHECK(found[0].lowest == 4 * SIDE * (SIDE - 1)); /* all but diagonals */
        CHECK(found[0].least > 70 && found[0].least < 100 && found[0].most > 100);
        for (int fold = 1; fold < 3; ++fold) {
            CHECK(found[fold].arcs == found[0].arcs && found[fold].lowest == 2 * SIDE);
            CHECK(found[fold].most == found[0].most);
            CHECK_MSG(found[fold].least == found[0].least / (fold + 1), "%d of %d",
                      (int)found[fold].least, (int)found[0].least);
        }
    }
}

/* A point of a flat cloth's rim is pulled away: what an edge costs ends at 1000, and at 1. */
static void edges_of_all_lengths(void)
{
    soup mesh = soup_cloth(8, 8);
    sc_build_options options;
    sc_model *model = NULL;
    costs found;
    uint32_t v = 0;
    while (!(mesh.positions[3 * v + 1] == 0 && mesh.positions[3 * v] == 0.5)) ++v;
    mesh.positions[3 * v + 1] = -1e6;
    memset(&options, 0, sizeof(options));
    memset(&found, 0, sizeof(found));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_BISECT;
    options.weld = SC_WELD_NONE;
    options.bisect = note_costs;
    options.bisect_user = &found;
    sc_mesh m = input_plain_mesh(&mesh);
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    CHECK(found.most == 1000 && found.least == 1);
    sc_model_free(model);
    soup_free(&mesh);
}

/* How many leaf clusters a mesh gets. Of every so many triangles of it in turn: how many such parts
   are divided between clusters, and how many clusters have triangles of several. */
static uint32_t count_clusters(const soup *mesh, uint32_t partition, uint32_t together,
                               uint32_t *divided, uint32_t *mixed)
{
    input_choices c = input_choose(mesh, SC_WELD_NONE, partition);
    steps made;
    uint32_t i, leaves = 0;
    *divided = *mixed = 0;
    if (CHECK(make_steps(&made, mesh, &c.options) == SC_OK)) {
        patches p = find_patches(&made);
        const uint32_t *patch = p.patch + (p.levels - 1) * p.triangles;
        uint32_t *cluster_of = (uint32_t *)test_allocate(p.triangles * sizeof(uint32_t));
        uint8_t *is_divided = (uint8_t *)zeroed(p.triangles), *is_mixed;
        uint32_t *part_of = (uint32_t *)test_allocate(p.triangles * sizeof(uint32_t));
        is_mixed = (uint8_t *)zeroed(p.triangles);
        memset(cluster_of, 0xff, p.triangles * sizeof(uint32_t));
        memset(part_of, 0xff, p.triangles * sizeof(uint32_t));
        leaves = p.count[p.levels - 1];
        for (i = 0; i < p.triangles; ++i) {
            uint32_t part = made.points.id[i] / together, cluster = patch[i];
            if (cluster_of[part] == SC_NONE) cluster_of[part] = cluster;
            if (part_of[cluster] == SC_NONE) part_of[cluster] = part;
            is_divided[part] |= cluster_of[part] != cluster;
            is_mixed[cluster] |= part_of[cluster] != part;
        }
        for (i = 0; i < p.triangles; ++i) {
            *divided += is_divided[i];
            *mixed += is_mixed[i];
        }
        free(part_of);
        free(cluster_of);
        free(is_mixed);
        free(is_divided);
        free_patches(&p);
    }
    free_steps(&made);
    input_free_choices(&c);
    return leaves;
}

/* Thin tubes become whole rings, as many as fit into a leaf cluster, at any scale and by any cut.
   Of five sides, one and a half do. */
static void slices(void)
{
    enum { ALONG = 60 };
    static const double sizes[] = {1, 0x1p+1000, 0x1p-1000};
    uint32_t sides, partition, divided, mixed, leaves, size;
    for (sides = 3; sides <= 8; ++sides) {
        uint32_t most = 1 + (sides < 5 ? ALONG / 2 : sides == 5 ? 2 * ALONG / 3 : ALONG);
        for (partition = SC_PARTITION_FAST; partition <= SC_PARTITION_BISECT;
             partition += SC_PARTITION_BISECT) {
            for (size = 0; size < 3; ++size) {
                soup tube = soup_tube(sides, ALONG);
                soup_scale(tube.positions, tube.vertex_count, sizes[size]);
                leaves = count_clusters(&tube, partition, 2 * sides, &divided, &mixed);
                CHECK_MSG((divided == 0 || sides == 5) && leaves <= most,
                          "%" PRIu32 " sides: %" PRIu32 " rings divided, %" PRIu32 " clusters",
                          sides, divided, leaves);
                soup_free(&tube);
            }
        }
    }
}

/* A strand like a U: a plane across it meets both legs, in triangles that would fit into one leaf
   cluster. */
static void two_legs(void)
{
    enum { ALONG = 128 };
    soup strand = soup_tube(3, ALONG);
    uint32_t v, divided, mixed;
    for (v = 0; v < strand.vertex_count; ++v) {
        double *p = strand.positions + 3 * (size_t)v;
        if (p[0] > 0.5) p[1] = 1 - p[1];
        p[0] = 8 * fabs(p[0] - 0.5);
    }
    (void)count_clusters(&strand, SC_PARTITION_FAST, 6 * ALONG / 2, &divided, &mixed);
    CHECK_MSG(mixed <= 1, "%" PRIu32 " clusters on both legs", mixed);
    soup_free(&strand);
}

static void random_meshes(void)
{
    for (uint32_t i = 0; i < test_iterations(60); ++i) {
        const char *name = "soup";
        soup s = i % 4 == 0 ? soup_on_grid(1 + i % 3) : shape_any(40 + 4 * i, &name);
        input_choices c = input_choose(&s, test_random_below(3), test_random_below(4));
        check_all(name, &s, &c.options);
        input_free_choices(&c);
        soup_free(&s);
    }
}

/* ---- validators ---- */

/* Changes *at for a moment. */
static int is_noticed(const steps *s, int which, uint32_t *at, uint32_t value)
{
    uint32_t old = *at;
    sc_scratch scratch = s->scratch;
    int found;
    scratch.blocks = NULL;
    *at = value;
    switch (which) {
    case 0:
        found = !sc_hierarchy_validate(&s->hierarchy, &scratch);
        break;
    case 1:
        found = !sc_xbvh_validate(&s->xbvh);
        break;
    case 2:
        found = !sc_sctt_validate(&s->xbvh, &s->neighbors, &s->sctt);
        break;
    default:
        found = !sc_csf_validate(&s->csf, &s->sctt, &scratch);
        break;
    }
    *at = old;
    sc_scratch_clear(&scratch);
    return found;
}

static void validators(void)
{
    soup mesh = soup_cloth(9, 9);
    sc_build_options options;
    steps s;
    uint32_t i, n, inner = 0, leaf = 0, middle, *order;
    memset(&options, 0, sizeof(options));
    if (!CHECK(make_steps(&s, &mesh, &options) == SC_OK)) return;
    order = s.hierarchy.order;
    while (s.hierarchy.nodes[leaf].left != SC_NONE) ++leaf;
    /* the tree: an order that is no permutation; children before parents, out of range, lost;
       wrong, empty and too large leaves; a wrong number of them */
    CHECK(is_noticed(&s, 0, &order[3], order[4]));
    CHECK(is_noticed(&s, 0, &order[3], mesh.triangle_count));
    CHECK(is_noticed(&s, 0, &s.hierarchy.nodes[0].left, 0));
    CHECK(is_noticed(&s, 0, &s.hierarchy.nodes[0].left, s.hierarchy.node_count));
    CHECK(is_noticed(&s, 0, &s.hierarchy.nodes[0].right, 1));
    CHECK(is_noticed(&s, 0, &s.hierarchy.nodes[leaf].first, s.hierarchy.nodes[leaf].first + 1));
    CHECK(is_noticed(&s, 0, &s.hierarchy.nodes[leaf].count, 0));
    CHECK(is_noticed(&s, 0, &s.hierarchy.nodes[leaf].count, SC_LEAF_MAX + 1));
    CHECK(is_noticed(&s, 0, &s.hierarchy.leaf_count, s.hierarchy.leaf_count + 1));
    /* patches: levels that do not start where they should, children and leaves off by one */
    middle = s.xbvh.level_first[2];
    CHECK(is_noticed(&s, 1, &s.xbvh.level_first[0], 1));
    CHECK(is_noticed(&s, 1, &s.xbvh.level_first[2], middle - 1));
    CHECK(is_noticed(&s, 1, &s.xbvh.patch_end, s.xbvh.patch_end - 1));
    CHECK(is_noticed(&s, 1, &s.xbvh.leaf_count, s.xbvh.leaf_count - 1));
    for (i = 0; i < s.xbvh.level_first[s.xbvh.level_count - 1]; ++i) {
        CHECK_MSG(is_noticed(&s, 1, &s.xbvh.child[i], s.xbvh.child[i] + 1), "child %" PRIu32, i);
        CHECK_MSG(is_noticed(&s, 1, &s.xbvh.leaf[i], s.xbvh.leaf[i] + 1), "leaf %" PRIu32, i);
    }
    /* tests: any patch of any node, any child range, any BVTT child; a pair lost from the
       neighbors */
    for (n = 0; n < s.sctt.node_count; ++n) {
        CHECK_MSG(is_noticed(&s, 2, &s.sctt.patches[n].a, s.sctt.patches[n].a + 1), "node %" PRIu32,
                  n);
        CHECK_MSG(is_noticed(&s, 2, &s.sctt.patches[n].b, s.sctt.patches[n].b + 1), "node %" PRIu32,
                  n);
        CHECK_MSG(is_noticed(&s, 2, &s.sctt.child[n + 1], s.sctt.child[n + 1] - 1), "node %" PRIu32,
                  n);
        for (i = 0; i < 8; ++i)
            CHECK_MSG(is_noticed(&s, 2, &s.sctt.pairs[n], s.sctt.pairs[n] ^ 1u << i),
                      "node %" PRIu32, n);
        if (s.sctt.child[n] != s.sctt.child[n + 1]) inner = n;
    }
    i = s.sctt.patches[s.sctt.child[inner + 1] - 1].a;
    CHECK(s.neighbors.count[i] > 0 && is_noticed(&s, 2, &s.neighbors.count[i], 0));
    /* segments: a point too few, a child before or twice, a gap between children, a contour of what
       is no segment */
    for (i = 0; i < s.csf.segment_count; i += 7) {
        CHECK(is_noticed(&s, 3, &s.csf.point_last[i], s.csf.point_first[i]));
        CHECK(is_noticed(&s, 3, &s.csf.point_last[i], s.csf.point_count));
    }
    CHECK(s.csf.segment_count > s.csf.leaf_count);
    for (i = s.csf.leaf_count; i < s.csf.segment_count; ++i) {
        uint32_t *first = s.csf.child_first + (i - s.csf.leaf_count);
        CHECK(is_noticed(&s, 3, &first[1], first[0] + 1));
        uint32_t second = s.csf.children[first[0] + 1];
        CHECK(is_noticed(&s, 3, &s.csf.point_first[second], s.csf.point_first[second] - 1));
        CHECK(s.csf.point_last[i] + 1 == s.csf.point_count ||
              is_noticed(&s, 3, &s.csf.point_last[i], s.csf.point_last[i] + 1));
        CHECK(is_noticed(&s, 3, &s.csf.children[first[0]], i));
        CHECK(is_noticed(&s, 3, &s.csf.children[first[0]], s.csf.children[first[0] + 1]));
    }
    for (n = 0; n < s.sctt.node_count; ++n) {
        i = s.csf.contour_first[n] + (s.sctt.touch[n] == SC_NONE ? 0 : 2);
        CHECK(i >= s.csf.contour_first[n + 1] ||
              is_noticed(&s, 3, &s.csf.contours[i], s.csf.segment_count));
    }
    CHECK(is_noticed(&s, 3, &s.csf.contour_first[0], s.csf.contour_first[1] + 1));
    free_steps(&s);
    soup_free(&mesh);
}

/* How far apart the first corners of consecutive triangles are, on average. */
static double mean_step(const sc_points *points)
{
    double sum = 0;
    for (uint32_t t = 1; t < points->triangle_count; ++t)
        for (int k = 0; k < 3; ++k)
            sum += fabs(points->rest[3 * points->triangles[3 * t] + (uint32_t)k] -
                        points->rest[3 * points->triangles[3 * t - 3] + (uint32_t)k]);
    return sum / points->triangle_count;
}

/* Whether each triangle is still the caller's triangle of its number, in place and in numbers. */
static int is_renumbered(const sc_points *points, const soup *mesh)
{
    uint8_t *seen = (uint8_t *)zeroed(points->triangle_count);
    uint32_t wrong = 0, t, k, next = 0;
    for (t = 0; t < points->triangle_count; ++t)
        for (k = 0; k < 3; ++k) {
            uint32_t p = points->triangles[3 * t + k], v;
            if (k == 0 && (points->id[t] >= points->triangle_count || seen[points->id[t]]++)) {
                ++wrong;
                break;
            }
            v = mesh->triangles[3 * points->id[t] + k];
            wrong += points->slot[v] != p || p > next;
            wrong += memcmp(points->rest + 3 * p, mesh->positions + 3 * v, 24) != 0;
            next += p == next;
        }
    free(seen);
    return wrong == 0 && next == points->point_count;
}

static void locality(void)
{
    static const double sizes[] = {1, 1e300, 5e-324, 0};
    static const int curves[] = {SC_LOCALITY_Z, SC_LOCALITY_HILBERT};
    soup mesh = soup_cloth(60, 60);
    sc_mesh m = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_allocator allocator = sc_memory_allocator(NULL);
    sc_scratch scratch;
    sc_points points;
    uint32_t t, k, size;
    for (t = mesh.triangle_count; t > 1; --t) { /* in any order */
        uint32_t u = test_random_below(t), *a = mesh.triangles + 3 * (t - 1);
        for (k = 0; k < 3; ++k) {
            uint32_t v = a[k];
            a[k] = mesh.triangles[3 * u + k];
            mesh.triangles[3 * u + k] = v;
        }
    }
    memset(&options, 0, sizeof(options));
    options.weld = SC_WELD_NONE;
    for (size = 0; size < 4; ++size) {
        double before;
        soup scaled = soup_copy(&mesh);
        soup_scale(scaled.positions, scaled.vertex_count, sizes[size]);
        m = input_plain_mesh(&scaled);
        sc_scratch_init(&scratch, &allocator);
        if (CHECK(sc_mesh_read(&m, &options, &scratch, &points) == SC_OK)) {
            before = mean_step(&points);
            CHECK(sc_locality_sort(&points, curves[size % 2], &scratch) == SC_OK);
            CHECK_MSG(size > 1 || mean_step(&points) < before / 5, "mean step %g, before %g",
                      mean_step(&points), before);
            CHECK(is_renumbered(&points, &scaled));
        }
        sc_scratch_clear(&scratch);
        soup_free(&scaled);
    }
    soup_free(&mesh);
}

/* Triangles in the cells of a lattice, in any order: the curve goes from each cell to one beside
   it. */
static void curve(void)
{
    enum { SIDE = 16, CELLS = SIDE * SIDE * SIDE };
    soup mesh = soup_make(3 * CELLS, CELLS);
    sc_mesh m;
    sc_build_options options;
    sc_allocator allocator = sc_memory_allocator(NULL);
    sc_scratch scratch;
    sc_points points;
    uint32_t t, k, far = 0;
    for (t = 0; t < CELLS; ++t) {
        uint32_t cell = t * 1597 % CELLS;
        for (k = 0; k < 9; ++k) {
            uint32_t axis = k % 3, at = axis == 0 ? cell % SIDE : cell / SIDE;
            at = axis == 2 ? at / SIDE : at % SIDE;
            mesh.positions[9 * t + k] = at + (k / 3 == axis ? 0.1 : 0.0);
        }
        for (k = 0; k < 3; ++k) mesh.triangles[3 * t + k] = 3 * t + k;
    }
    m = input_plain_mesh(&mesh);
    memset(&options, 0, sizeof(options));
    options.weld = SC_WELD_NONE;
    sc_scratch_init(&scratch, &allocator);
    if (CHECK(sc_mesh_read(&m, &options, &scratch, &points) == SC_OK) &&
        CHECK(sc_locality_sort(&points, SC_LOCALITY_HILBERT, &scratch) == SC_OK))
        for (t = 1; t < CELLS; ++t) {
            double step = 0;
            for (k = 0; k < 3; ++k)
                step += fabs(points.rest[3 * points.triangles[3 * t] + k] -
                             points.rest[3 * points.triangles[3 * (t - 1)] + k]);
            far += step > 1.5;
        }
    CHECK_MSG(far == 0, "%" PRIu32 " leaps", far);
    sc_scratch_clear(&scratch);
    soup_free(&mesh);
}

/* Triangles in a row, each of which touches the next in a corner: one closed chain of all their
   edges, just as many as the length of a loop can say; and one triangle more, which has none. */
static void longest_loop(void)
{
    for (uint32_t more = 0; more < 2; ++more) {
        const uint32_t count = SC_LOOP_MAX / 3 + more;
        soup s = soup_make(2 * count + 1, count);
        uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
        sc_mesh mesh = input_plain_mesh(&s);
        sc_build_options options;
        sc_model *model = NULL;
        for (uint32_t v = 0; v < s.vertex_count; ++v) {
            s.positions[3 * v] = v;
            s.positions[3 * v + 1] = v % 2;
            s.positions[3 * v + 2] = 0;
        }
        for (uint32_t t = 0; t < count; ++t) {
            for (uint32_t k = 0; k < 3; ++k) s.triangles[3 * t + k] = 2 * t + (k ? 3 - k : 0);
            order[t] = t;
        }
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.partition = SC_PARTITION_ORDER;
        options.order = order;
        if (CHECK(sc_build(&mesh, &options, &model) == SC_OK)) {
            const sc_node *root = sc_model_node(model);
            CHECK(model->leaf_count <= SC_LOOP_LEAVES && !(root->kind & SC_NODE_PIECES));
            CHECK(root->loop_length == (more ? 0 : SC_LOOP_MAX));
        }
        sc_model_free(model);
        free(order);
        soup_free(&s);
    }
}

static void *allocate_nothing(void *user, uint64_t size, uint64_t alignment)
{
    (void)user, (void)size, (void)alignment;
    return NULL;
}

/* As many leaf clusters as there can be, and one more: by a tree, and by a saved model. What is
   behind the numbers would take a hundred gigabytes, and is not looked at. */
static void most_leaves(void)
{
    const sc_allocator nothing = {allocate_nothing, NULL, NULL};
    for (uint32_t more = 0; more < 2; ++more) {
        sc_scratch scratch;
        sc_hierarchy hierarchy;
        sc_xbvh xbvh;
        sc_model counts;
        memset(&hierarchy, 0, sizeof(hierarchy));
        hierarchy.triangle_count = 0x55555554u;
        hierarchy.leaf_count = SC_LEAVES_MAX + more;
        hierarchy.depth = 30;
        sc_scratch_init(&scratch, &nothing);
        CHECK(sc_xbvh_build(&hierarchy, &scratch, &xbvh) ==
              (more ? SC_ERROR_COUNT : SC_ERROR_MEMORY));
        memset(&counts, 0, sizeof(counts));
        counts.vertex_count = counts.point_count = counts.triangle_count = 0x55555554u;
        counts.leaf_count = SC_LEAVES_MAX + more;
        counts.level_count = 30;
        counts.patch_end = 0xfffffff0u;
        sc_model_lay_out(&counts);
        CHECK(sc_model_check_counts(&counts, counts.bytes) == !more);
    }
}

SC_TEST_MAIN(SC_TEST(locality), SC_TEST(curve), SC_TEST(named_meshes), SC_TEST(hubs),
             SC_TEST(copies), SC_TEST(creases), SC_TEST(edges_of_all_lengths), SC_TEST(slices),
             SC_TEST(two_legs), SC_TEST(longest_loop), SC_TEST(random_meshes), SC_TEST(validators),
             SC_TEST(most_leaves))
