/*
 * The exact contour test against exact rational arithmetic and the oracle: points in the unit
 * box, places and their error, pieces, pinches, small contours, and all of them together.
 *
 * SPDX-License-Identifier: MIT
 */
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "posed_model.h"
#include "query/query_kernels.h"
#include "query/simple.h"
#include "query/simple_contour.h"
#include "run/workspace.h"
#include "simd/isa.h"
#include "soups.h"
#include "starcontour.h"

/* ---- the exact contour test ---- */

/* A disc that goes twice round its center; its border crosses itself at one point, which both turns
   have. */
static soup crossing_at_a_point(void)
{
    uint32_t sectors = 2 * (3 + test_random_below(5)), twice = sectors / 2;
    double depth = test_random_range(0.05, 0.4), start = test_random_range(0, 2 * posed_model_pi);
    soup s = soup_make(2 * sectors, 2 * sectors);
    for (uint32_t i = 0; i < 2 * sectors; ++i) {
        uint32_t a = i < twice + sectors ? 1 + i : i == twice + sectors ? 1 + twice : i;
        uint32_t next = (i + 1) % (2 * sectors);
        uint32_t b = next < twice + sectors ? 1 + next : next == twice + sectors ? 1 + twice : next;
        double angle = 2 * posed_model_pi * i / sectors, radius = 1 + depth * cos(angle / 2);
        s.positions[3 * a] = radius * cos(angle + start);
        s.positions[3 * a + 1] = radius * sin(angle + start);
        s.positions[3 * a + 2] = 0;
        s.triangles[3 * i] = 0;
        s.triangles[3 * i + 1] = a;
        s.triangles[3 * i + 2] = b;
    }
    memset(s.positions, 0, 3 * sizeof(double));
    return s;
}

/* Two discs that share the two points where their borders cross: a part of each is over the
   other. */
static soup crossing_at_two_points(void)
{
    enum { INNER = 2, OUTER = 4, EACH = INNER + OUTER }; /* edges */
    double apart = test_random_range(0.1, 1.5), half = acos(apart / 2), crowded[2][2];
    soup s = soup_make(2 * EACH, 2 * EACH);
    for (uint32_t i = 0; i < 4; ++i) /* points close to one end of an arc */
        crowded[i / 2][i % 2] = test_random_below(3) * 7.0 * (test_random_below(2) ? 1 : -1);
    for (uint32_t i = 0; i < 4; ++i)
        if (crowded[i / 2][i % 2] == 0) crowded[i / 2][i % 2] = 1;
    for (uint32_t disc = 0; disc < 2; ++disc)
        for (uint32_t i = 0; i < EACH; ++i) { /* from the lower crossing over the inner border */
            uint32_t arc = i >= INNER;
            double f = arc ? (double)(i - INNER) / OUTER : (double)i / INNER;
            double g = crowded[disc][arc] < 0 ? 1 - pow(1 - f, -crowded[disc][arc])
                                              : pow(f, crowded[disc][arc]);
            double angle = arc ? half + (2 * posed_model_pi - 2 * half) * g : half * (2 * g - 1);
            double sign = disc ? -1 : 1;
            uint32_t center = disc * (EACH + 1), p[EACH + 1];
            double *at;
            for (uint32_t k = 0; k <= EACH; ++k) p[k] = center + 1 + k % EACH;
            for (uint32_t k = 0; disc && k <= EACH; ++k) /* the first disc's crossings */
                p[k] = k % EACH == 0       ? 1 + INNER
                       : k % EACH == INNER ? 1
                                           : center + k % EACH - (k % EACH > INNER);
            at = s.positions + 3 * (size_t)p[i];
            at[0] = disc * apart + sign * cos(angle);
            at[1] = sign * sin(angle);
            at[2] = 0;
            at = s.positions + 3 * (size_t)center;
            at[0] = disc * apart;
            at[1] = at[2] = 0;
            s.triangles[3 * (disc * EACH + i)] = center;
            s.triangles[3 * (disc * EACH + i) + 1] = p[i];
            s.triangles[3 * (disc * EACH + i) + 2] = p[i + 1];
        }
    return s;
}

/* A triangle whose side two others share, cut at a point that is on it, or off by very little. */
static soup side_in_two(void)
{
    static const uint32_t triangles[] = {0, 2, 3, 2, 1, 3, 1, 0, 4};
    soup s = soup_make(5, 3);
    double off = test_random_below(3) == 0
                     ? 0
                     : test_random_range(-1, 1) * exp2(-10 - (double)test_random_below(50));
    double along = test_random_below(2) ? 0.5 : test_random_range(0.05, 0.95);
    double positions[] = {0, 0, 0, 1, 0, 0, along, off, 0, 0.5, 1, 0, 0.5, -1, 0};
    memcpy(s.positions, positions, sizeof(positions));
    memcpy(s.triangles, triangles, sizeof(triangles));
    return s;
}

/* Discs round each other, with or without a hole: each fan of them turns left. */
static soup nested_discs(void)
{
    uint32_t sides = 3 + test_random_below(4), rings = 2 + test_random_below(3), n = 0;
    soup s = soup_make(2 * rings * sides, 2 * rings * sides);
    for (uint32_t ring = 0; ring < rings; ++ring) {
        double outer = test_random_range(0.2, 1), inner = outer * test_random_range(0.3, 0.9);
        double x = test_random_range(-0.6, 0.6), y = test_random_range(-0.6, 0.6);
        for (uint32_t i = 0; i < sides; ++i) {
            uint32_t a = 2 * (ring * sides + i), b = 2 * (ring * sides + (i + 1) % sides);
            double angle = 2 * posed_model_pi * i / sides;
            uint32_t corners[2][3] = {{a, a + 1, b}, {a + 1, b + 1, b}};
            for (uint32_t k = 0; k < 2; ++k) {
                double *p = s.positions + 3 * (size_t)(a + k);
                p[0] = x + (k ? outer : inner) * cos(angle);
                p[1] = y + (k ? outer : inner) * sin(angle);
                p[2] = 0;
            }
            memcpy(s.triangles + 6 * (size_t)n++, corners, sizeof(corners));
        }
    }
    return s;
}

