/*
 * The caller's filter. See filter.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query/filter.h"

#include <inttypes.h>
#include <string.h>

#include "base/arguments.h"
#include "base/sort.h"

static int is_pair(const sc_model *model, uint32_t kind, sc_pair pair)
{
    uint32_t count = model->triangle_count;
    if (kind == SC_FILTER_EDGES) return pair.a < 3 * count && pair.b < count;
    if (kind == SC_FILTER_VERTEX_FACE) return pair.a < model->vertex_count && pair.b < count;
    return pair.a < pair.b && pair.b < (kind == SC_FILTER_EDGE_EDGE ? 3 * count : count);
}

static sc_status check_filter(const sc_hooks *hooks, const char *of, const sc_model *model,
                              uint32_t kind, const sc_filter *filter)
{
    const sc_choice rings = {"ignore_rings", filter->ignore_rings, SC_RINGS_MAX};
    const char *wrong = NULL;
    uint64_t i;
    sc_status status = sc_arguments_choose(hooks, of, &rings, 1);
    if (!status && filter->ignore_count)
        status = sc_arguments_need(hooks, of, "ignore", filter->ignore);
    for (i = 0; !status && i < filter->ignore_count; i++) {
        if (!is_pair(model, kind, filter->ignore[i]))
            wrong = "is no pair of this model";
        else if (i && sc_sort_less(filter->ignore[i], filter->ignore[i - 1]))
            wrong = "comes before the one before it";
        else
            continue;
        sc_hooks_log(hooks, SC_LOG_ERROR, "%s.ignore[%" PRIu64 "] %s", of, i, wrong);
        return SC_ERROR_PAIRS;
    }
    return status;
}

sc_status sc_filter_read(const sc_hooks *hooks, const char *of, const sc_model *model,
                         uint32_t kind, const sc_filter *from, sc_filter *filter)
{
    sc_status status = sc_arguments_read(hooks, of, filter, sizeof *filter, from, sizeof(void *));
    return status ? status : check_filter(hooks, of, model, kind, filter);
}

sc_status sc_filter_begin(sc_question *question, const sc_hooks *hooks, const sc_model *model,
                          const sc_filter *from, sc_filter *filter)
{
    uint32_t kind = question->options.pairs;
    sc_status status = sc_filter_read(hooks, "options.filter", model, kind, from, filter);
    if (status) return status;
    question->filter = filter;
    question->sifts = filter->vertex_groups || filter->triangle_groups;
    /* an edge and a triangle that share no vertex are one edge apart if their triangles share
       one */
    question->drops_neighbors = filter->ignore_rings > (kind == SC_PAIRS_EDGE);
    return SC_OK;
}

/* ---- groups ---- */

