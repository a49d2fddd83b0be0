/*
 * Fewer triangles; see decimate.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/decimate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t none = UINT32_MAX;

/* The symmetric 4 x 4 matrix of a sum of squared distances to planes: its upper triangle. */
typedef struct quadric {
    double m[10];
} quadric;

typedef struct candidate {
    double cost;
    uint32_t a, b;
    uint64_t stamp; /* of both ends when it was made */
} candidate;

typedef struct decimation {
    uint32_t vertex_count, triangle_count, alive;
    uint32_t *corners; /* 3 * triangle_count: vertices; the first is none if the triangle is gone */
    uint32_t *next;    /* 3 * triangle_count: the next corner at the same vertex, or none */
    uint32_t *first;   /* vertex_count: a corner, or none */
    double *positions; /* 3 * vertex_count */
    quadric *quadrics; /* vertex_count */
    uint64_t *stamps;  /* vertex_count: raised when a vertex changes */
    uint32_t *marks;   /* vertex_count */
    uint32_t mark;     /* the last one used */
    candidate *heap;   /* the cheapest at 0 */
    size_t heap_length, heap_room;
    bool failed; /* no memory */
} decimation;

/* ------------------------------------------------------------------------------------------------
 * Quadrics.
 */

static void add_plane(quadric *q, const double normal[3], double offset, double weight)
{
    const double plane[4] = {normal[0], normal[1], normal[2], offset};
    int at = 0;
    for (int i = 0; i < 4; i++) {
        for (int j = i; j < 4; j++) q->m[at++] += weight * plane[i] * plane[j];
    }
}

static double quadric_value(const quadric *q, const double p[3])
{
    const double v[4] = {p[0], p[1], p[2], 1.0};
    double sum = 0.0;
    int at = 0;
    for (int i = 0; i < 4; i++) {
        for (int j = i; j < 4; j++) sum += (i == j ? 1.0 : 2.0) * q->m[at++] * v[i] * v[j];
    }
    return sum;
}

static const double *position(const decimation *d, uint32_t vertex)
{
    return d->positions + 3 * (size_t)vertex;
}

/* The normal of a triangle, twice its area long. */
static void triangle_normal(const double *a, const double *b, const double *c, double normal[3])
{
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    }
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ------------------------------------------------------------------------------------------------
 * What is round a vertex or an edge.
 */

/* The other two corners of a corner's triangle. */
static void other_corners(uint32_t corner, uint32_t others[2])
{
    const uint32_t base = corner - corner % 3;
    others[0] = base + (corner + 1) % 3;
    others[1] = base + (corner + 2) % 3;
}

/* The number of triangles at both a and b. */
static uint32_t edge_triangles(const decimation *d, uint32_t a, uint32_t b)
{
    uint32_t count = 0, others[2];
    for (uint32_t c = d->first[a]; c != none; c = d->next[c]) {
        other_corners(c, others);
        if (d->corners[others[0]] == b || d->corners[others[1]] == b) count++;
    }
    return count;
}

static bool on_border(const decimation *d, uint32_t vertex)
{
    uint32_t others[2];
    for (uint32_t c = d->first[vertex]; c != none; c = d->next[c]) {
        other_corners(c, others);
        for (int k = 0; k < 2; k++) {
            if (edge_triangles(d, vertex, d->corners[others[k]]) != 2) return true;
        }
    }
    return false;
}

/* Vertices that are neighbours of both a and b. */
static uint32_t common_neighbors(decimation *d, uint32_t a, uint32_t b)
{
    uint32_t count = 0, others[2];
    const uint32_t near_a = ++d->mark, counted = ++d->mark;
    for (uint32_t c = d->first[a]; c != none; c = d->next[c]) {
        other_corners(c, others);
        for (int k = 0; k < 2; k++) d->marks[d->corners[others[k]]] = near_a;
    }
    for (uint32_t c = d->first[b]; c != none; c = d->next[c]) {
        other_corners(c, others);
        for (int k = 0; k < 2; k++) {
            const uint32_t v = d->corners[others[k]];
            if (d->marks[v] != near_a) continue;
            d->marks[v] = counted;
            count++;
        }
    }
    return count;
}

