/*
 * Adversaries: poses made to sit on the edge of each step that skips work (adversaries.h), against
 * the oracle. Every method, rest pose alike or not, in several partitions; and every node of the
 * test tree by itself, so that a test that passes in spite of a pair shows even where no query
 * relies on it.
 *
 * The notes say how many nodes passed and failed at the steps aimed at; both must occur.
 *
 * SPDX-License-Identifier: MIT
 */
#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "adversaries.h"
#include "harness.h"
#include "inputs.h"
#include "oracle.h"
#include "pose/contour_bounds.h"
#include "pose/dnc.h"
#include "pose/positions.h"
#include "pose/refit.h"
#include "posed_model.h"
#include "query/simple.h"
#include "query/star.h"
#include "run/workspace.h"
#include "simd/isa.h"
#include "starcontour.h"

/* What came of the cases of a test. */
typedef struct tally {
    uint64_t cases, hits, queries;
    uint64_t turned, passed, failed;     /* nodes, by orientation test and star test */
    uint64_t simple;                     /* passed the exact contour test */
    uint64_t touching_passed, colliding; /* of the passed and of the failed */
    uint64_t roots_passed, roots_failed; /* the adversary as one node */
    uint64_t rows;                       /* sides of boxes of triangles */
} tally;

typedef struct way {
    const char *name;
    uint32_t method, contour, rest_cache, simd;
} way;

static const way ways[] = {
    {"exact", SC_METHOD_SCTT, SC_CONTOUR_EXACT, SC_REST_CACHE_ON, 0},
    {"star", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_ON, 0},
    {"star, no cache", SC_METHOD_SCTT, SC_CONTOUR_STAR, SC_REST_CACHE_OFF, 0},
    {"aabb sctt", SC_METHOD_AABB_SCTT, 0, SC_REST_CACHE_ON, 0},
    {"aabb", SC_METHOD_AABB, 0, SC_REST_CACHE_ON, 0},
    {"exact, base", SC_METHOD_SCTT, SC_CONTOUR_EXACT, 0, SC_SIMD_BASE},
    {"aabb, base", SC_METHOD_AABB, 0, 0, SC_SIMD_BASE}};

enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

/* A model of an adversary, and its pose. */
typedef struct scene {
    const char *name;
    uint64_t state; /* of the random numbers, before the adversary was made */
    const adversary *a;
    const input_choices *choices;
    const oracle_answer *answer;
    sc_pose pose;
    sc_model *model;
    sc_workspace *workspace;
} scene;

static void print_mesh(const scene *s)
{
    const soup *m = &s->a->mesh;
    if (test_failures() > 2) return;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const double *p = m->positions + 3 * (size_t)v;
        printf("    vertex %" PRIu32 ": %a %a %a\n", v, p[0], p[1], p[2]);
    }
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        const uint32_t *c = m->triangles + 3 * (size_t)t;
        printf("    triangle %" PRIu32 ": %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", t, c[0], c[1],
               c[2]);
    }
}

/* ---- queries ---- */

static void check_queries(const scene *s, tally *t)
{
    for (uint32_t i = 0; i < 4 * WAYS; ++i) {
        const way *w = &ways[i / 4];
        const oracle_list *right = &s->answer->lists[i & 1][i >> 1 & 1];
        sc_pair *pairs = (sc_pair *)test_allocate((right->count + 1) * sizeof(sc_pair));
        sc_query_options options;
        sc_result result;
        uint64_t same = 0;
        sc_status status;
        memset(&options, 0, sizeof(options));
        memset(&result, 0, sizeof(result));
        options.struct_size = sizeof(options);
        options.pairs = i & 1;
        options.contact = i >> 1 & 1;
        options.method = w->method;
        options.contour = w->contour;
        options.simd = w->simd;
        options.rest_cache = w->rest_cache;
        result.struct_size = sizeof(result);
        result.capacity = right->count + 1;
        result.pairs = pairs;
        status = sc_query(s->model, s->workspace, &s->pose, &options, &result);
        while (same < right->count && same < result.count &&
               pairs[same].a == right->pairs[same].a && pairs[same].b == right->pairs[same].b)
            ++same;
        if (!CHECK_MSG(status == SC_OK && result.count == right->count && same == right->count,
                       "%s, %s, partition %s, pairs %" PRIu32 ", contact %" PRIu32 ": %" PRIu64
                       " pairs instead of %" PRIu64 ", the first %" PRIu64
                       " alike; the adversary's random state %" PRIu64,
                       s->name, w->name, s->choices->partition_name, i & 1, i >> 1 & 1,
                       result.count, right->count, same, s->state))
            print_mesh(s);
        free(pairs);
        ++t->queries;
    }
}

