/*
 * Pairs that cross, and where. See crossings.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * Nearly all pairs are decided eight at a time (trace/crossing_kernel.h). The rest, in which four
 * points are in a plane or nearly so, are decided here, each by itself.
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

/* Pairs of the shortest part that is looked at by itself, and between looks at the flag. */
enum { PART_PAIRS_MIN = 500, PAIRS_BETWEEN_LOOKS = 1000 };

int sc_trace_is_cancelled(const sc_trace_subject *subject)
{
    return subject->cancel && sc_atomic_read(subject->cancel) != 0;
}

/* A search through the pairs. */
typedef struct pair_search {
    const sc_trace_subject *subject;
    sc_pair *pairs; /* those that cross of each part, from the part's first pair on */
    sc_crossing_place *places;
    uint32_t count[SC_JOBS_PARTS];   /* how many these are */
    uint32_t first[SC_JOBS_PARTS];   /* the part's first pair */
    uint32_t wrong[SC_JOBS_PARTS];   /* the first pair that is wrong, or SC_NONE; */
    sc_status status[SC_JOBS_PARTS]; /* what is wrong with it */
} pair_search;

/* ---- one pair ---- */

/* Five points: the ends of an edge and the corners of a triangle. */
typedef struct five_points {
    uint32_t number[5];
    double position[5][3];
    const double *p[5]; /* these */
} five_points;

static int is_finite(const double p[3])
{
    int k, finite = 1;
    for (k = 0; k < 3; k++) finite &= p[k] - p[k] == 0;
    return finite;
}

/* The sign of four of the points, by their places. */
static int sign_of_four(const five_points *five, int i, int j, int k, int l)
{
    const double *const p[4] = {five->p[i], five->p[j], five->p[k], five->p[l]};
    const uint32_t number[4] = {five->number[i], five->number[j], five->number[k], five->number[l]};
    uint64_t fallbacks = 0;
    return sc_perturbed_orient3d(p, number, &fallbacks);
}

/* Whether the edge crosses the triangle. The numbers differ. */
static int crosses(const five_points *five)
{
    int turn;
    if (sign_of_four(five, 2, 3, 4, 0) == sign_of_four(five, 2, 3, 4, 1)) return 0;
    turn = sign_of_four(five, 0, 1, 2, 3);
    return sign_of_four(five, 0, 1, 3, 4) == turn && sign_of_four(five, 0, 1, 4, 2) == turn;
}

/* Where they cross: in the middle of what they have in common, if that is more than a point. */
static void place_five(const five_points *five, sc_crossing_place *place)
{
    const double *const *p = five->p;
    const double *const edge[3] = {p[0], p[1], p[1]};
    uint64_t fallbacks = 0;
    sc_contact contact;
    int k;
    if (sc_primitives_segment_meets(p[0], p[1], p + 2, 1, &fallbacks)) {
        place->along = sc_contacts_pass(edge, p + 2, place->weights, place->point);
        return;
    }
    sc_contacts_find(edge, p + 2, &contact);
    place->along = contact.weights_a[0][1] / 2 + contact.weights_a[1][1] / 2;
    for (k = 0; k < 3; k++) {
        place->weights[k] = contact.weights_b[0][k] / 2 + contact.weights_b[1][k] / 2;
        place->point[k] = contact.points[0][k] / 2 + contact.points[1][k] / 2;
    }
}

/* Looks at a pair by itself: whether it crosses, and where. */
static int look_at_pair(const sc_trace_subject *s, const uint32_t number[5],
                        sc_crossing_place *place, sc_status *status)
{
    five_points five;
    int k;
    for (k = 0; k < 5; k++) {
        five.number[k] = number[k];
        five.p[k] = five.position[k];
        sc_positions_get(&s->positions, number[k], five.position[k]);
        if (is_finite(five.position[k])) continue;
        *status = SC_ERROR_NOT_FINITE;
        return 0;
    }
    if (!crosses(&five)) return 0;
    place_five(&five, place);
    return 1;
}

/* ---- eight pairs ---- */

typedef struct pair_block {
    uint32_t count, pair[SC_CROSSING_LANES];
    uint32_t number[SC_CROSSING_LANES][5];
    sc_crossing_lanes lanes;
    sc_crossing_values values;
} pair_block;

/* Whether pair i is one that sc_query may find, and its points; else what is wrong in *status. One
   of a triangle that welding has collapsed is none that crosses, but has to be finite too. */
