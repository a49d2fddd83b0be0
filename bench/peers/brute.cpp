/*
 * No peer: the triangle test on each pair of triangles whose boxes overlap, found without any tree.
 * It checks the driver and the triangle test against starcontour, on small scenes: its time grows
 * with the square of the triangles.
 *
 * SPDX-License-Identifier: MIT
 */
#include "peer.h"
#include "triangle_test.h"

#include <algorithm>

namespace peers
{
namespace
{

class brute : public peer
{
    const scene *mesh = nullptr;
    std::vector<double> low, high; /* boxes of triangles */

  public:
    std::string name() const override
    {
        return "brute";
    }
    std::string version() const override
    {
        return "-";
    }
    std::string what() const override
    {
        return "all pairs of boxes; exact triangle test of ours";
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
        low.resize(3 * mesh->triangles);
        high.resize(3 * mesh->triangles);
    }

    void query(const double *positions, pair_list &found) override
    {
        const auto corner = [&](size_t t, int k) {
            return positions + 3 * size_t(mesh->corners[3 * t + size_t(k)]);
        };
        for (size_t t = 0; t < mesh->triangles; ++t) {
            for (size_t k = 0; k < 3; ++k) {
                const double x = corner(t, 0)[k], y = corner(t, 1)[k], z = corner(t, 2)[k];
                low[3 * t + k] = std::min({x, y, z});
                high[3 * t + k] = std::max({x, y, z});
            }
        }
        for (uint32_t a = 0; a < mesh->triangles; ++a) {
            const double *const p[3] = {corner(a, 0), corner(a, 1), corner(a, 2)};
            for (uint32_t b = a + 1; b < mesh->triangles; ++b) {
                bool overlap = true;
                for (size_t k = 0; k < 3; ++k) {
                    overlap &= low[3 * size_t(a) + k] <= high[3 * size_t(b) + k] &&
                               low[3 * size_t(b) + k] <= high[3 * size_t(a) + k];
                }
                if (!overlap || mesh->adjacent(a, b)) continue;
                const double *const q[3] = {corner(b, 0), corner(b, 1), corner(b, 2)};
                if (triangles_meet(p, q)) found.push_back(pair(a, b));
            }
        }
    }
};

/* The same of several objects. */
class brute_objects : public objects_peer
{
    const object_scene *all = nullptr;

  public:
    std::string name() const override
    {
        return "brute";
    }
    std::string version() const override
    {
        return "-";
    }
    std::string what() const override
    {
        return "all pairs; exact triangle test of ours";
    }
    bool threaded() const override
    {
        return false;
    }

    void build(const object_scene &scene, unsigned) override
    {
        all = &scene;
    }

    void query(size_t frame, pair_list &found) override
    {
        for (size_t i = 0; i < all->objects.size(); ++i)
            for (size_t j = i; j < all->objects.size(); ++j) ask(i, j, frame, found);
    }

  private:
    void ask(size_t i, size_t j, size_t frame, pair_list &found) const
    {
        const object &one = all->objects[i], &other = all->objects[j];
        if (i == j && !one.itself) return;
        for (uint32_t a = 0; a < one.mesh.triangles; ++a) {
            for (uint32_t b = i == j ? a + 1 : 0; b < other.mesh.triangles; ++b) {
                const double *p[3], *q[3];
                for (size_t k = 0; k < 3; ++k) {
                    p[k] = one.frame(frame) + 3 * size_t(one.mesh.corners[3 * size_t(a) + k]);
                    q[k] = other.frame(frame) + 3 * size_t(other.mesh.corners[3 * size_t(b) + k]);
                }
                if (i == j && one.mesh.adjacent(a, b)) continue;
                if (triangles_meet(p, q)) found.push_back(pair(one.first + a, other.first + b));
            }
        }
    }
};

} // namespace

std::vector<std::unique_ptr<peer>> make_peers()
{
    std::vector<std::unique_ptr<peer>> list;
    list.push_back(std::make_unique<brute>());
    return list;
}

std::vector<std::unique_ptr<objects_peer>> make_objects_peers()
{
    std::vector<std::unique_ptr<objects_peer>> list;
    list.push_back(std::make_unique<brute_objects>());
    return list;
}

} // namespace peers