/* ---- single nodes ---- */

static void check_nodes(const scene *s, sc_pair *pairs, uint64_t count, tally *t)
{
    const sc_model *m = s->model;
    sc_worker *w = s->workspace->worker;
    uint32_t wrong = 0;
    for (uint32_t node = 0; node < m->node_count; ++node) {
        const sc_pair *patches = &sc_model_node(m)[node].patches;
        uint32_t mask =
            (uint32_t)s->workspace->frame.mask[patches->a] & s->workspace->frame.mask[patches->b];
        int bad = posed_model_has_pair(m, node, 0, pairs, count),
            worse = posed_model_has_pair(m, node, 1, pairs, count);
        t->turned += mask == 0;
        for (int tries = 0; tries < 2 && mask != 0; ++tries) {
            sc_projection projection;
            int passed;
            sc_dnc_projection(&s->workspace->frame, tries ? test_random_part(mask) : mask,
                              &projection);
            sc_contour_bounds_begin(m, &w->frame->positions[0], &projection, w->bounds);
            passed = sc_star_test(w, node);
            wrong += (uint32_t)(passed && bad);
            t->simple += (uint64_t)sc_simple_test(w, &projection, node);
            wrong += (uint32_t)(worse && sc_simple_test(w, &projection, node));
            *(passed ? &t->passed : &t->failed) += 1;
            if (node == 0) *(passed ? &t->roots_passed : &t->roots_failed) += 1;
            t->touching_passed +=
                (uint64_t)(passed && sc_model_node(m)[node].kind & SC_NODE_TOUCHES);
            t->colliding += (uint64_t)bad;
        }
    }
    if (!CHECK_MSG(wrong == 0,
                   "%s, partition %s: %" PRIu32 " nodes pass in spite of a pair; the adversary's "
                   "random state %" PRIu64,
                   s->name, s->choices->partition_name, wrong, s->state))
        print_mesh(s);
}

/* Whether a point, moved and scaled as boxes are, is within bounds: exactly. */
static int is_between(const sc_workspace *w, uint32_t point, uint32_t k, float low, float high)
{
    mpq_t x, y;
    int within;
    double at[3];
    sc_positions_get(&w->frame.positions[0], point, at);
    mpq_inits(x, y, NULL);
    mpq_set_d(x, at[k]);
    mpq_set_d(y, w->frame.center[k]);
    mpq_sub(x, x, y);
    mpq_set_d(y, w->frame.scale);
    mpq_mul(x, x, y);
    mpq_set_d(y, (double)low);
    within = mpq_cmp(y, x) <= 0;
    mpq_set_d(y, (double)high);
    within &= mpq_cmp(x, y) <= 0;
    mpq_clears(x, y, NULL);
    return within;
}

