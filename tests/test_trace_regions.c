/*
 * Regions: of closed surfaces that pass through each other, against the winding number of the other
 * one round each vertex, which knows nothing of contours; of planes through spheres, against areas
 * by formulas; of loops and ends within a triangle, by hand; of any meshes, what is true of all:
 * areas add up, and ends of edges that nothing crosses are in one region; of sizes up to the ends
 * of the range of doubles. What cannot be is in test_trace_regions_input.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "divided_scene.h"
#include "harness.h"

static const double pi = 3.14159265358979323846;

static const double *corner_of(const soup *s, uint32_t triangle, uint32_t k)
{
    return s->positions + 3 * (size_t)s->triangles[3 * (size_t)triangle + k];
}

static double area_of(const soup *s, uint32_t triangle)
{
    const double *p = corner_of(s, triangle, 0), *q = corner_of(s, triangle, 1),
                 *r = corner_of(s, triangle, 2);
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double n = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]);
        sum += n * n;
    }
    return sqrt(sum) / 2;
}

static int is_collapsed(const soup *s, uint32_t t)
{
    const uint32_t *v = s->triangles + 3 * (size_t)t;
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

/* The edges that contours cross: 1 in crossed[3 t + k]. */
static uint8_t *find_crossed(const divided_scene *d)
{
    const soup *s = &d->s.mesh;
    uint8_t *crossed = (uint8_t *)calloc(3 * (size_t)s->triangle_count, 1);
    if (!crossed) abort();
    for (uint64_t i = 0; i < d->s.result.node_count; ++i) {
        const sc_trace_node *n = &d->s.result.nodes[i];
        uint32_t u, v;
        if (n->edge == SC_TRACE_NO_EDGE) continue;
        u = s->triangles[n->edge];
        v = s->triangles[n->edge - n->edge % 3 + (n->edge + 1) % 3];
        for (uint32_t h = 0; h < 3 * s->triangle_count; ++h) {
            const uint32_t a = s->triangles[h], b = s->triangles[h - h % 3 + (h + 1) % 3];
            crossed[h] |= (a == u && b == v) || (a == v && b == u);
        }
    }
    return crossed;
}

/* Whether both sides of a contour on a sheet are the ends of the edge at its first node there, if
   nothing else crosses that. */
static int check_sides(const divided_scene *d, const sc_trace_contour *c, const uint32_t sides[2],
                       uint32_t sheet)
{
    const sc_trace_result *t = &d->s.result;
    const uint32_t *v = d->s.mesh.triangles;
    uint64_t i = c->first, others = 0;
    uint32_t edge;
    while (i < c->first + c->count &&
           (t->nodes[i].edge == SC_TRACE_NO_EDGE || t->nodes[i].sheet != sheet))
        ++i;
    if (i == c->first + c->count) return 1;
    edge = t->nodes[i].edge;
    for (uint64_t k = 0; k < t->node_count; ++k) others += t->nodes[k].edge == edge;
    return others != 1 ||
           (CHECK(d->regions.vertex_regions[v[edge]] == sides[0]) &&
            CHECK(d->regions.vertex_regions[v[edge - edge % 3 + (edge + 1) % 3]] == sides[1]));
}

/* What is true of all meshes. No area is below this share of the whole: of generic ones, one that
   rounding explains; where ties were decided, nodes are not quite where contours are. */
static int check_any(const divided_scene *d, double least)
{
    const soup *s = &d->s.mesh;
    const sc_regions_result *r = &d->regions;
    double whole = 0, sum = 0;
    uint64_t vertices = 0, used = 0;
    uint8_t *crossed = find_crossed(d);
    int is_right = 1;
    for (uint32_t t = 0; t < s->triangle_count; ++t)
        if (!is_collapsed(s, t)) whole += area_of(s, t);
    for (uint64_t i = 0; i < r->region_count; ++i) {
        sum += r->regions[i].area;
        vertices += r->regions[i].vertex_count;
        is_right = is_right && CHECK_MSG(r->regions[i].area >= least * whole, "area %g of %g",
                                         r->regions[i].area, whole);
    }
    is_right =
        is_right && CHECK_MSG(fabs(sum - whole) <= 1e-9 * whole, "%.17g and %.17g", sum, whole);
    for (uint32_t h = 0; h < 3 * s->triangle_count && is_right; ++h) {
        const uint32_t a = s->triangles[h], b = s->triangles[h - h % 3 + (h + 1) % 3];
        if (crossed[h] || is_collapsed(s, h / 3)) continue;
        is_right = CHECK(r->vertex_regions[a] == r->vertex_regions[b]);
    }
    for (uint32_t v = 0; v < s->vertex_count && is_right; ++v) {
        used += r->vertex_regions[v] != SC_TRACE_NO_EDGE;
        is_right = CHECK(r->vertex_regions[v] == SC_TRACE_NO_EDGE ||
                         r->vertex_regions[v] < r->region_count);
    }
    is_right = is_right && CHECK(used == vertices);
    for (uint64_t i = 0; i < d->s.result.contour_count && is_right; ++i)
        for (int k = 0; k < 4; ++k)
            is_right =
                is_right && CHECK(r->sides[i].sides[k / 2][k % 2] < r->region_count) &&
                check_sides(d, &d->s.result.contours[i], r->sides[i].sides[k / 2], (uint32_t)k / 2);
    free(crossed);
    return is_right;
}