/* Whether a triangle at vertex, but not at other, would turn by more than 78 degrees. */
static bool turns_over(const decimation *d, uint32_t vertex, uint32_t other, const double *target)
{
    uint32_t others[2];
    double before[3], after[3];
    for (uint32_t c = d->first[vertex]; c != none; c = d->next[c]) {
        other_corners(c, others);
        const uint32_t v = d->corners[others[0]], w = d->corners[others[1]];
        if (v == other || w == other) continue;
        triangle_normal(position(d, vertex), position(d, v), position(d, w), before);
        triangle_normal(target, position(d, v), position(d, w), after);
        if (dot(before, after) <= 0.2 * sqrt(dot(before, before) * dot(after, after))) return true;
    }
    return false;
}

static bool may_collapse(decimation *d, uint32_t a, uint32_t b, const double *target)
{
    const uint32_t triangles = edge_triangles(d, a, b);
    if (triangles < 1 || triangles > 2 || common_neighbors(d, a, b) != triangles) return false;
    if (triangles == 2 && on_border(d, a) && on_border(d, b)) return false;
    return !turns_over(d, a, b, target) && !turns_over(d, b, a, target);
}

/* ------------------------------------------------------------------------------------------------
 * Candidates.
 */

static bool goes_before(const candidate *x, const candidate *y)
{
    if (x->cost != y->cost) return x->cost < y->cost;
    return x->a != y->a ? x->a < y->a : x->b < y->b;
}

static void push_candidate(decimation *d, candidate new_one)
{
    if (d->heap_length == d->heap_room) {
        const size_t room = 2 * d->heap_room + 1024;
        candidate *heap = (candidate *)realloc(d->heap, room * sizeof *heap);
        if (!heap) {
            d->failed = true;
            return;
        }
        d->heap = heap;
        d->heap_room = room;
    }
    size_t at = d->heap_length++;
    while (at > 0 && goes_before(&new_one, &d->heap[(at - 1) / 2])) {
        d->heap[at] = d->heap[(at - 1) / 2];
        at = (at - 1) / 2;
    }
    d->heap[at] = new_one;
}

static candidate pop_candidate(decimation *d)
{
    const candidate top = d->heap[0], last = d->heap[--d->heap_length];
    size_t at = 0;
    for (;;) {
        size_t child = 2 * at + 1;
        if (child >= d->heap_length) break;
        if (child + 1 < d->heap_length && goes_before(&d->heap[child + 1], &d->heap[child]))
            child++;
        if (!goes_before(&d->heap[child], &last)) break;
        d->heap[at] = d->heap[child];
        at = child;
    }
    d->heap[at] = last;
    return top;
}

/* The cost of a collapse and where the new vertex goes. */
static double collapse_cost(const decimation *d, uint32_t a, uint32_t b, double target[3])
{
    quadric sum = d->quadrics[a];
    for (int k = 0; k < 10; k++) sum.m[k] += d->quadrics[b].m[k];
    const double *p = position(d, a), *q = position(d, b);
    double best = HUGE_VAL, length = 0.0;
    for (int choice = 0; choice < 3; choice++) {
        const double part = choice == 0 ? 0.5 : choice == 1 ? 0.0 : 1.0;
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = p[k] + part * (q[k] - p[k]);
        const double cost = quadric_value(&sum, at);
        if (cost >= best) continue;
        best = cost;
        memcpy(target, at, sizeof at);
    }
    for (int k = 0; k < 3; k++) length += (q[k] - p[k]) * (q[k] - p[k]);
    /* In flat parts the shortest edge goes first. */
    return fmax(best, 0.0) + 1e-6 * length * length;
}

