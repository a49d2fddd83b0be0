/*
 * Times a peer beside starcontour, in one process, on the same frames, and compares their pairs.
 *
 *     PEER [--threads 1|all|N] [--repeats N] [--frames N] [--csv FILE] SCENE...
 *
 * A SCENE is a folder: meta.txt ("triangles vertices frames"), tris.u32 (3 little-endian uint32 a
 * triangle), frames.f64 or frames.f32 (frames x vertices x 3, little-endian). One with objects.txt
 * has several objects: see objects_driver.cpp.
 *
 * All ways of the peer and three of starcontour (exact contours, the default; star contours; boxes)
 * take turns frame by frame, one query each, as a simulation would ask: no query meets warm caches.
 * The sequence is walked once untimed, in which pairs are compared, and then N times. Everything
 * that a new pose costs is in the time: reading positions, refitting or rebuilding, finding and
 * storing pairs. Building on the first frame is not, but for the way "one shot" of starcontour,
 * which has a turn in the first frame only: a model for boxes alone, workspace, one query and
 * freeing it all.
 *
 * starcontour gets the same doubles, runs in one thread, and takes vertices as they are numbered
 * (SC_WELD_NONE), as peers do.
 *
 * Writes lines scene, triangles, frame, peer, version, what, threads, ms, pairs, matches, ms_min,
 * missing, extra, beside, processors: comma-separated, appended to FILE or printed. README.md says
 * what the columns are. A mesh that a peer cannot take is a line "# skipped: PEER on SCENE: REASON"
 * in FILE.
 *
 * Exit status: 0 if pairs match, 1 if some do not, 2 if a scene cannot be read or an option is
 * wrong.
 *
 * SPDX-License-Identifier: MIT
 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#  define _GNU_SOURCE
#endif

#include "driver.h"

#include <starcontour.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#ifdef __linux__
#  include <sched.h>
#endif

namespace
{

using namespace peers;

/* starcontour's ways, asked for by name so that they stay what they are called. The first is the
   default. */
const struct {
    const char *name;
    uint32_t method, contour;
    bool one_shot; /* from nothing, in the first frame only, by a model for boxes alone */
} own_ways[] = {{"exact", SC_METHOD_SCTT, SC_CONTOUR_EXACT, false},
                {"star", SC_METHOD_SCTT, SC_CONTOUR_STAR, false},
                {"aabb", SC_METHOD_AABB, SC_CONTOUR_DEFAULT, false},
                {"one shot", SC_METHOD_AABB, SC_CONTOUR_DEFAULT, true}};
const size_t own_way_count = sizeof(own_ways) / sizeof(*own_ways);

/* ------------------------------------------------------------------------------------------------
 * Scenes
 */

template <typename number> std::vector<number> read_numbers(const std::string &path, size_t count)
{
    std::vector<number> numbers(count);
    std::FILE *file = std::fopen(path.c_str(), "rb");
    if (!file) throw std::runtime_error(path + ": cannot be opened");
    const size_t got = std::fread(numbers.data(), sizeof(number), count, file);
    const bool more = std::fgetc(file) != EOF;
    std::fclose(file);
    if (got != count || more) throw std::runtime_error(path + ": not as long as meta.txt says");
    return numbers;
}

} // namespace

namespace peers
{

std::string last_part(std::string folder)
{
    while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
    return folder.substr(folder.rfind('/') + 1); /* npos + 1 is 0 */
}

scene read_scene(std::string folder)
{
    const int32_t one = 1;
    char first;
    std::memcpy(&first, &one, 1);
    if (first != 1) throw std::runtime_error("this machine is not little-endian");

    while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
    scene s;
    s.name = last_part(folder);
    std::FILE *file = std::fopen((folder + "/meta.txt").c_str(), "r");
    if (!file) throw std::runtime_error(folder + "/meta.txt: cannot be opened");
    unsigned long triangles = 0, vertices = 0, frames = 0;
    const int fields = std::fscanf(file, "%lu %lu %lu", &triangles, &vertices, &frames);
    std::fclose(file);
    if (fields != 3 || triangles == 0 || vertices == 0 || frames == 0 || triangles > 0x55555554 ||
        vertices > 0xffffffff || frames > 1000000) {
        throw std::runtime_error(folder + "/meta.txt: not three usable numbers");
    }
    s.triangles = triangles;
    s.vertices = vertices;
    s.frames = frames;
    s.corners = read_numbers<uint32_t>(folder + "/tris.u32", 3 * s.triangles);
    for (const uint32_t v : s.corners) {
        if (v >= s.vertices) throw std::runtime_error(folder + "/tris.u32: no such vertex");
    }
    const size_t count = 3 * s.vertices * s.frames;
    file = std::fopen((folder + "/frames.f64").c_str(), "rb");
    if (file) {
        std::fclose(file);
        s.positions = read_numbers<double>(folder + "/frames.f64", count);
    } else {
        const std::vector<float> floats = read_numbers<float>(folder + "/frames.f32", count);
        s.positions.assign(floats.begin(), floats.end());
    }
    for (const double x : s.positions) {
        if (!std::isfinite(x)) throw std::runtime_error(folder + ": a position is not finite");
    }
    return s;
}

} // namespace peers

