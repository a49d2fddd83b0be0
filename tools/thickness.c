/*
 * The thickness of triangles; see thickness.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "thickness.h"

#include "mesh_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const uint32_t thickness_percents[THICKNESS_PERCENTILES] = {1, 5, 25, 50, 75, 95, 99};

struct thickness {
    thickness_mesh mesh;
    double limit;      /* 2 D: paths that are shorter join */
    double *triangles; /* the answer: triangle_count */
    /* Triangles at each vertex that represents others or itself: of v, those of at from starts[v]
       to before starts[v + 1]. A triangle that has v twice is there twice. */
    uint32_t *starts, *at;
    /* The search from a feature (Dijkstra 1959), for as long as pairs begin with that. */
    uint32_t source[2]; /* its vertices, equal if it is one; SC_NONE: no search */
    uint32_t round;     /* of this search; 0: none yet */
    uint32_t *rounds;   /* the round in which a vertex was last reached, by less than the limit */
    double *lengths;    /* to reached vertices, of the shortest path so far */
    uint32_t *heap;     /* heap_size vertices that were reached and not gone on from, as a binary
                           heap by length */
    uint32_t *places;   /* of reached vertices: where in the heap */
    uint32_t heap_size;
};

static uint32_t vertex_at(const thickness *self, size_t corner)
{
    const uint32_t v = self->mesh.indices[corner];
    return self->mesh.weld_map ? self->mesh.weld_map[v] : v;
}

/* Lists triangles by their vertices: counts, sums, and fills from behind. */
static void list_triangles(thickness *self)
{
    const size_t corners = 3 * (size_t)self->mesh.triangle_count;
    for (size_t c = 0; c < corners; c++) self->starts[vertex_at(self, c) + 1]++;
    for (size_t v = 0; v < self->mesh.vertex_count; v++) self->starts[v + 1] += self->starts[v];
    /* rounds serves as the number of entries that each vertex has so far */
    for (size_t c = 0; c < corners; c++) {
        const uint32_t v = vertex_at(self, c);
        self->at[self->starts[v] + self->rounds[v]++] = (uint32_t)(c / 3);
    }
    memset(self->rounds, 0, self->mesh.vertex_count * sizeof *self->rounds);
}

thickness *thickness_new(const thickness_mesh *mesh, double distance)
{
    thickness *self = (thickness *)calloc(1, sizeof *self);
    const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    if (!self) return NULL;
    self->mesh = *mesh;
    self->limit = 2 * distance;
    self->source[0] = self->source[1] = SC_NONE;
    self->triangles = (double *)malloc((triangles + 1) * sizeof *self->triangles);
    self->starts = (uint32_t *)calloc(vertices + 1, sizeof *self->starts);
    self->at = (uint32_t *)malloc((3 * triangles + 1) * sizeof *self->at);
    self->rounds = (uint32_t *)calloc(vertices + 1, sizeof *self->rounds);
    self->lengths = (double *)malloc((vertices + 1) * sizeof *self->lengths);
    self->heap = (uint32_t *)malloc((vertices + 1) * sizeof *self->heap);
    self->places = (uint32_t *)malloc((vertices + 1) * sizeof *self->places);
    if (!self->triangles || !self->starts || !self->at || !self->rounds || !self->lengths ||
        !self->heap || !self->places) {
        thickness_free(self);
        return NULL;
    }
    for (size_t t = 0; t < triangles; t++) self->triangles[t] = HUGE_VAL;
    list_triangles(self);
    return self;
}

void thickness_free(thickness *self)
{
    if (!self) return;
    free(self->triangles);
    free(self->starts);
    free(self->at);
    free(self->rounds);
    free(self->lengths);
    free(self->heap);
    free(self->places);
    free(self);
}

const double *thickness_of_triangles(const thickness *self)
{
    return self->triangles;
}

/* ------------------------------------------------------------------------------------------------
 * Paths
 */

