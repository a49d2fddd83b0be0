/*
 * See structures.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "structures.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "build/locality.h"
#include "build/partition.h"
#include "harness.h"
#include "inputs.h"

sc_status structures_make(structures *s, const soup *mesh, const sc_build_options *options)
{
    sc_mesh m = input_plain_mesh(mesh);
    const uint32_t *order;
    sc_sharing sharing;
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
        status =
            sc_sharing_build(&s->points, &s->adjacency, order, &s->xbvh, &s->scratch, &sharing);
    if (!status)
        status = sc_neighbors_build(&s->points, &s->adjacency, order, &s->xbvh, &sharing,
                                    &s->scratch, &s->neighbors);
    if (!status) status = sc_sctt_build(&s->xbvh, &s->neighbors, &s->scratch, &s->sctt);
    if (!status)
        status = sc_csf_build(&s->points, &s->adjacency, order, &s->xbvh, &s->sctt, &s->scratch,
                              &s->csf);
    return status;
}

void structures_free(structures *s)
{
    sc_scratch_clear(&s->scratch);
}

void *structures_zeroed(size_t size)
{
    void *memory = test_allocate(size);
    memset(memory, 0, size);
    return memory;
}

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

static uint32_t structures_end_of(const structures *s, uint32_t h)
{
    return s->points.triangles[h % 3 == 2 ? h - 2 : h + 1];
}

void structures_check_edges(const structures *s)
{
    uint32_t corners = 3 * s->points.triangle_count, n = 0, i, j, k;
    uint32_t edges = 0, boundary = 0, irregular = 0, wrong = 0;
    uint32_t *opposite = (uint32_t *)test_allocate(corners * sizeof(uint32_t));
    uint8_t *owned = (uint8_t *)structures_zeroed(s->points.triangle_count);
    side *sides = (side *)test_allocate(corners * sizeof(side));
    for (i = 0; i < corners; ++i) {
        uint32_t a = s->points.triangles[i], b = structures_end_of(s, i);
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

void structures_check_components(const structures *s)
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

void structures_check_full_leaves(const structures *s)
{
    const uint32_t *first = s->xbvh.leaf_first;
    uint32_t not_full = 0;
    for (uint32_t leaf = 0; leaf + 1 < s->xbvh.leaf_count; ++leaf) {
        uint32_t count = first[leaf + 1] - first[leaf];
        not_full += count < SC_LEAF_MAX &&
                    count_points(&s->hierarchy, first[leaf], count + 1) <= SC_LEAF_POINTS;
    }
    CHECK_MSG(not_full == 0, "%s: %" PRIu32 " leaf clusters are not full", s->name, not_full);
}

static void visit(const sc_hierarchy *h, uint32_t node, uint32_t level, structures_patches *out)
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

structures_patches structures_find_patches(const structures *s)
{
    structures_patches p;
    size_t size;
    p.levels = s->hierarchy.depth;
    p.triangles = s->points.triangle_count;
    size = (size_t)p.levels * p.triangles;
    p.patch = (uint32_t *)structures_zeroed(size * sizeof(uint32_t));
    p.parent = (uint32_t *)structures_zeroed(size * sizeof(uint32_t));
    p.finished = (uint8_t *)structures_zeroed(size);
    p.count = (uint32_t *)structures_zeroed(p.levels * sizeof(uint32_t));
    visit(&s->hierarchy, 0, 0, &p);
    return p;
}

void structures_free_patches(structures_patches *p)
{
    free(p->patch);
    free(p->parent);
    free(p->finished);
    free(p->count);
}

void structures_check_xbvh(const structures *s, const structures_patches *p)
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
static void find_shared(const structures *s, const structures_patches *p, uint32_t level,
                        uint8_t *shared, uint32_t *which)
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

/* Whether a pair of children of a node's patches is left to boxes, and which two these are. */
static int structures_is_for_boxes(const structures *s, uint32_t node, uint32_t bit, uint32_t *a,
                                   uint32_t *b)
{
    *a = s->xbvh.child[s->sctt.patches[node].a] + bit / 2;
    *b = s->xbvh.child[s->sctt.patches[node].b] + bit % 2;
    return s->sctt.pairs[node] >> (SC_PAIR_BOXES + bit) & 1;
}

void structures_check_sctt(const structures *s, const structures_patches *p)
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
                    if (!structures_is_for_boxes(s, n, k, &c, &d)) continue;
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

