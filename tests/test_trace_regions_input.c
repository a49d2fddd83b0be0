/*
 * Regions: what cannot be. Memory that fails, a search that is cancelled, contours that are of no
 * mesh or of another one, edges under two names, counts and arguments that are wrong.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "divided_scene.h"
#include "harness.h"

static void failing_memory(void)
{
    divided_scene d;
    uint32_t vertices, triangles;
    int is_done = 0;
    if (divide(&d, two_spheres(10, 0.5, 0.7, &vertices, &triangles)))
        for (uint32_t times = 0; !is_done && times < 100; ++times) {
            sc_trace_options options;
            sc_regions_result r = d.regions;
            scarce_memory memory;
            sc_status status;
            memset(&options, 0, sizeof options);
            options.struct_size = sizeof options;
            options.allocator = &memory.allocator;
            scarce_memory_start(&memory, times);
            status = sc_trace_regions(d.s.model, &d.s.pose, &d.s.result, &options, &r);
            is_done = status == SC_OK;
            CHECK(is_done || (status == SC_ERROR_MEMORY && !r.region_count));
            CHECK(memory.live == 0);
        }
    CHECK(is_done);
    undivide(&d);
}

/* Cancelled by the allocator, each time it is called: so after each step. */
static void cancelling(void)
{
    divided_scene d;
    uint32_t vertices, triangles;
    int is_done = 0;
    if (divide(&d, two_spheres(10, 0.5, 0.7, &vertices, &triangles)))
        for (uint32_t times = 0; !is_done && times < 100; ++times) {
            sc_trace_options options;
            sc_regions_result r = d.regions;
            scarce_memory memory;
            sc_status status;
            memset(&options, 0, sizeof options);
            options.struct_size = sizeof options;
            scarce_memory_start(&memory, times);
            memory.cancels = 1;
            options.allocator = &memory.allocator;
            options.cancel = &memory.cancelled;
            status = sc_trace_regions(d.s.model, &d.s.pose, &d.s.result, &options, &r);
            is_done = !memory.cancelled;
            CHECK(is_done ? status == SC_OK && r.region_count == d.regions.region_count
                          : status == SC_ERROR_INCOMPLETE && r.region_count == 0);
            CHECK(memory.live == 0);
        }
    CHECK(is_done);
    undivide(&d);
}

static sc_status ask(const divided_scene *d, const sc_trace_result *trace)
{
    sc_regions_result r = d->regions;
    const sc_status status = sc_trace_regions(d->s.model, &d->s.pose, trace, NULL, &r);
    CHECK(status == SC_OK || status == SC_ERROR_SHORT_BUFFER || r.region_count == 0);
    return status;
}

/* Another name of an edge of a closed surface: that of its other triangle. */
static uint32_t other_name(const soup *s, uint32_t edge)
{
    const uint32_t *v = s->triangles;
    uint32_t h = 0;
    while (v[h] != v[edge - edge % 3 + (edge + 1) % 3] || v[h - h % 3 + (h + 1) % 3] != v[edge])
        ++h;
    return h;
}