/* Contours of several loops that lie in each other, beside each other, or across. */
static void contours_in_pieces(void)
{
    posed_model_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(300); ++i) {
        posed_model s;
        soup mesh = nested_discs();
        if (!posed_model_open(&s, "nested discs", &mesh, SC_WELD_NONE, i % 4)) continue;
        if (i / 4 % 2) posed_model_rotate(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) posed_model_check_nodes(&s, &tally);
        posed_model_close(&s);
    }
    CHECK(!test_is_full() || (tally.colliding > 300 && tally.simple > 300));
}

/* A triangle whose corner is in the middle of the straight border of two others, and of one point
   with it. */
static soup corner_at_side(void)
{
    static const uint32_t triangles[] = {1, 0, 3, 0, 2, 3, 0, 4, 5, 1, 0, 3, 0, 2, 3};
    static const double positions[] = {0, 0, 0, -1,   0,  0, 1,   0,  0,
                                       0, 1, 0, -0.5, -1, 0, 0.5, -1, 0};
    soup s = soup_make(6, 3);
    memcpy(s.positions, positions, sizeof(positions));
    memcpy(s.triangles, triangles + 3 * test_random_below(3), 9 * sizeof(uint32_t));
    for (uint32_t i = 0; i < 4; ++i) /* not beyond the side; one of them may touch it */
        s.positions[12 + i % 2 + 3 * (i / 2)] *= test_random_range(0, 1);
    return s;
}

/* Contours that touch or cross themselves at points they share, and nowhere else. */
static void contours_at_shared_points(void)
{
    posed_model_tally tally;
    memset(&tally, 0, sizeof(tally));
    for (uint32_t i = 0; i < test_iterations(300); ++i) {
        posed_model s;
        soup mesh = i % 4 == 0   ? crossing_at_a_point()
                    : i % 4 == 1 ? crossing_at_two_points()
                    : i % 4 == 2 ? side_in_two()
                                 : corner_at_side();
        if (!posed_model_open(&s, "shared points", &mesh, SC_WELD_NONE, i / 4 % 4)) continue;
        if (i / 16 % 2) posed_model_rotate(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) posed_model_check_nodes(&s, &tally);
        posed_model_close(&s);
    }
    CHECK(!test_is_full() || (tally.colliding > 300 && tally.simple > 30));
}

/* x = axis . ((p - center) scale - from), exactly. */
static void exact_place(mpq_t result, const sc_workspace *w, uint32_t point, const float axis[3],
                        const float from[3])
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    mpq_set_ui(result, 0, 1);
    for (int k = 0; k < 3; ++k) {
        mpq_set_d(a, posed_model_part(w, point, k));
        mpq_set_d(b, w->frame.center[k]);
        mpq_sub(a, a, b);
        mpq_set_d(b, w->frame.scale);
        mpq_mul(a, a, b);
        mpq_set_d(b, (double)from[k]);
        mpq_sub(a, a, b);
        mpq_set_d(b, (double)axis[k]);
        mpq_mul(a, a, b);
        mpq_add(result, result, a);
    }
    mpq_clears(a, b, NULL);
}

/* The points that a contour has in its list, with those between which there is no edge. */
static uint32_t count_listed(const sc_model *m, uint32_t node)
{
    const sc_node *n = sc_model_node(m) + node;
    uint32_t listed = 0, i = n->contour + (n->kind & SC_NODE_TOUCHES ? 2 : 0);
    uint32_t before = SC_NONE;
    for (; i < n[1].contour; ++i) {
        uint32_t segment = sc_model_contours(m)[i];
        uint32_t first = sc_model_segment_first(m)[segment],
                 last = sc_model_segment_last(m)[segment];
        listed += last - first + (sc_model_points(m)[first] != before);
        before = sc_model_points(m)[last];
    }
    return listed;
}

/* Points in the unit box are in it, and off by what the bounds allow for, whatever the pose's
   size. */
static void points_in_the_unit_box(void)
{
    static const float axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, origin[3] = {0, 0, 0};
    double worst = 0, largest = 0;
    uint32_t differ = 0;
    mpq_t exact, place;
    mpq_inits(exact, place, NULL);
    for (uint32_t round = 0; round < test_iterations(200); ++round) {
        posed_model s;
        posed_model_open_any(&s, 40);
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        soup_move(s.pose, s.mesh.vertex_count, test_random_range(-2, 2));
        if (round % 2)
            soup_scale(s.pose, s.mesh.vertex_count, exp2(test_random_range(-1074, 1000)));
        if (posed_model_load(&s))
            for (uint32_t i = 0; i < 3 * SC_LEAF_POINTS * s.model->leaf_count; ++i) {
                uint32_t leaf = i / 3 / SC_LEAF_POINTS, k = i % 3, at = i / 3 % SC_LEAF_POINTS;
                uint32_t point = sc_model_leaf_point(s.model)[SC_LEAF_POINTS * leaf + at];
                uint32_t turned = SC_LEAF_POINTS * leaf + sc_loops_turn(at);
                double off, unit = (double)s.workspace->frame.point_at[4 * turned + k];
                float one[3];
                sc_positions_unit(&s.workspace->frame, point, one);
                differ += one[k] != (float)unit;
                exact_place(exact, s.workspace, point, axis[k], origin);
                mpq_set_d(place, unit);
                mpq_sub(place, place, exact);
                off = fabs(mpq_get_d(place));
                if (off > worst) worst = off;
                if (fabs(unit) > largest) largest = fabs(unit);
            }
        posed_model_close(&s);
    }
    CHECK_MSG(worst <= 3e-8 && largest <= 1, "off by %g, up to %g", worst, largest);
    CHECK(differ == 0); /* from what one point alone gives */
    CHECK(!test_is_full() || (worst > 0x1.8p-26 && largest > 0.9));
    mpq_clears(exact, place, NULL);
}

