/*
 * The runner. See runner.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/runner.h"

#include <string.h>

#include "base/hooks.h"
#include "pose/refit.h"
#include "step/step_motion.h"

/* How long a list must be to be worth a stage, and how many items that takes at once; and both
   where a query may end early, by the first pair or by a budget: then pairs do not wait for long,
   as what has been found by then counts. What its time is filed under: that task, or the one of the
   same name for what follows a contour test. */
typedef struct list_rule {
    uint32_t enough, at_once, soon_enough, soon_at_once, task;
} list_rule;

enum { BOXES = SC_TASK_BOXES_ORIENTATION, PRIMITIVES = SC_TASK_PRIMITIVES_ORIENTATION };

static const list_rule rules[SC_LIST_COUNT] = {
    [SC_LIST_SPANS] = {1, 16, 1, 16, BOXES},
    [SC_LIST_STARS] = {1, 16, 1, 16, SC_TASK_ORIENTATION},
    [SC_LIST_FAILED] = {1, 64, 1, 64, SC_TASK_ORIENTATION},
    [SC_LIST_ORIENTED] = {SC_ORIENTED_ENOUGH, SC_ORIENTED_MAX, SC_ORIENTED_ENOUGH, SC_ORIENTED_MAX,
                          SC_TASK_CONTOUR},
    [SC_LIST_LEFT] = {SC_LEFT_ENOUGH, SC_LEFT_MAX, SC_LEFT_ENOUGH, SC_LEFT_MAX, BOXES},
    [SC_LIST_PATCHES] = {1, 64, 1, 1, BOXES},
    [SC_LIST_ROWS] = {SC_ROWS_ENOUGH, SC_ROWS_MAX, 1, 1, BOXES},
    [SC_LIST_FAR] = {SC_LEAF_LIST_ENOUGH, SC_LEAF_LIST_AT_ONCE, 16, 16, BOXES},
    [SC_LIST_NEAR] = {SC_LEAF_LIST_ENOUGH, SC_LEAF_LIST_AT_ONCE, 16, 16, BOXES},
    [SC_LIST_CLUSTERS] = {SC_CLUSTERS_ENOUGH, SC_CLUSTERS_ENOUGH, 1, SC_CLUSTERS_ENOUGH, BOXES},
    [SC_LIST_TRIANGLES] = {1, SC_TRIANGLES_MAX, 1, SC_TRIANGLES_MAX, BOXES},
    [SC_LIST_OPEN] = {SC_OPEN_ENOUGH, SC_OPEN_ENOUGH, 1, SC_OPEN_ENOUGH, BOXES},
    [SC_LIST_CANDIDATES] = {SC_CANDIDATES_ENOUGH, SC_CANDIDATES_ENOUGH, 1, SC_CANDIDATES_ENOUGH,
                            PRIMITIVES},
    [SC_LIST_NEIGHBORS] = {SC_NEIGHBORS_ENOUGH, SC_NEIGHBORS_ENOUGH, 1, SC_NEIGHBORS_ENOUGH,
                           PRIMITIVES},
    [SC_LIST_EXACT] = {SC_EXACT_ENOUGH, SC_EXACT_ENOUGH, 1, SC_EXACT_ENOUGH, PRIMITIVES},
    [SC_LIST_FACE_ROWS] = {SC_MOVING_ROWS_ENOUGH, SC_MOVING_ROWS_ENOUGH, 1, SC_MOVING_ROWS_ENOUGH,
                           PRIMITIVES},
    [SC_LIST_EDGE_ROWS] = {SC_MOVING_ROWS_ENOUGH, SC_MOVING_ROWS_ENOUGH, 1, SC_MOVING_ROWS_ENOUGH,
                           PRIMITIVES},
    [SC_LIST_FACES] = {SC_MOVING_ENOUGH, SC_MOVING_ENOUGH, 1, SC_MOVING_ENOUGH, PRIMITIVES},
    [SC_LIST_EDGES] = {SC_MOVING_ENOUGH, SC_MOVING_ENOUGH, 1, SC_MOVING_ENOUGH, PRIMITIVES},
};

