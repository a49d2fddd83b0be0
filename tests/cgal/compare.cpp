/*
 * Compares the triangle pairs of starcontour with those of CGAL (Computational Geometry Algorithms
 * Library) on one mesh: compare [--limit TRIANGLES] [--contour-none] MESH
 *
 * SPDX-License-Identifier: MIT
 *
 * Both sides get the same coordinates, as tools/mesh_file.h reads them, equal positions joined.
 * Ours: SC_PAIRS_TRIANGLE, touching, by all three methods. CGAL's: Polygon_mesh_processing::
 * self_intersections with exact predicates (the kernel named below, whose constructions are not
 * used), brought to our definition as follows. Statements about CGAL are those of its headers,
 * version 5.5.1.
 *
 *   CGAL                                            ours, and what is done about it
 *   triangles are closed: touching is a pair        the same
 *   no common vertex: they have a common point      the same
 *   one common vertex: the edge opposite to it      the same
 *     in one of them meets the other triangle
 *   a common edge: the four points are coplanar     the same
 *     and the other two on one side of the edge
 *   three common vertices: always, by that test     the same
 *   (a, b) and (b, a) are one pair, in any order    a < b, sorted: put into this order
 *   a mesh is an oriented 2-manifold; vertices      any soup: a triangle that CGAL's mesh refuses, as it
 *     are common if they are one in the mesh          would make it non-manifold, gets vertices of its
 *                                                     own. What it shares with others then counts
 *                                                     as touching, so CGAL reports all our pairs
 *                                                     and some more; each reported pair with fewer
 *                                                     common vertices in CGAL's mesh than common
 *                                                     positions is tried again with the rule for
 *                                                     the latter.
 *   a degenerate triangle is reported as (f, f),    a degenerate triangle is a segment or a point, and
 *     and in no other pair                            pairs like any other: (f, f) is dropped, and CGAL's
 *                                                     box_intersection_d and do_intersect, on
 *                                                     segments and points, find its pairs. Two
 *                                                     triangles with a common edge of which both
 *                                                     are segments pair if both go beyond the same
 *                                                     end of it.
 *
 * (triangle_soup_self_intersections, which newer versions of CGAL have, would spare the mesh, not
 * the other differences.)
 *
 * Each differing pair is printed with its coordinates and with what exact rational arithmetic
 * (tests/oracle.h) says of it. Where that agrees with us the difference is explained.
 *
 * Prints one line on the mesh: whether pairs are the same, triangles, our pairs, CGAL's (mapped),
 * milliseconds of both (ours with building the model; CGAL's without its mesh), and CGAL's own
 * count. Exit status: 0 same or explained, 1 different, 2 wrong usage or our library fails, 3 not
 * read as a mesh, 4 left out for the reason printed.
 *
 * Cost: some microseconds a triangle on each side, and one for each pair that touches.
 *
 * CGAL's headers used here are under the GPL: so is a binary of this program. It is never
 * installed.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include "mesh_file.h"
#include "oracle.h"
}

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace
{

typedef CGAL::Exact_predicates_inexact_constructions_kernel kernel;
typedef kernel::Point_3 point;
typedef CGAL::Surface_mesh<point> surface;
typedef std::pair<uint32_t, uint32_t> pair;
typedef std::vector<pair> pair_list;

enum { SAME = 0, DIFFERENT = 1, FAILED = 2, NOT_READ = 3, LEFT_OUT = 4 };

double milliseconds()
{
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

/* ------------------------------------------------------------------------------------------------
 * CGAL's side
 */

/* The distinct vertices of a triangle: joined before, so their positions are distinct as well. */
std::vector<uint32_t> distinct(const uint32_t *corners)
{
    std::vector<uint32_t> list;
    for (int k = 0; k < 3; ++k) {
        if (std::find(list.begin(), list.end(), corners[k]) == list.end())
            list.push_back(corners[k]);
    }
    return list;
}

/* Members of a that are in b, or those that are not. */
std::vector<uint32_t> select(const std::vector<uint32_t> &a, const std::vector<uint32_t> &b,
                             bool in_b)
{
    std::vector<uint32_t> list;
    for (uint32_t v : a) {
        if ((std::find(b.begin(), b.end(), v) != b.end()) == in_b) list.push_back(v);
    }
    return list;
}

/* What one to three distinct points span. */
typedef std::variant<point, kernel::Segment_3, kernel::Triangle_3> shape;

