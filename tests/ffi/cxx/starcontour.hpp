// starcontour for C++17: handles that free themselves, positions read in place from the application's
// own vertices, exceptions that say which argument was refused and why. Nothing but this header and
// starcontour.h, which is the manual; what is not wrapped is called with get().
//
//     const starcontour::Model model({rest, vertex_count}, triangles, triangle_count);
//     starcontour::Workspace workspace(model);
//     for (const sc_pair &pair : workspace.query({pose, vertex_count})) ...
//
//     starcontour::Workspace larger(model, SC_WORKSPACE_NEAR);
//     larger.step({pose, vertex_count}, {next, vertex_count}).earliest
//     larger.near({pose, vertex_count}, 0.01).vertex_faces
//
// SPDX-License-Identifier: MIT
#ifndef STARCONTOUR_HPP
#define STARCONTOUR_HPP

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <starcontour.h>

namespace starcontour
{

// What the library refused: its text, and its number (SC_ERROR_...).
class Error : public std::runtime_error
{
  public:
    Error(sc_status code, const std::string &reason)
        : std::runtime_error(reason.empty() ? sc_status_string(code) : reason), status(code)
    {
    }
    sc_status status;
};

// A structure of the library: all zero but its size.
template <typename T> T sized()
{
    T structure{};
    structure.struct_size = sizeof(structure);
    return structure;
}

// Where positions lie: `count` times x, y, z, with `stride` bytes from each to the next, 0: packed.
// The array is the caller's and is read during calls, never copied.
struct Positions {
    Positions(const float *first, std::size_t number, std::size_t bytes = 0)
        : data(first), count(number), stride(bytes), type(SC_FLOAT)
    {
    }
    Positions(const double *first, std::size_t number, std::size_t bytes = 0)
        : data(first), count(number), stride(bytes), type(SC_DOUBLE)
    {
    }
    const void *data;
    std::size_t count, stride;
    std::uint32_t type;
};

// Inside: a number as the library takes it, and what it logs of an argument that it refuses.
namespace detail
{

inline std::uint32_t number(std::size_t value)
{
    if (value > std::numeric_limits<std::uint32_t>::max()) throw Error(SC_ERROR_COUNT, "");
    return static_cast<std::uint32_t>(value);
}

class Log
{
  public:
    Log() : hooks(sized<sc_hooks>())
    {
        hooks.log = hear;
        hooks.user = this;
    }
    Log(const Log &) = delete;
    Log &operator=(const Log &) = delete;

    void check(sc_status status)
    {
        const std::string reason = reason_;
        reason_.clear();
        if (status != SC_OK) throw Error(status, reason);
    }

    sc_hooks hooks;

  private:
    // Called from C, through which no exception may pass.
    static void hear(void *user, std::uint32_t level, const char *message) noexcept
    {
        if (level != SC_LOG_ERROR) return;
        try {
            static_cast<Log *>(user)->reason_ = message;
        } catch (...) {
        }
    }

    std::string reason_;
};

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

inline sc_pose pose_of(const Positions &positions)
{
    auto pose = sized<sc_pose>();
    pose.vertex_count = number(positions.count);
    pose.position_type = positions.type;
    pose.position_stride = number(positions.stride);
    pose.positions = positions.data;
    return pose;
}

} // namespace detail

// A mesh made ready for queries. It never changes: threads may share it, each with its own Workspace.
class Model
{
  public:
    // triangles: triangle_count times three vertex numbers; read during the call. options: NULL, or
    // as for sc_build.
    Model(const Positions &rest, const std::uint32_t *triangles, std::size_t triangle_count,
          const sc_build_options *options = nullptr)
    {
        auto mesh = sized<sc_mesh>();
        mesh.vertex_count = detail::number(rest.count);
        mesh.position_type = rest.type;
        mesh.position_stride = detail::number(rest.stride);
        mesh.positions = rest.data;
        mesh.triangle_count = detail::number(triangle_count);
        mesh.indices = triangles;
        auto with_log = options != nullptr ? *options : sized<sc_build_options>();
        detail::Log log;
        if (with_log.hooks == nullptr) with_log.hooks = &log.hooks;
        sc_model *model = nullptr;
        log.check(sc_build(&mesh, &with_log, &model));
        model_.reset(model);
    }

    const sc_model *get() const
    {
        return model_.get();
    }

