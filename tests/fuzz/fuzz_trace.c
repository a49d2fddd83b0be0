/*
 * Fuzz target: sc_trace, sc_trace_triples, sc_trace_gradients and sc_trace_regions. A small mesh,
 * or two or three that are the same, built in some way, in poses of any coordinates. What is found
 * is held against the oracle's crossings and against what is true of all contours and regions; then
 * with arrays too short, memory that runs out, pairs and contours that were tampered with, and
 * coordinates that are no numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "fuzz_support.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "simd/isa.h"
#include "trace_checks.h"
#include "trace_oracle.h"

/* The oracle's numbers are long where exponents differ much: it gets fewer triangles then. */
enum { MOST_POSES = 3, MOST_TRIANGLES = 60, MOST_WIDE_TRIANGLES = 10 };

typedef struct fuzz_subject {
    soup mesh;
    uint32_t *triangles; /* after welding */
    double *positions;
    sc_pose pose;
    sc_model *model;
    sc_workspace *workspace;
    uint32_t simd;
} fuzz_subject;

static sc_trace_options plain_options(uint32_t simd)
{
    sc_trace_options o;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.simd = simd;
    return o;
}

static void forbid(const char *what, sc_status status)
{
    FUZZ_CHECK(0, "%s: %s", what, sc_status_string(status));
}

/* ---- contours ---- */

/* Arrays of exactly so many entries, unset. */
static sc_trace_result room_for(uint64_t nodes, uint64_t contours)
{
    sc_trace_result r;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    r.reserved = 7;
    r.node_count = r.contour_count = 77;
    r.node_capacity = nodes;
    r.contour_capacity = contours;
    r.nodes = (sc_trace_node *)test_allocate((size_t)nodes * sizeof *r.nodes);
    r.contours = (sc_trace_contour *)test_allocate((size_t)contours * sizeof *r.contours);
    memset(r.nodes, 0xa5, (size_t)nodes * sizeof *r.nodes);
    memset(r.contours, 0xa5, (size_t)contours * sizeof *r.contours);
    return r;
}

static void free_trace(sc_trace_result *r)
{
    free(r->nodes);
    free(r->contours);
}

static int are_same(const sc_trace_result *a, const sc_trace_result *b)
{
    return a->node_count == b->node_count && a->contour_count == b->contour_count &&
           memcmp(a->nodes, b->nodes, (size_t)a->node_count * sizeof *a->nodes) == 0 &&
           memcmp(a->contours, b->contours, (size_t)a->contour_count * sizeof *a->contours) == 0;
}

static sc_result find_pairs(const fuzz_subject *s)
{
    const sc_query_options o = input_query(SC_PAIRS_EDGE, SC_CONTACT_TOUCHING, SC_METHOD_DEFAULT);
    sc_result r;
    sc_status status;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    sc_query(s->model, s->workspace, &s->pose, &o, &r);
    r.capacity = r.count;
    r.pairs = (sc_pair *)test_allocate((size_t)r.count * sizeof *r.pairs);
    status = sc_query(s->model, s->workspace, &s->pose, &o, &r);
    FUZZ_CHECK(status == SC_OK, "a good pose: %s", sc_status_string(status));
    return r;
}

static sc_trace_result trace_all(const fuzz_subject *s, const sc_result *pairs)
{
    sc_trace_result none = room_for(0, 0), r;
    sc_status status = sc_trace(s->model, &s->pose, pairs->pairs, pairs->count, NULL, &none);
    FUZZ_CHECK(status == (none.node_count ? SC_ERROR_SHORT_BUFFER : SC_OK) && !none.reserved &&
                   !none.node_count == !none.contour_count,
               "%s, %" PRIu64 " nodes", sc_status_string(status), none.node_count);
    r = room_for(none.node_count, none.contour_count);
    status = sc_trace(s->model, &s->pose, pairs->pairs, pairs->count, NULL, &r);
    FUZZ_CHECK(status == SC_OK && r.node_count == none.node_count &&
                   r.contour_count == none.contour_count,
               "%s, %" PRIu64 " nodes instead of %" PRIu64, sc_status_string(status), r.node_count,
               none.node_count);
    free_trace(&none);
    return r;
}

