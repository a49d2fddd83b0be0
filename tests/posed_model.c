/*
 * See posed_model.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "posed_model.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "oracle.h"
#include "pose/contour_bounds.h"
#include "pose/positions.h"
#include "query/simple.h"
#include "query/star.h"
#include "shapes.h"

sc_question posed_model_nothing_asked;

void posed_model_project(const sc_workspace *w, const sc_projection *projection, int line,
                         uint32_t point, double *x, double *y)
{
    sc_contour_bounds bounds;
    memset(&bounds, 0, sizeof(bounds));
    bounds.positions = &w->frame.positions[0];
    bounds.projection = *projection;
    sc_contour_bounds_project(&bounds, line, point, x, y);
}

int posed_model_load(posed_model *s)
{
    sc_pose pose = input_plain_pose(s->pose, s->mesh.vertex_count);
    sc_workspace_begin(s->model, s->workspace, &posed_model_nothing_asked);
    if (!CHECK(sc_positions_read(s->model, &pose, 24, &s->workspace->frame) == SC_OK)) return 0;
    sc_dnc_update(s->model, &s->workspace->frame);
    return 1;
}

int posed_model_open(posed_model *s, const char *name, const soup *mesh, uint32_t weld,
                     uint32_t partition)
{
    sc_mesh m;
    memset(s, 0, sizeof(*s));
    s->name = name;
    s->mesh = *mesh;
    s->pose = soup_copy_positions(mesh);
    s->choices = input_choose(mesh, weld, partition);
    m = input_plain_mesh(mesh);
    return CHECK(sc_build(&m, &s->choices.options, &s->model) == SC_OK) &&
           CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK);
}

void posed_model_close(posed_model *s)
{
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
    input_free_choices(&s->choices);
    free(s->pose);
    soup_free(&s->mesh);
}

void posed_model_rotate(double *positions, uint32_t count)
{
    double axis[3], size = 0, angle = test_random_range(0, 2 * posed_model_pi), c = cos(angle),
                    d = sin(angle);
    for (int k = 0; k < 3; ++k) axis[k] = test_random_range(-1, 1);
    for (int k = 0; k < 3; ++k) size += axis[k] * axis[k];
    for (int k = 0; k < 3; ++k) axis[k] /= sqrt(size);
    for (uint32_t v = 0; v < count; ++v) {
        double *p = positions + 3 * (size_t)v, q[3];
        double along = (1 - c) * (axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
        for (int k = 0; k < 3; ++k)
            q[k] = c * p[k] + along * axis[k] +
                   d * (axis[(k + 1) % 3] * p[(k + 2) % 3] - axis[(k + 2) % 3] * p[(k + 1) % 3]);
        memcpy(p, q, sizeof(q));
    }
}

void posed_model_any_pose(double *positions, uint32_t count)
{
    switch (test_random_below(6)) {
    case 0:
        soup_any_pose(positions, count);
        break;
    case 1:
        soup_smooth(positions, count, 0.03);
        break;
    case 2: /* bent in its plane, up to twice round */
        for (uint32_t v = 0; v < count; ++v) positions[3 * (size_t)v + 1] *= 0.1;
        shape_bend(positions, count, test_random_range(0.3, 2));
        break;
    case 3: /* sheared and nearly flat */
        for (uint32_t v = 0; v < count; ++v) {
            double *p = positions + 3 * (size_t)v;
            p[0] += 2 * p[1];
            p[2] *= 0.1;
        }
        soup_smooth(positions, count, 0.05);
        break;
    case 4:
        soup_twist(positions, count, test_random_range(0.1, 1));
        break;
    default:
        break;
    }
    posed_model_rotate(positions, count);
    if (test_random_below(6) == 0) soup_noise(positions, count, 0.02);
    if (test_random_below(6) == 0) soup_round_to_float(positions, count);
    if (test_random_below(8) == 0) soup_snap(positions, count, 0.0625);
    if (test_random_below(8) == 0) soup_move(positions, count, 1e5);
}

void posed_model_open_any(posed_model *s, uint32_t maximum)
{
    const char *name = "soup";
    soup mesh = test_random_below(8) == 0 ? soup_on_grid(2) : shape_any(maximum, &name);
    posed_model_open(s, name, &mesh, test_random_below(3), test_random_below(4));
}

const double *posed_model_place(const sc_workspace *w, uint32_t point)
{
    return (const double *)(const void *)w->frame.positions[0].at + 3 * (size_t)point;
}

double posed_model_part(const sc_workspace *w, uint32_t point, int k)
{
    return posed_model_place(w, point)[k];
}

void posed_model_exact_dot(mpq_t result, const double v[3], const double *p, const double *q)
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    mpq_set_ui(result, 0, 1);
    for (int k = 0; k < 3; ++k) {
        mpq_set_d(a, p[k]);
        mpq_set_d(b, q[k]);
        mpq_sub(a, a, b);
        mpq_set_d(b, v[k]);
        mpq_mul(a, a, b);
        mpq_add(result, result, a);
    }
    mpq_clears(a, b, NULL);
}

