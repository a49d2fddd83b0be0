/*
 * One query by one worker or several. See plan.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * One worker begins with the root of the test tree, or of the tree of boxes, and runs until nothing
 * waits. For several, the calling thread opens what is large first, by the same stages as the first
 * of them; contour tests of large nodes are a job, again and again, since what fails leads to
 * further large nodes. What hangs below is a list of parts, items of the lists that each worker has
 * (query/lists.h), and depends on the model and the pose only. Nodes of one patch wait until all
 * that hangs below their ancestors is done, level by level, and leaf clusters by themselves until
 * all others are: which patches were culled by then is the union of what workers wrote down.
 *
 * No locks: a worker writes to what is its own, and to parts of the caller's array that it claims
 * by an atomic addition, for many pairs at a time. What is left in the end goes behind them.
 */
#include "run/plan.h"

#include <string.h>

#include "base/assume.h"
#include "base/atomic.h"
#include "base/hooks.h"
#include "base/jobs.h"
#include "near/near_candidates.h"
#include "pose/dnc.h"
#include "query/culling.h"
#include "query/pairs.h"
#include "run/runner.h"
#include "step/step_filter.h"
#include "step/step_motion.h"
#include "step/step_pairs.h"

/* Models with fewer leaf clusters are not worth a job. */
enum { LEAVES_MIN = 128 };

/* A patch with more than one of so many leaf clusters is large: in a node of the test tree; in a
   pair of patches, most of which turn out to have little in common, so that listing smaller ones
   takes longer than it saves; and against itself, which is as much work as there are leaf clusters,
   so that no part that is left for the end takes long. */
enum { LARGE_IN_NODE = 32, LARGE_IN_PAIR = 16, LARGE_BY_ITSELF = 128 };

/* Patches of so many leaf clusters are small as a pair in any model: opening them leads to leaf
   clusters, which the calling thread would compare while the others wait. */
enum { SMALL_PAIR = 128 };

/* Fewer contour tests are not worth a job. */
enum { TESTS_MIN = 16 };

/* How many waiting nodes, and leaf clusters by themselves, a worker takes at once. */
enum { NODES_AT_ONCE = SC_NODES_AT_ONCE, ALONE_AT_ONCE = 64 };

/* More items are not kept waiting from one part to the next. */
enum { WAITING_MAX = 64 };

/* What opening one large node, or one large pair of patches, adds to the list of parts at most. */
enum { PARTS_OF_ONE = SC_PATCHES_CHILDREN + 2 * SC_NODE_CHILDREN };

typedef struct plan {
    sc_workspace *workspace;
    sc_plan_room *room;
    sc_worker *w;          /* the first of them, who plans, and has the sums in the end */
    const sc_tasks *tasks; /* of two workers or more, or NULL: of one */
    uint32_t workers;
    sc_share share;
    sc_question question;                                    /* with this filter: */
    sc_filter filter;                                        /* the caller's without its function */
    uint32_t part_count, test_count, open_count, pair_count; /* of those in room */
    uint32_t last_end[SC_WORKERS_MAX]; /* parts that were left for the end by workers up to each */
    sc_jobs_ranges ranges;             /* of the job at hand */
} plan;

const sc_tasks *sc_plan_tasks(const sc_model *model, const sc_question *question)
{
    const sc_tasks *tasks = question->options.tasks;
    if (!tasks || tasks->workers < 2 || model->leaf_count < LEAVES_MIN) return NULL;
    return tasks;
}

/* Those that share in all of it. */
static const sc_tasks *tasks_for(const sc_model *model, const sc_question *question)
{
    const sc_query_options *o = &question->options;
    if (!SC_ATOMIC || o->budget) return NULL;
    if (o->method == SC_METHOD_SCTT && o->contour != SC_CONTOUR_EXACT) return NULL;
    /* the caller's function is asked of all pairs afterwards */
    if (question->filter && question->filter->accept &&
        !(o->output == SC_OUTPUT_PAIRS && question->capacity))
        return NULL;
    if (question->step && !sc_step_filter_allows_workers(question->step)) return NULL;
    if (question->near && sc_near_candidates_need_one_worker(question->near)) return NULL;
    return sc_plan_tasks(model, question);
}

