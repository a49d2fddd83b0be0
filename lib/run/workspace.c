/*
 * The workspace. See workspace.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/workspace.h"

#include <math.h>
#include <string.h>

#include "base/assume.h"

/* ---- layout ---- */

/* Where the next array goes; block is NULL when only the size is wanted. */
typedef struct layout {
    unsigned char *block;
    uint64_t at;
} layout;

static void *place(layout *l, uint64_t count, size_t size)
{
    unsigned char *array = l->block ? l->block + l->at : NULL;
    l->at += (count * size + SC_ALIGNMENT - 1) / SC_ALIGNMENT * SC_ALIGNMENT;
    return array;
}

#define SC_PLACE(layout, count, type) ((type *)place((layout), (count), sizeof(type)))

/* What a workspace has that takes its room from another one. */
#define SHARES_ROOM 0x80000000u

static sc_workspace_sizes sizes_for(const sc_model *model, uint32_t workers, uint32_t flags)
{
    sc_workspace_sizes s;
    s.vertices = model->vertex_count;
    s.leaves = model->leaf_count;
    s.patches = model->patch_end;
    s.nodes = model->node_count;
    s.levels = model->level_count;
    s.segments = model->segment_count;
    s.contour = model->contour_max;
    s.workers = workers;
    s.flags = flags;
    return s;
}

/* Of how many leaf clusters a worker keeps what it makes of them, a power of two: of so many, or of
   all, if they are few. */
static uint32_t some_leaves(const sc_workspace_sizes *s, uint32_t most)
{
    uint32_t kept = 1;
    while (kept < most && kept < s->leaves) kept *= 2;
    return kept;
}

/* Of how many the first worker can keep it at once: of all, where bounds of
   segments have room for about as many. Models for boxes have none, so that they stay small. */
static uint32_t all_derived(const sc_workspace_sizes *s)
{
    return s->segments ? s->leaves : 0;
}

/* Its own, or those of which it may use some. */
static sc_workspace_sizes sizes_asked(const sc_model *model, const sc_workspace_options *o)
{
    if (!o) return sizes_for(model, 1, 0);
    if (!o->room) return sizes_for(model, o->workers, o->flags);
    return sizes_for(model, o->room->sizes.workers,
                     (o->room->sizes.flags & ~(uint32_t)SC_WORKSPACE_ROOM) | SHARES_ROOM);
}

static void lay_out_boxes(const sc_workspace_sizes *s, layout *l, sc_boxes *boxes)
{
    int k;
    for (k = 0; k < 6; k++)
        boxes->side[k] = SC_PLACE(l, (uint64_t)s->patches + SC_BOXES_PADDING, float);
}

static void lay_out_frame(const sc_workspace_sizes *s, layout *l, sc_frame *frame)
{
    int k;
    lay_out_boxes(s, l, &frame->patch_boxes);
    frame->mask = SC_PLACE(l, s->patches, uint16_t);
    frame->prospect = SC_PLACE(l, s->patches, uint32_t);
    if (s->flags & SC_WORKSPACE_STEP) {
        frame->motion.unit = SC_PLACE(l, 8 * (uint64_t)s->vertices, float);
        for (k = 0; k < 2; k++) lay_out_boxes(s, l, &frame->motion.boxes[k]);
        frame->motion.own_points = SC_PLACE(l, s->leaves, uint16_t);
        frame->motion.vertex_groups = SC_PLACE(l, s->vertices, sc_group);
    }
    frame->point_at = SC_PLACE(l, 4 * SC_LEAF_POINTS * (uint64_t)s->leaves, float);
}

