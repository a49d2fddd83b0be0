/*
 * What a compiled peer offers to driver.cpp, and what it gets. One file a peer defines make_peers;
 * each is linked with the driver into a program of its own.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PEERS_PEER_H
#define PEERS_PEER_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace peers
{

/* Two triangles, smaller number first. */
typedef std::pair<uint32_t, uint32_t> pair;
typedef std::vector<pair> pair_list;

/* An animation of one mesh, read from a folder. */
struct scene {
    std::string name;
    size_t triangles = 0, vertices = 0, frames = 0;
    std::vector<uint32_t> corners; /* 3 vertices a triangle */
    std::vector<double> positions; /* x, y, z of each vertex, frame after frame */

    const double *frame(size_t f) const
    {
        return positions.data() + 3 * vertices * f;
    }

    /* Whether two triangles have a vertex in common. */
    bool adjacent(uint32_t a, uint32_t b) const
    {
        const uint32_t *v = &corners[3 * size_t(a)], *w = &corners[3 * size_t(b)];
        for (int i = 0; i < 3; ++i) {
            if (v[i] == w[0] || v[i] == w[1] || v[i] == w[2]) return true;
        }
        return false;
    }
};

/* Which of the pairs that starcontour finds a peer should find. */
enum class kind {
    all,  /* all pairs of triangles that meet elsewhere than in what they share */
    apart /* those of triangles that share no vertex */
};

class peer
{
  public:
    virtual ~peer() = default;
    virtual std::string name() const = 0;    /* of the library */
    virtual std::string version() const = 0; /* of the library that runs */
    virtual std::string what() const = 0;    /* what a query does, without commas */
    virtual kind finds() const = 0;
    virtual bool threaded() const = 0; /* whether it can use more than one thread */

    /*
     * Gets ready for a scene, which outlives the peer; not timed. Throws std::runtime_error with
     * the reason if the library cannot take the mesh.
     */
    virtual void build(const scene &animation, unsigned threads) = 0;

    /* Everything there is to do for a new pose; timed. Adds pairs to an empty list, in any
       order. */
    virtual void query(const double *positions, pair_list &found) = 0;
};

/* The ways of using a library that are measured. */
std::vector<std::unique_ptr<peer>> make_peers();

/* ------------------------------------------------------------------------------------------------
 * Several objects. Their triangles are numbered one object after the other, and pairs are of such
 * numbers.
 */

/* One of them; what does not move has one frame. */
struct object {
    scene mesh;
    bool itself = false; /* its pairs with itself are wanted */
    uint32_t first = 0;  /* the number of its first triangle */

    bool moves() const
    {
        return mesh.frames > 1;
    }
    const double *frame(size_t f) const
    {
        return mesh.frame(moves() ? f : 0);
    }
};

struct object_scene {
    std::string name;
    size_t triangles = 0, frames = 0;
    std::vector<object> objects;
};

/* As peer, about several objects. It finds the pairs of triangles of two objects, and those of one
   object that is asked about itself of which the triangles share no vertex. */
class objects_peer
{
  public:
    virtual ~objects_peer() = default;
    virtual std::string name() const = 0;
    virtual std::string version() const = 0;
    virtual std::string what() const = 0;
    virtual bool threaded() const = 0;
    virtual void build(const object_scene &scene, unsigned threads) = 0;

    /* Everything there is to do for a frame; timed. What does not move was built before. */
    virtual void query(size_t frame, pair_list &found) = 0;
};

/* None for a library that takes one mesh. */
std::vector<std::unique_ptr<objects_peer>> make_objects_peers();

} // namespace peers

#endif /* PEERS_PEER_H */
