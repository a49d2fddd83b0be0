// C++17: owning handles, spans of the application's own vertex type, exceptions, two threads.
//
//     ffi_cxx MESH GOLDEN
//
// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <starcontour.h>

namespace
{

// What the library refused.
class Error : public std::runtime_error
{
  public:
    explicit Error(sc_status code) : std::runtime_error(sc_status_string(code)), status(code)
    {
    }
    sc_status status;
};

void check_status(sc_status status)
{
    if (status != SC_OK) throw Error(status);
}

// A structure of the library: all zero but its size.
template <typename T> T sized()
{
    T structure{};
    structure.struct_size = sizeof(structure);
    return structure;
}

struct Free {
    void operator()(sc_model *model) const
    {
        sc_model_free(model);
    }
    void operator()(sc_workspace *workspace) const
    {
        sc_workspace_free(workspace);
    }
};

using Workspace = std::unique_ptr<sc_workspace, Free>;

// A vertex as the application stores it. Only position is read, in steps of sizeof(Vertex).
struct Vertex {
    std::array<float, 3> position;
    std::array<float, 3> normal;
    std::array<float, 2> uv;
};

using Triangle = std::array<std::uint32_t, 3>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// A model in its owner. Const calls may come from several threads, each with its own Workspace.
class Model
{
  public:
    Model(const std::vector<Vertex> &vertices, const std::vector<Triangle> &triangles)
    {
        auto mesh = sized<sc_mesh>();
        mesh.vertex_count = static_cast<std::uint32_t>(vertices.size());
        mesh.triangle_count = static_cast<std::uint32_t>(triangles.size());
        mesh.position_stride = sizeof(Vertex);
        mesh.positions = vertices.empty() ? nullptr : &vertices[0].position;
        mesh.indices = triangles.data();
        sc_model *model;
        check_status(sc_build(&mesh, nullptr, &model));
        model_.reset(model);
    }

    Workspace workspace() const
    {
        sc_workspace *workspace;
        check_status(sc_workspace_create(model_.get(), nullptr, &workspace));
        return Workspace(workspace);
    }

    Pairs query(const Workspace &workspace, const std::vector<Vertex> &vertices) const
    {
        auto pose = sized<sc_pose>();
        pose.vertex_count = static_cast<std::uint32_t>(vertices.size());
        pose.position_stride = sizeof(Vertex);
        pose.positions = vertices.empty() ? nullptr : &vertices[0].position;
        std::vector<sc_pair> found(16);
        auto result = sized<sc_result>();
        for (;;) {
            result.capacity = found.size();
            result.pairs = found.data();
            const auto status = sc_query(model_.get(), workspace.get(), &pose, nullptr, &result);
            if (status == SC_OK) break;
            if (status != SC_ERROR_SHORT_BUFFER) throw Error(status);
            found.resize(result.count);
        }
        Pairs pairs;
        for (std::uint64_t i = 0; i < result.count; ++i) pairs.emplace_back(found[i].a, found[i].b);
        return pairs;
    }

  private:
    std::unique_ptr<sc_model, Free> model_;
};

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

    Pairs golden_rest, golden_moved;
    for (std::ifstream file(golden_path); std::getline(file, line);) {
        std::istringstream words(line);
        std::string pose;
        std::uint32_t a, b;
        if (words >> pose >> a >> b)
            (pose == "rest" ? golden_rest : golden_moved).emplace_back(a, b);
    }
    check("there is something to compare", !golden_rest.empty() && golden_rest != golden_moved);

    const Model model(rest, triangles);
    auto workspace = model.workspace();
    check("pairs at rest", model.query(workspace, rest) == golden_rest);
    check("pairs when moved", model.query(workspace, moved) == golden_moved);

    bool fine[2] = {true, true};
    const auto work = [&](bool &right, const std::vector<Vertex> &pose, const Pairs &golden) {
        const auto own = model.workspace();
        for (int i = 0; i < 200; ++i) right = right && model.query(own, pose) == golden;
    };
    std::thread one(work, std::ref(fine[0]), std::cref(rest), std::cref(golden_rest));
    std::thread two(work, std::ref(fine[1]), std::cref(moved), std::cref(golden_moved));
    one.join();
    two.join();
    check("two threads, one model", fine[0] && fine[1]);

    auto spoilt = moved;
    spoilt[3].position[1] = NAN;
    check("NaN", refused(SC_ERROR_NOT_FINITE, "NaN", [&] { model.query(workspace, spoilt); }));
    spoilt.pop_back();
    check("number of vertices",
          refused(SC_ERROR_VERTEX_COUNT, "vert", [&] { model.query(workspace, spoilt); }));
    check("no triangles", refused(SC_ERROR_EMPTY, "triangle", [&] { Model(rest, {}); }));
    check("usable after errors", model.query(workspace, rest) == golden_rest);

    auto other = Model(rest, triangles);
    auto moved_away = std::move(other);
    check("moved model", moved_away.query(moved_away.workspace(), rest) == golden_rest);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) return 2;
    test(argv[1], argv[2]);
    std::printf("c++17: %d passed, %d failed\n", passed, failed);
    return failed != 0;
}