/* How often triangles first to end - 1, a closed surface, go round a point: the sum of the solid
   angles of its triangles (van Oosterom, Strackee 1983). */
static double winding(const soup *s, uint32_t first, uint32_t end, const double *point)
{
    double sum = 0;
    for (uint32_t t = first; t < end; ++t) {
        double v[3][3], length[3], dot[3], volume = 0;
        for (int i = 0; i < 3; ++i) {
            const double *p = corner_of(s, t, (uint32_t)i);
            for (int k = 0; k < 3; ++k) v[i][k] = p[k] - point[k];
            length[i] = sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
        }
        for (int i = 0; i < 3; ++i) {
            const double *a = v[i], *b = v[(i + 1) % 3];
            dot[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            volume += v[0][i] * (v[1][(i + 1) % 3] * v[2][(i + 2) % 3] -
                                 v[1][(i + 2) % 3] * v[2][(i + 1) % 3]);
        }
        sum += 2 * atan2(volume, length[0] * length[1] * length[2] + dot[0] * length[2] +
                                     dot[1] * length[0] + dot[2] * length[1]);
    }
    return fabs(sum) / (4 * pi);
}

/* Whether the normal of the first triangle points away from the middle. */
static int is_outwards(const soup *s)
{
    const double *p = corner_of(s, 0, 0), *q = corner_of(s, 0, 1), *r = corner_of(s, 0, 2);
    return p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
               p[2] * (q[0] * r[1] - q[1] * r[0]) >
           0;
}

static void spheres_through_each_other(void)
{
    uint32_t divided_ones = 0, known = 0;
    for (uint32_t n = test_iterations(40); n > 0; --n) {
        const uint32_t around = 6 + test_random_below(14);
        uint32_t first_vertices, first_triangles;
        soup mesh = two_spheres(around, test_random_range(0.1, 1.2), test_random_range(0.3, 1.2),
                                &first_vertices, &first_triangles);
        divided_scene d;
        if (divide(&d, mesh) && check_any(&d, -1e-9)) {
            const soup *s = &d.s.mesh;
            const uint64_t count = d.regions.region_count;
            int *inside = (int *)test_allocate((size_t)count * sizeof *inside);
            for (uint64_t i = 0; i < count; ++i) inside[i] = -1;
            for (uint32_t v = 0; v < s->vertex_count; ++v) {
                const int is_first = v < first_vertices;
                const double times = winding(s, is_first ? first_triangles : 0,
                                             is_first ? s->triangle_count : first_triangles,
                                             s->positions + 3 * (size_t)v);
                const int is_inside = times > 0.5;
                const uint32_t region = d.regions.vertex_regions[v];
                CHECK_MSG(fabs(times - is_inside) < 1e-6, "%g times", times);
                CHECK(d.regions.regions[region].component == (is_first ? 0 : first_vertices));
                if (inside[region] < 0) inside[region] = is_inside;
                if (!CHECK_MSG(inside[region] == is_inside, "a region is inside and outside"))
                    break;
            }
            for (uint64_t i = 0; i < count; ++i) {
                const int wanted = is_outwards(s) ? inside[i] : -1 - inside[i];
                known += inside[i] >= 0 && d.regions.regions[i].inside == wanted;
                CHECK_MSG(d.regions.regions[i].inside == SC_REGION_UNKNOWN || inside[i] < 0 ||
                              d.regions.regions[i].inside == wanted,
                          "%d times round, not %d", d.regions.regions[i].inside, wanted);
            }
            for (uint64_t i = 0; i < d.s.result.contour_count; ++i) {
                const sc_contour_sides *c = &d.regions.sides[i];
                CHECK(d.s.result.contours[i].begin == SC_TRACE_CLOSED);
                for (int sheet = 0; sheet < 2; ++sheet) {
                    const uint32_t a = c->sides[sheet][0], b = c->sides[sheet][1];
                    const uint32_t hint = sc_region_hint(d.regions.regions, c, (uint32_t)sheet);
                    CHECK(a != b && (inside[a] < 0 || inside[b] < 0 || inside[a] != inside[b]));
                    CHECK(hint < 2 && d.regions.regions[c->sides[sheet][hint]].area <
                                          d.regions.regions[c->sides[sheet][1 - hint]].area);
                    ++divided_ones;
                }
            }
            free(inside);
        }
        undivide(&d);
    }
    CHECK_MSG((divided_ones > 0 && known > 0) || !test_is_full(), "no contour, or no side known");
}

/* A sphere and a plane through it at some height: caps. */
static void planes_through_spheres(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        const double height = test_random_range(-0.7, 0.7), size = 4 + test_random_unit();
        soup ball = soup_sphere(60, 30), plane = soup_cloth(1 + test_random_below(30), 5), both;
        double radius = 0, sphere = 0, disc, cap;
        divided_scene d;
        for (uint32_t v = 0; v < ball.vertex_count; ++v) {
            const double *p = ball.positions + 3 * (size_t)v;
            const double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            if (length > radius) radius = length;
        }
        for (uint32_t v = 0; v < plane.vertex_count; ++v) {
            double *p = plane.positions + 3 * (size_t)v;
            p[0] = size * radius * (p[0] - 0.5013);
            p[1] = size * radius * (p[1] - 0.5017);
            p[2] = height * radius;
        }
        sphere = 4 * pi * radius * radius;
        cap = 2 * pi * radius * radius * (1 - height);
        disc = pi * radius * radius * (1 - height * height);
        both = soup_join(&ball, &plane);
        soup_free(&ball);
        soup_free(&plane);
        if (divide(&d, both) && check_any(&d, -1e-9) &&
            CHECK_MSG(d.regions.region_count == 4, "%" PRIu64 " regions", d.regions.region_count) &&
            CHECK(d.s.result.contour_count == 1)) {
            const sc_contour_sides *c = d.regions.sides;
            for (int sheet = 0; sheet < 2; ++sheet) {
                const double a = d.regions.regions[c->sides[sheet][0]].area;
                const double b = d.regions.regions[c->sides[sheet][1]].area;
                const uint32_t hint = sc_region_hint(d.regions.regions, c, (uint32_t)sheet);
                const int is_plane = d.regions.regions[c->sides[sheet][0]].component >= 2 + 29 * 60;
                const double small = a < b ? a : b;
                const double wanted = is_plane ? disc : cap < sphere - cap ? cap : sphere - cap;
                CHECK(c->sides[sheet][0] != c->sides[sheet][1]);
                CHECK_MSG(fabs(small - wanted) < 0.02 * sphere, "%g, not %g", small, wanted);
                CHECK(hint == (b < a));
                if (is_plane) { /* which is not closed, and goes round nothing */
                    const int sign = is_outwards(&d.s.mesh) ? 1 : -1;
                    const int32_t inside = d.regions.regions[c->sides[sheet][b < a]].inside;
                    CHECK_MSG(inside == sign || inside == SC_REGION_UNKNOWN, "%d", inside);
                } else {
                    const int32_t inside = d.regions.regions[c->sides[sheet][0]].inside;
                    CHECK_MSG(inside == (is_outwards(&d.s.mesh) ? 0 : -1), "%d", inside);
                }
            }
        }
        undivide(&d);
    }
}

