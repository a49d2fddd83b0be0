/*
 * Bounds of contour segments (paper, section 4), against exact rational arithmetic, and the
 * ticks that say whether they are of this projection.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "pose/contour_bounds.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "posed_model.h"
#include "soups.h"
#include "starcontour.h"

typedef struct bounds_check {
    posed_model *s;
    const sc_projection *projection;
    int line;
    const sc_segment_bounds *bounds;
    double samples[10];
    uint32_t wrong_extent, wrong_line, edges;
    double gap[2]; /* least distance of a line from the bound at the samples, by side */
} bounds_check;

static void exact_point(const bounds_check *c, uint32_t point, mpq_t x, mpq_t y)
{
    const double *at = posed_model_place(c->s->workspace, point);
    const sc_projection *p = c->projection;
    posed_model_exact_dot(c->line == SC_LINE_VERTICAL ? x : y, p->u, at, p->origin);
    posed_model_exact_dot(c->line == SC_LINE_VERTICAL ? y : x, p->w, at, p->origin);
    if (c->line == SC_LINE_HORIZONTAL) mpq_neg(y, y);
}

/* Whether low <= x <= high, where the outermost floats stand for everything beyond. */
static int is_within(mpq_t x, float low, float high)
{
    int inside;
    mpq_t bound;
    if (!(low <= high)) return 0;
    mpq_init(bound);
    if (low > -FLT_MAX) mpq_set_d(bound, (double)low);
    inside = low <= -FLT_MAX || (low <= FLT_MAX && mpq_cmp(bound, x) <= 0);
    if (high < FLT_MAX) mpq_set_d(bound, (double)high);
    inside = inside && (high >= FLT_MAX || mpq_cmp(x, bound) <= 0);
    mpq_clear(bound);
    return inside;
}

static void check_edge(bounds_check *c, uint32_t from, uint32_t to)
{
    mpq_t x0, y0, x1, y1, slope, at, bound;
    int run, side;
    const sc_ray_bound *b;
    mpq_inits(x0, y0, x1, y1, slope, at, bound, NULL);
    exact_point(c, from, x0, y0);
    exact_point(c, to, x1, y1);
    run = mpq_cmp(x1, x0);
    side = run < 0 ? SC_SIDE_TOP : SC_SIDE_BOTTOM;
    b = &c->bounds->side[side];
    ++c->edges;
    if (run == 0) {
        const sc_ray_bound *o = &c->bounds->side[SC_SIDE_TOP];
        c->wrong_extent +=
            !is_within(x0, o->ax < b->ax ? o->ax : b->ax, o->bx > b->bx ? o->bx : b->bx);
        c->wrong_line += b->ay != -INFINITY || o->ay != -INFINITY;
    } else {
        c->wrong_extent += !is_within(x0, b->ax, b->bx) || !is_within(x1, b->ax, b->bx);
        if (side == SC_SIDE_BOTTOM) {
            mpq_neg(y0, y0);
            mpq_neg(y1, y1);
        }
        mpq_sub(y1, y1, y0);
        mpq_sub(x1, x1, x0);
        mpq_div(slope, y1, x1);
        for (int i = 0; i < 10; ++i) {
            double lowest = sc_contour_bounds_lowest(b, c->samples[i]);
            if (lowest == -HUGE_VAL) continue;
            if (!isfinite(lowest)) {
                ++c->wrong_line;
                continue;
            }
            mpq_set_d(at, c->samples[i]);
            mpq_sub(at, at, x0);
            mpq_mul(at, at, slope);
            mpq_add(at, at, y0);
            mpq_set_d(bound, lowest);
            c->wrong_line += mpq_cmp(bound, at) > 0;
            mpq_sub(at, at, bound);
            if (i < 3) c->gap[side] = fmin(c->gap[side], mpq_get_d(at));
        }
    }
    mpq_clears(x0, y0, x1, y1, slope, at, bound, NULL);
}

static void check_edges_of(bounds_check *c, uint32_t segment)
{
    const sc_model *m = c->s->model;
    for (uint32_t i = sc_model_segment_first(m)[segment]; i < sc_model_segment_last(m)[segment];
         ++i)
        check_edge(c, sc_model_points(m)[i], sc_model_points(m)[i + 1]);
}

/* Some places along a line: the ends of the bounds, between them, beside them, far away. */
static void choose_samples(bounds_check *c)
{
    const sc_ray_bound *b = &c->bounds->side[test_random_below(2)];
    double low = fmax((double)b->ax, -1e300), high = fmin((double)b->bx, 1e300), length;
    if (!(low <= high)) low = high = 0;
    length = high - low + c->s->workspace->frame.radius * 0x1p-20;
    c->samples[0] = low;
    c->samples[1] = high;
    c->samples[2] = low / 2 + high / 2;
    c->samples[3] = low + length * test_random_unit();
    c->samples[4] = low - length;
    c->samples[5] = high + length;
    c->samples[6] = low - 1e6 * length * test_random_unit();
    c->samples[7] = high + 1e6 * length * test_random_unit();
    c->samples[8] = 0;
    c->samples[9] = test_random_range(-1, 1) * c->s->workspace->frame.radius * 1e3;
    for (int i = 0; i < 10; ++i)
        if (!isfinite(c->samples[i])) c->samples[i] = 0;
}