/* ---- jobs ---- */

/* A worker begins and ends a part; its clock stands still between parts. */
static sc_worker *begin_part(const plan *p, uint32_t worker)
{
    sc_worker *w = &p->w[worker];
    if (p->question.timed) w->last_time = sc_clock_nanoseconds();
    return w;
}

static void stop_clock(sc_worker *w)
{
    if (w->question->timed) w->stats.nanoseconds[w->task] += sc_clock_nanoseconds() - w->last_time;
}

/* What waits goes on waiting if it is little and parts are left, unless the first hit ends the
   query: many at once take less time. */
static void end_part(sc_worker *w, int is_last)
{
    sc_runner_run(w, is_last || w->question->ends_early || sc_runner_waiting(w) > WAITING_MAX);
    stop_clock(w);
}

/* Runs a job; some: of parts that are taken some at once. The calling thread's clock stands still:
   what workers do is in their own statistics. */
static void run_job(plan *p, void (*run)(void *context, uint32_t part, uint32_t worker),
                    uint32_t count, int some)
{
    uint32_t part;
    if (!count) return;
    sc_jobs_divide(p->workers, count, &p->ranges);
    if (some) count = sc_jobs_takes(&p->ranges);
    stop_clock(p->w);
    if (count == 1 || !p->tasks)
        for (part = 0; part < count; part++) run(p, part, 0);
    else
        p->tasks->finish(p->tasks->user, p->tasks->enqueue(p->tasks->user, run, p, count));
    if (p->question.timed) p->w->last_time = sc_clock_nanoseconds();
}

static uint32_t divide_up(uint32_t count, uint32_t by)
{
    return count / by + (count % by != 0);
}

/* ---- the list of parts ---- */

/* Puts a part into the list that it is an item of. */
static void take_part(sc_worker *w, const sc_part *part)
{
    sc_lists *l = &w->lists;
    const uint32_t at = l->count[part->list]++;
    sc_pair *pairs = part->list == SC_LIST_SPANS ? l->spans : l->patches;
    uint32_t *nodes = part->list == SC_LIST_FAILED ? l->failed : l->oriented;
    if (part->list == SC_LIST_SPANS || part->list == SC_LIST_PATCHES) {
        pairs[at].a = part->a;
        pairs[at].b = part->b;
    } else {
        nodes[at] = part->a;
    }
}

/* Some parts, whose nodes wait in lists together: contour tests take less time when there are
   many. */
static void run_parts(void *context, uint32_t part, uint32_t worker)
{
    plan *p = (plan *)context;
    sc_worker *w = begin_part(p, worker);
    uint32_t some;
    part = sc_jobs_take_some(&p->ranges, worker, &some);
    while (some-- && !sc_worker_stops(w)) take_part(w, &p->room->parts[part + some]);
    end_part(w, sc_jobs_are_taken(&p->ranges));
}

/* A part is what waits with one worker, whoever does it. */
static void run_waiting(void *context, uint32_t part, uint32_t worker)
{
    const plan *p = (const plan *)context;
    (void)worker;
    end_part(begin_part(p, part), 1);
}

/* Does all that waits. Mostly workers have done so when they saw that no part was left. */
static void do_waiting(plan *p)
{
    uint32_t i, k, waits = 0;
    for (i = 0; i < p->workers; i++)
        for (k = 0; k < SC_LIST_COUNT; k++) waits |= p->w[i].lists.count[k];
    if (waits) run_job(p, run_waiting, p->workers, 0);
}

/* Empties the list of parts. */
static void do_parts(plan *p)
{
    run_job(p, run_parts, p->part_count, 1);
    p->part_count = 0;
    do_waiting(p);
}

static void add_part(plan *p, sc_list_id list, uint32_t a, uint32_t b)
{
    sc_part *part = &p->room->parts[p->part_count++];
    part->list = list;
    part->a = a;
    part->b = b;
}

/* ---- what is large ---- */

static int is_large(const sc_model *model, uint32_t patch, uint32_t parts)
{
    return sc_model_leaves_of(model, patch) > model->leaf_count / parts;
}