namespace
{

/* ------------------------------------------------------------------------------------------------
 * starcontour
 */

/* A model of a scene, with a workspace of its own for each way. */
class starcontour
{
    const scene &mesh;
    sc_model *model = nullptr;
    sc_workspace *workspaces[own_way_count] = {};

    static void must(sc_status status)
    {
        if (status != SC_OK)
            throw std::runtime_error(std::string("starcontour: ") + sc_status_string(status));
    }

  public:
    std::vector<sc_pair> pairs; /* of the latest query, count of them */
    uint64_t count = 0;

    /* content: SC_MODEL_... */
    starcontour(const scene &animation, uint32_t content) : mesh(animation), pairs(1024)
    {
        model = build(content);
    }

  private:
    sc_model *build(uint32_t content) const
    {
        sc_model *built = nullptr;
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
        options.content = content;
        must(sc_build(&input, &options, &built));
        return built;
    }

  public:
    ~starcontour()
    {
        for (sc_workspace *workspace : workspaces) sc_workspace_free(workspace);
        sc_model_free(model);
    }
    starcontour(const starcontour &) = delete;
    starcontour &operator=(const starcontour &) = delete;

    void query(size_t way, const double *positions)
    {
        if (own_ways[way].one_shot) {
            starcontour other(mesh, SC_MODEL_BOXES);
            other.pairs.swap(pairs);
            other.ask(way, positions);
            other.pairs.swap(pairs);
            count = other.count;
        } else {
            ask(way, positions);
        }
    }

  private:
    void ask(size_t way, const double *positions)
    {
        if (!workspaces[way]) must(sc_workspace_create(model, nullptr, &workspaces[way]));
        sc_pose pose = sc_pose();
        pose.struct_size = sizeof(pose);
        pose.vertex_count = uint32_t(mesh.vertices);
        pose.position_type = SC_DOUBLE;
        pose.positions = positions;
        sc_query_options options = sc_query_options();
        options.struct_size = sizeof(options);
        options.method = own_ways[way].method;
        options.contour = own_ways[way].contour;
        for (;;) {
            sc_result result = sc_result();
            result.struct_size = sizeof(result);
            result.pairs = pairs.data();
            result.capacity = pairs.size();
            const sc_status status = sc_query(model, workspaces[way], &pose, &options, &result);
            count = result.count;
            if (status != SC_ERROR_SHORT_BUFFER) return must(status);
            pairs.resize(size_t(count)); /* in the untimed walk: the same poses come again */
        }
    }

