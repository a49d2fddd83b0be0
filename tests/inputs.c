/*
 * From soups to the library's inputs: see inputs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "inputs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "oracle.h"

/* Room for count elements of size bytes, gap apart, and nothing behind the last; filled with
   0xff. */
static input_array make_array(uint32_t count, uint32_t size, uint32_t type, uint32_t gap)
{
    input_array array;
    size_t bytes = count == 0 ? 0 : (size_t)(count - 1) * (size + gap) + size;
    array.memory = (unsigned char *)test_allocate(bytes + 1);
    memset(array.memory, 0xff, bytes + 1);
    array.data = array.memory + 1;
    array.type = type;
    array.stride = gap == 0 ? 0 : size + gap;
    return array;
}

input_array input_positions(const double *positions, uint32_t count, uint32_t type, uint32_t gap)
{
    uint32_t size = type == SC_FLOAT ? 12 : 24;
    input_array array = make_array(count, size, type, gap);
    for (uint32_t v = 0; v < count; ++v) {
        const double *p = positions + 3 * (size_t)v;
        float f[3] = {(float)p[0], (float)p[1], (float)p[2]};
        if (type == SC_FLOAT) {
            memcpy(array.data + (size_t)v * (size + gap), f, size);
        } else {
            memcpy(array.data + (size_t)v * (size + gap), p, size);
        }
    }
    return array;
}

input_array input_indices(const uint32_t *triangles, uint32_t count, uint32_t type, uint32_t gap)
{
    uint32_t size = type == SC_UINT16 ? 6 : 12;
    input_array array = make_array(count, size, type, gap);
    for (uint32_t t = 0; t < count; ++t) {
        const uint32_t *v = triangles + 3 * (size_t)t;
        uint16_t narrow[3] = {(uint16_t)v[0], (uint16_t)v[1], (uint16_t)v[2]};
        if (type == SC_UINT16) {
            memcpy(array.data + (size_t)t * (size + gap), narrow, size);
        } else {
            memcpy(array.data + (size_t)t * (size + gap), v, size);
        }
    }
    return array;
}

void input_free(input_array *array)
{
    free(array->memory);
    memset(array, 0, sizeof(*array));
}

sc_mesh input_mesh(const soup *s, const input_array *positions, const input_array *indices)
{
    sc_mesh mesh;
    memset(&mesh, 0, sizeof(mesh));
    mesh.struct_size = sizeof(mesh);
    mesh.vertex_count = s->vertex_count;
    mesh.triangle_count = s->triangle_count;
    mesh.position_type = positions->type;
    mesh.position_stride = positions->stride;
    mesh.index_type = indices->type;
    mesh.index_stride = indices->stride;
    mesh.positions = positions->data;
    mesh.indices = indices->data;
    return mesh;
}

sc_pose input_pose(uint32_t vertex_count, const input_array *positions)
{
    sc_pose pose;
    memset(&pose, 0, sizeof(pose));
    pose.struct_size = sizeof(pose);
    pose.vertex_count = vertex_count;
    pose.position_type = positions->type;
    pose.position_stride = positions->stride;
    pose.positions = positions->data;
    return pose;
}

sc_mesh input_plain_mesh(const soup *s)
{
    sc_mesh mesh;
    memset(&mesh, 0, sizeof(mesh));
    mesh.struct_size = sizeof(mesh);
    mesh.vertex_count = s->vertex_count;
    mesh.triangle_count = s->triangle_count;
    mesh.position_type = SC_DOUBLE;
    mesh.positions = s->positions;
    mesh.indices = s->triangles;
    return mesh;
}

sc_pose input_plain_pose(const double *positions, uint32_t vertex_count)
{
    sc_pose pose;
    memset(&pose, 0, sizeof(pose));
    pose.struct_size = sizeof(pose);
    pose.vertex_count = vertex_count;
    pose.position_type = SC_DOUBLE;
    pose.positions = positions;
    return pose;
}

sc_query_options input_query(uint32_t kind, uint32_t contact, uint32_t method)
{
    sc_query_options o;
    memset(&o, 0, sizeof(o));
    o.struct_size = sizeof(o);
    o.pairs = kind;
    o.contact = contact;
    o.method = method;
    return o;
}