static int is_large_node(const sc_model *model, uint32_t node)
{
    const sc_pair *patches = &sc_model_node(model)[node].patches;
    return is_large(model, patches->a, LARGE_IN_NODE) || is_large(model, patches->b, LARGE_IN_NODE);
}

static int is_large_pair(const sc_worker *w, sc_pair item)
{
    const sc_model *model = w->model, *other = w->second->model;
    const uint32_t a = item.a & SC_ITEM, b = item.b;
    if (sc_model_leaves_of(model, a) <= SMALL_PAIR && sc_model_leaves_of(other, b) <= SMALL_PAIR)
        return 0;
    if (a == b && !sc_worker_is_between(w)) return is_large(model, a, LARGE_BY_ITSELF);
    return is_large(model, a, LARGE_IN_PAIR) || is_large(other, b, LARGE_IN_PAIR);
}

/* Takes what waits in lists of the first worker: what is large is opened or tested next, the rest
   are parts. Last things first: so the first child is opened first, and parts come about as leaf
   clusters are numbered. Then each worker finds in its part of the list what it did of the pose. Of
   open nodes there are no more than there is room for: those that failed a test, SC_PARTS_MAX at
   most, are opened into nodes to test, as what has a direction in common still has below, but for
   one of two patches in place of one that has one patch; and before any test they are brothers on
   the way to one node, four at each level at most. Pairs are opened before the next node, and each
   large patch of one adds 31 pairs at most where one in sixteen below it is large as well: there is
   room for all unless a dozen such lines of patches lie side by side. */
static void sort_out(plan *p)
{
    const sc_model *model = p->w->model;
    sc_lists *l = &p->w->lists;
    uint32_t *count = l->count, i;
    if (count[SC_LIST_LEFT]) {
        sc_runner_make_boxes(p->w);
        sc_worker_switch(p->w, SC_TASK_BOXES_ORIENTATION);
        sc_runner_run_stage(p->w, SC_LIST_LEFT, SC_LEFT_MAX);
    }
    for (i = count[SC_LIST_FAILED]; i-- > 0;) {
        if (is_large_node(model, l->failed[i]) && SC_ALWAYS(p->open_count < SC_PARTS_MAX))
            p->room->open[p->open_count++] = l->failed[i];
        else
            add_part(p, SC_LIST_FAILED, l->failed[i], 0);
    }
    for (i = 0; i < count[SC_LIST_ORIENTED]; i++) {
        if (is_large_node(model, l->oriented[i]) && p->test_count < SC_PARTS_MAX)
            p->room->tests[p->test_count++] = l->oriented[i];
        else
            add_part(p, SC_LIST_ORIENTED, l->oriented[i], 0);
    }
    for (i = 0; i < count[SC_LIST_PATCHES]; i++) {
        if (is_large_pair(p->w, l->patches[i]) && !SC_HARDLY(p->pair_count == SC_PLAN_PAIRS))
            p->room->pairs[p->pair_count++] = l->patches[i];
        else
            add_part(p, SC_LIST_PATCHES, l->patches[i].a, l->patches[i].b);
    }
    count[SC_LIST_FAILED] = count[SC_LIST_ORIENTED] = count[SC_LIST_PATCHES] = 0;
}

/* Opens large pairs of patches, and large nodes that failed, and those that fail below them. */
static void open_large(plan *p)
{
    sc_lists *l = &p->w->lists;
    for (;;) {
        sort_out(p);
        sc_runner_run(p->w, 0); /* leaf clusters, if there are any so near the root */
        if (p->part_count > SC_PARTS_MAX - PARTS_OF_ONE) do_parts(p);
        if (sc_worker_stops(p->w)) return;
        if (p->pair_count) {
            l->patches[l->count[SC_LIST_PATCHES]++] = p->room->pairs[--p->pair_count];
            sc_worker_switch(p->w, SC_TASK_BOXES_ORIENTATION);
            sc_runner_run_stage(p->w, SC_LIST_PATCHES, 1);
        } else if (p->open_count) {
            sc_runner_make_boxes(p->w); /* before workers need them */
            l->failed[l->count[SC_LIST_FAILED]++] = p->room->open[--p->open_count];
            sc_worker_switch(p->w, SC_TASK_ORIENTATION);
            sc_runner_run_stage(p->w, SC_LIST_FAILED, 1);
        } else {
            return;
        }
    }
}