/* Positions of any type, stride, alignment and size, with vertices that are used, welded or not
   used at all, are read as each alone is, by all instructions alike, and nothing behind the last
   one; points in the unit box are where they should. */
static void poses_of_any_layout(void)
{
    static const struct layout {
        uint32_t type, gap, shift; /* bytes after each vertex, and before the first */
    } layouts[] = {{SC_DOUBLE, 0, 0}, {SC_DOUBLE, 8, 0}, {SC_DOUBLE, 0, 1}, {SC_DOUBLE, 13, 3},
                   {SC_FLOAT, 0, 0},  {SC_FLOAT, 4, 0},  {SC_FLOAT, 0, 2},  {SC_FLOAT, 9, 5}};
    uint32_t wrong = 0;
    for (uint32_t round = 0; round < test_iterations(60); ++round) {
        posed_model s;
        posed_model_open_any(&s, round % 3 ? 60 : 300);
        posed_model_any_pose(s.pose, s.mesh.vertex_count);
        if (round % 2) { /* where floats are hardly large or small enough, or sums too large */
            double largest = 1, size = exp2(test_random_range(-150, 120));
            if (round % 4 == 3) size = round % 8 == 3 ? 0x1.8p127 : 0x1.8p1023;
            for (uint32_t i = 0; i < 3 * s.mesh.vertex_count; ++i)
                largest = fmax(largest, fabs(s.pose[i]));
            soup_scale(s.pose, s.mesh.vertex_count, size / largest);
        }
        for (size_t l = 0; l < sizeof(layouts) / sizeof(layouts[0]); ++l) {
            const struct layout *layout = &layouts[l];
            const size_t size = layout->type == SC_DOUBLE ? sizeof(double) : sizeof(float);
            const size_t stride = 3 * size + layout->gap;
            const size_t bytes = layout->shift + s.mesh.vertex_count * stride - layout->gap;
            unsigned char *memory = (unsigned char *)test_allocate(bytes);
            double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
            double high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
            int is_finite = 1;
            sc_pose pose = input_plain_pose(s.pose, s.mesh.vertex_count);
            for (uint32_t i = 0; i < 3 * s.mesh.vertex_count; ++i) {
                unsigned char *at = memory + layout->shift + i / 3 * stride + i % 3 * size;
                float f = (float)s.pose[i];
                double d = layout->type == SC_DOUBLE ? s.pose[i] : (double)f;
                memcpy(at, layout->type == SC_DOUBLE ? (void *)&s.pose[i] : (void *)&f, size);
                if (sc_model_vertex_use(s.model)[i / 3] == SC_VERTEX_UNUSED) continue;
                low[i % 3] = fmin(low[i % 3], d);
                high[i % 3] = fmax(high[i % 3], d);
                is_finite &= isfinite(d) != 0;
            }
            pose.positions = memory + layout->shift;
            pose.position_type = layout->type;
            for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
                sc_workspace *w = s.workspace;
                w->frame.kernels = sc_kernels_for(isa);
                sc_workspace_begin(s.model, w, &posed_model_nothing_asked);
                if (is_finite != (sc_positions_read(s.model, &pose, stride, &w->frame) == SC_OK))
                    ++wrong;
                if (!is_finite) continue; /* too large for floats */
                sc_dnc_update(s.model, &w->frame);
                for (uint32_t k = 0; k < 3; ++k) {
                    double middle = low[k] / 2 + high[k] / 2;
                    if (layout->type == SC_FLOAT) middle = (double)(float)middle;
                    wrong += w->frame.center[k] != middle;
                }
                for (uint32_t i = 0; i < SC_LEAF_POINTS * s.model->leaf_count; ++i) {
                    uint32_t point = sc_model_leaf_point(s.model)[i];
                    const float *at = w->frame.point_at + 4 * sc_loops_turn(i);
                    double p[3];
                    float one[3];
                    sc_positions_get(&w->frame.positions[0], point, p);
                    sc_positions_unit(&w->frame, point, one);
                    for (uint32_t k = 0; k < 3; ++k) {
                        double d = s.pose[3 * point + k];
                        wrong += p[k] != (layout->type == SC_DOUBLE ? d : (double)(float)d);
                        wrong += at[k] != one[k];
                        d = (p[k] - w->frame.center[k]) * w->frame.scale;
                        wrong += fabs((double)one[k] - d) > 3e-8;
                    }
                    wrong += at[3] != 0;
                }
            }
            free(memory);
        }
        posed_model_close(&s);
    }
    CHECK_MSG(wrong == 0, "%" PRIu32 " coordinates", wrong);
}

/* Point i of the contour of a node that was tested. */
static uint32_t tested_point(const posed_model *s, uint32_t node, uint32_t i)
{
    const sc_model *m = s->model;
    const uint32_t *leaf = sc_model_leaf(m);
    const sc_node *n = sc_model_node(m) + node;
    const sc_pair *patches = &n->patches;
    uint32_t split = leaf[patches->a + 1] - leaf[patches->a], number, cluster;
    if (!n->loop_length) return s->workspace->worker->contour.point[i];
    if (n->kind & SC_NODE_PIECES)
        return sc_model_leaf_point(m)[sc_loops_turn(s->workspace->worker->contour.point[i])];
    number = sc_model_loop(m)[n->loop + i % n->loop_length];
    cluster = number / SC_LEAF_POINTS;
    cluster = cluster < split ? leaf[patches->a] + cluster : leaf[patches->b] + cluster - split;
    return sc_model_leaf_point(
        m)[SC_LEAF_POINTS * cluster + sc_loops_turn(number % SC_LEAF_POINTS)];
}