/* Bounds of segments, and derived data of leaf clusters in the same place. */
static void lay_out_bounds(const sc_workspace_sizes *s, layout *l, sc_workspace *w)
{
    const uint64_t start = l->at;
    uint64_t end;
    int k;
    w->all_derived = SC_PLACE(l, all_derived(s), sc_leaf_derived);
    end = l->at;
    l->at = start;
    for (k = 0; k < 2; k++) w->bounds.of[k] = SC_PLACE(l, s->segments, sc_segment_bounds);
    if (l->at < end) l->at = end;
    for (k = 0; k < 2; k++) w->bounds.epoch_of[k] = SC_PLACE(l, s->segments, uint16_t);
    w->all_known = SC_PLACE(l, all_derived(s), sc_leaf_known);
}

static void lay_out_plan(const sc_workspace_sizes *s, layout *l, sc_plan_room *plan)
{
    plan->units = (sc_unit *)place(l, 0, sizeof(sc_unit)); /* in the place of parts, less */
    plan->parts = SC_PLACE(l, SC_PARTS_MAX, sc_part);
    plan->tests = SC_PLACE(l, SC_PARTS_MAX, uint32_t);
    plan->open = SC_PLACE(l, SC_PARTS_MAX, uint32_t);
    plan->pairs = SC_PLACE(l, SC_PLAN_PAIRS, sc_pair);
    plan->passed = SC_PLACE(l, SC_PARTS_MAX, uint8_t);
    plan->culled = SC_PLACE(l, s->patches, uint8_t);
}

/* How many points of a contour are listed at most, with what is read beyond. */
static uint64_t listed_points(const sc_workspace_sizes *s)
{
    return ((uint64_t)s->contour / SC_CONTOUR_BLOCK + 3) * SC_CONTOUR_BLOCK +
           (uint64_t)SC_LOOP_PIECES * SC_CONTOUR_GAP;
}

static void lay_out_contour(const sc_workspace_sizes *s, layout *l, sc_contour_edges *c)
{
    const uint64_t listed = listed_points(s);
    uint64_t spans, n;
    int k;
    c->point = SC_PLACE(l, listed, uint32_t);
    for (k = 0; k < 2; k++) c->at[k] = SC_PLACE(l, listed, float);
    for (spans = 0, n = listed / 2; n; n = n > SC_CONTOUR_BLOCK ? (n + 1) / 2 : 0)
        spans += SC_CONTOUR_SPANS(n);
    for (k = 0; k < 4; k++) c->span_side[k] = SC_PLACE(l, spans, float);
    c->is_edge = SC_PLACE(l, listed / SC_CONTOUR_BLOCK + 3, uint16_t);
    c->wall = SC_PLACE(l, listed, float);
}

/* What is written sixteen at a time goes beyond the end. */
enum { BEYOND = 16 };