/* Lists the large nodes of one patch that wait, and drops all that are culled by now. No level has
   as many large patches as LARGE_IN_NODE, and there are SC_DEPTH_MAX levels at most: the list has
   room. */
static void list_selfs(plan *p)
{
    const sc_node *nodes = sc_model_node(p->w->model);
    sc_last *last = &p->w->last;
    uint32_t i, kept = 0;
    for (i = 0; i < last->self_count; i++) {
        uint32_t node = last->self[i];
        if (last->culled[nodes[node].patches.a]) continue;
        if (is_large_node(p->w->model, node) && SC_ALWAYS(p->test_count < SC_PARTS_MAX))
            p->room->tests[p->test_count++] = node;
        else
            last->self[kept++] = node;
    }
    last->self_count = kept;
}

static void run_tests(void *context, uint32_t part, uint32_t worker)
{
    const plan *p = (const plan *)context;
    sc_worker *w = begin_part(p, worker);
    sc_culling_test_all(w, &p->room->tests[part], 1, &p->room->passed[part]);
    stop_clock(w);
}

/* The contour tests of all listed nodes, while none is open. */
static void do_tests(plan *p)
{
    const sc_node *nodes = sc_model_node(p->w->model);
    uint8_t *culled = p->w->last.culled;
    uint32_t i;
    if (p->test_count < TESTS_MIN)
        sc_culling_test_all(p->w, p->room->tests, p->test_count, p->room->passed);
    else
        run_job(p, run_tests, p->test_count, 0);
    for (i = p->test_count; i-- > 0;) {
        uint32_t node = p->room->tests[i];
        if (!p->room->passed[i])
            p->room->open[p->open_count++] = node;
        else
            culled[nodes[node].patches.a] = culled[nodes[node].patches.b] = 1;
    }
    p->test_count = 0;
}

/* ---- what comes last ---- */

/* Brings together what the workers wrote down of patches that are culled. */
static void join_marks(plan *p)
{
    uint8_t *culled = p->room->culled;
    uint32_t worker, i, end = p->w->model->patch_end;
    for (worker = 0; p->tasks && worker < p->workers; worker++) {
        const uint8_t *marks = p->w[worker].last.marks;
        for (i = 0; i < end; i++) culled[i] |= marks[i];
    }
}

/* Of which worker a part was left for the end, and where it begins there. */
static const sc_last *find_last(plan *p, uint32_t *part, uint32_t worker)
{
    uint32_t k = 0;
    *part = sc_jobs_take(&p->ranges, *part, worker);
    while (*part >= p->last_end[k]) k++;
    *part -= k ? p->last_end[k - 1] : 0;
    return &p->w[k].last;
}

/* Some nodes of one patch, of which those are tested that are not culled by now. */
static void run_selfs(void *context, uint32_t part, uint32_t worker)
{
    plan *p = (plan *)context;
    const sc_node *nodes = sc_model_node(p->w->model);
    sc_worker *w = begin_part(p, worker);
    sc_lists *l = &w->lists;
    const sc_last *last = find_last(p, &part, worker);
    uint32_t i = last->self_first + part * NODES_AT_ONCE;
    const uint32_t end = last->self_end - i < NODES_AT_ONCE ? last->self_end : i + NODES_AT_ONCE;
    for (; i < end; i++)
        if (!w->last.culled[nodes[last->self[i]].patches.a])
            l->oriented[l->count[SC_LIST_ORIENTED]++] = last->self[i];
    end_part(w, sc_jobs_are_taken(&p->ranges));
}

