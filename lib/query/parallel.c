/*
 * One query by several of the host's threads. See parallel.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * The large nodes at the top of the test tree are opened one after the other by the calling thread;
 * their contour tests are a job, again and again, since what fails leads to further large nodes.
 * What hangs below is a list of parts, each of which a worker walks through by itself, with a
 * state, a stack and scratch of its own. The list depends on the model and the pose only. As with
 * one thread, nodes of one patch, and leaf clusters by themselves, wait until all others are done:
 * which patches were culled by then is the union of what workers wrote down.
 *
 * No locks: a worker writes to what is its own, and to parts of the caller's array that it claims
 * by an atomic addition, for many pairs at a time. What is left in the end goes behind them.
 */
#include "query/parallel.h"

#include <string.h>

#include "base/assume.h"
#include "base/atomic.h"
#include "base/bits.h"
#include "base/jobs.h"
#include "query/filter.h"
#include "query/pairs.h"
#include "query/query_kernels.h"
#include "query/traversal.h"

typedef char state_fits[sizeof(sc_query_state) <= SC_STATE_ROOM ? 1 : -1];

/* Models with fewer leaf clusters are not worth a job. */
enum { LEAVES_MIN = 128 };

/* A patch with more than one of so many leaf clusters is large: in a node of the test tree; in a
   pair of patches, most of which turn out to have little in common, so that listing smaller ones
   takes longer than it saves; and against itself, which is as much work as there are leaf clusters,
   so that no part that is left for the end takes long. */
enum { LARGE_IN_NODE = 32, LARGE_IN_PAIR = 16, LARGE_BY_ITSELF = 128 };

/* Fewer contour tests are not worth a job. */
enum { TESTS_MIN = 16 };

/* How many waiting nodes, and leaf clusters by themselves, a worker takes at once. */
enum { NODES_AT_ONCE = 16, ALONE_AT_ONCE = 64 };

/* More pairs of leaf clusters or of triangles are not kept waiting from one part to the next. */
enum { WAITING_MAX = 64 };

enum {
    PART_BELOW, /* a: a node that failed a test */
    PART_TEST,  /* a: a node that passed the orientation test */
    PART_PAIR,  /* a, b: patches of a level whose boxes overlap */
    PART_PAIR_AFTER_CONTOUR,
    PART_PATCH, /* a: a patch against itself, by boxes */
    PART_NODES  /* a to b - 1: nodes, all of which are taken as colliding */
};

/* A query that is shared out. */
typedef struct plan {
    sc_query_state *state; /* of the calling thread, and the sums in the end */
    sc_workspace *w;
    const sc_tasks *tasks;
    sc_share share;
    sc_filter filter;                            /* the caller's without its function */
    uint32_t part_count, test_count, open_count; /* of those in w->parts, tests and open */
    uint32_t last_end[SC_WORKERS_MAX]; /* parts that were left for the end by workers up to each */
    uint32_t alone_count[SC_WORKERS_MAX]; /* leaf clusters that each has listed by then */
    sc_jobs_ranges ranges;                /* of the job at hand */
} plan;

const sc_tasks *sc_parallel_tasks(const sc_query_state *state)
{
    const sc_tasks *tasks = state->options.tasks;
    if (!tasks || tasks->workers < 2 || state->model->leaf_count < LEAVES_MIN) return NULL;
    return tasks;
}

int sc_parallel_pays(const sc_query_state *state)
{
    const sc_query_options *o = &state->options;
    if (!SC_ATOMIC || !sc_parallel_tasks(state) || o->budget) return 0;
    if (o->method == SC_METHOD_SCTT && o->contour != SC_CONTOUR_EXACT) return 0;
    /* the caller's function is asked of all pairs afterwards */
    return !(state->filter && state->filter->accept) ||
           (o->output == SC_OUTPUT_PAIRS && state->capacity);
}

static sc_query_state *state_of(const plan *p, uint32_t worker)
{
    return (sc_query_state *)(void *)sc_workspace_of_worker(p->w, worker)->state;
}

/* ---- jobs ---- */

static void empty_walk(sc_walk *walk)
{
    walk->stack_count = walk->queue_count = walk->self_count = walk->alone_count = 0;
    walk->pair_count[0] = walk->pair_count[1] = 0;
}