static void lay_out_lists(const sc_workspace_sizes *s, layout *l, sc_lists *lists)
{
    const uint32_t levels = s->levels + 1;
    uint32_t *room = lists->room;
    uint64_t start, end;
    int k;
    room[SC_LIST_SPANS] = SC_SPANS_MAX;
    room[SC_LIST_STARS] = levels * SC_NODE_CHILDREN;
    room[SC_LIST_FAILED] = levels * (SC_ORIENTED_MAX + levels * SC_NODE_CHILDREN);
    room[SC_LIST_ORIENTED] = SC_ORIENTED_MAX;
    room[SC_LIST_LEFT] = SC_LEFT_MAX;
    room[SC_LIST_PATCHES] = SC_LEFT_MAX + s->levels / 4 * SC_PATCHES_CHILDREN;
    if (room[SC_LIST_PATCHES] < SC_PATCHES_BETWEEN) room[SC_LIST_PATCHES] = SC_PATCHES_BETWEEN;
    room[SC_LIST_ROWS] = SC_ROWS_MAX;
    room[SC_LIST_FAR] = room[SC_LIST_NEAR] = SC_LEAF_LIST_MAX;
    room[SC_LIST_CLUSTERS] = SC_CLUSTERS_MAX;
    room[SC_LIST_TRIANGLES] = SC_TRIANGLES_MAX;
    room[SC_LIST_OPEN] = SC_OPEN_MAX;
    room[SC_LIST_CANDIDATES] = SC_CANDIDATES_MAX;
    room[SC_LIST_NEIGHBORS] = room[SC_LIST_EXACT] = SC_FEW_MAX;
    room[SC_LIST_FACE_ROWS] = SC_FACE_ROWS_MAX;
    room[SC_LIST_EDGE_ROWS] = SC_EDGE_ROWS_MAX;
    room[SC_LIST_FACES] = s->flags & SC_WORKSPACE_NEAR ? SC_NEAR_FACES_MAX : SC_MOVING_MAX;
    room[SC_LIST_EDGES] = s->flags & SC_WORKSPACE_NEAR ? SC_NEAR_EDGES_MAX : SC_MOVING_MAX;
    lists->spans = SC_PLACE(l, room[SC_LIST_SPANS], sc_pair);
    lists->stars = SC_PLACE(l, room[SC_LIST_STARS], uint32_t);
    lists->failed = SC_PLACE(l, room[SC_LIST_FAILED], uint32_t);
    lists->oriented = SC_PLACE(l, room[SC_LIST_ORIENTED], uint32_t);
    lists->left = SC_PLACE(l, room[SC_LIST_LEFT], sc_pair);
    lists->patches = SC_PLACE(l, room[SC_LIST_PATCHES], sc_pair);
    for (k = 0; k < 3; k++) lists->row[k] = SC_PLACE(l, room[SC_LIST_ROWS] + BEYOND, uint32_t);
    for (k = 0; k < 2; k++) {
        lists->far[k] = SC_PLACE(l, room[SC_LIST_FAR] + BEYOND, uint32_t);
        lists->near[k] = SC_PLACE(l, room[SC_LIST_NEAR] + BEYOND, uint32_t);
    }
    lists->clusters = SC_PLACE(l, room[SC_LIST_CLUSTERS], sc_cluster_pair);
    lists->triangles = SC_PLACE(l, 1, sc_triangle_rows);
    lists->open = SC_PLACE(l, 1, sc_open_pairs);
    lists->scratch = SC_PLACE(l, SC_LEAF_LIST_AT_ONCE, uint32_t);
    start = l->at;
    lists->candidates = SC_PLACE(l, room[SC_LIST_CANDIDATES] + BEYOND, sc_pair);
    lists->neighbors = SC_PLACE(l, room[SC_LIST_NEIGHBORS], sc_pair);
    lists->exact = SC_PLACE(l, room[SC_LIST_EXACT], sc_pair);
    end = l->at;
    l->at = start;
    for (k = 0; k < 2; k++) { /* in the same place, less: a step has no use for those */
        lists->moving_rows[k] =
            SC_PLACE(l, room[SC_LIST_FACE_ROWS + k] + (uint64_t)1, sc_moving_row);
        lists->moving[k] = SC_PLACE(l, room[SC_LIST_FACES + k], sc_pair);
    }
    if (l->at < end) l->at = end; /* 6 of 13 kB, for what is near 30 */
}

static void lay_out_last(const sc_workspace_sizes *s, layout *l, sc_last *last)
{
    last->self = SC_PLACE(l, s->patches, uint32_t);
    last->alone = SC_PLACE(l, s->leaves, uint32_t);
    last->culled = last->marks = SC_PLACE(l, s->patches, uint8_t);
}