/* Traces that name what exists, but in contours that cannot be. */
static void impossible_contours(void)
{
    divided_scene d;
    uint32_t vertices, triangles;
    uint64_t i = 1;
    if (divide(&d, two_spheres(10, 0.5, 0.7, &vertices, &triangles)) &&
        CHECK(d.s.result.node_count > 8 && d.s.result.contours[0].begin == SC_TRACE_CLOSED)) {
        const size_t bytes = (size_t)d.s.result.node_count * sizeof(sc_trace_node);
        sc_trace_result t = d.s.result;
        sc_trace_contour contours[2];
        sc_trace_node *nodes = (sc_trace_node *)test_allocate(bytes);
        uint32_t s;
        memcpy(nodes, t.nodes, bytes);
        t.nodes = nodes;
        CHECK(ask(&d, &t) == SC_OK);
        /* from edge to edge through a triangle that has none of them, or not the second one */
        while (i + 1 < t.contours[0].count && nodes[i].sheet != nodes[i + 1].sheet) ++i;
        s = nodes[i].sheet;
        if (CHECK(i + 1 < t.contours[0].count)) {
            nodes[i].sheets[s] = d.s.result.nodes[i].sheets[1 - s];
            CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
            nodes[i].sheets[s] = nodes[i - 1].sheets[s];
            CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
            nodes[i] = d.s.result.nodes[i];
        }
        /* through an edge, and by the same back into the triangle it came from */
        for (i = 0; i + 1 < t.contours[0].count && nodes[i].sheet == nodes[i + 1].sheet;) ++i;
        t.contours = contours;
        t.contour_count = 1;
        contours[0] = d.s.result.contours[0];
        contours[0].first = i;
        contours[0].count = 2;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        /* nodes that are in two contours, and that are not there */
        contours[0] = contours[1] = d.s.result.contours[0];
        CHECK(contours[0].count > t.node_count / 2);
        t.contour_count = t.contour_capacity = 2;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        t.contour_count = 1;
        contours[0].count = 2;
        contours[0].first = t.node_count + 1;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        free(nodes);
    }
    undivide(&d);
}

/* An octahedron, and two triangles that cross its lower edges: one edge by two names. */
static void edges_with_two_names(void)
{
    soup all = octahedron(1);
    divided_scene d;
    for (int i = 0; i < 2; ++i) {
        const double z = -0.25 * i;
        const double big[9] = {-3, -2, z, 3, -2, z, 0, 4, z};
        soup one = soup_make(3, 1);
        memcpy(one.positions, big, sizeof big);
        for (uint32_t k = 0; k < 3; ++k) one.triangles[k] = k;
        add_soup(&all, one);
    }
    if (divide(&d, all) && CHECK(d.s.result.node_count == 8)) {
        sc_trace_node *node = d.s.result.nodes;
        CHECK(ask(&d, &d.s.result) == SC_OK);
        node->edge = other_name(&d.s.mesh, node->edge);
        node->along = 1 - node->along;
        CHECK(ask(&d, &d.s.result) == SC_ERROR_PAIRS);
    }
    undivide(&d);
}

/* Traces of more than there is room for, or of more than can be. */
static void wrong_counts(void)
{
    divided_scene d;
    uint32_t vertices, triangles;
    if (divide(&d, two_spheres(10, 0.5, 0.7, &vertices, &triangles))) {
        sc_trace_result t = d.s.result;
        --t.node_capacity;
        CHECK(ask(&d, &t) == SC_ERROR_SHORT_BUFFER);
        t = d.s.result;
        --t.contour_capacity;
        CHECK(ask(&d, &t) == SC_ERROR_SHORT_BUFFER);
        t = d.s.result;
        t.node_count = t.node_capacity = (UINT64_C(1) << 30) + 1;
        CHECK(ask(&d, &t) == SC_ERROR_COUNT);
        t = d.s.result;
        t.contour_count = t.contour_capacity = (UINT64_C(1) << 30) + 1;
        CHECK(ask(&d, &t) == SC_ERROR_COUNT);
    }
    undivide(&d);
}