/* A small ball within one triangle: a loop inside of it, and one in that. */
static void loops_in_a_triangle(void)
{
    for (uint32_t n = test_iterations(10); n > 0; --n) {
        const double scale[2] = {test_random_range(0.1, 0.2), test_random_range(0.05, 0.08)};
        const uint32_t count = 1 + test_random_below(2);
        soup all = soup_make(3, 1);
        divided_scene d;
        const double big[9] = {-3, -2, 0, 3, -2, 0, 0, 4, 0};
        memcpy(all.positions, big, sizeof big);
        for (uint32_t i = 0; i < 3; ++i) all.triangles[i] = i;
        for (uint32_t i = 0; i < count; ++i) {
            soup ball = soup_sphere(12, 6), both;
            soup_scale(ball.positions, ball.vertex_count, scale[i]);
            soup_move(ball.positions, ball.vertex_count, 0.011);
            both = soup_join(&all, &ball);
            soup_free(&all);
            soup_free(&ball);
            all = both;
        }
        if (divide(&d, all) && check_any(&d, -1e-9) &&
            CHECK_MSG(d.regions.region_count == 1 + 3 * count, "%" PRIu64 " regions",
                      d.regions.region_count)) {
            double ring = 0;
            for (uint64_t i = 0; i < d.s.result.contour_count; ++i) {
                const sc_contour_sides *c = &d.regions.sides[i];
                const sc_trace_node *node = d.s.result.nodes + d.s.result.contours[i].first;
                const uint32_t flat = 1 - node->sheet; /* the balls have all the edges */
                const sc_region *in = &d.regions.regions[c->sides[flat][0]];
                const sc_region *round = &d.regions.regions[c->sides[flat][1]];
                CHECK(node->triangle == 0 && in->vertex_count == 0 && in->area > 0);
                CHECK(in->component == 0 && round->component == 0);
                CHECK(in != round && in->area < round->area + (count == 2 ? 1 : 0));
                ring += in->area;
            }
            if (count == 2) { /* balls with one middle: one loop is in the other */
                const sc_trace_node *node = d.s.result.nodes + d.s.result.contours[0].first;
                const uint32_t flat = 1 - node->sheet;
                const uint32_t *a = d.regions.sides[0].sides[flat];
                const uint32_t *b = d.regions.sides[1].sides[flat];
                CHECK(a[0] == b[1] || b[0] == a[1]);
                CHECK(a[1] == d.regions.vertex_regions[0] || b[1] == d.regions.vertex_regions[0]);
            }
            CHECK_MSG(fabs(ring + d.regions.regions[d.regions.vertex_regions[0]].area -
                           area_of(&d.s.mesh, 0)) < 1e-9,
                      "areas of loops do not add up");
        }
        undivide(&d);
    }
}

