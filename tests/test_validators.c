/*
 * The validators that debug builds run: those of a pose, on sound cones and bounds and on changed
 * ones, and what tests/test_structures.c leaves of those of the model.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/partition.h"
#include "harness.h"
#include "inputs.h"
#include "pose/contour_bounds.h"
#include "pose/dnc.h"
#include "pose/pose_kernels.h"
#include "pose/positions.h"
#include "posed_model.h"
#include "pose/refit.h"
#include "run/workspace.h"

/* A waved cloth with its cones. */
typedef struct scene {
    soup mesh;
    sc_model *model;
    sc_workspace *workspace;
} scene;

static int open_scene(scene *s)
{
    sc_mesh m;
    sc_pose pose;
    s->mesh = soup_cloth(12, 12);
    s->model = NULL;
    s->workspace = NULL;
    m = input_plain_mesh(&s->mesh);
    if (!CHECK(sc_build(&m, NULL, &s->model) == SC_OK) ||
        !CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK))
        return 0;
    soup_smooth(s->mesh.positions, s->mesh.vertex_count, 0.05);
    pose = input_plain_pose(s->mesh.positions, s->mesh.vertex_count);
    sc_workspace_begin(s->model, s->workspace, &posed_model_nothing_asked);
    if (!CHECK(sc_positions_read(s->model, &pose, 24, &s->workspace->frame) == SC_OK)) return 0;
    sc_dnc_update(s->model, &s->workspace->frame);
    return 1;
}

static void close_scene(scene *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    soup_free(&s->mesh);
}

static void cones(void)
{
    scene s;
    if (open_scene(&s)) {
        const uint32_t *first = sc_model_level_first(s.model);
        CHECK(sc_dnc_validate(s.model, &s.workspace->frame));
        for (uint32_t level = 0; level < s.model->level_count; ++level)
            for (uint32_t p = first[level]; p + 1 < first[level + 1]; ++p) {
                uint16_t *mask = &s.workspace->frame.mask[p];
                uint16_t bit = (uint16_t)(1u << test_random_below(SC_DNC_DIRECTIONS));
                *mask = (uint16_t)(*mask ^ bit);
                CHECK_MSG(!sc_dnc_validate(s.model, &s.workspace->frame), "patch %" PRIu32, p);
                *mask = (uint16_t)(*mask ^ bit);
            }
        CHECK(sc_dnc_validate(s.model, &s.workspace->frame));
    }
    close_scene(&s);
}

/* Waves that are broken in some places: leaf clusters without cones, alone and in groups. Each part
   of them, whatever it begins and ends with, has the cones that all have. */
static void cones_of_groups(void)
{
    soup mesh = soup_cloth(70, 70);
    sc_mesh m = input_plain_mesh(&mesh);
    sc_model *model = NULL;
    sc_workspace *w = NULL;
    if (CHECK(sc_build(&m, NULL, &model) == SC_OK) &&
        CHECK(sc_workspace_create(model, NULL, &w) == SC_OK)) {
        const uint32_t leaves = sc_model_first_leaf_patch(model);
        uint16_t *all = (uint16_t *)test_allocate(model->leaf_count * sizeof *all);
        uint32_t skipped = 0, kept = 0;
        for (uint32_t trial = 0; all && trial < 20; ++trial) {
            double *at = (double *)test_allocate(3 * mesh.vertex_count * sizeof *at);
            double along = 5 + 20 * test_random_unit();
            sc_pose pose;
            if (!CHECK(at != NULL)) break;
            memcpy(at, mesh.positions, 3 * mesh.vertex_count * sizeof *at);
            for (uint32_t i = 0; i < mesh.vertex_count; ++i)
                if (sin(along * at[3 * i]) + sin(along * at[3 * i + 1]) > 0)
                    at[3 * i] += 0.1 * test_random_unit();
            pose = input_plain_pose(at, mesh.vertex_count);
            for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
                const uint32_t count = model->leaf_count;
                w->frame.kernels = sc_kernels_for(isa);
                sc_workspace_begin(model, w, &posed_model_nothing_asked);
                if (!CHECK(sc_positions_read(model, &pose, 24, &w->frame) == SC_OK)) break;
                sc_dnc_update(model, &w->frame);
                CHECK(sc_dnc_validate(model, &w->frame));
                memcpy(all, w->frame.mask + leaves, count * sizeof *all);
                memset(w->frame.mask + leaves, 0xff, count * sizeof *all);
                for (uint32_t first = 0, end; first < count; first = end) {
                    end = first + 1 + test_random_below(40);
                    if (end > count) end = count;
                    w->frame.kernels->pose->load_leaves(model, &w->frame, first, end, 1);
                }
                CHECK(!memcmp(all, w->frame.mask + leaves, count * sizeof *all));
            }
            for (uint32_t i = 0; i + SC_CONES_GROUP <= model->leaf_count; i += SC_CONES_GROUP) {
                uint32_t sample = 0, others = 0;
                for (uint32_t k = 0; k < SC_CONES_GROUP; ++k)
                    *(k < SC_CONES_SAMPLE ? &sample : &others) |= all[i + k];
                skipped += !sample;
                kept += sample && others;
                CHECK(sample || !others);
            }
            free(at);
        }
        CHECK_MSG(skipped > 20 && kept > 20, "%" PRIu32 " and %" PRIu32, skipped, kept);
        free(all);
    }
    sc_workspace_free(w);
    sc_model_free(model);
    soup_free(&mesh);
}