static int name_five(const sc_trace_subject *s, uint32_t i, uint32_t number[5], sc_status *status)
{
    const sc_model *model = s->model;
    const sc_pair pair = s->pairs[i];
    const uint32_t *corner;
    int k, shared = 0;
    *status = SC_ERROR_PAIRS;
    if (pair.a / 3 >= model->triangle_count || pair.b >= model->triangle_count ||
        (i > 0 && !sc_sort_less(s->pairs[i - 1], pair)))
        return 0;
    corner = sc_trace_corners(model, pair.b);
    sc_trace_ends(model, pair.a, number);
    for (k = 0; k < 3; k++) {
        number[2 + k] = corner[k];
        shared |= corner[k] == number[0] || corner[k] == number[1];
    }
    if (shared) return 0;
    *status = SC_OK;
    if (number[0] != number[1] && !sc_trace_is_collapsed(corner)) return 1;
    for (k = 0; k < 5; k++) {
        double p[3];
        sc_positions_get(&s->positions, number[k], p);
        if (!is_finite(p)) *status = SC_ERROR_NOT_FINITE;
    }
    return 0;
}

/* Adds pair i, whose points are named at the end of the block. */
static void add_to_block(const sc_trace_subject *s, pair_block *block, uint32_t i)
{
    const uint32_t at = block->count++;
    int k;
    block->pair[at] = i;
    for (k = 0; k < 5; k++)
        block->lanes.point[k][at] = s->positions.at + s->positions.stride * block->number[at][k];
}

/* The place of a pair whose determinants are certain. */
static void place_lane(const sc_trace_subject *s, const pair_block *block, uint32_t at,
                       sc_crossing_place *place)
{
    const sc_crossing_values *v = &block->values;
    const double sum = v->weights[0][at] + v->weights[1][at] + v->weights[2][at];
    double p[3], q[3];
    int k;
    sc_positions_get(&s->positions, block->number[at][0], p);
    sc_positions_get(&s->positions, block->number[at][1], q);
    place->along = v->along[at] / sum;
    for (k = 0; k < 3; k++) {
        const double mean = (1 - place->along) * p[k] + place->along * q[k];
        const double low = p[k] < q[k] ? p[k] : q[k], high = p[k] < q[k] ? q[k] : p[k];
        place->weights[k] = v->weights[k][at] / sum;
        place->point[k] = mean < low ? low : mean > high ? high : mean;
    }
}

/* Looks at the pairs of a block: together, and those of which it is not certain then each by
   itself. Returns 0 after one that is wrong. */
static int look_at_block(pair_search *search, pair_block *block, uint32_t part)
{
    const sc_trace_subject *s = search->subject;
    const uint32_t first = search->first[part];
    uint32_t i, k;
    if (!block->count) return 1;
    for (i = block->count; i < SC_CROSSING_LANES; i++) /* something is in all lanes */
        for (k = 0; k < 5; k++) block->lanes.point[k][i] = block->lanes.point[k][0];
    s->kernels->look(&block->lanes, &block->values);
    for (i = 0; i < block->count; i++) {
        const uint32_t to = first + search->count[part];
        sc_crossing_place *place = &search->places[to];
        if (block->values.apart >> i & 1) continue;
        if (block->values.cross >> i & 1) {
            place_lane(s, block, i, place);
        } else if (!look_at_pair(s, block->number[i], place, &search->status[part])) {
            if (!search->status[part]) continue;
            search->wrong[part] = block->pair[i];
            return 0;
        }
        search->pairs[to] = s->pairs[block->pair[i]];
        search->count[part]++;
    }
    block->count = 0;
    return 1;
}

static void look_at_some_pairs(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    pair_search *search = (pair_search *)context;
    const sc_trace_subject *s = search->subject;
    pair_block block;
    sc_status status = SC_OK;
    uint32_t i;
    search->first[part] = first;
    search->count[part] = 0;
    search->wrong[part] = SC_NONE;
    search->status[part] = SC_OK;
    block.count = 0;
    block.lanes.floats = s->positions.type == SC_FLOAT;
    for (i = first; i < end; i++) {
        if (i % PAIRS_BETWEEN_LOOKS == 0 && sc_trace_is_cancelled(s)) return;
        if (name_five(s, i, block.number[block.count], &status)) add_to_block(s, &block, i);
        if (status) break;
        if (block.count == SC_CROSSING_LANES && !look_at_block(search, &block, part)) return;
    }
    if (!look_at_block(search, &block, part) || !status) return;
    search->wrong[part] = i;
    search->status[part] = status;
}

sc_status sc_crossings_find(const sc_trace_subject *subject, sc_scratch *scratch,
                            sc_crossings *crossings)
{
    pair_search search;
    uint32_t parts, part;
    search.subject = subject;
    search.pairs = (sc_pair *)sc_scratch_take(scratch, subject->count, sizeof *search.pairs);
    search.places =
        (sc_crossing_place *)sc_scratch_take(scratch, subject->count, sizeof *search.places);
    if (!search.pairs || !search.places) return SC_ERROR_MEMORY;
    crossings->pairs = search.pairs;
    crossings->places = search.places;
    crossings->count = 0;
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
        memmove(search.pairs + crossings->count, search.pairs + search.first[part],
                search.count[part] * sizeof *search.pairs);
        memmove(search.places + crossings->count, search.places + search.first[part],
                search.count[part] * sizeof *search.places);
        crossings->count += search.count[part];
    }
    return SC_OK;
}