/* How many places the pieces of a node's loop are listed in, and the place of what is about the
   middle of its points. */
static uint32_t list_pieces(const posed_model *s, uint32_t node, uint32_t *middle)
{
    const uint16_t *loop = sc_model_loop(s->model) + sc_model_node(s->model)[node].loop;
    uint32_t edges = 0, places = 0, before = 0;
    for (uint32_t p = 0; p < loop[0]; ++p) edges += loop[1 + p];
    for (uint32_t p = 0; p < loop[0]; ++p) {
        if (before <= edges / 2) *middle = places + edges / 2 - before;
        before += loop[1 + p];
        places += (loop[1 + p] / (uint32_t)SC_CONTOUR_GAP + 1) * SC_CONTOUR_GAP;
    }
    return places;
}

/* Whether the error that a contour carries when it is projected is less than that of a point as far
   from the middle as its points are, in any of the three axes. */
static uint32_t is_too_sure(const posed_model *s, const sc_projection *projection, uint32_t node,
                            const float from[3], uint32_t listed, int has_gaps)
{
    const sc_contour_edges *e = &s->workspace->worker->contour;
    sc_simple_contour c;
    float most = 0;
    memset(&c, 0, sizeof(c));
    if (!sc_simple_start(&c, s->model, &s->workspace->worker->contour, node)) return 0;
    sc_simple_axes(&c, projection);
    memcpy(c.from, from, sizeof(c.from));
    s->workspace->frame.kernels->query->project(&c, &s->workspace->frame);
    for (uint32_t i = 0; i < listed; ++i) {
        float unit[3];
        if (has_gaps && (e->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1) == 0)
            continue;
        sc_positions_unit(&s->workspace->frame, tested_point(s, node, i), unit);
        for (int k = 0; k < 3; ++k) most = fmaxf(most, fabsf(unit[k] - from[k]));
    }
    return c.error < sc_bounds_contour(most);
}

/* The boxes of spans of two edges hold the true places of their ends, however the contour is seen:
   from above, or from one end, so that it is small for the size that it has; and whatever its
   size. */
static void places_of_contours(void)
{
    mpq_t exact, bound;
    mpq_inits(exact, bound, NULL);
    for (uint32_t round = 0; round < test_iterations(120); ++round) {
        soup mesh = soup_cloth(5, 5);
        double flat = exp2(-(double)test_random_below(40)), move = test_random_range(-9, 9);
        sc_projection projection;
        posed_model s;
        if (!posed_model_open(&s, "cloth", &mesh, SC_WELD_REST, SC_PARTITION_FAST)) break;
        sc_dnc_projection(&s.workspace->frame,
                          1 + test_random_below((1 << SC_DNC_DIRECTIONS / 2) - 1), &projection);
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            double along = test_random_range(-1, 1);
            const double *u = projection.u, *w = projection.w;
            for (int k = 0; k < 3; ++k) {
                double down = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
                s.pose[3 * v + (uint32_t)k] =
                    1e-5 * along * down + flat * test_random_range(-1, 1) + move;
            }
        }
        if (round % 3 == 2) { /* all but one corner far smaller than the pose's box */
            double shrink = exp2(-(double)test_random_below(24));
            for (uint32_t i = 3; i < 3 * mesh.vertex_count; ++i)
                s.pose[i] = s.pose[i % 3] + 7 * (i % 3 + 1) + shrink * (s.pose[i] - s.pose[i % 3]);
        }
        if (round % 5 > 1) /* long in one axis alone */
            for (uint32_t i = 0; i < 3 * mesh.vertex_count; ++i)
                if (i % 3 != round % 5 - 2) s.pose[i] *= 0x1p-12;
        if (round % 4 == 3)
            soup_scale(s.pose, mesh.vertex_count,
                       exp2(test_random_below(2) ? test_random_range(1008, 1012)
                                                 : test_random_range(-1060, 1012)));
        if (posed_model_load(&s)) {
            const sc_contour_edges *e = &s.workspace->worker->contour;
            uint32_t wrong = 0, edges = 0, too_sure = 0;
            for (uint32_t node = 0; node < s.model->node_count; ++node) {
                const uint32_t length = sc_model_node(s.model)[node].loop_length;
                int in_pieces = sc_model_node(s.model)[node].kind & SC_NODE_PIECES;
                int has_gaps = !length || in_pieces;
                uint32_t listed = length ? length : count_listed(s.model, node);
                uint32_t middle;
                float from[3], one[3], other[3];
                int passed;
                if (listed == 0) continue;
                middle = listed / 2;
                if (length && in_pieces) listed = list_pieces(&s, node, &middle);
                s.workspace->frame.kernels = sc_kernels_for(1 + node % (uint32_t)sc_isa_best());
                passed = sc_simple_test(s.workspace->worker, &projection, node);
                sc_positions_unit(&s.workspace->frame, tested_point(&s, node, 0), one);
                sc_positions_unit(&s.workspace->frame, tested_point(&s, node, middle), other);
                for (int k = 0; k < 3; ++k) from[k] = one[k] / 2 + other[k] / 2;
                too_sure += is_too_sure(&s, &projection, node, from, listed, has_gaps);
                if (!passed && listed > SC_CONTOUR_BLOCK) listed = SC_CONTOUR_BLOCK; /* at least */
                for (uint32_t i = 0; i < listed; ++i) {
                    if (has_gaps &&
                        (e->is_edge[i / SC_CONTOUR_BLOCK] >> i % SC_CONTOUR_BLOCK & 1) == 0)
                        continue;
                    ++edges;
                    for (uint32_t j = 0; j < 4; ++j) { /* x and y of both ends */
                        const double *v = j % 2 ? projection.w : projection.u;
                        float axis[3];
                        int exponent;
                        (void)frexp(fabs(v[0]) + fabs(v[1]) + fabs(v[2]), &exponent);
                        for (int k = 0; k < 3; ++k) axis[k] = (float)ldexp(v[k], -exponent);
                        exact_place(exact, s.workspace, tested_point(&s, node, i + j / 2), axis,
                                    from);
                        mpq_set_d(bound, (double)e->span_side[2 * (j % 2)][i / 2]);
                        wrong += mpq_cmp(exact, bound) < 0;
                        mpq_set_d(bound, (double)e->span_side[2 * (j % 2) + 1][i / 2]);
                        wrong += mpq_cmp(exact, bound) > 0;
                    }
                }
            }
            CHECK_MSG(!too_sure, "%" PRIu32 " errors are too small", too_sure);
            CHECK_MSG(wrong == 0 && edges > 100, "flat %g: %" PRIu32 " places of %" PRIu32 " edges",
                      flat, wrong, edges);
        }
        posed_model_close(&s);
    }
    mpq_clears(exact, bound, NULL);
}

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Whether v is in the sector that begins with a, lies to its left, and ends with b. */
static int is_in_sector(const double a[2], const double b[2], const double v[2])
{
    if (cross(a, b) > 0) return cross(a, v) > 0 && cross(v, b) > 0;
    return cross(a, v) > 0 || cross(v, b) > 0;
}