/* Ends raised, slopes and extents narrowed: each alone is noticed. */
static void check_changes(const scene *s, int line, uint32_t segment)
{
    sc_workspace *w = s->workspace;
    for (int side = 0; side < 2; ++side) {
        sc_ray_bound *b = &w->bounds.of[line][segment].side[side], old = *b;
        float extent = old.bx - old.ax;
        if (sc_contour_bounds_empty(b) || b->ay == -INFINITY) continue;
        for (int k = 0; k < 6; ++k) {
            if (k == 0) b->ax += extent / 2;
            if (k == 1) b->bx -= extent / 2;
            if (k == 2) b->ay += 1e8f;
            if (k == 3) b->by += 1e8f;
            if (k == 4) b->least = b->most + 1 + fabsf(b->most);
            if (k == 5) b->most = old.least - 1 - fabsf(old.least);
            CHECK_MSG(!sc_contour_bounds_validate(s->model, &w->bounds, line, segment),
                      "segment %" PRIu32 ", line %d, side %d, member %d", segment, line, side, k);
            *b = old;
        }
    }
}

static void bounds(void)
{
    scene s;
    if (open_scene(&s)) {
        sc_workspace *w = s.workspace;
        uint32_t mask = w->frame.mask[0], parents = 0;
        sc_projection projection;
        if (CHECK(mask != 0)) {
            sc_dnc_projection(&w->frame, mask, &projection);
            sc_contour_bounds_begin(s.model, &w->frame.positions[0], &projection, &w->bounds);
            for (int line = 0; line < 2; ++line)
                for (uint32_t i = s.model->segment_count; i-- > 0;) {
                    uint32_t before = w->bounds.epoch_of[line][i] == w->bounds.epoch;
                    CHECK(before ==
                          (uint32_t)sc_contour_bounds_validate(s.model, &w->bounds, line, i));
                    sc_contour_bounds_update(s.model, &w->bounds, line, i);
                    CHECK_MSG(sc_contour_bounds_validate(s.model, &w->bounds, line, i),
                              "segment %" PRIu32, i);
                    parents += i >= s.model->leaf_segment_count;
                    check_changes(&s, line, i);
                }
            CHECK(parents > 10);
        }
    }
    close_scene(&s);
}

/* Nothing is known of coordinates beyond float, and that is sound. */
static void no_bounds(void)
{
    scene s;
    if (open_scene(&s)) {
        sc_workspace *w = s.workspace;
        uint32_t mask = w->frame.mask[0], i;
        sc_projection projection;
        for (i = 0; i < 3 * s.model->vertex_count; ++i) s.mesh.positions[i] *= 1e60;
        if (CHECK(mask != 0)) {
            sc_dnc_projection(&w->frame, mask, &projection);
            sc_contour_bounds_begin(s.model, &w->frame.positions[0], &projection, &w->bounds);
            for (i = 0; i < s.model->segment_count; ++i) {
                sc_contour_bounds_update(s.model, &w->bounds, 0, i);
                CHECK(w->bounds.of[0][i].side[0].ay == -INFINITY);
                CHECK(sc_contour_bounds_validate(s.model, &w->bounds, 0, i));
            }
        }
    }
    close_scene(&s);
}

/* Once a pose. */
static void boxes(void)
{
    scene s;
    if (open_scene(&s)) {
        float *low = s.workspace->frame.patch_boxes.side[0], right;
        sc_refit_boxes(s.model, &s.workspace->frame);
        right = low[0];
        low[0] = 77;
        sc_refit_boxes(s.model, &s.workspace->frame);
        CHECK(low[0] == 77);
        sc_workspace_begin(s.model, s.workspace, &posed_model_nothing_asked);
        sc_refit_boxes(s.model, &s.workspace->frame);
        CHECK(low[0] == right);
    }
    close_scene(&s);
}

/* ---- what test_structures leaves ---- */

