/*
 * Pairs that cross, and where. See crossings.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "trace/crossings.h"

#include <inttypes.h>

#include "base/atomic.h"
#include "base/hooks.h"
#include "base/jobs.h"
#include "base/perturbed.h"
#include "base/sort.h"
#include "query/contacts.h"
#include "query/primitives.h"

/* Pairs and nodes of the shortest part that is done by itself. */
enum { PART_PAIRS_MIN = 500, PART_NODES_MIN = 200, PAIRS_BETWEEN_LOOKS = 1000 };

int sc_trace_is_cancelled(const sc_trace_subject *subject)
{
    return subject->cancel && sc_atomic_read(subject->cancel) != 0;
}

/* A search through the pairs. */
typedef struct pair_search {
    const sc_trace_subject *subject;
    sc_pair *list;                   /* those of each part, from the part's first pair on */
    uint32_t count[SC_JOBS_PARTS];   /* how many these are */
    uint32_t first[SC_JOBS_PARTS];   /* the part's first pair */
    uint32_t wrong[SC_JOBS_PARTS];   /* the first pair that is wrong, or SC_NONE; */
    sc_status status[SC_JOBS_PARTS]; /* what is wrong with it */
} pair_search;

static int is_finite(const double p[3])
{
    int k, finite = 1;
    for (k = 0; k < 3; k++) finite &= p[k] - p[k] == 0;
    return finite;
}

/* Whether an edge crosses a triangle: five points with different numbers, of the edge first. */
static int crosses(const double *const p[5], const uint32_t number[5])
{
    uint64_t fallbacks = 0;
    const double *side[4] = {p[2], p[3], p[4], p[0]};
    uint32_t side_number[4] = {number[2], number[3], number[4], number[0]};
    int first, k, sign[3];
    first = sc_perturbed_orient3d(side, side_number, &fallbacks);
    side[3] = p[1];
    side_number[3] = number[1];
    if (sc_perturbed_orient3d(side, side_number, &fallbacks) == first) return 0;
    for (k = 0; k < 3; k++) {
        const int i = 2 + k, j = 2 + (k + 1) % 3;
        const double *const line[4] = {p[0], p[1], p[i], p[j]};
        const uint32_t line_number[4] = {number[0], number[1], number[i], number[j]};
        sign[k] = sc_perturbed_orient3d(line, line_number, &fallbacks);
        if (sign[k] != sign[0]) return 0;
    }
    return 1;
}

/* Whether the pair crosses; or SC_ERROR_... in *status. */
static int look_at_pair(const sc_trace_subject *s, uint32_t i, sc_status *status)
{
    const sc_model *model = s->model;
    const sc_pair pair = s->pairs[i];
    const uint32_t *corner;
    uint32_t number[5];
    double position[5][3];
    const double *p[5];
    int k;
    *status = SC_ERROR_PAIRS;
    if (pair.a / 3 >= model->triangle_count || pair.b >= model->triangle_count ||
        (i > 0 && !sc_sort_less(s->pairs[i - 1], pair)))
        return 0;
    corner = sc_trace_corners(model, pair.b);
    sc_trace_ends(model, pair.a, number);
    for (k = 0; k < 3; k++) {
        number[2 + k] = corner[k];
        if (corner[k] == number[0] || corner[k] == number[1]) return 0;
    }
    *status = SC_ERROR_NOT_FINITE;
    for (k = 0; k < 5; k++) {
        sc_positions_get(&s->positions, number[k], position[k]);
        if (!is_finite(position[k])) return 0;
        p[k] = position[k];
    }
    *status = SC_OK;
    return number[0] != number[1] && !sc_trace_is_collapsed(corner) && crosses(p, number);
}

static void look_at_some_pairs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    pair_search *search = (pair_search *)context;
    uint32_t i, count = 0;
    search->first[part] = first;
    search->wrong[part] = SC_NONE;
    for (i = first; i < end; i++) {
        if (i % PAIRS_BETWEEN_LOOKS == 0 && sc_trace_is_cancelled(search->subject)) break;
        if (look_at_pair(search->subject, i, &search->status[part]))
            search->list[first + count++] = search->subject->pairs[i];
        if (search->status[part]) {
            search->wrong[part] = i;
            break;
        }
    }
    search->count[part] = count;
}

