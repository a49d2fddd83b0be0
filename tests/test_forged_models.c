/*
 * Saved models whose arrays were changed and that were sealed again: they are refused, or used
 * without reading or writing where nothing is.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/saved.h"
#include "build/model.h"
#include "harness.h"
#include "inputs.h"
#include "saved_models.h"
#include "soups.h"
#include "starcontour.h"

/* Whether each model is used for steps as well; else one in sixteen, as that takes longer than all
   else. */
static int saved_model_always_steps;

/* A step by either contour test, on a workspace of its own. */
static void use_for_step(const sc_model *model, const sc_pose *pose)
{
    sc_workspace_options own;
    sc_workspace *workspace = NULL;
    memset(&own, 0, sizeof(own));
    own.struct_size = sizeof(own);
    own.flags = SC_WORKSPACE_STEP;
    if (!CHECK(sc_workspace_create_for(model, &own, &workspace) == SC_OK)) return;
    for (uint32_t contour = SC_CONTOUR_STAR; contour <= SC_CONTOUR_EXACT; ++contour) {
        sc_step_options options;
        sc_step_result result;
        sc_status status;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.output = SC_OUTPUT_COUNT;
        options.contour = contour;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        status = sc_query_step(model, workspace, pose, pose, &options, &result);
        CHECK(status == SC_OK || status == SC_ERROR_BOXES_ONLY);
    }
    sc_workspace_free(workspace);
}

/* All queries on a forged model: whatever they say, they end, and sanitizers see nothing. */
static void saved_model_use(sc_model *model, const soup *mesh)
{
    static uint32_t uses;
    sc_workspace *workspace = NULL;
    sc_model_info info;
    uint32_t *patches;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    CHECK(sc_model_get_info(model, &info) == SC_OK);
    patches = (uint32_t *)test_allocate(info.triangle_count * sizeof(uint32_t));
    for (uint32_t level = 0; level < info.level_count; ++level)
        CHECK(sc_model_get_patches(model, level, patches, info.triangle_count) == SC_OK);
    free(patches);
    if (!CHECK(sc_workspace_create(model, NULL, &workspace) == SC_OK)) return;
    for (uint32_t i = 0; i < 12 && info.vertex_count == mesh->vertex_count; ++i) {
        saved_model_pairs list =
            saved_model_ask(model, workspace, mesh, mesh->positions, 1 + i % 3, i / 3);
        free(list.pairs);
    }
    if (info.vertex_count == mesh->vertex_count) { /* filters walk where culling does not */
        sc_pose pose = input_plain_pose(mesh->positions, mesh->vertex_count);
        sc_group *groups = (sc_group *)test_allocate((size_t)mesh->vertex_count * sizeof(sc_group));
        sc_query_options options;
        sc_filter filter;
        sc_result result;
        memset(groups, 0xff, (size_t)mesh->vertex_count * sizeof(sc_group));
        memset(&filter, 0, sizeof(filter));
        filter.struct_size = sizeof(filter);
        filter.ignore_rings = 4;
        filter.vertex_groups = groups;
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.output = SC_OUTPUT_COUNT;
        options.filter = &filter;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        CHECK(sc_query(model, workspace, &pose, &options, &result) == SC_OK);
        free(groups);
        if (saved_model_always_steps || uses++ % 16 == 0) use_for_step(model, &pose);
        for (uint32_t t = 1; t < mesh->triangle_count; ++t) {
            sc_pair pair = {t - 1, t};
            sc_contact contact;
            CHECK(sc_contacts(model, &pose, SC_PAIRS_TRIANGLE, &pair, 1, &contact) == SC_OK);
        }
    }
    sc_workspace_free(workspace);
}

typedef struct model_array {
    const char *name;
    uint64_t offset, count;
    uint32_t words; /* uint32_t an element; 0: bytes, of which count says how many */
} model_array;

static uint32_t list_arrays(const sc_model *m, model_array *arrays)
{
    uint32_t n = 0;
    uint32_t vertex_count = m->vertex_count, triangle_count = m->triangle_count;
    uint32_t leaf_count = m->leaf_count, level_count = m->level_count;
    uint32_t patch_end = m->patch_end, around_total = m->around_total, node_count = m->node_count;
    uint32_t contour_total = m->contour_total;
    uint32_t segment_count = m->segment_count, leaf_segment_count = m->leaf_segment_count;
    uint32_t segment_point_total = m->segment_point_total;
    uint32_t segment_child_total = m->segment_child_total, share_count = m->share_count;
    uint32_t share_total = m->share_total;
    uint32_t loop_total = m->loop_total;
#define LIST(array, type, length)                                                                  \
  arrays[n].name = #array;                                                                         \
  arrays[n].offset = m->offset[n];                                                                 \
  arrays[n].words = sizeof(type) / 4;                                                              \
  arrays[n++].count = (length) * (sizeof(type) == 2 ? 2 : 1);
    SC_MODEL_ARRAYS(LIST)
#undef LIST
    return n;
}