static void start_workers(plan *p)
{
    const sc_model *model = p->state->model;
    uint32_t worker;
    sc_workspace_share(model, p->w, p->tasks->workers);
    for (worker = 0; worker < p->tasks->workers; worker++) {
        sc_query_state *s = state_of(p, worker);
        sc_walk *walk;
        *s = *p->state;
        s->workspace = sc_workspace_of_worker(p->w, worker);
        if (s->filter) s->filter = &p->filter;
        memset(&s->stats, 0, sizeof s->stats);
        walk = &s->workspace->walk;
        walk->culled = p->w->culled;
        memset(walk->marks, 0, model->patch_end);
        walk->selfs_wait = 1;
        empty_walk(walk);
    }
    memset(p->w->culled, 0, model->patch_end);
}

/* A worker begins and ends a part; its clock stands still between parts. */
static sc_query_state *begin_part(const plan *p, uint32_t worker)
{
    sc_query_state *s = state_of(p, worker);
    s->task = p->state->task;
    if (s->timed) s->last_time = sc_clock_nanoseconds();
    return s;
}

/* What waits to be compared or decided goes on waiting if it is little, unless the first hit ends
   the query: many at once take less time. */
static void end_part(sc_query_state *s)
{
    const sc_workspace *w = s->workspace;
    const uint32_t most = s->options.output == SC_OUTPUT_ANY ? 0 : WAITING_MAX;
    if (w->near_count + w->far_count > most || w->candidate_count > most ||
        w->neighbor_count > most)
        sc_candidates_decide(s);
    if (s->timed) s->stats.nanoseconds[s->task] += sc_clock_nanoseconds() - s->last_time;
}

/* Runs a job; some: of parts that are taken some at once. The calling thread's clock stands still:
   what workers do is in their own statistics. */
static void run_job(plan *p, void (*run)(void *context, uint32_t part, uint32_t worker),
                    uint32_t count, int some)
{
    sc_query_state *state = p->state;
    if (!count) return;
    sc_jobs_divide(p->tasks, count, &p->ranges);
    if (some) count = sc_jobs_takes(&p->ranges);
    if (state->timed)
        state->stats.nanoseconds[state->task] += sc_clock_nanoseconds() - state->last_time;
    if (count == 1)
        run(p, 0, 0);
    else
        p->tasks->finish(p->tasks->user, p->tasks->enqueue(p->tasks->user, run, p, count));
    if (state->timed) state->last_time = sc_clock_nanoseconds();
}

static uint32_t divide_up(uint32_t count, uint32_t by)
{
    return count / by + (count % by != 0);
}

/* Does a part; nodes wait in the worker's walk. */
static void run_part(sc_query_state *s, const sc_part *part)
{
    sc_walk *walk = &s->workspace->walk;
    sc_pair pair;
    switch (part->kind) {
    case PART_BELOW:
        walk->stack[walk->stack_count++] = part->a;
        break;
    case PART_TEST:
        walk->queue[walk->queue_count++] = part->a;
        break;
    case PART_NODES:
        sc_traversal_take_nodes(s, part->a, part->b);
        break;
    case PART_PATCH:
        sc_traversal_follow_contour(s, 0);
        pair.a = pair.b = part->a;
        s->workspace->kernels->query->patch_pairs(s, &pair, 1);
        break;
    default:
        sc_traversal_follow_contour(s, part->kind == PART_PAIR_AFTER_CONTOUR);
        pair.a = part->a;
        pair.b = part->b;
        s->workspace->kernels->query->patch_pairs(s, &pair, 1);
    }
}

/* Some parts, whose nodes wait in the walk together: contour tests take less time when there are
   many. */
static void run_parts(void *context, uint32_t part, uint32_t worker)
{
    plan *p = (plan *)context;
    sc_query_state *s = begin_part(p, worker);
    uint32_t some;
    part = sc_jobs_take_some(&p->ranges, worker, &some);
    while (some-- && !sc_state_stops(s)) run_part(s, &p->w->parts[part + some]);
    sc_traversal_walk(s);
    if (sc_jobs_are_taken(&p->ranges)) sc_candidates_decide(s);
    end_part(s);
}

