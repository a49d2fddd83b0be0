/*
 * The query of one step by several of the host's threads. See step_parallel.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The test tree is taken level by level: first nodes of two patches, then those of one, which are
 * left out if one of two that has their patch was culled. One thread, which goes deep first, comes
 * to a node of one patch after all nodes of two that have it, and these are all of its level: so it
 * is the same nodes that are left out. The nodes of a level are one job, or two; what they leave to
 * boxes, with the narrow phase, is one more when all levels are done. The pairs of large patches
 * are split up by the calling thread, to a list of parts which is done in that job, too, or when it
 * is full. The plain tree is nothing but such a list.
 *
 * No locks: see run/parallel.c.
 */
#include "run/step_parallel.h"

#include <string.h>

#include "base/atomic.h"
#include "base/bits.h"
#include "base/jobs.h"
#include "step/step_candidates.h"
#include "step/step_kernels.h"
#include "step/step_motion.h"
#include "step/step_pairs.h"
#include "step/step_traversal.h"

/* Models with fewer leaf clusters are not worth a job. */
enum { STEP_MODEL_MIN = 128 };

/* Patches with more than one of so many leaf clusters are large. */
enum { STEP_LARGE_PART = 64 };

/* Fewer nodes to look at are not worth a job. */
enum { STEP_NODES_MIN = 16 };

/* The nodes of a level are cut into so many parts at most, with so many to look at in each, more or
   less; parts of the list are taken a few at once. */
enum { STEP_NODE_PARTS = 256, STEP_NODES_AT_ONCE = 8, STEP_PARTS_AT_ONCE = 2 };

/* For what nodes leave to boxes, the nodes of the first level with so many patches, each with all
   that is below, and those above it are cut into so many parts at most. */
enum { STEP_SUBTREES_MIN = 512, STEP_REST_PARTS = 1024 };

/* What sc_plan_room.reached says of a node; 0: its parent was not opened. */
enum {
    REACHED_TEST = 1,   /* it is to be tested */
    REACHED_FAILED = 2, /* it has the contour of its parent, which failed */
    REACHED_OPEN = 3,   /* it is large and was opened; its boxes are left */
    REACHED_REST = 4    /* it was opened; its boxes and leaf clusters are left */
};

enum { STEP_PART_PAIR, STEP_PART_PAIR_AFTER_CONTOUR, STEP_PART_PATCH };

/* A step that is shared out. */
typedef struct step_plan {
    sc_workspace *workspace;
    sc_plan_room *room;
    sc_worker *w; /* the first, as which the calling thread plans, and the sums in the end */
    const sc_tasks *tasks;
    sc_step_share share;
    uint32_t part_count;         /* of those in room */
    uint32_t first, end, length; /* nodes of a level, and of a part */
    uint32_t roots; /* the first node that is done with all below it, see STEP_SUBTREES_MIN */
    sc_jobs_ranges ranges; /* of the job at hand */
    int selfs;             /* of these, those of one patch; else those of two */
} step_plan;

const sc_tasks *sc_step_parallel_tasks(const sc_model *model, const sc_step_question *question)
{
    const sc_tasks *tasks = question->options.tasks;
    if (!tasks || tasks->workers < 2 || model->leaf_count < STEP_MODEL_MIN) return NULL;
    return tasks;
}

int sc_step_parallel_pays(const sc_model *model, const sc_step_question *question)
{
    return SC_ATOMIC && sc_step_parallel_tasks(model, question) && !question->options.budget;
}

/* ---- jobs ---- */

static void start_step_workers(step_plan *p)
{
    const sc_model *model = p->w->model;
    uint32_t i;
    sc_workspace_share_step(model, p->workspace, &p->share, p->tasks->workers);
    for (i = 0; i < p->tasks->workers; i++)
        memset(p->workspace->worker[i].last.marks, 0, model->patch_end);
    memset(p->room->culled, 0, model->patch_end);
    memset(p->room->reached, 0, model->node_count);
}