static void add_edge(decimation *d, uint32_t a, uint32_t b)
{
    double target[3];
    candidate edge;
    edge.a = a < b ? a : b;
    edge.b = a < b ? b : a;
    edge.cost = collapse_cost(d, edge.a, edge.b, target);
    edge.stamp = d->stamps[a] + d->stamps[b];
    push_candidate(d, edge);
}

/* All edges at a vertex, each once. */
static void add_edges(decimation *d, uint32_t vertex)
{
    uint32_t others[2];
    const uint32_t seen = ++d->mark;
    for (uint32_t c = d->first[vertex]; c != none; c = d->next[c]) {
        other_corners(c, others);
        for (int k = 0; k < 2; k++) {
            const uint32_t v = d->corners[others[k]];
            if (d->marks[v] == seen) continue;
            d->marks[v] = seen;
            add_edge(d, vertex, v);
        }
    }
}

/* ------------------------------------------------------------------------------------------------
 * Collapsing.
 */

/* Takes the corners of dead triangles out of a vertex's list. */
static void drop_dead(decimation *d, uint32_t vertex)
{
    uint32_t *link = &d->first[vertex];
    while (*link != none) {
        if (d->corners[*link - *link % 3] == none)
            *link = d->next[*link];
        else
            link = &d->next[*link];
    }
}

/* b becomes a. */
static void collapse(decimation *d, uint32_t a, uint32_t b, const double target[3])
{
    uint32_t others[2], last = none, removed[2], removed_count = 0;
    for (uint32_t c = d->first[b]; c != none; c = d->next[c]) {
        other_corners(c, others);
        const uint32_t v = d->corners[others[0]], w = d->corners[others[1]];
        if (v == a || w == a) {
            removed[removed_count++] = v == a ? w : v;
            d->corners[c - c % 3] = none;
            d->alive--;
        } else {
            d->corners[c] = a;
        }
        last = c;
    }
    if (last != none) d->next[last] = d->first[a];
    d->first[a] = d->first[b];
    d->first[b] = none;
    drop_dead(d, a);
    for (uint32_t k = 0; k < removed_count; k++) drop_dead(d, removed[k]);
    memcpy(d->positions + 3 * (size_t)a, target, 3 * sizeof(double));
    for (int k = 0; k < 10; k++) d->quadrics[a].m[k] += d->quadrics[b].m[k];
    d->stamps[a]++;
    add_edges(d, a);
}

static void add_triangle_planes(decimation *d, uint32_t triangle)
{
    const uint32_t *v = d->corners + 3 * (size_t)triangle;
    double normal[3], side[3], border[3];
    const double zero[3] = {0.0, 0.0, 0.0};
    triangle_normal(position(d, v[0]), position(d, v[1]), position(d, v[2]), normal);
    const double length = sqrt(dot(normal, normal));
    if (length == 0.0) return;
    for (int k = 0; k < 3; k++) normal[k] /= length;
    for (int k = 0; k < 3; k++) {
        add_plane(&d->quadrics[v[k]], normal, -dot(normal, position(d, v[0])), length);
        const uint32_t a = v[k], b = v[(k + 1) % 3];
        if (edge_triangles(d, a, b) == 2) continue;
        /* A border: the plane through it, upright on the triangle. */
        for (int i = 0; i < 3; i++) side[i] = position(d, b)[i] - position(d, a)[i];
        triangle_normal(zero, side, normal, border);
        const double width = sqrt(dot(border, border));
        if (width == 0.0) continue;
        for (int i = 0; i < 3; i++) border[i] /= width;
        const double offset = -dot(border, position(d, a));
        add_plane(&d->quadrics[a], border, offset, 10.0 * width * width);
        add_plane(&d->quadrics[b], border, offset, 10.0 * width * width);
    }
}