/* Boxes hold their triangles' corners, which are doubles. */
static void check_boxes(const scene *s)
{
    const sc_model *m = s->model;
    sc_workspace *w = s->workspace;
    uint32_t wrong = 0;
    sc_refit_boxes(m, &w->frame);
    for (uint32_t leaf = 0; leaf < m->leaf_count; ++leaf)
        for (uint32_t i = sc_model_leaf_first(m)[leaf]; i < sc_model_leaf_first(m)[leaf + 1]; ++i)
            for (uint32_t c = 0; c < 9; ++c) {
                uint32_t k = c % 3;
                uint32_t patch = sc_model_first_leaf_patch(m) + leaf;
                uint32_t p = sc_model_triangle(m)[3 * i + c / 3];
                wrong += !is_between(w, p, k, w->frame.patch_boxes.side[k][patch],
                                     w->frame.patch_boxes.side[k + 3][patch]);
            }
    if (!CHECK_MSG(wrong == 0,
                   "%s: %" PRIu32 " bounds of boxes; the adversary's random state "
                   "%" PRIu64,
                   s->name, wrong, s->state))
        print_mesh(s);
}

/* The same of the boxes of triangles that the queries before have left. */
static void check_rows(const scene *s, tally *t)
{
    const sc_model *m = s->model;
    const sc_workspace *w = s->workspace;
    uint32_t wrong = 0;
    for (uint32_t kept = 0;
         kept < (w->worker->kept.mask == SC_KEEPS_ALL ? m->leaf_count : w->worker->kept.spare + 1);
         ++kept) {
        const sc_leaf_derived *derived = &w->worker->kept.derived[kept];
        const uint32_t *first = sc_model_leaf_first(m) + w->worker->kept.known[kept].leaf;
        if (w->worker->kept.known[kept].epoch != w->frame.epoch) continue;
        for (uint32_t c = 0; c < 9 * (first[1] - first[0]); ++c, ++t->rows) {
            uint32_t i = c / 9, k = c % 3, p = sc_model_triangle(m)[3 * first[0] + c / 3];
            wrong += !is_between(w, p, k, derived->side[k][i], derived->side[k + 3][i]);
        }
        for (uint32_t i = first[1] - first[0]; i < SC_LEAF_MAX; ++i)
            for (uint32_t k = 0; k < 6; ++k) wrong += isnan(derived->side[k][i]) ? 0 : 1;
    }
    if (!CHECK_MSG(wrong == 0,
                   "%s: %" PRIu32 " sides of triangles; the adversary's random state %" PRIu64,
                   s->name, wrong, s->state))
        print_mesh(s);
}

/* Cones, boxes and fans are the same bit for bit whatever instructions computed them. */
static void check_instructions(const scene *s)
{
    const sc_model *m = s->model;
    sc_workspace *w = s->workspace;
    size_t points = (size_t)4 * SC_LEAF_POINTS * m->leaf_count, wrong = 0;
    float *point_at = (float *)test_allocate(points * sizeof(float));
    uint16_t *mask = (uint16_t *)test_allocate(m->patch_end * sizeof(uint16_t));
    float *box[6];
    for (uint32_t isa = SC_ISA_BASE; isa <= (uint32_t)sc_isa_best(); ++isa) {
        w->frame.kernels = sc_kernels_for(isa);
        sc_workspace_begin(m, w, &posed_model_nothing_asked);
        sc_dnc_update(m, &w->frame);
        sc_refit_boxes(m, &w->frame);
        if (isa == SC_ISA_BASE) memcpy(mask, w->frame.mask, m->patch_end * sizeof(uint16_t));
        wrong += memcmp(mask, w->frame.mask, m->patch_end * sizeof(uint16_t)) != 0;
        if (isa == SC_ISA_BASE) memcpy(point_at, w->frame.point_at, points * sizeof(float));
        wrong += memcmp(point_at, w->frame.point_at, points * sizeof(float)) != 0;
        for (int k = 0; k < 6; ++k) {
            if (isa == SC_ISA_BASE) {
                box[k] = (float *)test_allocate(m->patch_end * sizeof(float));
                memcpy(box[k], w->frame.patch_boxes.side[k], m->patch_end * sizeof(float));
            }
            wrong +=
                memcmp(box[k], w->frame.patch_boxes.side[k], m->patch_end * sizeof(float)) != 0;
        }
    }
    if (!CHECK_MSG(wrong == 0, "%s: %zu arrays differ; the adversary's random state %" PRIu64,
                   s->name, wrong, s->state))
        print_mesh(s);
    for (int k = 0; k < 6; ++k) free(box[k]);
    free(point_at);
    free(mask);
}