/* How long an edge is. Where squares could be too large or too small, all is brought near 1 before
   by a power of two. */
static double edge_length(const thickness *self, uint32_t u, uint32_t v)
{
    double p[3], q[3], longest = 0;
    int exponent = 0;
    mesh_file_position(self->mesh.positions, self->mesh.position_type, u, p);
    mesh_file_position(self->mesh.positions, self->mesh.position_type, v, q);
    for (int i = 0; i < 3; i++) {
        p[i] -= q[i];
        longest = fabs(p[i]) > longest ? fabs(p[i]) : longest;
    }
    if (!(longest > 0 && longest < HUGE_VAL)) return longest;
    if (longest < 0x1p-500 || longest > 0x1p500) {
        frexp(longest, &exponent);
        for (int i = 0; i < 3; i++) p[i] = ldexp(p[i], -exponent);
    }
    const double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    return exponent ? ldexp(length, exponent) : length;
}

/* Puts a vertex where it belongs in the heap, from place on, which is free, towards the first. */
static void rise(thickness *self, uint32_t vertex, uint32_t place)
{
    while (place > 0) {
        const uint32_t above = (place - 1) / 2, other = self->heap[above];
        if (self->lengths[other] <= self->lengths[vertex]) break;
        self->heap[place] = other;
        self->places[other] = place;
        place = above;
    }
    self->heap[place] = vertex;
    self->places[vertex] = place;
}

/* Takes the vertex with the shortest path out of the heap. */
static uint32_t take_nearest(thickness *self)
{
    const uint32_t nearest = self->heap[0], last = self->heap[--self->heap_size];
    uint32_t place = 0;
    for (;;) {
        uint32_t below = 2 * place + 1;
        if (below >= self->heap_size) break;
        if (below + 1 < self->heap_size &&
            self->lengths[self->heap[below + 1]] < self->lengths[self->heap[below]])
            below++;
        self->heap[place] = self->heap[below];
        self->places[self->heap[place]] = place;
        place = below;
    }
    if (self->heap_size) rise(self, last, place);
    return nearest;
}

/* A path to a vertex was found. */
static void reach(thickness *self, uint32_t vertex, double length)
{
    if (!(length < self->limit)) return;
    const bool is_new = self->rounds[vertex] != self->round;
    if (!is_new && length >= self->lengths[vertex]) return;
    self->rounds[vertex] = self->round;
    self->lengths[vertex] = length;
    rise(self, vertex, is_new ? self->heap_size++ : self->places[vertex]);
}

static void begin_search(thickness *self, const uint32_t source[2])
{
    if (++self->round == 0) { /* after 2^32 of them, old rounds would look new */
        memset(self->rounds, 0, self->mesh.vertex_count * sizeof *self->rounds);
        self->round = 1;
    }
    self->heap_size = 0;
    for (int i = 0; i < 2; i++) {
        self->source[i] = source[i];
        reach(self, source[i], 0);
    }
}

/* Goes on along all edges from a vertex. A vertex that is out of the heap has its shortest path,
   and none is shorter: rounded sums grow with what they are sums of, as lengths of edges are not
   negative. */
static void go_on(thickness *self, uint32_t vertex)
{
    for (uint32_t i = self->starts[vertex]; i < self->starts[vertex + 1]; i++) {
        for (size_t k = 0; k < 3; k++) {
            const uint32_t next = vertex_at(self, 3 * (size_t)self->at[i] + k);
            if (next != vertex)
                reach(self, next, self->lengths[vertex] + edge_length(self, vertex, next));
        }
    }
}

/* Whether a path leads from the source to one of count vertices. */
static bool joins(thickness *self, const uint32_t *vertices, int count)
{
    for (;;) {
        for (int i = 0; i < count; i++) {
            if (self->rounds[vertices[i]] == self->round) return true;
        }
        if (!self->heap_size) return false;
        go_on(self, take_nearest(self));
    }
}