/* A small upright triangle that z = 0 cuts at a third of its height, at x. */
static soup small_flag(double x)
{
    const double r = 0x1p-8;
    const double positions[9] = {x - r, r / 2, -r, x + r, r / 4, -r, x + r / 8, -r / 3, 2 * r};
    soup s = soup_make(3, 1);
    memcpy(s.positions, positions, sizeof positions);
    for (uint32_t i = 0; i < 3; ++i) s.triangles[i] = i;
    return s;
}

/* The area of a region that is on a side of the contour on sheet 0's or 1's triangle 0. */
static double area_at(const divided_scene *d, uint64_t contour, int side)
{
    const sc_trace_result *t = &d->s.result;
    const sc_trace_node *node = t->nodes + t->contours[contour].first;
    CHECK(node->triangle == 0 && node->edge != SC_TRACE_NO_EDGE);
    return d->regions.regions[d->regions.sides[contour].sides[1 - node->sheet][side]].area;
}

/* By hand: a triangle of the area 18, in it squares of the areas 1/2, 1/8 and 1/32, one in the
   other, in any order; and small triangles through it, whose contours end in it and divide nothing,
   in each of the four regions. */
static void loops_by_hand(void)
{
    static const double big[9] = {-3, -2, 0, 3, -2, 0, 0, 4, 0};
    static const double at[4] = {0, 0.1875, 0.375, 1};
    static const double areas[4] = {1. / 32, 3. / 32, 3. / 8, 17.5};
    for (uint32_t order = 0; order < 6; ++order) {
        const uint32_t first = order / 2, second = (first + 1 + order % 2) % 3;
        const uint32_t sizes[3] = {first, second, 3 - first - second};
        soup all = soup_make(3, 1);
        divided_scene d;
        memcpy(all.positions, big, sizeof big);
        for (uint32_t i = 0; i < 3; ++i) all.triangles[i] = i;
        for (uint32_t i = 0; i < 3; ++i) add_soup(&all, octahedron(ldexp(1, (int)sizes[i] - 2)));
        for (uint32_t i = 0; i < 4; ++i) add_soup(&all, small_flag(at[i]));
        if (divide(&d, all) && check_any(&d, 0) && CHECK(d.s.result.contour_count == 7) &&
            CHECK(d.regions.region_count == 1 + 2 * 3 + 3 + 2 * 4)) {
            const double flag = area_of(&d.s.mesh, 25);
            for (uint64_t i = 0; i < 4; ++i) { /* those that are not closed come first */
                const sc_contour_sides *c = &d.regions.sides[i];
                const uint32_t flat = 1 - d.s.result.nodes[d.s.result.contours[i].first].sheet;
                const double a = d.regions.regions[c->sides[1 - flat][0]].area;
                const double b = d.regions.regions[c->sides[1 - flat][1]].area;
                CHECK(c->sides[flat][0] == c->sides[flat][1]);
                CHECK(sc_region_hint(d.regions.regions, c, flat) == SC_TRACE_NO_EDGE);
                CHECK(sc_region_hint(d.regions.regions, c, 1 - flat) == (b < a));
                CHECK_MSG(fabs(area_at(&d, i, 0) - areas[i]) < 1e-14, "%g, not %g",
                          area_at(&d, i, 0), areas[i]);
                CHECK_MSG(fabs((a < b ? a : b) - flag * 4 / 9) < 1e-14 &&
                              fabs((a < b ? b : a) - flag * 5 / 9) < 1e-14,
                          "%g and %g of %g", a, b, flag);
            }
            for (uint64_t i = 4; i < 7; ++i) {
                const uint32_t k = sizes[i - 4];
                CHECK_MSG(fabs(area_at(&d, i, 0) - areas[k]) < 1e-14, "%g within, not %g",
                          area_at(&d, i, 0), areas[k]);
                CHECK_MSG(fabs(area_at(&d, i, 1) - areas[k + 1]) < 1e-14, "%g round, not %g",
                          area_at(&d, i, 1), areas[k + 1]);
            }
            CHECK(d.regions.vertex_regions[0] == 0 &&
                  fabs(d.regions.regions[0].area - areas[3]) < 1e-14);
        }
        undivide(&d);
    }
}

