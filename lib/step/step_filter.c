/*
 * Filters of pairs of a vertex and a face, and of two edges. See step_filter.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "step/step_filter.h"

#include <string.h>

#include "base/jobs.h"
#include "pose/positions.h"
#include "query/filter.h"
#include "step/within.h"

/* Fewer vertices are not worth a part of their own. */
enum { REST_VERTICES_MIN = 1024 };

sc_status sc_step_filter_read(const sc_hooks *hooks, const sc_model *model,
                              const sc_filter *vertex_face, const sc_filter *edge_edge,
                              sc_pair_filters *filters)
{
    const sc_filter *const from[2] = {vertex_face, edge_edge};
    static const char *const names[2] = {"options.vertex_face_filter", "options.edge_edge_filter"};
    sc_status status = SC_OK;
    int kind;
    memset(filters, 0, sizeof *filters);
    filters->rest_distance = -1;
    for (kind = 0; kind < 2 && !status; kind++) {
        sc_filter *f = &filters->of[kind];
        if (!from[kind]) continue;
        status = sc_filter_read(hooks, names[kind], model, SC_FILTER_VERTEX_FACE + (uint32_t)kind,
                                from[kind], f);
        /* the two never share a vertex */
        filters->sifts[kind] = f->vertex_groups || f->triangle_groups || f->ignore_count ||
                               f->ignore_rings > 1;
        filters->asks[kind] = f->accept != NULL;
    }
    return status;
}

/* ---- the rest pose ---- */

typedef struct rest_pass {
    const uint8_t *use;
    const sc_positions *positions;
    double not_finite[SC_JOBS_PARTS]; /* stays 0 unless something is NaN or infinite */
} rest_pass;

static void check_rest(void *context, uint32_t part, uint32_t first, uint32_t last)
{
    rest_pass *pass = (rest_pass *)context;
    double sum = 0, p[3];
    uint32_t v;
    for (v = first; v < last; v++) {
        if (pass->use[v] == SC_VERTEX_UNUSED) continue;
        sc_positions_get(pass->positions, v, p);
        sum += (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]);
    }
    pass->not_finite[part] = sum;
}

static sc_status read_rest(const sc_model *model, const sc_positions *positions,
                           const sc_tasks *tasks)
{
    rest_pass pass;
    uint32_t part, parts;
    pass.use = sc_model_vertex_use(model);
    pass.positions = positions;
    parts = sc_jobs_loop(tasks, model->vertex_count, REST_VERTICES_MIN, check_rest, &pass);
    for (part = 0; part < parts; part++)
        if (pass.not_finite[part] != 0) return SC_ERROR_NOT_FINITE; /* NaN is not 0 */
    return SC_OK;
}

/* The group of each vertex: those of all triangles at it together. */
static void join_groups(const sc_model *model, const sc_group *of_triangles, sc_group *groups)
{
    const uint32_t *corner = sc_model_triangle(model), *id = sc_model_triangle_id(model);
    uint32_t t, k;
    memset(groups, 0, model->vertex_count * sizeof *groups);
    for (t = 0; t < model->triangle_count; t++, corner += 3) {
        const sc_group *of = &of_triangles[id[t]];
        for (k = 0; k < 3; k++) {
            groups[corner[k]].category |= of->category;
            groups[corner[k]].mask |= of->mask;
        }
    }
}

sc_status sc_step_filter_begin(const sc_model *model, const sc_pose *rest, uint64_t stride,
                               double rest_distance, const sc_tasks *tasks, sc_group *room,
                               sc_pair_filters *filters)
{
    const sc_group *of_triangles = filters->of[SC_STEP_VERTEX_FACE].triangle_groups;
    if (of_triangles) {
        join_groups(model, of_triangles, room);
        filters->vertex_groups = room;
    }
    if (!rest) return SC_OK;
    sc_positions_note(model, rest, stride, &filters->rest);
    filters->rest_distance = rest_distance;
    filters->sifts[0] = filters->sifts[1] = 1;
    return read_rest(model, &filters->rest, tasks);
}

/* ---- pairs ---- */

/* Whether the groups of two leave their pair. */
static int groups_leave(const sc_pair_filters *filters, int kind, const uint32_t point[4],
                        sc_pair name)
{
    const sc_filter *f = &filters->of[kind];
    const uint32_t first = sc_step_points_of_first(kind);
    if (f->triangle_groups) {
        const int is_vertex = kind == SC_STEP_VERTEX_FACE;
        const sc_group *a =
            is_vertex ? &filters->vertex_groups[name.a] : &f->triangle_groups[name.a / 3];
        if (!sc_filter_groups_collide(*a, f->triangle_groups[is_vertex ? name.b : name.b / 3]))
            return 0;
    }
    if (!f->vertex_groups) return 1;
    return sc_filter_groups_collide(
        sc_filter_group_of(f->vertex_groups, point, first),
        sc_filter_group_of(f->vertex_groups, point + first, 4 - first));
}