int sc_filter_groups_collide(sc_group a, sc_group b)
{
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

sc_group sc_filter_group_of(const sc_group *groups, const uint32_t *points, uint32_t count)
{
    sc_group all = {0, 0};
    uint32_t i;
    for (i = 0; i < count; i++) {
        all.category |= groups[points[i]].category;
        all.mask |= groups[points[i]].mask;
    }
    return all;
}

/* ---- rings ---- */

/* Begins a ball with the points that it is round. It may grow by so many edges. */
static void begin_ball(const sc_model *model, sc_ball *ball, const uint32_t *center, uint32_t count,
                       uint32_t steps)
{
    uint32_t i;
    if (ball->epoch == 0xffff) {
        memset(ball->epoch_of, 0, model->vertex_count * sizeof *ball->epoch_of);
        ball->epoch = 0;
    }
    ball->epoch++;
    ball->head = ball->tail = 0;
    ball->steps = steps;
    for (i = 0; i < count; i++)
        if (ball->epoch_of[center[i]] != ball->epoch) {
            ball->epoch_of[center[i]] = ball->epoch;
            ball->queue[ball->tail++] = center[i];
        }
}

/* Adds the points that are one edge farther away; 0: it is not to grow, or cannot. */
static int grow_ball(const sc_model *model, sc_ball *ball)
{
    const uint32_t *first = sc_model_around_first(model), *around = sc_model_around(model);
    const uint32_t end = ball->tail;
    uint32_t i;
    if (!ball->steps || ball->head == end) return 0;
    ball->steps--;
    for (; ball->head < end; ball->head++)
        for (i = first[ball->queue[ball->head]]; i < first[ball->queue[ball->head] + 1]; i++)
            if (ball->epoch_of[around[i]] != ball->epoch) {
                ball->epoch_of[around[i]] = ball->epoch;
                ball->queue[ball->tail++] = around[i];
            }
    return 1;
}

static const uint32_t *points_of(const sc_model *model, uint32_t triangle)
{
    return sc_model_triangle(model) + 3 * (uint64_t)sc_model_place(model)[triangle];
}

int sc_filter_is_near(const sc_model *model, sc_ball *ball, const sc_ball_side sides[2],
                      uint32_t kind, uint32_t rings)
{
    const uint32_t center = ball->kind == kind ? ball->center : SC_NONE;
    const sc_ball_side *other = &sides[1];
    uint32_t i;
    if (center != SC_NONE && center == sides[1].number) {
        other = &sides[0];
    } else if (center != sides[0].number) {
        begin_ball(model, ball, sides[0].points, sides[0].count, rings - 1);
        ball->center = sides[0].number;
        ball->kind = (uint16_t)kind;
    }
    do
        for (i = 0; i < other->count; i++)
            if (ball->epoch_of[other->points[i]] == ball->epoch) return 1;
    while (grow_ball(model, ball));
    return 0;
}

/* ---- all together ---- */

uint32_t sc_filter_sift(const sc_worker *w, sc_pair *pairs, uint32_t count)
{
    const sc_filter *f = w->question->filter;
    const uint32_t *triangle = sc_model_triangle(w->model);
    const uint32_t *id = sc_model_triangle_id(w->model);
    uint32_t i, kept = 0;
    for (i = 0; i < count; i++) {
        const uint32_t a = pairs[i].a & SC_ITEM, b = pairs[i].b;
        if (f->triangle_groups &&
            !sc_filter_groups_collide(f->triangle_groups[id[a]], f->triangle_groups[id[b]]))
            continue;
        /* an edge's group is part of its triangle's */
        if (f->vertex_groups &&
            !sc_filter_groups_collide(
                sc_filter_group_of(f->vertex_groups, triangle + 3 * (uint64_t)a, 3),
                sc_filter_group_of(f->vertex_groups, triangle + 3 * (uint64_t)b, 3)))
            continue;
        pairs[kept++] = pairs[i];
    }
    return kept;
}

int sc_filter_ignores(const sc_filter *f, uint32_t a, uint32_t b)
{
    uint64_t low = 0, high = f->ignore_count;
    sc_pair pair;
    pair.a = a;
    pair.b = b;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (sc_sort_less(f->ignore[middle], pair))
            low = middle + 1;
        else
            high = middle;
    }
    return low < f->ignore_count && f->ignore[low].a == a && f->ignore[low].b == b;
}

int sc_filter_admits(sc_worker *w, uint32_t a, uint32_t b)
{
    const sc_filter *f = w->question->filter;
    int is_edge = w->question->options.pairs == SC_PAIRS_EDGE;
    uint32_t triangle = is_edge ? a / 3 : a, count = is_edge ? 2 : 3, points[3], k;
    const uint32_t *corner = points_of(w->model, triangle), *other = points_of(w->model, b);
    for (k = 0; k < count; k++) points[k] = corner[is_edge ? (a + k) % 3 : k];
    if (f->triangle_groups &&
        !sc_filter_groups_collide(f->triangle_groups[triangle], f->triangle_groups[b]))
        return 0;
    if (f->vertex_groups &&
        !sc_filter_groups_collide(sc_filter_group_of(f->vertex_groups, points, count),
                                  sc_filter_group_of(f->vertex_groups, other, 3)))
        return 0;
    if (sc_filter_ignores(f, a, b)) return 0;
    if (f->ignore_rings) {
        /* balls round triangles alone: those round edges would go by other numbers */
        const sc_ball_side sides[2] = {{other, 3, b}, {points, count, is_edge ? SC_NONE : a}};
        if (sc_filter_is_near(w->model, &w->ball, sides, SC_FILTER_TRIANGLES, f->ignore_rings))
            return 0;
    }
    return !f->accept || f->accept(f->accept_user, a, b);
}
