/*
 * Prints what the library answers about meshes, as tests/wasm/answers.mjs does with the package for
 * npm: the same bits are the same lines.
 *
 *     answers FOLDER FILE.obj...     also writes FOLDER/FILE.obj.scm, the saved model
 *
 * Questions: pairs of triangles and of edges, where they meet, contours, their gradients and
 * regions, where they cross, what is near, its closest points and bounds, and steps with times;
 * each on three poses, which are made by additions and products alone.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "starcontour.h"

enum { CAPACITY = 1 << 16, POSES = 3 };

static uint32_t sum;

/* Words in the order of their bytes on a little-endian machine, as WebAssembly has them. */
static void add(const void *data, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)data;
    for (size_t i = 0; i < size; ++i) sum = (sum ^ bytes[i]) * 16777619u;
}

static void tell(const char *file, int pose, const char *what, uint64_t count)
{
    printf("%s %d %s %" PRIu64 " %08" PRIx32 "\n", file, pose, what, count, sum);
    sum = 2166136261u;
}

static void need(sc_status status, const char *what)
{
    if (status == SC_OK) return;
    fprintf(stderr, "%s: %s\n", what, sc_status_string(status));
    exit(1);
}

static void ask_trace(const sc_model *model, const sc_pose *pose, const sc_pair *pairs,
                      uint64_t count, const char *file, int number)
{
    static sc_trace_node nodes[CAPACITY];
    static sc_trace_contour contours[CAPACITY];
    static sc_trace_gradient gradients[CAPACITY];
    static sc_trace_triple triples[CAPACITY];
    static sc_region regions[CAPACITY];
    static sc_contour_sides sides[CAPACITY];
    uint32_t *vertex_regions = (uint32_t *)test_allocate(pose->vertex_count * sizeof(uint32_t));
    sc_trace_result t = {.struct_size = sizeof(t),
                         .node_capacity = CAPACITY,
                         .nodes = nodes,
                         .contour_capacity = CAPACITY,
                         .contours = contours};
    sc_triples_result p = {.struct_size = sizeof(p), .capacity = CAPACITY, .triples = triples};
    sc_regions_result r = {.struct_size = sizeof(r),
                           .flags = SC_REGIONS_INSIDE,
                           .region_capacity = CAPACITY,
                           .regions = regions,
                           .vertex_regions = vertex_regions,
                           .sides = sides};
    need(sc_trace(model, pose, pairs, count, NULL, &t), "sc_trace");
    for (uint64_t i = 0; i < t.node_count; ++i) {
        add(&nodes[i].edge, sizeof(nodes[i].edge));
        add(&nodes[i].triangle, sizeof(nodes[i].triangle));
        add(&nodes[i].sheet, sizeof(nodes[i].sheet));
        add(nodes[i].sheets, sizeof(nodes[i].sheets));
        add(&nodes[i].along, sizeof(nodes[i].along));
        add(nodes[i].weights, sizeof(nodes[i].weights));
        add(nodes[i].point, sizeof(nodes[i].point));
    }
    for (uint64_t i = 0; i < t.contour_count; ++i) {
        const uint32_t range[2] = {(uint32_t)contours[i].first, (uint32_t)contours[i].count};
        add(range, sizeof(range));
        add(&contours[i].begin, sizeof(contours[i].begin));
        add(&contours[i].end, sizeof(contours[i].end));
        add(&contours[i].flags, sizeof(contours[i].flags));
        add(&contours[i].length, sizeof(contours[i].length));
    }
    tell(file, number, "trace", t.node_count);
    need(sc_trace_gradients(model, pose, &t, gradients), "sc_trace_gradients");
    for (uint64_t i = 0; i < t.node_count; ++i) {
        add(gradients[i].vertices, sizeof(gradients[i].vertices));
        add(&gradients[i].flags, sizeof(gradients[i].flags));
        add(gradients[i].weights, sizeof(gradients[i].weights));
        add(gradients[i].vectors, sizeof(gradients[i].vectors));
    }
    tell(file, number, "gradients", t.node_count);
    need(sc_trace_triples(model, pose, &t, NULL, &p), "sc_trace_triples");
    for (uint64_t i = 0; i < p.count; ++i) {
        add(triples[i].triangles, sizeof(triples[i].triangles));
        for (int k = 0; k < 3; ++k) {
            const uint32_t node = (uint32_t)triples[i].nodes[k];
            add(&node, sizeof(node));
        }
        add(triples[i].along, sizeof(triples[i].along));
        add(triples[i].point, sizeof(triples[i].point));
    }
    tell(file, number, "triples", p.count);
    need(sc_trace_regions(model, pose, &t, NULL, &r), "sc_trace_regions");
    for (uint64_t i = 0; i < r.region_count; ++i) {
        add(&regions[i].component, sizeof(regions[i].component));
        add(&regions[i].vertex_count, sizeof(regions[i].vertex_count));
        add(&regions[i].area, sizeof(regions[i].area));
        add(&regions[i].inside, sizeof(regions[i].inside));
    }
    add(vertex_regions, pose->vertex_count * sizeof(*vertex_regions));
    add(sides, t.contour_count * sizeof(*sides));
    tell(file, number, "regions", r.region_count);
    free(vertex_regions);
}

