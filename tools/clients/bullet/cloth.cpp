// A game's frame loop with Bullet: a cloth in three layers falls over a rod and to the ground. The
// same cloth three times, a frame of each in turns: without self-collisions, with those of Bullet's
// clusters, and with those of self_contacts.hpp.
//
//     cloth [--nodes N] [--frames N] [--clusters N] [--csv FILE] [--obj PREFIX]
//
//     --nodes N      the cloth has N x N nodes (48)
//     --frames N     of 1/60 second (240)
//     --clusters N   how many clusters Bullet is to make (64); 0: one for each triangle
//     --csv FILE     a line for each frame
//     --obj PREFIX   the last frame of each: PREFIX-none.obj, -clusters.obj, -starcontour.obj
//
// Prints for each how many pairs of triangles intersect, by sc_query, the least distance of parts
// of the cloth that share no node, and milliseconds of the processor's time a frame. Exit status 1
// if a frame of self_contacts.hpp has an intersection, or parts of its cloth nearer than an eighth
// of the thickness.
//
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyInternals.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "self_contacts.hpp"

namespace
{

enum Way { NONE, CLUSTERS, STARCONTOUR, WAYS };
const char *const names[WAYS] = {"none", "clusters", "starcontour"};

struct Settings {
    int nodes = 48, frames = 240, clusters = 64;
    const char *csv = nullptr, *obj = nullptr;
};

const btScalar side = 2; // of the cloth, in meters

// Bends a flat cloth, of x from -side / 2 to side / 2, into an S of three layers.
btVector3 folded(const btVector3 &flat, btScalar radius)
{
    const btScalar third = side / 3, turn = radius * SIMD_PI;
    btScalar along = flat.x() + side / 2;
    if (along < third) return btVector3(along, 0, flat.z());
    along -= third;
    if (along < turn) {
        const btScalar angle = along / radius;
        return btVector3(third + radius * btSin(angle), radius * (1 - btCos(angle)), flat.z());
    }
    along -= turn;
    const btScalar back = third - turn;
    if (along < back) return btVector3(third - along, 2 * radius, flat.z());
    along -= back;
    if (along < turn) {
        const btScalar angle = along / radius;
        return btVector3(third - back - radius * btSin(angle), radius * (3 - btCos(angle)),
                         flat.z());
    }
    return btVector3(third - back + along - turn, 4 * radius, flat.z());
}

// Bullet's solver, with self-collisions of clusters. By itself Bullet 3.24 has none: a body's flag
// CL_SELF is in the mask by which it is to be left out (SVSmask), so that no case applies. So this
// calls what that case would, at the same place, after constraints were solved.
class ClusterContacts : public btDefaultSoftBodySolver
{
  public:
    void updateSoftBodies() override
    {
        for (int i = 0; i < m_softBodySet.size(); ++i) {
            if (m_softBodySet[i]->m_clusters.size() == 0) continue;
            btSoftColliders::CollideCL_SS collide;
            collide.ProcessSoftSoft(m_softBodySet[i], m_softBodySet[i]);
        }
        btDefaultSoftBodySolver::updateSoftBodies();
    }
};

// A world with ground, rod and cloth.
class World
{
  public:
    World(Way way, const Settings &settings)
        : way_(way), dispatcher_(&configuration_),
          world(&dispatcher_, &broadphase_, &constraints_, &configuration_,
                way == STARCONTOUR ? static_cast<btSoftBodySolver *>(&solver_) : &clusters_),
          ground_(btVector3(5, 1, 5)), rod_(btVector3(btScalar(0.12), btScalar(2), btScalar(0.12)))
    {
        const btVector3 gravity(0, btScalar(-9.81), 0);
        world.setGravity(gravity);
        world.getWorldInfo().m_gravity = gravity;
        add(ground_, btTransform(btQuaternion::getIdentity(), btVector3(0, -1, 0)));
        // Not in line with the folds.
        add(rod_, btTransform(btQuaternion(btVector3(0, 1, 0), btScalar(0.5)) *
                                  btQuaternion(btVector3(1, 0, 0), SIMD_HALF_PI),
                              btVector3(btScalar(0.35), btScalar(0.6), 0)));

        const btScalar h = side / 2, cell = side / btScalar(settings.nodes - 1);
        thickness = cell / 4;
        cloth = btSoftBodyHelpers::CreatePatch(
            world.getWorldInfo(), btVector3(-h, 0, -h), btVector3(h, 0, -h), btVector3(-h, 0, h),
            btVector3(h, 0, h), settings.nodes, settings.nodes, 0, true);
        cloth->m_materials[0]->m_kLST = btScalar(0.9);
        cloth->generateBendingConstraints(2, cloth->m_materials[0]);
        cloth->setTotalMass(1);
        cloth->getCollisionShape()->setMargin(thickness / 2);
        cloth->m_cfg.piterations = 10;
        cloth->m_cfg.kDP = btScalar(0.01);
        cloth->m_cfg.kDF = btScalar(0.5);
        cloth->setActivationState(DISABLE_DEACTIVATION);
        if (way == STARCONTOUR) contacts = &solver_.add(cloth, thickness);
        if (way == CLUSTERS) cloth->generateClusters(settings.clusters);
        const btScalar radius = cell;
        for (int i = 0; i < cloth->m_nodes.size(); ++i) {
            btSoftBody::Node &n = cloth->m_nodes[i];
            n.m_x = folded(n.m_x, radius) + btVector3(0, btScalar(0.8), 0);
            n.m_q = n.m_x;
        }
        cloth->updateNormals();
        world.addSoftBody(cloth);
    }