/* A part is what waits with one worker, whoever does it. */
static void run_waiting(void *context, uint32_t part, uint32_t worker)
{
    const plan *p = (const plan *)context;
    sc_query_state *s = begin_part(p, part);
    (void)worker;
    sc_candidates_decide(s);
    end_part(s);
}

/* Decides all that waits, or drops it if the query is to end: the next one begins with nothing.
   Mostly workers have done so when they saw that no part was left. */
static void do_waiting(plan *p)
{
    uint32_t worker, waits = 0;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        const sc_workspace *w = sc_workspace_of_worker(p->w, worker);
        waits |= w->near_count | w->far_count | w->candidate_count | w->neighbor_count;
    }
    if (waits) run_job(p, run_waiting, p->tasks->workers, 0);
}

/* Empties the list of parts. Nothing goes on waiting: the calling thread goes on with the workspace
   of the first worker, and would count what waits there as its own, after a contour test or not. */
static void do_parts(plan *p)
{
    run_job(p, run_parts, p->part_count, 1);
    p->part_count = 0;
    do_waiting(p);
}

static void add_part(plan *p, uint32_t kind, uint32_t a, uint32_t b)
{
    sc_part *part;
    if (p->part_count == SC_PARTS_MAX) do_parts(p);
    part = &p->w->parts[p->part_count++];
    part->kind = kind;
    part->a = a;
    part->b = b;
}

/* ---- boxes ---- */

/* Boxes must be there before workers need them. */
static void update_boxes(plan *p)
{
    uint32_t worker;
    sc_traversal_update_boxes(p->state);
    for (worker = 1; worker < p->tasks->workers; worker++)
        sc_workspace_of_worker(p->w, worker)->leaves_ready =
            sc_workspace_of_worker(p->w, worker)->boxes_ready = 1;
}

static int is_large(const sc_model *model, uint32_t patch, uint32_t parts)
{
    const uint32_t *leaf = sc_model_leaf(model);
    return leaf[patch + 1] - leaf[patch] > model->leaf_count / parts;
}

/* Two patches of a level whose boxes overlap, as sc_query_kernels.patch_pairs has them. If one is
   large, their children: level by level, where one thread goes to the fourth level below at once,
   from which as many as 256 pairs come. */
static void add_patches(plan *p, uint32_t a, uint32_t b)
{
    sc_query_state *state = p->state;
    const sc_model *model = state->model;
    const sc_boxes *boxes = &p->w->patch_boxes;
    const uint32_t *child = sc_model_child(model);
    uint32_t c, d, task = sc_state_box_task(state);
    if (!is_large(model, a, LARGE_IN_PAIR) && !is_large(model, b, LARGE_IN_PAIR)) {
        add_part(p, state->after_contour ? PART_PAIR_AFTER_CONTOUR : PART_PAIR, a, b);
        return;
    }
    state->stats.counts[task]++;
    for (c = child[a]; c < child[a + 1]; c++) {
        if (!sc_boxes_overlap(boxes, b, boxes, c)) continue;
        state->stats.counts[task]++;
        for (d = child[b]; d < child[b + 1]; d++)
            if (sc_boxes_overlap(boxes, c, boxes, d)) add_patches(p, c, d);
    }
}

/* A patch against itself. */
static void add_patch(plan *p, uint32_t a)
{
    sc_query_state *state = p->state;
    const sc_boxes *boxes = &p->w->patch_boxes;
    const uint32_t *child = sc_model_child(state->model);
    uint32_t c, d;
    if (!is_large(state->model, a, LARGE_BY_ITSELF)) {
        add_part(p, PART_PATCH, a, 0);
        return;
    }
    for (c = child[a]; c < child[a + 1]; c++) {
        state->stats.counts[SC_TASK_BOXES_ORIENTATION]++;
        add_patch(p, c);
        for (d = c + 1; d < child[a + 1]; d++)
            if (sc_boxes_overlap(boxes, c, boxes, d)) add_patches(p, c, d);
    }
}

static int is_large_node(const sc_model *model, uint32_t node)
{
    const sc_pair *patches = &sc_model_node(model)[node].patches;
    return is_large(model, patches->a, LARGE_IN_NODE) || is_large(model, patches->b, LARGE_IN_NODE);
}