/* What a worker has besides, for steps. */
static void lay_out_step(const sc_workspace_sizes *s, layout *l, sc_contour_edges *start,
                         sc_step_worker *step)
{
    const uint64_t runs = listed_points(s) / SC_CONTOUR_RUN;
    int k;
    step->kept.some = some_leaves(s, SC_MOTIONS_KEPT);
    step->kept.made = SC_PLACE(l, s->leaves + (uint64_t)SC_MOTIONS_KEPT, uint8_t);
    step->kept.own = SC_PLACE(l, 1 + (uint64_t)step->kept.some, sc_leaf_motion);
    for (k = 0; k < 2; k++) {
        step->found[k] = SC_PLACE(l, SC_FOUND_MAX, sc_pair);
        step->found_time[k] = SC_PLACE(l, SC_FOUND_MAX, double);
        step->contour.at[k] = SC_PLACE(l, listed_points(s), float);
    }
    for (k = 0; k < 4; k++) {
        start->run_side[k] = SC_PLACE(l, runs + 16, float);
        start->group_side[k] = SC_PLACE(l, runs / 16 + 17, float);
        step->contour.run_side[k] = SC_PLACE(l, runs + 16, float);
        step->contour.group_side[k] = SC_PLACE(l, runs / 16 + 17, float);
    }
}

/* And for what is near. */
static void lay_out_near(const sc_workspace_sizes *s, layout *l, sc_near_worker *near)
{
    near->some = some_leaves(s, SC_NEAR_KEPT);
    near->made = SC_PLACE(l, s->leaves + (uint64_t)SC_NEAR_KEPT, uint8_t);
    near->own = SC_PLACE(l, 1 + (uint64_t)near->some, sc_near_leaf);
}

static void lay_out_worker(const sc_workspace_sizes *s, layout *l, sc_worker *worker,
                           sc_step_worker *step, sc_near_worker *near)
{
    memset(worker, 0, sizeof *worker);
    memset(step, 0, sizeof *step);
    memset(near, 0, sizeof *near);
    lay_out_contour(s, l, &worker->contour);
    lay_out_lists(s, l, &worker->lists);
    lay_out_last(s, l, &worker->last);
    worker->kept.some = some_leaves(s, SC_DERIVED_KEPT);
    worker->kept.some_derived = SC_PLACE(l, (uint64_t)worker->kept.some + 1, sc_leaf_derived);
    worker->kept.some_known = SC_PLACE(l, (uint64_t)worker->kept.some + 1, sc_leaf_known);
    worker->kept.slab = SC_PLACE(l, s->leaves, sc_leaf_slab);
    worker->ball.epoch_of = SC_PLACE(l, s->vertices, uint16_t);
    worker->ball.queue = SC_PLACE(l, s->vertices, uint32_t);
    worker->found = SC_PLACE(l, SC_FOUND_MAX, sc_pair);
    if (s->flags & SC_WORKSPACE_STEP) lay_out_step(s, l, &worker->contour, step);
    if (s->flags & SC_WORKSPACE_NEAR) lay_out_near(s, l, near);
}

/* How many workers there are in a room: where workspaces share it, another one for each, that
   serves the second of two objects. */
static uint32_t all_workers(const sc_workspace_sizes *s)
{
    return s->flags & SC_WORKSPACE_ROOM ? 2 * s->workers : s->workers;
}

/* What a pose need not keep. */
static void lay_out_room(const sc_workspace_sizes *s, layout *l, sc_workspace *w)
{
    const int steps = (s->flags & SC_WORKSPACE_STEP) != 0;
    const int near = (s->flags & SC_WORKSPACE_NEAR) != 0;
    const uint32_t workers = all_workers(s);
    sc_worker no_worker;
    sc_step_worker no_step;
    sc_near_worker no_near;
    uint32_t i;
    lay_out_bounds(s, l, w);
    if (s->workers > 1) lay_out_plan(s, l, &w->plan);
    w->worker = SC_PLACE(l, workers, sc_worker);
    if (steps) w->step = SC_PLACE(l, workers, sc_step_worker);
    if (near) w->near = SC_PLACE(l, workers, sc_near_worker);
    for (i = 0; i < workers; i++)
        lay_out_worker(s, l, l->block ? &w->worker[i] : &no_worker,
                       l->block && steps ? &w->step[i] : &no_step,
                       l->block && near ? &w->near[i] : &no_near);
}