/* A worker begins and ends a part; its clock stands still between parts. */
static sc_worker *begin_step_part(const step_plan *p, uint32_t worker)
{
    sc_worker *w = &p->workspace->worker[worker];
    w->task = p->w->task;
    if (w->question->timed) w->last_time = sc_clock_nanoseconds();
    return w;
}

static void end_step_part(sc_worker *w)
{
    sc_step_candidates_decide(w);
    if (w->question->timed) w->stats.nanoseconds[w->task] += sc_clock_nanoseconds() - w->last_time;
}

/* Runs a job. The calling thread's clock stands still: what workers do is in their own
   statistics. */
static void run_step_job(step_plan *p, void (*run)(void *context, uint32_t part, uint32_t worker),
                         uint32_t count)
{
    sc_worker *w = p->w;
    if (!count) return;
    sc_jobs_divide(p->tasks->workers, count, &p->ranges);
    if (w->question->timed) w->stats.nanoseconds[w->task] += sc_clock_nanoseconds() - w->last_time;
    if (count == 1)
        run(p, 0, 0);
    else
        p->tasks->finish(p->tasks->user, p->tasks->enqueue(p->tasks->user, run, p, count));
    if (w->question->timed) w->last_time = sc_clock_nanoseconds();
}

static void do_step_part(sc_worker *s, const sc_part *part)
{
    const sc_step_kernels *kernels = s->frame->kernels->step;
    sc_step_traversal_follow_contour(s, part->list == STEP_PART_PAIR_AFTER_CONTOUR);
    sc_worker_switch(s, sc_step_box_task(s));
    if (part->list == STEP_PART_PATCH)
        kernels->patch_itself(s, part->a);
    else
        kernels->patch_pair(s, part->a, part->b);
}

/* So many parts the list is. */
static uint32_t listed_parts(const step_plan *p)
{
    return (p->part_count + STEP_PARTS_AT_ONCE - 1) / STEP_PARTS_AT_ONCE;
}

/* What a node leaves, and if it is a root or below one, what all below it leave, which one thread
   does in this order, too. A large node has left its boxes to the list already, but not what is
   below it: in an uneven tree of the caller's such nodes may be anywhere. */
static void take_rests(const step_plan *p, sc_worker *s, uint32_t node)
{
    const sc_node *n = sc_model_node(s->model) + node;
    const uint32_t end = sc_node_end(n), left = p->room->reached[node];
    uint32_t c;
    if (left != REACHED_REST && left != REACHED_OPEN) return;
    for (c = node < p->roots ? end : n->child; c < end; c++) take_rests(p, s, c);
    if (left == REACHED_REST) sc_step_traversal_query_rest(s, node);
}

/* Some of the list, or behind that what some nodes leave. */
static void run_step_parts(void *context, uint32_t part, uint32_t worker)
{
    step_plan *p = (step_plan *)context;
    sc_worker *s = begin_step_part(p, worker);
    const uint32_t listed = listed_parts(p);
    uint32_t i, node;
    part = sc_jobs_take(&p->ranges, part, worker);
    if (part < listed) {
        for (i = part * STEP_PARTS_AT_ONCE; i < (part + 1) * STEP_PARTS_AT_ONCE; i++)
            if (i < p->part_count && !sc_worker_stops(s)) do_step_part(s, &p->room->parts[i]);
    } else {
        node = (part - listed) * p->length;
        for (i = node; i < p->end && i < node + p->length; i++) take_rests(p, s, i);
    }
    end_step_part(s);
}

/* Empties the list of parts. */
static void do_step_parts(step_plan *p)
{
    run_step_job(p, run_step_parts, listed_parts(p));
    p->part_count = 0;
}

static void add_step_part(step_plan *p, uint32_t kind, uint32_t a, uint32_t b)
{
    sc_part *part;
    if (p->part_count == SC_PARTS_MAX) do_step_parts(p);
    part = &p->room->parts[p->part_count++];
    part->list = kind;
    part->a = a;
    part->b = b;
}

/* ---- boxes ---- */