typedef struct tree_maker {
    sc_tree_node *nodes;
    uint32_t count;
    uint32_t leaf_limit;
    int is_skewed;
} tree_maker;

/* Makes node of order[first .. first + count - 1]; depth counts the nodes from the root to it. */
static void make_node(tree_maker *maker, uint32_t node, uint32_t first, uint32_t count,
                      uint32_t depth)
{
    uint32_t left_count;
    sc_tree_node *n = &maker->nodes[node];
    if (count <= maker->leaf_limit || depth == 60) {
        n->left = n->right = SC_NONE;
        n->first = first;
        n->count = count;
        return;
    }
    left_count = maker->is_skewed ? 1 : 1 + test_random_below(count - 1);
    /* The children's numbers are apart, and what an inner node has in first and count is no
       matter. */
    n->right = maker->count++;
    n->left = maker->count++;
    n->first = n->count = 12345;
    make_node(maker, n->left, first, left_count, depth + 1);
    make_node(maker, n->right, first + left_count, count - left_count, depth + 1);
}

input_choices input_choose(const soup *s, uint32_t weld, uint32_t partition)
{
    static const char *const names[] = {"fast", "order", "tree", "bisect"};
    input_choices c;
    memset(&c, 0, sizeof(c));
    c.options.struct_size = sizeof(c.options);
    c.options.weld = weld;
    c.options.partition = partition;
    c.options.rest = (s->triangle_count + partition) % 2 ? SC_REST_MARKED : SC_REST_UNMARKED;
    c.partition_name = names[partition];
    if (weld == SC_WELD_MAP) {
        uint32_t share = 1 + test_random_below(12);
        c.weld_map = (uint32_t *)test_allocate(s->vertex_count * sizeof(uint32_t));
        for (uint32_t v = 0; v < s->vertex_count; ++v) {
            c.weld_map[v] = v;
            if (v > 0 && test_random_below(share) == 0)
                c.weld_map[v] = c.weld_map[test_random_below(v)];
        }
        if (s->vertex_count > 1 && test_random_below(2) != 0) { /* a representative behind */
            uint32_t last = s->vertex_count - 1, v = test_random_below(last);
            if (c.weld_map[last] == last) {
                for (uint32_t i = 0; i < s->vertex_count; ++i) {
                    if (c.weld_map[i] == v) c.weld_map[i] = last;
                }
            }
        }
        c.options.weld_map = c.weld_map;
    }
    if (partition == SC_PARTITION_ORDER || partition == SC_PARTITION_TREE) {
        uint32_t shuffles = test_random_below(2) != 0 ? s->triangle_count : 0;
        c.order = (uint32_t *)test_allocate(s->triangle_count * sizeof(uint32_t));
        for (uint32_t t = 0; t < s->triangle_count; ++t) c.order[t] = t;
        for (uint32_t t = shuffles; t > 1; --t) {
            uint32_t u = test_random_below(t), swap = c.order[u];
            c.order[u] = c.order[t - 1];
            c.order[t - 1] = swap;
        }
        c.options.order = c.order;
    }
    if (partition == SC_PARTITION_TREE) {
        tree_maker maker;
        c.tree =
            (sc_tree_node *)test_allocate(2 * (size_t)s->triangle_count * sizeof(sc_tree_node));
        maker.nodes = c.tree;
        maker.count = 1;
        maker.leaf_limit = 1 + test_random_below(20);
        maker.is_skewed = test_random_below(4) == 0;
        make_node(&maker, 0, 0, s->triangle_count, 1);
        c.options.tree = c.tree;
        c.options.tree_count = maker.count;
    }
    if (partition == SC_PARTITION_BISECT) {
        static int marker;
        c.options.bisect = input_bisect;
        c.options.bisect_user = test_random_below(2) != 0 ? &marker : NULL;
    }
    return c;
}

void input_free_choices(input_choices *choices)
{
    free(choices->weld_map);
    free(choices->order);
    free(choices->tree);
    memset(choices, 0, sizeof(*choices));
}

