// A broad phase for ipc-toolkit (C++) on starcontour: contacts within a distance, and those of a
// step.
//
//     starcontour_ipc::BroadPhase broad_phase(rest, faces);       once per topology
//     collisions.build(mesh, vertices, dhat, 0, &broad_phase);    NormalCollisions
//     candidates.build(mesh, start, end, 0, &broad_phase);        Candidates, for step sizes
//
// For the headers of ipc-toolkit 1.6 and starcontour.hpp, the header for C++17. Where ipc-toolkit
// looks for boxes that overlap, this asks what is within the distance (sc_query_near), or what may
// come together on the way from one pose to another (sc_query_step, candidates). Pairs of which
// can_vertices_collide refuses all vertices are left out. Only triangle meshes: each edge is one of
// a face, and each vertex of one. Like any broad phase of ipc-toolkit, one object serves one
// thread.
//
// SPDX-License-Identifier: MIT
#ifndef STARCONTOUR_BROAD_PHASE_HPP
#define STARCONTOUR_BROAD_PHASE_HPP

#include <ipc/broad_phase/broad_phase.hpp>

#include <starcontour.hpp>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace starcontour_ipc
{

class BroadPhase : public ipc::BroadPhase
{
    using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    using Numbers = Eigen::ConstRef<Eigen::MatrixXi>;
    using Poses = Eigen::ConstRef<Eigen::MatrixXd>;

    // ipc-toolkit's distances and its test for collisions on the way are rounded; what is this much
    // farther, of the size of the mesh, is a candidate as well.
    static constexpr double slack = 1e-5;

  public:
    // tasks: the host's threads that may search, or NULL. They outlive this.
    BroadPhase(Poses rest, Numbers faces, const sc_tasks *tasks = nullptr)
        : faces_(faces), model_(model_of(rest, faces)),
          workspace_(model_, SC_WORKSPACE_NEAR, tasks ? tasks->workers : 1), tasks_(tasks)
    {
    }

    std::string name() const override
    {
        return "starcontour";
    }

    void clear() override
    {
        ipc::BroadPhase::clear();
        found_ = nullptr;
    }

    void build(Poses vertices, Numbers edges, Numbers faces, const double radius = 0) override
    {
        begin(edges, faces);
        const Points pose = vertices;
        auto options = starcontour::sized<sc_near_options>();
        options.tasks = tasks_;
        found_ = &workspace_.near(of(pose), 2 * radius + slack * size(pose), &options);
    }

    void build(Poses start, Poses end, Numbers edges, Numbers faces,
               const double radius = 0) override
    {
        begin(edges, faces);
        const Points from = start, to = end;
        auto options = starcontour::sized<sc_step_options>();
        options.pairs = SC_STEP_CANDIDATES;
        options.separation = 2 * radius + slack * std::max(size(from), size(to));
        options.tasks = tasks_;
        found_ = &workspace_.step(of(from), of(to), &options);
    }

    // Boxes that others made say too little.
    void build(const ipc::AABBs &, Numbers, Numbers, const uint8_t) override
    {
        refuse("needs vertices, not boxes");
    }

    void detect_face_vertex_candidates(std::vector<ipc::FaceVertexCandidate> &out) const override
    {
        for (const sc_pair &pair : found().vertex_faces) {
            const int v = int(pair.a), f = int(pair.b);
            if (may(v, faces_(f, 0)) || may(v, faces_(f, 1)) || may(v, faces_(f, 2)))
                out.emplace_back(f, v);
        }
    }

    void detect_edge_edge_candidates(std::vector<ipc::EdgeEdgeCandidate> &out) const override
    {
        for (const sc_pair &pair : found().edge_edges) {
            const int a = numbers_[pair.a], b = numbers_[pair.b];
            const int p = edges_(a, 0), q = edges_(a, 1), r = edges_(b, 0), s = edges_(b, 1);
            if (may(p, r) || may(p, s) || may(q, r) || may(q, s)) out.emplace_back(a, b);
        }
    }

    void detect_vertex_vertex_candidates(std::vector<ipc::VertexVertexCandidate> &) const override
    {
        refuse("is for triangle meshes");
    }
    void detect_edge_vertex_candidates(std::vector<ipc::EdgeVertexCandidate> &) const override
    {
        refuse("is for triangle meshes");
    }
    void detect_edge_face_candidates(std::vector<ipc::EdgeFaceCandidate> &) const override
    {
        refuse("does not look for edges in faces");
    }
    void detect_face_face_candidates(std::vector<ipc::FaceFaceCandidate> &) const override
    {
        refuse("does not look for faces in faces");
    }

  private:
    [[noreturn]] static void refuse(const std::string &why)
    {
        throw std::runtime_error("starcontour_ipc::BroadPhase " + why);
    }

    static starcontour::Positions of(const Points &points)
    {
        return {points.data(), std::size_t(points.rows())};
    }

    // The longest side of its box.
    static double size(const Points &points)
    {
        return (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
    }

    static starcontour::Model model_of(Poses rest, Numbers faces)
    {
        const Points points = rest;
        const Eigen::Matrix<uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor> corners =
            faces.cast<uint32_t>();
        auto options = starcontour::sized<sc_build_options>();
        options.weld = SC_WELD_NONE;
        return {of(points), corners.data(), std::size_t(corners.rows()), &options};
    }

    const starcontour::Features &found() const
    {
        if (!found_) refuse("is to be built first");
        return *found_;
    }

    bool may(int v, int w) const
    {
        return can_vertices_collide(std::size_t(v), std::size_t(w));
    }

    // The library names edges by faces: edge 3 f + k leads from corner k of face f to the next.
    void begin(Numbers edges, Numbers faces)
    {
        clear();
        dim = 3;
        if (faces.rows() != faces_.rows() || faces != faces_) refuse("was made for other faces");
        if (edges.rows() == edges_.rows() && edges == edges_) return;
        std::map<std::pair<int, int>, int> rows;
        for (int e = 0; e < edges.rows(); ++e) rows[std::minmax({edges(e, 0), edges(e, 1)})] = e;
        std::vector<bool> named(std::size_t(edges.rows()), false);
        numbers_.resize(3 * std::size_t(faces.rows()));
        for (int f = 0; f < faces.rows(); ++f) {
            for (int k = 0; k < 3; ++k) {
                const auto row = rows.find(std::minmax({faces(f, k), faces(f, (k + 1) % 3)}));
                if (row == rows.end()) refuse("found a side of a face that is no edge");
                numbers_[3 * std::size_t(f) + std::size_t(k)] = row->second;
                named[std::size_t(row->second)] = true;
            }
        }
        if (std::find(named.begin(), named.end(), false) != named.end())
            refuse("found an edge that is of no face, or there twice");
        edges_ = edges;
    }

    Eigen::MatrixXi faces_, edges_;
    std::vector<int> numbers_; // of edge 3 f + k the row of edges_
    starcontour::Model model_;
    starcontour::Workspace workspace_;
    const sc_tasks *tasks_;
    const starcontour::Features *found_ = nullptr; // the workspace's
};

} // namespace starcontour_ipc

#endif // STARCONTOUR_BROAD_PHASE_HPP