static int is_large_in_step(const sc_model *model, uint32_t patch)
{
    const uint32_t *leaf = sc_model_leaf(model);
    return leaf[patch + 1] - leaf[patch] > model->leaf_count / STEP_LARGE_PART;
}

/* Two patches of a level that are near each other: those of them that are large as by
   sc_step_kernels.patch_pair. */
static void add_step_patches(step_plan *p, uint32_t a, uint32_t b, int after_contour)
{
    sc_worker *w = p->w;
    const sc_motion *motion = &w->frame->motion;
    const uint32_t *hop = sc_model_hop(w->model);
    const uint32_t task = after_contour ? SC_TASK_BOXES_CONTOUR : SC_TASK_BOXES_ORIENTATION;
    uint32_t c, d;
    if (!is_large_in_step(w->model, a) && !is_large_in_step(w->model, b)) {
        add_step_part(p, after_contour ? STEP_PART_PAIR_AFTER_CONTOUR : STEP_PART_PAIR, a, b);
        return;
    }
    w->stats.counts[task]++;
    for (c = hop[a]; c < hop[a + 1] && !sc_worker_stops(w); c++) {
        if (sc_motion_boxes_apart(motion, b, c)) continue;
        w->stats.counts[task]++;
        for (d = hop[b]; d < hop[b + 1]; d++)
            if (!sc_motion_boxes_apart(motion, c, d)) add_step_patches(p, c, d, after_contour);
    }
}

/* The same for sc_step_kernels.patch_itself. */
static void add_step_patch(step_plan *p, uint32_t a)
{
    sc_worker *w = p->w;
    const sc_motion *motion = &w->frame->motion;
    const uint32_t *hop = sc_model_hop(w->model);
    uint32_t c, d;
    if (!is_large_in_step(w->model, a)) {
        add_step_part(p, STEP_PART_PATCH, a, 0);
        return;
    }
    for (c = hop[a]; c < hop[a + 1] && !sc_worker_stops(w); c++) {
        w->stats.counts[SC_TASK_BOXES_ORIENTATION]++;
        add_step_patch(p, c);
        for (d = c + 1; d < hop[a + 1]; d++)
            if (!sc_motion_boxes_apart(motion, c, d)) add_step_patches(p, c, d, 0);
    }
}

/* What large nodes of a level leave to boxes; such nodes have no leaf clusters of their own. */
static void add_boxes_of_level(step_plan *p)
{
    sc_worker *w = p->w;
    uint32_t node, bits, previous;
    for (node = p->first; node < p->end && !sc_worker_stops(w); node++) {
        const sc_node *n = sc_model_node(w->model) + node;
        const int after_contour = sc_step_traversal_mask(w, node) != 0;
        if (p->room->reached[node] != REACHED_OPEN) continue;
        sc_step_traversal_follow_contour(w, after_contour);
        previous = sc_worker_switch(w, sc_step_box_task(w));
        for (bits = sc_node_boxes(n); bits; bits &= bits - 1) {
            const sc_pair pair = sc_model_pair(w->model, n, sc_bits_lowest(bits));
            w->stats.counts[sc_step_box_task(w)]++;
            if (!sc_motion_boxes_apart(&w->frame->motion, pair.a, pair.b))
                add_step_patches(p, pair.a, pair.b, after_contour);
        }
        sc_worker_switch(w, previous);
    }
}

/* ---- the test tree ---- */

/* A node that failed: its children are reached. Boxes are left for later, when all levels are done:
   some nodes leave much more than others, and then no level has to wait for these. But where the
   first pair ends the step, they are done at once, unless there are too many. */
static void open_step_node(const step_plan *p, sc_worker *s, uint32_t node)
{
    const sc_model *model = s->model;
    const sc_node *nodes = sc_model_node(model), *n = nodes + node;
    const uint32_t end = sc_node_end(n);
    int failed = p->selfs && sc_step_traversal_mask(s, node);
    uint32_t c;
    for (c = n->child; c < end; c++) {
        int is_pair = nodes[c].patches.a != nodes[c].patches.b;
        p->room->reached[c] = failed && is_pair ? REACHED_FAILED : REACHED_TEST;
        s->step->reached[is_pair]++;
    }
    if (is_large_in_step(model, n->patches.a) || is_large_in_step(model, n->patches.b)) {
        p->room->reached[node] = REACHED_OPEN;
        s->step->large++;
    } else if (s->step->question->options.output != SC_OUTPUT_ANY) {
        p->room->reached[node] = REACHED_REST;
    } else {
        sc_step_traversal_query_rest(s, node);
    }
}

