// Self-collisions of Bullet's soft bodies by starcontour: a solver to hand to the world in place of
// Bullet's own. World and soft bodies stay as they are; needs Bullet and starcontour.h alone.
//
//     SelfContacts solver;
//     btSoftRigidDynamicsWorld world(dispatcher, broadphase, constraints, configuration, &solver);
//     solver.add(cloth, thickness);       once it has all its nodes and faces, in its rest pose
//     world.addSoftBody(cloth);           in a pose without intersections
//     world.stepSimulation(...)           and so on, as before
//
// Bullet predicts where nodes go (m_q to m_x), finds contacts with rigid bodies, and has this
// solver move the nodes. For a body that was added, a step is
//
//     near        nodes and faces within reach at m_q, and their closest points
//     rounds      of Bullet's own constraints, each followed by one that pushes these pairs apart
//     hold back   what would still meet, or nearly, on the way from m_q to m_x
//
// The last is what nothing passes: if the first pose has no intersections, no later one has.
// Positions are read where Bullet has them, single or double. Nothing is allocated in a step but
// what Bullet itself allocates: arrays have a fixed length, and what does not fit is not pushed
// apart, but held back nevertheless.
//
// Bodies that were added keep their nodes and faces, and their drift solver is not run. Others are
// solved as by Bullet.
//
// SPDX-License-Identifier: MIT
#ifndef SELF_CONTACTS_HPP
#define SELF_CONTACTS_HPP

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <vector>

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <starcontour.h>

class SelfContacts : public btDefaultSoftBodySolver
{
  public:
    // Of one body: what a step took, and what happened in the last one.
    struct Cloth {
        btSoftBody *body;
        btScalar thickness;       // at which layers are kept
        btScalar least;           // nearer than this nothing comes: a quarter of it
        btScalar friction = 0.5f; // between layers; 0: none
        unsigned contacts = 0;    // pairs that were looked at
        unsigned rounds = 0;      // of holding back
        unsigned held = 0;        // pairs held back, in all of these rounds
        bool stopped = false;     // rounds were not enough: nothing moved
        bool full = false;        // not all contacts fitted
        double near_ms = 0, solve_ms = 0, hold_ms = 0;

        std::vector<uint32_t> triangles;
        std::vector<btVector3> rest;
        std::unique_ptr<sc_model, void (*)(sc_model *)> model{nullptr, sc_model_free};
        std::unique_ptr<sc_workspace, void (*)(sc_workspace *)> workspace{nullptr,
                                                                          sc_workspace_free};
        std::vector<sc_pair> faces, edges; // pairs, and of steps their times
        std::vector<double> face_times, edge_times;
        std::vector<sc_near_stencil> stencils;
    };

    // Keeps a body's layers a thickness apart, which should be less than half of the height of its
    // faces. What is that near in the pose that the body has now are neighbors, which are not
    // pushed apart. The body must stay until it is removed.
    Cloth &add(btSoftBody *body, btScalar thickness)
    {
        std::unique_ptr<Cloth> cloth(new Cloth);
        Cloth &c = *cloth;
        c.body = body;
        c.thickness = thickness;
        c.least = thickness / 4;
        for (int i = 0; i < body->m_faces.size(); ++i)
            for (const btSoftBody::Node *node : body->m_faces[i].m_n)
                c.triangles.push_back(static_cast<uint32_t>(node - &body->m_nodes[0]));
        for (int i = 0; i < body->m_nodes.size(); ++i) c.rest.push_back(body->m_nodes[i].m_x);

        auto mesh = sized<sc_mesh>();
        mesh.vertex_count = static_cast<uint32_t>(body->m_nodes.size());
        mesh.triangle_count = static_cast<uint32_t>(body->m_faces.size());
        mesh.position_type = scalar;
        mesh.position_stride = sizeof(btSoftBody::Node);
        mesh.positions = &body->m_nodes[0].m_x;
        mesh.indices = c.triangles.data();
        auto build = sized<sc_build_options>();
        build.weld = SC_WELD_NONE; // nodes that touch are not one
        sc_model *model = nullptr;
        check(sc_build(&mesh, &build, &model));
        c.model.reset(model);
        auto options = sized<sc_workspace_options>();
        options.flags = SC_WORKSPACE_NEAR; // serves steps as well
        sc_workspace *workspace = nullptr;
        check(sc_workspace_create_for(model, &options, &workspace));
        c.workspace.reset(workspace);

        const size_t room = 16 * mesh.vertex_count;
        c.faces.resize(room);
        c.edges.resize(room);
        c.face_times.resize(room);
        c.edge_times.resize(room);
        c.stencils.resize(room);
        cloths_.push_back(std::move(cloth));
        return c;
    }

    void remove(const btSoftBody *body)
    {
        for (size_t i = cloths_.size(); i-- > 0;)
            if (cloths_[i]->body == body) cloths_.erase(cloths_.begin() + std::ptrdiff_t(i));
    }

