/*
 * Embree (Intel): rtcCollide on a scene with itself, or with another one.
 *
 * SPDX-License-Identifier: MIT
 *
 * Triangles are one user geometry, as rtcCollide asks for; their boxes are floats rounded outward.
 * For each pose the tree is refitted, or built anew with low quality (Morton codes), then
 * rtcCollide hands out pairs of triangles whose boxes overlap. It has no test of triangles and
 * knows no neighbours: both are done in the callback, by triangle_test.h. Each pair comes in both
 * orders, and each triangle with itself; the callback drops what is not in ascending order.
 *
 * Several objects are a scene each. Those that move are refitted or built anew for each frame, the
 * others built once with the best quality; then rtcCollide is called for each two whose bounds
 * (rtcGetSceneBounds) overlap, and for each that is asked about itself, one after the other. With
 * several threads each such call, and each build, uses them all.
 */
#include "peer.h"
#include "triangle_test.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

namespace peers
{
namespace
{

float round_down(double x)
{
    const float f = float(x);
    return double(f) <= x ? f : std::nextafterf(f, -std::numeric_limits<float>::infinity());
}

float round_up(double x)
{
    const float f = float(x);
    return double(f) >= x ? f : std::nextafterf(f, std::numeric_limits<float>::infinity());
}

bool boxes_overlap(const double *const p[3], const double *const q[3])
{
    for (int k = 0; k < 3; ++k) {
        if (std::max({p[0][k], p[1][k], p[2][k]}) < std::min({q[0][k], q[1][k], q[2][k]}) ||
            std::max({q[0][k], q[1][k], q[2][k]}) < std::min({p[0][k], p[1][k], p[2][k]})) {
            return false;
        }
    }
    return true;
}

/* A tree over the triangles of a mesh, in the latest pose that it was given. */
class tree
{
    RTCGeometry geometry = nullptr;

    static void bounds(const RTCBoundsFunctionArguments *arguments)
    {
        const tree *self = static_cast<const tree *>(arguments->geometryUserPtr);
        const double *p = self->corner(arguments->primID, 0);
        const double *q = self->corner(arguments->primID, 1);
        const double *r = self->corner(arguments->primID, 2);
        RTCBounds *box = arguments->bounds_o;
        box->lower_x = round_down(std::min({p[0], q[0], r[0]}));
        box->lower_y = round_down(std::min({p[1], q[1], r[1]}));
        box->lower_z = round_down(std::min({p[2], q[2], r[2]}));
        box->upper_x = round_up(std::max({p[0], q[0], r[0]}));
        box->upper_y = round_up(std::max({p[1], q[1], r[1]}));
        box->upper_z = round_up(std::max({p[2], q[2], r[2]}));
    }

  public:
    const scene *const mesh;
    const double *pose = nullptr;
    RTCScene handle = nullptr;

    explicit tree(const scene &of) : mesh(&of)
    {
    }
    ~tree()
    {
        if (handle) rtcReleaseScene(handle);
    }
    tree(const tree &) = delete;
    tree &operator=(const tree &) = delete;

    const double *corner(uint32_t t, int k) const
    {
        return pose + 3 * size_t(mesh->corners[3 * size_t(t) + size_t(k)]);
    }

    void place(RTCDevice device, const double *positions)
    {
        pose = positions;
        rtcCommitGeometry(geometry);
        rtcCommitScene(handle);
        if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
            throw std::runtime_error("Embree could not build the tree");
    }

    void build(RTCDevice device, bool moves, bool refit)
    {
        handle = rtcNewScene(device);
        const RTCBuildQuality quality = moves ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_HIGH;
        rtcSetSceneFlags(handle, moves ? RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST
                                       : RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(handle, quality);
        geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, unsigned(mesh->triangles));
        rtcSetGeometryUserData(geometry, this);
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
        rtcSetGeometryBuildQuality(geometry, moves && refit ? RTC_BUILD_QUALITY_REFIT : quality);
        rtcAttachGeometry(handle, geometry);
        rtcReleaseGeometry(geometry); /* the scene keeps it */
        place(device, mesh->frame(0));
    }
};

/* What a call of rtcCollide is about, and where pairs go. */
struct collision {
    const tree *a, *b;
    uint32_t first_a, first_b; /* is added to numbers of triangles */
    std::mutex *lock;          /* of *found */
    pair_list *found;