/* Places all arrays behind a workspace, or of a workspace that is nowhere; returns its size. */
static uint64_t lay_out(const sc_workspace_sizes *s, unsigned char *block, sc_workspace *w)
{
    layout l;
    l.block = block;
    l.at = 0;
    (void)place(&l, 1, sizeof *w);
    lay_out_frame(s, &l, &w->frame);
    if (!(s->flags & SHARES_ROOM)) lay_out_room(s, &l, w);
    return l.at;
}

uint64_t sc_workspace_bytes(const sc_model *model, const sc_workspace_options *options)
{
    const sc_workspace_sizes sizes = sizes_asked(model, options);
    sc_workspace nowhere;
    return lay_out(&sizes, NULL, &nowhere);
}

/* ---- what is in a new workspace ---- */

/* Boxes behind the last patch are not there: near and overlapping nothing. */
static void clear_boxes(const sc_workspace_sizes *s, const sc_boxes *boxes)
{
    uint64_t i, end = (uint64_t)s->patches + SC_BOXES_PADDING;
    int k;
    for (k = 0; k < 6; k++)
        for (i = 0; i < end; i++) boxes->side[k][i] = k < 3 ? HUGE_VALF : -HUGE_VALF;
}

/* A point belongs to the first leaf cluster that has it; seen is 0 for all points, before and
   after. */
static void find_own_points(const sc_model *model, uint16_t *own_points, uint16_t *seen)
{
    const uint32_t *point = sc_model_leaf_point(model);
    uint32_t leaf, i;
    for (leaf = 0; leaf < model->leaf_count; leaf++, point += SC_LEAF_POINTS) {
        uint32_t own = 0;
        for (i = 0; i < SC_LEAF_POINTS; i++) {
            if (!seen[point[i]]) own |= 1u << i;
            seen[point[i]] = 1;
        }
        own_points[leaf] = (uint16_t)own;
    }
    memset(seen, 0, model->vertex_count * sizeof *seen);
}

/* What is read of the arrays of a worker before it is written. */
static void clear_worker(const sc_workspace_sizes *s, const sc_worker *worker)
{
    /* whole lanes of places and spans are read, with some behind the last that was written */
    unsigned char *places = (unsigned char *)(void *)worker->contour.at[0];
    memset(places, 0, (size_t)((unsigned char *)(void *)worker->contour.is_edge - places));
    memset(worker->lists.open, 0, sizeof *worker->lists.open); /* which are read, too */
    memset(worker->ball.epoch_of, 0, s->vertices * sizeof *worker->ball.epoch_of);
}

/* Nothing is known of what is in the room for all leaf clusters. */
static void forget_derived(const sc_workspace *w)
{
    memset(w->all_known, 0, all_derived(&w->sizes) * sizeof *w->all_known);
}

/* Nor of what is elsewhere in what workspaces may share. */
static void clear_room(const sc_workspace *w)
{
    const sc_workspace_sizes *s = &w->sizes;
    const uint32_t count = all_workers(s);
    uint32_t i;
    forget_derived(w);
    for (i = 0; i < count; i++) {
        const sc_kept_leaves *kept = &w->worker[i].kept;
        memset(kept->some_known, 0, ((size_t)kept->some + 1) * sizeof *kept->some_known);
        memset(kept->slab, 0, s->leaves * sizeof *kept->slab);
    }
}

static void begin_room(sc_workspace *w)
{
    const sc_workspace_sizes *s = &w->sizes;
    uint32_t i;
    int k;
    w->others = w->worker + (all_workers(s) - s->workers);
    for (k = 0; k < 2; k++) memset(w->bounds.epoch_of[k], 0, s->segments * sizeof(uint16_t));
    for (i = 0; i < all_workers(s); i++) {
        w->worker[i].step = w->step ? &w->step[i] : NULL;
        w->worker[i].near = w->near ? &w->near[i] : NULL;
        clear_worker(s, &w->worker[i]);
    }
    clear_room(w);
    w->worker[0].bounds = &w->bounds;
}