/* The same again: other instructions, memory that may run out, arrays that may be short. */
static void trace_again(fuzz_bytes *bytes, const fuzz_subject *s, const sc_result *pairs,
                        const sc_trace_result *known)
{
    const uint64_t nodes = fuzz_number(bytes, 2) % (known->node_count + 2);
    const uint64_t contours = fuzz_byte(bytes) % (known->contour_count + 2);
    const uint32_t countdown = fuzz_byte(bytes);
    fuzz_memory memory;
    const sc_allocator allocator = fuzz_allocator(&memory, countdown % 64);
    sc_trace_options o = plain_options(s->simd);
    sc_trace_result r = room_for(known->node_count, known->contour_count);
    sc_status status;
    if (countdown >= 128) o.allocator = &allocator;
    status = sc_trace(s->model, &s->pose, pairs->pairs, pairs->count, &o, &r);
    FUZZ_CHECK(status == (memory.refused ? SC_ERROR_MEMORY : SC_OK) && memory.live == 0 &&
                   (status ? !r.node_count && !r.contour_count : are_same(known, &r)),
               "%s, %" PRIu64 " nodes", sc_status_string(status), r.node_count);
    free_trace(&r);
    r = room_for(nodes, contours);
    status = sc_trace(s->model, &s->pose, pairs->pairs, pairs->count, NULL, &r);
    FUZZ_CHECK(status == (nodes < known->node_count || contours < known->contour_count
                              ? SC_ERROR_SHORT_BUFFER
                              : SC_OK) &&
                   r.node_count == known->node_count && r.contour_count == known->contour_count,
               "%s, room for %" PRIu64 " nodes and %" PRIu64 " contours", sc_status_string(status),
               nodes, contours);
    free_trace(&r);
}

/* Pairs that are missing, exchanged, there twice, or any other ones. If they are sorted and exist,
   contours may still fit together; then they are no more than room was asked for. */
static void trace_wrong_pairs(fuzz_bytes *bytes, const fuzz_subject *s, const sc_result *pairs)
{
    const uint32_t kind = fuzz_byte(bytes) % 4;
    sc_pair *wrong = (sc_pair *)test_allocate(((size_t)pairs->count + 1) * sizeof *wrong);
    uint64_t count = pairs->count, at = fuzz_number(bytes, 2);
    sc_trace_result r, again;
    sc_status status;
    if (count) memcpy(wrong, pairs->pairs, (size_t)count * sizeof *wrong);
    if (count) at %= count;
    if (kind == 0 && count) {
        memmove(wrong + at, wrong + at + 1, (size_t)(count - at - 1) * sizeof *wrong);
        --count;
    } else if (kind == 1 && count) {
        const sc_pair p = wrong[at];
        wrong[at] = wrong[count - 1];
        wrong[count - 1] = p;
    } else if (kind == 2 && count) {
        memmove(wrong + at + 1, wrong + at, (size_t)(count - at) * sizeof *wrong);
        ++count;
    } else {
        sc_pair *p = &wrong[count ? at : count++];
        p->a = (uint32_t)fuzz_number(bytes, fuzz_byte(bytes) % 5);
        p->b = (uint32_t)fuzz_number(bytes, fuzz_byte(bytes) % 5);
    }
    r = room_for(0, 0);
    status = sc_trace(s->model, &s->pose, wrong, count, NULL, &r);
    if (status == SC_ERROR_PAIRS)
        FUZZ_CHECK(!r.node_count && !r.contour_count, "%" PRIu64 " nodes", r.node_count);
    else if (status != SC_OK && status != SC_ERROR_SHORT_BUFFER)
        forbid("wrong pairs", status);
    again = room_for(r.node_count, r.contour_count);
    if (status != SC_ERROR_PAIRS) {
        status = sc_trace(s->model, &s->pose, wrong, count, NULL, &again);
        FUZZ_CHECK(status == SC_OK && again.node_count == r.node_count &&
                       again.contour_count == r.contour_count,
                   "%s, %" PRIu64 " nodes", sc_status_string(status), again.node_count);
    }
    free_trace(&again);
    free_trace(&r);
    free(wrong);
}

/* ---- regions ---- */

