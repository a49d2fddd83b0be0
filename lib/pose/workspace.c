/*
 * The workspace. See workspace.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "pose/workspace.h"

#include <math.h>
#include <string.h>

static uint64_t align(uint64_t bytes)
{
    return (bytes + SC_ALIGNMENT - 1) / SC_ALIGNMENT * SC_ALIGNMENT;
}

/* The next array of the block: NULL if block is, as when only its size is wanted. */
static void *place(unsigned char *block, uint64_t *at, uint64_t count, size_t size)
{
    unsigned char *array = block ? block + *at : NULL;
    *at += align(count * size);
    return array;
}

/* How many leaf clusters are kept ready of each side of pairs: as many as there are, if they are
   few. */
static uint32_t ready_kept(const sc_model *model)
{
    uint32_t kept = 1;
    while (kept < SC_READY_KEPT && kept < model->leaf_count) kept *= 2;
    return kept;
}

/* The same for steps. */
static uint32_t leaves_kept(const sc_model *model)
{
    uint32_t kept = 1;
    while (kept < SC_LEAVES_KEPT && kept < model->leaf_count) kept *= 2;
    return kept;
}

/* The arrays that each worker has for itself, see workspace.h. */
static void lay_out_own(const sc_model *model, unsigned char *block, uint64_t *at, sc_workspace *w)
{
    uint64_t listed = ((uint64_t)model->contour_max / SC_CONTOUR_BLOCK + 3) * SC_CONTOUR_BLOCK +
                      (uint64_t)SC_LOOP_PIECES * SC_CONTOUR_GAP;
    uint64_t levels = (uint64_t)model->level_count + 1, spans, n;
    const uint64_t turns = model->contour_max ? SC_CONTOUR_TURNS : 0;
    int k;
    if (listed < turns * SC_CONTOUR_ROOM) listed = turns * SC_CONTOUR_ROOM;
    w->contour.point = (uint32_t *)place(block, at, listed, sizeof(uint32_t));
    for (k = 0; k < 2; k++) w->contour.at[k] = (float *)place(block, at, listed, sizeof(float));
    for (spans = 0, n = listed / 2; n; n = n > SC_CONTOUR_BLOCK ? (n + 1) / 2 : 0)
        spans += SC_CONTOUR_SPANS(n);
    if (spans < turns * SC_CONTOUR_SPAN_ROOM) spans = turns * SC_CONTOUR_SPAN_ROOM;
    for (k = 0; k < 4; k++)
        w->contour.span_side[k] = (float *)place(block, at, spans, sizeof(float));
    w->contour.is_edge = (uint16_t *)place(
        block, at, listed / SC_CONTOUR_BLOCK + 3 * SC_CONTOUR_TURNS, sizeof(uint16_t));
    w->contour.wall = (float *)place(block, at, listed, sizeof(float));
    w->walk.stack =
        (uint32_t *)place(block, at, levels * (SC_WALK_QUEUE + levels * SC_WALK_CHILDREN), 4);
    w->walk.queue =
        (uint32_t *)place(block, at, SC_WALK_QUEUE + SC_WALK_CHILDREN, sizeof(uint32_t));
    w->walk.self = (uint32_t *)place(block, at, model->leaf_count, sizeof(uint32_t));
    w->walk.alone = (uint32_t *)place(block, at, model->leaf_count, sizeof(uint32_t));
    w->walk.culled = w->walk.marks = (uint8_t *)place(block, at, model->patch_end, 1);
    w->some_ready = (sc_leaf_ready *)place(block, at, 2 * ready_kept(model), sizeof(sc_leaf_ready));
    w->some_known = (sc_leaf_known *)place(block, at, 2 * ready_kept(model), sizeof(sc_leaf_known));
    w->slab = (sc_leaf_slab *)place(block, at, model->leaf_count, sizeof(sc_leaf_slab));
    for (k = 0; k < 2; k++) {
        w->far_pairs[k] = (uint32_t *)place(block, at, SC_LEAF_QUEUE, sizeof(uint32_t));
        w->near_list[k] =
            (uint32_t *)place(block, at, SC_LEAF_QUEUE + SC_LEAF_MAX, sizeof(uint32_t));
    }
    w->near_pairs = (sc_near_pair *)place(block, at, SC_LEAF_QUEUE, sizeof(sc_near_pair));
    w->candidates = (sc_pair *)place(block, at, SC_CANDIDATES_MAX, sizeof(sc_pair));
    w->neighbors = (sc_pair *)place(block, at, SC_CANDIDATES_MAX, sizeof(sc_pair));
    w->ball = (uint16_t *)place(block, at, model->vertex_count, sizeof(uint16_t));
    w->ball_queue = (uint32_t *)place(block, at, model->vertex_count, sizeof(uint32_t));
    w->found = (sc_pair *)place(block, at, SC_FOUND_MAX, sizeof(sc_pair));
    w->state = (unsigned char *)place(block, at, SC_STATE_ROOM, 1);
    if (!(w->flags & SC_WORKSPACE_STEP)) return;
    w->motion.made = (uint8_t *)place(block, at, model->leaf_count + (uint64_t)SC_LEAVES_KEPT, 1);
    w->motion.own_leaves =
        (sc_leaf_motion *)place(block, at, 1 + leaves_kept(model), sizeof(sc_leaf_motion));
    for (k = 0; k < 2; k++) {
        w->motion.found[k] = (sc_pair *)place(block, at, SC_FOUND_MAX, sizeof(sc_pair));
        w->motion.found_time[k] = (double *)place(block, at, SC_FOUND_MAX, sizeof(double));
    }
    w->motion.state = (unsigned char *)place(block, at, SC_STEP_STATE_ROOM, 1);
    for (k = 0; k < 2; k++)
        w->motion.contour.at[k] = (float *)place(block, at, listed, sizeof(float));
    for (k = 0; k < 4; k++) {
        w->contour.run_side[k] =
            (float *)place(block, at, listed / SC_CONTOUR_RUN + 16, sizeof(float));
        w->contour.group_side[k] =
            (float *)place(block, at, listed / SC_CONTOUR_RUN / 16 + 17, sizeof(float));
        w->motion.contour.run_side[k] =
            (float *)place(block, at, listed / SC_CONTOUR_RUN + 16, sizeof(float));
        w->motion.contour.group_side[k] =
            (float *)place(block, at, listed / SC_CONTOUR_RUN / 16 + 17, sizeof(float));
    }
}