static void check_parts(const scene *s, tally *t)
{
    const oracle_list *list = &s->answer->lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    uint32_t count = s->model->triangle_count;
    uint32_t *place = (uint32_t *)test_allocate(count * sizeof(uint32_t));
    sc_pair *pairs = (sc_pair *)test_allocate((list->count + 1) * sizeof(sc_pair));
    sc_workspace_begin(s->model, s->workspace, &posed_model_nothing_asked);
    if (CHECK(sc_positions_read(s->model, &s->pose, 24, &s->workspace->frame) == SC_OK)) {
        for (uint32_t i = 0; i < count; ++i) place[sc_model_triangle_id(s->model)[i]] = i;
        for (uint64_t i = 0; i < list->count; ++i) {
            pairs[i].a = place[list->pairs[i].a];
            pairs[i].b = place[list->pairs[i].b];
        }
        check_instructions(s);
        sc_dnc_update(s->model, &s->workspace->frame);
        check_boxes(s);
        check_nodes(s, pairs, list->count, t);
    }
    free(pairs);
    free(place);
}

/* ---- one adversary ---- */

/* A partition in which the first triangles are a node of their own, and so are the others. */
static input_choices choose_split(const adversary *a)
{
    uint32_t count = a->mesh.triangle_count;
    input_choices c = input_choose(&a->mesh, SC_WELD_NONE, SC_PARTITION_ORDER);
    for (uint32_t t = 0; t < count; ++t) c.order[t] = t;
    c.partition_name = "own order";
    if (a->split == 0 || a->split >= count) return c;
    c.tree = (sc_tree_node *)test_allocate(3 * sizeof(sc_tree_node));
    memset(c.tree, 0, 3 * sizeof(sc_tree_node));
    c.tree[0].left = 1;
    c.tree[0].right = 2;
    for (int n = 1; n < 3; ++n) c.tree[n].left = c.tree[n].right = SC_NONE;
    c.tree[1].count = c.tree[2].first = a->split;
    c.tree[2].count = count - a->split;
    c.options.partition = SC_PARTITION_TREE;
    c.options.tree = c.tree;
    c.options.tree_count = 3;
    c.partition_name = "own tree";
    return c;
}

/* Builds from the pose itself, or from what the adversary was before it was dressed. */
static void check_build(scene *s, const soup *rest, const input_choices *choices, tally *t)
{
    sc_mesh input = input_plain_mesh(rest);
    s->choices = choices;
    s->model = NULL;
    s->workspace = NULL;
    if (CHECK(sc_build(&input, &choices->options, &s->model) == SC_OK) &&
        CHECK(sc_workspace_create(s->model, NULL, &s->workspace) == SC_OK)) {
        input_array floats;
        check_parts(s, t);
        memset(&floats, 0, sizeof(floats));
        if (s->a->type == SC_FLOAT) { /* the same numbers as floats */
            floats = input_positions(s->a->mesh.positions, s->a->mesh.vertex_count, SC_FLOAT, 0);
            s->pose = input_pose(s->a->mesh.vertex_count, &floats);
        }
        check_queries(s, t);
        check_rows(s, t);
        s->pose = input_plain_pose(s->a->mesh.positions, s->a->mesh.vertex_count);
        input_free(&floats);
    }
    sc_workspace_free(s->workspace);
    sc_model_free(s->model);
}

