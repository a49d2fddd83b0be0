/*
 * CGAL (Computational Geometry Algorithms Library): Polygon_mesh_processing::self_intersections.
 *
 * SPDX-License-Identifier: MIT
 *
 * For each pose: the positions go into a Surface_mesh, then boxes of all triangles are made anew
 * and their overlaps found by box_intersection_d; predicates are exact. Triangles that share
 * vertices are pairs by the same rules as ours. The mesh is an oriented 2-manifold; others are
 * refused here.
 *
 * CGAL's headers used here are under the GPL: so is a binary of this program. It is never
 * installed.
 */
#include "peer.h"

#define CGAL_LINKED_WITH_TBB

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version_macros.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace peers
{
namespace
{

typedef CGAL::Exact_predicates_inexact_constructions_kernel kernel;
typedef CGAL::Surface_mesh<kernel::Point_3> surface;

class cgal : public peer
{
    surface mesh;
    bool parallel = false;
    std::unique_ptr<tbb::global_control> limit;
    std::vector<std::pair<surface::Face_index, surface::Face_index>> reported;

    void place(const double *positions)
    {
        for (const surface::Vertex_index v : mesh.vertices()) {
            const double *p = positions + 3 * size_t(v);
            mesh.point(v) = kernel::Point_3(p[0], p[1], p[2]);
        }
    }

  public:
    std::string name() const override
    {
        return "cgal";
    }
    std::string version() const override
    {
        return CGAL_VERSION_STR;
    }
    std::string what() const override
    {
        return "self_intersections: boxes rebuilt and swept; exact predicates; all pairs";
    }
    kind finds() const override
    {
        return kind::all;
    }
    bool threaded() const override
    {
        return true;
    }

    void build(const scene &animation, unsigned threads) override
    {
        mesh.clear();
        for (size_t v = 0; v < animation.vertices; ++v) mesh.add_vertex(kernel::Point_3(0, 0, 0));
        for (size_t t = 0; t < animation.triangles; ++t) {
            const uint32_t *v = &animation.corners[3 * t];
            const surface::Vertex_index i(v[0]), j(v[1]), k(v[2]);
            if (mesh.add_face(i, j, k) == surface::null_face())
                throw std::runtime_error("the mesh is not an oriented 2-manifold");
        }
        place(animation.frame(0));
        parallel = threads > 1;
        limit.reset(); /* the smallest of all limits holds */
        limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      threads);
    }

    void query(const double *positions, pair_list &found) override
    {
        namespace pmp = CGAL::Polygon_mesh_processing;
        place(positions);
        reported.clear();
        if (parallel)
            pmp::self_intersections<CGAL::Parallel_tag>(mesh, std::back_inserter(reported));
        else
            pmp::self_intersections(mesh, std::back_inserter(reported));
        for (const auto &faces : reported) {
            const uint32_t a = faces.first, b = faces.second;
            found.push_back(std::minmax(a, b));
        }
    }
};

} // namespace

std::vector<std::unique_ptr<peer>> make_peers()
{
    std::vector<std::unique_ptr<peer>> list;
    list.push_back(std::make_unique<cgal>());
    return list;
}

/* self_intersections takes one mesh. */
std::vector<std::unique_ptr<objects_peer>> make_objects_peers()
{
    return {};
}

} // namespace peers