static sc_regions_result regions_room(const fuzz_subject *s, uint32_t flags, uint64_t regions,
                                      uint64_t contours)
{
    const size_t sizes[3] = {(size_t)regions * sizeof(sc_region),
                             s->mesh.vertex_count * sizeof(uint32_t),
                             (size_t)contours * sizeof(sc_contour_sides)};
    sc_regions_result r;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    r.flags = flags;
    r.region_count = 77;
    r.region_capacity = regions;
    r.regions = (sc_region *)test_allocate(sizes[0]);
    r.vertex_regions = (uint32_t *)test_allocate(sizes[1]);
    r.sides = (sc_contour_sides *)test_allocate(sizes[2]);
    memset(r.regions, 0xa5, sizes[0]);
    memset(r.vertex_regions, 0xa5, sizes[1]);
    memset(r.sides, 0xa5, sizes[2]);
    return r;
}

static void free_regions(sc_regions_result *r)
{
    free(r->regions);
    free(r->vertex_regions);
    free(r->sides);
}

/* Regions of a trace, compared with those asked for in other ways; checked. */
static void divide(fuzz_bytes *bytes, const fuzz_subject *s, const trace_facts *facts)
{
    const uint32_t how = fuzz_byte(bytes), flags = how & 1 ? SC_REGIONS_INSIDE : 0;
    const uint64_t contours = facts->trace.contour_count;
    sc_trace_options o = plain_options(s->simd);
    fuzz_memory memory;
    const sc_allocator allocator = fuzz_allocator(&memory, how / 4);
    sc_regions_result none, all, some;
    sc_status status;
    memset(&none, 0, sizeof none);
    none.struct_size = sizeof none;
    none.flags = flags;
    status = sc_trace_regions(s->model, &s->pose, &facts->trace, NULL, &none);
    FUZZ_CHECK(status == (none.region_count ? SC_ERROR_SHORT_BUFFER : SC_OK), "%s, %" PRIu64,
               sc_status_string(status), none.region_count);
    all = regions_room(s, flags, none.region_count, contours);
    status = sc_trace_regions(s->model, &s->pose, &facts->trace, NULL, &all);
    FUZZ_CHECK(status == SC_OK && all.region_count == none.region_count, "%s, %" PRIu64,
               sc_status_string(status), all.region_count);
    trace_check_regions(facts, &all);
    if (how & 2) o.allocator = &allocator;
    some = regions_room(s, flags, all.region_count, contours);
    status = sc_trace_regions(s->model, &s->pose, &facts->trace, &o, &some);
    FUZZ_CHECK(status == (memory.refused ? SC_ERROR_MEMORY : SC_OK) && memory.live == 0 &&
                   some.region_count == (status ? 0 : all.region_count),
               "%s, %" PRIu64, sc_status_string(status), some.region_count);
    if (status == SC_OK)
        FUZZ_CHECK(memcmp(some.regions, all.regions,
                          (size_t)all.region_count * sizeof *all.regions) == 0 &&
                       memcmp(some.vertex_regions, all.vertex_regions,
                              s->mesh.vertex_count * sizeof *all.vertex_regions) == 0 &&
                       memcmp(some.sides, all.sides, (size_t)contours * sizeof *all.sides) == 0,
                   "%" PRIu64 " regions, not the same", all.region_count);
    free_regions(&some);
    if (all.region_count) { /* the others are written all the same */
        some = regions_room(s, flags, how / 2 % all.region_count, contours);
        status = sc_trace_regions(s->model, &s->pose, &facts->trace, NULL, &some);
        FUZZ_CHECK(status == SC_ERROR_SHORT_BUFFER && some.region_count == all.region_count &&
                       memcmp(some.vertex_regions, all.vertex_regions,
                              s->mesh.vertex_count * sizeof *all.vertex_regions) == 0 &&
                       memcmp(some.sides, all.sides, (size_t)contours * sizeof *all.sides) == 0,
                   "%s, %" PRIu64, sc_status_string(status), some.region_count);
        free_regions(&some);
    }
    free_regions(&all);
}

/* ---- triples ---- */