sc_status sc_crossings_find(const sc_trace_subject *subject, sc_scratch *scratch,
                            sc_pair **crossings, uint32_t *count)
{
    pair_search search;
    uint32_t parts, part;
    search.subject = subject;
    search.list = (sc_pair *)sc_scratch_take(scratch, subject->count, sizeof *search.list);
    if (!search.list) return SC_ERROR_MEMORY;
    *crossings = search.list;
    *count = 0;
    if (!subject->count) return SC_OK;
    parts =
        sc_jobs_loop(scratch->tasks, subject->count, PART_PAIRS_MIN, look_at_some_pairs, &search);
    if (sc_trace_is_cancelled(subject)) return SC_ERROR_INCOMPLETE;
    for (part = 0; part < parts; part++) {
        if (search.wrong[part] != SC_NONE) {
            const sc_pair wrong = subject->pairs[search.wrong[part]];
            sc_hooks_log(subject->hooks, SC_LOG_ERROR,
                         "pairs[%" PRIu32 "], %" PRIu32 " and %" PRIu32 ": %s", search.wrong[part],
                         wrong.a, wrong.b, sc_status_string(search.status[part]));
            return search.status[part];
        }
        memmove(search.list + *count, search.list + search.first[part],
                search.count[part] * sizeof *search.list);
        *count += search.count[part];
    }
    return SC_OK;
}

/* What nodes are placed with. */
typedef struct placing {
    const sc_trace_subject *subject;
    sc_trace_node *nodes;
    uint64_t first; /* of the nodes that are placed now */
} placing;

static void place_node(const sc_trace_subject *s, sc_trace_node *node)
{
    double position[5][3];
    const double *edge[3] = {position[0], position[1], position[1]};
    const double *triangle[3] = {position[2], position[3], position[4]};
    const uint32_t *corner;
    uint32_t ends[2];
    uint64_t fallbacks = 0;
    sc_contact contact;
    int k;
    memset(node->weights, 0, sizeof node->weights);
    node->along = 0;
    if (node->edge == SC_TRACE_NO_EDGE) {
        sc_positions_get(&s->positions, node->triangle, node->point);
        return;
    }
    corner = sc_trace_corners(s->model, node->triangle);
    sc_trace_ends(s->model, node->edge, ends);
    for (k = 0; k < 2; k++) sc_positions_get(&s->positions, ends[k], position[k]);
    for (k = 0; k < 3; k++) sc_positions_get(&s->positions, corner[k], position[2 + k]);
    if (sc_primitives_segment_meets(edge[0], edge[1], triangle, 1, &fallbacks)) {
        node->along = sc_contacts_pass(edge, triangle, node->weights, node->point);
        return;
    }
    sc_contacts_find(edge, triangle, &contact);
    node->along = contact.weights_a[0][1] / 2 + contact.weights_a[1][1] / 2;
    for (k = 0; k < 3; k++) {
        node->weights[k] = contact.weights_b[0][k] / 2 + contact.weights_b[1][k] / 2;
        node->point[k] = contact.points[0][k] / 2 + contact.points[1][k] / 2;
    }
}

static void place_some_nodes(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const placing *p = (const placing *)context;
    uint32_t i;
    (void)part;
    for (i = first; i < end; i++) {
        if (i % PAIRS_BETWEEN_LOOKS == 0 && sc_trace_is_cancelled(p->subject)) return;
        place_node(p->subject, &p->nodes[p->first + i]);
    }
}

void sc_crossings_place(const sc_trace_subject *subject, const sc_tasks *tasks,
                        sc_trace_node *nodes, uint64_t count)
{
    const uint64_t most = UINT32_MAX / 2;
    placing p;
    p.subject = subject;
    p.nodes = nodes;
    for (p.first = 0; p.first < count; p.first += most) {
        const uint64_t left = count - p.first;
        sc_jobs_loop(tasks, (uint32_t)(left < most ? left : most), PART_NODES_MIN, place_some_nodes,
                     &p);
    }
}