shape span(const std::vector<point> &points, const std::vector<uint32_t> &v)
{
    const point &a = points[v[0]];
    if (v.size() == 1) return a;
    const point &b = points[v[1]];
    if (v.size() == 2) return kernel::Segment_3(a, b);
    const point &c = points[v[2]];
    if (!CGAL::collinear(a, b, c)) return kernel::Triangle_3(a, b, c);
    if (CGAL::collinear_are_ordered_along_line(a, b, c)) return kernel::Segment_3(a, c);
    if (CGAL::collinear_are_ordered_along_line(b, a, c)) return kernel::Segment_3(b, c);
    return kernel::Segment_3(a, b);
}

bool meet(const shape &first, const shape &second)
{
    return std::visit([](const auto &a, const auto &b) -> bool { return CGAL::do_intersect(a, b); },
                      first, second);
}

/* Whether the triangles (s, t, p) and (s, t, q) have a common point off the segment s t. */
bool fold(const point &s, const point &t, const point &p, const point &q)
{
    const bool p_on_line = CGAL::collinear(s, t, p), q_on_line = CGAL::collinear(s, t, q);
    if (p_on_line != q_on_line) return false;
    if (!p_on_line) {
        return CGAL::coplanar(s, t, p, q) &&
               CGAL::coplanar_orientation(s, t, p, q) == CGAL::POSITIVE;
    }
    const auto ordered = [](const point &x, const point &y, const point &z) {
        return CGAL::collinear_are_ordered_along_line(x, y, z);
    };
    return (ordered(s, t, p) && ordered(s, t, q)) || (ordered(t, s, p) && ordered(t, s, q));
}

/* The rule for two triangles that share any number of vertices and may be degenerate. */
bool is_pair(const std::vector<point> &points, const uint32_t *first, const uint32_t *second)
{
    const std::vector<uint32_t> a = distinct(first), b = distinct(second);
    const std::vector<uint32_t> shared = select(a, b, true);
    const std::vector<uint32_t> rest_a = select(a, b, false), rest_b = select(b, a, false);
    switch (shared.size()) {
    case 0:
        return meet(span(points, a), span(points, b));
    case 1:
        return (!rest_a.empty() && meet(span(points, rest_a), span(points, b))) ||
               (!rest_b.empty() && meet(span(points, rest_b), span(points, a)));
    case 2:
        return rest_a.size() == 1 && rest_b.size() == 1 &&
               fold(points[shared[0]], points[shared[1]], points[rest_a[0]], points[rest_b[0]]);
    default:
        return true;
    }
}

size_t count_shared(const uint32_t *a, const uint32_t *b)
{
    return select(distinct(a), distinct(b), true).size();
}

struct cgal_answer {
    pair_list pairs;           /* mapped, sorted */
    size_t raw = 0;            /* pairs that self_intersections reported, without (f, f) */
    size_t degenerate = 0;     /* triangles */
    size_t own_vertices = 0;   /* triangles that CGAL's mesh refused */
    double milliseconds = 0.0; /* without building CGAL's mesh */
};

cgal_answer ask_cgal(const mesh_file &mesh)
{
    cgal_answer answer;
    std::vector<point> points;
    surface cgal_mesh;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        double p[3];
        mesh_file_position(mesh.positions, mesh.position_type, v, p);
        points.push_back(point(p[0], p[1], p[2]));
        cgal_mesh.add_vertex(points.back());
    }

    /* mesh_corners: the vertices that a triangle has in CGAL's mesh. */
    const size_t corner_count = 3 * size_t(mesh.triangle_count);
    std::vector<uint32_t> mesh_corners(mesh.indices, mesh.indices + corner_count);
    std::vector<uint32_t> triangle_of_face, degenerate;
    for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
        uint32_t *v = &mesh_corners[3 * size_t(t)];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0] ||
            CGAL::collinear(points[v[0]], points[v[1]], points[v[2]])) {
            degenerate.push_back(t);
        }
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue; /* no face for CGAL */
        const auto add = [&]() {
            return cgal_mesh.add_face(surface::Vertex_index(v[0]), surface::Vertex_index(v[1]),
                                      surface::Vertex_index(v[2])) != surface::null_face();
        };
        if (!add()) {
            for (int k = 0; k < 3; ++k) v[k] = uint32_t(cgal_mesh.add_vertex(points[v[k]]));
            ++answer.own_vertices;
            if (!add()) throw std::runtime_error("a triangle by itself is not taken into the mesh");
        }
        triangle_of_face.push_back(t);
    }
    answer.degenerate = degenerate.size();

    const double start = milliseconds();
    std::vector<std::pair<surface::Face_index, surface::Face_index>> reported;
    CGAL::Polygon_mesh_processing::self_intersections(cgal_mesh, std::back_inserter(reported));
    for (const auto &faces : reported) {
        const uint32_t a = triangle_of_face[faces.first], b = triangle_of_face[faces.second];
        if (a == b) continue;
        ++answer.raw;
        const uint32_t *corners_a = mesh.indices + 3 * size_t(a);
        const uint32_t *corners_b = mesh.indices + 3 * size_t(b);
        if (count_shared(corners_a, corners_b) !=
                count_shared(&mesh_corners[3 * size_t(a)], &mesh_corners[3 * size_t(b)]) &&
            !is_pair(points, corners_a, corners_b)) {
            continue;
        }
        answer.pairs.push_back(std::minmax(a, b));
    }

    if (!degenerate.empty()) {
        typedef CGAL::Box_intersection_d::Box_with_info_d<double, 3, uint32_t> box;
        const auto box_of = [&](uint32_t t) {
            const uint32_t *v = mesh.indices + 3 * size_t(t);
            return box(points[v[0]].bbox() + points[v[1]].bbox() + points[v[2]].bbox(), t);
        };
        std::vector<box> some, all;
        std::vector<char> is_degenerate(mesh.triangle_count, 0);
        for (uint32_t t : degenerate) {
            some.push_back(box_of(t));
            is_degenerate[t] = 1;
        }
        for (uint32_t t = 0; t < mesh.triangle_count; ++t) all.push_back(box_of(t));
        const auto compare = [&](const box &first, const box &second) {
            const uint32_t a = first.info(), b = second.info();
            if (a == b || (is_degenerate[b] && b < a)) return; /* both degenerate: once */
            if (is_pair(points, mesh.indices + 3 * size_t(a), mesh.indices + 3 * size_t(b)))
                answer.pairs.push_back(std::minmax(a, b));
        };
        CGAL::box_intersection_d(some.begin(), some.end(), all.begin(), all.end(), compare);
    }
    std::sort(answer.pairs.begin(), answer.pairs.end());
    answer.milliseconds = milliseconds() - start;
    return answer;
}