static sc_triples_result triples_room(uint64_t triples)
{
    sc_triples_result r;
    memset(&r, 0, sizeof r);
    r.struct_size = sizeof r;
    r.reserved = 7;
    r.count = 77;
    r.capacity = triples;
    r.triples = (sc_trace_triple *)test_allocate((size_t)triples * sizeof *r.triples);
    memset(r.triples, 0xa5, (size_t)triples * sizeof *r.triples);
    return r;
}

/* Where contours of a trace cross; the same with memory that may run out, and too little room. */
static void cross(fuzz_bytes *bytes, const fuzz_subject *s, const trace_facts *facts)
{
    const uint32_t how = fuzz_byte(bytes);
    sc_trace_options o = plain_options(s->simd);
    fuzz_memory memory;
    const sc_allocator allocator = fuzz_allocator(&memory, how / 2 % 8);
    sc_triples_result none = triples_room(0), all, again;
    sc_status status = sc_trace_triples(s->model, &s->pose, &facts->trace, NULL, &none);
    FUZZ_CHECK(status == (none.count ? SC_ERROR_SHORT_BUFFER : SC_OK) && !none.reserved,
               "%s, %" PRIu64 " triples", sc_status_string(status), none.count);
    all = triples_room(none.count);
    status = sc_trace_triples(s->model, &s->pose, &facts->trace, NULL, &all);
    FUZZ_CHECK(status == SC_OK && all.count == none.count, "%s, %" PRIu64 " triples",
               sc_status_string(status), all.count);
    trace_check_triples(facts, &all);
    again = triples_room(none.count);
    if (how & 1) o.allocator = &allocator;
    status = sc_trace_triples(s->model, &s->pose, &facts->trace, &o, &again);
    FUZZ_CHECK(status == (memory.refused ? SC_ERROR_MEMORY : SC_OK) && memory.live == 0 &&
                   again.count == (status ? 0 : all.count) &&
                   (status || memcmp(again.triples, all.triples,
                                     (size_t)all.count * sizeof *all.triples) == 0),
               "%s, %" PRIu64 " triples", sc_status_string(status), again.count);
    free(none.triples);
    free(all.triples);
    free(again.triples);
}

/* ---- traces that were tampered with ---- */

static uint64_t any_count(fuzz_bytes *bytes, uint64_t near_to)
{
    const uint32_t kind = fuzz_byte(bytes);
    if (kind < 128) return near_to + kind % 8 - 4; /* may be less than 0 */
    if (kind < 192) return kind % 8;
    return fuzz_number(bytes, 8);
}

static uint32_t any_number(fuzz_bytes *bytes, uint32_t near_to)
{
    return (uint32_t)any_count(bytes, near_to);
}

/* Changes something in a node or a contour. */
static void tamper(fuzz_bytes *bytes, const sc_trace_result *t)
{
    const uint32_t kind = fuzz_byte(bytes) % 16;
    sc_trace_node *node = t->node_count ? t->nodes + fuzz_number(bytes, 2) % t->node_count : NULL;
    sc_trace_contour *contour =
        t->contour_count ? t->contours + fuzz_byte(bytes) % t->contour_count : NULL;
    if (!node || !contour) return;
    if (kind < 3) node->edge = any_number(bytes, node->edge);
    if (kind == 3) node->edge = SC_TRACE_NO_EDGE;
    if (kind == 4) node->triangle = any_number(bytes, node->triangle);
    if (kind == 5) node->sheet = any_number(bytes, node->sheet);
    if (kind == 6) node->sheets[0] = any_number(bytes, node->sheets[0]);
    if (kind == 7) node->sheets[1] = any_number(bytes, node->sheets[1]);
    if (kind == 8) node->along = fuzz_coordinate(bytes, 4);
    if (kind == 9) node->weights[fuzz_byte(bytes) % 3] = fuzz_coordinate(bytes, 4);
    if (kind == 10) node->point[fuzz_byte(bytes) % 3] = fuzz_coordinate(bytes, 4);
    if (kind == 11) contour->first = any_count(bytes, contour->first);
    if (kind == 12) contour->count = any_count(bytes, contour->count);
    if (kind == 13) contour->begin = any_number(bytes, contour->begin);
    if (kind == 14) contour->end = any_number(bytes, contour->end);
    if (kind == 15) contour->flags = any_number(bytes, contour->flags);
}