/* What only queries of steps use and all workers share. */
static void lay_out_motion(const sc_model *model, unsigned char *block, uint64_t *at, sc_motion *m)
{
    uint64_t patches = (uint64_t)model->patch_end + SC_BOXES_PADDING;
    int s, k;
    m->unit = (float *)place(block, at, 8 * (uint64_t)model->vertex_count, sizeof(float));
    for (s = 0; s < 2; s++)
        for (k = 0; k < 6; k++)
            m->boxes[s].side[k] = (float *)place(block, at, patches, sizeof(float));
    m->own_points = (uint16_t *)place(block, at, model->leaf_count, sizeof(uint16_t));
}

/* A point belongs to the first leaf cluster that has it; seen is 0 for all points, before and
   after. */
static void place_motion(const sc_model *model, sc_motion *m, uint16_t *seen)
{
    const uint32_t *point = sc_model_leaf_point(model);
    uint64_t i, patches = (uint64_t)model->patch_end + SC_BOXES_PADDING;
    uint32_t leaf;
    int s, k;
    for (s = 0; s < 2; s++)
        for (k = 0; k < 6; k++)
            for (i = 0; i < patches; i++)
                m->boxes[s].side[k][i] = k < 3 ? HUGE_VALF : -HUGE_VALF; /* near nothing */
    memset(m->unit, 0, 8 * (size_t)model->vertex_count * sizeof *m->unit);
    for (leaf = 0; leaf < model->leaf_count; leaf++, point += SC_LEAF_POINTS) {
        uint32_t own = 0;
        for (i = 0; i < SC_LEAF_POINTS; i++) {
            if (!seen[point[i]]) own |= 1u << i;
            seen[point[i]] = 1;
        }
        m->own_points[leaf] = (uint16_t)own;
    }
    memset(seen, 0, model->vertex_count * sizeof *seen);
}