/* The BVTT children of a large node, which has no leaf clusters of its own. */
static void add_boxes_of_node(plan *p, uint32_t node)
{
    sc_query_state *state = p->state;
    const sc_boxes *boxes = &p->w->patch_boxes;
    const sc_node *n = sc_model_node(state->model) + node;
    uint32_t bits, previous;
    previous = sc_state_switch(state, sc_state_box_task(state));
    for (bits = sc_node_boxes(n); bits; bits &= bits - 1) {
        const sc_pair pair = sc_model_pair(state->model, n, sc_bits_lowest(bits));
        state->stats.counts[sc_state_box_task(state)]++;
        if (sc_boxes_overlap(boxes, pair.a, boxes, pair.b)) add_patches(p, pair.b, pair.a);
    }
    sc_state_switch(state, previous);
}

/* ---- the walk with the exact contour test ---- */

/* The pairs of patches that wait in the walk of the calling thread, and nothing else does. */
static void sort_out_pairs(plan *p)
{
    const sc_boxes *boxes = &p->w->patch_boxes;
    sc_walk *walk = &p->w->walk;
    sc_pair pairs[SC_WALK_PAIRS];
    int after_contour;
    for (after_contour = 0; after_contour < 2; after_contour++) {
        uint32_t i, count = walk->pair_count[after_contour], previous;
        if (!count) continue;
        memcpy(pairs, walk->pairs[after_contour], count * sizeof *pairs);
        walk->pair_count[after_contour] = 0;
        update_boxes(p);
        sc_traversal_follow_contour(p->state, after_contour);
        previous = sc_state_switch(p->state, sc_state_box_task(p->state));
        p->state->stats.counts[sc_state_box_task(p->state)] += count;
        for (i = 0; i < count; i++) {
            if (!sc_boxes_overlap(boxes, pairs[i].a, boxes, pairs[i].b)) continue;
            if (pairs[i].a == pairs[i].b)
                add_patch(p, pairs[i].a);
            else
                add_patches(p, pairs[i].a, pairs[i].b);
        }
        sc_state_switch(p->state, previous);
    }
}

/* What waits in the walk of the calling thread: what is large is opened or tested next, the rest
   are parts. There is room for those of nodes, as a job of parts would go on with that walk. Last
   things first: so the first child is opened first, and parts come about as leaf clusters are
   numbered. Then each worker finds in its part of the list what it did of the pose. Of open nodes
   there are no more than that: those that failed a test, SC_PARTS_MAX at most, are opened into
   nodes to test, as what has a direction in common still has below, but for one of two patches in
   place of one that has one patch; and before any test they are brothers on the way to one node,
   four at each level at most. */
static void sort_out(plan *p)
{
    const sc_model *model = p->state->model;
    sc_walk *walk = &p->w->walk;
    uint32_t i;
    for (i = walk->stack_count; i-- > 0;) {
        if (is_large_node(model, walk->stack[i]) && SC_ALWAYS(p->open_count < SC_PARTS_MAX))
            p->w->open[p->open_count++] = walk->stack[i];
        else
            add_part(p, PART_BELOW, walk->stack[i], 0);
    }
    for (i = 0; i < walk->queue_count; i++) {
        if (is_large_node(model, walk->queue[i]) && p->test_count < SC_PARTS_MAX)
            p->w->tests[p->test_count++] = walk->queue[i];
        else
            add_part(p, PART_TEST, walk->queue[i], 0);
    }
    walk->stack_count = walk->queue_count = 0;
    sort_out_pairs(p);
}

/* Opens large nodes that failed, and those that fail below them. */
static void open_nodes(plan *p)
{
    while (p->open_count && !sc_state_stops(p->state)) {
        update_boxes(p);
        if (p->part_count > SC_PARTS_MAX - 2 * SC_WALK_CHILDREN) do_parts(p);
        sc_traversal_open(p->state, p->w->open[--p->open_count]);
        sort_out(p);
    }
}

/* Lists the large nodes of one patch that wait, and drops all that are culled by now. No level has
   as many large patches as LARGE_IN_NODE, and there are SC_DEPTH_MAX levels at most: the list has
   room. */