static void ask_tampered(fuzz_bytes *bytes, const fuzz_subject *s, const sc_trace_result *known)
{
    sc_trace_result t = *known;
    sc_trace_gradient *gradients =
        (sc_trace_gradient *)test_allocate((size_t)t.node_count * sizeof *gradients);
    sc_regions_result r = regions_room(s, 0, fuzz_byte(bytes) % 32, t.contour_count);
    sc_triples_result triples = triples_room(r.region_capacity);
    const uint32_t counts = fuzz_byte(bytes);
    int is_short;
    sc_status status;
    t.nodes = (sc_trace_node *)fuzz_copy(t.nodes, (size_t)t.node_count * sizeof *t.nodes);
    t.contours =
        (sc_trace_contour *)fuzz_copy(t.contours, (size_t)t.contour_count * sizeof *t.contours);
    for (uint32_t times = 1 + counts / 4 % 4; times > 0; --times) tamper(bytes, &t);
    if (counts & 1 && t.node_count) t.node_count = any_count(bytes, t.node_count);
    if (counts & 2 && t.contour_count) t.contour_count = any_count(bytes, t.contour_count);
    is_short = t.node_count > t.node_capacity || t.contour_count > t.contour_capacity;
    status = sc_trace_regions(s->model, &s->pose, &t, NULL, &r);
    if (is_short)
        FUZZ_CHECK(status == SC_ERROR_SHORT_BUFFER && !r.region_count, "%s",
                   sc_status_string(status));
    else if (status == SC_ERROR_PAIRS)
        FUZZ_CHECK(!r.region_count, "%" PRIu64 " regions", r.region_count);
    else
        FUZZ_CHECK(status == (r.region_count > r.region_capacity ? SC_ERROR_SHORT_BUFFER : SC_OK),
                   "%s, %" PRIu64 " regions", sc_status_string(status), r.region_count);
    status = sc_trace_gradients(s->model, &s->pose, &t, gradients);
    if (is_short ? status != SC_ERROR_SHORT_BUFFER
                 : status != SC_OK && status != SC_ERROR_PAIRS && status != SC_ERROR_NOT_FINITE)
        forbid("gradients of what was tampered with", status);
    status = sc_trace_triples(s->model, &s->pose, &t, NULL, &triples);
    if (is_short)
        FUZZ_CHECK(status == SC_ERROR_SHORT_BUFFER && !triples.count, "%s",
                   sc_status_string(status));
    else if (status == SC_ERROR_PAIRS || status == SC_ERROR_NOT_FINITE)
        FUZZ_CHECK(!triples.count, "%" PRIu64 " triples", triples.count);
    else
        FUZZ_CHECK(status == (triples.count > triples.capacity ? SC_ERROR_SHORT_BUFFER : SC_OK),
                   "%s, %" PRIu64 " triples", sc_status_string(status), triples.count);
    free_trace(&t);
    free_regions(&r);
    free(triples.triples);
    free(gradients);
}

/* ---- poses ---- */

static int is_used(const fuzz_subject *s, uint32_t vertex)
{
    for (uint32_t i = 0; i < 3 * s->mesh.triangle_count; ++i)
        if (s->triangles[i] == vertex) return 1;
    return 0;
}

/* A vertex that is in a triangle and not finite, or one that there is not. */
static uint32_t find_bad_vertex(const fuzz_subject *s)
{
    for (uint32_t v = 0; v < s->mesh.vertex_count; ++v)
        for (int k = 0; k < 3; ++k)
            if (!isfinite(s->positions[3 * v + (uint32_t)k]) && is_used(s, v)) return v;
    return s->mesh.vertex_count;
}

static int is_wide(const fuzz_subject *s)
{
    double low = HUGE_VAL, high = 0;
    for (uint32_t i = 0; i < 3 * s->mesh.vertex_count; ++i) {
        const double x = fabs(s->positions[i]);
        if (!(x > 0 && x < HUGE_VAL) || !is_used(s, i / 3)) continue;
        low = fmin(low, x);
        high = fmax(high, x);
    }
    return high > 0x1p100 * low;
}

