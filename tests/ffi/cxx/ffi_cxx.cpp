// C++17 by starcontour.hpp: the application's own vertex type, exceptions, two threads.
//
//     ffi_cxx MESH GOLDEN
//
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include <starcontour.hpp>

namespace
{

using starcontour::Error;
using starcontour::Workspace;

// A vertex as the application stores it. Only position is read, in steps of sizeof(Vertex).
struct Vertex {
    std::array<float, 3> position;
    std::array<float, 3> normal;
    std::array<float, 2> uv;
};

using Triangle = std::array<std::uint32_t, 3>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

starcontour::Positions positions(const std::vector<Vertex> &vertices)
{
    return {vertices.empty() ? nullptr : vertices[0].position.data(), vertices.size(),
            sizeof(Vertex)};
}

starcontour::Model build(const std::vector<Vertex> &rest, const std::vector<Triangle> &triangles)
{
    return {positions(rest), triangles.empty() ? nullptr : triangles[0].data(), triangles.size()};
}

Pairs plain(const std::vector<sc_pair> &found)
{
    Pairs pairs;
    for (const sc_pair &pair : found) pairs.emplace_back(pair.a, pair.b);
    return pairs;
}

Pairs query(Workspace &workspace, const std::vector<Vertex> &vertices)
{
    return plain(workspace.query(positions(vertices)));
}

int passed, failed;

void check(const char *what, bool condition)
{
    ++(condition ? passed : failed);
    if (!condition) std::printf("failed: %s\n", what);
}

template <typename Call> bool refused(sc_status status, const char *text, Call call)
{
    try {
        call();
    } catch (const Error &error) {
        return error.status == status && std::strstr(error.what(), text);
    }
    return false;
}

// Pairs in the numbers of the one mesh of all objects, with their times, or 0; sorted.
using Timed = std::vector<std::tuple<std::size_t, std::size_t, double>>;

// firsts: the number, in that mesh, of each object's first a and first b.
Timed joined(const starcontour::Meetings &found, const std::array<std::size_t, 2> (&firsts)[2])
{
    Timed pairs;
    for (const auto &range : found.ranges)
        for (auto i = range.first; i < range.first + range.count; ++i)
            pairs.emplace_back(found.pairs[i].a + firsts[range.object_a][0],
                               found.pairs[i].b + firsts[range.object_b][1],
                               found.times.empty() ? 0 : found.times[i]);
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

Timed of_one(const std::vector<sc_pair> &found, const std::vector<double> &times = {})
{
    Timed pairs;
    for (std::size_t i = 0; i < found.size(); ++i)
        pairs.emplace_back(found[i].a, found[i].b, times.empty() ? 0 : times[i]);
    return pairs;
}

// The mesh's two cloths as two objects, whose poses are the two halves of the mesh's: the same
// pairs.
void test_scene(const std::vector<Vertex> &rest, const std::vector<Vertex> &moved,
                const std::vector<Triangle> &triangles)
{
    const std::size_t v = rest.size() / 2, t = triangles.size() / 2;
    const std::vector<Triangle> one(triangles.begin(), triangles.begin() + static_cast<long>(t));
    std::vector<Triangle> other(triangles.begin() + static_cast<long>(t), triangles.end());
    for (auto &corners : other)
        for (auto &corner : corners) corner -= static_cast<std::uint32_t>(v);
    const auto half = [v](const std::vector<Vertex> &pose, std::size_t which) {
        return starcontour::Positions(pose[which * v].position.data(), v, sizeof(Vertex));
    };
    const auto whole = build(rest, triangles);
    const starcontour::Model models[] = {{half(rest, 0), one[0].data(), t},
                                         {half(rest, 1), other[0].data(), t}};
    const std::array<std::size_t, 2> of_triangles[] = {{0, 0}, {t, t}};
    const std::array<std::size_t, 2> of_faces[] = {{0, 0}, {v, t}};
    const std::array<std::size_t, 2> of_edges[] = {{0, 0}, {3 * t, 3 * t}};
    // Each cloth folded along its middle, so that it meets itself: more pairs than there is room
    // for.
    auto folded = moved;
    for (auto &vertex : folded) {
        auto &[x, y, z] = vertex.position;
        if (x > 1.5f) x = 3 - x, y += z / 8, z += (y - 1.5f) / 8;
    }

    Workspace workspace(whole, SC_WORKSPACE_NEAR);
    starcontour::Scene scene(SC_WORKSPACE_NEAR);
    for (std::size_t i = 0; i < 2; ++i) scene.add(models[i], half(rest, i));
    for (const auto *pose : {&rest, &moved, &std::as_const(folded)}) {
        for (std::size_t i = 0; i < 2; ++i) scene[i].set_pose(half(*pose, i));
        check("pairs of two objects",
              joined(scene.query(), of_triangles) == of_one(workspace.query(positions(*pose))));
        const auto near = scene.near(0.045);
        const auto near_one = workspace.near(positions(*pose), 0.045);
        check("near of two objects",
              joined(near.vertex_faces, of_faces) == of_one(near_one.vertex_faces) &&
                  joined(near.edge_edges, of_edges) == of_one(near_one.edge_edges));
        for (std::size_t i = 0; i < 2; ++i) scene[i].set_end(half(moved, i));
        const auto step = scene.step();
        const auto step_one = workspace.step(positions(*pose), positions(moved));
        check("a step of two objects",
              joined(step.vertex_faces, of_faces) ==
                      of_one(step_one.vertex_faces, step_one.vertex_face_times) &&
                  joined(step.edge_edges, of_edges) ==
                      of_one(step_one.edge_edges, step_one.edge_edge_times) &&
                  step.earliest == step_one.earliest &&
                  step.edge_edges.times.size() == step.edge_edges.pairs.size());
    }
    const auto ranges = scene.query().ranges;
    check("objects meet themselves and each other", ranges.size() == 3 && ranges[0].object_b == 0 &&
                                                        ranges[1].object_b == 1 &&
                                                        ranges[2].object_a == 1);
    const auto edges = [&] { return scene.step().edge_edges.pairs.size(); };
    const auto moving = edges();
    scene[1].stay();
    const auto staying = edges();
    scene[1].set_end(half(folded, 1));
    check("what stays ends where it began", staying != moving && edges() == staying);
    scene[1].set_end(half(moved, 1));
    check("what moves again", edges() == moving);
    scene.options.accept = [](void *, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t) {
        return 0;
    };
    check("pairs that are not accepted", scene.query().ranges.size() == 2);
    scene.options.accept = nullptr;
    scene[0].options.group = {1, 2};
    scene[1].options.group = {4, 4};
    check("groups of objects", scene.query().ranges.size() == 2);
    scene[1].options.itself = 0;
    check("one with itself", scene.query().ranges.size() == 1);
    auto count = starcontour::sized<sc_query_options>();
    count.output = SC_OUTPUT_COUNT;
    const auto counted = scene.query(&count);
    check("only counted", counted.pairs.empty() && counted.ranges.size() == 1 &&
                              counted.ranges[0].count == ranges[0].count);
    count.method = 99;
    check("option of a scene", refused(SC_ERROR_OPTION, "option", [&] { scene.query(&count); }));
    auto spoilt = moved;
    spoilt[v + 3].position[1] = NAN;
    scene[1].set_pose(half(spoilt, 1));
    check("NaN in an object",
          refused(SC_ERROR_NOT_FINITE,
                  "object 1 has a vertex that is not finite; vertex 3 is NaN or infinite",
                  [&] { scene.query(); }));
    starcontour::Scene crowd;
    for (int i = 0; i < 7; ++i) crowd.add(models[0], half(rest, 0));
    const auto &all = crowd.query();
    check("a crowd of one model, all in one place",
          all.ranges.size() == 21 && all.pairs.size() == 21 * all.ranges[20].count);
    starcontour::Scene nothing;
    check("an empty scene", nothing.query().pairs.empty() && nothing.step().earliest == 1);
    nothing.add(models[0], half(rest, 0));
    check("a scene without room for steps",
          refused(SC_ERROR_WORKSPACE, "workspace", [&] { nothing.step(); }));
}

void test(const char *mesh_path, const char *golden_path)
{
    std::vector<Vertex> rest;
    std::vector<Triangle> triangles;
    std::string line;
    for (std::ifstream file(mesh_path); std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            Vertex vertex{{}, {NAN, NAN, NAN}, {NAN, NAN}};
            for (auto &x : vertex.position) words >> x;
            rest.push_back(vertex);
        } else if (kind == "f") {
            Triangle triangle{};
            for (auto &v : triangle) words >> v, --v;
            triangles.push_back(triangle);
        }
    }
    auto moved = rest;
    for (auto i = rest.size() / 2; i < rest.size(); ++i)
        moved[i].position[2] += moved[i].position[0] / 4 - 0.25f;

    std::map<std::string, Pairs> golden;
    std::vector<std::tuple<std::uint64_t, std::uint32_t, std::uint32_t>> golden_contours;
    std::vector<double> golden_lengths;
    for (std::ifstream file(golden_path); std::getline(file, line);) {
        std::istringstream words(line);
        std::string pose;
        std::uint32_t a, b;
        if (words >> pose >> a >> b) golden[pose].emplace_back(a, b);
        std::uint32_t end;
        double length;
        if (pose == "contour" && words >> end >> length) {
            golden_contours.emplace_back(a, b, end);
            golden_lengths.push_back(length);
        }
    }
    const Pairs golden_rest = golden["rest"], golden_moved = golden["moved"];
    check("there is something to compare", !golden_rest.empty() && golden_rest != golden_moved);

    const auto model = build(rest, triangles);
    Workspace workspace(model);
    check("pairs at rest", query(workspace, rest) == golden_rest);
    check("pairs when moved", query(workspace, moved) == golden_moved);

    bool fine[2] = {true, true};
    const auto work = [&](bool &right, const std::vector<Vertex> &pose, const Pairs &wanted) {
        Workspace own(model);
        for (int i = 0; i < 200; ++i) right = right && query(own, pose) == wanted;
    };
    std::thread one(work, std::ref(fine[0]), std::cref(rest), std::cref(golden_rest));
    std::thread two(work, std::ref(fine[1]), std::cref(moved), std::cref(golden_moved));
    one.join();
    two.join();
    check("two threads, one model", fine[0] && fine[1]);

    auto spoilt = moved;
    spoilt[3].position[1] = NAN;
    check("NaN", refused(SC_ERROR_NOT_FINITE, "vertex 3 is NaN or infinite",
                         [&] { query(workspace, spoilt); }));
    spoilt.pop_back();
    check("number of vertices", refused(SC_ERROR_VERTEX_COUNT, "pose.vertex_count is",
                                        [&] { query(workspace, spoilt); }));
    check("no triangles", refused(SC_ERROR_EMPTY, "triangle", [&] { build(rest, {}); }));
    check("vertex out of range", refused(SC_ERROR_INDEX, "triangle 1 names vertex", [&] {
              build(rest, {{0, 1, 2}, {0, 1, 1u << 30}});
          }));
    auto options = starcontour::sized<sc_query_options>();
    options.method = 99;
    check("option", refused(SC_ERROR_OPTION, "options.method is 99, but at most",
                            [&] { workspace.query(positions(rest), &options); }));
    check("usable after errors", query(workspace, rest) == golden_rest);

    auto other = build(rest, triangles);
    auto moved_away = std::move(other);
    Workspace before(moved_away);
    auto after = std::move(before);
    check("moved model and workspace", query(after, rest) == golden_rest);

    // Nodes follow each other contour after contour, and so does the length of their segments.
    const auto traced = workspace.trace(positions(moved));
    std::uint64_t nodes = 0;
    bool lengths = !traced.contours.empty();
    for (const auto &contour : traced.contours) {
        double length = 0;
        const bool closed = contour.begin == SC_TRACE_CLOSED;
        for (std::uint64_t i = 0; i + (closed ? 0 : 1) < contour.count; ++i) {
            const auto &p = traced.nodes[contour.first + i].point;
            const auto &q = traced.nodes[contour.first + (i + 1) % contour.count].point;
            length += std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
        }
        lengths = lengths && contour.first == nodes &&
                  std::abs(length - contour.length) <= 1e-12 * contour.length;
        nodes += contour.count;
    }
    check("contours and their lengths", lengths && nodes == traced.nodes.size());
    const auto &at_rest = workspace.trace(positions(rest));
    check("contours of another pose", at_rest.nodes.size() != nodes);
    Pairs crossings;
    for (const auto &node : at_rest.nodes) crossings.emplace_back(node.edge, node.triangle);
    decltype(golden_contours) contours;
    bool long_enough = at_rest.contours.size() == golden_lengths.size() && !golden_lengths.empty();
    for (const auto &contour : at_rest.contours) {
        contours.emplace_back(contour.count, contour.begin, contour.end);
        const double wanted = long_enough ? golden_lengths[contours.size() - 1] : 0;
        long_enough = long_enough && std::abs(contour.length - wanted) <= 1e-12 * wanted;
    }
    check("contours at rest",
          crossings == golden["node"] && contours == golden_contours && long_enough);
    check("contours again", workspace.trace(positions(moved)).nodes.size() == nodes);
    std::uint32_t stop = 1;
    auto stopped = starcontour::sized<sc_trace_options>();
    stopped.cancel = &stop;
    check("contours that are not wanted any more",
          refused(SC_ERROR_INCOMPLETE, "", [&] { workspace.trace(positions(moved), &stopped); }));
    auto not_finite = moved;
    not_finite[3].position[1] = NAN;
    check("contours of NaN", refused(SC_ERROR_NOT_FINITE, "vertex 3 is NaN or infinite",
                                     [&] { workspace.trace(positions(not_finite)); }));

    Workspace larger(model, SC_WORKSPACE_NEAR);
    const auto near = larger.near(positions(moved), 0.045);
    check("pairs that are near", plain(near.vertex_faces) == golden["nearfaces"] &&
                                     plain(near.edge_edges) == golden["nearedges"]);
    auto kind = starcontour::sized<sc_near_options>();
    kind.kinds = SC_NEAR_EDGE_EDGE;
    check("of one kind", larger.near(positions(moved), 0.045, &kind).vertex_faces.empty());
    const auto step = larger.step(positions(rest), positions(moved));
    check("pairs of a step", plain(step.vertex_faces) == golden["stepfaces"] &&
                                 plain(step.edge_edges) == golden["stepedges"]);
    bool later = step.vertex_face_times.size() == step.vertex_faces.size() && step.earliest > 0;
    for (const double time : step.edge_edge_times) later = later && time >= step.earliest;
    check("at their times", later && step.edge_edge_times.size() == step.edge_edges.size());
    check("a step that is free", larger.step(positions(rest), positions(rest)).earliest == 1);
    check("a distance below 0", refused(SC_ERROR_OPTION, "options.distance is -1",
                                        [&] { larger.near(positions(rest), -1); }));
    check("a workspace without room for steps", refused(SC_ERROR_WORKSPACE, "workspace", [&] {
              workspace.step(positions(rest), positions(moved));
          }));

    test_scene(rest, moved, triangles);

    // Doubles are read as they are: as floats these two triangles do not meet.
    const double far[] = {500000.155, 5400000.362, 100.080, 500000.208, 5400000.167, 100.355,
                          500000.397, 5400000.115, 100.197, 500000.358, 5400000.218, 100.086,
                          500000.304, 5400000.135, 100.194, 500000.003, 5400000.396, 100.263};
    const std::uint32_t corners[] = {0, 1, 2, 3, 4, 5};
    const starcontour::Model wide({far, 6}, corners, 2);
    Workspace of_wide(wide);
    check("doubles", of_wide.query({far, 6}).size() == 1);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) return 2;
    test(argv[1], argv[2]);
    std::printf("c++17: %d passed, %d failed\n", passed, failed);
    return failed != 0;
}