  public:
    /* The latest pairs, or those of them that a peer should find. */
    pair_list select(kind which) const
    {
        pair_list list;
        for (size_t i = 0; i < count; ++i) {
            if (which == kind::all || !mesh.adjacent(pairs[i].a, pairs[i].b))
                list.push_back(pair(pairs[i].a, pairs[i].b));
        }
        return list;
    }
};

/* ------------------------------------------------------------------------------------------------
 * Turns
 */

double milliseconds()
{
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

/* How many members of sorted list a are not in b. */
size_t count_lacking(const pair_list &a, const pair_list &b)
{
    pair_list rest;
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
    return rest.size();
}

/* Walks the animation once; compares pairs if first, else records times. */
void walk(const subject &asked, std::vector<contender> &contenders, size_t frames, bool first)
{
    pair_list found, all, apart;
    for (size_t f = 0; f < frames; ++f) {
        if (first) asked.reference(f, all, apart);
        for (contender &c : contenders) {
            if (f >= c.frames) continue;
            found.clear();
            const double start = milliseconds();
            c.query(f, found);
            const double time = milliseconds() - start;
            if (!first) {
                c.times[f].push_back(time);
                continue;
            }
            if (c.listed) found = c.listed();
            std::sort(found.begin(), found.end());
            c.pairs.push_back(found.size());
            const pair_list &wanted = c.finds == kind::all ? all : apart;
            c.missing.push_back(count_lacking(wanted, found));
            c.extra.push_back(count_lacking(found, wanted));
        }
    }
}

std::vector<contender> line_up(const std::vector<std::unique_ptr<peer>> &list, const scene &mesh,
                               starcontour &ours, const settings &s, size_t frames, std::FILE *out)
{
    std::vector<contender> contenders;
    for (const auto &p : list) {
        contender c;
        c.query = [&mesh, other = p.get()](size_t f, pair_list &found) {
            other->query(mesh.frame(f), found);
        };
        c.finds = p->finds();
        c.name = p->name();
        c.version = p->version();
        c.what = p->what();
        c.threads = s.threads;
        c.frames = frames;
        if (s.threads > 1 && !p->threaded()) {
            std::printf("skipped: %s on %s: it uses one thread only\n", c.name.c_str(),
                        mesh.name.c_str());
            continue;
        }
        try {
            p->build(mesh, s.threads);
        } catch (const std::runtime_error &error) {
            say_skipped(c.name, mesh.name, error.what(), s, out);
            continue;
        }
        contenders.push_back(c);
    }
    if (contenders.empty()) return contenders;
    for (size_t way = 0; way < own_way_count; ++way) {
        contender c;
        c.query = [&mesh, &ours, way](size_t f, pair_list &) { ours.query(way, mesh.frame(f)); };
        c.listed = [&ours] { return ours.select(kind::all); };
        c.name = "starcontour";
        c.version = sc_version_string();
        c.what = own_ways[way].name;
        c.frames = own_ways[way].one_shot ? 1 : frames;
        contenders.push_back(c);
    }
    return contenders;
}

/* Returns whether all pairs matched. */
bool run(const scene &mesh, const std::vector<std::unique_ptr<peer>> &list, const settings &s,
         std::FILE *out)
{
    starcontour ours(mesh, SC_MODEL_FULL);
    subject asked;
    asked.name = mesh.name;
    asked.triangles = mesh.triangles;
    asked.frames = std::min(s.frames, mesh.frames);
    asked.reference = [&mesh, &ours](size_t f, pair_list &all, pair_list &apart) {
        ours.query(0, mesh.frame(f));
        all = ours.select(kind::all);
        apart = ours.select(kind::apart);
    };
    std::vector<contender> contenders = line_up(list, mesh, ours, s, asked.frames, out);
    return contenders.empty() || measure(asked, contenders, list[0]->name(), s, out);
}

} // namespace

namespace peers
{

void say_skipped(const std::string &name, const std::string &scene, const std::string &reason,
                 const settings &s, std::FILE *out)
{
    std::printf("skipped: %s on %s: %s\n", name.c_str(), scene.c_str(), reason.c_str());
    if (s.csv)
        std::fprintf(out, "# skipped: %s on %s: %s\n", name.c_str(), scene.c_str(), reason.c_str());
}

bool measure(const subject &asked, std::vector<contender> &contenders, const std::string &beside,
             const settings &s, std::FILE *out)
{
    for (contender &c : contenders) c.times.resize(c.frames);
    for (size_t repeat = 0; repeat <= s.repeats; ++repeat)
        walk(asked, contenders, asked.frames, repeat == 0);

    bool same = true;
    for (contender &c : contenders) {
        double sum = 0.0;
        size_t different = 0;
        for (size_t f = 0; f < c.frames; ++f) {
            std::vector<double> &t = c.times[f];
            std::sort(t.begin(), t.end());
            const double median = 0.5 * (t[(t.size() - 1) / 2] + t[t.size() / 2]);
            sum += median;
            const bool matches = c.missing[f] == 0 && c.extra[f] == 0;
            different += !matches;
            std::fprintf(out, "%s,%zu,%zu,%s,%s,%s,%u,%.4f,%zu,%s,%.4f,%zu,%zu,%s,%u\n",
                         asked.name.c_str(), asked.triangles, f, c.name.c_str(), c.version.c_str(),
                         c.what.c_str(), c.threads, median, c.pairs[f], matches ? "yes" : "no",
                         t[0], c.missing[f], c.extra[f], beside.c_str(), s.threads);
        }
        std::fflush(out);
        if (s.csv)
            std::printf("%-14s %-12s %u thread%s %9.3f ms a frame  %s\n", asked.name.c_str(),
                        c.name.c_str(), c.threads, c.threads == 1 ? " " : "s",
                        sum / double(c.frames), c.what.c_str());
        if (different > 0) {
            same = false;
            std::printf("different pairs in %zu of %zu frames: %s on %s\n", different, c.frames,
                        c.name.c_str(), asked.name.c_str());
        }
    }
    return same;
}

} // namespace peers

namespace
{

/* ------------------------------------------------------------------------------------------------
 * Command line
 */

/* Number of processors this process may use. */
unsigned processors()
{
#ifdef __linux__
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof(set), &set) == 0) return unsigned(CPU_COUNT(&set));
#endif
    return std::max(1u, std::thread::hardware_concurrency());
}

