// starcontour for C++17: handles that free themselves, positions read in place from the application's
// own vertices, exceptions that say which argument was refused and why. Nothing but this header and
// starcontour.h, which is the manual; what is not wrapped is called with get().
//
//     const starcontour::Model model({rest, vertex_count}, triangles, triangle_count);
//     starcontour::Workspace workspace(model);
//     for (const sc_pair &pair : workspace.query({pose, vertex_count})) ...
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

// What one query at a time writes to. The model must outlive it.
class Workspace
{
  public:
    explicit Workspace(const Model &model)
        : model_(model.get()), log_(std::make_unique<detail::Log>())
    {
        sc_workspace *workspace = nullptr;
        log_->check(sc_workspace_create(model_, nullptr, &workspace));
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

    sc_workspace *get() const
    {
        return workspace_.get();
    }

  private:
    const sc_model *model_;
    std::unique_ptr<detail::Log> log_;
    std::unique_ptr<sc_workspace, detail::Free> workspace_;
    std::vector<sc_pair> pairs_;
};

} // namespace starcontour

#endif // STARCONTOUR_HPP