static void ask_pairs(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                      uint32_t kind, const char *file, int number)
{
    static sc_pair pairs[CAPACITY];
    static sc_contact contacts[CAPACITY];
    sc_query_options o = {.struct_size = sizeof(o), .pairs = kind};
    sc_result r = {.struct_size = sizeof(r), .capacity = CAPACITY, .pairs = pairs};
    need(sc_query(model, workspace, pose, &o, &r), "sc_query");
    add(pairs, r.count * sizeof(*pairs));
    tell(file, number, kind ? "edges" : "triangles", r.count);
    need(sc_contacts(model, pose, kind, pairs, r.count, contacts), "sc_contacts");
    for (uint64_t i = 0; i < r.count; ++i) {
        add(&contacts[i].kind, sizeof(contacts[i].kind));
        add(contacts[i].points, sizeof(contacts[i].points));
        add(contacts[i].weights_a, sizeof(contacts[i].weights_a));
        add(contacts[i].weights_b, sizeof(contacts[i].weights_b));
    }
    tell(file, number, "contacts", r.count);
    if (kind == SC_PAIRS_EDGE) ask_trace(model, pose, pairs, r.count, file, number);
}

static void add_stencil(const sc_near_stencil *stencil)
{
    add(&stencil->feature, sizeof(stencil->feature));
    add(stencil->vertices, sizeof(stencil->vertices));
    add(stencil->weights, sizeof(stencil->weights));
    add(stencil->vector, sizeof(stencil->vector));
    add(&stencil->distance, sizeof(stencil->distance));
}

static void add_stencils(const sc_model *model, const sc_pose *pose, uint32_t kind,
                         const sc_pair *pairs, uint64_t count)
{
    static sc_near_stencil stencils[CAPACITY];
    need(sc_near_stencils(model, pose, kind, pairs, count, stencils), "sc_near_stencils");
    for (uint64_t i = 0; i < count; ++i) add_stencil(&stencils[i]);
}

static void add_step_stencils(const sc_model *model, const sc_pose *start, const sc_pose *end,
                              uint32_t kind, const sc_pair *pairs, const double *times,
                              uint64_t count)
{
    static sc_step_stencil stencils[CAPACITY];
    need(sc_step_stencils(model, start, end, kind, pairs, times, count, stencils),
         "sc_step_stencils");
    for (uint64_t i = 0; i < count; ++i) add_stencil(&stencils[i].start);
    for (uint64_t i = 0; i < count; ++i) add_stencil(&stencils[i].impact);
    for (uint64_t i = 0; i < count; ++i) add(&stencils[i].time, sizeof(stencils[i].time));
    for (uint64_t i = 0; i < count; ++i) add(stencils[i].normal, sizeof(stencils[i].normal));
    for (uint64_t i = 0; i < count; ++i) add(&stencils[i].side, sizeof(stencils[i].side));
    for (uint64_t i = 0; i < count; ++i) add(&stencils[i].flags, sizeof(stencils[i].flags));
}