static void *no_memory(void *user, uint64_t size, uint64_t alignment)
{
    (void)user;
    (void)size;
    (void)alignment;
    return NULL;
}

/* Nodes each of which is the left child of the one before. */
static void check_long_chain(sc_scratch *scratch)
{
    enum { NODES = 2 * SC_DEPTH_MAX };
    static sc_tree_node nodes[2 * NODES + 1];
    static uint32_t order[NODES + 1], corner[3 * (NODES + 1)];
    sc_hierarchy hierarchy;
    for (uint32_t length = SC_DEPTH_MAX - 1; length < NODES; ++length) {
        uint32_t i;
        hierarchy.order = order;
        hierarchy.corner = corner; /* all triangles at one point */
        hierarchy.nodes = nodes;
        hierarchy.triangle_count = hierarchy.leaf_count = length + 1;
        hierarchy.node_count = 2 * length + 1;
        hierarchy.depth = length + 1;
        for (i = 0; i <= length; ++i) order[i] = i;
        for (i = 0; i < length; ++i) { /* its right child is a leaf of one triangle */
            nodes[i].left = i + 1;
            nodes[i].right = length + 1 + i;
        }
        for (i = 0; i <= length; ++i) {
            nodes[length + i].left = nodes[length + i].right = SC_NONE;
            nodes[length + i].first = i == 0 ? 0 : length + 1 - i;
            nodes[length + i].count = 1;
        }
        CHECK_MSG(sc_hierarchy_validate(&hierarchy, scratch) == (length < SC_DEPTH_MAX + 1),
                  "a chain of %" PRIu32, length);
    }
}