/* What has a vertex that is not finite is refused: the pairs of its edges, a node, regions. */
static void refuse(const fuzz_subject *s, uint32_t bad)
{
    const uint32_t *v = s->triangles;
    sc_trace_result r = room_for(1, 1), one = room_for(2, 1);
    sc_trace_gradient gradients[2];
    sc_regions_result regions = regions_room(s, 0, 1, 1);
    sc_status status;
    for (uint32_t e = 0; e < 3 * s->mesh.triangle_count; ++e)
        for (uint32_t t = 0; t < s->mesh.triangle_count; ++t) {
            const uint32_t a = v[e], b = v[e / 3 * 3 + (e + 1) % 3], *c = v + 3 * t;
            const sc_pair pair = {e, t};
            if ((a != bad && b != bad && c[0] != bad && c[1] != bad && c[2] != bad) || a == b)
                continue;
            status = sc_trace(s->model, &s->pose, &pair, 1, NULL, &r);
            FUZZ_CHECK((status == SC_ERROR_NOT_FINITE || status == SC_ERROR_PAIRS) &&
                           !r.node_count && !r.contour_count,
                       "%s, %" PRIu64 " nodes", sc_status_string(status), r.node_count);
            if (c[0] != bad || c[0] == c[1]) continue;
            memset(one.nodes, 0, 2 * sizeof *one.nodes);
            memset(one.contours, 0, sizeof *one.contours);
            one.nodes[0].edge = one.nodes[1].edge = e;
            one.nodes[0].triangle = one.nodes[1].triangle = t;
            one.contours[0].count = one.node_count = 2;
            one.contour_count = 1;
            status = sc_trace_gradients(s->model, &s->pose, &one, gradients);
            FUZZ_CHECK(status == SC_ERROR_NOT_FINITE, "%s", sc_status_string(status));
        }
    one.node_count = one.contour_count = 0;
    status = sc_trace_regions(s->model, &s->pose, &one, NULL, &regions);
    FUZZ_CHECK(status == SC_ERROR_NOT_FINITE && !regions.region_count, "%s",
               sc_status_string(status));
    free_regions(&regions);
    free_trace(&one);
    free_trace(&r);
}

static void look_at_pose(fuzz_bytes *bytes, const fuzz_subject *s)
{
    const uint32_t bad = find_bad_vertex(s), how = fuzz_byte(bytes);
    trace_facts facts = {
        s->mesh.vertex_count, s->mesh.triangle_count, s->triangles, s->positions, {0}};
    sc_trace_gradient *gradients, *others;
    sc_result pairs;
    size_t size;
    if (bad < s->mesh.vertex_count) {
        refuse(s, bad);
        return;
    }
    pairs = find_pairs(s);
    facts.trace = trace_all(s, &pairs);
    if (s->mesh.triangle_count <= (is_wide(s) ? MOST_WIDE_TRIANGLES : MOST_TRIANGLES)) {
        trace_oracle_answer truth =
            trace_oracle_find(s->triangles, s->mesh.triangle_count, s->positions);
        trace_check_contours(&facts, &truth);
        trace_oracle_free(&truth);
    }
    trace_again(bytes, s, &pairs, &facts.trace);
    size = (size_t)facts.trace.node_count * sizeof *gradients;
    gradients = (sc_trace_gradient *)test_allocate(size);
    others = (sc_trace_gradient *)test_allocate(size);
    memset(gradients, 0xa5, size);
    memset(others, 0x5a, size);
    FUZZ_CHECK(sc_trace_gradients(s->model, &s->pose, &facts.trace, gradients) == SC_OK &&
                   sc_trace_gradients(s->model, &s->pose, &facts.trace, others) == SC_OK &&
                   memcmp(gradients, others, size) == 0,
               "gradients of a good trace");
    trace_check_gradients(&facts, gradients);
    free(gradients);
    free(others);
    divide(bytes, s, &facts);
    for (uint32_t i = 0; i < how % 4; ++i) trace_wrong_pairs(bytes, s, &pairs);
    for (uint32_t i = 0; i < how / 4 % 8; ++i) ask_tampered(bytes, s, &facts.trace);
    cross(bytes, s, &facts);
    free_trace(&facts.trace);
    free(pairs.pairs);
}