/* Nothing is known yet in the arrays of a worker. */
static void clear_own(const sc_model *model, sc_workspace *w)
{
    /* whole lanes of places and spans are read, with some behind the last that was written */
    unsigned char *places = (unsigned char *)(void *)w->contour.at[0];
    memset(places, 0, (size_t)((unsigned char *)(void *)w->contour.is_edge - places));
    memset(w->some_known, 0, 2 * ready_kept(model) * sizeof *w->some_known);
    memset(w->slab, 0, model->leaf_count * sizeof *w->slab);
    memset(w->ball, 0, model->vertex_count * sizeof *w->ball);
}

/* How long the view of a further worker is, with its arrays. */
static uint64_t view_bytes(const sc_model *model, uint32_t flags)
{
    sc_workspace view;
    uint64_t at = align(sizeof view);
    view.flags = flags;
    lay_out_own(model, NULL, &at, &view);
    return at;
}

/* How many leaf clusters can be kept ready at once by the first worker: all, where bounds of
   segments have room for about as many. Models for boxes have none, so that they stay small. */
static uint32_t all_ready_count(const sc_model *model)
{
    return model->segment_count ? model->leaf_count : 0;
}

/* Bounds of segments, and leaf clusters made ready in the same place. */
static void lay_out_bounds(const sc_model *model, unsigned char *block, uint64_t *at,
                           sc_workspace *w)
{
    uint64_t start = *at, end;
    int k;
    w->all_ready = (sc_leaf_ready *)place(block, at, all_ready_count(model), sizeof(sc_leaf_ready));
    end = *at;
    *at = start;
    for (k = 0; k < 2; k++)
        w->bounds[k] =
            (sc_segment_bounds *)place(block, at, model->segment_count, sizeof(sc_segment_bounds));
    if (*at < end) *at = end;
    for (k = 0; k < 2; k++)
        w->bounds_tick[k] = (uint16_t *)place(block, at, model->segment_count, sizeof(uint16_t));
    w->all_known = (sc_leaf_known *)place(block, at, all_ready_count(model), sizeof(sc_leaf_known));
}

static uint64_t lay_out_arrays(const sc_model *model, unsigned char *block, sc_workspace *w)
{
    uint64_t at = align(sizeof *w), patches = (uint64_t)model->patch_end + SC_BOXES_PADDING;
    int k;
    for (k = 0; k < 6; k++)
        w->patch_boxes.side[k] = (float *)place(block, &at, patches, sizeof(float));
    w->mask = (uint16_t *)place(block, &at, model->patch_end, sizeof(uint16_t));
    w->prospect = (uint32_t *)place(block, &at, model->patch_end, sizeof(uint32_t));
    w->point_at =
        (float *)place(block, &at, 4 * SC_LEAF_POINTS * (uint64_t)model->leaf_count, sizeof(float));
    lay_out_bounds(model, block, &at, w); /* next to point_at, see sc_workspace_keep_motions */
    if (w->flags & SC_WORKSPACE_STEP) lay_out_motion(model, block, &at, &w->motion);
    lay_out_own(model, block, &at, w);
    if (w->workers == 1) return at;
    w->view_bytes = view_bytes(model, w->flags);
    w->views = (unsigned char *)place(block, &at, w->view_bytes * (w->workers - 1), 1);
    w->parts = (sc_part *)place(block, &at, SC_PARTS_MAX, sizeof(sc_part));
    w->tests = (uint32_t *)place(block, &at, SC_PARTS_MAX, sizeof(uint32_t));
    w->open = (uint32_t *)place(block, &at, SC_PARTS_MAX, sizeof(uint32_t));
    w->passed = (uint8_t *)place(block, &at, SC_PARTS_MAX, 1);
    w->culled = (uint8_t *)place(block, &at, model->patch_end, 1);
    if (w->flags & SC_WORKSPACE_STEP)
        w->motion.reached = (uint8_t *)place(block, &at, model->node_count, 1);
    return at;
}

