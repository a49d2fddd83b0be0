/*
 * Scenes of several objects. See object_scenes.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "object_scenes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "shapes.h"
#include "tasks.h"

/* ---- objects ---- */

static sc_model *build(const soup *mesh, uint32_t weld, const uint32_t *map)
{
    sc_build_options options;
    sc_model *model = NULL;
    sc_mesh m;
    memset(&m, 0, sizeof m);
    m.struct_size = sizeof m;
    m.vertex_count = mesh->vertex_count;
    m.triangle_count = mesh->triangle_count;
    m.position_type = SC_DOUBLE;
    m.index_type = SC_UINT32;
    m.positions = mesh->positions;
    m.indices = mesh->triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = weld;
    options.weld_map = map;
    CHECK(sc_build(&m, &options, &model) == SC_OK);
    return model;
}

static sc_workspace *work_for(const sc_model *model, uint32_t workers, uint32_t flags)
{
    sc_workspace_options options = options_for_workers(workers);
    sc_workspace *workspace = NULL;
    options.flags = flags;
    CHECK(sc_workspace_create_for(model, &options, &workspace) == SC_OK);
    return workspace;
}

/* Makes the workspace of an object, which takes its room from another one or not. */
static int open_work(scene *s, uint32_t i)
{
    thing *t = &s->things[i];
    sc_workspace_options options = options_for_workers(t->workers);
    options.flags = s->flags;
    if (t->lender == i + 1) options.flags |= SC_WORKSPACE_ROOM;
    if (t->lender && t->lender <= i) options.room = s->things[t->lender - 1].workspace;
    t->workspace = NULL;
    CHECK(sc_workspace_create_for(t->model, &options, &t->workspace) == SC_OK);
    s->objects[i].workspace = t->workspace;
    return t->workspace != NULL;
}

int scene_renew_work(scene *s)
{
    for (uint32_t i = s->count; i-- > 0;) sc_workspace_free(s->things[i].workspace);
    for (uint32_t i = 0; i < s->count; ++i)
        if (!open_work(s, i)) return 0;
    return 1;
}

/* Half of all models have room for others, which most of their copies use. */
static void choose_lender(scene *s, uint32_t i)
{
    thing *t = &s->things[i];
    const thing *before = t->is_copy ? &s->things[i - 1] : NULL;
    const int lends = test_random_below(2) != 0, uses = test_random_below(4) != 0;
    t->workers = s->workers;
    t->lender = lends ? i + 1 : 0;
    if (before && before->lender && before->workers == t->workers)
        t->lender = uses ? before->lender : 0;
}

/* Hands the poses over as floats or as doubles. */
static void set_poses(thing *t)
{
    const uint32_t count = t->mesh.vertex_count;
    for (int end = 0; end < 2; ++end) {
        if (t->is_float) soup_round_to_float(t->posed[end], count);
        for (uint32_t i = 0; i < 3 * count; ++i) t->floats[end][i] = (float)t->posed[end][i];
        t->pose[end].position_type = t->is_float ? SC_FLOAT : SC_DOUBLE;
        t->pose[end].positions =
            t->is_float ? (const void *)t->floats[end] : (const void *)t->posed[end];
    }
}

/* Where it is at the end: moved as a whole, now and then each vertex by itself, or not at all. */
static void move_thing(thing *t)
{
    const uint32_t count = t->mesh.vertex_count;
    double way[3];
    memcpy(t->posed[1], t->posed[0], sizeof(double) * 3 * count);
    if (test_random_below(5) == 0) return;
    for (int k = 0; k < 3; ++k) way[k] = test_random_range(-0.5, 0.5);
    for (uint32_t i = 0; i < 3 * count; ++i) t->posed[1][i] += way[i % 3];
    if (test_random_below(2)) soup_noise(t->posed[1], count, 0.05);
}