/*
 * A point that a contour passes twice, its four edges in any directions, some nearly the same or
 * opposite: it is fine only if they alternate, and then always if no two of them are nearly on one
 * line.
 */
static void pinches_alone(void)
{
    uint32_t wrong = 0, missed = 0, fine = 0, doubtful = 0;
    for (uint32_t i = 0; i < test_iterations_at_least(40000, 8000); ++i) {
        enum { POINTS = 6, ROOM = 32 };
        /* the point, out, in, the point, out, in: where the second in precedes the first out */
        float at[2][ROOM] = {{0}};
        double v[4][2], angle = test_random_range(0, 2 * posed_model_pi), least = HUGE_VAL,
                        sizes = 0;
        int inside, result;
        sc_contour_edges edges;
        sc_simple_contour c;
        memset(&edges, 0, sizeof(edges));
        memset(&c, 0, sizeof(c));
        c.edges = &edges;
        c.count = POINTS;
        c.error = 1e-6f;
        c.pinch_count = 1;
        c.pinch[0].edge[1] = 3;
        for (int k = 0; k < 2; ++k) edges.at[k] = at[k];
        for (int n = 0; n < 4; ++n) { /* out, out, in, in */
            static const int place[4] = {1, 4, 2, 5};
            double turn = angle + (test_random_below(2) ? posed_model_pi : 0),
                   length = test_random_unit();
            turn +=
                test_random_below(4) ? test_random_range(-1e-4, 1e-4) : test_random_range(-2, 2);
            if (test_random_below(4) == 0) length *= 0.01;
            at[0][place[n]] = (float)(length * cos(turn));
            at[1][place[n]] = (float)(length * sin(turn));
            for (int k = 0; k < 2; ++k) {
                v[n][k] = (double)at[k][place[n]];
                sizes += fabs(v[n][k]);
            }
        }
        for (int k = 0; k < 2; ++k) at[k][POINTS] = at[k][0];
        for (int n = 0; n < 4; ++n)
            for (int m = 0; m < n; ++m) least = fmin(least, fabs(cross(v[n], v[m])));
        if (least == 0) continue;
        inside = is_in_sector(v[0], v[1], v[2]) + is_in_sector(v[0], v[1], v[3]);
        result = sc_simple_is_wound_well(&c);
        wrong += result && inside != 1;
        missed += !result && inside == 1 && least > 100e-6 * sizes;
        fine += result != 0;
        doubtful += !result && inside == 1;
    }
    CHECK_MSG(!wrong && !missed, "%" PRIu32 " wrong, %" PRIu32 " missed", wrong, missed);
    CHECK_MSG(fine > 500 && doubtful > 100, "%" PRIu32 " fine, %" PRIu32 " doubtful", fine,
              doubtful);
}

/* A node whose contour is a loop of at least so many points, in one piece, none of those twice;
   SC_NONE: there is none. */
static uint32_t long_loop(const sc_model *m, uint32_t least)
{
    for (uint32_t node = 0; node < m->node_count; ++node) {
        const sc_node *n = sc_model_node(m) + node;
        const uint16_t *loop = sc_model_loop(m) + n->loop;
        int twice = (n->kind & SC_NODE_PIECES) != 0;
        if (n->loop_length < least) continue;
        for (uint32_t i = 0; i < least; ++i)
            for (uint32_t j = 0; j < i; ++j) twice |= loop[i] == loop[j];
        if (!twice) return node;
    }
    return SC_NONE;
}

/* Moves the first points of a loop, as they are kept in the unit box; the second is higher by
   lift. */
static void move_loop(const posed_model *s, uint32_t node, float at[][2], uint32_t count,
                      float lift)
{
    const uint32_t *leaf = sc_model_leaf(s->model);
    const sc_pair *patches = &sc_model_node(s->model)[node].patches;
    const uint16_t *loop = sc_model_loop(s->model) + sc_model_node(s->model)[node].loop;
    sc_simple_contour c;
    memset(&c, 0, sizeof(c));
    c.first = SC_LEAF_POINTS * leaf[patches->a];
    c.split = SC_LEAF_POINTS * leaf[patches->a + 1] - c.first;
    c.second = SC_LEAF_POINTS * leaf[patches->b] - c.split;
    for (uint32_t i = 0; i < count; ++i) {
        float *to = s->workspace->frame.point_at + 4 * (size_t)sc_simple_place(&c, loop[i]);
        to[0] = at[i][0];
        to[1] = at[i][1];
        to[2] = i == 1 ? 0.5f + lift : 0.5f;
    }
}