/* The first node from one on that was reached, or the end: mostly few are, so eight are looked at
   together. */
static uint32_t next_reached(const uint8_t *reached, uint32_t node, uint32_t end)
{
    uint64_t eight;
    for (; end - node >= sizeof eight; node += (uint32_t)sizeof eight) {
        memcpy(&eight, reached + node, sizeof eight);
        if (eight) break;
    }
    while (node < end && !reached[node]) node++;
    return node;
}

static void run_step_nodes(void *context, uint32_t part, uint32_t worker)
{
    step_plan *p = (step_plan *)context;
    sc_worker *s = begin_step_part(p, worker);
    const sc_node *nodes = sc_model_node(s->model);
    uint8_t *reached = p->room->reached, *marks = s->last.marks;
    uint32_t first = p->first + sc_jobs_take(&p->ranges, part, worker) * p->length, node;
    uint32_t end = p->end - first < p->length ? p->end : first + p->length;
    for (node = first; node < end && !sc_worker_stops(s); node++) {
        uint32_t a, b;
        node = next_reached(reached, node, end);
        if (node == end) break;
        a = nodes[node].patches.a;
        b = nodes[node].patches.b;
        if ((a == b) != p->selfs || (p->selfs && p->room->culled[a])) continue;
        if (sc_step_traversal_culls(s, node, reached[node] == REACHED_FAILED))
            marks[a] = marks[b] = 1;
        else
            open_step_node(p, s, node);
    }
    end_step_part(s);
}

/* Takes the nodes of the level that are of one patch, or of two: so many were reached. */
static void do_nodes(step_plan *p, int selfs, uint32_t reached)
{
    uint32_t count = p->end - p->first, parts;
    if (!reached || sc_worker_stops(p->w)) return;
    p->selfs = selfs;
    parts = reached < STEP_NODES_MIN ? 1 : reached / STEP_NODES_AT_ONCE;
    p->length = (count - 1) / (parts < STEP_NODE_PARTS ? parts : STEP_NODE_PARTS) + 1;
    run_step_job(p, run_step_nodes, (count - 1) / p->length + 1);
}

/* Brings together which patches of the level, all of which are in nodes of two, the workers
   culled. */
static void join_marks_of_level(step_plan *p, uint32_t level)
{
    const uint32_t *level_first = sc_model_level_first(p->w->model);
    uint32_t worker, i;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        const uint8_t *marks = p->workspace->worker[worker].last.marks;
        for (i = level_first[level]; i < level_first[level + 1]; i++)
            p->room->culled[i] |= marks[i];
    }
}

/* How many nodes of one patch, or of two, the workers have reached, and how many large ones they
   opened; they begin to count again. */
static uint32_t take_reached(const step_plan *p, int is_pair)
{
    uint32_t worker, sum = 0;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        sum += p->workspace->step[worker].reached[is_pair];
        p->workspace->step[worker].reached[is_pair] = 0;
    }
    return sum;
}

static uint32_t take_large(const step_plan *p)
{
    uint32_t worker, sum = 0;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        sum += p->workspace->step[worker].large;
        p->workspace->step[worker].large = 0;
    }
    return sum;
}