uint32_t *input_weld_of(const input_choices *choices, const soup *s)
{
    uint32_t *weld = (uint32_t *)test_allocate(s->vertex_count * sizeof(uint32_t));
    for (uint32_t v = 0; v < s->vertex_count; ++v)
        weld[v] = choices->options.weld == SC_WELD_MAP ? choices->weld_map[v] : v;
    if (choices->options.weld == SC_WELD_REST)
        oracle_weld(s->positions, s->vertex_count, s->triangles, s->triangle_count, weld);
    return weld;
}

sc_status input_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target, uint8_t *side)
{
    for (uint32_t i = 0; i < graph->node_count; ++i) side[i] = i >= left_target;
    if (user != NULL) {
        for (uint32_t i = graph->node_count; i > 1; --i) {
            uint32_t k = test_random_below(i);
            uint8_t swap = side[k];
            side[k] = side[i - 1];
            side[i - 1] = swap;
        }
    }
    return SC_OK;
}

typedef struct growing {
    double *positions;
    uint32_t *triangles;
    uint32_t vertex_count, vertex_room, triangle_count, triangle_room;
} growing;

static void *grow(void *memory, size_t size)
{
    void *grown = realloc(memory, size);
    if (grown == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    return grown;
}

static void add_vertex(growing *g, const double *p)
{
    if (g->vertex_count == g->vertex_room) {
        g->vertex_room = 2 * g->vertex_room + 64;
        g->positions = (double *)grow(g->positions, 3 * (size_t)g->vertex_room * sizeof(double));
    }
    memcpy(g->positions + 3 * (size_t)g->vertex_count++, p, 3 * sizeof(double));
}

static void add_triangle(growing *g, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *v;
    if (g->triangle_count == g->triangle_room) {
        g->triangle_room = 2 * g->triangle_room + 64;
        g->triangles =
            (uint32_t *)grow(g->triangles, 3 * (size_t)g->triangle_room * sizeof(uint32_t));
    }
    v = g->triangles + 3 * (size_t)g->triangle_count++;
    v[0] = a;
    v[1] = b;
    v[2] = c;
}

/* Reads the three numbers of a v line. */
static int read_vertex(growing *g, const char *text)
{
    double p[3];
    for (int i = 0; i < 3; ++i) {
        char *end;
        p[i] = strtod(text, &end);
        if (end == text) return 0;
        text = end;
    }
    add_vertex(g, p);
    return 1;
}

/* Reads the corners of an f line: numbers from 1, or negative from the end, each perhaps with
   /... */
static int read_face(growing *g, const char *text)
{
    uint32_t corner[2] = {0, 0};
    for (uint32_t n = 0;; ++n) {
        char *end;
        long number = strtol(text, &end, 10);
        uint32_t v;
        if (end == text) return n >= 3;
        text = end + strcspn(end, " \t\r\n");
        if (number < 0) number += (long)g->vertex_count + 1;
        if (number < 1 || number > (long)g->vertex_count) return 0;
        v = (uint32_t)(number - 1);
        if (n >= 2) add_triangle(g, corner[0], corner[1], v);
        corner[n == 0 ? 0 : 1] = v;
    }
}

int input_read_obj(const char *path, soup *s)
{
    char line[1024];
    growing g;
    int ok = 1;
    FILE *file = fopen(path, "r");
    memset(s, 0, sizeof(*s));
    memset(&g, 0, sizeof(g));
    if (file == NULL) return 0;
    while (ok && fgets(line, sizeof(line), file) != NULL) {
        if (strncmp(line, "v ", 2) == 0) ok = read_vertex(&g, line + 2);
        if (strncmp(line, "f ", 2) == 0) ok = read_face(&g, line + 2);
    }
    fclose(file);
    if (!ok || g.triangle_count == 0) {
        free(g.positions);
        free(g.triangles);
        return 0;
    }
    s->positions = g.positions;
    s->triangles = g.triangles;
    s->vertex_count = g.vertex_count;
    s->triangle_count = g.triangle_count;
    return 1;
}
