// starcontour for C++17: handles that free themselves, positions read in place from the
// application's own vertices, exceptions that say which argument was refused and why. Nothing but
// this header and starcontour.h, which is the manual; what is not wrapped is called with get().
//
//     const starcontour::Model model({rest, vertex_count}, triangles, triangle_count);
//     starcontour::Workspace workspace(model);
//     for (const sc_pair &pair : workspace.query({pose, vertex_count})) ...
//     for (const sc_trace_contour &contour : workspace.trace({pose, vertex_count}).contours) ...
//
//     starcontour::Workspace larger(model, SC_WORKSPACE_NEAR);
//     larger.step({pose, vertex_count}, {next, vertex_count}).earliest
//     larger.near({pose, vertex_count}, 0.01).vertex_faces
//
//     starcontour::Scene scene;
//     auto &cloth = scene.add(model, {pose, vertex_count}), &body = scene.add(...);
//     cloth.set_pose({pose, vertex_count});           again whenever it has moved
//     for (const sc_object_pairs &range : scene.query().ranges) ...
//
// SPDX-License-Identifier: MIT
#ifndef STARCONTOUR_HPP
#define STARCONTOUR_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
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
        const std::string reason = take();
        if (status != SC_OK) throw Error(status, reason);
    }

    // What was said since the last time.
    std::string take()
    {
        return std::exchange(reason_, {});
    }

    sc_hooks hooks;

  private:
    // Called from C, through which no exception may pass.
    static void hear(void *user, std::uint32_t level, const char *message) noexcept
    {
        if (level != SC_LOG_ERROR) return;
        try {
            auto &reason = static_cast<Log *>(user)->reason_;
            reason += reason.empty() ? "" : "; ";
            reason += message;
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

// A mesh made ready for queries. It never changes: threads may share it, each with its own
// Workspace.
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

// Contours of a pose; each names its first node and how many it has.
struct Contours {
    std::vector<sc_trace_node> nodes;
    std::vector<sc_trace_contour> contours;
};

// What one query at a time writes to. The model must outlive it.
class Workspace
{
  public:
    // flags: SC_WORKSPACE_..., for steps and for what is near; workers: threads that a query may
    // use. room: NULL, or a workspace for the same and SC_WORKSPACE_ROOM, whose room this one uses;
    // it outlives this one.
    explicit Workspace(const Model &model, std::uint32_t flags = 0, std::uint32_t workers = 1,
                       const Workspace *room = nullptr)
        : model_(model.get()), log_(std::make_unique<detail::Log>())
    {
        auto options = sized<sc_workspace_options>();
        options.flags = flags;
        options.workers = workers;
        options.room = room != nullptr ? room->get() : nullptr;
        sc_workspace *workspace = nullptr;
        log_->check(sc_workspace_create_for(model_, &options, &workspace));
        workspace_.reset(workspace);
        log_->check(sc_workspace_set_hooks(workspace, &log_->hooks));
    }

    // All pairs in a pose, sorted; they stay until the next query. options: NULL, or as for
    // sc_query, with SC_OUTPUT_PAIRS.
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

    // What collides on the way from one pose to another; it stays until the next step or query of
    // what is near. options: NULL, all pairs with their times; or as for sc_query_step.
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

    // What is within a distance in a pose. options: NULL, or as for sc_query_near, but for
    // distance.
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

    // Contours of the intersections in a pose; they stay until the next trace. Its pairs of edges
    // and triangles are found first, in place of those of the last query. options: NULL, or as for
    // sc_trace; its tasks are also those of the query.
    const Contours &trace(const Positions &positions, const sc_trace_options *options = nullptr)
    {
        auto asked = options != nullptr ? *options : sized<sc_trace_options>();
        if (asked.hooks == nullptr) asked.hooks = &log_->hooks;
        auto edges = sized<sc_query_options>();
        edges.pairs = SC_PAIRS_EDGE;
        edges.simd = asked.simd;
        edges.tasks = asked.tasks;
        edges.cancel = asked.cancel;
        query(positions, &edges);
        const auto pose = detail::pose_of(positions);
        auto result = sized<sc_trace_result>();
        auto nodes = std::max(std::size_t{64}, traced_.nodes.capacity());
        auto contours = std::max(std::size_t{8}, traced_.contours.capacity());
        for (;;) {
            traced_.nodes.resize(nodes);
            traced_.contours.resize(contours);
            result.nodes = traced_.nodes.data();
            result.node_capacity = nodes;
            result.contours = traced_.contours.data();
            result.contour_capacity = contours;
            const auto status =
                sc_trace(model_, &pose, pairs_.data(), pairs_.size(), &asked, &result);
            if (status != SC_ERROR_SHORT_BUFFER) {
                log_->check(status);
                break;
            }
            nodes = std::max(nodes, static_cast<std::size_t>(result.node_count));
            contours = std::max(contours, static_cast<std::size_t>(result.contour_count));
        }
        traced_.nodes.resize(static_cast<std::size_t>(result.node_count));
        traced_.contours.resize(static_cast<std::size_t>(result.contour_count));
        return traced_;
    }

    sc_workspace *get() const
    {
        return workspace_.get();
    }

  private:
    friend class Scene; // reads the log

    // Asks until both arrays are long enough; they begin as long as they ever were. Of a query that
    // only counts they stay empty.
    template <typename Result, typename Ask>
    void find(Result &result, std::uint32_t output, const Ask &ask)
    {
        const bool listed = output == SC_OUTPUT_PAIRS;
        auto faces = std::max(std::size_t{64}, found_.vertex_faces.capacity());
        auto edges = std::max(std::size_t{64}, found_.edge_edges.capacity());
        for (;;) {
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
    Contours traced_;
};

// What objects have with each other and with themselves: a range for each two, or one, that have
// pairs, in the order that sc_objects_result and sc_object_list promise.
struct Meetings {
    std::vector<sc_pair> pairs;
    std::vector<sc_object_pairs> ranges; // objects by their numbers, and which pairs they have
    std::vector<double> times;           // of a step, if wanted, when each pair collides
};

// Meetings of a vertex and a face, and of two edges.
struct FeatureMeetings {
    Meetings vertex_faces, edge_edges;
    double earliest = 1; // of a step: nothing collides before
};

// Several objects: cloth and a body, characters that share a model, a level. One call at a time.
// What did not move since the last call of the same kind is not read again.
class Scene
{
  public:
    class Object
    {
      public:
        // By Scene::add.
        Object(const Model &model, const Positions &positions, std::uint32_t flags,
               std::uint32_t workers, const Workspace *room, std::uint32_t its_number)
            : number(its_number), model_(model.get()), workspace_(model, flags, workers, room)
        {
            options.itself = 1;
            set_pose(positions);
        }

        // Where it is, of a step at its start. The array is read in place, and stays as it is until
        // the next set_pose: that is how the scene knows what has moved.
        void set_pose(const Positions &positions)
        {
            pose_ = detail::pose_of(positions);
            ++version_;
        }

        // Of a step where it is at its end, likewise; without, or after stay(), where it began.
        void set_end(const Positions &positions)
        {
            end_ = detail::pose_of(positions);
            moves_ = true;
            ++version_;
        }
        void stay()
        {
            moves_ = false;
            ++version_;
        }

        const std::uint32_t number; // in ranges: that of the first object is 0
        // group, itself (at first 1), filters, rest, rest_distance and masks, as for sc_object:
        // each query takes those that it has use for. The other members are the scene's.
        sc_object options{};

      private:
        friend class Scene;
        const sc_model *model_;
        Workspace workspace_;
        sc_pose pose_{}, end_{};
        bool moves_ = false;
        std::uint64_t version_ = 0;
    };

    // flags and workers: of each object's workspace, see there.
    explicit Scene(std::uint32_t flags = 0, std::uint32_t workers = 1)
        : flags_(flags), workers_(workers)
    {
    }

    // A new object, which lives as long as the scene. The model must outlive both. Objects of one
    // model are small: all but the first use one room.
    Object &add(const Model &model, const Positions &positions)
    {
        const auto is_copy = std::any_of(objects_.begin(), objects_.end(), [&](const Object &one) {
            return one.model_ == model.get();
        });
        const Workspace *room = nullptr;
        if (is_copy)
            room = &rooms_.try_emplace(model.get(), model, flags_ | SC_WORKSPACE_ROOM, workers_)
                        .first->second;
        return objects_.emplace_back(model, positions, flags_, workers_, room,
                                     detail::number(objects_.size()));
    }

    std::size_t size() const
    {
        return objects_.size();
    }
    Object &operator[](std::size_t number)
    {
        return objects_[number];
    }

    // What intersects; it stays until the next query. asked: NULL, or as for sc_query_objects.
    const Meetings &query(const sc_query_options *asked = nullptr)
    {
        auto result = sized<sc_objects_result>();
        const auto objects = fill([](sc_object &one) {
            one.end = one.rest = nullptr;
            one.vertex_face_filter = one.edge_edge_filter = nullptr;
            one.masks = nullptr;
        });
        do give(result, pairs_);
        while (again(sc_query_objects(&objects, asked, &result)));
        trim(result, pairs_, asked == nullptr || asked->output == SC_OUTPUT_PAIRS);
        return pairs_;
    }

    // What is within a distance; it stays until the next step or query of what is near. wanted:
    // NULL, or as for sc_query_objects_near, but for distance.
    const FeatureMeetings &near(double distance, const sc_near_options *wanted = nullptr)
    {
        auto asked = wanted != nullptr ? *wanted : sized<sc_near_options>();
        asked.distance = distance;
        const auto objects = fill([](sc_object &one) {
            one.end = nullptr;
            one.filter = nullptr;
        });
        return find(asked.output, false, [&](sc_objects_lists &lists) {
            return sc_query_objects_near(&objects, &asked, &lists);
        });
    }

    // What collides while objects move from their pose to their end; it stays as long. wanted:
    // NULL, all pairs with their times; or as for sc_query_objects_step.
    const FeatureMeetings &step(const sc_step_options *wanted = nullptr)
    {
        auto all = sized<sc_step_options>();
        all.times = SC_STEP_TIMES_EACH;
        const auto &asked = wanted != nullptr ? *wanted : all;
        const auto objects = fill([](sc_object &one) {
            one.filter = nullptr;
            one.masks = nullptr;
        });
        return find(asked.output, asked.times == SC_STEP_TIMES_EACH, [&](sc_objects_lists &lists) {
            return sc_query_objects_step(&objects, &asked, &lists);
        });
    }

    // accept, accept_near and accept_user, as for sc_objects; the other members are the scene's.
    sc_objects options = sized<sc_objects>();

  private:
    // The objects as the library takes them; leave_out takes away what a query has no use for.
    template <typename LeaveOut> sc_objects fill(const LeaveOut &leave_out)
    {
        list_.clear();
        for (const Object &object : objects_) {
            auto one = object.options;
            one.model = object.model_;
            one.workspace = object.workspace_.get();
            one.pose = &object.pose_;
            one.end = object.moves_ ? &object.end_ : nullptr;
            one.pose_version = object.version_;
            leave_out(one);
            list_.push_back(one);
        }
        auto objects = options;
        objects.count = detail::number(list_.size());
        objects.objects = list_.data();
        objects.stride = sizeof(sc_object);
        return objects;
    }

    // Gives a list, or the result of query, arrays of the length that it said it needs, or more.
    template <typename List> static void give(List &list, Meetings &found)
    {
        const auto count = static_cast<std::size_t>(list.count);
        const auto range_count = static_cast<std::size_t>(list.range_count);
        found.pairs.resize(std::max({std::size_t{64}, found.pairs.capacity(), count}));
        found.ranges.resize(std::max({std::size_t{16}, found.ranges.capacity(), range_count}));
        list.capacity = found.pairs.size();
        list.pairs = found.pairs.data();
        list.range_capacity = found.ranges.size();
        list.ranges = found.ranges.data();
    }

    // Of a query that only counts there are ranges without pairs.
    template <typename List> static void trim(const List &list, Meetings &found, bool listed)
    {
        found.pairs.resize(listed ? static_cast<std::size_t>(list.count) : 0);
        found.ranges.resize(static_cast<std::size_t>(list.range_count));
    }

    bool again(sc_status status)
    {
        std::string reasons;
        for (const Object &object : objects_) {
            const auto reason = object.workspace_.log_->take();
            reasons += reasons.empty() || reason.empty() ? reason : "; " + reason;
        }
        if (status != SC_OK && status != SC_ERROR_SHORT_BUFFER) throw Error(status, reasons);
        return status == SC_ERROR_SHORT_BUFFER;
    }

    template <typename Ask>
    const FeatureMeetings &find(std::uint32_t output, bool timed, const Ask &ask)
    {
        auto lists = sized<sc_objects_lists>();
        const std::pair<sc_object_list &, Meetings &> both[] = {
            {lists.vertex_faces, found_.vertex_faces}, {lists.edge_edges, found_.edge_edges}};
        do {
            for (const auto &[list, found] : both) {
                give(list, found);
                found.times.resize(timed ? found.pairs.size() : 0);
                list.times = timed ? found.times.data() : nullptr;
            }
        } while (again(ask(lists)));
        for (const auto &[list, found] : both) {
            trim(list, found, output == SC_OUTPUT_PAIRS);
            found.times.resize(timed ? found.pairs.size() : 0);
        }
        found_.earliest = lists.earliest;
        return found_;
    }

    std::uint32_t flags_, workers_;
    std::map<const sc_model *, Workspace> rooms_;
    std::deque<Object> objects_;
    std::vector<sc_object> list_;
    Meetings pairs_;
    FeatureMeetings found_;
};

} // namespace starcontour

#endif // STARCONTOUR_HPP
