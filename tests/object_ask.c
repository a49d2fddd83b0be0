/*
 * Questions about several objects. See object_ask.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "object_ask.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

void object_ask(const sc_objects *objects, const object_question *q, const sc_tasks *tasks,
                const uint64_t capacity[2], object_answer *a)
{
    sc_objects_result result;
    sc_objects_lists lists;
    memset(a, 0, sizeof *a);
    memset(&result, 0, sizeof result);
    memset(&lists, 0, sizeof lists);
    a->stats.struct_size = sizeof a->stats;
    result.struct_size = sizeof result;
    lists.struct_size = sizeof lists;
    result.stats = lists.stats = &a->stats;
    for (int kind = 0; kind < 2; ++kind) {
        sc_object_list *list = &a->list[kind];
        list->capacity = capacity[kind];
        list->range_capacity = capacity[kind];
        list->pairs = (sc_pair *)test_allocate(sizeof(sc_pair) * capacity[kind]);
        list->times = (double *)test_allocate(sizeof(double) * capacity[kind]);
        list->ranges = (sc_object_pairs *)test_allocate(sizeof(sc_object_pairs) * capacity[kind]);
    }
    if (q->about == OBJECTS_QUERY) {
        sc_query_options o = q->query;
        o.tasks = tasks;
        result.capacity = result.range_capacity = capacity[0];
        result.pairs = a->list[0].pairs;
        result.ranges = a->list[0].ranges;
        a->status = sc_query_objects(objects, &o, &result);
        a->list[0].count = result.count;
        a->list[0].range_count = result.range_count;
        a->collides = result.collides;
        a->verdict = result.verdict;
        return;
    }
    lists.vertex_faces = a->list[0];
    lists.edge_edges = a->list[1];
    if (q->about == OBJECTS_NEAR) {
        sc_near_options o = q->near;
        o.tasks = tasks;
        a->status = sc_query_objects_near(objects, &o, &lists);
    } else {
        sc_step_options o = q->step;
        o.tasks = tasks;
        a->status = sc_query_objects_step(objects, &o, &lists);
    }
    a->list[0] = lists.vertex_faces;
    a->list[1] = lists.edge_edges;
    a->collides = lists.collides;
    a->verdict = lists.verdict;
    a->earliest = lists.earliest;
}

void object_answer_forget(object_answer *a)
{
    for (int kind = 0; kind < 2; ++kind) {
        free(a->list[kind].pairs);
        free(a->list[kind].times);
        free(a->list[kind].ranges);
    }
}

/* Whether two lists are the same, as far as ranges fit. */
static int is_same_list(const sc_object_list *x, const sc_object_list *y, int has_pairs, int timed)
{
    if (x->count != y->count || x->range_count != y->range_count) return 0;
    for (uint64_t i = 0; i < x->range_count && i < x->range_capacity; ++i) {
        const sc_object_pairs *p = &x->ranges[i], *q = &y->ranges[i];
        if (p->object_a != q->object_a || p->object_b != q->object_b || p->first != q->first ||
            p->count != q->count)
            return 0;
        if (!has_pairs || p->first + p->count > x->capacity) continue;
        for (uint64_t k = p->first; k < p->first + p->count; ++k)
            if (x->pairs[k].a != y->pairs[k].a || x->pairs[k].b != y->pairs[k].b ||
                (timed && memcmp(&x->times[k], &y->times[k], sizeof x->times[k]) != 0))
                return 0;
    }
    return 1;
}

int object_answers_are_same(const object_question *q, const object_answer *x,
                            const object_answer *y)
{
    const int has_pairs = q->query.output == SC_OUTPUT_PAIRS;
    const int timed = q->about == OBJECTS_STEP && q->step.times == SC_STEP_TIMES_EACH;
    return x->status == y->status && x->collides == y->collides && x->verdict == y->verdict &&
           memcmp(&x->earliest, &y->earliest, sizeof x->earliest) == 0 &&
           is_same_list(&x->list[0], &y->list[0], has_pairs, timed) &&
           is_same_list(&x->list[1], &y->list[1], has_pairs, timed);
}

int object_counts_are_same(const sc_stats *x, const sc_stats *y)
{
    return memcmp(x->counts, y->counts, sizeof x->counts) == 0 &&
           x->nodes_visited == y->nodes_visited && x->nodes_oriented == y->nodes_oriented &&
           x->nodes_culled == y->nodes_culled && x->leaf_pairs == y->leaf_pairs &&
           x->exact_fallbacks == y->exact_fallbacks;
}

object_question object_question_any(void)
{
    static const uint32_t methods[] = {SC_METHOD_DEFAULT, SC_METHOD_SCTT, SC_METHOD_AABB_SCTT,
                                       SC_METHOD_AABB};
    object_question q;
    memset(&q, 0, sizeof q);
    q.query.struct_size = sizeof q.query;
    q.near.struct_size = sizeof q.near;
    q.step.struct_size = sizeof q.step;
    q.about = (int)test_random_below(3);
    q.query.pairs = test_random_below(2) ? SC_PAIRS_EDGE : SC_PAIRS_TRIANGLE;
    q.query.method = methods[test_random_below(4)];
    q.near.distance = q.step.separation = test_random_below(2) ? 0.05 * test_random_unit() : 0;
    q.step.times = test_random_below(2) ? SC_STEP_TIMES_EACH : SC_STEP_TIMES_NONE;
    return q;
}

void object_question_set_output(object_question *q, uint32_t output)
{
    q->query.output = q->near.output = q->step.output = output;
}
