// starcontour_broad_phase.hpp on a mesh whose distances are known, by the headers of ipc-toolkit or
// by those of stand_in/. Exit status 1 if anything is wrong.
//
// SPDX-License-Identifier: MIT
#include "starcontour_broad_phase.hpp"

#include <cstdio>
#include <functional>
#include <set>

namespace
{

typedef std::set<std::pair<int, int>> Pairs;

int failures = 0;

void check(const char *what, bool good)
{
    std::printf("%s: %s\n", good ? "passed" : "failed", what);
    failures += !good;
}

Pairs faces_and_vertices(const ipc::BroadPhase &broad_phase)
{
    std::vector<ipc::FaceVertexCandidate> list;
    broad_phase.detect_face_vertex_candidates(list);
    Pairs pairs;
    for (const auto &one : list) pairs.insert({int(one.face_id), int(one.vertex_id)});
    return pairs;
}

Pairs edges_and_edges(const ipc::BroadPhase &broad_phase)
{
    std::vector<ipc::EdgeEdgeCandidate> list;
    broad_phase.detect_edge_edge_candidates(list);
    Pairs pairs;
    for (const auto &one : list) pairs.insert(std::minmax({int(one.edge0_id), int(one.edge1_id)}));
    return pairs;
}

bool refused(const std::function<void()> &call)
{
    try {
        call();
    } catch (const std::runtime_error &) {
        return true;
    }
    return false;
}

} // namespace

int main()
{
    // A square of two faces, 0 and 1, and above it a small face, half a unit higher. Its corners
    // are above face 0; those but the first are 0.866 from face 1, and its edges from their common
    // edge, and 1.118 or more from the other edges.
    Eigen::MatrixXd rest(7, 3), fallen;
    rest << 0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 4, 0, 1, 1, 0.5, 2, 1, 0.5, 1, 2, 0.5;
    fallen = rest;
    fallen.bottomRows(3).col(2).array() -= 1;
    Eigen::MatrixXi faces(3, 3), edges(8, 2), turned, fewer;
    faces << 0, 1, 2, 1, 3, 2, 4, 5, 6;
    edges << 4, 5, 0, 1, 2, 0, 2, 1, 6, 4, 1, 3, 5, 6, 3, 2; // the common edge is 3; above 0, 4, 6
    turned = faces;
    turned.row(0) << 1, 2, 0;
    fewer = edges.topRows(7);

    starcontour_ipc::BroadPhase broad_phase(rest, faces);
    ipc::BroadPhase &base = broad_phase; // as ipc-toolkit sees it
    const Pairs above = {{0, 4}, {0, 5}, {0, 6}}, near = {{0, 4}, {0, 5}, {0, 6}, {1, 5}, {1, 6}};
    const Pairs common = {{0, 3}, {3, 4}, {3, 6}};
    check("it has a name", base.name() == "starcontour");
    check("what was not built is refused", refused([&] { faces_and_vertices(base); }));
    base.build(rest, edges, faces, 0.25);
    check("twice the radius: faces and vertices", faces_and_vertices(base) == above);
    check("twice the radius: no edges", edges_and_edges(base).empty());
    base.build(rest, edges, faces, 0.2);
    check("less finds nothing", faces_and_vertices(base).empty());
    base.build(rest, edges, faces, 0.5);
    check("more finds more", faces_and_vertices(base) == near);
    check("edges by their rows", edges_and_edges(base) == common);

    base.can_vertices_collide = [](size_t v, size_t w) {
        return v != 5 && w != 5 && !(v == 4 && w < 4) && !(w == 4 && v < 4);
    };
    check("a filter: faces and vertices", faces_and_vertices(base) == Pairs({{0, 6}, {1, 6}}));
    check("a filter: edges with a vertex that may",
          edges_and_edges(base) == Pairs({{3, 4}, {3, 6}}));
    base.can_vertices_collide = [](size_t, size_t) { return true; };

    base.build(rest, fallen, edges, faces, 0);
    const Pairs met = faces_and_vertices(base);
    check("a step: what falls through",
          std::includes(met.begin(), met.end(), above.begin(), above.end()));
    fallen.bottomRows(3).col(2).array() += 9;
    Eigen::MatrixXd lifted = fallen;
    lifted.bottomRows(3).col(2).array() -= 2;
    base.build(lifted, fallen, edges, faces, 0);
    bool far = edges_and_edges(base).empty();
    for (const auto &one : faces_and_vertices(base)) far &= one.first < 2 && one.second < 4;
    check("a step far from the square", far); // in which candidates may be, whose boxes touch

    check("other faces are refused", refused([&] { base.build(rest, edges, turned, 0.5); }));
    check("edges that lack are refused", refused([&] { base.build(rest, fewer, faces, 0.5); }));
    check("boxes are refused",
          refused([&] { base.build(ipc::AABBs(), edges, faces, uint8_t(3)); }));
    return failures ? 1 : 0;
}