static void list_selfs(plan *p)
{
    const sc_node *nodes = sc_model_node(p->state->model);
    sc_walk *walk = &p->w->walk;
    uint32_t i, kept = 0;
    for (i = 0; i < walk->self_count; i++) {
        uint32_t node = walk->self[i];
        if (p->w->culled[nodes[node].patches.a]) continue;
        if (is_large_node(p->state->model, node) && SC_ALWAYS(p->test_count < SC_PARTS_MAX))
            p->w->tests[p->test_count++] = node;
        else
            walk->self[kept++] = node;
    }
    walk->self_count = kept;
}

static void run_tests(void *context, uint32_t part, uint32_t worker)
{
    const plan *p = (const plan *)context;
    sc_query_state *s = begin_part(p, worker);
    sc_traversal_test(s, &p->w->tests[part], 1, &p->w->passed[part]);
    end_part(s);
}

/* The contour tests of all listed nodes, while none is open. */
static void do_tests(plan *p)
{
    const sc_node *nodes = sc_model_node(p->state->model);
    uint32_t i;
    if (p->test_count < TESTS_MIN)
        sc_traversal_test(p->state, p->w->tests, p->test_count, p->w->passed);
    else
        run_job(p, run_tests, p->test_count, 0);
    for (i = p->test_count; i-- > 0;) {
        uint32_t node = p->w->tests[i];
        if (p->w->passed[i])
            p->w->culled[nodes[node].patches.a] = p->w->culled[nodes[node].patches.b] = 1;
        else
            p->w->open[p->open_count++] = node;
    }
    p->test_count = 0;
}

/* Brings together what the workers wrote down of patches that are culled. */
static void join_marks(plan *p)
{
    uint8_t *culled = p->w->culled;
    uint32_t worker, i, end = p->state->model->patch_end;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        const uint8_t *marks = sc_workspace_of_worker(p->w, worker)->walk.marks;
        for (i = 0; i < end; i++) culled[i] |= marks[i];
    }
}

/* What waited with a worker until all else was done: a part is some nodes of one patch, of which
   those are tested that are not culled by now; or some leaf clusters to be looked at by
   themselves. */
static void run_last(void *context, uint32_t part, uint32_t worker)
{
    plan *p = (plan *)context;
    const sc_node *nodes = sc_model_node(p->state->model);
    sc_query_state *s = begin_part(p, worker);
    sc_walk *walk = &s->workspace->walk;
    const sc_walk *from;
    uint32_t i, end, k = 0, listed;
    part = sc_jobs_take(&p->ranges, part, worker);
    while (part >= p->last_end[k]) k++;
    part -= k ? p->last_end[k - 1] : 0;
    from = &sc_workspace_of_worker(p->w, k)->walk;
    listed = divide_up(from->self_count, NODES_AT_ONCE);
    walk->selfs_wait = 0;
    if (part < listed) {
        const uint32_t before = walk->alone_count;
        i = part * NODES_AT_ONCE;
        end = from->self_count - i < NODES_AT_ONCE ? from->self_count : i + NODES_AT_ONCE;
        for (; i < end && !sc_state_stops(s); i++)
            if (!walk->culled[nodes[from->self[i]].patches.a])
                walk->queue[walk->queue_count++] = from->self[i];
        sc_traversal_walk(s);
        sc_traversal_take_alone(s, walk->alone + before, walk->alone_count - before);
    } else {
        i = (part - listed) * ALONE_AT_ONCE;
        end = p->alone_count[k] - i < ALONE_AT_ONCE ? p->alone_count[k] : i + ALONE_AT_ONCE;
        sc_traversal_take_alone(s, from->alone + i, end - i);
    }
    if (sc_jobs_are_taken(&p->ranges)) sc_candidates_decide(s);
    end_part(s);
}

/* Those of one worker are behind each other, so that mostly it does them. */
static void do_last(plan *p)
{
    uint32_t worker, count = 0;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        const sc_walk *walk = &sc_workspace_of_worker(p->w, worker)->walk;
        p->alone_count[worker] = walk->alone_count;
        count += divide_up(walk->self_count, NODES_AT_ONCE);
        count += divide_up(walk->alone_count, ALONE_AT_ONCE);
        p->last_end[worker] = count;
    }
    run_job(p, run_last, count, 0);
}

static void walk_exact(plan *p)
{
    sc_traversal_find_prospects(p->state);
    sc_traversal_orient(p->state, 0);
    sort_out(p);
    for (;;) {
        open_nodes(p);
        if (!p->test_count) list_selfs(p);
        if (!p->test_count || sc_state_stops(p->state)) break;
        do_tests(p);
    }
    do_parts(p);
    join_marks(p);
    if (!sc_state_stops(p->state)) do_last(p);
}