/* ------------------------------------------------------------------------------------------------
 * Our side
 */

struct our_answer {
    sc_status status = SC_OK;
    bool methods_agree = true;
    pair_list pairs;           /* of SC_METHOD_SCTT */
    double milliseconds = 0.0; /* build and first query */
};

our_answer ask_starcontour(const mesh_file &mesh, uint32_t contour)
{
    static const uint32_t methods[] = {SC_METHOD_SCTT, SC_METHOD_AABB_SCTT, SC_METHOD_AABB};
    our_answer answer;
    sc_model *model = nullptr;
    sc_workspace *workspace = nullptr;
    sc_mesh input = sc_mesh();
    input.struct_size = sizeof(input);
    input.vertex_count = mesh.vertex_count;
    input.triangle_count = mesh.triangle_count;
    input.position_type = mesh.position_type;
    input.positions = mesh.positions;
    input.indices = mesh.indices;
    sc_pose pose = sc_pose();
    pose.struct_size = sizeof(pose);
    pose.vertex_count = mesh.vertex_count;
    pose.position_type = mesh.position_type;
    pose.positions = mesh.positions;

    std::vector<sc_pair> buffer(1024);
    const double start = milliseconds();
    answer.status = sc_build(&input, nullptr, &model);
    if (answer.status == SC_OK) answer.status = sc_workspace_create(model, nullptr, &workspace);
    for (uint32_t method : methods) {
        if (answer.status != SC_OK) break;
        sc_query_options options = sc_query_options();
        options.struct_size = sizeof(options);
        options.method = method;
        options.contour = method == SC_METHOD_SCTT ? contour : uint32_t(SC_CONTOUR_DEFAULT);
        sc_result result = sc_result();
        do {
            buffer.resize(std::max<size_t>(buffer.size(), result.count));
            result = sc_result();
            result.struct_size = sizeof(result);
            result.pairs = buffer.data();
            result.capacity = buffer.size();
            answer.status = sc_query(model, workspace, &pose, &options, &result);
        } while (answer.status == SC_ERROR_SHORT_BUFFER);
        pair_list pairs;
        for (uint64_t i = 0; i < result.count; ++i) pairs.push_back(pair(buffer[i].a, buffer[i].b));
        if (method == SC_METHOD_SCTT) {
            answer.milliseconds = milliseconds() - start;
            answer.pairs = pairs;
        } else if (pairs != answer.pairs) {
            answer.methods_agree = false;
        }
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    return answer;
}

/* ------------------------------------------------------------------------------------------------
 * Differences
 */

/* What exact rational arithmetic says of a pair. */
bool oracle_says(const mesh_file &mesh, const pair &p)
{
    uint32_t triangles[6], numbers[6], count = 0;
    double positions[18];
    for (uint32_t c = 0; c < 6; ++c) {
        const uint32_t v = mesh.indices[3 * size_t(c < 3 ? p.first : p.second) + c % 3];
        uint32_t i = 0;
        while (i < count && numbers[i] != v) ++i;
        triangles[c] = i;
        if (i < count) continue;
        numbers[count++] = v;
        mesh_file_position(mesh.positions, mesh.position_type, v, positions + 3 * i);
    }
    oracle_answer answer;
    oracle_solve(positions, count, triangles, 2, nullptr, &answer);
    const bool is = answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING].count != 0;
    oracle_free(&answer);
    return is;
}