/* Keeps the process on its first processors, so that no library takes more than it should. */
void keep_to(unsigned threads)
{
#ifdef __linux__
    cpu_set_t set, kept;
    if (sched_getaffinity(0, sizeof(set), &set) != 0) return;
    CPU_ZERO(&kept);
    for (int i = 0; i < CPU_SETSIZE && unsigned(CPU_COUNT(&kept)) < threads; ++i) {
        if (CPU_ISSET(i, &set)) CPU_SET(i, &kept);
    }
    (void)sched_setaffinity(0, sizeof(kept), &kept);
#else
    (void)threads;
#endif
}

size_t number(const std::string &option, const char *text)
{
    char *end = nullptr;
    const unsigned long value = text ? std::strtoul(text, &end, 10) : 0;
    if (!text || *end || value < 1 || value > 1000000)
        throw std::invalid_argument(option + " needs a number from 1 to 1000000");
    return value;
}

/* Whether the file has more than lines that begin with #. */
bool has_heading(const char *path)
{
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.compare(0, 1, "#") != 0) return true;
    }
    return false;
}

settings parse(int argc, char **argv)
{
    settings s;
    for (int i = 1; i < argc; ++i) {
        const std::string option = argv[i];
        if (option.compare(0, 1, "-") != 0) {
            s.scenes.push_back(option);
            continue;
        }
        const char *value = ++i < argc ? argv[i] : nullptr;
        if (option == "--threads" && value && std::strcmp(value, "all") == 0)
            s.threads = processors();
        else if (option == "--threads")
            s.threads = unsigned(number(option, value));
        else if (option == "--repeats")
            s.repeats = number(option, value);
        else if (option == "--frames")
            s.frames = number(option, value);
        else if (option == "--csv" && value)
            s.csv = value;
        else
            throw std::invalid_argument("what is " + option + "?");
    }
    if (s.scenes.empty()) throw std::invalid_argument("no scene given");
    return s;
}

} // namespace

int main(int argc, char **argv)
{
    settings s;
    try {
        s = parse(argc, argv);
    } catch (const std::invalid_argument &error) {
        std::fprintf(stderr,
                     "%s\nusage: %s [--threads 1|all|N] [--repeats N] [--frames N] [--csv FILE] "
                     "SCENE...\n",
                     error.what(), argv[0]);
        return 2;
    }
    keep_to(s.threads);

    const bool headed = s.csv && has_heading(s.csv);
    std::FILE *out = s.csv ? std::fopen(s.csv, "a") : stdout;
    if (!out) {
        std::fprintf(stderr, "%s: cannot be written\n", s.csv);
        return 2;
    }
    if (!headed)
        std::fputs(
            "scene,triangles,frame,peer,version,what,threads,ms,pairs,matches,ms_min,missing,"
            "extra,beside,processors\n",
            out);

    int status = 0;
    try {
        for (const std::string &folder : s.scenes) {
            const bool same = is_of_objects(folder) ? run_objects(folder, s, out)
                                                    : run(read_scene(folder), make_peers(), s, out);
            if (!same) status = 1;
        }
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        status = 2;
    }
    if (s.csv && std::fclose(out) != 0) {
        std::fprintf(stderr, "%s: cannot be written\n", s.csv);
        status = 2;
    }
    return status;
}