static void ask_features(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                         const sc_pose *end, double distance, const char *file, int number)
{
    static sc_pair faces[CAPACITY], edges[CAPACITY];
    static double face_times[CAPACITY], edge_times[CAPACITY];
    double *bounds = (double *)test_allocate(pose->vertex_count * sizeof(*bounds));
    sc_near_options o = {.struct_size = sizeof(o), .distance = distance};
    sc_near_result r = {.struct_size = sizeof(r),
                        .vertex_faces = faces,
                        .edge_edges = edges,
                        .vertex_face_capacity = CAPACITY,
                        .edge_edge_capacity = CAPACITY,
                        .vertex_bounds = bounds};
    sc_step_options how = {
        .struct_size = sizeof(how), .times = SC_STEP_TIMES_EACH, .separation = distance / 4};
    sc_step_result s = {.struct_size = sizeof(s),
                        .vertex_faces = faces,
                        .edge_edges = edges,
                        .vertex_face_capacity = CAPACITY,
                        .edge_edge_capacity = CAPACITY,
                        .vertex_face_times = face_times,
                        .edge_edge_times = edge_times};
    need(sc_query_near(model, workspace, pose, &o, &r), "sc_query_near");
    add(faces, r.vertex_face_count * sizeof(*faces));
    add(edges, r.edge_edge_count * sizeof(*edges));
    add(bounds, pose->vertex_count * sizeof(*bounds));
    tell(file, number, "near", r.vertex_face_count + r.edge_edge_count);
    add_stencils(model, pose, SC_NEAR_VERTEX_FACE, faces, r.vertex_face_count);
    add_stencils(model, pose, SC_NEAR_EDGE_EDGE, edges, r.edge_edge_count);
    tell(file, number, "stencils", r.vertex_face_count + r.edge_edge_count);
    need(sc_query_step(model, workspace, pose, end, &how, &s), "sc_query_step");
    add(faces, s.vertex_face_count * sizeof(*faces));
    add(edges, s.edge_edge_count * sizeof(*edges));
    add(face_times, s.vertex_face_count * sizeof(*face_times));
    add(edge_times, s.edge_edge_count * sizeof(*edge_times));
    add(&s.earliest, sizeof(s.earliest));
    add_step_stencils(model, pose, end, SC_NEAR_VERTEX_FACE, faces, face_times,
                      s.vertex_face_count);
    add_step_stencils(model, pose, end, SC_NEAR_EDGE_EDGE, edges, edge_times, s.edge_edge_count);
    tell(file, number, "step", s.vertex_face_count + s.edge_edge_count);
    free(bounds);
}

/* As it is, sheared, and folded. */
static void move(const soup *rest, int number, double *positions)
{
    for (uint32_t v = 0; v < rest->vertex_count; ++v) {
        const double *from = rest->positions + 3 * (size_t)v;
        double *to = positions + 3 * (size_t)v;
        memcpy(to, from, 3 * sizeof(double));
        if (number == 1) to[2] = from[2] * 0.5 + from[0] * from[1];
        if (number == 2) to[0] = from[0] * from[0] - 0.25 * from[1];
    }
}

static void save(const sc_model *model, const char *folder, const char *name)
{
    char path[1000];
    uint64_t size = 0;
    void *data;
    FILE *file;
    need(sc_model_save_size(model, &size), "sc_model_save_size");
    data = test_allocate(size);
    need(sc_model_save(model, data, size, NULL), "sc_model_save");
    snprintf(path, sizeof(path), "%s/%s.scm", folder, name);
    file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file)) {
        fprintf(stderr, "cannot write %s\n", path);
        exit(1);
    }
    free(data);
}

static void ask(const char *folder, const char *path)
{
    const char *file = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    soup rest;
    sc_mesh mesh;
    sc_model *model;
    sc_workspace *workspace;
    sc_workspace_options how = {.struct_size = sizeof(how), .flags = SC_WORKSPACE_NEAR};
    double *positions[2], low = 1e300, high = -1e300;
    if (!input_read_obj(path, &rest)) {
        fprintf(stderr, "cannot read %s\n", path);
        exit(1);
    }
    mesh = input_plain_mesh(&rest);
    need(sc_build(&mesh, NULL, &model), "sc_build");
    need(sc_workspace_create_for(model, &how, &workspace), "sc_workspace_create_for");
    save(model, folder, file);
    for (uint32_t i = 0; i < 3 * rest.vertex_count; ++i) {
        low = rest.positions[i] < low ? rest.positions[i] : low;
        high = rest.positions[i] > high ? rest.positions[i] : high;
    }
    for (int i = 0; i < 2; ++i)
        positions[i] = (double *)test_allocate(3 * (size_t)rest.vertex_count * sizeof(double));
    for (int i = 0; i < POSES; ++i) {
        sc_pose pose = input_plain_pose(positions[0], rest.vertex_count);
        sc_pose end = input_plain_pose(positions[1], rest.vertex_count);
        move(&rest, i, positions[0]);
        move(&rest, (i + 1) % POSES, positions[1]);
        ask_pairs(model, workspace, &pose, SC_PAIRS_TRIANGLE, file, i);
        ask_pairs(model, workspace, &pose, SC_PAIRS_EDGE, file, i);
        ask_features(model, workspace, &pose, &end, (high - low) / 64, file, i);
    }
    free(positions[0]);
    free(positions[1]);
    sc_workspace_free(workspace);
    sc_model_free(model);
    soup_free(&rest);
}

int main(int argc, char **argv)
{
    sum = 2166136261u;
    for (int i = 2; i < argc; ++i) ask(argv[1], argv[i]);
    return argc > 2 ? 0 : 1;
}