/* What the test of small contours says of a polygon, seen from above, as if it were the contour of
   a node with a longer one. */
static unsigned tell_small(posed_model *s, uint32_t node, float at[][2], uint32_t count, float lift)
{
    const uint32_t blocks = (count + SC_CONTOUR_BLOCK - 1) / SC_CONTOUR_BLOCK;
    float above[2 * 3 * SC_DNC_VECTORS] = {0};
    const float *axes = above;
    sc_node *n = (sc_node *)(uintptr_t)(sc_model_node(s->model) + node);
    const uint16_t length = n->loop_length;
    unsigned simple;
    above[0] = above[4 * SC_DNC_VECTORS] = 1;
    move_loop(s, node, at, count, lift);
    n->loop_length = (uint16_t)count;
    simple = s->workspace->frame.kernels->query->find_simple(s->workspace->worker, &node, 1, blocks,
                                                             &axes);
    n->loop_length = length;
    return simple;
}

/* A polygon of which edge i, from left to right, crosses the one that begins at point j, from above
   to below, and no others meet; or a convex one, if i is j. Between them it runs along a circle. */
static void crossed_polygon(float at[][2], uint32_t count, double size, uint32_t i, uint32_t j)
{
    const uint32_t on = j - i;
    for (uint32_t k = 0; k < count; ++k) {
        double angle = 2 * posed_model_pi * k / count;
        float *to = at[(i + 1 + k) % count];
        if (on)
            angle = k < on
                        ? posed_model_pi / 2 * k / (on - 1)
                        : posed_model_pi * 1.5 - posed_model_pi / 2 * (k - on) / (count - on - 1);
        to[0] = (float)(0.5 + size * cos(angle));
        to[1] = (float)(0.5 + size * sin(angle));
    }
}

/* A square with a slot from above; where it begins a number of a cell ends. */
static void slotted_square(float at[12][2], float size, uint32_t width)
{
    static const float shape[12][2] = {{-1, -1},  {0, -1},   {1, -1},   {1, -0.3f},
                                       {1, 0.2f}, {1, 0.6f}, {1, 1},    {0, 0.9f},
                                       {0, 0},    {0, 0},    {0, 0.9f}, {-1, 1}};
    float wall = (float)(0.5 + 10.5 * (double)size / 126);
    for (uint32_t i = 0; i < 12; ++i)
        for (uint32_t k = 0; k < 2; ++k) at[i][k] = 0.5f + size * shape[i][k];
    if ((double)wall > 0.5 + 10.5 * (double)size / 126) wall = nextafterf(wall, 0);
    at[9][0] = at[10][0] = wall;
    while (width-- > 0) wall = nextafterf(wall, 1);
    at[7][0] = at[8][0] = wall;
}

/* Small contours by themselves: convex ones are simple, and those of which any two edges cross are
   not, by any instruction set. Edges that may meet, as far as their places are known, are not
   apart, whatever cells they are in. */
static void small_contours(void)
{
    uint32_t told = 0, missed = 0, node;
    float at[64][2];
    posed_model s;
    soup mesh = soup_cloth(40, 40);
    if (!posed_model_open(&s, "small", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) ||
        !posed_model_load(&s))
        return;
    node = long_loop(s.model, 64);
    if (!CHECK(node != SC_NONE)) return;
    for (uint32_t isa = 1; isa <= (uint32_t)sc_isa_best(); ++isa) {
        s.workspace->frame.kernels = sc_kernels_for(isa);
        for (uint32_t count = SC_SMALL_EDGES; count <= 64; ++count) {
            double size = test_random_below(2) ? 0.4 : 1e-4;
            crossed_polygon(at, count, size, 0, 0);
            told += tell_small(&s, node, at, count, 0);
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t j = i + 2; j < count && (i || j + 1 < count); ++j) {
                    crossed_polygon(at, count, size, i, j);
                    missed += tell_small(&s, node, at, count, 0);
                }
        }
        slotted_square(at, 0.25f, 100000);
        CHECK(tell_small(&s, node, at, 12, 0) == 1);
        for (uint32_t width = 0; width <= 2; ++width) {
            slotted_square(at, 0.25f, width);
            CHECK_MSG(!tell_small(&s, node, at, 12, 0), "a slot of %" PRIu32, width);
        }
        slotted_square(at, 1 / 32768.0f, 8); /* wide enough, but not for one so high */
        CHECK(tell_small(&s, node, at, 12, 0) == 1);
        CHECK(!tell_small(&s, node, at, 12, 0.45f));
        slotted_square(at, 1 / 1048576.0f, 1);
        CHECK(!tell_small(&s, node, at, 12, 0));
    }
    CHECK_MSG(told == 56 * (uint32_t)sc_isa_best(), "%" PRIu32 " are simple", told);
    CHECK_MSG(!missed, "%" PRIu32 " that are not", missed);
    posed_model_close(&s);
}

/* Contours of more edges than one row of spans: convex ones pass, and those of which any two edges
   cross, and no others meet, do not, by any instruction set. */