void sc_runner_run_stage(sc_worker *w, sc_list_id list, uint32_t most)
{
    const int asked = w->question->near   ? SC_QUESTION_NEAR
                      : w->question->step ? SC_QUESTION_STEP
                                          : SC_QUESTION_QUERY;
    w->frame->kernels->stages[asked][sc_worker_is_between(w)][list](w, most);
    SC_HOOKS_ASSERT(w->hooks, sc_lists_have_room(&w->lists));
}

void sc_runner_make_boxes(sc_worker *w)
{
    uint32_t previous;
    if (w->frame->boxes_ready) return;
    previous = sc_worker_switch(w, SC_TASK_UPDATE_BOXES);
    w->stats.counts[SC_TASK_UPDATE_BOXES] += w->model->patch_end;
    if (w->question->step) {
        sc_motion_refit(w->model, w->frame);
    } else {
        sc_refit_boxes(w->model, w->frame);
        w->stats.counts[SC_TASK_UPDATE_BOXES] += w->model->triangle_count;
    }
    sc_worker_switch(w, previous);
}

/* Files the time since the last look at the clock under a task and that of the same name for what
   follows a contour test, as the tests that were counted meanwhile are of both; if there are none,
   as those before. */
static void divide_time(sc_worker *w, uint32_t task, const uint64_t before[SC_TASK_COUNT])
{
    const uint32_t other = task + SC_TASK_BOXES_CONTOUR - SC_TASK_BOXES_ORIENTATION;
    const uint64_t now = sc_clock_nanoseconds(), took = now - w->last_time;
    const uint64_t one = w->stats.counts[task] - before[task];
    const uint64_t two = w->stats.counts[other] - before[other];
    uint64_t part;
    if (one + two) w->follow_part = (double)two / (double)(one + two);
    part = (uint64_t)(w->follow_part * (double)took);
    w->stats.nanoseconds[task] += took - part;
    w->stats.nanoseconds[other] += part;
    w->last_time = now;
}

/* Runs a stage on as many items as it takes at once: on one, where that may take long by itself and
   the query may be stopped. */
static void run_list(sc_worker *w, sc_list_id list, int soon)
{
    const sc_query_options *o = &w->question->options;
    const int takes_long = list == SC_LIST_STARS || list == SC_LIST_EXACT ||
                           list == SC_LIST_FACES || list == SC_LIST_EDGES;
    const uint32_t most = takes_long && (o->cancel || o->budget) ? 1
                          : soon                                 ? rules[list].soon_at_once
                                                                 : rules[list].at_once;
    const uint32_t task = rules[list].task;
    uint64_t before[SC_TASK_COUNT];
    if (list >= SC_LIST_LEFT) sc_runner_make_boxes(w);
    if (!w->question->timed) {
        sc_runner_run_stage(w, list, most);
        return;
    }
    sc_worker_switch(w, task);
    memcpy(before, w->stats.counts, sizeof before);
    sc_runner_run_stage(w, list, most);
    if (task == BOXES || task == PRIMITIVES) divide_time(w, task, before);
}

/* The last list that is worth a stage; the one that had the last stage is, if there is more of
   it. */
static sc_list_id choose_list(const uint32_t *count, uint32_t last, int soon, int all)
{
    uint32_t k;
    for (k = SC_LIST_COUNT; k-- > 0;) {
        const uint32_t enough = soon ? rules[k].soon_enough : rules[k].enough;
        if (count[k] >= (k == last ? 1 : enough)) return (sc_list_id)k;
    }
    for (k = 0; all && k < SC_LIST_COUNT; k++)
        if (count[k]) return (sc_list_id)k;
    return SC_LIST_COUNT;
}

void sc_runner_run(sc_worker *w, int all)
{
    const int soon = w->question->ends_early;
    sc_list_id list = SC_LIST_COUNT;
    while (!sc_worker_stops(w)) {
        list = choose_list(w->lists.count, list, soon, all);
        if (list == SC_LIST_COUNT) return;
        run_list(w, list, soon);
    }
    memset(w->lists.count, 0, sizeof w->lists.count);
}

uint32_t sc_runner_waiting(const sc_worker *w)
{
    uint32_t k, sum = 0;
    for (k = SC_LIST_ROWS; k < SC_LIST_COUNT; k++) sum += w->lists.count[k];
    return sum;
}
