/*
 * FCL (Flexible Collision Library): a BVHModel of axis-aligned boxes, refitted, and selfCollide.
 *
 * SPDX-License-Identifier: MIT
 *
 * For each pose the vertices are replaced, the boxes refitted from the leaves up (leaves of one
 * triangle, in double), and the tree is walked against itself. FCL's own collide() tests a model
 * with another one, and by rounded arithmetic; here its leaves are decided by triangle_test.h,
 * neighbours left out. (Updating a model instead of replacing its vertices makes boxes that hold
 * the old and the new triangle: for continuous tests.)
 */
#include "peer.h"
#include "triangle_test.h"

#include <fcl/config.h>
#include <fcl/math/bv/utility.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/detail/traversal/collision/bvh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>

#include <algorithm>
#include <stdexcept>

namespace peers
{
namespace
{

typedef fcl::BVHModel<fcl::AABBd> model_type;

/* Where FCL's walk arrives: at pairs of leaves whose boxes overlap. */
class leaves : public fcl::detail::BVHCollisionTraversalNode<fcl::AABBd>
{
  public:
    const scene *mesh = nullptr;
    const double *pose = nullptr;
    pair_list *found = nullptr;

    void leafTesting(int first, int second) const override
    {
        const uint32_t a = uint32_t(model1->getBV(first).primitiveId());
        const uint32_t b = uint32_t(model2->getBV(second).primitiveId());
        if (mesh->adjacent(a, b)) return;
        const double *p[3], *q[3];
        for (size_t k = 0; k < 3; ++k) {
            p[k] = pose + 3 * size_t(mesh->corners[3 * size_t(a) + k]);
            q[k] = pose + 3 * size_t(mesh->corners[3 * size_t(b) + k]);
        }
        if (triangles_meet(p, q)) found->push_back(std::minmax(a, b));
    }
};

class fcl_peer : public peer
{
    const scene *mesh = nullptr;
    std::unique_ptr<model_type> model;
    std::vector<fcl::Vector3d> vertices;

    void place(const double *positions)
    {
        vertices.resize(mesh->vertices);
        for (size_t v = 0; v < mesh->vertices; ++v)
            vertices[v] =
                fcl::Vector3d(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    }

  public:
    std::string name() const override
    {
        return "fcl";
    }
    std::string version() const override
    {
        return FCL_VERSION;
    }
    std::string what() const override
    {
        return "selfCollide: boxes refitted; exact triangle test of ours; pairs without common "
               "vertex";
    }
    kind finds() const override
    {
        return kind::apart;
    }
    bool threaded() const override
    {
        return false;
    }

    void build(const scene &animation, unsigned) override
    {
        mesh = &animation;
        std::vector<fcl::Triangle> triangles;
        for (size_t t = 0; t < mesh->triangles; ++t) {
            const uint32_t *v = &mesh->corners[3 * t];
            triangles.push_back(fcl::Triangle(v[0], v[1], v[2]));
        }
        place(mesh->frame(0));
        model = std::make_unique<model_type>();
        model->beginModel(int(mesh->triangles), int(mesh->vertices));
        model->addSubModel(vertices, triangles);
        if (model->endModel() != fcl::BVH_OK) throw std::runtime_error("FCL refuses the mesh");
    }

    void query(const double *positions, pair_list &found) override
    {
        place(positions);
        model->beginReplaceModel();
        model->replaceSubModel(vertices);
        if (model->endReplaceModel(true, true) != fcl::BVH_OK)
            throw std::runtime_error("FCL refuses the pose");
        leaves walk;
        walk.mesh = mesh;
        walk.pose = positions;
        walk.found = &found;
        walk.model1 = walk.model2 = model.get();
        fcl::detail::selfCollide<double>(&walk);
    }
};

} // namespace

std::vector<std::unique_ptr<peer>> make_peers()
{
    std::vector<std::unique_ptr<peer>> list;
    list.push_back(std::make_unique<fcl_peer>());
    return list;
}

} // namespace peers
