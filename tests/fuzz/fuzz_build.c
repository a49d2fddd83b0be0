/*
 * Fuzz target: sc_build. Meshes with any indices, coordinates, types and strides, weld maps, orders
 * and trees right and wrong, a caller's bisection that cheats, an allocator that runs dry.
 *
 * What is wrong with the input is worked out here as well: a build must fail with one of the causes
 * that there are, and succeed if there is none. A model must then know its own numbers and answer
 * in its rest pose as the oracle does.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fuzz_support.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

/* ---- the bisection that cheats ---- */

typedef struct cheat {
    fuzz_bytes *bytes;
    int is_done;      /* it broke its contract or gave up: */
    sc_status status; /* what sc_build must return then */
} cheat;

static void check_graph(const sc_dual_graph *g, uint32_t left_target)
{
    FUZZ_CHECK(g->struct_size == sizeof(*g) && g->node_count >= 2 && left_target > 0 &&
                   left_target < g->node_count && g->offsets[0] == 0,
               "%u nodes, %u to the left", (unsigned)g->node_count, (unsigned)left_target);
    for (uint32_t i = 0; i < g->node_count; ++i) {
        FUZZ_CHECK(g->offsets[i] <= g->offsets[i + 1], "node %u", (unsigned)i);
        for (int32_t k = g->offsets[i]; k < g->offsets[i + 1]; ++k)
            FUZZ_CHECK(g->neighbors[k] >= 0 && (uint32_t)g->neighbors[k] < g->node_count &&
                           (uint32_t)g->neighbors[k] != i && g->weights[k] >= 1 &&
                           g->weights[k] <= 1000,
                       "arc %d of node %u", (int)k, (unsigned)i);
    }
}

static sc_status bisect(void *user, const sc_dual_graph *g, uint32_t left_target, uint8_t *side)
{
    cheat *c = (cheat *)user;
    uint32_t how = fuzz_byte(c->bytes), zeros = 0, others = 0;
    FUZZ_CHECK(!c->is_done, "asked again after it gave up");
    check_graph(g, left_target);
    for (uint32_t i = 0; i < g->node_count; ++i) {
        side[i] = i >= left_target;
        if (how >= 128) side[i] = (uint8_t)(fuzz_byte(c->bytes) & (how >= 250 ? 255 : 1));
        zeros += side[i] == 0;
        others += side[i] > 1;
    }
    c->status = how > 100 && how < 120 ? (sc_status)how - 110 : SC_OK;
    if (c->status == SC_OK && (others || zeros == 0 || zeros == g->node_count)) {
        c->status = SC_ERROR_PARTITION;
        c->is_done = 1;
        return SC_OK;
    }
    c->is_done = c->status != SC_OK;
    return c->status;
}

/* ---- maps, orders and trees ---- */

static uint32_t *read_array(fuzz_bytes *bytes, uint32_t count, uint32_t below)
{
    uint32_t *array = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    uint32_t faults = fuzz_byte(bytes) % 8;
    for (uint32_t i = 0; i < count; ++i) array[i] = i;
    for (; faults > 0; --faults) array[fuzz_byte(bytes) % count] = fuzz_byte(bytes) % below;
    return array;
}

static int is_weld_map(const uint32_t *map, uint32_t count)
{
    for (uint32_t v = 0; v < count; ++v)
        if (map[v] >= count || map[map[v]] != map[v]) return 0;
    return 1;
}

/* Whether each of 0 to count - 1 is there once. */
static int is_order(const uint32_t *order, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t found = 0;
        for (uint32_t k = 0; k < count; ++k) found += order[k] == i;
        if (found != 1) return 0;
    }
    return 1;
}

/* A tree of random shape, some nodes of which are overwritten. */
static sc_tree_node *read_tree(fuzz_bytes *bytes, const sc_tree_node *model, uint32_t count)
{
    sc_tree_node *tree = (sc_tree_node *)fuzz_copy(model, count * sizeof(sc_tree_node));
    for (uint32_t faults = fuzz_byte(bytes) % 4; faults > 0; --faults) {
        sc_tree_node *node = &tree[fuzz_byte(bytes) % count];
        uint32_t which = fuzz_byte(bytes), value = fuzz_byte(bytes);
        if (which & 8) value = which & 16 ? SC_NONE : value - 128;
        *(which % 4 == 0   ? &node->left
          : which % 4 == 1 ? &node->right
          : which % 4 == 2 ? &node->first
                           : &node->count) = value;
    }
    return tree;
}

