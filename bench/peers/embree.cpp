/*
 * Embree (Intel): rtcCollide on a scene with itself.
 *
 * SPDX-License-Identifier: MIT
 *
 * Triangles are one user geometry, as rtcCollide asks for; their boxes are floats rounded outward.
 * For each pose the tree is refitted, or built anew with low quality (Morton codes), then
 * rtcCollide hands out pairs of triangles whose boxes overlap. It has no test of triangles and
 * knows no neighbours: both are done in the callback, by triangle_test.h. Each pair comes in both
 * orders, and each triangle with itself; the callback drops what is not in ascending order.
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

class embree : public peer
{
    const bool refit;
    const scene *mesh = nullptr;
    const double *pose = nullptr;
    RTCDevice device = nullptr;
    RTCScene tree = nullptr;
    RTCGeometry geometry = nullptr;
    std::mutex lock; /* of *result */
    pair_list *result = nullptr;

    const double *corner(uint32_t t, int k) const
    {
        return pose + 3 * size_t(mesh->corners[3 * size_t(t) + size_t(k)]);
    }

    static void bounds(const RTCBoundsFunctionArguments *arguments)
    {
        const embree *self = static_cast<const embree *>(arguments->geometryUserPtr);
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

    static void collide(void *user, RTCCollision *collisions, unsigned count)
    {
        embree *self = static_cast<embree *>(user);
        for (unsigned i = 0; i < count; ++i) {
            const uint32_t a = collisions[i].primID0, b = collisions[i].primID1;
            if (a >= b || self->mesh->adjacent(a, b)) continue;
            const double *const p[3] = {self->corner(a, 0), self->corner(a, 1), self->corner(a, 2)};
            const double *const q[3] = {self->corner(b, 0), self->corner(b, 1), self->corner(b, 2)};
            if (!boxes_overlap(p, q) || !triangles_meet(p, q)) continue;
            const std::lock_guard<std::mutex> guard(self->lock);
            self->result->push_back(pair(a, b));
        }
    }

    void release()
    {
        if (tree) rtcReleaseScene(tree);
        if (device) rtcReleaseDevice(device);
        tree = nullptr;
        device = nullptr;
    }

    void commit()
    {
        rtcCommitGeometry(geometry);
        rtcCommitScene(tree);
        if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
            throw std::runtime_error("Embree could not build the tree");
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
        mesh = &animation;
        pose = mesh->frame(0);
        device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
        if (!device) throw std::runtime_error("Embree offers no device on this processor");
        tree = rtcNewScene(device);
        rtcSetSceneFlags(tree, RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(tree, RTC_BUILD_QUALITY_LOW);
        geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, unsigned(mesh->triangles));
        rtcSetGeometryUserData(geometry, this);
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
        rtcSetGeometryBuildQuality(geometry,
                                   refit ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_LOW);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(tree, geometry);
        rtcReleaseGeometry(geometry); /* the scene keeps it */
        commit();
    }

    void query(const double *positions, pair_list &found) override
    {
        pose = positions;
        result = &found;
        commit();
        rtcCollide(tree, tree, collide, this);
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

} // namespace peers