void scene_pose_thing(scene *s, uint32_t i)
{
    thing *t = &s->things[i];
    const uint32_t count = t->mesh.vertex_count;
    const int snaps = test_random_below(3) == 0;
    double offset[3];
    memcpy(t->posed[0], t->mesh.positions, sizeof(double) * 3 * count);
    if (test_random_below(2)) soup_any_pose(t->posed[0], count);
    if (t->is_copy && test_random_below(4) == 0) { /* the same pose as the one it is a copy of */
        memcpy(t->posed[0], s->things[i - 1].posed[0], sizeof(double) * 3 * count);
    } else {
        for (int k = 0; k < 3; ++k) {
            offset[k] = test_random_range(-1, 1) * (test_random_below(3) ? 0.3 : 2);
            if (snaps) offset[k] = round(4 * offset[k]) / 4;
        }
        for (uint32_t v = 0; v < 3 * count; ++v) t->posed[0][v] += offset[v % 3];
        if (snaps) soup_snap(t->posed[0], count, 0.125);
    }
    t->is_float = test_random_below(3) == 0;
    move_thing(t);
    set_poses(t);
}

int scene_open_thing_of(scene *s, uint32_t i, const soup *mesh)
{
    thing *t = &s->things[i];
    sc_object *o = &s->objects[i];
    t->is_copy = !mesh;
    if (!mesh) {
        t->mesh = s->things[i - 1].mesh;
        t->model = s->things[i - 1].model;
        t->weld = s->things[i - 1].weld;
    } else {
        t->mesh = *mesh;
        t->weld = test_random_below(2) ? SC_WELD_REST : SC_WELD_NONE;
        t->model = build(&t->mesh, t->weld, NULL);
        if (!t->model) return 0;
    }
    memset(o, 0, sizeof *o);
    choose_lender(s, i);
    if (!open_work(s, i)) return 0;
    memset(t->pose, 0, sizeof t->pose);
    for (int end = 0; end < 2; ++end) {
        t->posed[end] = (double *)test_allocate(sizeof(double) * 3 * t->mesh.vertex_count);
        t->floats[end] = (float *)test_allocate(sizeof(float) * 3 * t->mesh.vertex_count);
        t->pose[end].struct_size = sizeof t->pose[end];
        t->pose[end].vertex_count = t->mesh.vertex_count;
    }
    o->model = t->model;
    o->pose = &t->pose[0];
    o->itself = test_random_below(4) > 0;
    o->pose_version = test_random_below(2);
    if (test_random_below(4) == 0) {
        o->group.category = 1u + test_random_below(3);
        o->group.mask = 1u + test_random_below(3);
    }
    scene_pose_thing(s, i);
    return 1;
}

int scene_open_thing(scene *s, uint32_t i, uint32_t maximum)
{
    const char *name;
    soup mesh;
    if (i > 0 && test_random_below(3) == 0) return scene_open_thing_of(s, i, NULL);
    mesh = shape_any(2 + test_random_below(maximum), &name);
    return scene_open_thing_of(s, i, &mesh);
}

int scene_open(scene *s, uint32_t most, uint32_t maximum, uint32_t workers, uint32_t flags)
{
    memset(s, 0, sizeof *s);
    s->state = test_random_state();
    s->workers = workers;
    s->flags = flags;
    s->count = 1 + test_random_below(most);
    for (uint32_t i = 0; i < s->count; ++i)
        if (!scene_open_thing(s, i, maximum)) return 0;
    return 1;
}

void scene_close(scene *s)
{
    for (uint32_t i = s->count; i-- > 0;) { /* those that others use last */
        thing *t = &s->things[i];
        sc_workspace_free(t->workspace);
        for (int end = 0; end < 2; ++end) {
            free(t->posed[end]);
            free(t->floats[end]);
        }
        if (t->is_copy) continue;
        sc_model_free(t->model);
        soup_free(&t->mesh);
    }
}

int scene_asks_for(const scene *s, uint32_t a, uint32_t b)
{
    const sc_group all = {~0u, ~0u};
    const sc_group *x = &s->objects[a].group, *y = &s->objects[b].group;
    if (a == b) return s->objects[a].itself != 0;
    if (!x->category && !x->mask) x = &all;
    if (!y->category && !y->mask) y = &all;
    return (x->category & y->mask) && (y->category & x->mask);
}

/* ---- one mesh of all ---- */