  private:
    std::unique_ptr<sc_model, detail::Free> model_;
};

// Pairs of a vertex and a face, and of two edges; of steps when each collides, if wanted.
struct Features {
    std::vector<sc_pair> vertex_faces, edge_edges;
    std::vector<double> vertex_face_times, edge_edge_times;
    double earliest = 1; // of a step: nothing collides before
};

// What one query at a time writes to. The model must outlive it.
class Workspace
{
  public:
    // flags: SC_WORKSPACE_..., for steps and for what is near; workers: threads that a query may use.
    explicit Workspace(const Model &model, std::uint32_t flags = 0, std::uint32_t workers = 1)
        : model_(model.get()), log_(std::make_unique<detail::Log>())
    {
        auto options = sized<sc_workspace_options>();
        options.flags = flags;
        options.workers = workers;
        sc_workspace *workspace = nullptr;
        log_->check(sc_workspace_create_for(model_, &options, &workspace));
        workspace_.reset(workspace);
        log_->check(sc_workspace_set_hooks(workspace, &log_->hooks));
    }

    // All pairs in a pose, sorted; they stay until the next query. options: NULL, or as for sc_query,
    // with SC_OUTPUT_PAIRS.
    const std::vector<sc_pair> &query(const Positions &positions,
                                      const sc_query_options *options = nullptr)
    {
        const auto pose = detail::pose_of(positions);
        auto result = sized<sc_result>();
        if (pairs_.empty()) pairs_.resize(64);
        pairs_.resize(pairs_.capacity());
        for (;;) {
            result.capacity = pairs_.size();
            result.pairs = pairs_.data();
            const auto status = sc_query(model_, workspace_.get(), &pose, options, &result);
            if (status != SC_ERROR_SHORT_BUFFER) {
                log_->check(status);
                break;
            }
            pairs_.resize(static_cast<std::size_t>(result.count));
        }
        pairs_.resize(static_cast<std::size_t>(result.count));
        return pairs_;
    }

    // What collides on the way from one pose to another; it stays until the next step or query of what
    // is near. options: NULL, all pairs with their times; or as for sc_query_step.
    const Features &step(const Positions &start, const Positions &end,
                         const sc_step_options *options = nullptr)
    {
        auto all = sized<sc_step_options>();
        all.times = SC_STEP_TIMES_EACH;
        const auto &asked = options != nullptr ? *options : all;
        const auto from = detail::pose_of(start), to = detail::pose_of(end);
        auto result = sized<sc_step_result>();
        const bool timed = asked.times == SC_STEP_TIMES_EACH;
        find(result, asked.output, [&] {
            if (timed) {
                found_.vertex_face_times.resize(found_.vertex_faces.size());
                found_.edge_edge_times.resize(found_.edge_edges.size());
                result.vertex_face_times = found_.vertex_face_times.data();
                result.edge_edge_times = found_.edge_edge_times.data();
            }
            return sc_query_step(model_, workspace_.get(), &from, &to, &asked, &result);
        });
        found_.vertex_face_times.resize(timed ? found_.vertex_faces.size() : 0);
        found_.edge_edge_times.resize(timed ? found_.edge_edges.size() : 0);
        found_.earliest = result.earliest;
        return found_;
    }

    // What is within a distance in a pose. options: NULL, or as for sc_query_near, but for distance.
    const Features &near(const Positions &positions, double distance,
                         const sc_near_options *options = nullptr)
    {
        auto asked = options != nullptr ? *options : sized<sc_near_options>();
        asked.distance = distance;
        const auto pose = detail::pose_of(positions);
        auto result = sized<sc_near_result>();
        find(result, asked.output, [&] {
            return sc_query_near(model_, workspace_.get(), &pose, &asked, &result);
        });
        found_.vertex_face_times.clear();
        found_.edge_edge_times.clear();
        return found_;
    }

    sc_workspace *get() const
    {
        return workspace_.get();
    }

  private:
    // Asks until both arrays are long enough. Of a query that only counts they stay empty.
    template <typename Result, typename Ask>
    void find(Result &result, std::uint32_t output, const Ask &ask)
    {
        const bool listed = output == SC_OUTPUT_PAIRS;
        for (std::size_t faces = 64, edges = 64;;) {
            found_.vertex_faces.resize(faces);
            found_.edge_edges.resize(edges);
            result.vertex_faces = found_.vertex_faces.data();
            result.edge_edges = found_.edge_edges.data();
            result.vertex_face_capacity = faces;
            result.edge_edge_capacity = edges;
            const sc_status status = ask();
            if (status != SC_ERROR_SHORT_BUFFER) {
                log_->check(status);
                break;
            }
            faces = static_cast<std::size_t>(result.vertex_face_count);
            edges = static_cast<std::size_t>(result.edge_edge_count);
        }
        found_.vertex_faces.resize(listed ? static_cast<std::size_t>(result.vertex_face_count) : 0);
        found_.edge_edges.resize(listed ? static_cast<std::size_t>(result.edge_edge_count) : 0);
    }

    const sc_model *model_;
    std::unique_ptr<detail::Log> log_;
    std::unique_ptr<sc_workspace, detail::Free> workspace_;
    std::vector<sc_pair> pairs_;
    Features found_;
};

} // namespace starcontour

#endif // STARCONTOUR_HPP