/* Two triangles that pass through each other such that one is divided in the middle of its height:
   hints of regions that are as large, and none of what is inside if nobody asks for that. */
static void equal_regions(void)
{
    static const double positions[18] = {-8, -8, 0, 8, -8, 0, 0, 8, 0, 1, 0, 4, 1, 0, -4, -1, 0, 0};
    soup mesh = soup_make(6, 2);
    divided_scene d;
    memcpy(mesh.positions, positions, sizeof positions);
    for (uint32_t i = 0; i < 6; ++i) mesh.triangles[i] = i;
    if (divide(&d, mesh) && CHECK(d.regions.region_count == 3) &&
        CHECK(d.s.result.contour_count == 1)) {
        sc_regions_result r = d.regions;
        const sc_contour_sides *c = d.regions.sides;
        for (uint32_t sheet = 0; sheet < 2; ++sheet) {
            const double area = r.regions[c->sides[sheet][0]].area;
            const int is_divided = c->sides[sheet][0] != c->sides[sheet][1];
            CHECK(sc_region_hint(r.regions, c, sheet) == SC_TRACE_NO_EDGE);
            CHECK_MSG(area == (is_divided ? 4 : 128), "%g", area);
        }
        r.flags = 0;
        memset(r.regions, 0x55, (size_t)r.region_count * sizeof *r.regions);
        CHECK(sc_trace_regions(d.s.model, &d.s.pose, &d.s.result, NULL, &r) == SC_OK);
        for (uint64_t i = 0; i < r.region_count; ++i)
            CHECK(r.regions[i].inside == SC_REGION_UNKNOWN);
    }
    undivide(&d);
}

/* Whatever there is: nothing but what is true of all. */
static void any_meshes(void)
{
    uint64_t regions = 0, contours = 0;
    for (uint32_t n = test_iterations(200); n > 0; --n) {
        const char *name;
        soup s = test_random_below(3) ? soup_any_mesh(150, &name)
                                      : soup_on_grid(2 + test_random_below(6));
        divided_scene d;
        if (test_random_below(2)) soup_any_pose(s.positions, s.vertex_count);
        for (uint32_t i = 0; i < 3 * s.vertex_count; ++i)
            if (!(fabs(s.positions[i]) < 1e100)) s.positions[i] = 0;
        if (divide(&d, s)) {
            check_any(&d, -0.2);
            regions += d.regions.region_count;
            contours += d.s.result.contour_count;
        }
        undivide(&d);
    }
    test_note("%" PRIu64 " regions, %" PRIu64 " contours", regions, contours);
}