/* Counts how often each place of the order is owned; 0 if nodes are wrong. */
static int walk_tree(const sc_build_options *o, uint32_t triangles, uint32_t at, uint32_t depth,
                     uint8_t *node_seen, uint8_t *owned)
{
    const sc_tree_node *node;
    if (at >= o->tree_count || depth > 60 || node_seen[at]) return 0;
    node = &o->tree[at];
    node_seen[at] = 1;
    if (node->left != SC_NONE || node->right != SC_NONE)
        return walk_tree(o, triangles, node->left, depth + 1, node_seen, owned) &&
               walk_tree(o, triangles, node->right, depth + 1, node_seen, owned);
    if (node->count == 0 || (uint64_t)node->first + node->count > triangles) return 0;
    for (uint32_t i = 0; i < node->count; ++i)
        if (owned[node->first + i]++) return 0;
    return 1;
}

static int is_tree(const sc_build_options *o, uint32_t triangles)
{
    uint8_t *node_seen = (uint8_t *)calloc(o->tree_count + (size_t)triangles, 1);
    uint8_t *owned = node_seen + o->tree_count;
    int is_good = node_seen != NULL && walk_tree(o, triangles, 0, 1, node_seen, owned);
    for (uint32_t i = 0; i < triangles && is_good; ++i) is_good = owned[i];
    free(node_seen);
    return is_good;
}

/* ---- what must come out ---- */

static void check_numbers(const soup *s, const sc_model *model)
{
    uint32_t patch[256];
    sc_model_info info;
    memset(&info, 0, sizeof(info));
    info.struct_size = sizeof(info);
    FUZZ_CHECK(sc_model_get_info(model, &info) == SC_OK && info.vertex_count == s->vertex_count &&
                   info.triangle_count == s->triangle_count &&
                   info.edge_count <= 3 * s->triangle_count && info.level_count > 0,
               "%u triangles", (unsigned)info.triangle_count);
    for (uint32_t level = 0; level <= info.level_count; ++level) {
        sc_level_info l;
        memset(&l, 0, sizeof(l));
        l.struct_size = sizeof(l);
        if (level == info.level_count) {
            FUZZ_CHECK(sc_model_get_level(model, level, &l) == SC_ERROR_LEVEL, "behind the last");
            break;
        }
        FUZZ_CHECK(sc_model_get_level(model, level, &l) == SC_OK && l.patch_count > 0 &&
                       l.connected_patches <= l.patch_count && l.self_nodes <= l.patch_count &&
                       l.self_culled <= l.self_oriented && l.self_oriented <= l.self_nodes &&
                       l.pair_culled <= l.pair_oriented && l.pair_oriented <= l.pair_nodes,
                   "level %u", (unsigned)level);
        FUZZ_CHECK(sc_model_get_patches(model, level, patch, s->triangle_count) == SC_OK, "level");
        for (uint32_t t = 0; t < s->triangle_count; ++t)
            FUZZ_CHECK(patch[t] < l.patch_count, "triangle %u", (unsigned)t);
    }
}

static void check_answers(fuzz_bytes *bytes, const soup *s, const sc_mesh *mesh,
                          const uint32_t *weld, const sc_model *model)
{
    fuzz_memory memory;
    sc_allocator allocator = fuzz_allocator(&memory, fuzz_byte(bytes) & 1);
    sc_workspace *workspace;
    sc_status status = sc_workspace_create(model, &allocator, &workspace);
    FUZZ_CHECK(status == (memory.refused ? SC_ERROR_MEMORY : SC_OK), "status %d", (int)status);
    if (memory.refused) {
        status = sc_workspace_create(model, NULL, &workspace);
        FUZZ_CHECK(status == SC_OK, "status %d", (int)status);
    }
    sc_pose pose = {sizeof(pose), mesh->vertex_count, mesh->position_type, mesh->position_stride,
                    mesh->positions};
    oracle_answer expected = fuzz_expect(s, s->positions, weld, model, workspace);
    for (uint32_t i = 0; i < 8; ++i) {
        uint32_t choice = fuzz_byte(bytes);
        sc_query_options o;
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.pairs = i % 2;
        o.contact = i / 2 % 2;
        o.method = i < 4 ? SC_METHOD_SCTT : choice / 2 % 4;
        o.rest_cache = choice % 2;
        fuzz_check_query(model, workspace, &pose, &o, expected.lists[o.pairs][o.contact].count,
                         &expected);
    }
    oracle_free(&expected);
    sc_workspace_free(workspace);
    FUZZ_CHECK(memory.live == 0, "%u blocks", (unsigned)memory.live);
}