    World(const World &) = delete;
    World &operator=(const World &) = delete;

    ~World()
    {
        world.removeSoftBody(cloth);
        delete cloth;
        for (btRigidBody *body : bodies_) {
            world.removeRigidBody(body);
            delete body;
        }
    }

    // A frame; how long it took.
    double step()
    {
        const double begin = SelfContacts::milliseconds();
        world.stepSimulation(btScalar(1) / 60, 0);
        return SelfContacts::milliseconds() - begin;
    }

    void write(const char *prefix) const
    {
        const std::string name = std::string(prefix) + "-" + names[way_] + ".obj";
        std::FILE *const file = std::fopen(name.c_str(), "w");
        if (file == nullptr) throw std::runtime_error("cannot write " + name);
        for (int i = 0; i < cloth->m_nodes.size(); ++i) {
            const btVector3 &x = cloth->m_nodes[i].m_x;
            std::fprintf(file, "v %.9g %.9g %.9g\n", double(x.x()), double(x.y()), double(x.z()));
        }
        for (int i = 0; i < cloth->m_faces.size(); ++i) {
            std::fprintf(file, "f");
            for (const btSoftBody::Node *n : cloth->m_faces[i].m_n)
                std::fprintf(file, " %d", int(n - &cloth->m_nodes[0]) + 1);
            std::fprintf(file, "\n");
        }
        if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + name);
    }

  private:
    void add(btCollisionShape &shape, const btTransform &where)
    {
        shape.setMargin(btScalar(0.01));
        bodies_.push_back(
            new btRigidBody(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape)));
        bodies_.back()->setWorldTransform(where);
        bodies_.back()->setFriction(btScalar(0.5));
        world.addRigidBody(bodies_.back());
    }

    Way way_;
    SelfContacts solver_;
    ClusterContacts clusters_;
    btSoftBodyRigidBodyCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver constraints_;

  public:
    btSoftRigidDynamicsWorld world;
    btSoftBody *cloth = nullptr;
    btScalar thickness = 0;
    SelfContacts::Cloth *contacts = nullptr; // of self_contacts.hpp

  private:
    btBoxShape ground_;
    btCylinderShape rod_;
    std::vector<btRigidBody *> bodies_;
};

// What a frame of one cloth is like.
struct Measured {
    double ms = 0;
    uint64_t pairs = 0;
    double distance = 0; // at most the thickness
};