uint64_t sc_workspace_bytes(const sc_model *model, const sc_workspace_options *options)
{
    sc_workspace sizes;
    sizes.workers = options ? options->workers : 1;
    sizes.flags = options ? options->flags : 0;
    return lay_out_arrays(model, NULL, &sizes);
}

sc_workspace *sc_workspace_of_worker(sc_workspace *w, uint32_t worker)
{
    if (!worker) return w;
    return (sc_workspace *)(void *)(w->views + (worker - 1) * w->view_bytes);
}

void sc_workspace_keep_some(const sc_model *model, sc_workspace *w)
{
    w->ready = w->some_ready;
    w->known = w->some_known;
    w->ready_mask = ready_kept(model) - 1;
    w->ready_upper = ready_kept(model);
}

void sc_workspace_keep_all(const sc_model *model, sc_workspace *w)
{
    if (!all_ready_count(model)) return;
    w->ready = w->all_ready;
    w->known = w->all_known;
    w->ready_mask = SC_KEEPS_ALL;
    w->ready_upper = 0;
}

/* Gives each of so many workers a part of the room for all leaf clusters, if that is more than it
   has by itself. */
static void keep_parts(const sc_model *model, sc_workspace *w, uint32_t workers)
{
    const uint32_t room = all_ready_count(model) / workers;
    uint32_t kept = 1, worker;
    while (kept <= room / 2) kept *= 2;
    if (w->ready != w->all_ready || kept <= ready_kept(model)) return;
    for (worker = 0; worker < workers; worker++) {
        sc_workspace *own = sc_workspace_of_worker(w, worker);
        own->ready = w->all_ready + (uint64_t)worker * room;
        own->known = w->all_known + (uint64_t)worker * room;
        own->ready_mask = kept - 1;
        own->ready_upper = 0;
    }
}

void sc_workspace_keep_motions(const sc_model *model, sc_workspace *w, uint32_t workers)
{
    unsigned char *room = (unsigned char *)(void *)w->point_at;
    const unsigned char *end =
        (const unsigned char *)(const void *)(w->all_ready + all_ready_count(model));
    const uint64_t count = (uint64_t)(end - room) / sizeof(sc_leaf_motion) / workers;
    uint32_t kept = 1, worker;
    while (kept <= count / 2) kept *= 2;
    for (worker = 0; worker < workers; worker++) {
        sc_motion *m = &sc_workspace_of_worker(w, worker)->motion;
        m->leaves = (sc_leaf_motion *)(void *)room + worker * count;
        m->leaves_mask = count >= model->leaf_count ? SC_KEEPS_ALL : kept - 1;
        if (count < model->leaf_count && kept <= leaves_kept(model)) {
            m->leaves = m->own_leaves + 1;
            m->leaves_mask = leaves_kept(model) - 1;
        }
        memset(m->made, 0, model->leaf_count + (size_t)SC_LEAVES_KEPT);
    }
}

/* All that is in the workspace, with the arrays of its own that stand behind the view. */
static void make_view(const sc_model *model, const sc_workspace *w, sc_workspace *view)
{
    uint64_t at = align(sizeof *view);
    *view = *w;
    lay_out_own(model, (unsigned char *)view, &at, view);
    sc_workspace_keep_some(model, view);
}

void sc_workspace_share(const sc_model *model, sc_workspace *w, uint32_t workers)
{
    uint32_t worker;
    for (worker = 1; worker < workers; worker++) {
        sc_workspace *view = sc_workspace_of_worker(w, worker);
        uint16_t ball_tick = view->ball_tick;
        make_view(model, w, view);
        view->ball_tick = ball_tick;
        view->tasks = NULL;
    }
    keep_parts(model, w, workers);
}