/* Has a workspace use the room of another one, which stays where it is. */
static void use_room(sc_workspace *w, sc_workspace *room)
{
    w->room = room;
    w->all_derived = room->all_derived;
    w->all_known = room->all_known;
    w->plan = room->plan;
    w->worker = room->worker;
    w->others = room->others;
    w->step = room->step;
    w->near = room->near;
    w->round = room->rounds;
}

sc_workspace *sc_workspace_place(const sc_model *model, const sc_workspace_options *options,
                                 void *memory)
{
    sc_workspace *w = (sc_workspace *)memory;
    sc_workspace_sizes *s = &w->sizes;
    uint32_t i;
    int k;
    memset(w, 0, sizeof *w);
    w->topology_hash = model->topology_hash;
    *s = sizes_asked(model, options);
    w->bytes = lay_out(s, (unsigned char *)memory, w);
    w->frame.kernels = sc_kernels_for((uint32_t)sc_isa_best());
    clear_boxes(s, &w->frame.patch_boxes);
    memset(w->frame.mask, 0, s->patches * sizeof *w->frame.mask);
    w->room = w;
    if (s->flags & SHARES_ROOM)
        use_room(w, options->room);
    else
        begin_room(w);
    if (!w->step) return w;
    for (k = 0; k < 2; k++) clear_boxes(s, &w->frame.motion.boxes[k]);
    memset(w->frame.motion.unit, 0, 8 * (size_t)s->vertices * sizeof *w->frame.motion.unit);
    if (w->room == w)
        find_own_points(model, w->frame.motion.own_points, w->worker[0].ball.epoch_of);
    else
        for (i = 0; i < s->leaves; i++)
            w->frame.motion.own_points[i] = w->room->frame.motion.own_points[i];
    return w;
}

int sc_workspace_fits(const sc_workspace *w, const sc_model *model)
{
    const sc_workspace_sizes s = sizes_for(model, w->sizes.workers, w->sizes.flags);
    return w->topology_hash == model->topology_hash && memcmp(&s, &w->sizes, sizeof s) == 0;
}

/* ---- queries ---- */

/* Where so many epochs were given out before a call, all that has one is cleared. A call gives out
   two for an object, and there are 2^32. */
enum { EPOCH_MAX = 0x7fffffff };

void sc_workspace_renew(sc_workspace *w, int keeps)
{
    sc_workspace *room = w->room;
    if (room->epochs >= EPOCH_MAX) {
        clear_room(room);
        room->epochs = 0;
        room->rounds++;
    }
    if (keeps && room->spoiled) forget_derived(room);
    room->spoiled = !keeps;
    if (w->round != room->rounds) w->pose_version = 0; /* its epoch may come again */
    w->round = room->rounds;
}

void sc_workspace_forget(sc_workspace *w)
{
    w->frame.epoch = (uint32_t)sc_atomic_add(&w->room->epochs, 1) + 1;
    w->frame.leaves_ready = w->frame.boxes_ready = w->frame.cones_ready = 0;
    w->pose_version = 0;
}

static void begin_step_worker(const sc_step_question *question, sc_step_worker *step)
{
    int k;
    step->question = question;
    step->earliest = 1;
    step->turned = 0;
    for (k = 0; k < 2; k++) step->count[k] = step->found_count[k] = 0;
}

/* Of a question about two objects, the workers that have the second: where both are in one room,
   the others there. */
static sc_worker *seconds_of(const sc_question *question)
{
    return question->one_room ? question->second->others : question->second->worker;
}

/* A worker for a question that a workspace is asked, or that it is the second object of: nothing
   waits, nothing is found. */