    // Where nodes are (m_x), or were when the step began (m_q), as the library reads them.
    static sc_pose pose(const btSoftBody &body, btVector3 btSoftBody::Node::*which)
    {
        auto pose = sized<sc_pose>();
        pose.vertex_count = static_cast<uint32_t>(body.m_nodes.size());
        pose.position_type = scalar;
        pose.position_stride = sizeof(btSoftBody::Node);
        pose.positions = &(body.m_nodes[0].*which);
        return pose;
    }

    template <typename T> static T sized()
    {
        T structure{};
        structure.struct_size = sizeof(structure);
        return structure;
    }

    static void check(sc_status status)
    {
        if (status != SC_OK) throw std::runtime_error(sc_status_string(status));
    }

    // Of the processor's time, so that other programs on the machine do not count.
    static double milliseconds()
    {
        return 1e3 * double(std::clock()) / CLOCKS_PER_SEC;
    }

    // Called by the world, once a step, for all bodies.
    void solveConstraints(btScalar) override
    {
        for (int i = 0; i < m_softBodySet.size(); ++i) {
            btSoftBody *const body = m_softBodySet[i];
            if (!body->isActive()) continue;
            Cloth *const cloth = find(body);
            if (cloth == nullptr) {
                body->solveConstraints();
                continue;
            }
            const double begin = milliseconds();
            const size_t contacts = near(*cloth);
            const double found = milliseconds();
            solve(*cloth, contacts);
            const double solved = milliseconds();
            hold_back(*cloth);
            cloth->near_ms = found - begin;
            cloth->solve_ms = solved - found;
            cloth->hold_ms = milliseconds() - solved;
            const btScalar speed = body->m_sst.isdt * (1 - body->m_cfg.kDP);
            for (int j = 0; j < body->m_nodes.size(); ++j) {
                btSoftBody::Node &n = body->m_nodes[j];
                n.m_v = (n.m_x - n.m_q) * speed;
                n.m_f.setZero();
            }
        }
    }

  private:
    static const uint32_t scalar = sizeof(btScalar) == sizeof(float) ? SC_FLOAT : SC_DOUBLE;

    Cloth *find(const btSoftBody *body)
    {
        for (const auto &cloth : cloths_)
            if (cloth->body == body) return cloth.get();
        return nullptr;
    }

    // Finds pairs and their closest points, all at the start of the step; says how many there are.
    size_t near(Cloth &c)
    {
        // What is farther apart than this cannot come within the thickness, however the motion that
        // all have in common: each moves by `most` at most beside it. But where much is near, a
        // farther reach takes more time than it is worth; what is faster is held back.
        auto &nodes = c.body->m_nodes;
        btVector3 mean(0, 0, 0);
        btScalar most = 0;
        for (int i = 0; i < nodes.size(); ++i) mean += nodes[i].m_x - nodes[i].m_q;
        mean /= btScalar(nodes.size());
        for (int i = 0; i < nodes.size(); ++i)
            most = btMax(most, (nodes[i].m_x - nodes[i].m_q - mean).length());

        const sc_pose start = pose(*c.body, &btSoftBody::Node::m_q);
        sc_pose rest = start;
        rest.position_stride = sizeof(btVector3);
        rest.positions = c.rest.data();
        auto options = sized<sc_near_options>();
        options.distance = c.thickness + btMin(2 * most, c.thickness / 2);
        options.kinds = SC_NEAR_VERTEX_FACE; // edges that cross are left to hold_back
        options.rest = &rest;
        options.rest_distance = options.distance; // neighbors are no news
        auto result = sized<sc_near_result>();
        result.vertex_face_capacity = c.faces.size();
        result.vertex_faces = c.faces.data();
        const sc_status status =
            sc_query_near(c.model.get(), c.workspace.get(), &start, &options, &result);
        c.full = status == SC_ERROR_SHORT_BUFFER; // then the array is full of what was found
        if (!c.full) check(status);
        const size_t count = btMin<size_t>(result.vertex_face_count, c.faces.size());
        check(sc_near_stencils(c.model.get(), &start, SC_NEAR_VERTEX_FACE, c.faces.data(), count,
                               c.stencils.data()));
        c.contacts = static_cast<unsigned>(count);
        return count;
    }

    // Has Bullet do all but solve positions, and does that, each round with one of contacts.
    static void solve(Cloth &c, size_t contacts)
    {
        btSoftBody &body = *c.body;
        const int rounds = body.m_cfg.piterations, drift = body.m_cfg.diterations;
        body.m_cfg.piterations = body.m_cfg.diterations = 0;
        body.solveConstraints(); // prepares links and anchors, solves velocities
        body.m_cfg.piterations = rounds;
        body.m_cfg.diterations = drift;
        for (int round = 0; round < rounds; ++round) {
            const btScalar part = btScalar(round) / btScalar(rounds);
            for (int i = 0; i < body.m_cfg.m_psequence.size(); ++i)
                btSoftBody::getSolver(body.m_cfg.m_psequence[i])(&body, 1, part);
            for (size_t i = 0; i < contacts; ++i) keep_apart(c, c.stencils[i]);
        }
    }