static void wrong_arguments(void)
{
    divided_scene d;
    uint32_t vertices, triangles;
    if (divide(&d, two_spheres(10, 0.5, 0.7, &vertices, &triangles)) &&
        CHECK(d.s.result.node_count > 2)) {
        const size_t bytes = (size_t)d.s.result.node_count * sizeof(sc_trace_node);
        sc_trace_result t = d.s.result;
        sc_regions_result r = d.regions;
        sc_trace_contour contour = t.contours[0];
        sc_trace_options options;
        sc_pose pose = d.s.pose;
        volatile uint32_t flag = 1;
        double *bad;
        sc_trace_node *nodes = (sc_trace_node *)test_allocate(bytes);
        memcpy(nodes, t.nodes, bytes);
        CHECK(sc_trace_regions(NULL, &pose, &t, NULL, &r) == SC_ERROR_NULL && !r.region_count);
        CHECK(sc_trace_regions(d.s.model, NULL, &t, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace_regions(d.s.model, &pose, NULL, NULL, &r) == SC_ERROR_NULL);
        CHECK(sc_trace_regions(d.s.model, &pose, &t, NULL, NULL) == SC_ERROR_NULL);
        r.regions = NULL;
        CHECK(sc_trace_regions(d.s.model, &pose, &t, NULL, &r) == SC_ERROR_NULL);
        r = d.regions;
        r.flags = 2;
        CHECK(sc_trace_regions(d.s.model, &pose, &t, NULL, &r) == SC_ERROR_OPTION);
        r = d.regions;
        r.struct_size = 4;
        CHECK(sc_trace_regions(d.s.model, &pose, &t, NULL, &r) == SC_ERROR_STRUCT_SIZE);
        r = d.regions;
        r.region_capacity--;
        CHECK(sc_trace_regions(d.s.model, &pose, &t, NULL, &r) == SC_ERROR_SHORT_BUFFER &&
              r.region_count == d.regions.region_count);
        t.nodes = NULL;
        CHECK(ask(&d, &t) == SC_ERROR_NULL);
        t = d.s.result;
        t.contours = NULL;
        CHECK(ask(&d, &t) == SC_ERROR_NULL);
        t = d.s.result;
        t.nodes = nodes;
        nodes[1].edge = 3 * d.s.mesh.triangle_count;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        nodes[1] = d.s.result.nodes[1];
        nodes[1].triangle = d.s.mesh.triangle_count;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        nodes[1] = d.s.result.nodes[1];
        nodes[1].sheet = 2;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        nodes[1] = d.s.result.nodes[1];
        nodes[1].sheets[0] = d.s.mesh.triangle_count;
        nodes[1].sheets[1] = d.s.mesh.triangle_count;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        nodes[1] = d.s.result.nodes[1];
        t.contours = &contour;
        t.contour_count = 1;
        contour.count = t.node_count + 1;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        contour.count = 1;
        CHECK(ask(&d, &t) == SC_ERROR_PAIRS);
        t = d.s.result;
        memset(&options, 0, sizeof options);
        options.struct_size = sizeof options;
        options.cancel = &flag;
        r = d.regions;
        CHECK(sc_trace_regions(d.s.model, &pose, &t, &options, &r) == SC_ERROR_INCOMPLETE &&
              r.region_count == 0);
        bad = soup_copy_positions(&d.s.mesh);
        bad[4] = (double)INFINITY;
        pose = input_plain_pose(bad, d.s.mesh.vertex_count);
        CHECK(sc_trace_regions(d.s.model, &pose, &t, NULL, &r) == SC_ERROR_NOT_FINITE);
        free(bad);
        free(nodes);
        options.cancel = NULL;
        options.simd = SC_SIMD_AVX512 + 1;
        CHECK(sc_trace_regions(d.s.model, &d.s.pose, &t, &options, &r) == SC_ERROR_OPTION);
        CHECK(sc_region_hint(NULL, d.regions.sides, 0) == SC_TRACE_NO_EDGE);
        CHECK(sc_region_hint(d.regions.regions, NULL, 0) == SC_TRACE_NO_EDGE);
        CHECK(sc_region_hint(d.regions.regions, d.regions.sides, 2) == SC_TRACE_NO_EDGE);
    }
    undivide(&d);
}

SC_TEST_MAIN(SC_TEST(failing_memory), SC_TEST(cancelling), SC_TEST(impossible_contours),
             SC_TEST(edges_with_two_names), SC_TEST(wrong_counts), SC_TEST(wrong_arguments))
