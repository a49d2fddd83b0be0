// No part of ipc-toolkit: what starcontour_broad_phase.hpp needs of its interface (1.6), so that it
// can be compiled and tried where ipc-toolkit is not installed. The base class finds nothing
// itself.
//
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace Eigen
{

template <typename T> using ConstRef = const Ref<const T> &;

} // namespace Eigen

namespace ipc
{

struct AABB {
};
using AABBs = std::vector<AABB>;
using CollisionFilter = std::function<bool(size_t, size_t)>;

struct FaceVertexCandidate {
    FaceVertexCandidate(int face, int vertex) : face_id(face), vertex_id(vertex)
    {
    }
    int face_id, vertex_id;
};

struct EdgeEdgeCandidate {
    EdgeEdgeCandidate(int a, int b) : edge0_id(a), edge1_id(b)
    {
    }
    int edge0_id, edge1_id;
};

struct VertexVertexCandidate {
};
struct EdgeVertexCandidate {
};
struct EdgeFaceCandidate {
};
struct FaceFaceCandidate {
};

class BroadPhase
{
  public:
    virtual ~BroadPhase() = default;
    virtual std::string name() const = 0;
    virtual void build(Eigen::ConstRef<Eigen::MatrixXd>, Eigen::ConstRef<Eigen::MatrixXi>,
                       Eigen::ConstRef<Eigen::MatrixXi>, const double = 0)
    {
    }
    virtual void build(Eigen::ConstRef<Eigen::MatrixXd>, Eigen::ConstRef<Eigen::MatrixXd>,
                       Eigen::ConstRef<Eigen::MatrixXi>, Eigen::ConstRef<Eigen::MatrixXi>,
                       const double = 0)
    {
    }
    virtual void build(const AABBs &, Eigen::ConstRef<Eigen::MatrixXi>,
                       Eigen::ConstRef<Eigen::MatrixXi>, const uint8_t)
    {
    }
    virtual void clear()
    {
        dim = 0;
    }
    virtual void detect_vertex_vertex_candidates(std::vector<VertexVertexCandidate> &) const = 0;
    virtual void detect_edge_vertex_candidates(std::vector<EdgeVertexCandidate> &) const = 0;
    virtual void detect_edge_edge_candidates(std::vector<EdgeEdgeCandidate> &) const = 0;
    virtual void detect_face_vertex_candidates(std::vector<FaceVertexCandidate> &) const = 0;
    virtual void detect_edge_face_candidates(std::vector<EdgeFaceCandidate> &) const = 0;
    virtual void detect_face_face_candidates(std::vector<FaceFaceCandidate> &) const = 0;

    CollisionFilter can_vertices_collide = [](size_t, size_t) { return true; };

  protected:
    virtual void build(Eigen::ConstRef<Eigen::MatrixXi>, Eigen::ConstRef<Eigen::MatrixXi>)
    {
    }

    uint8_t dim = 0;
};

} // namespace ipc
