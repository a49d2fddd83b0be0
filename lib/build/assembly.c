/*
 * Putting a model together. See assembly.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/assembly.h"

#include <string.h>

#include "base/assume.h"
#include "base/bits.h"
#include "base/jobs.h"
#include "build/connected.h"
#include "build/leaf_shapes.h"

/* Parts of jobs have so many at least. Leaf clusters are cut into so many parts at most, for each
   has marks of its own. */
enum {
    TRIANGLES_PART_MIN = 10000,
    POINTS_PART_MIN = 10000,
    NODES_PART_MIN = 2000,
    LEAVES_PART_MIN = 1000,
    LEAVES_PARTS = 4
};

/* One array of the model while it is being written. */
#define NEW_ARRAY(model, name, type)                                                               \
  ((type *)(void *)((unsigned char *)(model) + (model)->offset[SC_ARRAY_##name]))

static void copy(void *to, const void *from, uint64_t bytes)
{
    if (bytes) memcpy(to, from, (size_t)bytes);
}

static uint64_t mix(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * 0x9fb21c651e98df25u;
    return hash ^ (hash >> 29);
}

static uint64_t hash_topology(const sc_model *m)
{
    const uint32_t *triangle = sc_model_triangle(m);
    const uint8_t *use = sc_model_vertex_use(m);
    const uint32_t *id = sc_model_triangle_id(m), *leaf = sc_model_leaf_first(m);
    const uint32_t *child = sc_model_child(m);
    uint64_t hash = 0x51ed270b7a1c4e35u, i;
    hash = mix(mix(mix(hash, m->vertex_count), m->triangle_count), m->level_count);
    for (i = 0; i < m->vertex_count; i++) hash = mix(hash, use[i]);
    for (i = 0; i < 3 * (uint64_t)m->triangle_count; i++) hash = mix(hash, triangle[i]);
    for (i = 0; i < m->triangle_count; i++) hash = mix(hash, id[i]);
    for (i = 0; i <= m->leaf_count; i++) hash = mix(hash, leaf[i]);
    for (i = 0; i < m->patch_end; i++) hash = mix(hash, child[i]);
    return sc_model_is_for_boxes(m) ? mix(hash, SC_MODEL_BOXES) : hash;
}

/* What is round points is listed in so many parts. */
enum { AROUND_PARTS = 16 };

/* The points that edges join each point with, by old numbers, which are those of the order in which
   they are in memory. */
typedef struct surroundings {
    uint32_t *first;                  /* point_count + 1 */
    uint32_t *points;                 /* by new numbers; and room to read AROUND_AT_ONCE behind */
    uint32_t length;                  /* points of a part */
    uint64_t begin[AROUND_PARTS + 1]; /* where the list of each part begins; how many all have */
} surroundings;

/* What the parts of jobs read, and the model, of which each writes its own share. */
typedef struct assembly {
    const sc_points *points;
    const sc_adjacency *adjacency;
    const uint32_t *order;
    const sc_xbvh *xbvh;
    const sc_sctt *sctt;
    const sc_csf *csf;
    const sc_sharing *sharing;
    sc_connected pieces;
    uint32_t *number;                 /* of each point: the vertex that stands for it */
    uint32_t connected[SC_DEPTH_MAX]; /* patches of each level, that are connected through edges */
    surroundings around;
    sc_model *model;
    uint32_t leaf_parts; /* of the job that writes leaf clusters */
} assembly;

/* Numbers points as the vertices that stand for them. */
static void number_points(const sc_points *points, uint32_t *number)
{
    uint32_t v;
    for (v = 0; v < points->vertex_count; v++)
        if (points->slot[v] < SC_SLOT_WELDED) number[points->slot[v]] = v;
}

/* Some triangles, by their places. */
static void write_triangles(void *context, uint32_t part, uint32_t i, uint32_t end)
{
    const assembly *a = (const assembly *)context;
    const sc_points *points = a->points;
    const uint32_t *order = a->order, *number = a->number;
    const uint8_t *owned_edges = a->adjacency->owned;
    sc_model *m = a->model;
    uint32_t *triangle = NEW_ARRAY(m, triangle, uint32_t) + 3 * (uint64_t)i;
    uint32_t *id = NEW_ARRAY(m, triangle_id, uint32_t), *place = NEW_ARRAY(m, place, uint32_t);
    uint8_t *owned = NEW_ARRAY(m, edge_owned, uint8_t);
    int k;
    (void)part;
    for (; i < end; i++) {
        for (k = 0; k < 3; k++)
            *triangle++ = number[points->triangles[3 * (uint64_t)order[i] + (uint64_t)k]];
        id[i] = points->id[order[i]];
        place[id[i]] = i;
        owned[i] = owned_edges[order[i]];
    }
}

static void write_vertex_use(const sc_points *points, sc_model *m)
{
    uint8_t *use = NEW_ARRAY(m, vertex_use, uint8_t);
    uint32_t i;
    for (i = 0; i < m->vertex_count; i++)
        use[i] = points->slot[i] == SC_SLOT_UNUSED   ? SC_VERTEX_UNUSED
                 : points->slot[i] == SC_SLOT_WELDED ? SC_VERTEX_WELDED
                                                     : SC_VERTEX_POINT;
}

/* The points of some leaf clusters, in the order in which their triangles use them, and where the
   corners are. */
static void write_leaves(void *context, uint32_t part, uint32_t worker)
{
    const assembly *a = (const assembly *)context;
    sc_model *m = a->model;
    const uint32_t begin = (uint32_t)((uint64_t)m->leaf_count * part / a->leaf_parts);
    const uint32_t end = (uint32_t)((uint64_t)m->leaf_count * (part + 1) / a->leaf_parts);
    /* a place of each vertex, which may be of another cluster; LEAVES_PARTS times as many bytes are
       there, to be written to later */
    uint8_t *last_place = NEW_ARRAY(m, around_first, uint8_t) + (uint64_t)part * m->vertex_count;
    const uint32_t *first = sc_model_leaf_first(m);
    const uint32_t *corner = sc_model_triangle(m) + 3 * (uint64_t)first[begin];
    uint32_t *point = NEW_ARRAY(m, leaf_point, uint32_t) + SC_LEAF_POINTS * (uint64_t)begin;
    uint8_t *where = NEW_ARRAY(m, leaf_corner, uint8_t) + 3 * SC_LEAF_MAX * (uint64_t)begin;
    uint32_t leaf, i, k;
    (void)worker;
    memset(last_place, 0, m->vertex_count);
    for (leaf = begin; leaf < end; leaf++, point += SC_LEAF_POINTS, where += 3 * SC_LEAF_MAX) {
        uint32_t count = first[leaf + 1] - first[leaf], points = 0, newest;
        uint32_t known[SC_LEAF_POINTS];
        for (i = 0; i < SC_LEAF_POINTS; i++) known[i] = SC_NONE;
        for (i = 0; i < count; i++, corner += 3)
            for (k = 0; k < 3; k++) { /* without branches, which no processor could foresee */
                uint32_t p = corner[k], place = last_place[p], is_new = known[place] != p;
                place = is_new ? points : place;
                points += is_new;
                known[place] = p;
                last_place[p] = where[SC_LEAF_MAX * k + i] = (uint8_t)place;
            }
        newest = known[points - 1];
        for (k = 0; k < 3; k++)
            for (i = count; i < SC_LEAF_MAX; i++)
                where[SC_LEAF_MAX * k + i] = where[SC_LEAF_MAX * k + count - 1];
        for (i = 0; i < SC_LEAF_POINTS; i++) point[i] = i < points ? known[i] : newest;
    }
}

/* Lists of neighbors are copied so many points at once, as nearly all are shorter; what is too much
   is written over by the next. Their memory is asked for so many vertices ahead. */
enum { AROUND_AT_ONCE = 8, AROUND_AHEAD = 16 };

/* For each corner at a point the next one; the previous one as well if no half-edge runs back to
   it. */
static void list_around(const sc_points *points, const sc_adjacency *adjacency,
                        const uint32_t *number, uint32_t part, surroundings *s)
{
    const uint32_t *triangles = points->triangles;
    uint32_t p, i, at = (uint32_t)s->begin[part];
    const uint32_t end = part + 1 < AROUND_PARTS ? (part + 1) * s->length : points->point_count;
    for (p = part * s->length; p < end; p++) {
        s->first[p] = at;
        for (i = adjacency->corner_first[p]; i < adjacency->corner_first[p + 1]; i++) {
            uint32_t h = adjacency->corners[i], before = sc_adjacency_previous(h);
            s->points[at++] = number[triangles[sc_adjacency_next(h)]];
            if (adjacency->opposite[before] == SC_NONE) s->points[at++] = number[triangles[before]];
        }
    }
    if (part + 1 == AROUND_PARTS) s->first[p] = at;
}

/* How long these lists are, and those of the parts before each. */
static void count_around(const sc_points *points, const sc_adjacency *adjacency, surroundings *s)
{
    const uint32_t corners = 3 * points->triangle_count;
    uint64_t single[AROUND_PARTS] = {0}, before = 0; /* half-edges that no other runs back to */
    uint32_t h, part;
    s->length = points->point_count / AROUND_PARTS;
    for (h = 0; h < corners; h++)
        if (adjacency->opposite[h] == SC_NONE) {
            part = s->length ? points->triangles[sc_adjacency_next(h)] / s->length : AROUND_PARTS;
            single[part < AROUND_PARTS ? part : AROUND_PARTS - 1]++;
        }
    for (part = 0; part < AROUND_PARTS; before += single[part++])
        s->begin[part] = adjacency->corner_first[part * s->length] + before;
    s->begin[part] = corners + before;
}

static void write_around(const sc_points *points, const surroundings *s, sc_model *m)
{
    uint32_t *first = NEW_ARRAY(m, around_first, uint32_t);
    uint32_t *around = NEW_ARRAY(m, around, uint32_t), at = 0, v;
    for (v = 0; v < m->vertex_count; v++) {
        uint32_t p = points->slot[v], n, ahead = v + AROUND_AHEAD;
        if (ahead < m->vertex_count && points->slot[ahead] < SC_SLOT_WELDED)
            sc_fetch(s->points + s->first[points->slot[ahead]]);
        first[v] = at;
        if (p >= SC_SLOT_WELDED) continue;
        n = s->first[p + 1] - s->first[p];
        if (n <= AROUND_AT_ONCE && m->around_total - at >= AROUND_AT_ONCE)
            memcpy(around + at, s->points + s->first[p], AROUND_AT_ONCE * sizeof *around);
        else
            memcpy(around + at, s->points + s->first[p], n * sizeof *around);
        at += n;
    }
    first[v] = at;
}

static void write_box_children(const sc_xbvh *xbvh, sc_model *m)
{
    uint32_t *box_child = NEW_ARRAY(m, box_child, uint32_t), level, p, step;
    for (level = 0; level < xbvh->level_count; level++) {
        uint32_t steps = sc_model_box_steps(xbvh->level_count, level);
        for (p = xbvh->level_first[level]; p < xbvh->level_first[level + 1]; p++) {
            box_child[p] = p;
            for (step = 0; step < steps; step++) box_child[p] = xbvh->child[box_child[p]];
        }
    }
}

static void write_nodes(const assembly *a, uint32_t n, uint32_t end)
{
    const sc_sctt *sctt = a->sctt;
    const sc_csf *csf = a->csf;
    sc_node *node = NEW_ARRAY(a->model, node, sc_node) + n;
    for (; n < end; n++, node++) {
        node->patches = sctt->patches[n];
        node->child = sctt->child[n];
        node->loop = csf->loop_first[n];
        node->contour = csf->contour_first[n];
        node->loop_length = (uint16_t)(csf->loop_first[n + 1] - csf->loop_first[n]);
        node->pairs = (uint8_t)sctt->pairs[n];
        node->kind = csf->in_pieces[n] ? SC_NODE_PIECES : 0;
        if (sctt->touch[n] != SC_NONE) node->kind |= SC_NODE_TOUCHES;
    }
}

/* Behind the last node. */
static void write_node_behind(sc_model *m)
{
    sc_node *node = NEW_ARRAY(m, node, sc_node) + m->node_count;
    memset(node, 0, sizeof *node);
    node->child = m->node_count;
    node->contour = m->contour_total;
}

/* The node of each two leaf clusters that share points, among some nodes. No two nodes are of the
   same two. */
static void write_share_nodes(sc_model *m, uint32_t n, uint32_t end)
{
    uint32_t *share_node = NEW_ARRAY(m, share_node, uint32_t), i;
    const uint32_t *first = sc_model_share_first(m), *other = sc_model_share_leaf(m);
    const uint32_t *leaf = sc_model_leaf(m);
    const sc_node *node = sc_model_node(m);
    for (; n < end; n++) {
        const uint32_t a = node[n].patches.a, b = node[n].patches.b;
        if (a == b || !sc_node_is_leaf(&node[n])) continue;
        for (i = first[leaf[a]]; i < first[leaf[a] + 1]; i++)
            if (other[i] == leaf[b]) share_node[i] = n;
    }
}

static void write_contours(const assembly *a, uint32_t n, uint32_t end)
{
    const sc_csf *csf = a->csf;
    uint32_t *contours = NEW_ARRAY(a->model, contours, uint32_t);
    const uint32_t first = csf->contour_first[n];
    copy(contours + first, csf->contours + first,
         (csf->contour_first[end] - first) * sizeof(uint32_t));
    for (; n < end; n++)
        if (a->sctt->touch[n] != SC_NONE)
            contours[csf->contour_first[n]] = a->number[contours[csf->contour_first[n]]];
}

/* Some nodes, and all that is of each. */
static void write_tree(void *context, uint32_t part, uint32_t n, uint32_t end)
{
    const assembly *a = (const assembly *)context;
    (void)part;
    write_nodes(a, n, end);
    write_share_nodes(a->model, n, end);
    write_contours(a, n, end);
}

/* Some points of segments. */
static void write_segment_points(void *context, uint32_t part, uint32_t i, uint32_t end)
{
    const assembly *a = (const assembly *)context;
    const uint32_t *number = a->number, *points = a->csf->points;
    uint32_t *list = NEW_ARRAY(a->model, points, uint32_t);
    (void)part;
    for (; i < end; i++) list[i] = number[points[i]];
}

static void copy_segments(const sc_csf *csf, sc_model *m)
{
    copy(NEW_ARRAY(m, segment_first, uint32_t), csf->point_first,
         m->segment_count * sizeof(uint32_t));
    copy(NEW_ARRAY(m, segment_last, uint32_t), csf->point_last,
         m->segment_count * sizeof(uint32_t));
    copy(NEW_ARRAY(m, segment_children, uint32_t), csf->child_first,
         ((uint64_t)m->segment_count - m->leaf_segment_count + 1) * sizeof(uint32_t));
    copy(NEW_ARRAY(m, children, uint32_t), csf->children,
         m->segment_child_total * sizeof(uint32_t));
}

static void write_levels(const sc_xbvh *xbvh, const sc_sctt *sctt, const sc_csf *csf,
                         const uint32_t *connected, sc_level *levels)
{
    uint32_t level, n;
    for (level = 0; level < xbvh->level_count; level++) {
        levels[level].patch_count = sc_xbvh_patches(xbvh, level);
        levels[level].connected_patches = connected[level];
        levels[level].segment_count = csf->level_segments[level];
        for (n = sctt->level_first[level]; n < sctt->level_first[level + 1]; n++)
            if (sctt->patches[n].a == sctt->patches[n].b)
                levels[level].self_nodes++;
            else
                levels[level].pair_nodes++;
    }
}

static void count_arrays(const sc_points *points, const sc_adjacency *adjacency,
                         const sc_xbvh *xbvh, const sc_sctt *sctt, const sc_csf *csf, sc_model *m)
{
    m->vertex_count = points->vertex_count;
    m->point_count = points->point_count;
    m->triangle_count = points->triangle_count;
    m->edge_count = adjacency->edge_count;
    m->component_count = adjacency->component_count;
    m->boundary_edges = adjacency->boundary_edges;
    m->irregular_edges = adjacency->irregular_edges;
    m->leaf_count = xbvh->leaf_count;
    m->level_count = xbvh->level_count;
    m->patch_end = xbvh->patch_end;
    m->node_count = sctt->node_count;
    m->contour_total = csf->contour_first[sctt->node_count];
    m->loop_total = csf->loop_first[sctt->node_count];
    m->segment_count = csf->segment_count;
    m->leaf_segment_count = csf->leaf_count;
    m->segment_point_total = csf->point_count;
    m->contour_max = csf->contour_max;
    m->segment_child_total = csf->child_first[csf->segment_count - csf->leaf_count];
}

/* Steps of about the same length that need not wait for each other. */
static void write_rest(void *context, uint32_t part, uint32_t worker)
{
    const assembly *a = (const assembly *)context;
    sc_model *m = a->model;
    uint16_t *own_rows = NEW_ARRAY(m, share_own_rows, uint16_t);
    uint64_t i;
    (void)worker;
    if (!part) {
        m->topology_hash = hash_topology(m);
        return;
    }
    write_around(a->points, &a->around, m);
    for (i = 0; i < m->leaf_count; i++)
        sc_sharing_fold(a->sharing->own_rows + SC_LEAF_MAX * i, own_rows + SC_OWN_WORDS * i);
    write_box_children(a->xbvh, m);
    copy_segments(a->csf, m);
    write_levels(a->xbvh, a->sctt, a->csf, a->connected, NEW_ARRAY(m, level_info, sc_level));
}

/* Arrays that others are made from. */
static void copy_hierarchy(const sc_xbvh *xbvh, const sc_sharing *sharing, sc_model *m)
{
    copy(NEW_ARRAY(m, leaf_first, uint32_t), xbvh->leaf_first,
         ((uint64_t)m->leaf_count + 1) * sizeof(uint32_t));
    copy(NEW_ARRAY(m, share_first, uint32_t), sharing->first,
         ((uint64_t)m->leaf_count + 1) * sizeof(uint32_t));
    copy(NEW_ARRAY(m, share_leaf, uint32_t), sharing->leaf, m->share_count * sizeof(uint32_t));
    copy(NEW_ARRAY(m, share_crowded, uint8_t), sharing->crowded, m->leaf_count);
    copy(NEW_ARRAY(m, level_first, uint32_t), xbvh->level_first,
         ((uint64_t)m->level_count + 1) * sizeof(uint32_t));
    copy(NEW_ARRAY(m, child, uint32_t), xbvh->child, m->patch_end * sizeof(uint32_t));
    copy(NEW_ARRAY(m, leaf, uint32_t), xbvh->leaf, m->patch_end * sizeof(uint32_t));
}

/* Of each triangle, leaf cluster, node and segment. */
static void write_arrays(assembly *a, const sc_tasks *tasks, sc_sharing_parts *parts)
{
    sc_model *m = a->model;
    copy_hierarchy(a->xbvh, a->sharing, m);
    write_vertex_use(a->points, m);
    sc_jobs_loop(tasks, m->triangle_count, TRIANGLES_PART_MIN, write_triangles, a);
    a->leaf_parts = tasks && m->leaf_count >= LEAVES_PARTS * LEAVES_PART_MIN ? LEAVES_PARTS : 1;
    sc_jobs_run(tasks, a->leaf_parts, write_leaves, a);
    sc_jobs_run(m->triangle_count < TRIANGLES_PART_MIN ? NULL : tasks, 2, write_rest, a);
    sc_leaf_shapes_fans(m, tasks, NEW_ARRAY(m, leaf_fan, uint16_t));
    sc_leaf_shapes_outlines(m, tasks, NEW_ARRAY(m, leaf_outline, uint8_t));
    sc_leaf_shapes_touches(m, tasks, NEW_ARRAY(m, share_touch, uint16_t));
    sc_sharing_lists_write(a->sharing, a->xbvh, sc_model_triangle(m), tasks, parts,
                           NEW_ARRAY(m, share_begin, uint32_t), NEW_ARRAY(m, share_list, uint16_t));
    memset(NEW_ARRAY(m, share_node, uint32_t), 0xff, m->share_count * sizeof(uint32_t));
    if (m->node_count) sc_jobs_loop(tasks, m->node_count, NODES_PART_MIN, write_tree, a);
    write_node_behind(m);
    if (m->segment_point_total)
        sc_jobs_loop(tasks, m->segment_point_total, POINTS_PART_MIN, write_segment_points, a);
}

/* Steps before there is a model, which need not wait for each other. */
static void before_writing(void *context, uint32_t part, uint32_t worker)
{
    assembly *a = (assembly *)context;
    (void)worker;
    if (part)
        list_around(a->points, a->adjacency, a->number, part - 1, &a->around);
    else if (a->sctt->node_count) /* of models for boxes nobody asks */
        sc_connected_count(a->adjacency, a->order, a->xbvh, &a->pieces, a->connected);
}

sc_status sc_assembly_make(const sc_points *points, sc_adjacency *adjacency,
                           const sc_hierarchy *hierarchy, const sc_xbvh *xbvh, const sc_sctt *sctt,
                           const sc_csf *csf, const sc_sharing *sharing, sc_scratch *scratch,
                           sc_model **model)
{
    sc_model counts, *m;
    assembly all;
    sc_sharing_parts share_parts;
    const uint64_t share_total =
        sc_sharing_lists_count(sharing, xbvh, scratch->tasks, &share_parts);
    const sc_tasks *tasks = points->triangle_count < TRIANGLES_PART_MIN ? NULL : scratch->tasks;
    uint64_t around_total;
    sc_status status = SC_OK;

    memset(&counts, 0, sizeof counts);
    memset(&all, 0, sizeof all);
    count_arrays(points, adjacency, xbvh, sctt, csf, &counts);
    count_around(points, adjacency, &all.around);
    around_total = all.around.begin[AROUND_PARTS];
    if (SC_HARDLY(around_total > UINT32_MAX || share_total > UINT32_MAX)) return SC_ERROR_COUNT;
    all.points = points;
    all.adjacency = adjacency;
    all.order = hierarchy->order;
    all.xbvh = xbvh;
    all.sctt = sctt;
    all.csf = csf;
    all.sharing = sharing;
    all.number = (uint32_t *)sc_scratch_take(scratch, points->point_count, sizeof *all.number);
    all.around.first = (uint32_t *)sc_scratch_take(scratch, (uint64_t)points->point_count + 1,
                                                   sizeof *all.around.first);
    all.around.points = (uint32_t *)sc_scratch_take(scratch, around_total + AROUND_AT_ONCE,
                                                    sizeof *all.around.points);
    if (!all.number || !all.around.first || !all.around.points) return SC_ERROR_MEMORY;
    if (sctt->node_count) status = sc_connected_take(xbvh, scratch, &all.pieces);
    if (status) return status;
    number_points(points, all.number);
    sc_jobs_run(tasks, 1 + AROUND_PARTS, before_writing, &all);
    sc_connected_give(scratch, &all.pieces);
    sc_adjacency_give_walks(adjacency, scratch); /* before the model needs memory */
    counts.share_count = sharing->first[xbvh->leaf_count];
    counts.share_total = (uint32_t)share_total;
    counts.around_total = (uint32_t)around_total;
    sc_model_lay_out(&counts);
    if (SC_HARDLY(counts.bytes > SIZE_MAX - SC_ALIGNMENT)) /* where addresses have 32 bits */
        return SC_ERROR_COUNT;
    m = sc_model_allocate(counts.bytes, scratch);
    if (!m) return SC_ERROR_MEMORY;
    *m = counts;
    sc_model_clear_gaps(m);
    all.model = m;
    write_arrays(&all, scratch->tasks, &share_parts);
    sc_scratch_give(scratch, all.around.points); /* before the loops need memory */
    sc_scratch_give(scratch, all.around.first);
    if (!sc_model_is_for_boxes(m))
        status = sc_loops_write(csf, sctt, xbvh, hierarchy->order, sc_model_leaf_corner(m), scratch,
                                NEW_ARRAY(m, loop, uint16_t));
    if (status) {
        sc_model_release(m);
        return status;
    }
    *model = m;
    return SC_OK;
}

sc_node *sc_assembly_nodes(sc_model *model)
{
    return NEW_ARRAY(model, node, sc_node);
}

sc_level *sc_assembly_levels(sc_model *model)
{
    return NEW_ARRAY(model, level_info, sc_level);
}
