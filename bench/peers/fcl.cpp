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
 *
 * Several objects are a model each in a DynamicAABBTreeCollisionManager, which hands out each two
 * whose boxes overlap; their trees are walked in the same way. What does not move is built once.
 */
#include "peer.h"
#include "triangle_test.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/config.h>
#include <fcl/math/bv/utility.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/detail/traversal/collision/bvh_collision_traversal_node.h>
#include <fcl/narrowphase/collision_object.h>
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
    const scene *mesh_a = nullptr, *mesh_b = nullptr; /* one, of a model with itself */
    const double *pose_a = nullptr, *pose_b = nullptr;
    uint32_t first_a = 0, first_b = 0; /* is added to numbers of triangles */
    pair_list *found = nullptr;

    void leafTesting(int first, int second) const override
    {
        const uint32_t a = uint32_t(model1->getBV(first).primitiveId());
        const uint32_t b = uint32_t(model2->getBV(second).primitiveId());
        if (mesh_a == mesh_b && mesh_a->adjacent(a, b)) return;
        const double *p[3], *q[3];
        for (size_t k = 0; k < 3; ++k) {
            p[k] = pose_a + 3 * size_t(mesh_a->corners[3 * size_t(a) + k]);
            q[k] = pose_b + 3 * size_t(mesh_b->corners[3 * size_t(b) + k]);
        }
        if (triangles_meet(p, q)) found->push_back(std::minmax(first_a + a, first_b + b));
    }
};

/* A mesh as FCL has it. */
class placed_model
{
    std::vector<fcl::Vector3d> vertices;

    void copy(const double *positions)
    {
        vertices.resize(mesh->vertices);
        for (size_t v = 0; v < mesh->vertices; ++v)
            vertices[v] =
                fcl::Vector3d(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    }

  public:
    const scene *const mesh;
    const std::shared_ptr<model_type> model = std::make_shared<model_type>();

    explicit placed_model(const scene &of) : mesh(&of)
    {
        std::vector<fcl::Triangle> triangles;
        for (size_t t = 0; t < mesh->triangles; ++t) {
            const uint32_t *v = &mesh->corners[3 * t];
            triangles.push_back(fcl::Triangle(v[0], v[1], v[2]));
        }
        copy(mesh->frame(0));
        model->beginModel(int(mesh->triangles), int(mesh->vertices));
        model->addSubModel(vertices, triangles);
        if (model->endModel() != fcl::BVH_OK) throw std::runtime_error("FCL refuses the mesh");
    }

    void place(const double *positions)
    {
        copy(positions);
        model->beginReplaceModel();
        model->replaceSubModel(vertices);
        if (model->endReplaceModel(true, true) != fcl::BVH_OK)
            throw std::runtime_error("FCL refuses the pose");
    }
};

class fcl_peer : public peer
{
    std::unique_ptr<placed_model> self;

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
        self = std::make_unique<placed_model>(animation);
    }

    void query(const double *positions, pair_list &found) override
    {
        self->place(positions);
        leaves walk;
        walk.mesh_a = walk.mesh_b = self->mesh;
        walk.pose_a = walk.pose_b = positions;
        walk.found = &found;
        walk.model1 = walk.model2 = self->model.get();
        fcl::detail::selfCollide<double>(&walk);
    }
};

/* Several objects. */
class fcl_objects : public objects_peer
{
    const object_scene *all = nullptr;
    std::vector<std::unique_ptr<placed_model>> models;
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects; /* user data: of all->objects */
    std::unique_ptr<fcl::DynamicAABBTreeCollisionManagerd> manager;
    size_t frame = 0; /* that is asked about */
    pair_list *found = nullptr;

    leaves walk_of(size_t i, size_t j) const
    {
        const object &a = all->objects[i], &b = all->objects[j];
        leaves walk;
        walk.mesh_a = &a.mesh;
        walk.mesh_b = &b.mesh;
        walk.pose_a = a.frame(frame);
        walk.pose_b = b.frame(frame);
        walk.first_a = a.first;
        walk.first_b = b.first;
        walk.found = found;
        walk.model1 = models[i]->model.get();
        walk.model2 = models[j]->model.get();
        return walk;
    }

    size_t number_of(const fcl::CollisionObjectd *o) const
    {
        return size_t(static_cast<const object *>(o->getUserData()) - all->objects.data());
    }

    /* Goes on: returns false. */
    static bool two(fcl::CollisionObjectd *a, fcl::CollisionObjectd *b, void *user)
    {
        const fcl_objects *self = static_cast<const fcl_objects *>(user);
        leaves walk = self->walk_of(self->number_of(a), self->number_of(b));
        fcl::detail::collide<double>(&walk);
        return false;
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
        return "DynamicAABBTreeCollisionManager: trees refitted";
    }
    bool threaded() const override
    {
        return false;
    }

    void build(const object_scene &scene, unsigned) override
    {
        all = &scene;
        manager = std::make_unique<fcl::DynamicAABBTreeCollisionManagerd>();
        for (const object &o : all->objects) {
            models.push_back(std::make_unique<placed_model>(o.mesh));
            objects.push_back(std::make_unique<fcl::CollisionObjectd>(models.back()->model));
            objects.back()->setUserData(const_cast<object *>(&o));
            manager->registerObject(objects.back().get());
        }
        manager->setup();
    }

    void query(size_t number, pair_list &pairs) override
    {
        frame = number;
        found = &pairs;
        for (size_t i = 0; i < objects.size(); ++i) {
            if (!all->objects[i].moves()) continue;
            models[i]->place(all->objects[i].frame(frame));
            models[i]->model->computeLocalAABB();
            objects[i]->computeAABB();
        }
        manager->update(); /* of boxes that are as before it changes nothing */
        for (size_t i = 0; i < objects.size(); ++i) {
            if (!all->objects[i].itself) continue;
            leaves walk = walk_of(i, i);
            fcl::detail::selfCollide<double>(&walk);
        }
        manager->collide(this, two);
    }
};

} // namespace

std::vector<std::unique_ptr<peer>> make_peers()
{
    std::vector<std::unique_ptr<peer>> list;
    list.push_back(std::make_unique<fcl_peer>());
    return list;
}

std::vector<std::unique_ptr<objects_peer>> make_objects_peers()
{
    std::vector<std::unique_ptr<objects_peer>> list;
    list.push_back(std::make_unique<fcl_objects>());
    return list;
}

} // namespace peers