static void two_edges_that_cross(void)
{
    static const uint32_t counts[] = {33, 34, 40, 47, 48, 49, 64, 65, 66, 67, 97, 128, 129, 160};
    enum { MOST = 160 };
    const sc_projection above = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, 0, 0};
    uint32_t told = 0, missed = 0, node;
    float at[MOST][2];
    posed_model s;
    soup mesh = soup_cloth(60, 60);
    if (!posed_model_open(&s, "crossing", &mesh, SC_WELD_NONE, SC_PARTITION_FAST) ||
        !posed_model_load(&s))
        return;
    node = long_loop(s.model, MOST);
    if (!CHECK(node != SC_NONE)) return;
    for (uint32_t isa = 1; isa <= (uint32_t)sc_isa_best(); ++isa)
        for (uint32_t k = 0; k < sizeof(counts) / sizeof(*counts); ++k) {
            const uint32_t count = counts[k];
            sc_node *n = (sc_node *)(uintptr_t)(sc_model_node(s.model) + node);
            const uint16_t length = n->loop_length;
            s.workspace->frame.kernels = sc_kernels_for(isa);
            n->loop_length = (uint16_t)count;
            crossed_polygon(at, count, 0.4, 0, 0);
            move_loop(&s, node, at, count, 0);
            told += sc_simple_test(s.workspace->worker, &above, node) != 0;
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t j = i + 2; j < count && (i || j + 1 < count); ++j) {
                    crossed_polygon(at, count, 0.4, i, j);
                    move_loop(&s, node, at, count, 0);
                    missed += sc_simple_test(s.workspace->worker, &above, node) != 0;
                }
            n->loop_length = length;
        }
    CHECK_MSG(told == 14 * (uint32_t)sc_isa_best(), "%" PRIu32 " are simple", told);
    CHECK_MSG(!missed, "%" PRIu32 " that are not", missed);
    posed_model_close(&s);
}

/* Contours that are looked at together pass or fail as each does by itself. */
static void contours_together(void)
{
    enum { MOST = 60 };
    uint32_t wrong = 0, in_pieces = 0, count[2] = {0, 0};
    for (uint32_t round = 0; round < test_iterations(30); ++round) {
        posed_model s;
        soup mesh = round % 4 == 0   ? soup_cloth(30 + round, 20)
                    : round % 4 == 1 ? soup_sphere(20 + round, 16)
                    : round % 4 == 2 ? soup_branched(8 + round, 10)
                                     : nested_discs();
        uint32_t nodes[MOST], most = 1 + test_random_below(MOST), n = 0;
        uint8_t passed[MOST];
        if (!posed_model_open(&s, "together", &mesh, SC_WELD_NONE, SC_PARTITION_FAST)) continue;
        if (round % 4 < 2) soup_smooth(s.pose, s.mesh.vertex_count, 0.02 * round);
        if (!posed_model_load(&s)) continue;
        s.workspace->frame.kernels = sc_kernels_for(1 + round % (uint32_t)sc_isa_best());
        for (uint32_t p = 0; p < s.model->patch_end && round % 3 == 1; ++p) /* seen from anywhere */
            s.workspace->frame.mask[p] = (uint16_t)(1u << test_random_below(SC_DNC_DIRECTIONS) |
                                                    1u << test_random_below(SC_DNC_DIRECTIONS));
        for (uint32_t node = 0; node < s.model->node_count; ++node) {
            const sc_pair *patches = &sc_model_node(s.model)[node].patches;
            if (s.workspace->frame.mask[patches->a] & s.workspace->frame.mask[patches->b])
                nodes[n++] = node;
            if (n < most && node + 1 < s.model->node_count) continue;
            sc_simple_tests(s.workspace->worker, nodes, n, passed);
            for (uint32_t i = 0; i < n; ++i) {
                sc_projection projection;
                patches = &sc_model_node(s.model)[nodes[i]].patches;
                sc_dnc_projection(&s.workspace->frame,
                                  (uint32_t)s.workspace->frame.mask[patches->a] &
                                      s.workspace->frame.mask[patches->b],
                                  &projection);
                wrong += sc_simple_test(s.workspace->worker, &projection, nodes[i]) != passed[i];
                ++count[passed[i] != 0];
                in_pieces += (sc_model_node(s.model)[nodes[i]].kind & SC_NODE_PIECES) != 0;
            }
            n = 0;
        }
        posed_model_close(&s);
    }
    CHECK_MSG(!wrong, "%" PRIu32 " of %" PRIu32 " differ", wrong, count[0] + count[1]);
    CHECK(!test_is_full() || (count[0] > 50 && count[1] > 1000 && in_pieces > 10));
    printf("    contours_together: %" PRIu32 " pass, %" PRIu32 " do not\n", count[1], count[0]);
}

/* Whether a contour is one that may be left open though it is simple: if it passes a point three
   times, how its edges lie round that is not looked at; if pieces share a point, one of them may
   begin there, of which nobody can say then how often the others go round it. */
static int is_left_open(const sc_model *model, const sc_workspace *workspace, uint32_t node)
{
    uint32_t most = 0;
    sc_simple_contour c;
    if (!sc_simple_list(&c, model, &workspace->worker->contour, node)) return 0;
    for (uint32_t i = 0; i < c.count; ++i) {
        uint32_t begin = 0;
        for (uint32_t k = 0; k < c.count; ++k)
            begin += c.edges->point[k] == c.edges->point[i] &&
                     (c.edges->is_edge[k / SC_CONTOUR_BLOCK] >> k % SC_CONTOUR_BLOCK & 1);
        if (begin > most) most = begin;
    }
    return most > 2 || (most > 1 && c.in_pieces);
}

/* A flat square grid, in any direction: no contour crosses itself, and where two patches share one
   point the lines of the grid go straight on from one to the other. */