typedef struct bounds_tally {
    uint32_t segments, bounded, leaves, tight;
} bounds_tally;

/* A random projection, of a node if any is oriented, else of nobody. */
static void random_projection(posed_model *s, sc_projection *projection)
{
    uint32_t p = test_random_below(s->model->patch_end), mask = s->workspace->frame.mask[p];
    if (mask == 0) { /* the normals of a random half-space */
        double d[SC_DNC_DIRECTIONS][3], n[3];
        for (int k = 0; k < 3; ++k) n[k] = test_random_range(-1, 1);
        posed_model_directions(s->workspace, d);
        for (int i = 0; i < SC_DNC_DIRECTIONS; ++i)
            mask |= (uint32_t)(d[i][0] * n[0] + d[i][1] * n[1] + d[i][2] * n[2] > 0) << i;
    }
    sc_dnc_projection(&s->workspace->frame, test_random_part(mask), projection);
    sc_contour_bounds_begin(s->model, &s->workspace->frame.positions[0], projection,
                            &s->workspace->bounds);
}

static void check_bounds(posed_model *s, bounds_tally *tally)
{
    const sc_model *m = s->model;
    uint32_t stride = 1 + m->segment_count / 60;
    sc_projection projection;
    random_projection(s, &projection);
    for (int line = 0; line < 2; ++line)
        for (uint32_t i = test_random_below(stride); i < m->segment_count; i += stride) {
            /* the last ones have children; not in order, as in a query */
            uint32_t segment = i % 2 ? m->segment_count - 1 - i / 2 : i / 2;
            bounds_check c;
            memset(&c, 0, sizeof(c));
            c.s = s;
            c.projection = &projection;
            c.line = line;
            c.gap[0] = c.gap[1] = HUGE_VAL;
            sc_contour_bounds_update(m, &s->workspace->bounds, line, segment);
            CHECK(sc_contour_bounds_update(m, &s->workspace->bounds, line, segment) == 0);
            c.bounds = &s->workspace->bounds.of[line][segment];
            choose_samples(&c);
            check_edges_of(&c, segment);
            CHECK_MSG(c.wrong_extent == 0,
                      "%s: segment %" PRIu32 ", line %d: %" PRIu32 " of %" PRIu32 " edges outside",
                      s->name, segment, line, c.wrong_extent, c.edges);
            CHECK_MSG(c.wrong_line == 0,
                      "%s: segment %" PRIu32 ", line %d: %" PRIu32 " lines of %" PRIu32
                      " edges below",
                      s->name, segment, line, c.wrong_line, c.edges);
            ++tally->segments;
            if (c.bounds->side[0].ay == -INFINITY) continue;
            ++tally->bounded;
            for (int side = 0; side < 2; ++side) {
                if (segment >= m->leaf_segment_count || c.gap[side] == HUGE_VAL) continue;
                ++tally->leaves;
                tally->tight +=
                    c.gap[side] < 1e-4 * fabs(projection.w[0] + 1e3) * s->workspace->frame.radius;
            }
        }
}

static void bounds_of_segments(void)
{
    bounds_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(60); ++i) {
        posed_model s;
        posed_model_open_any(&s, 60 + 2 * i);
        for (int k = 0; k < 2; ++k) {
            memcpy(s.pose, s.mesh.positions, 3 * (size_t)s.mesh.vertex_count * sizeof(double));
            posed_model_any_pose(s.pose, s.mesh.vertex_count);
            if (i % 10 == 0) soup_scale(s.pose, s.mesh.vertex_count, k ? 1e-30 : 1e-45);
            if (i % 10 == 1) soup_scale(s.pose, s.mesh.vertex_count, k ? 1e30 : 1e38);
            if (posed_model_load(&s)) check_bounds(&s, &tally);
        }
        posed_model_close(&s);
    }
    CHECK_MSG(!test_is_full() || 3 * tally.bounded > tally.segments, "%" PRIu32 " of %" PRIu32,
              tally.bounded, tally.segments);
    CHECK_MSG(!test_is_full() || 10 * (uint64_t)tally.tight > 7 * (uint64_t)tally.leaves,
              "%" PRIu32 " of %" PRIu32 " bounds of leaves are tight", tally.tight, tally.leaves);
}