static void walk_levels(step_plan *p)
{
    const sc_model *model = p->w->model;
    uint32_t level, end = 1, reached[2] = {1, 0}, few = 1; /* levels so far have few patches */
    p->room->reached[0] = REACHED_TEST;
    p->end = 1;
    for (level = 0; reached[0] + reached[1] && !sc_worker_stops(p->w); level++) {
        do_nodes(p, 0, reached[1]);
        if (reached[1]) join_marks_of_level(p, level);
        do_nodes(p, 1, reached[0]);
        reached[0] = take_reached(p, 0);
        reached[1] = take_reached(p, 1);
        if (!level && reached[0]) sc_step_traversal_refit(p->w); /* the root is large */
        if (take_large(p)) add_boxes_of_level(p);
        if (few) {
            p->roots = p->first;
            end = p->end;
        }
        few &= sc_model_patches(model, level) < STEP_SUBTREES_MIN;
        p->first = p->end;
        p->end = sc_model_node(model)[p->end].child;
    }
    if (sc_worker_stops(p->w)) return;
    p->end = end;
    p->length = (end - 1) / STEP_REST_PARTS + 1;
    run_step_job(p, run_step_parts, listed_parts(p) + (end - 1) / p->length + 1);
    p->part_count = 0;
}

/* ---- all together ---- */

/* Adds up what the workers counted, and puts the last of their pairs into the caller's lists.
   Returns 0 if one of these is too short. */
static int gather_step(step_plan *p)
{
    const sc_step_list *list = p->w->step->question->list;
    sc_worker *sum = p->w;
    uint32_t i, k;
    int fits = 1, kind;
    for (i = 0; i < p->tasks->workers; i++) {
        const sc_worker *w = &p->workspace->worker[i];
        const sc_step_worker *step = w->step;
        for (kind = 0; kind < 2; kind++) {
            const uint64_t at = p->share.claimed[kind];
            const uint32_t count = step->found_count[kind];
            if (at <= list[kind].capacity && count && count <= list[kind].capacity - at) {
                memcpy(list[kind].pairs + at, step->found[kind], sizeof(sc_pair) * count);
                if (list[kind].times)
                    memcpy(list[kind].times + at, step->found_time[kind], sizeof(double) * count);
            }
            p->share.claimed[kind] += count;
        }
        if (w == sum) continue;
        for (k = 0; k < SC_TASK_COUNT; k++) {
            sum->stats.counts[k] += w->stats.counts[k];
            sum->stats.nanoseconds[k] += w->stats.nanoseconds[k];
        }
        sum->stats.nodes_visited += w->stats.nodes_visited;
        sum->stats.nodes_oriented += w->stats.nodes_oriented;
        sum->stats.nodes_culled += w->stats.nodes_culled;
        sum->stats.leaf_pairs += w->stats.leaf_pairs;
        sum->incomplete |= w->incomplete;
        if (step->earliest < sum->step->earliest) sum->step->earliest = step->earliest;
        for (kind = 0; kind < 2; kind++) sum->step->count[kind] += step->count[kind];
    }
    for (kind = 0; kind < 2; kind++) fits &= p->share.claimed[kind] <= list[kind].capacity;
    return fits;
}

void sc_step_parallel_run(sc_workspace *workspace)
{
    sc_worker *w = &workspace->worker[0];
    const sc_step_question *question = w->step->question;
    const sc_stats before = w->stats;
    step_plan p;
    memset(&p, 0, sizeof p);
    p.workspace = workspace;
    p.room = &workspace->plan;
    p.w = w;
    p.tasks = question->options.tasks;
    w->frame->motion.swept = question->options.method == SC_STEP_METHOD_SWEPT;
    start_step_workers(&p);
    if (question->options.method == SC_STEP_METHOD_SCTT) {
        sc_step_traversal_update_cones(w);
        walk_levels(&p);
    } else {
        sc_worker_switch(w, SC_TASK_BOXES_ORIENTATION);
        sc_step_traversal_refit(w);
        add_step_patch(&p, 0);
        do_step_parts(&p);
    }
    if (gather_step(&p)) {
        sc_step_pairs_finish(question, w->step->count, p.tasks);
        return;
    }
    sc_workspace_begin_step(w->model, workspace, question);
    w->stats = before;
    if (question->query.timed) w->last_time = sc_clock_nanoseconds();
    sc_step_traversal_run(w);
    sc_step_pairs_finish(question, w->step->count, NULL);
}