/* Whether a pair is less than so many edges of the mesh apart. */
static int is_in_rings(sc_worker *w, int kind, sc_pair inner, const uint32_t point[4],
                       uint32_t rings)
{
    const uint32_t first = sc_step_points_of_first(kind);
    sc_ball_side sides[2] = {{NULL, 0, SC_NONE}, {NULL, 0, SC_NONE}};
    const int is_vertex = kind == SC_STEP_VERTEX_FACE; /* round faces, not round vertices */
    sides[is_vertex].points = point;
    sides[is_vertex].count = first;
    sides[!is_vertex].points = point + first;
    sides[!is_vertex].count = 4 - first;
    sides[0].number = is_vertex ? inner.b : inner.a;
    if (!is_vertex) sides[1].number = inner.b;
    return sc_filter_is_near(w->model, &w->ball, sides, SC_FILTER_VERTEX_FACE + (uint32_t)kind,
                             rings);
}

static int is_near_at_rest(const sc_pair_filters *filters, int kind, const uint32_t point[4])
{
    double p[4][3];
    const double(*at)[3] = (const double(*)[3])p;
    int k;
    for (k = 0; k < 4; k++) sc_positions_get(&filters->rest, point[k], p[k]);
    return kind == SC_STEP_VERTEX_FACE ? sc_within_vertex_face(at, filters->rest_distance)
                                       : sc_within_edge_edge(at, filters->rest_distance);
}

int sc_step_filter_admits(sc_worker *w, int kind, sc_pair inner, const uint32_t point[4],
                          sc_pair name)
{
    const sc_pair_filters *filters = &w->step->question->filters;
    const sc_filter *f = &filters->of[kind];
    if (!groups_leave(filters, kind, point, name)) return 0;
    if (f->ignore_count && sc_filter_ignores(f, name.a, name.b)) return 0;
    if (f->ignore_rings > 1 && is_in_rings(w, kind, inner, point, f->ignore_rings)) return 0;
    return filters->rest_distance < 0 || !is_near_at_rest(filters, kind, point);
}

int sc_step_filter_accepts(const sc_worker *w, int kind, sc_pair name)
{
    const sc_filter *f = &w->step->question->filters.of[kind];
    return w->share || f->accept(f->accept_user, name.a, name.b);
}

/* ---- several workers ---- */

int sc_step_filter_allows_workers(const sc_step_question *question)
{
    const sc_step_options *o = &question->options;
    int asks = 0, fits = 1, kind;
    for (kind = 0; kind < 2; kind++) {
        const sc_step_list *list = &question->list[kind];
        asks |= question->filters.of[kind].accept != NULL;
        fits &= list->capacity && (list->times || o->times == SC_STEP_TIMES_NONE);
    }
    return !asks || (fits && o->output == SC_OUTPUT_PAIRS);
}

/* Keeps what the caller's function wants of a list; returns how many. */
static uint64_t ask_of_list(const sc_filter *f, const sc_step_list *list, uint64_t count)
{
    uint64_t i, kept = 0;
    for (i = 0; i < count; i++) {
        if (!f->accept(f->accept_user, list->pairs[i].a, list->pairs[i].b)) continue;
        list->pairs[kept] = list->pairs[i];
        if (list->times) list->times[kept] = list->times[i];
        kept++;
    }
    return kept;
}

void sc_step_filter_ask(sc_worker *w)
{
    sc_step_worker *step = w->step;
    const sc_step_question *q = step->question;
    int asks = 0, kind;
    uint64_t i;
    for (kind = 0; kind < 2; kind++) {
        const sc_filter *f = &q->filters.of[kind];
        if (!f->accept) continue;
        asks = 1;
        step->count[kind] = ask_of_list(f, &q->list[kind], step->count[kind]);
    }
    if (!asks || q->options.times == SC_STEP_TIMES_NONE) return;
    step->earliest = 1;
    for (kind = 0; kind < 2; kind++)
        for (i = 0; i < step->count[kind]; i++)
            if (q->list[kind].times[i] < step->earliest) step->earliest = q->list[kind].times[i];
}
