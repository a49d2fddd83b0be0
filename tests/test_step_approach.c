/*
 * SC_STEP_BEGUN_NEARER: steps leave out pairs that come no nearer than they began, and no others.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "near_oracle.h"
#include "shapes.h"
#include "step_check.h"

static double distance_of(int is_edges, const double p[4][3])
{
    return is_edges ? near_oracle_distance_edge_edge(p) : near_oracle_distance_vertex_face(p);
}

/* The separation of a pair is its distance at the start less two tolerances, by exact arithmetic;
   also of pairs almost without width. */
static void own_separations(void)
{
    for (int i = 0, n = (int)test_iterations(20000); i < n; ++i) {
        double p[4][3], thin = i % 3 ? 1 : ldexp(1, -(int)test_random_below(60)), own, wanted;
        const double(*at)[3] = (const double(*)[3])p;
        const double tolerance = ldexp(1, -5 - (int)test_random_below(20));
        sc_impact_limits limits = {8, tolerance, 1};
        int is_edges = i & 1;
        for (int k = 0; k < 12; ++k)
            p[k / 3][k % 3] = (test_random_unit() - 0.5) * (k % 3 ? thin : 1);
        own = sc_impact_nearer(is_edges, at, at, &limits);
        wanted = distance_of(is_edges, at) - 2 * tolerance;
        if (!CHECK_MSG(own <= (wanted > 0 ? wanted : 0) + 0.57 * tolerance &&
                           own >= wanted - 0.07 * tolerance,
                       "%.17g, should be %.17g", own, wanted))
            return;
    }
}

/* The same where rounding hides that the nearest point is inside: of thin pairs in any direction,
   whose distance is about half their width. */
static void own_separations_of_slivers(void)
{
    for (int i = 0, n = (int)test_iterations_at_least(40000, 20000); i < n; ++i) {
        double p[4][3], axis[3], size = 0, own, wanted, tolerance;
        const double(*at)[3] = (const double(*)[3])p;
        const double width = ldexp(1, -25 - (int)test_random_below(5));
        const int is_edges = i & 1, first = is_edges ? 2 : 1;
        sc_impact_limits limits = {8, 0, 1};
        for (int k = 0; k < 3; ++k) axis[k] = test_random_range(-1, 1);
        for (int j = 0; j < 4; ++j) {
            const double along = test_random_range(-1, 1);
            for (int k = 0; k < 3; ++k) p[j][k] = along * axis[k] + test_random_range(0, width);
        }
        for (int j = 0; j < first; ++j)
            for (int k = first; k < 4; ++k)
                for (int c = 0; c < 3; ++c) size = fmax(size, fabs(p[k][c] - p[j][c]));
        tolerance = SC_IMPACT_FLOOR * size;
        own = sc_impact_nearer(is_edges, at, at, &limits);
        wanted = distance_of(is_edges, at) - 2 * tolerance;
        if (!CHECK_MSG(own <= (wanted > 0 ? wanted : 0) + 0.57 * tolerance &&
                           own >= wanted - 0.07 * tolerance,
                       "%.17g, should be %.17g", own, wanted))
            return;
    }
}

/* The separation of those farther apart than a double can say is all that is asked for; of pairs
   that are too small for a tolerance it is 0. */
static void own_separations_out_of_range(void)
{
    static const double sizes[3] = {0x1.8p1023, 1, 0x1.8p-904};
    for (int i = 0; i < 6; ++i) {
        const int is_edges = i & 1;
        const double size = sizes[i / 2];
        const sc_impact_limits limits = {size > 1 ? DBL_MAX : 1, 0, 1};
        double p[4][3], own;
        const double(*at)[3] = (const double(*)[3])p;
        for (int k = 0; k < 12; ++k) p[k / 3][k % 3] = k < (is_edges ? 6 : 3) ? size : -size;
        p[3][2] = size;
        CHECK(distance_of(is_edges, at) > size);
        own = sc_impact_nearer(is_edges, at, at, &limits);
        CHECK_MSG(own == (size < 1 ? 0 : limits.separation), "%g", own);
    }
}

/* A flat cloth, thicker than its cells, moves as a whole, or swells: no pair. As it shrinks there
   are pairs. By all methods. */
static void cloth_at_rest(void)
{
    soup mesh = soup_cloth(12, 12);
    const size_t count = 3 * (size_t)mesh.vertex_count;
    double *end = (double *)test_allocate(count * sizeof(double));
    step_subject s;
    if (!step_open(&s, &mesh, NULL)) return;
    for (int motion = 0; motion < 3; ++motion) {
        sc_pose from, to;
        for (size_t i = 0; i < count; ++i)
            end[i] = motion == 0   ? mesh.positions[i] + (i % 3 == 2 ? -0.25 : 0.125)
                     : motion == 1 ? 1.5 * mesh.positions[i]
                                   : 0.5 * mesh.positions[i];
        from = input_plain_pose(mesh.positions, mesh.vertex_count);
        to = input_plain_pose(end, mesh.vertex_count);
        uint64_t first = 0;
        for (uint32_t method = SC_STEP_METHOD_SCTT; method <= SC_STEP_METHOD_SWEPT; ++method) {
            sc_step_options o = step_plain_options();
            sc_step_result r;
            uint64_t found;
            memset(&r, 0, sizeof(r));
            r.struct_size = sizeof(r);
            o.output = SC_OUTPUT_COUNT;
            o.times = SC_STEP_TIMES_EARLIEST;
            o.method = method;
            o.separation = 0.15;
            o.tolerance = 1e-4;
            CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &r) == SC_OK);
            CHECK(r.edge_edge_count > 0 && r.vertex_face_count > 0 && r.earliest == 0);
            o.begun = SC_STEP_BEGUN_NEARER;
            CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &r) == SC_OK);
            found = r.edge_edge_count + r.vertex_face_count;
            CHECK(motion == 2 ? found > 0 && r.earliest > 0 && r.earliest < 1
                              : found == 0 && r.earliest == 1);
            if (method == SC_STEP_METHOD_SCTT) first = found;
            CHECK(found == first);
            o.begun = 2;
            CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &r) == SC_ERROR_OPTION);
            o.begun = 0;
            o.reserved2 = 1;
            CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &r) == SC_ERROR_OPTION);
            o.begun = SC_STEP_BEGUN_NEARER; /* not read: an older structure */
            o.struct_size = (uint32_t)(sizeof(o) - 8);
            CHECK(sc_query_step(s.model, s.workspace, &from, &to, &o, &r) == SC_OK);
            CHECK(r.edge_edge_count > 0 && r.earliest == 0);
        }
    }
    step_close(&s);
    free(end);
    soup_free(&mesh);
}

SC_TEST_MAIN(SC_TEST(own_separations), SC_TEST(own_separations_of_slivers),
             SC_TEST(own_separations_out_of_range), SC_TEST(cloth_at_rest))