/* Changes a few coordinates, or all. */
static void change_pose(fuzz_bytes *bytes, fuzz_subject *s)
{
    const uint32_t how = fuzz_byte(bytes), count = s->mesh.vertex_count;
    if (how & 8) memcpy(s->positions, s->mesh.positions, 3 * count * sizeof(double));
    if ((how & 48) == 48 && find_bad_vertex(s) == count) {
        test_random_reset(fuzz_byte(bytes));
        soup_any_pose(s->positions, count);
    }
    for (uint32_t edits = how % 8; edits > 0; --edits) {
        const uint32_t at = fuzz_byte(bytes) % (3 * count);
        s->positions[at] = fuzz_coordinate(bytes, fuzz_byte(bytes) % FUZZ_KINDS);
    }
    if (how & 64)
        for (uint32_t i = 0; i < 3 * count; ++i)
            if (!isfinite(s->positions[i])) s->positions[i] = 0;
}

/* The mesh as often as a number of the bytes says, if that is not too much. */
static soup take_mesh(fuzz_bytes *bytes, uint32_t copies)
{
    soup mesh = fuzz_mesh(bytes, 0);
    for (soup one = soup_copy(&mesh);; --copies) {
        soup more;
        if (copies < 2 || mesh.triangle_count + one.triangle_count > FUZZ_ORACLE) {
            soup_free(&one);
            return mesh;
        }
        more = soup_join(&mesh, &one);
        soup_free(&mesh);
        mesh = more;
    }
}

int fuzz_trace(const uint8_t *data, size_t size)
{
    fuzz_bytes bytes = {data, size};
    const uint32_t how = fuzz_byte(&bytes), random = fuzz_byte(&bytes);
    const uint32_t copies = fuzz_byte(&bytes) % 4;
    input_choices choices;
    fuzz_subject s;
    sc_mesh mesh;
    uint32_t *weld;
    memset(&s, 0, sizeof s);
    fuzz_number(&bytes, 2); /* as in fuzz_query: the same seeds serve both */
    s.mesh = take_mesh(&bytes, copies);
    s.simd = how / 16 % 4;
    if (s.simd > (uint32_t)sc_isa_best()) s.simd = SC_SIMD_BASE;
    mesh = input_plain_mesh(&s.mesh);
    test_random_reset(random);
    choices = input_choose(&s.mesh, how % 3, how / 4 % 4);
    if (how & 64) {
        choices.options.content = SC_MODEL_BOXES;
        choices.options.rest = SC_REST_UNMARKED;
    }
    weld = input_weld_of(&choices, &s.mesh);
    s.triangles = (uint32_t *)test_allocate(3 * s.mesh.triangle_count * sizeof *s.triangles);
    for (uint32_t i = 0; i < 3 * s.mesh.triangle_count; ++i)
        s.triangles[i] = weld[s.mesh.triangles[i]];
    FUZZ_CHECK(sc_build(&mesh, &choices.options, &s.model) == SC_OK &&
                   sc_workspace_create(s.model, NULL, &s.workspace) == SC_OK,
               "a good mesh");
    s.positions = soup_copy_positions(&s.mesh);
    for (uint32_t i = 0; i < MOST_POSES && (i == 0 || bytes.left > 0); ++i) {
        input_array positions;
        if (i > 0) change_pose(&bytes, &s);
        if (how & 128) soup_round_to_float(s.positions, s.mesh.vertex_count);
        for (uint32_t k = 0; k < 9 * s.mesh.triangle_count; ++k) { /* what welding has replaced */
            const uint32_t v = s.mesh.triangles[k / 3];
            double *x = &s.positions[3 * (size_t)v + k % 3];
            if (weld[v] != v && !isfinite(*x)) *x = 0;
        }
        positions =
            input_positions(s.positions, s.mesh.vertex_count, how & 128 ? SC_FLOAT : SC_DOUBLE, i);
        s.pose = input_pose(s.mesh.vertex_count, &positions);
        look_at_pose(&bytes, &s);
        input_free(&positions);
    }
    sc_workspace_free(s.workspace);
    sc_model_free(s.model);
    input_free_choices(&choices);
    free(weld);
    free(s.triangles);
    free(s.positions);
    soup_free(&s.mesh);
    return 0;
}
