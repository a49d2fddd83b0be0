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
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "build/csf.h"
#include "build/hierarchy.h"
#include "build/locality.h"
#include "build/mesh.h"
#include "build/model.h"
#include "build/model_check.h"
#include "build/neighbors.h"
#include "build/sctt.h"
#include "build/sharing_lists.h"
#include "build/xbvh.h"
#include "harness.h"
#include "inputs.h"
#include "model_arrays.h"
#include "shapes.h"
#include "soups.h"
#include "starcontour.h"
#include "starcontour_metis.h"
#include "structures.h"

/* ---- all of it ---- */

static void check_all(const char *name, const soup *mesh, const sc_build_options *options)
{
    structures s;
    uint64_t state = test_random_state();
    sc_status status = structures_make(&s, mesh, options);
    s.name = name;
    if (CHECK_MSG(status == SC_OK, "%s: status %d", name, (int)status)) {
        structures_patches p = structures_find_patches(&s);
        CHECK_MSG(sc_hierarchy_validate(&s.hierarchy, &s.scratch) == 1, "%s", name);
        CHECK_MSG(sc_xbvh_validate(&s.xbvh) == 1, "%s", name);
        CHECK_MSG(sc_sctt_validate(&s.xbvh, &s.neighbors, &s.sctt) == 1, "%s", name);
        CHECK_MSG(sc_csf_validate(&s.csf, &s.sctt, &s.scratch) == 1, "%s", name);
        structures_check_edges(&s);
        structures_check_components(&s);
        if (options->partition == SC_PARTITION_ORDER) structures_check_full_leaves(&s);
        structures_check_xbvh(&s, &p);
        structures_check_sctt(&s, &p);
        structures_check_leaf_pairs(&s);
        structures_check_contours(&s, &p);
        if (p.triangles < 500) model_arrays_check_sharing(&s);
        test_random_reset(state); /* a bisection may be random */
        model_arrays_check(&s, &p, mesh, options);
        structures_free_patches(&p);
    }
    structures_free(&s);
}

/* A caller's tree that is a chain: one triangle leaves at each of 59 nodes, the rest is the
   last. */
static void check_chain(const char *name, const soup *mesh, int to_the_left)
{
    uint32_t count = mesh->triangle_count, inner = count - 1 < 59 ? count - 1 : 59, i;
    uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    sc_tree_node *tree =
        (sc_tree_node *)structures_zeroed((2 * (size_t)inner + 1) * sizeof(sc_tree_node));
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
        structures made;
        check_all("hub", &s, &c.options);
        if (CHECK(structures_make(&made, &s, &c.options) == SC_OK)) {
            structures_patches p = structures_find_patches(&made);
            const uint32_t *patch = p.patch + (p.levels - 1) * p.triangles;
            uint8_t *seen = (uint8_t *)structures_zeroed(p.count[p.levels - 1]);
            uint32_t i, n = 0;
            for (i = 0; i < p.triangles; ++i) {
                const uint32_t *v = made.points.triangles + 3 * i, hub = made.points.slot[0];
                if (v[0] != hub && v[1] != hub && v[2] != hub) continue;
                n += !seen[patch[i]];
                seen[patch[i]] = 1;
            }
            hubs_met += n > SC_NEIGHBORS_HUB;
            free(seen);
            structures_free_patches(&p);
        }
        structures_free(&made);
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
    structures made;
    uint32_t i, leaves = 0;
    *divided = *mixed = 0;
    if (CHECK(structures_make(&made, mesh, &c.options) == SC_OK)) {
        structures_patches p = structures_find_patches(&made);
        const uint32_t *patch = p.patch + (p.levels - 1) * p.triangles;
        uint32_t *cluster_of = (uint32_t *)test_allocate(p.triangles * sizeof(uint32_t));
        uint8_t *is_divided = (uint8_t *)structures_zeroed(p.triangles), *is_mixed;
        uint32_t *part_of = (uint32_t *)test_allocate(p.triangles * sizeof(uint32_t));
        is_mixed = (uint8_t *)structures_zeroed(p.triangles);
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
        structures_free_patches(&p);
    }
    structures_free(&made);
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
static int is_noticed(const structures *s, int which, uint32_t *at, uint32_t value)
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
    structures s;
    uint32_t i, n, inner = 0, leaf = 0, middle, *order;
    memset(&options, 0, sizeof(options));
    if (!CHECK(structures_make(&s, &mesh, &options) == SC_OK)) return;
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
    structures_free(&s);
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
    uint8_t *seen = (uint8_t *)structures_zeroed(points->triangle_count);
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

/* Pairs of positions that differ in one coordinate and have the same hash, found by trying a
   million of each: only what is at the same position is welded. */
static void positions_of_one_hash(void)
{
    static const double alike[3][2] = {{75280, 88139}, {355, 43085}, {126313 / 3.0, 787089 / 3.0}};
    for (uint32_t axis = 0; axis < 3; ++axis) {
        soup s = soup_make(6, 2);
        sc_mesh mesh = input_plain_mesh(&s);
        sc_build_options options;
        sc_allocator allocator = sc_memory_allocator(NULL);
        sc_scratch scratch;
        sc_points points;
        memset(s.positions, 0, 18 * sizeof(double));
        for (uint32_t v = 0; v < 6; ++v) {
            s.triangles[v] = v;
            s.positions[3 * v + axis] = v % 3 < 2 ? alike[axis][v % 3] : -1;
        }
        memset(&options, 0, sizeof(options));
        options.weld = SC_WELD_REST;
        sc_scratch_init(&scratch, &allocator);
        if (CHECK(sc_mesh_read(&mesh, &options, &scratch, &points) == SC_OK)) {
            CHECK(points.point_count == 3);
            for (uint32_t v = 0; v < 6; ++v) {
                CHECK(points.triangles[v] == points.triangles[v % 3]);
                CHECK(points.rest[3 * points.triangles[v] + axis] == s.positions[3 * v + axis]);
            }
        }
        sc_scratch_clear(&scratch);
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
             SC_TEST(two_legs), SC_TEST(longest_loop), SC_TEST(positions_of_one_hash),
             SC_TEST(random_meshes), SC_TEST(validators), SC_TEST(most_leaves))