    // Pushes a pair apart along the vector between its closest points when the step began, and
    // keeps it from sliding. A pair that began nearer than the thickness gets it back over ten
    // steps.
    static void keep_apart(Cloth &c, const sc_near_stencil &s)
    {
        if (s.distance == 0) return;
        const btScalar distance = btScalar(s.distance), wanted = c.thickness;
        const btVector3 normal(btScalar(s.vector[0]) / distance, btScalar(s.vector[1]) / distance,
                               btScalar(s.vector[2]) / distance);
        btSoftBody::Node *nodes[4];
        btScalar weights[4], mass = 0;
        btVector3 moved(0, 0, 0);
        for (int j = 0; j < 4; ++j) {
            nodes[j] = &c.body->m_nodes[static_cast<int>(s.vertices[j])];
            weights[j] = btScalar(s.weights[j]);
            mass += weights[j] * weights[j] * nodes[j]->m_im;
            moved += weights[j] * (nodes[j]->m_x - nodes[j]->m_q);
        }
        const btScalar away = moved.dot(normal);
        const btScalar depth = btMin(wanted, distance + wanted / 10) - (distance + away);
        if (depth <= 0 || mass <= 0) return;
        const btVector3 slip = moved - away * normal;
        const btScalar length = slip.length(), most = c.friction * depth;
        btVector3 push = depth * normal;
        if (length > 0) push -= slip * (length > most ? most / length : btScalar(1));
        for (int j = 0; j < 4; ++j) nodes[j]->m_x += push * (weights[j] * nodes[j]->m_im / mass);
    }

    // Nodes of pairs that come nearer than `least` go half of the way that they may. That can bring
    // them into the way of others, so the step is asked about again. After too many rounds nothing
    // moves.
    static void hold_back(Cloth &c)
    {
        auto &nodes = c.body->m_nodes;
        const sc_pose start = pose(*c.body, &btSoftBody::Node::m_q);
        const sc_pose end = pose(*c.body, &btSoftBody::Node::m_x);
        auto options = sized<sc_step_options>();
        options.times = SC_STEP_TIMES_EACH;
        options.separation = c.least;
        options.tolerance = c.least / 10000;
        options.begun = SC_STEP_BEGUN_NEARER; // what began nearer may stay, or move apart
        c.held = 0;
        c.stopped = false;
        for (c.rounds = 0; c.rounds < 30; ++c.rounds) {
            auto result = sized<sc_step_result>();
            result.vertex_face_capacity = c.faces.size();
            result.vertex_faces = c.faces.data();
            result.vertex_face_times = c.face_times.data();
            result.edge_edge_capacity = c.edges.size();
            result.edge_edges = c.edges.data();
            result.edge_edge_times = c.edge_times.data();
            const sc_status status =
                sc_query_step(c.model.get(), c.workspace.get(), &start, &end, &options, &result);
            if (status != SC_ERROR_SHORT_BUFFER) check(status);
            if (!result.collides) return;
            const size_t faces = btMin<size_t>(result.vertex_face_count, c.faces.size());
            const size_t edges = btMin<size_t>(result.edge_edge_count, c.edges.size());
            for (size_t i = 0; i < faces; ++i) {
                const uint32_t *const face = &c.triangles[3 * c.faces[i].b];
                slow(nodes, c.faces[i].a, c.face_times[i]);
                for (int j = 0; j < 3; ++j) slow(nodes, face[j], c.face_times[i]);
            }
            for (size_t i = 0; i < edges; ++i)
                for (const uint32_t edge : {c.edges[i].a, c.edges[i].b}) {
                    // Edge 3 t + k is that from corner k of triangle t to the next.
                    slow(nodes, c.triangles[edge], c.edge_times[i]);
                    slow(nodes, c.triangles[edge - edge % 3 + (edge + 1) % 3], c.edge_times[i]);
                }
            c.held += static_cast<unsigned>(faces + edges);
        }
        c.stopped = true;
        for (int i = 0; i < nodes.size(); ++i) nodes[i].m_x = nodes[i].m_q;
    }

    static void slow(btSoftBody::tNodeArray &nodes, uint32_t vertex, double time)
    {
        btSoftBody::Node &n = nodes[static_cast<int>(vertex)];
        n.m_x = n.m_q + (n.m_x - n.m_q) * btScalar(time / 2);
    }

    std::vector<std::unique_ptr<Cloth>> cloths_;
};

#endif // SELF_CONTACTS_HPP