// Measures poses: a model and a workspace of its own, so that nothing it does helps the solver.
class Ruler
{
  public:
    explicit Ruler(const World &world)
    {
        std::vector<uint32_t> triangles;
        const btSoftBody &cloth = *world.cloth;
        for (int i = 0; i < cloth.m_faces.size(); ++i)
            for (const btSoftBody::Node *n : cloth.m_faces[i].m_n)
                triangles.push_back(static_cast<uint32_t>(n - &cloth.m_nodes[0]));
        const sc_pose pose = SelfContacts::pose(cloth, &btSoftBody::Node::m_x);
        auto mesh = SelfContacts::sized<sc_mesh>();
        mesh.vertex_count = pose.vertex_count;
        mesh.triangle_count = static_cast<uint32_t>(triangles.size() / 3);
        mesh.position_type = pose.position_type;
        mesh.position_stride = pose.position_stride;
        mesh.positions = pose.positions;
        mesh.indices = triangles.data();
        auto build = SelfContacts::sized<sc_build_options>();
        build.weld = SC_WELD_NONE;
        sc_model *model = nullptr;
        SelfContacts::check(sc_build(&mesh, &build, &model));
        model_.reset(model);
        auto options = SelfContacts::sized<sc_workspace_options>();
        options.flags = SC_WORKSPACE_NEAR;
        sc_workspace *workspace = nullptr;
        SelfContacts::check(sc_workspace_create_for(model, &options, &workspace));
        workspace_.reset(workspace);
        bounds_.resize(mesh.vertex_count);
    }

    // Says whether the positions are numbers at all.
    bool measure(const World &world, Measured &measured)
    {
        const sc_pose pose = SelfContacts::pose(*world.cloth, &btSoftBody::Node::m_x);
        auto count = SelfContacts::sized<sc_query_options>();
        count.output = SC_OUTPUT_COUNT;
        auto result = SelfContacts::sized<sc_result>();
        const sc_status status = sc_query(model_.get(), workspace_.get(), &pose, &count, &result);
        if (status == SC_ERROR_NOT_FINITE) return false;
        SelfContacts::check(status);
        measured.pairs = result.count;
        auto options = SelfContacts::sized<sc_near_options>();
        options.output = SC_OUTPUT_COUNT;
        options.distance = world.thickness;
        auto near = SelfContacts::sized<sc_near_result>();
        near.vertex_bounds = bounds_.data();
        SelfContacts::check(sc_query_near(model_.get(), workspace_.get(), &pose, &options, &near));
        measured.distance = *std::min_element(bounds_.begin(), bounds_.end());
        return true;
    }

  private:
    std::unique_ptr<sc_model, void (*)(sc_model *)> model_{nullptr, sc_model_free};
    std::unique_ptr<sc_workspace, void (*)(sc_workspace *)> workspace_{nullptr, sc_workspace_free};
    std::vector<double> bounds_;
};