/* Some leaf clusters to be looked at by themselves, but those that are culled with others. */
static void run_alone(void *context, uint32_t part, uint32_t worker)
{
    plan *p = (plan *)context;
    sc_worker *w = begin_part(p, worker);
    const uint8_t *culled = w->last.culled + sc_model_first_leaf_patch(w->model);
    sc_lists *l = &w->lists;
    const sc_last *last = find_last(p, &part, worker);
    uint32_t i = part * ALONE_AT_ONCE;
    const uint32_t end =
        last->alone_count - i < ALONE_AT_ONCE ? last->alone_count : i + ALONE_AT_ONCE;
    for (; i < end; i++) {
        const uint32_t item = last->alone[i], at = l->count[SC_LIST_NEAR];
        if (culled[item & SC_ITEM]) continue;
        l->near[0][at] = item;
        l->near[1][at] = SC_NONE;
        l->count[SC_LIST_NEAR]++;
    }
    end_part(w, sc_jobs_are_taken(&p->ranges));
}

/* Nodes of one patch that wait with workers, level by level: when those of a level are tested, all
   nodes of two patches that could cull one of them have been, as they hang below its ancestors. So
   which are culled does not depend on who does what. Parts of one worker are behind each other, so
   that mostly it does them. */
static void do_selfs(plan *p)
{
    uint32_t i, count = 1;
    while (count && !sc_worker_stops(p->w)) {
        join_marks(p);
        for (count = i = 0; i < p->workers; i++) {
            sc_last *last = &p->w[i].last;
            last->self_first = last->self_end;
            last->self_end = last->self_count;
            count += divide_up(last->self_end - last->self_first, NODES_AT_ONCE);
            p->last_end[i] = count;
        }
        run_job(p, run_selfs, count, 0);
        do_waiting(p);
    }
}

/* The same for leaf clusters by themselves, which lead to nothing further. */
static void do_alone(plan *p)
{
    uint32_t i, count = 0;
    if (sc_worker_stops(p->w)) return;
    join_marks(p);
    for (i = 0; i < p->workers; i++) {
        count += divide_up(p->w[i].last.alone_count, ALONE_AT_ONCE);
        p->last_end[i] = count;
    }
    run_job(p, run_alone, count, 0);
    do_waiting(p);
}

/* ---- the methods ---- */

static void walk_exact(plan *p)
{
    if (sc_culling_weighs_prospects(p->w)) sc_culling_find_prospects(p->w);
    sc_culling_orient(p->w, 0);
    while (p->tasks) {
        open_large(p);
        if (!p->test_count) list_selfs(p);
        if (!p->test_count || sc_worker_stops(p->w)) break;
        do_tests(p);
    }
    do_parts(p);
    do_selfs(p);
}

static void walk_stars(plan *p)
{
    p->w->lists.stars[p->w->lists.count[SC_LIST_STARS]++] = 0;
    do_parts(p);
}

static void add_span(sc_worker *w, uint32_t first, uint32_t end)
{
    sc_pair *span = &w->lists.spans[w->lists.count[SC_LIST_SPANS]++];
    span->a = first;
    span->b = end;
}

static void walk_nodes(plan *p)
{
    const sc_model *model = p->w->model;
    uint32_t node = 0, step;
    sc_runner_make_boxes(p->w); /* before workers need them */
    if (!p->tasks) add_span(p->w, 0, model->node_count);
    /* the last node of all is of single leaf clusters, which are not large */
    for (; p->tasks && SC_ALWAYS(node < model->node_count) && is_large_node(model, node); node++) {
        add_span(p->w, node, node + 1);
        sc_runner_run_stage(p->w, SC_LIST_SPANS, 1);
        open_large(p);
    }
    /* more parts cost more than they even out */
    step = divide_up(model->node_count - node, (SC_PARTS_MAX - p->part_count) / 4);
    for (; p->tasks && node < model->node_count; node += step)
        add_part(p, SC_LIST_SPANS, node,
                 model->node_count - node < step ? model->node_count : node + step);
    do_parts(p);
}

/* The root against itself, or the roots of two objects. */
static void add_roots(plan *p)
{
    sc_pair *root = &p->w->lists.patches[p->w->lists.count[SC_LIST_PATCHES]++];
    root->a = root->b = 0;
}

static void walk_boxes(plan *p)
{
    sc_runner_make_boxes(p->w);
    add_roots(p);
    if (p->tasks) open_large(p);
    do_parts(p);
}