static sc_worker *begin_worker(const sc_model *model, sc_workspace *workspace,
                               const sc_question *question, sc_share *share, uint32_t worker)
{
    sc_worker *w = &workspace->worker[worker], *second = w;
    if (question->second) {
        second = &seconds_of(question)[worker];
        if (workspace == question->second) w = second;
    }
    w->second = second;
    w->model = model;
    w->frame = &workspace->frame;
    w->question = question;
    w->hooks = &workspace->hooks;
    w->share = share;
    sc_kept_leaves_some(&w->kept);
    memset(w->lists.count, 0, sizeof w->lists.count);
    w->last.culled = w->last.marks;
    w->last.self_count = w->last.alone_count = w->last.self_first = w->last.self_end = 0;
    w->ball.center = SC_NONE;
    w->found_count = 0;
    w->count = 0;
    w->stop = w->incomplete = 0;
    w->task = SC_TASK_UPDATE_BOXES;
    w->last_time = 0;
    w->follow_part = 0;
    memset(&w->stats, 0, sizeof w->stats);
    if (question->step) begin_step_worker(question->step, w->step);
    return w;
}

/* Which of so many parts of a room a worker has: where both of two objects are in one room, half of
   it for each. */
typedef struct room_part {
    uint32_t part, parts;
} room_part;

static room_part part_of_room(const sc_workspace *w, const sc_question *q, uint32_t part,
                              uint32_t parts)
{
    room_part p;
    p.part = q->one_room ? 2 * part + (w == q->second) : part;
    p.parts = q->one_room ? 2 * parts : parts;
    return p;
}

/* How many leaf clusters each of so many workers may keep, of so many bytes each, in the room of
   derived data of leaf clusters in queries, and of their points, unless it is shared; which starts
   at *room. And the same as a power of two, in *kept. */
static uint64_t room_for_each(const sc_workspace *w, uint32_t workers, size_t bytes, void **room,
                              uint32_t *kept)
{
    const unsigned char *end =
        (const unsigned char *)(const void *)(w->all_derived + all_derived(&w->sizes));
    uint64_t count;
    *room = sc_workspace_is_shared(w) ? (void *)w->all_derived : (void *)w->frame.point_at;
    count = (uint64_t)(end - (const unsigned char *)*room) / bytes / workers;
    for (*kept = 1; *kept <= count / 2;) *kept *= 2;
    return count;
}

/* Lets a worker keep leaf clusters for a step, in one of so many parts of that room or in its own,
   and forget those of the last step. */
static void keep_motions(const sc_workspace *w, sc_kept_motions *motions, room_part p)
{
    void *room;
    uint32_t kept;
    const uint64_t count = room_for_each(w, p.parts, sizeof(sc_leaf_motion), &room, &kept);
    motions->leaves = (sc_leaf_motion *)room + p.part * count;
    motions->mask = count >= w->sizes.leaves ? SC_KEEPS_ALL : kept - 1;
    if (count < w->sizes.leaves && kept <= motions->some) {
        motions->leaves = motions->own + 1;
        motions->mask = motions->some - 1;
    }
    memset(motions->made, 0, w->sizes.leaves + (size_t)SC_MOTIONS_KEPT);
}

/* The same for what is near, of which there never is room for all: it takes more bytes than the
   points and the derived data of a leaf cluster. */
static void keep_near(const sc_workspace *w, sc_near_worker *near, room_part p)
{
    void *room;
    uint32_t kept;
    const uint64_t count = room_for_each(w, p.parts, sizeof(sc_near_leaf), &room, &kept);
    near->leaves = (sc_near_leaf *)room + p.part * count;
    near->mask = kept - 1;
    if (kept <= near->some) {
        near->leaves = near->own + 1;
        near->mask = near->some - 1;
    }
    memset(near->made, 0, w->sizes.leaves + (size_t)SC_NEAR_KEPT);
}