/* Strips that are one: contours of one sheet. */
static void strips(void)
{
    for (uint32_t turns = 0; turns < 6; ++turns) {
        divided_scene d;
        if (divide(&d, trace_scene_strips(24, turns)) && check_any(&d, -1e-9)) {
            /* halves of two strips; of strips that a half turn joins; of one strip */
            const uint64_t wanted = turns % 2 ? 1 : turns % 4 ? 2 : 4;
            CHECK_MSG(d.regions.region_count == wanted, "%u turns: %" PRIu64 " regions", turns,
                      d.regions.region_count);
        }
        undivide(&d);
    }
}

/* Two triangles of which the edge between them has its own vertices on either side, and a vertex of
   none: each place has one region, and that is of the vertex that stands for the others. */
static void welded_vertices(void)
{
    static double at[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 9, 9, 9};
    static uint32_t corners[] = {0, 1, 2, 3, 5, 4};
    static const uint32_t wanted[7] = {
        0, 0, 0, SC_TRACE_NO_EDGE, SC_TRACE_NO_EDGE, 0, SC_TRACE_NO_EDGE};
    const sc_pose pose = input_plain_pose(at, 7);
    sc_mesh mesh;
    sc_model *model = NULL;
    sc_trace_result t = trace_scene_no_room();
    sc_regions_result r;
    sc_region region;
    uint32_t of[7];
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = 7;
    mesh.triangle_count = 2;
    mesh.position_type = SC_DOUBLE;
    mesh.index_type = SC_UINT32;
    mesh.positions = at;
    mesh.indices = corners;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    r.region_capacity = 1;
    r.regions = &region;
    r.vertex_regions = of;
    if (!CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) return;
    CHECK(sc_trace(model, &pose, NULL, 0, NULL, &t) == SC_OK && t.node_count == 0);
    CHECK(sc_trace_regions(model, &pose, &t, NULL, &r) == SC_OK && r.region_count == 1);
    CHECK(region.vertex_count == 4 && region.component == 0 && region.area == 1);
    for (int i = 0; i < 7; ++i) CHECK(of[i] == wanted[i]);
    sc_model_free(model);
}

/* A mesh of these triangles at these places, which are not to be welded; the caller frees it. */
static soup soup_of(const double *at, uint32_t vertices, const uint32_t *corners,
                    uint32_t triangles)
{
    soup s;
    memset(&s, 0, sizeof s);
    s.vertex_count = vertices;
    s.triangle_count = triangles;
    s.positions = (double *)test_allocate(3 * vertices * sizeof *s.positions);
    s.triangles = (uint32_t *)test_allocate(3 * triangles * sizeof *s.triangles);
    memcpy(s.positions, at, 3 * vertices * sizeof *s.positions);
    memcpy(s.triangles, corners, 3 * triangles * sizeof *s.triangles);
    return s;
}

/* ---- sizes ---- */

/* Regions of a mesh whose coordinates are 2^exponent times as large: all the same, areas that much
   larger; where these are beyond the range of doubles they are more than 0 still. So are contours'
   lengths. */
static void compare_sizes(const divided_scene *known, int exponent)
{
    soup larger = soup_copy(&known->s.mesh);
    divided_scene d;
    for (uint32_t i = 0; i < 3 * larger.vertex_count; ++i)
        larger.positions[i] = ldexp(larger.positions[i], exponent);
    if (!divide(&d, larger)) {
        undivide(&d);
        return;
    }
    if (CHECK(d.s.result.contour_count == known->s.result.contour_count))
        for (uint64_t i = 0; i < d.s.result.contour_count; ++i) {
            const double length = ldexp(known->s.result.contours[i].length, exponent);
            const double found = d.s.result.contours[i].length;
            CHECK_MSG(fabs(found - length) <= 1e-9 * length, "length %g instead of %g, sizes 2^%d",
                      found, length, exponent);
        }
    if (CHECK(d.regions.region_count == known->regions.region_count))
        for (uint32_t i = 0; i < d.regions.region_count; ++i) {
            const sc_region *a = &known->regions.regions[i], *b = &d.regions.regions[i];
            const double area = ldexp(a->area, 2 * exponent);
            CHECK_MSG(area < DBL_MAX ? fabs(b->area - area) <= 1e-9 * area : b->area > 0,
                      "area %g instead of %g, sizes 2^%d", b->area, area, exponent);
            CHECK_MSG(a->inside == b->inside && a->vertex_count == b->vertex_count &&
                          a->component == b->component,
                      "inside %" PRId32 " instead of %" PRId32 ", sizes 2^%d", b->inside, a->inside,
                      exponent);
        }
    undivide(&d);
}