    static void report(void *user, RTCCollision *collisions, unsigned count)
    {
        const collision *self = static_cast<const collision *>(user);
        const tree &one = *self->a, &other = *self->b;
        for (unsigned i = 0; i < count; ++i) {
            const uint32_t a = collisions[i].primID0, b = collisions[i].primID1;
            if (&one == &other && (a >= b || one.mesh->adjacent(a, b))) continue;
            const double *const p[3] = {one.corner(a, 0), one.corner(a, 1), one.corner(a, 2)};
            const double *const q[3] = {other.corner(b, 0), other.corner(b, 1), other.corner(b, 2)};
            if (!boxes_overlap(p, q) || !triangles_meet(p, q)) continue;
            const std::lock_guard<std::mutex> guard(*self->lock);
            self->found->push_back(pair(self->first_a + a, self->first_b + b));
        }
    }

    void ask()
    {
        rtcCollide(a->handle, b->handle, report, this);
    }
};

RTCDevice new_device(unsigned threads)
{
    RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (!device) throw std::runtime_error("Embree offers no device on this processor");
    return device;
}

class embree : public peer
{
    const bool refit;
    RTCDevice device = nullptr;
    std::unique_ptr<tree> self;
    std::mutex lock;

    void release()
    {
        self.reset();
        if (device) rtcReleaseDevice(device);
        device = nullptr;
    }

  public:
    explicit embree(bool refitting) : refit(refitting)
    {
    }
    ~embree() override
    {
        release();
    }

    std::string name() const override
    {
        return "embree";
    }
    std::string version() const override
    {
        return RTC_VERSION_STRING;
    }
    std::string what() const override
    {
        return std::string("rtcCollide: tree ") + (refit ? "refitted" : "rebuilt") +
               "; exact triangle test of ours; pairs without common vertex";
    }
    kind finds() const override
    {
        return kind::apart;
    }
    bool threaded() const override
    {
        return true;
    }

    void build(const scene &animation, unsigned threads) override
    {
        release();
        device = new_device(threads);
        self = std::make_unique<tree>(animation);
        self->build(device, true, refit);
    }

    void query(const double *positions, pair_list &found) override
    {
        self->place(device, positions);
        collision{self.get(), self.get(), 0, 0, &lock, &found}.ask();
    }
};

/* Several objects, a tree each. */
class embree_objects : public objects_peer
{
    const bool refit;
    const object_scene *all = nullptr;
    RTCDevice device = nullptr;
    std::vector<std::unique_ptr<tree>> trees;
    std::vector<RTCBounds> boxes;
    std::mutex lock;

    void release()
    {
        trees.clear();
        if (device) rtcReleaseDevice(device);
        device = nullptr;
    }

    bool boxes_meet(size_t i, size_t j) const
    {
        const RTCBounds &a = boxes[i], &b = boxes[j];
        return a.lower_x <= b.upper_x && b.lower_x <= a.upper_x && a.lower_y <= b.upper_y &&
               b.lower_y <= a.upper_y && a.lower_z <= b.upper_z && b.lower_z <= a.upper_z;
    }

  public:
    explicit embree_objects(bool refitting) : refit(refitting)
    {
    }
    ~embree_objects() override
    {
        release();
    }

    std::string name() const override
    {
        return "embree";
    }
    std::string version() const override
    {
        return RTC_VERSION_STRING;
    }
    std::string what() const override
    {
        return std::string("rtcCollide of two scenes: trees ") + (refit ? "refitted" : "rebuilt");
    }
    bool threaded() const override
    {
        return true;
    }

    void build(const object_scene &scene, unsigned threads) override
    {
        release();
        all = &scene;
        device = new_device(threads);
        boxes.resize(all->objects.size());
        for (const object &o : all->objects) {
            trees.push_back(std::make_unique<tree>(o.mesh));
            trees.back()->build(device, o.moves(), refit);
        }
    }

    void query(size_t frame, pair_list &found) override
    {
        const std::vector<object> &objects = all->objects;
        for (size_t i = 0; i < objects.size(); ++i) {
            if (objects[i].moves()) trees[i]->place(device, objects[i].frame(frame));
            rtcGetSceneBounds(trees[i]->handle, &boxes[i]);
        }
        for (size_t i = 0; i < objects.size(); ++i) {
            for (size_t j = i; j < objects.size(); ++j) {
                if (i == j ? !objects[i].itself : !boxes_meet(i, j)) continue;
                collision{trees[i].get(),   trees[j].get(), objects[i].first,
                          objects[j].first, &lock,          &found}
                    .ask();
            }
        }
    }
};

} // namespace

std::vector<std::unique_ptr<peer>> make_peers()
{
    std::vector<std::unique_ptr<peer>> list;
    list.push_back(std::make_unique<embree>(true));
    list.push_back(std::make_unique<embree>(false));
    return list;
}

std::vector<std::unique_ptr<objects_peer>> make_objects_peers()
{
    std::vector<std::unique_ptr<objects_peer>> list;
    list.push_back(std::make_unique<embree_objects>(true));
    list.push_back(std::make_unique<embree_objects>(false));
    return list;
}

} // namespace peers