/* Nothing is wanted of all that is fewer edges of the mesh apart, whatever else is asked. */
static uint32_t rings_left_out(const sc_question *question)
{
    const sc_step_question *step = question->step;
    const sc_near_options *near = question->near ? &question->near->options : NULL;
    const uint32_t by_masks = near && near->masks ? near->masks->rings : 0;
    const int kinds = near ? (int)near->kinds : SC_NEAR_BOTH;
    uint32_t rings = UINT32_MAX;
    int k;
    if (step->options.contour != SC_CONTOUR_EXACT) return 0;
    for (k = 0; k < 2; k++) {
        uint32_t of_kind = step->filters.of[k].ignore_rings;
        if (kinds == (k == SC_STEP_VERTEX_FACE ? SC_NEAR_EDGE_EDGE : SC_NEAR_VERTEX_FACE)) continue;
        of_kind = of_kind > by_masks ? of_kind : by_masks;
        rings = of_kind < rings ? of_kind : rings;
    }
    return rings;
}

static void make_cones(sc_worker *w)
{
    if (w->frame->cones_ready) return;
    w->frame->cones_ready = 1;
    sc_worker_switch(w, SC_TASK_UPDATE_NORMALS);
    if (w->question->step) {
        sc_motion_update_cones(w->model, w->frame);
    } else {
        sc_dnc_update(w->model, w->frame);
        SC_HOOKS_ASSERT(w->hooks, sc_dnc_validate(w->model, w->frame));
    }
    w->stats.counts[SC_TASK_UPDATE_NORMALS] += w->model->patch_end;
    sc_worker_switch(w, SC_TASK_ORIENTATION);
}

/* ---- all together ---- */

/* The marks of one worker are what may be looked at, if it does all. */
static void begin_workers(plan *p)
{
    const sc_model *model = p->w->model;
    uint32_t i;
    if (p->tasks) {
        sc_workspace_share(model, p->workspace, &p->question, &p->share, p->workers);
        memset(p->room->culled, 0, model->patch_end);
    }
    for (i = 0; i < p->workers; i++) {
        sc_last *last = &p->w[i].last;
        memset(last->marks, 0, model->patch_end);
        last->culled = p->tasks ? p->room->culled : last->marks;
    }
}

/* What a worker counted. */
static void add_counts(sc_worker *sum, const sc_worker *w)
{
    sc_worker_add_stats(&sum->stats, &w->stats);
    sum->incomplete |= w->incomplete;
    sum->count += w->count;
}

/* Puts the last pairs that a worker found behind those that are in an array; 0: it is too short. */
static int put_last(sc_pair *pairs, uint64_t capacity, const sc_pair *found, uint32_t count,
                    size_t *claimed)
{
    const uint64_t at = *claimed;
    *claimed += count;
    if (at > capacity || count > capacity - at) return 0;
    if (count) memcpy(pairs + at, found, sizeof(sc_pair) * count);
    return 1;
}

/* The same for the two lists of a step, with their times. */
static int put_last_of_step(plan *p, const sc_worker *w)
{
    sc_step_worker *sum = p->w->step;
    const sc_step_worker *step = w->step;
    int fits = 1, kind;
    for (kind = 0; kind < 2; kind++) {
        const sc_step_list *list = &step->question->list[kind];
        const uint32_t count = step->found_count[kind];
        const size_t at = p->share.claimed[kind];
        const int ends_well = put_last(list->pairs, list->capacity, step->found[kind], count,
                                       &p->share.claimed[kind]);
        if (ends_well && count && list->times)
            memcpy(list->times + at, step->found_time[kind], sizeof(double) * count);
        fits &= ends_well;
        if (step != sum) sum->count[kind] += step->count[kind];
    }
    if (step != sum) sum->turned += step->turned;
    if (step->earliest < sum->earliest) sum->earliest = step->earliest;
    return fits;
}

/* Adds up what the workers counted, and puts the last of their pairs into the caller's arrays.
   Returns 0 if one of these is too short. */