void print_triangle(const mesh_file &mesh, uint32_t t)
{
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t v = mesh.indices[3 * size_t(t) + k];
        double p[3];
        mesh_file_position(mesh.positions, mesh.position_type, v, p);
        std::printf("        triangle %u vertex %u: %a %a %a = %.17g %.17g %.17g\n", t, v, p[0],
                    p[1], p[2], p[0], p[1], p[2]);
    }
}

/* Prints where the lists differ; returns how many differences exact arithmetic does not explain. */
size_t print_differences(const mesh_file &mesh, const pair_list &ours, const pair_list &cgals)
{
    pair_list differences;
    size_t unexplained = 0;
    std::set_symmetric_difference(ours.begin(), ours.end(), cgals.begin(), cgals.end(),
                                  std::back_inserter(differences));
    for (const pair &p : differences) {
        const bool is_ours = std::binary_search(ours.begin(), ours.end(), p);
        const bool explained = oracle_says(mesh, p) == is_ours;
        if (!explained) ++unexplained;
        std::printf("    pair %u %u: only %s has it; exact arithmetic says that %s right\n",
                    p.first, p.second, is_ours ? "starcontour" : "CGAL",
                    explained ? "starcontour is" : "CGAL is");
        print_triangle(mesh, p.first);
        print_triangle(mesh, p.second);
    }
    return unexplained;
}

int compare(const mesh_file &mesh, const char *path, uint32_t contour)
{
    const our_answer ours = ask_starcontour(mesh, contour);
    if (ours.status == SC_ERROR_NOT_FINITE) {
        std::printf("left out  %s: %s\n", path, sc_status_string(ours.status));
        return LEFT_OUT;
    }
    if (ours.status != SC_OK) {
        std::fprintf(stderr, "compare: %s: %s\n", path, sc_status_string(ours.status));
        return FAILED;
    }
    const cgal_answer cgals = ask_cgal(mesh);
    const bool same = ours.pairs == cgals.pairs;
    std::printf(
        "%-9s %7u triangles, pairs: %8zu, CGAL %8zu; ms: %8.1f, CGAL %8.1f; CGAL itself: %zu "
        "pairs, %zu degenerate, %zu on their own; %s\n",
        same ? "same" : "DIFFERENT", mesh.triangle_count, ours.pairs.size(), cgals.pairs.size(),
        ours.milliseconds, cgals.milliseconds, cgals.raw, cgals.degenerate, cgals.own_vertices,
        path);
    size_t unexplained = same ? 0 : print_differences(mesh, ours.pairs, cgals.pairs);
    if (!ours.methods_agree) {
        std::printf("    starcontour's methods do not give the same pairs\n");
        ++unexplained;
    }
    return unexplained == 0 ? SAME : DIFFERENT;
}

} // namespace

int main(int argc, char **argv)
{
    unsigned long limit = std::numeric_limits<uint32_t>::max();
    uint32_t contour = SC_CONTOUR_DEFAULT;
    int i = 1;
    for (; i < argc - 1; ++i) {
        if (std::strcmp(argv[i], "--contour-none") == 0) {
            contour = SC_CONTOUR_NONE;
        } else if (std::strcmp(argv[i], "--limit") == 0 && i + 2 < argc) {
            limit = std::strtoul(argv[++i], nullptr, 10);
        } else {
            break;
        }
    }
    if (i != argc - 1) {
        std::fprintf(stderr, "usage: compare [--limit TRIANGLES] [--contour-none] MESH\n");
        return FAILED;
    }

    const char *path = argv[i];
    mesh_file mesh;
    char error[MESH_FILE_ERROR_SIZE];
    if (!mesh_file_read(&mesh, path, error)) {
        std::printf("not read  %s\n", error);
        return NOT_READ;
    }
    int status = FAILED;
    if (mesh.triangle_count > limit) {
        std::printf("left out  %s: %u triangles, more than %lu\n", path, mesh.triangle_count,
                    limit);
        status = LEFT_OUT;
    } else if (!mesh_file_join(&mesh)) {
        std::fprintf(stderr, "compare: %s: out of memory\n", path);
    } else {
        try {
            status = compare(mesh, path, contour);
        } catch (const std::exception &problem) {
            std::fprintf(stderr, "compare: %s: %s\n", path, problem.what());
        }
    }
    mesh_file_free(&mesh);
    return status;
}
