/*
 * Times a peer beside starcontour on several objects, in one process, on the same frames, and
 * compares their pairs.
 *
 * A folder of objects has objects.txt, with a line "FOLDER ITSELF" for each: a scene folder in it
 * with the object's mesh and poses, one if it does not move, and whether it is asked about itself,
 * 1 or 0. sc-objects --export writes such folders.
 *
 * starcontour ("objects") is asked by sc_query_objects, in as many threads as the peer. Objects
 * with the same triangles share a model; the version of what does not move stays. Models,
 * workspaces and threads are made before.
 *
 * SPDX-License-Identifier: MIT
 */
#include "driver.h"

#include <starcontour.h>

extern "C" {
#include "thread_pool.h"
}

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace peers
{
namespace
{

std::string list_of(const std::string &folder)
{
    return folder + "/objects.txt";
}

object_scene read_objects(const std::string &folder)
{
    object_scene all;
    all.name = last_part(folder);
    all.frames = 1;
    std::ifstream file(list_of(folder));
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string name, more;
        int itself = -1;
        if (!(words >> name >> itself) || words >> more || itself < 0 || itself > 1)
            throw std::runtime_error(list_of(folder) + ": '" + line + "' is not FOLDER ITSELF");
        object o;
        o.mesh = read_scene(folder + "/" + name);
        o.itself = itself == 1;
        o.first = uint32_t(all.triangles);
        all.triangles += o.mesh.triangles;
        if (all.triangles > 0xffffffff) throw std::runtime_error(folder + ": too many triangles");
        if (o.moves() && all.frames > 1 && o.mesh.frames != all.frames)
            throw std::runtime_error(folder + ": what moves does not have equally many frames");
        all.frames = std::max(all.frames, o.mesh.frames);
        all.objects.push_back(std::move(o));
    }
    if (all.objects.empty()) throw std::runtime_error(list_of(folder) + ": no objects");
    return all;
}

class our_objects
{
    const object_scene &all;
    std::vector<sc_model *> models; /* each once */
    std::vector<sc_object> objects;
    std::vector<sc_pose> poses;
    thread_pool *pool = nullptr;
    std::vector<sc_pair> pairs;
    std::vector<sc_object_pairs> ranges;
    uint64_t version = 1, range_count = 0;

    static void must(sc_status status)
    {
        if (status != SC_OK)
            throw std::runtime_error(std::string("starcontour: ") + sc_status_string(status));
    }

    const sc_model *model_of(size_t i)
    {
        const scene &mesh = all.objects[i].mesh;
        for (size_t j = 0; j < i; ++j)
            if (all.objects[j].mesh.corners == mesh.corners) return objects[j].model;
        sc_mesh input = sc_mesh();
        input.struct_size = sizeof(input);
        input.vertex_count = uint32_t(mesh.vertices);
        input.triangle_count = uint32_t(mesh.triangles);
        input.position_type = SC_DOUBLE;
        input.positions = mesh.frame(0);
        input.indices = mesh.corners.data();
        sc_build_options options = sc_build_options();
        options.struct_size = sizeof(options);
        options.weld = SC_WELD_NONE;
        sc_model *built = nullptr;
        must(sc_build(&input, &options, &built));
        models.push_back(built);
        return built;
    }

  public:
    our_objects(const object_scene &scene, unsigned threads)
        : all(scene), objects(scene.objects.size()), poses(scene.objects.size()), pairs(1024),
          ranges(scene.objects.size())
    {
        if (threads > 1 && !(pool = thread_pool_create(threads)))
            throw std::runtime_error("no threads");
        sc_workspace_options options = sc_workspace_options();
        options.struct_size = sizeof(options);
        options.workers = threads;
        for (size_t i = 0; i < objects.size(); ++i) {
            objects[i].model = model_of(i);
            objects[i].itself = all.objects[i].itself;
            must(sc_workspace_create_for(objects[i].model, &options, &objects[i].workspace));
            poses[i].struct_size = sizeof(sc_pose);
            poses[i].vertex_count = uint32_t(all.objects[i].mesh.vertices);
            poses[i].position_type = SC_DOUBLE;
            objects[i].pose = &poses[i];
        }
    }
    ~our_objects()
    {
        for (const sc_object &o : objects) sc_workspace_free(o.workspace);
        for (sc_model *model : models) sc_model_free(model);
        thread_pool_free(pool);
    }
    our_objects(const our_objects &) = delete;
    our_objects &operator=(const our_objects &) = delete;

    void query(size_t frame)
    {
        ++version;
        for (size_t i = 0; i < objects.size(); ++i) {
            poses[i].positions = all.objects[i].frame(frame);
            objects[i].pose_version = all.objects[i].moves() ? version : 1;
        }
        sc_objects asked = sc_objects();
        asked.struct_size = sizeof(asked);
        asked.count = uint32_t(objects.size());
        asked.objects = objects.data();
        sc_query_options options = sc_query_options();
        options.struct_size = sizeof(options);
        options.tasks = thread_pool_tasks(pool);
        for (;;) {
            sc_objects_result result = sc_objects_result();
            result.struct_size = sizeof(result);
            result.pairs = pairs.data();
            result.capacity = pairs.size();
            result.ranges = ranges.data();
            result.range_capacity = ranges.size();
            const sc_status status = sc_query_objects(&asked, &options, &result);
            range_count = result.range_count;
            if (status != SC_ERROR_SHORT_BUFFER) return must(status);
            /* In the walk that is not timed: the same poses come again. */
            pairs.resize(std::max(pairs.size(), size_t(result.count)));
            ranges.resize(std::max(ranges.size(), size_t(result.range_count)));
        }
    }

    /* The latest pairs, or those of them that a peer should find. */
    pair_list select(kind which) const
    {
        pair_list list;
        for (uint64_t r = 0; r < range_count; ++r) {
            const sc_object_pairs &range = ranges[r];
            const object &a = all.objects[range.object_a], &b = all.objects[range.object_b];
            for (uint64_t i = range.first; i < range.first + range.count; ++i) {
                if (which == kind::all || &a != &b || !a.mesh.adjacent(pairs[i].a, pairs[i].b))
                    list.push_back(pair(a.first + pairs[i].a, b.first + pairs[i].b));
            }
        }
        std::sort(list.begin(), list.end());
        return list;
    }
};

} // namespace