int fuzz_build(const uint8_t *data, size_t size)
{
    fuzz_bytes bytes = {data, size};
    fuzz_memory memory;
    cheat cheating = {&bytes, 0, SC_OK};
    uint32_t weld = fuzz_byte(&bytes), partition = fuzz_byte(&bytes), form = fuzz_byte(&bytes);
    uint32_t dry = fuzz_byte(&bytes), wrong = fuzz_byte(&bytes), faults = 0;
    sc_allocator allocator = fuzz_allocator(&memory, dry & 1 ? dry / 2 : UINT32_MAX);
    soup s = fuzz_mesh(&bytes, 1);
    input_choices choices;
    input_array positions, indices;
    sc_model *model = (sc_model *)&memory;
    sc_status status;
    sc_mesh mesh;

    if (form & 1) soup_round_to_float(s.positions, s.vertex_count);
    positions =
        input_positions(s.positions, s.vertex_count, form & 1 ? SC_FLOAT : SC_DOUBLE, form / 4 % 8);
    indices = input_indices(s.triangles, s.triangle_count, form & 2 ? SC_UINT16 : SC_UINT32,
                            form / 32 % 8);
    mesh = input_mesh(&s, &positions, &indices);
    test_random_reset(form);
    choices = input_choose(&s, weld % 3, partition % 4);
    sc_build_options *o = &choices.options;
    o->allocator = &allocator;
    if (weld & 128 && choices.weld_map != NULL) {
        free(choices.weld_map);
        o->weld_map = choices.weld_map = read_array(&bytes, s.vertex_count, s.vertex_count + 1);
    }
    if (partition & 128 && choices.order != NULL) {
        free(choices.order);
        o->order = choices.order = read_array(&bytes, s.triangle_count, s.triangle_count + 1);
    }
    if (partition & 64 && choices.tree != NULL) {
        o->tree = read_tree(&bytes, choices.tree, o->tree_count);
        free(choices.tree);
        choices.tree = (sc_tree_node *)(uintptr_t)o->tree;
    }
    if (partition & 128 && o->bisect != NULL) {
        o->bisect = bisect;
        o->bisect_user = &cheating;
    }
    switch (wrong & 128 ? wrong % 16 : 16) { /* a member that was right becomes any number */
    case 0:
        mesh.reserved = fuzz_byte(&bytes);
        break;
    case 1:
        mesh.vertex_count = 0;
        break;
    case 2:
        mesh.triangle_count = 0;
        break;
    case 3:
        mesh.position_type = 2 + fuzz_byte(&bytes);
        break;
    case 4:
        mesh.index_type = 2 + fuzz_byte(&bytes);
        break;
    case 5:
        mesh.position_stride = 1 + fuzz_byte(&bytes) % 11;
        break;
    case 6:
        mesh.index_stride = 1 + fuzz_byte(&bytes) % 5;
        break;
    case 7:
        faults |= FUZZ_BIT(SC_ERROR_OPTION);
        o->weld = 3 + fuzz_byte(&bytes);
        break;
    case 8:
        faults |= FUZZ_BIT(SC_ERROR_OPTION);
        o->partition = 4 + fuzz_byte(&bytes);
        break;
    case 9:
        if (o->weld_map || o->order || o->bisect) faults |= FUZZ_BIT(SC_ERROR_NULL);
        o->weld_map = o->order = NULL;
        o->bisect = NULL;
        break;
    case 10:
        if (o->tree) faults |= FUZZ_BIT(SC_ERROR_NULL);
        o->tree = NULL;
        break;
    default:
        break;
    }
    if (o->weld == SC_WELD_MAP && o->weld_map && !is_weld_map(o->weld_map, s.vertex_count))
        faults |= FUZZ_BIT(SC_ERROR_WELD_MAP);
    if (o->order && !is_order(o->order, s.triangle_count)) faults |= FUZZ_BIT(SC_ERROR_TREE);
    if (o->tree && !is_tree(o, s.triangle_count)) faults |= FUZZ_BIT(SC_ERROR_TREE);
    faults |= fuzz_mesh_faults(&mesh, o->weld_map);

    status = sc_build(&mesh, o, &model);
    if (memory.refused) faults = FUZZ_BIT(SC_ERROR_MEMORY);
    if (cheating.is_done) {
        FUZZ_CHECK(status == cheating.status, "%d instead of %d", (int)status, cheating.status);
    } else if (faults) {
        FUZZ_CHECK(status > 0 && status < 32 && faults & FUZZ_BIT(status), "status %d, faults %x",
                   (int)status, (unsigned)faults);
    } else {
        FUZZ_CHECK(status == SC_OK, "status %d", (int)status);
    }
    FUZZ_CHECK((model != NULL) == (status == SC_OK), "status %d", (int)status);
    FUZZ_CHECK(memory.live == (model != NULL), "%u blocks", (unsigned)memory.live);
    if (model != NULL) {
        uint32_t *map = input_weld_of(&choices, &s);
        check_numbers(&s, model);
        check_answers(&bytes, &s, &mesh, map, model);
        free(map);
    }
    sc_model_free(model);
    FUZZ_CHECK(memory.live == 0, "%u blocks", (unsigned)memory.live);
    input_free_choices(&choices);
    input_free(&positions);
    input_free(&indices);
    soup_free(&s);
    return 0;
}
