/*
 * Scenes with regions. See divided_scene.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "divided_scene.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

sc_regions_result no_regions(void)
{
    sc_regions_result r;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    return r;
}

int divide(divided_scene *d, soup mesh)
{
    sc_regions_result *r = &d->regions;
    sc_status status;
    *r = no_regions();
    r->flags = SC_REGIONS_INSIDE;
    if (!trace_scene_open(&d->s, mesh, SC_MODEL_FULL)) return 0;
    status = sc_trace_regions(d->s.model, &d->s.pose, &d->s.result, NULL, r);
    if (!CHECK_MSG(status == SC_ERROR_SHORT_BUFFER && r->region_count > 0, "%s",
                   sc_status_string(status)))
        return 0;
    r->region_capacity = r->region_count;
    r->regions = (sc_region *)test_allocate((size_t)r->region_count * sizeof *r->regions);
    r->vertex_regions =
        (uint32_t *)test_allocate(d->s.mesh.vertex_count * sizeof *r->vertex_regions);
    r->sides =
        (sc_contour_sides *)test_allocate((size_t)d->s.result.contour_count * sizeof *r->sides);
    status = sc_trace_regions(d->s.model, &d->s.pose, &d->s.result, NULL, r);
    return CHECK_MSG(status == SC_OK && r->region_count == r->region_capacity, "%s",
                     sc_status_string(status));
}

void undivide(divided_scene *d)
{
    free(d->regions.regions);
    free(d->regions.vertex_regions);
    free(d->regions.sides);
    trace_scene_close(&d->s);
}

soup two_spheres(uint32_t around, double offset, double radius, uint32_t *vertices,
                 uint32_t *triangles)
{
    soup a = soup_sphere(around, around / 2), b = soup_sphere(around + 1, around / 2 + 1), both;
    soup_smooth(a.positions, a.vertex_count, 0.05);
    soup_scale(b.positions, b.vertex_count, radius);
    soup_smooth(b.positions, b.vertex_count, 0.05 * radius);
    for (uint32_t v = 0; v < b.vertex_count; ++v) b.positions[3 * (size_t)v] += offset;
    both = soup_join(&a, &b);
    *vertices = a.vertex_count;
    *triangles = a.triangle_count;
    soup_free(&a);
    soup_free(&b);
    return both;
}

soup octahedron(double r)
{
    static const uint32_t corners[24] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4,
                                         1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5};
    const double positions[18] = {r, 0,  r / 2, 0, r, r / 2,     -r, 0, r / 2,
                                  0, -r, r / 2, 0, 0, r * 3 / 2, 0,  0, -r / 2};
    soup s = soup_make(6, 8);
    memcpy(s.triangles, corners, sizeof corners);
    memcpy(s.positions, positions, sizeof positions);
    return s;
}

void add_soup(soup *all, soup s)
{
    const soup both = soup_join(all, &s);
    soup_free(all);
    soup_free(&s);
    *all = both;
}