void structures_check_leaf_pairs(const structures *s)
{
    const sc_sctt *t = &s->sctt;
    const uint32_t *leaf = s->xbvh.leaf;
    size_t leaves = s->xbvh.leaf_count;
    uint8_t *reached = (uint8_t *)structures_zeroed(leaves * leaves);
    uint32_t n, k, i, j, wrong = 0;
    for (n = 0; n < t->node_count; ++n) {
        uint32_t a = t->patches[n].a, b = t->patches[n].b;
        if (t->child[n] == t->child[n + 1] && sc_xbvh_is_leaf(&s->xbvh, a) &&
            sc_xbvh_is_leaf(&s->xbvh, b))
            ++reached[leaf[a] * leaves + leaf[b]];
        for (k = 0; k < 4; ++k)
            if (structures_is_for_boxes(s, n, k, &a, &b))
                for (i = leaf[a]; i < leaf[a + 1]; ++i)
                    for (j = leaf[b]; j < leaf[b + 1]; ++j) ++reached[i * leaves + j];
    }
    for (i = 0; i < leaves; ++i)
        for (j = 0; j < leaves; ++j) wrong += reached[i * leaves + j] != (i <= j);
    CHECK_MSG(wrong == 0, "%s: %" PRIu32 " of %zu leaf clusters' pairs not reached once", s->name,
              wrong, leaves);
    free(reached);
}

uint32_t structures_count_edges(const sc_csf *csf, uint32_t segment)
{
    return csf->point_last[segment] - csf->point_first[segment];
}

sc_pair *structures_flatten(const sc_csf *csf, uint32_t segment, sc_pair *out)
{
    uint32_t i;
    for (i = csf->point_first[segment]; i < csf->point_last[segment]; ++i, ++out) {
        out->a = csf->points[i];
        out->b = csf->points[i + 1];
    }
    return out;
}

int structures_compare_pairs(const void *x, const void *y)
{
    const sc_pair *a = (const sc_pair *)x, *b = (const sc_pair *)y;
    if (a->a != b->a) return a->a < b->a ? -1 : 1;
    return a->b < b->b ? -1 : a->b > b->b;
}

/* Whether segments hold, as a multiset, the half-edges of the triangles with patch a or b that do
   not meet their opposite within these. */
static int structures_is_contour(const structures *s, const uint32_t *patch, uint32_t a, uint32_t b,
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
        want[expected++].b = structures_end_of(s, h);
    }
    for (i = 0; i < segment_count; ++i) found += structures_count_edges(&s->csf, segments[i]);
    have = end = (sc_pair *)test_allocate(found * sizeof(sc_pair));
    for (i = 0; i < segment_count; ++i) end = structures_flatten(&s->csf, segments[i], end);
    if (expected) qsort(want, expected, sizeof(sc_pair), structures_compare_pairs);
    if (found) qsort(have, found, sizeof(sc_pair), structures_compare_pairs);
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

void structures_check_contours(const structures *s, const structures_patches *p)
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
                wrong += !structures_is_contour(s, patch, a, b, list, count) ||
                         !is_chained(csf, list, count);
            } else {
                wrong += list[0] != s->sctt.touch[n];
                wrong += !structures_is_contour(s, patch, a, a, list + 2, list[1]);
                wrong +=
                    !structures_is_contour(s, patch, b, b, list + 2 + list[1], count - 2 - list[1]);
                wrong += !is_chained(csf, list + 2, list[1]);
                wrong += !is_chained(csf, list + 2 + list[1], count - 2 - list[1]);
            }
        }
    }
    CHECK_MSG(wrong == 0, "%s: contours of %" PRIu32 " nodes wrong", s->name, wrong);
    for (i = 0; i < csf->segment_count; ++i) { /* one half-edge leads to the next */
        uint32_t edges = structures_count_edges(csf, i), e;
        sc_pair *list = (sc_pair *)test_allocate(edges * sizeof(sc_pair));
        gaps += structures_flatten(csf, i, list) != list + edges || edges == 0;
        for (e = 0; e + 1 < edges; ++e) gaps += list[e].b != list[e + 1].a;
        free(list);
    }
    CHECK_MSG(gaps == 0, "%s: %" PRIu32 " gaps within segments", s->name, gaps);
}