/* ---- the other methods ---- */

static void walk_nodes(plan *p)
{
    const sc_model *model = p->state->model;
    uint32_t node = 0, step;
    sc_state_switch(p->state, SC_TASK_BOXES_ORIENTATION);
    update_boxes(p);
    /* the last node of all is of single leaf clusters, which are not large */
    for (; SC_ALWAYS(node < model->node_count) && is_large_node(model, node); node++) {
        p->state->stats.nodes_visited++;
        add_boxes_of_node(p, node);
    }
    step = divide_up(model->node_count - node, SC_PARTS_MAX / 4);
    for (; node < model->node_count; node += step)
        add_part(p, PART_NODES, node,
                 model->node_count - node < step ? model->node_count : node + step);
    do_parts(p);
}

static void walk_boxes(plan *p)
{
    update_boxes(p);
    sc_state_switch(p->state, SC_TASK_BOXES_ORIENTATION);
    add_patch(p, 0);
    do_parts(p);
}

/* ---- all together ---- */

/* Adds up what the workers counted, and puts the last of their pairs into the caller's array.
   Returns 0 if that is too short. */
static int gather(plan *p)
{
    sc_query_state *state = p->state;
    uint64_t at = p->share.claimed;
    uint32_t worker, i;
    for (worker = 0; worker < p->tasks->workers; worker++) {
        const sc_query_state *s = state_of(p, worker);
        sc_workspace *w = s->workspace;
        for (i = 0; i < SC_TASK_COUNT; i++) {
            state->stats.counts[i] += s->stats.counts[i];
            state->stats.nanoseconds[i] += s->stats.nanoseconds[i];
        }
        state->stats.nodes_visited += s->stats.nodes_visited;
        state->stats.nodes_oriented += s->stats.nodes_oriented;
        state->stats.nodes_culled += s->stats.nodes_culled;
        state->stats.leaf_pairs += s->stats.leaf_pairs;
        state->stats.exact_fallbacks += s->stats.exact_fallbacks;
        state->incomplete |= s->incomplete;
        state->count += s->count;
        if (w->found_count && at <= state->capacity && w->found_count <= state->capacity - at)
            memcpy(state->pairs + at, w->found, sizeof(sc_pair) * w->found_count);
        at += w->found_count;
        w->found_count = 0;
    }
    return at <= state->capacity;
}

/* Pairs of the sorted list that the caller's function wants. */
static void ask_function(sc_query_state *state)
{
    const sc_filter *f = state->filter;
    uint64_t i, kept = 0;
    for (i = 0; i < state->count; i++)
        if (f->accept(f->accept_user, state->pairs[i].a, state->pairs[i].b))
            state->pairs[kept++] = state->pairs[i];
    state->count = kept;
}

void sc_parallel_run(sc_query_state *state)
{
    sc_query_state before = *state;
    sc_walk *walk = &state->workspace->walk;
    plan p;
    int fits;
    memset(&p, 0, sizeof p);
    p.state = state;
    p.w = state->workspace;
    p.tasks = state->options.tasks;
    state->share = &p.share;
    if (state->filter) {
        p.filter = *state->filter;
        p.filter.accept = NULL;
    }
    start_workers(&p);
    if (state->options.method == SC_METHOD_SCTT) {
        sc_traversal_update_normals(state);
        walk_exact(&p);
    } else if (state->options.method == SC_METHOD_AABB_SCTT) {
        walk_nodes(&p);
    } else {
        walk_boxes(&p);
    }
    do_waiting(&p);
    fits = gather(&p);
    state->share = NULL;
    walk->culled = walk->marks; /* as one thread has it */
    walk->selfs_wait = 0;
    empty_walk(walk);
    if (!fits) {
        *state = before;
        state->workspace->boxes_ready = 0;
        if (state->timed) state->last_time = sc_clock_nanoseconds();
        sc_traversal_run(state);
        sc_pairs_finish(state, NULL);
        return;
    }
    sc_pairs_finish(state, p.tasks);
    if (state->filter && state->filter->accept) ask_function(state);
}