/* Spheres, and three sheets through each other in large triangles. */
static void any_size(void)
{
    static const int exponents[] = {-1010, -480, -300, -250, -1, 1, 250, 300, 505, 900};
    static const double at[] = {-12, -10, 0,  12,  -11, 0,  0,  16,  1, /* the largest, z about 0 */
                                -3,  0,   -3, 3,   0,   -2, 0,  0.5, 4, /* in it two cross: y */
                                0,   6,   -6, 0.5, -7,  -6, -1, 0,   8}; /* x about 0 */
    static const uint32_t corners[] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    for (int kind = 0; kind < 2; ++kind) {
        divided_scene d;
        uint32_t vertices, triangles;
        if (divide(&d, kind ? soup_of(at, 9, corners, 3)
                            : two_spheres(10, 0.5, 0.7, &vertices, &triangles)))
            for (size_t i = 0; i < sizeof exponents / sizeof *exponents; ++i)
                compare_sizes(&d, exponents[i]);
        undivide(&d);
    }
}

/* A contour that is longer than any double: of a triangle in z = 0 and one in y = 0. */
static void endless_contour(void)
{
    static const double at[] = {-1.7e308, -1e308,  0,      1.7e308,  -1e308, 0,
                                0,        1.7e308, 0,      -1.7e308, 0,      -1e308,
                                1.7e308,  0,       -1e308, 0,        0,      1.7e308};
    static const uint32_t corners[] = {0, 1, 2, 3, 4, 5};
    for (int turn = 0; turn < 3; ++turn) { /* along each axis */
        double turned[18];
        trace_scene s;
        for (int i = 0; i < 18; ++i) turned[i - i % 3 + (i + turn) % 3] = at[i];
        if (trace_scene_open(&s, soup_of(turned, 6, corners, 2), SC_MODEL_FULL))
            CHECK(s.result.contour_count == 1 && s.result.contours[0].count == 2 &&
                  s.result.contours[0].length == HUGE_VAL);
        trace_scene_close(&s);
    }
}

/* Areas of single triangles near the ends of the range of doubles, by hand. */
static void areas_of_triangles(void)
{
    static const struct {
        double at[9], area;
    } cases[] = {
        {{0, 0, 0, 3, 0, 0, 0, 4, 0}, 6},
        {{0, 0, 0, 0x1p1000, 0, 0, 0, 0x1p-1000, 0}, 0.5},
        {{0, 0, 0, 0x1p-520, 0, 0, 0, 0x1p-520, 0}, 0x1p-1041},
        {{0, 0, 0, 0, 0x1p511, 0, 0, 0, 0x1p512}, 0x1p1022},
        {{0, 0x1p-600, 0, 0, 0, 0x1p-400, 0, 0, 0}, 0x1p-1001},
        {{-0x1.8p1023, 0, 0, 0x1.8p1023, 0, 0, 0, 0x1p-1000, 0}, 0x1.8p23},
        {{0, 0, 0, 0x1p-1074, 0, 0, 0, 0x1p1000, 0}, 0x1p-75},
        {{0, 0, 0, 0x1p-1074, 0, 0, 0, 0x1p10, 0}, 0x1p-1065},
        {{-DBL_MAX, 0, 0, DBL_MAX, 0, 0, 0, 0x1p-1074, 0}, 0x1p-50},
        {{0, 0, 0, 0x1p600, 0x1p600, 0, 0x1p-600, -0x1p-600, 0}, 1},
        {{0, 0, 0, 0x1p600, 0, 0, 0, 0x1p600, 0}, DBL_MAX},
        {{0, 0, 0, 0x1p600, 0, 0, -0x1p600, 0, 0}, 0},
        {{0x1p-600, 0, 0, 0x1p-600, 0, 0, 0x1p-600, 0, 0}, 0},
        {{0, 0, 0, 0x1p-300, 0x1p-320, 0, 0x1p-300, 0, 0}, 0x1p-621},
    };
    static const uint32_t corners[] = {0, 1, 2};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        sc_mesh mesh;
        soup s = soup_of(cases[i].at, 3, corners, 1);
        const sc_pose pose = input_plain_pose(s.positions, 3);
        sc_build_options options;
        sc_model *model = NULL;
        sc_trace_result t = trace_scene_no_room();
        sc_regions_result r = no_regions();
        sc_region region;
        memset(&options, 0, sizeof options);
        options.struct_size = sizeof options;
        options.weld = SC_WELD_NONE;
        r.region_capacity = 1;
        r.regions = &region;
        mesh = input_plain_mesh(&s);
        if (!CHECK(sc_build(&mesh, &options, &model) == SC_OK)) return;
        CHECK(sc_trace_regions(model, &pose, &t, NULL, &r) == SC_OK && r.region_count == 1);
        CHECK_MSG(fabs(region.area - cases[i].area) <= 1e-15 * cases[i].area, "%g instead of %g",
                  region.area, cases[i].area);
        sc_model_free(model);
        soup_free(&s);
    }
}