static void structures(void)
{
    soup mesh = soup_cloth(9, 9);
    sc_mesh m = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_allocator standard = sc_memory_allocator(NULL), empty = standard;
    sc_scratch scratch, none;
    sc_points points;
    sc_adjacency adjacency;
    sc_hierarchy hierarchy;
    sc_xbvh xbvh;
    sc_sharing sharing;
    sc_neighbors neighbors;
    sc_sctt sctt;
    sc_csf csf;
    uint32_t i, k, old, *first;
    memset(&options, 0, sizeof(options));
    empty.allocate = no_memory;
    sc_scratch_init(&none, &empty);
    sc_scratch_init(&scratch, &standard);
    if (!CHECK(!sc_mesh_read(&m, &options, &scratch, &points)) ||
        !CHECK(!sc_adjacency_build(&points, &scratch, &adjacency)) ||
        !CHECK(!sc_partition_build(&points, &adjacency, &options, &scratch, &hierarchy)) ||
        !CHECK(!sc_xbvh_build(&hierarchy, &scratch, &xbvh)) ||
        !CHECK(
            !sc_sharing_build(&points, &adjacency, hierarchy.order, &xbvh, &scratch, &sharing)) ||
        !CHECK(!sc_neighbors_build(&points, &adjacency, hierarchy.order, &xbvh, &sharing, &scratch,
                                   &neighbors)) ||
        !CHECK(!sc_sctt_build(&xbvh, &neighbors, &scratch, &sctt)) ||
        !CHECK(!sc_csf_build(&points, &adjacency, hierarchy.order, &xbvh, &sctt, &scratch, &csf)))
        return;
    /* sound; but not without memory to look */
    CHECK(sc_hierarchy_validate(&hierarchy, &scratch) && !sc_hierarchy_validate(&hierarchy, &none));
    CHECK(sc_csf_validate(&csf, &sctt, &scratch) && !sc_csf_validate(&csf, &sctt, &none));
    CHECK(sc_xbvh_validate(&xbvh) && sc_sctt_validate(&xbvh, &neighbors, &sctt));
    /* the right child that does not exist, the last triangle that nobody owns, a chain of nodes
       that is too long, which ends in another error */
    old = hierarchy.nodes[0].right;
    hierarchy.nodes[0].right = hierarchy.node_count;
    CHECK(!sc_hierarchy_validate(&hierarchy, &scratch));
    hierarchy.nodes[0].right = 0;
    CHECK(!sc_hierarchy_validate(&hierarchy, &scratch));
    hierarchy.nodes[0].right = old;
    for (i = hierarchy.node_count; hierarchy.nodes[i - 1].left != SC_NONE;) --i;
    --hierarchy.nodes[i - 1].count;
    CHECK(!sc_hierarchy_validate(&hierarchy, &scratch));
    ++hierarchy.nodes[i - 1].count;
    /* a triangle that does not exist; leaves with more points than they have room for */
    if (CHECK(hierarchy.nodes[i - 1].count < SC_LEAF_MAX)) {
        ++hierarchy.nodes[i - 1].count;
        CHECK(!sc_hierarchy_validate(&hierarchy, &scratch));
        --hierarchy.nodes[i - 1].count;
    }
    {
        sc_hierarchy apart = hierarchy;
        uint32_t corner[3 * 2 * 9 * 9];
        CHECK(hierarchy.triangle_count == 2 * 9 * 9);
        for (k = 0; k < 3 * 2 * 9 * 9; ++k) corner[k] = k;
        apart.corner = corner;
        CHECK(!sc_hierarchy_validate(&apart, &scratch));
    }
    CHECK(sc_hierarchy_validate(&hierarchy, &scratch));
    ++hierarchy.leaf_count;
    CHECK(!sc_hierarchy_validate(&hierarchy, &scratch));
    --hierarchy.leaf_count;
    check_long_chain(&scratch);
    /* a patch without leaves; the first test that has no children */
    i = xbvh.level_first[1] + 1;
    old = xbvh.leaf[i];
    xbvh.leaf[i] = 0;
    CHECK(!sc_xbvh_validate(&xbvh));
    xbvh.leaf[i] = old;
    /* two patches at the top; a level whose children are its own patches, and one that has all
       children but the last, whose leaves the one before claims */
    ++xbvh.level_first[1];
    CHECK(!sc_xbvh_validate(&xbvh));
    --xbvh.level_first[1];
    {
        uint32_t first_patch = xbvh.level_first[1], end = xbvh.level_first[2] - 1;
        uint32_t *child = (uint32_t *)test_allocate(xbvh.patch_end * sizeof(uint32_t));
        memcpy(child, xbvh.child, xbvh.patch_end * sizeof(uint32_t));
        for (i = first_patch; i <= end; ++i) xbvh.child[i] = i;
        CHECK(!sc_xbvh_validate(&xbvh));
        memcpy(xbvh.child, child, xbvh.patch_end * sizeof(uint32_t));
        CHECK(xbvh.child[end] - xbvh.child[end - 1] == 2);
        --xbvh.child[end];
        old = xbvh.leaf[xbvh.child[end]];
        xbvh.leaf[xbvh.child[end]] = xbvh.leaf_count;
        CHECK(!sc_xbvh_validate(&xbvh));
        xbvh.leaf[xbvh.child[end]] = old;
        ++xbvh.child[end];
        free(child);
    }
    CHECK(sc_xbvh_validate(&xbvh));
    /* tests that end too early, at any node */
    for (i = 1, k = sctt.node_count; i < k; ++i) {
        old = sctt.child[i];
        sctt.child[i] = sctt.node_count = i;
        CHECK_MSG(!sc_sctt_validate(&xbvh, &neighbors, &sctt), "%" PRIu32 " nodes", i);
        sctt.child[i] = old;
        sctt.node_count = k;
    }
    ++sctt.child[0];
    CHECK(!sc_sctt_validate(&xbvh, &neighbors, &sctt));
    --sctt.child[0];
    /* children of a segment in the wrong order; more than one segment less than there are */
    for (i = csf.leaf_count; i < csf.segment_count; ++i) {
        first = csf.child_first + (i - csf.leaf_count);
        for (k = first[0]; k + 1 < first[1]; ++k) {
            old = csf.children[k];
            csf.children[k] = csf.children[k + 1];
            csf.children[k + 1] = old;
            CHECK_MSG(!sc_csf_validate(&csf, &sctt, &scratch), "segment %" PRIu32, i);
            csf.children[k + 1] = csf.children[k];
            csf.children[k] = old;
        }
    }
    CHECK(csf.segment_count > csf.leaf_count && sc_csf_validate(&csf, &sctt, &scratch));
    /* two segments with the same children and points */
    first = csf.child_first;
    for (i = k = 0; i + 1 < csf.segment_count - csf.leaf_count && k == 0; ++i)
        if (first[i + 2] - first[i + 1] == first[i + 1] - first[i]) k = i + 1;
    if (CHECK(k > 0)) {
        uint32_t one = csf.leaf_count + k - 1, other = one + 1;
        for (i = first[k]; i < first[k + 1]; ++i)
            csf.children[i] = csf.children[first[k - 1] + i - first[k]];
        csf.point_first[other] = csf.point_first[one];
        csf.point_last[other] = csf.point_last[one];
        CHECK(!sc_csf_validate(&csf, &sctt, &scratch));
    }
    sc_scratch_clear(&scratch);
    soup_free(&mesh);
}

SC_TEST_MAIN(SC_TEST(cones), SC_TEST(cones_of_groups), SC_TEST(bounds), SC_TEST(no_bounds),
             SC_TEST(boxes), SC_TEST(structures))
