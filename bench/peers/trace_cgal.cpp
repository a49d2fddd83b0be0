/*
 * CGAL's curves of self-intersection, as a shared library that trace_curves.py loads:
 * Polygon_mesh_processing::experimental::surface_self_intersection. Its order of nodes along
 * polylines, all decisions and points come from exact arithmetic; points are rounded at the end.
 *
 * A polyline ends where three sheets meet, so that a curve that passes through such a point comes
 * in parts; trace_curves.py joins them.
 *
 * CGAL's headers used here are under the GPL: so is a binary of this file. It is never installed.
 *
 * SPDX-License-Identifier: MIT
 */
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version_macros.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <iterator>
#include <memory>
#include <vector>

namespace
{

typedef CGAL::Exact_predicates_exact_constructions_kernel kernel;
typedef CGAL::Surface_mesh<kernel::Point_3> surface;

} // namespace

extern "C" {

/* A mesh, and the answer of its latest query. */
struct trace_cgal {
    surface mesh;
    std::vector<std::vector<kernel::Point_3>> polylines;
    std::vector<uint64_t> counts;
    std::vector<double> points;
};

#define EXPORTED __attribute__((visibility("default")))
EXPORTED const char *trace_cgal_version(void);
EXPORTED trace_cgal *trace_cgal_new(size_t vertices, size_t triangles, const uint32_t *corners);
EXPORTED void trace_cgal_free(trace_cgal *t);
EXPORTED int64_t trace_cgal_query(trace_cgal *t, const double *positions);
EXPORTED const uint64_t *trace_cgal_counts(trace_cgal *t);
EXPORTED const double *trace_cgal_points(trace_cgal *t);

const char *trace_cgal_version(void)
{
    return CGAL_VERSION_STR;
}

/* NULL if the mesh is not an oriented 2-manifold. */
trace_cgal *trace_cgal_new(size_t vertices, size_t triangles, const uint32_t *corners)
{
    std::unique_ptr<trace_cgal> t(new trace_cgal);
    for (size_t v = 0; v < vertices; ++v) t->mesh.add_vertex(kernel::Point_3(0, 0, 0));
    for (size_t i = 0; i < triangles; ++i) {
        const uint32_t *v = &corners[3 * i];
        const surface::Vertex_index a(v[0]), b(v[1]), c(v[2]);
        if (t->mesh.add_face(a, b, c) == surface::null_face()) return nullptr;
    }
    return t.release();
}

void trace_cgal_free(trace_cgal *t)
{
    delete t;
}

/* How many polylines there are in a pose, or -1 if CGAL has raised an exception. */
int64_t trace_cgal_query(trace_cgal *t, const double *positions)
{
    for (const surface::Vertex_index v : t->mesh.vertices()) {
        const double *p = positions + 3 * size_t(v);
        t->mesh.point(v) = kernel::Point_3(p[0], p[1], p[2]);
    }
    t->polylines.clear();
    try {
        CGAL::Polygon_mesh_processing::experimental::surface_self_intersection(
            t->mesh, std::back_inserter(t->polylines));
    } catch (const std::exception &) {
        return -1;
    }
    return int64_t(t->polylines.size());
}

/* Of each polyline how many points it has, the first again at the end if it is closed. */
const uint64_t *trace_cgal_counts(trace_cgal *t)
{
    t->counts.clear();
    for (const auto &line : t->polylines) t->counts.push_back(line.size());
    return t->counts.data();
}

/* All points, x, y and z, one polyline after the other. */
const double *trace_cgal_points(trace_cgal *t)
{
    t->points.clear();
    for (const auto &line : t->polylines) {
        for (const auto &p : line) {
            for (int k = 0; k < 3; ++k) t->points.push_back(CGAL::to_double(CGAL::exact(p[k])));
        }
    }
    return t->points.data();
}

} /* extern "C" */