int run(const Settings &settings)
{
    std::unique_ptr<World> worlds[WAYS];
    for (int way = 0; way < WAYS; ++way) worlds[way].reset(new World(Way(way), settings));
    Ruler ruler(*worlds[0]);
    std::FILE *const csv = settings.csv != nullptr ? std::fopen(settings.csv, "w") : nullptr;
    if (settings.csv != nullptr && csv == nullptr)
        throw std::runtime_error("cannot write the CSV file");
    if (csv != nullptr)
        std::fprintf(
            csv, "frame,way,ms,intersections,distance,near_ms,solve_ms,hold_ms,contacts,held\n");

    std::vector<double> ms[WAYS], parts[3];
    uint64_t most[WAYS] = {}, last[WAYS] = {};
    int frames[WAYS] = {}, lost[WAYS] = {}, stopped = 0, full = 0;
    double least[WAYS];
    std::fill(least, least + WAYS, 1.0);
    unsigned most_contacts = 0, most_rounds = 0;
    size_t joints = 0;
    for (int frame = 0; frame < settings.frames; ++frame)
        for (int turn = 0; turn < WAYS; ++turn) {
            const int way = (frame + turn) % WAYS;
            if (lost[way] != 0) continue;
            Measured m;
            m.ms = worlds[way]->step();
            if (!ruler.measure(*worlds[way], m)) {
                lost[way] = frame + 1;
                continue;
            }
            ms[way].push_back(m.ms);
            most[way] = std::max(most[way], last[way] = m.pairs);
            frames[way] += m.pairs != 0;
            least[way] = std::min(least[way], m.distance / worlds[way]->thickness);
            const SelfContacts::Cloth none{}, *c = worlds[way]->contacts;
            if (c != nullptr) {
                most_contacts = std::max(most_contacts, c->contacts);
                most_rounds = std::max(most_rounds, c->rounds);
                stopped += c->stopped;
                full += c->full;
                parts[0].push_back(c->near_ms);
                parts[1].push_back(c->solve_ms);
                parts[2].push_back(c->hold_ms);
            } else {
                c = &none;
            }
            joints = std::max(joints, size_t(worlds[CLUSTERS]->cloth->m_joints.size()));
            if (csv != nullptr)
                std::fprintf(csv, "%d,%s,%.3f,%llu,%.6g,%.3f,%.3f,%.3f,%u,%u\n", frame, names[way],
                             m.ms, static_cast<unsigned long long>(m.pairs), m.distance, c->near_ms,
                             c->solve_ms, c->hold_ms, c->contacts, c->held);
        }
    if (csv != nullptr && std::fclose(csv) != 0)
        throw std::runtime_error("cannot write the CSV file");

    std::printf("%d x %d nodes, %d triangles, %d clusters, %d frames; %s precision\n",
                settings.nodes, settings.nodes, worlds[0]->cloth->m_faces.size(),
                worlds[CLUSTERS]->cloth->m_clusters.size(), settings.frames,
                sizeof(btScalar) == sizeof(float) ? "single" : "double");
    std::printf("%-12s %9s %9s %10s %10s %10s %10s\n", "", "median ms", "most ms", "frames hit",
                "most pairs", "last pairs", "distance");
    const auto median = [](std::vector<double> &list) {
        std::sort(list.begin(), list.end());
        return list.empty() ? 0 : list[list.size() / 2];
    };
    for (int way = 0; way < WAYS; ++way) {
        const double middle = median(ms[way]);
        std::printf("%-12s %9.2f %9.2f %10d %10llu %10llu %10.3f\n", names[way], middle,
                    ms[way].empty() ? 0 : ms[way].back(), frames[way],
                    static_cast<unsigned long long>(most[way]),
                    static_cast<unsigned long long>(last[way]), least[way]);
        if (settings.obj != nullptr) worlds[way]->write(settings.obj);
    }
    for (int way = 0; way < WAYS; ++way)
        if (lost[way] != 0)
            std::printf("%s: positions are no numbers in frame %d, the last one\n", names[way],
                        lost[way] - 1);
    std::printf("frames hit: with intersections; distance: the least, in thicknesses\n");
    std::printf("clusters: at most %d contacts\n", int(joints));
    std::printf(
        "starcontour: near %.2f, rounds %.2f, hold back %.2f ms (medians); at most %u contacts, "
        "%u rounds of holding back; %d frames stopped, %d with too many contacts\n",
        median(parts[0]), median(parts[1]), median(parts[2]), most_contacts, most_rounds, stopped,
        full);
    const bool good =
        lost[STARCONTOUR] == 0 && frames[STARCONTOUR] == 0 && least[STARCONTOUR] >= 0.125;
    if (!good) std::printf("FAILED: intersections, or nearer than an eighth of the thickness\n");
    return good ? 0 : 1;
}

} // namespace

int main(int count, char **arguments)
{
    Settings settings;
    for (int i = 1; i < count; ++i) {
        const std::string name = arguments[i];
        const char *const value = i + 1 < count ? arguments[++i] : "";
        if (name == "--nodes")
            settings.nodes = std::max(8, std::atoi(value));
        else if (name == "--frames")
            settings.frames = std::max(1, std::atoi(value));
        else if (name == "--clusters")
            settings.clusters = std::max(0, std::atoi(value));
        else if (name == "--csv")
            settings.csv = value;
        else if (name == "--obj")
            settings.obj = value;
        else {
            std::fprintf(stderr, "cloth: unknown option %s\n", name.c_str());
            return 2;
        }
    }
    try {
        return run(settings);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "cloth: %s\n", error.what());
        return 2;
    }
}