/* ------------------------------------------------------------------------------------------------
 * Pairs
 */

static bool has_side(const thickness *self, uint32_t triangle, uint32_t u, uint32_t v)
{
    for (size_t k = 0; k < 3; k++) {
        const uint32_t from = vertex_at(self, 3 * (size_t)triangle + k);
        const uint32_t to = vertex_at(self, 3 * (size_t)triangle + (k + 1) % 3);
        if ((from == u && to == v) || (from == v && to == u)) return true;
    }
    return false;
}

/* The vertices of a pair, those of a first; returns how many a has. */
static int find_vertices(const thickness *self, uint32_t kind, sc_pair pair, uint32_t v[4])
{
    if (kind == SC_NEAR_VERTEX_FACE) {
        v[0] = self->mesh.weld_map ? self->mesh.weld_map[pair.a] : pair.a;
        for (size_t k = 0; k < 3; k++) v[1 + k] = vertex_at(self, 3 * (size_t)pair.b + k);
        return 1;
    }
    for (int side = 0; side < 2; side++) {
        const uint32_t from = side ? pair.b : pair.a;
        v[2 * side] = vertex_at(self, from);
        v[2 * side + 1] = vertex_at(self, from % 3 == 2 ? from - 2 : from + 1);
    }
    return 2;
}

bool thickness_counts(thickness *self, uint32_t kind, sc_pair pair)
{
    uint32_t v[4];
    const int first = find_vertices(self, kind, pair, v);
    const uint32_t source[2] = {v[0], v[first - 1]};
    if (self->source[0] != source[0] || self->source[1] != source[1]) begin_search(self, source);
    return !joins(self, v + first, 4 - first);
}

static void lower(double *value, double distance)
{
    if (distance < *value) *value = distance;
}

/* Lowers the triangles at a vertex, or those at the edge from there to other. */
static void lower_at(thickness *self, uint32_t vertex, bool is_edge, uint32_t other,
                     double distance)
{
    for (uint32_t i = self->starts[vertex]; i < self->starts[vertex + 1]; i++) {
        const uint32_t t = self->at[i];
        if (!is_edge || has_side(self, t, vertex, other)) lower(&self->triangles[t], distance);
    }
}

void thickness_add(thickness *self, uint32_t kind, sc_pair pair, double distance)
{
    const bool is_edges = kind == SC_NEAR_EDGE_EDGE;
    uint32_t v[4];
    find_vertices(self, kind, pair, v);
    lower_at(self, v[0], is_edges, v[1], distance);
    if (is_edges)
        lower_at(self, v[2], true, v[3], distance);
    else
        lower(&self->triangles[pair.b], distance);
}

/* ------------------------------------------------------------------------------------------------
 * How values are spread
 */

static int compare_values(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

bool thickness_find_spread(const double *values, size_t count, double distance,
                           thickness_spread *spread)
{
    double *sorted = (double *)malloc(count * sizeof *sorted);
    if (!sorted) return false;
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_values);
    memset(spread, 0, sizeof *spread);
    for (int i = 0; i <= THICKNESS_BINS; i++)
        spread->limits[i] = distance * ((double)i / THICKNESS_BINS);
    int bin = 0;
    for (size_t i = 0; i < count; i++) {
        if (sorted[i] == HUGE_VAL) {
            spread->more = count - i;
            break;
        }
        while (bin + 1 < THICKNESS_BINS && sorted[i] >= spread->limits[bin + 1]) bin++;
        spread->counts[bin]++;
    }
    for (int i = 0; i < THICKNESS_PERCENTILES; i++) {
        /* the first of so many: count * percent / 100, rounded up */
        const uint64_t share = (uint64_t)count * thickness_percents[i];
        spread->percentiles[i] = sorted[(share + 99) / 100 - 1];
    }
    free(sorted);
    return true;
}