/* Takes the adversary. */
static void check_adversary(const char *name, uint64_t state, adversary a, tally *t)
{
    static const uint32_t welds[] = {SC_WELD_NONE, SC_WELD_NONE, SC_WELD_MAP, SC_WELD_REST};
    uint32_t weld = welds[test_random_below(4)], own_rest = test_random_below(2);
    soup before = soup_copy(&a.mesh);
    input_choices choices[2];
    oracle_answer answer;
    scene s;
    uint32_t *map;
    memset(&s, 0, sizeof(s));
    adversary_dress(&a);
    if (own_rest) soup_smooth(before.positions, before.vertex_count, 0.1);
    choices[0] = choose_split(&a);
    choices[1] = input_choose(&a.mesh, SC_WELD_NONE, test_random_below(4));
    for (int i = 0; i < 2; ++i) choices[i].options.weld = weld;
    if (weld == SC_WELD_MAP) { /* each twin may become one with its other; chains are followed */
        uint32_t *weld_map = (uint32_t *)test_allocate(a.mesh.vertex_count * sizeof(uint32_t));
        for (uint32_t v = 0; v < a.mesh.vertex_count; ++v) {
            uint32_t u = a.twin[v];
            weld_map[v] = u != SC_NONE && u < v && test_random_below(2) ? weld_map[u] : v;
        }
        for (int i = 0; i < 2; ++i) choices[i].options.weld_map = weld_map;
        choices[0].weld_map = weld_map;
    }
    map = input_weld_of(&choices[0], own_rest ? &before : &a.mesh);
    oracle_solve(a.mesh.positions, a.mesh.vertex_count, a.mesh.triangles, a.mesh.triangle_count,
                 map, &answer);
    s.name = name;
    s.state = state;
    s.a = &a;
    s.answer = &answer;
    s.pose = input_plain_pose(a.mesh.positions, a.mesh.vertex_count);
    for (int i = 0; i < 2; ++i) check_build(&s, own_rest ? &before : &a.mesh, &choices[i], t);
    for (int i = 0; i < 2; ++i) input_free_choices(&choices[i]);
    ++t->cases;
    t->hits += answer.lists[0][0].count != 0;
    oracle_free(&answer);
    free(map);
    soup_free(&before);
    adversary_free(&a);
}

static tally try_many(const char *name, adversary (*make)(void), uint32_t rounds)
{
    tally t;
    memset(&t, 0, sizeof(t));
    rounds = test_iterations(rounds);
    for (uint32_t i = 0; i < rounds; ++i) {
        uint64_t state = test_random_state();
        check_adversary(name, state, make(), &t);
    }
    return t;
}

/* Both outcomes of the star test, and adversaries with pairs and without. */
static void report(const tally *t)
{
    test_note("%" PRIu64 " cases (%" PRIu64 " with pairs), %" PRIu64 " queries; nodes: %" PRIu64
              " not oriented, contour passed %" PRIu64 " (%" PRIu64
              " at one point), failed %" PRIu64 ", simple %" PRIu64 "; whole: passed %" PRIu64
              ", failed %" PRIu64,
              t->cases, t->hits, t->queries, t->turned, t->passed, t->touching_passed, t->failed,
              t->simple, t->roots_passed, t->roots_failed);
}

static void check_both(const tally *t)
{
    report(t);
    CHECK(!test_is_full() || (t->hits > 20 && t->cases - t->hits > 20));
    CHECK(!test_is_full() || (t->roots_passed > 20 && t->roots_failed > 20 && t->colliding > 20));
}

static void slit_discs(void)
{
    tally t = try_many("slit disc", adversary_slit, 630);
    check_both(&t);
}

static void closing_strips(void)
{
    tally t = try_many("strip", adversary_strip, 489);
    report(&t);
    CHECK(!test_is_full() || (t.roots_failed > 100 && t.passed > 1000 && t.hits > 20));
}

static void pinched_petals(void)
{
    tally t = try_many("petals", adversary_petals, 630);
    report(&t);
    CHECK(!test_is_full() ||
          (t.touching_passed > 100 && t.roots_failed > 100 && t.colliding > 100));
}