/* Which vertices of an object are one: the lowest of those that triangles use. */
static void weld_thing(const thing *t, uint32_t first, uint32_t *map)
{
    const uint32_t count = t->mesh.vertex_count;
    uint8_t *used = (uint8_t *)test_allocate(count);
    memset(used, 0, count);
    for (uint32_t i = 0; i < 3 * t->mesh.triangle_count; ++i) used[t->mesh.triangles[i]] = 1;
    for (uint32_t v = 0; v < count; ++v) {
        const double *p = t->mesh.positions + 3 * (size_t)v;
        map[v] = first + v;
        for (uint32_t u = 0; t->weld == SC_WELD_REST && used[v] && u < v; ++u) {
            const double *q = t->mesh.positions + 3 * (size_t)u;
            if (!used[u] || p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) continue;
            map[v] = first + u;
            break;
        }
    }
    free(used);
}

int whole_scene_open(whole_scene *whole, const scene *s)
{
    uint32_t vertices = 0, triangles = 0, *map;
    memset(whole, 0, sizeof *whole);
    whole->count = s->count;
    for (uint32_t i = 0; i < s->count; ++i) {
        whole->first_vertex[i] = vertices;
        whole->first_triangle[i] = triangles;
        vertices += s->things[i].mesh.vertex_count;
        triangles += s->things[i].mesh.triangle_count;
    }
    whole->mesh = soup_make(vertices, triangles);
    map = (uint32_t *)test_allocate(sizeof *map * vertices);
    for (int end = 0; end < 2; ++end) {
        whole->posed[end] = (double *)test_allocate(sizeof(double) * 3 * vertices);
        whole->pose[end].struct_size = sizeof whole->pose[end];
        whole->pose[end].vertex_count = vertices;
        whole->pose[end].position_type = SC_DOUBLE;
        whole->pose[end].positions = whole->posed[end];
    }
    for (uint32_t i = 0; i < s->count; ++i) {
        const thing *t = &s->things[i];
        const uint32_t first = whole->first_vertex[i];
        const size_t at = 3 * (size_t)first, count = 3 * (size_t)t->mesh.vertex_count;
        memcpy(whole->mesh.positions + at, t->mesh.positions, count * sizeof(double));
        for (int end = 0; end < 2; ++end)
            memcpy(whole->posed[end] + at, t->posed[end], count * sizeof(double));
        for (uint32_t k = 0; k < 3 * t->mesh.triangle_count; ++k)
            whole->mesh.triangles[3 * (size_t)whole->first_triangle[i] + k] =
                first + t->mesh.triangles[k];
        weld_thing(t, first, map + first);
    }
    whole->model = build(&whole->mesh, SC_WELD_MAP, map);
    free(map);
    whole->workspace = whole->model ? work_for(whole->model, 1, s->flags) : NULL;
    return whole->workspace != NULL;
}

void whole_scene_close(whole_scene *whole)
{
    sc_workspace_free(whole->workspace);
    sc_model_free(whole->model);
    soup_free(&whole->mesh);
    for (int end = 0; end < 2; ++end) free(whole->posed[end]);
}

uint32_t whole_scene_split(const whole_scene *whole, const uint32_t *first, uint32_t *number)
{
    uint32_t i = whole->count - 1;
    while (first[i] > *number) --i;
    *number -= first[i];
    return i;
}

/* ---- what is to be found ---- */

int found_compare(const void *x, const void *y)
{
    const found *p = (const found *)x, *q = (const found *)y;
    const int turned[2] = {p->object_a > p->object_b, q->object_a > q->object_b};
    const uint32_t low[2] = {turned[0] ? p->object_b : p->object_a,
                             turned[1] ? q->object_b : q->object_a};
    const uint32_t high[2] = {turned[0] ? p->object_a : p->object_b,
                              turned[1] ? q->object_a : q->object_b};
    if (low[0] != low[1]) return low[0] < low[1] ? -1 : 1;
    if (high[0] != high[1]) return high[0] < high[1] ? -1 : 1;
    if (turned[0] != turned[1]) return turned[0] - turned[1];
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return p->b == q->b ? 0 : p->b < q->b ? -1 : 1;
}

uint64_t found_list_ranges(const found_list *wanted)
{
    uint64_t count = 0, i;
    for (i = 0; i < wanted->count; ++i)
        count += i == 0 || wanted->at[i].object_a != wanted->at[i - 1].object_a ||
                 wanted->at[i].object_b != wanted->at[i - 1].object_b;
    return count;
}