bool is_of_objects(const std::string &folder)
{
    return std::ifstream(list_of(folder)).good();
}

bool run_objects(const std::string &folder, const settings &s, std::FILE *out)
{
    const object_scene all = read_objects(folder);
    const auto list = make_objects_peers();
    our_objects ours(all, s.threads);
    subject asked;
    asked.name = all.name;
    asked.triangles = all.triangles;
    asked.frames = std::min(s.frames, all.frames);
    asked.reference = [&ours](size_t f, pair_list &every, pair_list &apart) {
        ours.query(f);
        every = ours.select(kind::all);
        apart = ours.select(kind::apart);
    };
    std::vector<contender> contenders;
    for (const auto &p : list) {
        contender c;
        c.query = [other = p.get()](size_t f, pair_list &found) { other->query(f, found); };
        c.finds = kind::apart;
        c.name = p->name();
        c.version = p->version();
        c.what = p->what();
        c.threads = s.threads;
        c.frames = asked.frames;
        if (s.threads > 1 && !p->threaded()) {
            std::printf("skipped: %s on %s: it uses one thread only\n", c.name.c_str(),
                        all.name.c_str());
            continue;
        }
        try {
            p->build(all, s.threads);
        } catch (const std::runtime_error &error) {
            say_skipped(c.name, all.name, error.what(), s, out);
            continue;
        }
        contenders.push_back(c);
    }
    if (list.empty()) say_skipped(make_peers()[0]->name(), all.name, "it takes one mesh", s, out);
    if (contenders.empty()) return true;
    contender c;
    c.query = [&ours](size_t f, pair_list &) { ours.query(f); };
    c.listed = [&ours] { return ours.select(kind::all); };
    c.name = "starcontour";
    c.version = sc_version_string();
    c.what = "objects";
    c.threads = s.threads;
    c.frames = asked.frames;
    contenders.push_back(c);
    return measure(asked, contenders, list[0]->name(), s, out);
}

} // namespace peers