void posed_model_directions(const sc_workspace *w, double directions[SC_DNC_DIRECTIONS][3])
{
    for (int d = 0; d < SC_DNC_DIRECTIONS; ++d) {
        sc_projection p;
        sc_dnc_projection(&w->frame, 1u << d, &p);
        for (int k = 0; k < 3; ++k) {
            double c = p.u[(k + 1) % 3] * p.w[(k + 2) % 3] - p.u[(k + 2) % 3] * p.w[(k + 1) % 3];
            directions[d][k] = (c > 0) - (c < 0);
        }
    }
}

int posed_model_is_in(const sc_model *m, uint32_t patch, uint32_t place)
{
    return place >= sc_model_leaf_first(m)[sc_model_leaf(m)[patch]] &&
           place < sc_model_leaf_first(m)[sc_model_leaf(m)[patch + 1]];
}

int posed_model_has_pair(const sc_model *m, uint32_t node, int whole, const sc_pair *pairs,
                         uint64_t count)
{
    uint32_t a = sc_model_node(m)[node].patches.a, b = sc_model_node(m)[node].patches.b;
    int touches = !whole && sc_model_node(m)[node].kind & SC_NODE_TOUCHES;
    for (uint64_t i = 0; i < count; ++i) {
        int first_a = posed_model_is_in(m, a, pairs[i].a),
            first_b = posed_model_is_in(m, b, pairs[i].a);
        int second_a = posed_model_is_in(m, a, pairs[i].b),
            second_b = posed_model_is_in(m, b, pairs[i].b);
        if (touches ? (first_a && second_b) || (first_b && second_a)
                    : (first_a || first_b) && (second_a || second_b))
            return 1;
    }
    return 0;
}

/* The oracle's touching triangle pairs of the pose, as places. */
static oracle_answer solve_in_places(const posed_model *s)
{
    oracle_answer answer;
    uint32_t *weld = input_weld_of(&s->choices, &s->mesh), i;
    uint32_t *place = (uint32_t *)test_allocate(s->mesh.triangle_count * sizeof(uint32_t));
    oracle_list *list = &answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    oracle_solve(s->pose, s->mesh.vertex_count, s->mesh.triangles, s->mesh.triangle_count, weld,
                 &answer);
    for (i = 0; i < s->mesh.triangle_count; ++i) place[sc_model_triangle_id(s->model)[i]] = i;
    for (uint64_t k = 0; k < list->count; ++k) {
        list->pairs[k].a = place[list->pairs[k].a];
        list->pairs[k].b = place[list->pairs[k].b];
    }
    free(place);
    free(weld);
    return answer;
}

void posed_model_check_nodes(posed_model *s, posed_model_tally *tally)
{
    const sc_model *m = s->model;
    oracle_answer answer = solve_in_places(s);
    const oracle_list *list = &answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    uint32_t wrong = 0, node;
    for (node = 0; node < m->node_count; ++node) {
        const sc_pair *patches = &sc_model_node(m)[node].patches;
        uint32_t mask =
            (uint32_t)s->workspace->frame.mask[patches->a] & s->workspace->frame.mask[patches->b];
        int bad, worse, tries, touches = sc_model_node(m)[node].kind & SC_NODE_TOUCHES;
        if (mask == 0) continue;
        bad = posed_model_has_pair(m, node, 0, list->pairs, list->count);
        worse = posed_model_has_pair(m, node, 1, list->pairs, list->count);
        for (tries = 0; tries < 3; ++tries) {
            sc_projection projection;
            int passed;
            sc_dnc_projection(&s->workspace->frame, tries == 0 ? mask : test_random_part(mask),
                              &projection);
            sc_contour_bounds_begin(m, &s->workspace->frame.positions[0], &projection,
                                    &s->workspace->bounds);
            passed = sc_star_test(s->workspace->worker, node);
            wrong += passed && bad;
            passed = sc_simple_test(s->workspace->worker, &projection, node);
            wrong += passed && worse;
            tally->simple += (uint64_t)passed;
            tally->pinched += (uint64_t)(passed && touches);
            passed = sc_star_test(s->workspace->worker, node);
            tally->oriented++;
            tally->passed += (uint64_t)passed;
            tally->touching += (uint64_t)touches;
            tally->touching_passed += (uint64_t)(touches && passed);
            tally->colliding += (uint64_t)bad;
        }
    }
    CHECK_MSG(wrong == 0,
              "%s, partition %s, weld %" PRIu32 ": %" PRIu32 " nodes passed in spite of %" PRIu64
              " pairs",
              s->name, s->choices.partition_name, s->choices.options.weld, wrong, list->count);
    oracle_free(&answer);
}