static void doubled_cloths(void)
{
    tally t = try_many("doubled cloth", adversary_doubled, 420);
    report(&t);
    CHECK(!test_is_full() || (t.passed > 100 && t.failed > 100 && t.colliding > 100));
}

static void near_vertical_sides(void)
{
    tally t = try_many("upright", adversary_upright, 630);
    check_both(&t);
}

static void shallow_cloths(void)
{
    tally t = try_many("shallow", adversary_shallow, 70);
    report(&t);
    CHECK(!test_is_full() || t.rows > 1000);
}

static void sheets_an_ulp_apart(void)
{
    tally t = try_many("sheets", adversary_sheets, 350);
    report(&t);
    CHECK(!test_is_full() || (t.hits > 50 && t.cases - t.hits > 50 && t.passed > 100));
}

static void degenerate_cloths(void)
{
    tally t = try_many("degenerate cloth", adversary_degenerate, 350);
    report(&t);
    CHECK(!test_is_full() || (t.passed > 50 && t.failed > 50));
}

static void one_sided_bands(void)
{
    tally t = try_many("moebius", adversary_moebius, 140);
    report(&t);
    CHECK(!test_is_full() || (t.hits > 5 && t.cases - t.hits > 20));
}

static void klein_bottles(void)
{
    tally t = try_many("klein", adversary_klein, 28);
    report(&t);
    CHECK(!test_is_full() || t.hits > 25);
}

static void books_of_triangles(void)
{
    tally t = try_many("book", adversary_book, 450);
    report(&t);
    CHECK(!test_is_full() || (t.hits > 50 && t.cases - t.hits > 25));
}

static void rings_round_a_point(void)
{
    tally t = try_many("ring", adversary_ring, 630);
    report(&t);
    CHECK(!test_is_full() || t.rows > 1000);
}

static void touching_corners(void)
{
    tally t = try_many("corners", adversary_corners, 630);
    report(&t);
    CHECK(!test_is_full() || (t.hits > 100 && t.cases - t.hits > 100));
}

static void touching_faces(void)
{
    tally t = try_many("faces", adversary_faces, 840);
    report(&t);
    CHECK(!test_is_full() || t.hits > 100);
}

/* ---- normals at right angles to a direction ---- */

static double edge_direction[3];

static adversary make_edge_on(void)
{
    return adversary_edge_on(edge_direction);
}

static void sheets_seen_edge_on(void)
{
    tally all;
    memset(&all, 0, sizeof(all));
    for (uint32_t bit = 0; bit < SC_DNC_DIRECTIONS; ++bit) {
        static const double half[7][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 1},
                                          {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
        tally t;
        for (int k = 0; k < 3; ++k) edge_direction[k] = bit < 7 ? half[bit][k] : -half[bit - 7][k];
        t = try_many("edge on", make_edge_on, 28);
        all.cases += t.cases;
        all.hits += t.hits;
        all.queries += t.queries;
        all.turned += t.turned;
        all.passed += t.passed;
        all.failed += t.failed;
        all.roots_passed += t.roots_passed;
        all.roots_failed += t.roots_failed;
    }
    report(&all);
    CHECK(!test_is_full() || (all.passed > 100 && all.failed > 100));
}

SC_TEST_MAIN(SC_TEST(slit_discs), SC_TEST(closing_strips), SC_TEST(pinched_petals),
             SC_TEST(doubled_cloths), SC_TEST(near_vertical_sides), SC_TEST(shallow_cloths),
             SC_TEST(sheets_an_ulp_apart), SC_TEST(degenerate_cloths), SC_TEST(one_sided_bands),
             SC_TEST(klein_bottles), SC_TEST(books_of_triangles), SC_TEST(rings_round_a_point),
             SC_TEST(touching_corners), SC_TEST(touching_faces), SC_TEST(sheets_seen_edge_on))