static bool init(decimation *d, const mesh_file *mesh)
{
    const size_t n = mesh->vertex_count, corners = 3 * (size_t)mesh->triangle_count;
    memset(d, 0, sizeof *d);
    d->vertex_count = mesh->vertex_count;
    d->triangle_count = mesh->triangle_count;
    d->corners = (uint32_t *)malloc(corners * sizeof(uint32_t));
    d->next = (uint32_t *)malloc(corners * sizeof(uint32_t));
    d->first = (uint32_t *)malloc(n * sizeof(uint32_t));
    d->positions = (double *)malloc(3 * n * sizeof(double));
    d->quadrics = (quadric *)calloc(n, sizeof(quadric));
    d->stamps = (uint64_t *)calloc(n, sizeof(uint64_t));
    d->marks = (uint32_t *)calloc(n, sizeof(uint32_t));
    if (!d->corners || !d->next || !d->first || !d->positions || !d->quadrics || !d->stamps ||
        !d->marks)
        return false;
    memset(d->first, 0xff, n * sizeof(uint32_t));
    for (size_t i = 0; i < 3 * n; i++)
        d->positions[i] = (double)((const float *)mesh->positions)[i];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->indices + 3 * (size_t)t;
        uint32_t *corner = d->corners + 3 * (size_t)t;
        memcpy(corner, v, 3 * sizeof(uint32_t));
        /* Triangles with a corner twice are dropped. */
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            corner[0] = none;
            continue;
        }
        d->alive++;
        for (uint32_t c = 3 * t; c < 3 * t + 3; c++) {
            d->next[c] = d->first[d->corners[c]];
            d->first[d->corners[c]] = c;
        }
    }
    for (uint32_t t = 0; t < d->triangle_count; t++) {
        if (d->corners[3 * (size_t)t] != none) add_triangle_planes(d, t);
    }
    for (uint32_t v = 0; v < d->vertex_count; v++) add_edges(d, v);
    return !d->failed;
}

/* Makes a mesh of what is left. */
static bool take_rest(const decimation *d, mesh_file *mesh)
{
    uint32_t *numbers = (uint32_t *)malloc(d->vertex_count * sizeof *numbers);
    uint32_t vertices = 0, triangles = 0;
    mesh_file rest;
    memset(&rest, 0, sizeof rest);
    for (uint32_t v = 0; v < d->vertex_count && numbers; v++) {
        numbers[v] = d->first[v] == none ? none : vertices++;
    }
    const bool done = numbers && mesh_file_allocate(&rest, vertices, d->alive);
    if (done) {
        for (uint32_t v = 0; v < d->vertex_count; v++) {
            for (size_t k = 0; k < 3 && numbers[v] != none; k++) {
                ((float *)rest.positions)[3 * (size_t)numbers[v] + k] = (float)position(d, v)[k];
            }
        }
        for (uint32_t t = 0; t < d->triangle_count; t++) {
            const uint32_t *v = d->corners + 3 * (size_t)t;
            if (v[0] == none) continue;
            uint32_t *out = rest.indices + 3 * (size_t)triangles++;
            for (int k = 0; k < 3; k++) out[k] = numbers[v[k]];
        }
        mesh_file_free(mesh);
        *mesh = rest;
    }
    free(numbers);
    return done;
}

bool decimate_mesh(mesh_file *mesh, uint32_t triangles)
{
    decimation d;
    bool done = init(&d, mesh);
    while (done && d.alive > triangles && d.heap_length > 0) {
        const candidate edge = pop_candidate(&d);
        double target[3];
        if (d.first[edge.a] == none || d.first[edge.b] == none ||
            edge.stamp != d.stamps[edge.a] + d.stamps[edge.b])
            continue;
        collapse_cost(&d, edge.a, edge.b, target);
        if (may_collapse(&d, edge.a, edge.b, target)) collapse(&d, edge.a, edge.b, target);
        done = !d.failed;
    }
    if (done) done = take_rest(&d, mesh);
    free(d.corners);
    free(d.next);
    free(d.first);
    free(d.positions);
    free(d.quadrics);
    free(d.stamps);
    free(d.marks);
    free(d.heap);
    return done;
}