/* What a forged save may do: be refused as such, or be loaded and used. Returns whether it was
   refused. */
static int try_forged(saved_model *s, const soup *mesh)
{
    sc_model *loaded = NULL;
    sc_status status;
    saved_model_seal(s);
    status = saved_model_load(s, SC_LOAD_IN_PLACE, &loaded);
    if (status == SC_OK) saved_model_use(loaded, mesh);
    CHECK_MSG(status == SC_OK || status == SC_ERROR_INCONSISTENT, "%s", sc_status_string(status));
    sc_model_free(loaded);
    return status != SC_OK;
}

/* Whether any value of an array's elements will do: masks of which only some bits are read. */
static int is_mask(const model_array *array)
{
    return strcmp(array->name, "share_own_rows") == 0 || strcmp(array->name, "leaf_fan") == 0 ||
           strcmp(array->name, "share_touch") == 0;
}

static unsigned is_little_endian(void)
{
    const uint16_t one = 1;
    return *(const unsigned char *)&one;
}

/* Each number of each array replaced by others. What no array may hold is always refused. */
static void forged_arrays(void)
{
    for (int which = 0; which < SAVED_MODEL_SMALL; ++which) {
        soup mesh;
        sc_model *model = saved_model_build_small(which, &mesh);
        saved_model s = saved_model_of(model);
        model_array arrays[SC_ARRAY_COUNT];
        uint32_t count = list_arrays(model, arrays);
        for (uint32_t a = 0; a < count; ++a) {
            /* what is told of levels; of those without nodes it is known */
            int is_info = which != 3 && strcmp(arrays[a].name, "level_info") == 0;
            unsigned char *base = s.data + sizeof(sc_saved_header) + arrays[a].offset;
            for (uint64_t i = 0; arrays[a].words == 0 && i < arrays[a].count; ++i) {
                unsigned char old = base[i];
                if (strcmp(arrays[a].name, "loop") == 0 && (i ^ is_little_endian()) % 2 == 0)
                    continue; /* the places of points, of which any may be meant */
                base[i] = 0xff;
                CHECK_MSG(old == 0xff || try_forged(&s, &mesh) || is_mask(&arrays[a]),
                          "%s[%" PRIu64 "] = 255", arrays[a].name, i);
                base[i] = (unsigned char)(old ^ 1u);
                try_forged(&s, &mesh);
                base[i] = old;
            }
            for (uint64_t i = 0; i < arrays[a].count * arrays[a].words; ++i) {
                uint32_t *number = (uint32_t *)(void *)base + i, old = *number;
                const uint32_t values[] = {0xfffffff0u, 0x80000000u,       old + 1, old - 1,
                                           0,           old ^ 0x80000000u, old + 2, UINT32_MAX};
                for (uint32_t k = 0; k < sizeof(values) / sizeof(values[0]); ++k) {
                    int refused;
                    *number = values[k];
                    if (values[k] == old) continue;
                    refused = try_forged(&s, &mesh);
                    CHECK_MSG(refused || k > 1 || is_info, "%s[%" PRIu64 "] = %" PRIu32,
                              arrays[a].name, i, values[k]);
                }
                *number = old;
            }
        }
        CHECK(!try_forged(&s, &mesh));
        free(s.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

/* The numbers before the arrays, and several changes at once. */
static void forged_counts(void)
{
    for (int which = 0; which < SAVED_MODEL_SMALL; ++which) {
        soup mesh;
        sc_model *model = saved_model_build_small(which, &mesh), *counts;
        saved_model s = saved_model_of(model);
        uint32_t rounds = test_iterations(3000), refused = 0;
        uint64_t words = sizeof(sc_model) / 4;
        uint32_t *numbers = (uint32_t *)(void *)(s.data + sizeof(sc_saved_header));
        counts = (sc_model *)(void *)numbers;
        for (uint64_t i = 0; i < words; ++i) {
            uint32_t old = numbers[i];
            const uint32_t values[] = {0, 1, old + 1, old - 1, 2 * old, UINT32_MAX, 0xfffffff0u};
            for (uint32_t k = 0; k < sizeof(values) / sizeof(values[0]); ++k) {
                numbers[i] = values[k];
                if (values[k] != old) try_forged(&s, &mesh);
            }
            numbers[i] = old;
        }
        /* sizes that no longer fit, whatever the arrays say */
        counts->leaf_segment_count = counts->segment_count + 1;
        CHECK(try_forged(&s, &mesh));
        counts->leaf_segment_count = model->leaf_segment_count;
        counts->bytes += SC_ALIGNMENT;
        CHECK(try_forged(&s, &mesh));
        counts->bytes = model->bytes;
        for (uint32_t k = 0; k < SC_ARRAY_COUNT; ++k) {
            counts->offset[k] ^= SC_ALIGNMENT;
            CHECK(try_forged(&s, &mesh));
            counts->offset[k] ^= SC_ALIGNMENT;
        }
        for (uint32_t i = 0; i < rounds; ++i) {
            saved_model forged = saved_model_copy(&s, s.size);
            uint32_t changes = 1 + test_random_below(4);
            for (uint32_t k = 0; k < changes; ++k) {
                uint64_t at = sizeof(sc_saved_header) +
                              test_random_below((uint32_t)(s.size - sizeof(sc_saved_header)));
                forged.data[at] = (unsigned char)test_random_below(which ? 20 : 256);
            }
            refused += (uint32_t)try_forged(&forged, &mesh);
            free(forged.memory);
        }
        CHECK(refused > rounds / 10);
        free(s.memory);
        sc_model_free(model);
        soup_free(&mesh);
    }
}

static void *array_of(sc_model *model, uint32_t array)
{
    return (unsigned char *)model + model->offset[array];
}

/* A mesh, its model as saved, and what is made up: the model in there. */
typedef struct forgery {
    soup mesh;
    sc_model *model;
    saved_model saved;
    sc_model *made_up;
} forgery;

static forgery forge(soup mesh)
{
    forgery f;
    f.mesh = mesh;
    f.model = saved_model_build(&f.mesh, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
    f.saved = saved_model_of(f.model);
    f.made_up = (sc_model *)(void *)(f.saved.data + sizeof(sc_saved_header));
    return f;
}

static void end_forgery(forgery *f)
{
    free(f->saved.memory);
    sc_model_free(f->model);
    soup_free(&f->mesh);
}

/* What stands for a point is a point, and there are so many. */
static void forged_uses(void)
{
    forgery f = forge(soup_cloth(8, 7));
    sc_model *m = f.made_up;
    uint8_t *saved_model_use = (uint8_t *)array_of(m, SC_ARRAY_vertex_use);
    for (uint32_t v = 0; v < f.model->vertex_count; ++v) {
        for (uint8_t other = SC_VERTEX_WELDED; other <= SC_VERTEX_UNUSED; ++other) {
            saved_model_use[v] = other;
            CHECK(try_forged(&f.saved, &f.mesh));
            --m->point_count;
            CHECK(try_forged(&f.saved, &f.mesh));
            ++m->point_count;
        }
        saved_model_use[v] = SC_VERTEX_POINT;
    }
    ++m->point_count;
    CHECK(try_forged(&f.saved, &f.mesh));
    m->point_count -= 2;
    CHECK(try_forged(&f.saved, &f.mesh));
    ++m->point_count;
    CHECK(!try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* The whole, which is flat and so oriented, has no contour, be it as a loop or in segments; the
   next node has that one, too. */
static void forged_contour(void)
{
    forgery f = forge(soup_cloth(6, 6));
    sc_model *m = f.made_up;
    sc_node *node = (sc_node *)array_of(m, SC_ARRAY_node);
    uint16_t *loop = (uint16_t *)array_of(m, SC_ARRAY_loop);
    CHECK(node[1].contour > 0 && node[0].loop_length > 0);
    node[1].contour = 0;
    memset(loop, 0, node[0].loop_length * sizeof(*loop)); /* points that the next node has */
    node[1].loop = 0;
    node[1].loop_length = (uint16_t)(node[1].loop_length + node[0].loop_length);
    node[0].loop_length = 0;
    saved_model_always_steps = 1;
    while (try_forged(&f.saved, &f.mesh) && m->contour_max < 1000) /* it has to be what it is now */
        ++m->contour_max;
    saved_model_always_steps = 0;
    CHECK(m->contour_max < 1000);
    end_forgery(&f);
}

/* What a node says of its children, of what it leaves to boxes and of where its loop begins follows
   from all else. */
static void forged_nodes(void)
{
    forgery f = forge(soup_cloth(8, 7));
    const sc_node *was = sc_model_node(f.model);
    sc_node *node = (sc_node *)array_of(f.made_up, SC_ARRAY_node);
    for (uint32_t n = 0; n < f.model->node_count; ++n, ++node, ++was) {
        uint32_t *numbers[] = {&node->patches.a, &node->patches.b, &node->child, &node->loop};
        for (size_t i = 0; i < sizeof(numbers) / sizeof(*numbers); ++i) {
            ++*numbers[i];
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, %zu", (unsigned)n, i);
            *numbers[i] -= 2;
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, %zu", (unsigned)n, i);
            ++*numbers[i];
        }
        for (uint32_t bit = 0; bit < 8; ++bit) {
            node->pairs = (uint8_t)(was->pairs ^ 1u << bit);
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, bit %u", (unsigned)n, (unsigned)bit);
        }
        node->pairs = was->pairs;
        for (uint32_t bit = 4; bit < 8; ++bit) {
            node->kind = (uint8_t)(was->kind ^ 1u << bit);
            CHECK_MSG(try_forged(&f.saved, &f.mesh), "node %u, bit %u", (unsigned)n, (unsigned)bit);
        }
        node->kind = was->kind;
    }
    CHECK(!try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* Nodes whose patches share one point begin their lists with two numbers of another kind. */
static void forged_touches(void)
{
    forgery f = forge(soup_cloth(8, 7));
    sc_model *m = f.made_up;
    sc_node *node = (sc_node *)array_of(m, SC_ARRAY_node);
    uint32_t touching = 0;
    for (uint32_t n = 0; n < f.model->node_count; ++n) {
        uint32_t old = node[n + 1].contour;
        if (!(node[n].kind & SC_NODE_TOUCHES)) continue;
        for (uint32_t left = 0; left < 2 && n + 1 < f.model->node_count; ++left) {
            node[n + 1].contour = node[n].contour + left; /* the rest becomes the next node's */
            CHECK(try_forged(&f.saved, &f.mesh));
        }
        node[n + 1].contour = old;
        ++touching;
    }
    CHECK(touching > 2);
    end_forgery(&f);
}

/* Leaf clusters that share points and are left to boxes; that is, others are said to share
   points. */
static void forged_sharing(void)
{
    forgery f = forge(soup_cloth(12, 12));
    sc_model *m = f.made_up;
    const uint32_t *first = sc_model_share_first(f.model);
    uint32_t *other = (uint32_t *)array_of(m, SC_ARRAY_share_leaf), tried = 0;
    for (uint32_t leaf = 0; leaf < m->leaf_count; ++leaf)
        for (uint32_t i = first[leaf]; i < first[leaf + 1]; ++i) {
            uint32_t was = other[i], end = i + 1 < first[leaf + 1] ? other[i + 1] : m->leaf_count;
            for (other[i] = was + 1; other[i] < end; ++other[i], ++tried)
                CHECK(try_forged(&f.saved, &f.mesh));
            other[i] = was;
        }
    CHECK(tried > 10 && !try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* The node of two leaf clusters is another: of one that the tree reaches early, and of a patch of
   several. */
static void forged_nodes_of_sharing(void)
{
    uint32_t tried[2] = {0, 0};
    for (uint32_t across = 6; across < 14; ++across) {
        forgery f = forge(soup_cloth(across, 9));
        uint32_t *node = (uint32_t *)array_of(f.made_up, SC_ARRAY_share_node), was = node[0];
        for (uint32_t n = 0; n < f.model->node_count; ++n) {
            const sc_pair patches = sc_model_node(f.model)[n].patches;
            const int is_leaf = sc_model_is_leaf(f.model, patches.a);
            if (is_leaf == sc_model_is_leaf(f.model, patches.b)) continue;
            node[0] = n;
            CHECK(try_forged(&f.saved, &f.mesh));
            ++tried[is_leaf];
        }
        node[0] = was;
        CHECK(!try_forged(&f.saved, &f.mesh));
        end_forgery(&f);
    }
    CHECK_MSG(tried[0] > 0 && tried[1] > 0, "%u, %u", (unsigned)tried[0], (unsigned)tried[1]);
}

/* Lists of neighboring triangles with one that is none of its leaf cluster, rows and pairs
   alike. */
static void forged_lists(void)
{
    forgery f = forge(soup_cloth(12, 12));
    sc_model *m = f.made_up;
    const uint32_t *share = sc_model_share_first(f.model), *other = sc_model_share_leaf(f.model);
    const uint32_t *first = sc_model_leaf_first(f.model), *begin = sc_model_share_begin(f.model);
    uint16_t *lists = (uint16_t *)array_of(m, SC_ARRAY_share_list), kept[512];
    uint32_t tried[2] = {0, 0};
    for (uint32_t leaf = 0; leaf < m->leaf_count; ++leaf)
        for (uint32_t i = share[leaf]; i < share[leaf + 1]; ++i) {
            uint16_t *list = lists + begin[i], *pair = list + SC_SHARE_ROWS;
            uint32_t words = begin[i + 1] - begin[i], last = 15, u;
            while (!(list[SC_SHARE_TRIANGLES] >> last & 1)) --last;
            for (uint32_t t = 0; t <= last; ++t) pair += list[SC_SHARE_TRIANGLES] >> t & 1;
            if (words > 512) continue;
            memcpy(kept, list, words * sizeof(*list));
            if (first[leaf + 1] - first[leaf] < 16) { /* the last of the lower cluster's */
                list[SC_SHARE_TRIANGLES] ^= (uint16_t)(1u << last | 1u << 15);
                for (uint16_t *p = pair; p < list + words; ++p)
                    if ((*p & 15u) == last) *p = (uint16_t)(*p | 15u);
                CHECK(try_forged(&f.saved, &f.mesh));
                memcpy(list, kept, words * sizeof(*list));
                ++tried[0];
            }
            if (first[other[i] + 1] - first[other[i]] < 16) { /* the upper one of the last row's */
                for (u = 0; !(pair[-1] >> u & 1); ++u) continue;
                pair[-1] = (uint16_t)(pair[-1] ^ (1u << u | 1u << 15));
                for (uint16_t *p = pair; p < list + words; ++p)
                    if ((*p & 255u) == (last | u << 4)) *p = (uint16_t)(*p | 15u << 4);
                CHECK(try_forged(&f.saved, &f.mesh));
                memcpy(list, kept, words * sizeof(*list));
                ++tried[1];
            }
        }
    CHECK(tried[0] > 3 && tried[1] > 3 && !try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

/* Loops in pieces of which one has no edges, and the next has those too; and numbers of pieces that
   none has, or not that. */
static void forge_pieces(soup mesh, uint32_t least)
{
    forgery f = forge(mesh);
    sc_model *m = f.made_up;
    const sc_node *node = sc_model_node(f.model);
    uint16_t *loop = (uint16_t *)array_of(m, SC_ARRAY_loop);
    uint32_t tried = 0;
    for (uint32_t n = 0; n < f.model->node_count; ++n, ++node) {
        uint16_t *edges = loop + node->loop + 1;
        const uint16_t pieces = edges[-1], others[] = {0, 1, 3, SC_LOOP_PIECES, SC_LOOP_PIECES + 1};
        if (!(node->kind & SC_NODE_PIECES) || !node->loop_length) continue;
        for (size_t k = 0; k < sizeof(others) / sizeof(*others); ++k) {
            edges[-1] = others[k];
            CHECK(others[k] == pieces || try_forged(&f.saved, &f.mesh));
        }
        edges[-1] = pieces;
        for (uint32_t i = 0; i < edges[-1]; ++i) {
            uint16_t *other = &edges[(i + 1) % edges[-1]], was = edges[i];
            edges[i] = 0;
            *other = (uint16_t)(*other + was);
            CHECK(try_forged(&f.saved, &f.mesh));
            edges[i] = was;
            *other = (uint16_t)(*other - was);
            ++tried;
        }
    }
    CHECK(tried >= least && !try_forged(&f.saved, &f.mesh));
    end_forgery(&f);
}

static void forged_pieces(void)
{
    forge_pieces(soup_annulus(16, 3), 4);
    forge_pieces(soup_annulus(4, 1), 2); /* with hardly more numbers than there may be pieces */
}

/* A node has the loops of those that follow as well: refused from where that is more than the sides
   of its triangles. */
static void forged_loops(void)
{
    forgery f = forge(soup_cloth(24, 24));
    sc_model *m = f.made_up;
    sc_node *forged = (sc_node *)array_of(m, SC_ARRAY_node);
    const sc_node *was = sc_model_node(f.model);
    const uint32_t *leaf = sc_model_leaf(f.model);
    uint32_t tried = 0, node = f.model->node_count / 2;
    for (; node < f.model->node_count && tried < 6; ++node) {
        sc_pair patches = was[node].patches;
        uint32_t triangles = sc_model_leaf_first(f.model)[leaf[patches.a] + 1] -
                             sc_model_leaf_first(f.model)[leaf[patches.a]];
        uint32_t end = node + 1, total, refused;
        if (patches.a != patches.b || !sc_model_is_leaf(f.model, patches.a) ||
            !was[node].loop_length || was[node].kind)
            continue;
        while (end + 1 < f.model->node_count && was[end].loop - was[node].loop <= 3 * triangles)
            ++end;
        total = was[end].loop - was[node].loop;
        if (total <= 3 * triangles || total > f.model->contour_max) continue;
        memset((uint16_t *)array_of(m, SC_ARRAY_loop) + was[node].loop, 0,
               total * sizeof(uint16_t));
        for (uint32_t last = end; last + 1 >= end; --last) { /* so many, and one node fewer */
            forged[node].loop_length = (uint16_t)(was[last].loop - was[node].loop);
            for (uint32_t n = node + 1; n < last; ++n) {
                forged[n].loop = was[last].loop;
                forged[n].loop_length = 0;
            }
            refused = (uint32_t)try_forged(&f.saved, &f.mesh);
            CHECK(refused == (forged[node].loop_length > 3 * triangles));
            memcpy(forged + node, was + node, (last - node) * sizeof(*was));
        }
        ++tried;
    }
    CHECK(tried == 6);
    end_forgery(&f);
}

/* Two leaf clusters that face one way have a loop of two points or fewer: the next two have the
   rest as well. They are in folds, of which two do not, so that large patches are left to boxes.
   What is read where nothing is, sanitizers see. */
static void forged_short_loops(void)
{
    enum { FOLDS = 6, ACROSS = 4 };
    soup mesh = soup_cloth(ACROSS, FOLDS * ACROSS);
    uint32_t tried = 0;
    forgery f;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        double *p = mesh.positions + 3 * v, along = FOLDS * p[0];
        p[0] = (int)along % 2 ? 1 - (along - floor(along)) : along - floor(along);
        p[2] = 0.1 * sin(2 * along);
    }
    f = forge(mesh);
    for (uint32_t n = 0; n + 1 < f.model->node_count; ++n) {
        const sc_node *was = sc_model_node(f.model) + n;
        sc_node *node = (sc_node *)array_of(f.made_up, SC_ARRAY_node) + n;
        int fits = was[0].loop_length > 2 && was[1].loop_length > 0;
        for (int i = 0; i < 2; ++i)
            fits &=
                !was[i].kind && was[i].patches.a != was[i].patches.b && sc_node_is_leaf(&was[i]);
        for (uint16_t left = 0; fits && left < 3; ++left) {
            const uint16_t moved = (uint16_t)(was[0].loop_length - left);
            node[0].loop_length = left;
            node[1].loop = was[1].loop - moved;
            node[1].loop_length = (uint16_t)(was[1].loop_length + moved);
            tried += !try_forged(&f.saved, &f.mesh);
        }
        memcpy(node, was, 2 * sizeof(*was));
    }
    CHECK_MSG(tried > 5, "%u", (unsigned)tried);
    end_forgery(&f);
}

/* A header for less than any model, with the right checksum. */
static void forged_sizes(void)
{
    soup mesh;
    sc_model *model = saved_model_build_small(0, &mesh);
    saved_model s = saved_model_of(model);
    char magic[8];
    sc_saved_header *header = (sc_saved_header *)(void *)s.data;
    memcpy(magic, header->magic, sizeof(magic));
    for (uint64_t size = sizeof(*header); size < s.size; size += 8) {
        sc_saved_seal(header, magic, header->version, size, s.data + sizeof(*header));
        saved_model_refuse(&s, SC_ERROR_INCONSISTENT, "size", size);
    }
    header->bytes = 63;
    saved_model_refuse(&s, SC_ERROR_CHECKSUM, "size", 63);
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

static void take_message(void *user, uint32_t level, const char *message)
{
    CHECK(level == SC_LOG_ERROR);
    snprintf((char *)user, 256, "%s", message);
}

static sc_hooks message_hooks(char *text)
{
    sc_hooks hooks;
    memset(&hooks, 0, sizeof(hooks));
    hooks.struct_size = sizeof(hooks);
    hooks.log = take_message;
    hooks.user = text;
    return hooks;
}

/*
 * A chain of segments that would be walked down as deep as it is long: each parent has the one
 * before it and a segment without children, the first several of these.
 */
static void forged_chain(void)
{
    forgery f = forge(soup_cloth(12, 12));
    sc_model *loaded;
    sc_model *m = f.made_up;
    uint32_t parents = m->segment_count - m->leaf_segment_count, leaf, i, at = 0;
    uint32_t extra = m->segment_child_total - 2 * parents;
    uint32_t *first = (uint32_t *)array_of(m, SC_ARRAY_segment_children);
    uint32_t *children = (uint32_t *)array_of(m, SC_ARRAY_children);
    uint32_t *begin = (uint32_t *)array_of(m, SC_ARRAY_segment_first);
    uint32_t *end = (uint32_t *)array_of(m, SC_ARRAY_segment_last);
    char text[256] = "";
    sc_hooks hooks = message_hooks(text);
    sc_load_options o;
    CHECK(parents > 2 * m->level_count && m->segment_child_total >= 2 * parents);
    for (leaf = 0; leaf < m->leaf_segment_count; ++leaf) {
        begin[leaf] = leaf;
        end[leaf] = leaf + 1;
    }
    for (i = leaf = 0; i < parents; ++i) {
        uint32_t number = m->leaf_segment_count + i, stop = at + (i ? 1 : 2 + extra);
        first[i] = at;
        if (i) children[at++] = number - 1, ++stop;
        while (at < stop) children[at++] = leaf++;
        begin[number] = 0;
        end[number] = leaf;
    }
    CHECK(at == m->segment_child_total && leaf <= m->leaf_segment_count &&
          leaf < m->segment_point_total);
    first[parents] = at;
    saved_model_seal(&f.saved);
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.hooks = &hooks;
    CHECK(sc_model_load(f.saved.data, f.saved.size, &o, &loaded) == SC_ERROR_INCONSISTENT);
    CHECK_MSG(strcmp(text, "saved model: array children is wrong") == 0, "%s", text);
    sc_model_free(loaded);
    end_forgery(&f);
}

/* The log says what is wrong. */
static void messages(void)
{
    soup mesh;
    sc_model *model = saved_model_build_small(1, &mesh), *loaded;
    saved_model s = saved_model_of(model);
    model_array arrays[SC_ARRAY_COUNT];
    uint32_t count = list_arrays(model, arrays);
    char text[256], wanted[256];
    sc_hooks hooks = message_hooks(text);
    sc_load_options o;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.hooks = &hooks;
    o.topology_hash = 1;
    CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_TOPOLOGY);
    snprintf(wanted, sizeof(wanted),
             "saved model: topology hash %016" PRIx64 ", expected 0000000000000001",
             model->topology_hash);
    CHECK_MSG(strcmp(text, wanted) == 0, "%s", text);
    o.topology_hash = 0;
    for (uint32_t a = 0; a < count; ++a) {
        unsigned char *number = s.data + sizeof(sc_saved_header) + arrays[a].offset, old[4];
        if (is_mask(&arrays[a])) continue;
        memcpy(old, number, 4);
        memset(number, 0xee, 4);
        saved_model_seal(&s);
        CHECK(sc_model_load(s.data, s.size, &o, &loaded) == SC_ERROR_INCONSISTENT);
        snprintf(wanted, sizeof(wanted), "saved model: array %s is wrong", arrays[a].name);
        /* those that are looked at together have one name */
        if (strcmp(arrays[a].name, "segment_last") == 0)
            snprintf(wanted, sizeof(wanted), "saved model: array segment_first is wrong");
        CHECK_MSG(strcmp(text, wanted) == 0, "%s: %s", arrays[a].name, text);
        memcpy(number, old, 4);
    }
    free(s.memory);
    sc_model_free(model);
    soup_free(&mesh);
}

/* Nine triangles in one place, in leaves of 8 and 1, or 1 and 8. */
static sc_model *build_leaves(soup *mesh, uint32_t first)
{
    static const uint32_t order[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    sc_tree_node tree[3] = {{1, 2, 0, 0}, {SC_NONE, SC_NONE, 0, 0}, {SC_NONE, SC_NONE, 0, 0}};
    sc_build_options options;
    sc_mesh m;
    sc_model *model = NULL;
    test_random_reset(1);
    *mesh = soup_make(27, 9);
    for (uint32_t i = 0; i < 81; ++i) mesh->positions[i] = test_random_unit();
    for (uint32_t i = 0; i < 27; ++i) mesh->triangles[i] = i;
    tree[1].count = tree[2].first = first;
    tree[2].count = 9 - first;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = 3;
    m = input_plain_mesh(mesh);
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    return model;
}

static void workspaces_and_forged_hashes(void)
{
    soup a, b, large;
    sc_model *of_a = build_leaves(&a, 8), *of_b, *of_large, *forged = NULL;
    sc_workspace *workspace = NULL, *own = NULL;
    sc_result result;
    sc_pose pose;
    saved_model s;
    of_b = build_leaves(&b, 1);
    large = soup_cloth(6, 6);
    of_large = saved_model_build(&large, SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
    memset(&result, 0, sizeof(result));
    result.struct_size = sizeof(result);
    CHECK(sc_workspace_create(of_a, NULL, &workspace) == SC_OK);
    /* another topology */
    pose = input_plain_pose(b.positions, b.vertex_count);
    CHECK(sc_query(of_b, workspace, &pose, NULL, &result) == SC_ERROR_WORKSPACE);
    /* one that claims to be the same: refused if the workspace does not fit, else usable */
    s = saved_model_of(of_large);
    ((sc_model *)(void *)(s.data + sizeof(sc_saved_header)))->topology_hash = of_a->topology_hash;
    saved_model_seal(&s);
    CHECK(saved_model_load(&s, SC_LOAD_IN_PLACE, &forged) == SC_OK);
    pose = input_plain_pose(large.positions, large.vertex_count);
    CHECK(sc_query(forged, workspace, &pose, NULL, &result) == SC_ERROR_WORKSPACE);
    sc_model_free(forged);
    free(s.memory);
    s = saved_model_of(of_b);
    ((sc_model *)(void *)(s.data + sizeof(sc_saved_header)))->topology_hash = of_a->topology_hash;
    saved_model_seal(&s);
    CHECK(saved_model_load(&s, SC_LOAD_COPY, &forged) == SC_OK);
    CHECK(sc_workspace_create(of_b, NULL, &own) == SC_OK);
    if (forged) {
        saved_model_compare_pairs(of_a, workspace, of_a, workspace, &a, a.positions);
        CHECK(saved_model_compare_pairs(forged, workspace, of_b, own, &b, b.positions) > 0);
        saved_model_compare_pairs(of_a, workspace, of_a, workspace, &a, a.positions);
    }
    sc_model_free(forged);
    free(s.memory);
    sc_workspace_free(own);
    sc_workspace_free(workspace);
    sc_model_free(of_a);
    sc_model_free(of_b);
    sc_model_free(of_large);
    soup_free(&a);
    soup_free(&b);
    soup_free(&large);
}

/* A model in place of another one, loaded in the same memory: masks of that one are refused,
   whether the new one has other triangles, as many leaf clusters or more, or only claims to have
   the same. */
static void masks_and_forged_hashes(void)
{
    soup mesh[3] = {soup_cloth(8, 8), soup_cloth(20, 20), soup_cloth(8, 8)};
    saved_model saved[3], here;
    uint64_t hash = 0;
    uint32_t leaf_count = 0;
    sc_workspace_options options;
    sc_near_masks *masks = NULL;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.flags = SC_WORKSPACE_NEAR;
    for (uint32_t i = 0; i < 3; ++i) { /* the last one: two triangles swapped */
        const uint32_t first = mesh[2].triangles[i];
        mesh[2].triangles[i] = mesh[2].triangles[3 + i];
        mesh[2].triangles[3 + i] = first;
    }
    for (int i = 0; i < 3; ++i) {
        sc_model *model =
            saved_model_build(&mesh[i], SC_WELD_REST, SC_PARTITION_FAST, SC_MODEL_FULL);
        saved[i] = saved_model_of(model);
        if (i == 0) {
            hash = model->topology_hash;
            leaf_count = model->leaf_count;
        }
        CHECK((model->topology_hash == hash) == (i == 0));
        CHECK((model->leaf_count == leaf_count) == (i != 1));
        sc_model_free(model);
    }
    here = saved_model_make(saved[1].size, 0);
    for (int way = 0; way < 5; ++way) { /* way 3: the second one claims to be the first */
        const int which = way == 3 ? 1 : way % 4;
        const sc_pose pose = input_plain_pose(mesh[which].positions, mesh[which].vertex_count);
        sc_model *model = NULL;
        sc_workspace *workspace = NULL;
        sc_near_options o;
        sc_near_result result;
        sc_status status;
        memcpy(here.data, saved[which].data, (size_t)saved[which].size);
        here.size = saved[which].size;
        if (way == 3) {
            ((sc_model *)(void *)(here.data + sizeof(sc_saved_header)))->topology_hash = hash;
            saved_model_seal(&here);
        }
        if (!CHECK(saved_model_load(&here, SC_LOAD_IN_PLACE, &model) == SC_OK)) break;
        if (way == 0) CHECK(sc_near_masks_create(model, 1, NULL, &masks) == SC_OK);
        CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK);
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.output = SC_OUTPUT_COUNT;
        o.distance = 0.1;
        memset(&result, 0, sizeof(result));
        result.struct_size = sizeof(result);
        CHECK(sc_query_near(model, workspace, &pose, &o, &result) == SC_OK);
        o.masks = masks;
        status = sc_query_near(model, workspace, &pose, &o, &result);
        CHECK_MSG(status == (which ? SC_ERROR_OPTION : SC_OK), "way %d: %s", way,
                  sc_status_string(status));
        sc_workspace_free(workspace);
        sc_model_free(model);
    }
    sc_near_masks_free(masks);
    free(here.memory);
    for (int i = 0; i < 3; ++i) {
        free(saved[i].memory);
        soup_free(&mesh[i]);
    }
}

SC_TEST_MAIN(SC_TEST(forged_arrays), SC_TEST(forged_counts), SC_TEST(forged_uses),
             SC_TEST(forged_contour), SC_TEST(forged_touches), SC_TEST(forged_nodes),
             SC_TEST(forged_sharing), SC_TEST(forged_nodes_of_sharing), SC_TEST(forged_lists),
             SC_TEST(forged_pieces), SC_TEST(forged_loops), SC_TEST(forged_short_loops),
             SC_TEST(forged_sizes), SC_TEST(forged_chain), SC_TEST(messages),
             SC_TEST(workspaces_and_forged_hashes), SC_TEST(masks_and_forged_hashes))