/* Of steps and of what is near. */
static void keep_leaves(const sc_workspace *w, const sc_question *question, sc_worker *worker,
                        room_part p)
{
    if (question->near)
        keep_near(w, worker->near, p);
    else if (question->step)
        keep_motions(w, &worker->step->kept, p);
}

/* Gives a worker a part of the room for all leaf clusters, if that is more than it has by itself.
 */
static void keep_part(const sc_workspace *w, sc_kept_leaves *some, room_part p)
{
    const uint32_t room = all_derived(&w->sizes) / p.parts;
    const uint64_t first = (uint64_t)p.part * room;
    uint32_t kept = 1;
    while (2 * kept < room) kept *= 2; /* and one place more */
    if (kept > some->some)
        sc_kept_leaves_in(some, w->all_derived + first, w->all_known + first, kept);
}

/* The same, or all of it. */
static void keep_derived(const sc_workspace *w, sc_kept_leaves *kept, room_part p)
{
    if (p.parts > 1)
        keep_part(w, kept, p);
    else if (all_derived(&w->sizes))
        sc_kept_leaves_in(kept, w->all_derived, w->all_known, SC_KEEPS_ALL);
}

sc_worker *sc_workspace_begin(const sc_model *model, sc_workspace *workspace,
                              const sc_question *question)
{
    sc_workspace_renew(workspace, 0);
    sc_workspace_forget(workspace);
    return sc_workspace_resume(model, workspace, question);
}

sc_worker *sc_workspace_resume(const sc_model *model, sc_workspace *workspace,
                               const sc_question *question)
{
    sc_worker *w = begin_worker(model, workspace, question, NULL, 0);
    keep_leaves(workspace, question, w, part_of_room(workspace, question, 0, 1));
    return w;
}

void sc_workspace_share(const sc_model *model, sc_workspace *workspace, const sc_question *question,
                        sc_share *share, uint32_t workers)
{
    sc_worker *first = &workspace->worker[0];
    const int keeps_all = first->kept.derived != first->kept.some_derived;
    const uint32_t task = first->task;
    const uint64_t last_time = first->last_time;
    const sc_stats stats = first->stats;
    uint32_t i;
    for (i = 0; i < workers; i++) {
        sc_worker *w = begin_worker(model, workspace, question, share, i);
        const room_part p = part_of_room(workspace, question, i, workers);
        if (keeps_all) keep_part(workspace, &w->kept, p);
        keep_leaves(workspace, question, w, p);
    }
    first->task = task;
    first->last_time = last_time;
    first->stats = stats;
}

sc_worker *sc_workspace_join(const sc_model *model, sc_workspace *w, const sc_question *question,
                             sc_share *share, uint32_t worker, uint32_t part, uint32_t parts)
{
    sc_worker *one = begin_worker(model, w, question, share, worker);
    const room_part p = part_of_room(w, question, part, parts);
    keep_derived(w, &one->kept, p);
    keep_leaves(w, question, one, p);
    return one;
}

void sc_workspace_lend(const sc_model *model, sc_workspace *w, const sc_question *question,
                       uint32_t workers)
{
    uint32_t i;
    for (i = 0; i < workers; i++) (void)sc_workspace_join(model, w, question, NULL, i, i, workers);
}

void sc_workspace_keep_all(sc_workspace *w)
{
    sc_worker *first = &w->worker[0];
    keep_derived(w, &first->kept, part_of_room(w, first->question, 0, 1));
}

sc_pair *sc_workspace_spare(const sc_workspace *w, uint64_t *count)
{
    const uint64_t derived = all_derived(&w->sizes) * (uint64_t)sizeof(sc_leaf_derived);
    const uint64_t points = 4 * SC_LEAF_POINTS * sizeof(float) * (uint64_t)w->sizes.leaves;
    *count = (derived ? derived : points) / sizeof(sc_pair);
    return derived ? (sc_pair *)(void *)w->all_derived : (sc_pair *)(void *)w->frame.point_at;
}