static int gather(plan *p)
{
    const sc_question *q = &p->question;
    int fits = 1;
    uint32_t i;
    for (i = 0; p->tasks && i < p->workers; i++) {
        const sc_worker *w = &p->w[i];
        fits &= q->step ? put_last_of_step(p, w)
                        : put_last(q->pairs, q->capacity, w->found, w->found_count,
                                   &p->share.claimed[0]);
        if (w != p->w) add_counts(p->w, w);
    }
    return fits;
}

/* Pairs of the sorted list that the caller's function wants. */
static void ask_function(const sc_filter *f, sc_worker *w)
{
    sc_pair *pairs = w->question->pairs;
    uint64_t i, kept = 0;
    for (i = 0; i < w->count; i++)
        if (f->accept(f->accept_user, pairs[i].a, pairs[i].b)) pairs[kept++] = pairs[i];
    w->count = kept;
}

/* Finds all pairs, by this worker or from this one on by several; 0: the caller's array is too
   short for those. */
static int find_pairs(sc_workspace *workspace, sc_worker *worker, const sc_tasks *tasks, plan *p)
{
    const sc_question *question = worker->question;
    const sc_query_options *o = &p->question.options;
    memset(p, 0, sizeof *p);
    p->workspace = workspace;
    p->room = &workspace->plan;
    p->w = worker;
    p->tasks = tasks;
    p->workers = tasks ? tasks->workers : 1;
    p->question = *question;
    if (tasks && question->filter) {
        p->filter = *question->filter;
        p->filter.accept = NULL;
        p->question.filter = &p->filter;
    }
    if (question->step && question->has_last)
        sc_motion_leave_out_rings(rings_left_out(question), worker->frame);
    /* then the plain tree does what the test tree would, and sooner */
    if (question->has_last && question->step && sc_motion_is_wide(worker->model, worker->frame)) {
        p->question.options.method = SC_METHOD_AABB;
        p->question.has_last = 0;
        worker->question = &p->question;
    }
    begin_workers(p);
    if (p->question.has_last) make_cones(p->w);
    if (o->method == SC_METHOD_AABB) /* as of two objects always */
        walk_boxes(p);
    else if (o->method == SC_METHOD_AABB_SCTT)
        walk_nodes(p);
    else if (o->contour == SC_CONTOUR_EXACT)
        walk_exact(p);
    else
        walk_stars(p);
    if (p->question.has_last) do_alone(p);
    p->w->question = question;
    return gather(p);
}

/* Sorts what was found. */
static void finish(sc_workspace *workspace, const sc_question *question, const sc_tasks *tasks)
{
    sc_worker *w = &workspace->worker[0];
    uint64_t room;
    sc_pair *spare = sc_workspace_spare(workspace, &room);
    if (question->step) {
        sc_step_pairs_finish(question->step, w->step->count, spare, room, tasks);
        if (tasks) sc_step_filter_ask(w);
        return;
    }
    if (question->keeps) room = 0; /* what is kept of leaf clusters is there */
    sc_pairs_finish(question, w->count, spare, room, tasks);
    if (tasks && question->filter && question->filter->accept) ask_function(question->filter, w);
}

void sc_plan_run(sc_workspace *workspace)
{
    sc_worker *w = &workspace->worker[0];
    const sc_question *question = w->question;
    const sc_tasks *tasks = tasks_for(w->model, question);
    const sc_stats before = w->stats;
    plan p;
    if (!find_pairs(workspace, w, tasks, &p)) {
        if (question->keeps)
            (void)sc_workspace_resume(w->model, workspace, question);
        else
            (void)sc_workspace_begin(w->model, workspace, question);
        w->stats = before;
        if (question->timed) w->last_time = sc_clock_nanoseconds();
        tasks = NULL;
        (void)find_pairs(workspace, w, tasks, &p);
    }
    finish(workspace, question, tasks);
}

void sc_plan_run_whole(sc_workspace *workspace, uint32_t worker)
{
    sc_worker *w = &workspace->worker[worker];
    plan p;
    (void)find_pairs(workspace, w, NULL, &p);
    if (!w->share) return;
    if (w->question->step)
        sc_step_pairs_deliver(w);
    else
        sc_pairs_deliver(w);
}