static void flat_cloths_pass(void)
{
    enum { ALL_PASS = 12 }; /* in the first of these cloths; none of --scale 100 is left open */
    uint32_t touching = 0, all = 0, open = 0;
    for (uint32_t i = 0; i < test_iterations(ALL_PASS); ++i) {
        posed_model s;
        soup mesh = soup_cloth(20 + i, 30);
        if (!posed_model_open(&s, "flat cloth", &mesh, SC_WELD_NONE, SC_PARTITION_FAST)) continue;
        if (i % 3) posed_model_rotate(s.pose, s.mesh.vertex_count);
        if (posed_model_load(&s)) {
            uint32_t failed = 0, node;
            s.workspace->frame.kernels = sc_kernels_for(1 + i % (uint32_t)sc_isa_best());
            for (node = 0; node < s.model->node_count; ++node) {
                const sc_pair *patches = &sc_model_node(s.model)[node].patches;
                uint32_t mask = (uint32_t)s.workspace->frame.mask[patches->a] &
                                s.workspace->frame.mask[patches->b];
                sc_projection projection;
                sc_dnc_projection(&s.workspace->frame, mask, &projection);
                ++all;
                if (!CHECK(mask != 0) || !sc_simple_test(s.workspace->worker, &projection, node))
                    ++*(i >= ALL_PASS && is_left_open(s.model, s.workspace, node) ? &open
                                                                                  : &failed);
                touching += (sc_model_node(s.model)[node].kind & SC_NODE_TOUCHES) != 0;
            }
            CHECK_MSG(!failed, "%" PRIu32 " of %" PRIu32 " nodes failed", failed,
                      s.model->node_count);
        }
        posed_model_close(&s);
    }
    CHECK(!test_is_full() || touching > 100);
    CHECK_MSG(open <= all / 100, "%" PRIu32 " of %" PRIu32 " nodes are left open", open, all);
}

/* Two patches that share one point p and, round a loop, points h at which so many patches meet that
   these make nobody adjacent. The second patch folds over the first. */
static void patches_that_share_hubs(void)
{
    enum { FINS = 60, HUBS = 3, TRIANGLES = 6 + HUBS * FINS };
    static const double flat[9][2] = {{0, 0},   {10, -5}, {4, 0}, {10, 5}, {9, -6},
                                      {9, 4.4}, {9.5, 0}, {9, 6}, {0, 0}};
    static const uint32_t corners[6][3] = {{0, 1, 2}, {0, 2, 3}, {1, 0, 4},
                                           {2, 1, 5}, {3, 2, 6}, {0, 3, 7}};
    for (uint32_t turn = 0; turn < 12; ++turn) {
        soup mesh = soup_make(9 + 2 * HUBS * FINS, TRIANGLES);
        uint32_t order[TRIANGLES], v = 9, leaves = 2 + HUBS * FINS, count = 1, head;
        uint32_t first[512], number[512];
        sc_tree_node tree[512];
        sc_build_options options;
        double c = cos(posed_model_pi * turn / 6 + 0.1), d = sin(posed_model_pi * turn / 6 + 0.1);
        posed_model_tally tally;
        posed_model s;
        sc_mesh m;
        memset(&tally, 0, sizeof(tally));
        memcpy(mesh.triangles, corners, sizeof(corners));
        for (uint32_t i = 0; i < 9; ++i) {
            double *p = mesh.positions + 3 * (size_t)i;
            p[0] = c * flat[i][0] - d * flat[i][1];
            p[1] = d * flat[i][0] + c * flat[i][1];
            p[2] = 0;
        }
        for (uint32_t i = 0; i < HUBS * FINS; ++i) {
            uint32_t *t = mesh.triangles + 3 * (size_t)(6 + i);
            t[0] = 1 + i % HUBS;
            t[1] = v++;
            t[2] = v++;
            for (uint32_t k = 3 * t[1]; k < 3 * v; ++k)
                mesh.positions[k] = test_random_range(20, 30);
        }
        /* leaves: the first two triangles, the next four, then each fin; halved at every node */
        for (uint32_t i = 0; i < TRIANGLES; ++i) order[i] = i;
        memset(tree, 0, sizeof(tree));
        first[0] = 0;
        number[0] = leaves;
        for (head = 0; head < count; ++head) {
            sc_tree_node *n = &tree[head];
            if (number[head] == 1) {
                n->left = n->right = SC_NONE;
                n->first = first[head] == 0 ? 0 : first[head] == 1 ? 2 : first[head] + 4;
                n->count = first[head] == 0 ? 2 : first[head] == 1 ? 4 : 1;
                continue;
            }
            n->left = count++;
            n->right = count++;
            first[n->left] = first[head];
            number[n->left] = number[head] / 2;
            first[n->right] = first[head] + number[n->left];
            number[n->right] = number[head] - number[n->left];
        }
        memset(&options, 0, sizeof(options));
        options.struct_size = sizeof(options);
        options.partition = SC_PARTITION_TREE;
        options.order = order;
        options.tree = tree;
        options.tree_count = count;
        memset(&s, 0, sizeof(s));
        s.name = "shared hubs";
        s.mesh = mesh;
        s.pose = soup_copy_positions(&mesh);
        s.choices.partition_name = "tree";
        m = input_plain_mesh(&mesh);
        if (CHECK(sc_build(&m, &options, &s.model) == SC_OK) &&
            CHECK(sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK) &&
            posed_model_load(&s)) {
            posed_model_check_nodes(&s, &tally);
            CHECK(tally.colliding > 0);
        }
        posed_model_close(&s);
    }
}

SC_TEST_MAIN(SC_TEST(contours_at_shared_points), SC_TEST(contours_in_pieces),
             SC_TEST(points_in_the_unit_box), SC_TEST(poses_of_any_layout),
             SC_TEST(places_of_contours), SC_TEST(small_contours), SC_TEST(two_edges_that_cross),
             SC_TEST(contours_together), SC_TEST(pinches_alone), SC_TEST(flat_cloths_pass),
             SC_TEST(patches_that_share_hubs))