/* Segments longer than leaf clusters of today can have, put into a copy of a model. */
static void bounds_of_long_segments(void)
{
    enum { LONGEST = 300 };
    for (uint32_t i = 0; i < test_iterations(20); ++i) {
        soup mesh = soup_cloth(9, 9);
        posed_model s;
        bounds_tally tally;
        memset(&tally, 0, sizeof(tally));
        if (!posed_model_open(&s, "long", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) continue;
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) {
            sc_model *model = s.model;
            size_t size = (size_t)model->bytes;
            uint32_t extra[LONGEST + 3], edges = 1 + test_random_below(i % 4 ? 28 : LONGEST - 1);
            sc_model *longer = (sc_model *)test_allocate(size + sizeof(extra));
            extra[0] = 0;
            extra[1] = edges;
            for (uint32_t k = 0; k <= edges; ++k)
                extra[2 + k] = test_random_below(model->vertex_count);
            for (uint32_t k = 3; k < edges + 3; ++k) /* no edge from a point to itself */
                while (extra[k] == extra[k - 1]) extra[k] = test_random_below(model->vertex_count);
            memcpy(longer, model, size);
            memcpy((unsigned char *)longer + size, extra, sizeof(extra));
            longer->segment_count = longer->leaf_segment_count = 1;
            longer->offset[SC_ARRAY_segment_first] = size;
            longer->offset[SC_ARRAY_segment_last] = size + sizeof(uint32_t);
            longer->offset[SC_ARRAY_points] = size + 2 * sizeof(uint32_t);
            s.model = longer;
            check_bounds(&s, &tally);
            CHECK(tally.segments == 2);
            free(longer);
            s.model = model;
        }
        posed_model_close(&s);
    }
}

/* Coordinates at the end of the range of doubles, where projected ones overflow. */
static void bounds_of_huge_coordinates(void)
{
    for (uint32_t i = 0; i < test_iterations(40); ++i) {
        posed_model s;
        bounds_tally tally;
        soup mesh = soup_cloth(3, 3);
        double size = exp2(test_random_range(960, 1023.9));
        memset(&tally, 0, sizeof(tally));
        if (!posed_model_open(&s, "huge", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) continue;
        for (uint32_t v = 0; v < 1 + i % 4 || (i % 3 == 0 && v < s.mesh.vertex_count); ++v) {
            double *p = s.pose + 3 * (size_t)test_random_below(s.mesh.vertex_count);
            for (int k = 0; k < 3; ++k)
                if (test_random_below(3)) p[k] = size * test_random_range(-1, 1);
        }
        if (posed_model_load(&s)) check_bounds(&s, &tally);
        posed_model_close(&s);
    }
}

/* What was found for the last pose or projection is not taken for the next one's, even when ticks
   start anew: a workspace answers as a fresh one does. */
static void ticks(void)
{
    soup mesh = soup_cloth(6, 6);
    posed_model s;
    bounds_tally tally;
    memset(&tally, 0, sizeof(tally));
    if (!posed_model_open(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) return;
    for (uint32_t i = 0; i < 12; ++i) {
        if (i == 4) s.workspace->bounds.epoch = 0xfffe;
        if (i == 8) s.workspace->epochs = 0x7ffffffe;
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        if (i % 2) soup_shuffle(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) check_bounds(&s, &tally);
        if (i % 4 == 3) memcpy(s.pose, s.mesh.positions, 49 * 3 * sizeof(double));
    }
    posed_model_close(&s);
}

/* What was found at the first tick, and never since, is not taken for new when that tick comes
   again. */
static void first_tick_again(void)
{
    soup mesh = soup_cloth(6, 6);
    posed_model s;
    sc_projection projection;
    if (!posed_model_open(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) return;
    if (CHECK(posed_model_load(&s))) {
        sc_dnc_projection(&s.workspace->frame, 1u << 2, &projection);
        for (int round = 0; round < 2; ++round) {
            sc_contour_bounds_begin(s.model, &s.workspace->frame.positions[0], &projection,
                                    &s.workspace->bounds);
            CHECK(s.workspace->bounds.epoch == 1);
            for (int line = 0; line < 2; ++line)
                for (uint32_t i = 0; i < s.model->segment_count; ++i) {
                    CHECK(sc_contour_bounds_update(s.model, &s.workspace->bounds, line, i) > 0);
                    CHECK(sc_contour_bounds_update(s.model, &s.workspace->bounds, line, i) == 0);
                }
            s.workspace->bounds.epoch = 0xffff;
        }
    }
    for (int round = 0; round < 2; ++round) {
        s.workspace->epochs = round == 0 ? 0 : 0x7fffffff;
        for (uint32_t i = 0; i < 3 * s.mesh.vertex_count && round == 1; ++i)
            s.pose[i] = test_random_unit();
        s.workspace->worker->kept.some_known[0].epoch = s.workspace->all_known[0].epoch = 1;
        s.workspace->worker->kept.slab[0].epoch = 1;
        if (!posed_model_load(&s)) break;
        CHECK(s.workspace->frame.epoch == 1);
        CHECK(s.workspace->worker->kept.some_known[0].epoch == (uint32_t)(round == 0));
        CHECK(s.workspace->all_known[0].epoch == (uint32_t)(round == 0));
        CHECK(s.workspace->worker->kept.slab[0].epoch == (uint32_t)(round == 0));
    }
    posed_model_close(&s);
}

SC_TEST_MAIN(SC_TEST(bounds_of_segments), SC_TEST(bounds_of_long_segments),
             SC_TEST(bounds_of_huge_coordinates), SC_TEST(ticks), SC_TEST(first_tick_again))