/* ---- what welding has collapsed ---- */

/* A triangle; one that has collapsed and hangs on it by a vertex; one that does so by none; and one
   that does so by an edge. */
static void vertices_of_collapsed_triangles(void)
{
    static const double at[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 6, 6, 6, 7, 7, 7};
    static const uint32_t corners[] = {0, 1, 2, 1, 3, 3, 4, 5, 5, 1, 2, 2};
    static const uint32_t wanted[6] = {
        0, 0, 0, SC_TRACE_NO_EDGE, SC_TRACE_NO_EDGE, SC_TRACE_NO_EDGE};
    soup s = soup_of(at, 6, corners, 4);
    const sc_pose pose = input_plain_pose(s.positions, 6);
    sc_mesh mesh = input_plain_mesh(&s);
    sc_model *model = NULL;
    sc_trace_result t = trace_scene_no_room();
    sc_trace_node nodes[2];
    sc_trace_contour contour;
    sc_regions_result r = no_regions();
    sc_region region;
    uint32_t of[6];
    const sc_pair pairs[] = {{0, 2}, {6, 0}};
    r.region_capacity = 1;
    r.regions = &region;
    r.vertex_regions = of;
    if (CHECK(sc_build(&mesh, NULL, &model) == SC_OK)) {
        CHECK(sc_trace_regions(model, &pose, &t, NULL, &r) == SC_OK && r.region_count == 1);
        CHECK(region.vertex_count == 3 && region.component == 0 && region.area == 0.5);
        for (int i = 0; i < 6; ++i) CHECK_MSG(of[i] == wanted[i], "%d: %" PRIu32, i, of[i]);
        /* a contour through an edge that no sheet has */
        memset(nodes, 0, sizeof nodes);
        memset(&contour, 0, sizeof contour);
        nodes[0].edge = nodes[1].edge = 6;
        nodes[0].sheets[0] = nodes[0].sheets[1] = 2;
        nodes[1].sheets[0] = nodes[1].sheets[1] = SC_TRACE_NO_EDGE;
        contour.begin = contour.end = SC_TRACE_BORDER;
        contour.count = t.node_count = t.node_capacity = 2;
        t.contour_count = t.contour_capacity = 1;
        t.nodes = nodes;
        t.contours = &contour;
        CHECK(sc_trace_regions(model, &pose, &t, NULL, &r) == SC_ERROR_PAIRS &&
              r.region_count == 0);
        /* not finite: vertices of collapsed triangles too */
        t = trace_scene_no_room();
        s.positions[3 * 5 + 1] = (double)NAN;
        CHECK(sc_trace(model, &pose, pairs, 1, NULL, &t) == SC_ERROR_NOT_FINITE);
        CHECK(sc_trace(model, &pose, pairs + 1, 1, NULL, &t) == SC_ERROR_NOT_FINITE);
        CHECK(sc_trace_regions(model, &pose, &t, NULL, &r) == SC_ERROR_NOT_FINITE);
        s.positions[3 * 5 + 1] = 7;
        CHECK(sc_trace(model, &pose, pairs, 2, NULL, &t) == SC_OK && t.node_count == 0);
    }
    sc_model_free(model);
    soup_free(&s);
}

SC_TEST_MAIN(SC_TEST(any_size), SC_TEST(endless_contour), SC_TEST(areas_of_triangles),
             SC_TEST(vertices_of_collapsed_triangles), SC_TEST(welded_vertices),
             SC_TEST(spheres_through_each_other), SC_TEST(planes_through_spheres),
             SC_TEST(loops_in_a_triangle), SC_TEST(loops_by_hand), SC_TEST(equal_regions),
             SC_TEST(any_meshes), SC_TEST(strips))