sc_workspace *sc_workspace_place(const sc_model *model, const sc_workspace_options *options,
                                 void *memory)
{
    sc_workspace *w = (sc_workspace *)memory;
    uint64_t i, patches = (uint64_t)model->patch_end + SC_BOXES_PADDING;
    uint32_t worker;
    int k;
    memset(w, 0, sizeof *w);
    w->flags = options ? options->flags : 0;
    w->workers = options ? options->workers : 1;
    w->bytes = lay_out_arrays(model, (unsigned char *)memory, w);
    w->topology_hash = model->topology_hash;
    w->kernels = sc_kernels_for((uint32_t)sc_isa_best());
    for (k = 0; k < 6; k++)
        for (i = 0; i < patches; i++) w->patch_boxes.side[k][i] = (float)NAN;
    memset(w->mask, 0, model->patch_end * sizeof *w->mask);
    for (k = 0; k < 2; k++) memset(w->bounds_tick[k], 0, model->segment_count * sizeof(uint16_t));
    memset(w->all_known, 0, all_ready_count(model) * sizeof *w->all_known);
    clear_own(model, w);
    sc_workspace_keep_some(model, w);
    if (w->flags & SC_WORKSPACE_STEP) place_motion(model, &w->motion, w->ball);
    for (worker = 1; worker < w->workers; worker++) {
        sc_workspace *view = sc_workspace_of_worker(w, worker);
        make_view(model, w, view);
        clear_own(model, view);
    }
    return w;
}

int sc_workspace_fits(sc_workspace *workspace, const sc_model *model)
{
    sc_workspace wanted;
    memcpy(&wanted, workspace, sizeof wanted);
    wanted.bytes = lay_out_arrays(model, (unsigned char *)workspace, &wanted);
    wanted.topology_hash = model->topology_hash;
    return memcmp(&wanted, workspace, sizeof wanted) == 0;
}

sc_pair *sc_workspace_spare(const sc_model *model, const sc_workspace *workspace, uint64_t *count)
{
    const uint64_t ready = all_ready_count(model) * (uint64_t)sizeof(sc_leaf_ready);
    const uint64_t points = 4 * SC_LEAF_POINTS * sizeof(float) * (uint64_t)model->leaf_count;
    *count = (ready ? ready : points) / sizeof(sc_pair);
    return ready ? (sc_pair *)(void *)workspace->all_ready : (sc_pair *)(void *)workspace->point_at;
}

void sc_workspace_new_pose(const sc_model *model, sc_workspace *workspace)
{
    if (workspace->pose_tick == 0x7fffffff) {
        uint32_t worker;
        for (worker = 0; worker < workspace->workers; worker++) {
            sc_workspace *own = sc_workspace_of_worker(workspace, worker);
            memset(own->some_known, 0, 2 * ready_kept(model) * sizeof *own->some_known);
            memset(own->slab, 0, model->leaf_count * sizeof *own->slab);
        }
        memset(workspace->all_known, 0, all_ready_count(model) * sizeof *workspace->all_known);
        workspace->pose_tick = 0;
    }
    workspace->pose_tick++;
    sc_workspace_keep_some(model, workspace);
    workspace->leaves_ready = workspace->boxes_ready = 0;
    workspace->near_count = workspace->far_count = 0;
    workspace->candidate_count = workspace->neighbor_count = workspace->found_count = 0;
    workspace->ball_center = SC_NONE;
}

void sc_workspace_new_projection(const sc_model *model, sc_workspace *workspace)
{
    int k;
    if (workspace->tick == 0xffff) {
        for (k = 0; k < 2; k++)
            memset(workspace->bounds_tick[k], 0, model->segment_count * sizeof(uint16_t));
        workspace->tick = 0;
    }
    workspace->tick++;
}
