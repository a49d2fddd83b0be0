/*
 * sc-objects: several objects in one query, beside one mesh of all of them and beside each of them
 * alone.
 *
 * SPDX-License-Identifier: MIT
 *
 *     sc-objects [options]
 *
 * Scenes:
 *   body    a cloth of 20,000 triangles that sinks onto a body of a million that does not move
 *   crowd   a hundred characters of 10,000 triangles, which share one model, all of them moving
 *   layers  two layers of cloth of 65,522 triangles, half an edge apart, moving in waves
 * Questions:
 *   query   what intersects
 *   near    what is within half an edge
 *   step    what collides on the way to the next frame, with a thousandth of an edge between
 * Ways, one after the other in each frame, of which the least time counts; the time of a scene is
 * the sum over its frames divided by their number:
 *   objects  one call about all objects; the version of what does not move stays
 *   cut      the same, where something does not move: of it no more than the triangles that come
 *            near what moves, in any frame
 *   merged   one mesh of all of them; where something is not asked about itself, groups of vertices
 *            leave its own pairs out
 *   alone    each that is asked about itself by itself, in a call of its own
 *
 * The first three must have as many pairs as one another, or the exit status is 1. 2: something
 * could not be done.
 *
 * With --export nothing is timed: scenes are written for others to be timed on (bench/peers), each
 * as a folder with a file objects.txt. It has a line "FOLDER ITSELF" for each object: a scene
 * folder (scene_folder.h) in it, of one frame if the object does not move, and whether it is asked
 * about itself, 1 or 0.
 */
#include "scene_folder.h"
#include "thread_pool.h"
#include "tool.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char usage[] =
    "Usage: sc-objects [options]\n"
    "Times queries about several objects beside one mesh of all of them.\n"
    "\n"
    "  --scene NAME      body, crowd or layers; by default all\n"
    "  --scale F         so many times the triangles (1)\n"
    "  --frames N        frames of each scene (8)\n"
    "  --rounds N        rounds in each frame (5)\n"
    "  --workers N       threads of each query (1)\n"
    "  --own-rooms       objects of one model do not use one room\n"
    "  --csv FILE        a line for each scene, question and way as well\n"
    "  --export FOLDER   time nothing, but write each scene into a folder there, for other\n"
    "                    libraries: bench/peers/README.md\n"
    "  -h, --help\n"
    "\n"
    "Exit status: 0, 1 where numbers of pairs differ, 2 if something could not be done.\n";

enum { OBJECTS_MAX = 100, QUERY = 0, NEAR = 1, STEP = 2, QUESTIONS = 3 };
enum { OBJECTS = 0, CUT = 1, MERGED = 2, ALONE = 3, WAYS = 4 };

static const char *const question_names[QUESTIONS] = {"query", "near", "step"};
static const char *const way_names[WAYS] = {"objects", "cut", "merged", "alone"};

/* A mesh, and what the library made of it. */
typedef struct part {
    uint32_t vertex_count, triangle_count;
    double *rest;
    uint32_t *triangles;
    sc_model *model;
    uint32_t object_count;
    sc_workspace *room; /* whose room all objects of it but the first use, or NULL: each its own */
} part;

/* An object: a part in two poses, of a frame and of the next one. */
typedef struct object {
    part *of;
    bool moves, itself;
    double *at[2];
    sc_workspace *workspace;
    sc_pose pose[2];
} object;

typedef struct run {
    double scale;
    uint32_t frames, rounds, workers;
    const char *scene, *csv, *folder;
    FILE *csv_file;
    bool own_rooms;
    thread_pool *pool;
    bool differs;
} run;

typedef struct scene {
    const char *name;
    part parts[2], whole;
    uint32_t part_count, count;
    object objects[OBJECTS_MAX];
    part near;      /* of an object that does not move, what comes near others */
    object cut;     /* that as an object, */
    uint32_t still; /* in place of this one; or as many as there are objects: none */
    double *whole_at[2];
    sc_pose whole_pose[2];
    sc_workspace *whole_workspace;
    sc_group *groups;           /* of vertices of the whole, or NULL */
    sc_filter filter;           /* with these */
    double edge;                /* a typical length of one */
    double ms[QUESTIONS][WAYS]; /* sums over frames */
    uint64_t pairs[QUESTIONS][WAYS];
    sc_pair *lists[2];
    double *times[2];
    uint64_t room;
} scene;

/* ---- meshes ---- */

static bool make_part(part *p, uint32_t vertices, uint32_t triangles)
{
    p->vertex_count = vertices;
    p->triangle_count = triangles;
    p->rest = (double *)malloc(sizeof(double) * 3 * vertices);
    p->triangles = (uint32_t *)malloc(sizeof(uint32_t) * 3 * triangles);
    return p->rest && p->triangles;
}

/* A cloth from -1 to 1 with n cells along each side. */
static bool make_cloth(part *p, uint32_t n)
{
    uint32_t *t;
    if (!make_part(p, (n + 1) * (n + 1), 2 * n * n)) return false;
    for (uint32_t j = 0; j <= n; j++) {
        for (uint32_t i = 0; i <= n; i++) {
            double *const at = p->rest + 3 * (size_t)(j * (n + 1) + i);
            at[0] = 2.0 * i / n - 1;
            at[1] = 2.0 * j / n - 1;
            at[2] = 0;
        }
    }
    t = p->triangles;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++, t += 6) {
            const uint32_t a = j * (n + 1) + i, b = a + n + 1;
            const uint32_t two[6] = {a, a + 1, b + 1, a, b + 1, b};
            memcpy(t, two, sizeof two);
        }
    }
    return true;
}

/* A torus round the z axis, of about so many triangles as square as cells can be: of radius 0.7,
   and 0.3 thick on each side. */
static bool make_torus(part *p, double triangles)
{
    const uint32_t around = (uint32_t)sqrt(triangles / 2 * 7 / 3), n = around * 3 / 7;
    uint32_t *t;
    if (!make_part(p, around * n, 2 * around * n)) return false;
    for (uint32_t j = 0; j < around; j++) {
        for (uint32_t i = 0; i < n; i++) {
            const double turn = 2 * acos(-1) * j / around, angle = 2 * acos(-1) * i / n;
            double *const at = p->rest + 3 * (size_t)(j * n + i);
            at[0] = (0.7 + 0.3 * cos(angle)) * cos(turn);
            at[1] = (0.7 + 0.3 * cos(angle)) * sin(turn);
            at[2] = 0.3 * sin(angle);
        }
    }
    t = p->triangles;
    for (uint32_t j = 0; j < around; j++) {
        for (uint32_t i = 0; i < n; i++, t += 6) {
            const uint32_t a = j * n + i, b = j * n + (i + 1) % n;
            const uint32_t c = (j + 1) % around * n + i, d = (j + 1) % around * n + (i + 1) % n;
            const uint32_t two[6] = {a, c, d, a, d, b};
            memcpy(t, two, sizeof two);
        }
    }
    return true;
}

static bool build(part *p, const uint32_t *weld_map)
{
    sc_build_options options;
    sc_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = p->vertex_count;
    mesh.triangle_count = p->triangle_count;
    mesh.position_type = SC_DOUBLE;
    mesh.positions = p->rest;
    mesh.indices = p->triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = weld_map ? SC_WELD_MAP : SC_WELD_NONE;
    options.weld_map = weld_map;
    options.hooks = tool_hooks();
    return sc_build(&mesh, &options, &p->model) == SC_OK;
}

static void free_part(part *p)
{
    sc_workspace_free(p->room);
    sc_model_free(p->model);
    free(p->rest);
    free(p->triangles);
}

/* ---- scenes ---- */

static sc_workspace *work_for(const run *r, const sc_model *model, uint32_t flags,
                              sc_workspace *room)
{
    sc_workspace_options options;
    sc_workspace *workspace = NULL;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.workers = r->workers;
    options.flags = SC_WORKSPACE_NEAR | flags;
    options.room = room;
    (void)sc_workspace_create_for(model, &options, &workspace);
    return workspace;
}

static bool make_object(const run *r, object *o, part *of, bool moves, bool itself)
{
    o->of = of;
    o->moves = moves;
    o->itself = itself;
    if (of->object_count++ && !of->room && !r->own_rooms)
        of->room = work_for(r, of->model, SC_WORKSPACE_ROOM, NULL);
    o->workspace = work_for(r, of->model, 0, of->room);
    for (int k = 0; k < 2; k++) {
        o->at[k] = (double *)malloc(sizeof(double) * 3 * of->vertex_count);
        if (!o->at[k]) return false;
        memcpy(o->at[k], of->rest, sizeof(double) * 3 * of->vertex_count);
        o->pose[k] = tool_pose(o->at[k], SC_DOUBLE, of->vertex_count);
    }
    return o->workspace != NULL;
}

static bool add_object(const run *r, scene *s, part *of, bool moves, bool itself)
{
    return make_object(r, &s->objects[s->count++], of, moves, itself);
}

static bool make_body(const run *r, scene *s)
{
    s->part_count = 2;
    s->edge = 2 / (100 * sqrt(r->scale));
    return make_cloth(&s->parts[0], (uint32_t)(100 * sqrt(r->scale))) &&
           make_torus(&s->parts[1], 1e6 * r->scale) && build(&s->parts[0], NULL) &&
           build(&s->parts[1], NULL) && add_object(r, s, &s->parts[0], true, true) &&
           add_object(r, s, &s->parts[1], false, false);
}

static bool make_crowd(const run *r, scene *s)
{
    s->part_count = 1;
    s->edge = 4.4 / sqrt(5000. * 7 / 3 * r->scale);
    if (!make_torus(&s->parts[0], 1e4 * r->scale) || !build(&s->parts[0], NULL)) return false;
    while (s->count < OBJECTS_MAX)
        if (!add_object(r, s, &s->parts[0], true, true)) return false;
    return true;
}

static bool make_layers(const run *r, scene *s)
{
    s->part_count = 1;
    s->edge = 2 / (181 * sqrt(r->scale));
    return make_cloth(&s->parts[0], (uint32_t)(181 * sqrt(r->scale))) &&
           build(&s->parts[0], NULL) && add_object(r, s, &s->parts[0], true, true) &&
           add_object(r, s, &s->parts[0], true, true);
}

/* Where vertex v of an object is at a time. */
static void place_body(const scene *s, uint32_t number, double time, const double *rest, double *at)
{
    const double x = rest[0], y = rest[1];
    (void)s;
    memcpy(at, rest, 3 * sizeof *at);
    if (number) return;
    at[2] = 0.305 - 0.002 * time + 0.01 * sin(7 * x + time) * cos(5 * y);
}

static void place_crowd(const scene *s, uint32_t number, double time, const double *rest,
                        double *at)
{
    const double phase = 1.7 * number + 0.3 * time;
    (void)s;
    at[0] = rest[0] * (1 + 0.1 * sin(9 * rest[2] + phase)) + 1.95 * (number % 10);
    at[1] = rest[1] * (1 + 0.1 * cos(8 * rest[2] - phase)) + 1.95 * (number / 10);
    at[2] = rest[2] + 0.1 * sin(phase);
}

static void place_layers(const scene *s, uint32_t number, double time, const double *rest,
                         double *at)
{
    const double x = rest[0], y = rest[1];
    at[0] = x + 0.2 * s->edge * number;
    at[1] = y;
    at[2] = 0.1 * sin(4 * x + 0.2 * time) * cos(3 * y) +
            number * s->edge * (0.5 + 0.1 * sin(31 * x + time));
}

static const struct {
    const char *name;
    bool (*make)(const run *r, scene *s);
    void (*place)(const scene *s, uint32_t number, double time, const double *rest, double *at);
} kinds[] = {{"body", make_body, place_body},
             {"crowd", make_crowd, place_crowd},
             {"layers", make_layers, place_layers}};

/* Groups by which what is not asked about itself does not collide with its like. */
static bool make_groups(scene *s)
{
    bool wanted = false;
    uint32_t at = 0;
    for (uint32_t i = 0; i < s->count; i++) wanted |= !s->objects[i].itself;
    if (!wanted) return true;
    s->groups = (sc_group *)malloc(sizeof *s->groups * s->whole.vertex_count);
    if (!s->groups) return false;
    for (uint32_t i = 0; i < s->count; i++) {
        const sc_group group = {s->objects[i].itself ? 1u : 2u, s->objects[i].itself ? 3u : 1u};
        for (uint32_t v = 0; v < s->objects[i].of->vertex_count; v++) s->groups[at++] = group;
    }
    s->filter.struct_size = sizeof s->filter;
    s->filter.vertex_groups = s->groups;
    return true;
}

/* One mesh of all, in which nothing is welded. */
static bool make_whole(const run *r, scene *s)
{
    uint32_t vertices = 0, triangles = 0, *map;
    bool good;
    for (uint32_t i = 0; i < s->count; i++) {
        vertices += s->objects[i].of->vertex_count;
        triangles += s->objects[i].of->triangle_count;
    }
    if (!make_part(&s->whole, vertices, triangles)) return false;
    vertices = triangles = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const part *const p = s->objects[i].of;
        memcpy(s->whole.rest + 3 * (size_t)vertices, s->objects[i].at[0],
               sizeof(double) * 3 * p->vertex_count);
        for (uint32_t k = 0; k < 3 * p->triangle_count; k++)
            s->whole.triangles[3 * (size_t)triangles + k] = vertices + p->triangles[k];
        vertices += p->vertex_count;
        triangles += p->triangle_count;
    }
    map = (uint32_t *)malloc(sizeof *map * vertices);
    for (uint32_t v = 0; map && v < vertices; v++) map[v] = v;
    good = map && build(&s->whole, map);
    free(map);
    for (int k = 0; k < 2 && good; k++) {
        s->whole_at[k] = (double *)malloc(sizeof(double) * 3 * vertices);
        good = s->whole_at[k] != NULL;
        s->whole_pose[k] = tool_pose(s->whole_at[k], SC_DOUBLE, vertices);
    }
    if (good) s->whole_workspace = work_for(r, s->whole.model, 0, NULL);
    return good && s->whole_workspace && make_groups(s);
}

/* Poses all for a frame and the next one. */
static void place(scene *s, size_t kind, uint32_t frame)
{
    for (int k = 0; k < 2; k++) {
        size_t first = 0;
        for (uint32_t i = 0; i < s->count; i++) {
            object *const o = &s->objects[i];
            for (uint32_t v = 0; v < o->of->vertex_count; v++)
                kinds[kind].place(s, i, (double)frame + k, o->of->rest + 3 * (size_t)v,
                                  o->at[k] + 3 * (size_t)v);
            memcpy(s->whole_at[k] + 3 * first, o->at[k], sizeof(double) * 3 * o->of->vertex_count);
            first += o->of->vertex_count;
        }
    }
}

/* The box of all that moves, in all frames, and half an edge round it. */
static void find_reach(const run *r, const scene *s, size_t kind, double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
    for (uint32_t i = 0; i < s->count; i++) {
        const part *const p = s->objects[i].of;
        for (uint32_t frame = 0; frame <= r->frames && s->objects[i].moves; frame++) {
            for (uint32_t v = 0; v < p->vertex_count; v++) {
                double at[3];
                kinds[kind].place(s, i, frame, p->rest + 3 * (size_t)v, at);
                for (int k = 0; k < 3; k++) {
                    low[k] = fmin(low[k], at[k] - s->edge / 2);
                    high[k] = fmax(high[k], at[k] + s->edge / 2);
                }
            }
        }
    }
}

/* Cuts an object that does not move down to the triangles whose boxes meet that box. */
static bool make_cut(const run *r, scene *s, size_t kind)
{
    const part *all;
    double low[3], high[3];
    uint32_t count = 0;
    for (s->still = 0; s->still < s->count && s->objects[s->still].moves;) s->still++;
    if (s->still == s->count) return true;
    all = s->objects[s->still].of;
    if (!make_part(&s->near, all->vertex_count, all->triangle_count)) return false;
    memcpy(s->near.rest, all->rest, sizeof(double) * 3 * all->vertex_count);
    find_reach(r, s, kind, low, high);
    for (uint32_t t = 0; t < all->triangle_count; t++) {
        const uint32_t *const corner = all->triangles + 3 * (size_t)t;
        bool meets = true;
        for (int k = 0; k < 3; k++) {
            const double a = all->rest[3 * (size_t)corner[0] + (size_t)k];
            const double b = all->rest[3 * (size_t)corner[1] + (size_t)k];
            const double c = all->rest[3 * (size_t)corner[2] + (size_t)k];
            meets = meets && fmin(a, fmin(b, c)) <= high[k] && fmax(a, fmax(b, c)) >= low[k];
        }
        if (meets) memcpy(s->near.triangles + 3 * (size_t)count++, corner, 3 * sizeof *corner);
    }
    s->near.triangle_count = count;
    return build(&s->near, NULL) &&
           make_object(r, &s->cut, &s->near, false, s->objects[s->still].itself);
}

static void free_object(const object *o)
{
    sc_workspace_free(o->workspace);
    for (int k = 0; k < 2; k++) free(o->at[k]);
}

static void free_scene(scene *s)
{
    for (uint32_t i = 0; i < s->count; i++) free_object(&s->objects[i]);
    free_object(&s->cut);
    free_part(&s->near);
    for (uint32_t i = 0; i < 2; i++) {
        free_part(&s->parts[i]);
        free(s->whole_at[i]);
        free(s->lists[i]);
        free(s->times[i]);
    }
    free(s->groups);
    sc_workspace_free(s->whole_workspace);
    free_part(&s->whole);
}

/* ---- asking ---- */

/* Room for that many pairs in both lists. */
static bool make_room(scene *s, uint64_t count)
{
    s->room = count + count / 4 + 1000;
    for (int k = 0; k < 2; k++) {
        free(s->lists[k]);
        free(s->times[k]);
        s->lists[k] = (sc_pair *)malloc(sizeof(sc_pair) * s->room);
        s->times[k] = (double *)malloc(sizeof(double) * s->room);
        if (!s->lists[k] || !s->times[k]) return false;
    }
    return true;
}

static sc_step_options step_options(const run *r, const scene *s)
{
    sc_step_options o;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.times = SC_STEP_TIMES_EACH;
    o.separation = s->edge / 1000;
    o.tolerance = s->edge / 10000;
    o.tasks = thread_pool_tasks(r->pool);
    return o;
}

static sc_near_options near_options(const run *r, const scene *s)
{
    sc_near_options o;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.distance = s->edge / 2;
    o.tasks = thread_pool_tasks(r->pool);
    return o;
}

static sc_query_options query_options(const run *r)
{
    sc_query_options o;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.tasks = thread_pool_tasks(r->pool);
    return o;
}

/* A question about one mesh; count: how many pairs there are, of the longer list if there are
   two. */
static sc_status ask_one(const run *r, scene *s, int question, const sc_model *model,
                         sc_workspace *workspace, const sc_pose pose[2], uint64_t *longest,
                         uint64_t *count)
{
    const sc_filter *const filter = model == s->whole.model && s->groups ? &s->filter : NULL;
    sc_status status;
    if (question == QUERY) {
        sc_query_options o = query_options(r);
        sc_result result;
        o.filter = filter;
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        result.pairs = s->lists[0];
        result.capacity = s->room;
        status = sc_query(model, workspace, &pose[0], &o, &result);
        *longest = *count = result.count;
    } else if (question == NEAR) {
        sc_near_options o = near_options(r, s);
        sc_near_result result;
        o.vertex_face_filter = o.edge_edge_filter = filter;
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        result.vertex_faces = s->lists[0];
        result.edge_edges = s->lists[1];
        result.vertex_face_capacity = result.edge_edge_capacity = s->room;
        status = sc_query_near(model, workspace, &pose[0], &o, &result);
        *count = result.vertex_face_count + result.edge_edge_count;
        *longest = result.vertex_face_count > result.edge_edge_count ? result.vertex_face_count
                                                                     : result.edge_edge_count;
    } else {
        sc_step_options o = step_options(r, s);
        sc_step_result result;
        o.vertex_face_filter = o.edge_edge_filter = filter;
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        result.vertex_faces = s->lists[0];
        result.edge_edges = s->lists[1];
        result.vertex_face_times = s->times[0];
        result.edge_edge_times = s->times[1];
        result.vertex_face_capacity = result.edge_edge_capacity = s->room;
        status = sc_query_step(model, workspace, &pose[0], &pose[1], &o, &result);
        *count = result.vertex_face_count + result.edge_edge_count;
        *longest = result.vertex_face_count > result.edge_edge_count ? result.vertex_face_count
                                                                     : result.edge_edge_count;
    }
    return status;
}

static sc_status ask_objects(const run *r, scene *s, int question, int way, uint64_t version,
                             uint64_t *longest, uint64_t *count)
{
    sc_object objects[OBJECTS_MAX];
    sc_objects all;
    sc_status status;
    memset(objects, 0, sizeof objects);
    for (uint32_t i = 0; i < s->count; i++) {
        const object *const o = way == CUT && i == s->still ? &s->cut : &s->objects[i];
        objects[i].model = o->of->model;
        objects[i].workspace = o->workspace;
        objects[i].pose = &o->pose[0];
        objects[i].end = question == STEP && o->moves ? &o->pose[1] : NULL;
        objects[i].pose_version = o->moves ? version : 1;
        objects[i].itself = o->itself;
    }
    memset(&all, 0, sizeof all);
    all.struct_size = sizeof all;
    all.count = s->count;
    all.objects = objects;
    if (question == QUERY) {
        const sc_query_options o = query_options(r);
        sc_objects_result result;
        memset(&result, 0, sizeof result);
        result.struct_size = sizeof result;
        result.pairs = s->lists[0];
        result.capacity = s->room;
        status = sc_query_objects(&all, &o, &result);
        *longest = *count = result.count;
    } else {
        const sc_near_options near = near_options(r, s);
        const sc_step_options step = step_options(r, s);
        sc_objects_lists lists;
        memset(&lists, 0, sizeof lists);
        lists.struct_size = sizeof lists;
        lists.vertex_faces.pairs = s->lists[0];
        lists.edge_edges.pairs = s->lists[1];
        lists.vertex_faces.times = s->times[0];
        lists.edge_edges.times = s->times[1];
        lists.vertex_faces.capacity = lists.edge_edges.capacity = s->room;
        status = question == NEAR ? sc_query_objects_near(&all, &near, &lists)
                                  : sc_query_objects_step(&all, &step, &lists);
        *count = lists.vertex_faces.count + lists.edge_edges.count;
        *longest = lists.vertex_faces.count > lists.edge_edges.count ? lists.vertex_faces.count
                                                                     : lists.edge_edges.count;
    }
    return status;
}

/* Asks in one way, again with more room if that was too little; *ms is the time of the last
   time. */
static bool ask(const run *r, scene *s, int question, int way, uint64_t version, double *ms,
                uint64_t *count)
{
    sc_status status;
    do {
        const double start = tool_clock();
        uint64_t longest = 0, some;
        status = SC_OK;
        if (way == OBJECTS || way == CUT)
            status = ask_objects(r, s, question, way, version, &longest, count);
        else if (way == MERGED)
            status = ask_one(r, s, question, s->whole.model, s->whole_workspace, s->whole_pose,
                             &longest, count);
        else
            *count = 0;
        for (uint32_t i = 0; way == ALONE && i < s->count && !status; i++) {
            const object *const o = &s->objects[i];
            uint64_t most = 0;
            if (!o->itself) continue;
            status = ask_one(r, s, question, o->of->model, o->workspace, o->pose, &most, &some);
            *count += some;
            if (most > longest) longest = most;
        }
        *ms = tool_clock() - start;
        if (status == SC_ERROR_SHORT_BUFFER && !make_room(s, longest)) return false;
    } while (status == SC_ERROR_SHORT_BUFFER);
    if (status) tool_error("%s: %s", s->name, tool_why(status));
    return !status;
}

static bool is_asked(const scene *s, int way)
{
    return way != CUT || s->still < s->count;
}

/* The ways of all questions, one after the other, as a way that comes after another one finds the
   processor's caches full of that one's. In each call the version is a new one, and of what stays
   it is not. */
static bool time_frame(run *r, scene *s)
{
    static uint64_t version = 2;
    for (int question = 0; question < QUESTIONS; question++) {
        double least[WAYS] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}, ms;
        uint64_t count[WAYS] = {0, 0, 0, 0};
        for (int way = 0; way < WAYS; way++) {
            for (uint32_t round = 0; round <= r->rounds && is_asked(s, way); round++, version++) {
                if (!ask(r, s, question, way, version, &ms, &count[way])) return false;
                if (round && ms < least[way]) least[way] = ms;
            }
        }
        for (int way = 0; way < WAYS; way++) {
            if (!is_asked(s, way)) continue;
            s->ms[question][way] += least[way];
            s->pairs[question][way] += count[way];
        }
    }
    return true;
}

/* ---- the report ---- */

static void print_line(const run *r, const scene *s, int question)
{
    const double *const ms = s->ms[question];
    const uint64_t *const pairs = s->pairs[question];
    char cut[32] = "-", ratio[32] = "-";
    if (is_asked(s, CUT)) {
        snprintf(cut, sizeof cut, "%.3f", ms[CUT] / r->frames);
        snprintf(ratio, sizeof ratio, "%.2f", ms[OBJECTS] / ms[CUT]);
    }
    printf("%-8s %-6s %8u %8u %12.1f %10.3f %10s %10.3f %10.3f %8s %8.2f %8.2f\n", s->name,
           question_names[question], s->count, r->workers, (double)pairs[OBJECTS] / r->frames,
           ms[OBJECTS] / r->frames, cut, ms[MERGED] / r->frames, ms[ALONE] / r->frames, ratio,
           ms[MERGED] / ms[OBJECTS], ms[OBJECTS] / ms[ALONE]);
    for (int way = 0; way < WAYS && r->csv_file; way++)
        if (is_asked(s, way))
            fprintf(r->csv_file, "%s,%s,%u,%u,%s,%.1f,%.4f\n", s->name, question_names[question],
                    s->count, r->workers, way_names[way], (double)pairs[way] / r->frames,
                    ms[way] / r->frames);
}

/* Pairs of one object with itself, which are not asked of all objects, are in the mesh of all. */
static bool time_scene(run *r, size_t kind)
{
    scene *const s = (scene *)calloc(1, sizeof *s);
    bool good;
    if (!s) return false;
    s->name = kinds[kind].name;
    good =
        make_room(s, 100000) && kinds[kind].make(r, s) && make_whole(r, s) && make_cut(r, s, kind);
    if (!good) tool_error("%s: out of memory", s->name);
    for (uint32_t frame = 0; frame < r->frames && good; frame++) {
        place(s, kind, frame);
        good = time_frame(r, s);
    }
    for (int question = 0; question < QUESTIONS && good; question++) {
        const uint64_t *const pairs = s->pairs[question];
        print_line(r, s, question);
        for (int way = CUT; way <= MERGED; way++) {
            if (!is_asked(s, way) || pairs[OBJECTS] == pairs[way]) continue;
            tool_error("%s, %s: objects have %llu pairs, %s %llu", s->name,
                       question_names[question], (unsigned long long)pairs[OBJECTS],
                       way == CUT ? "with what is near of them" : "the mesh of all of them",
                       (unsigned long long)pairs[way]);
            r->differs = true;
        }
    }
    free_scene(s);
    free(s);
    return good;
}

/* ---- scenes for others ---- */

static bool make_folder(const char *path)
{
    errno = 0;
    if (mkdir(path, 0777) == 0 || errno == EEXIST) return true;
    tool_error("%s: cannot be made: %s", path, strerror(errno));
    return false;
}

/* An object in all frames, or in one if it does not move. */
static bool export_object(const run *r, scene *s, size_t kind, uint32_t number, const char *path)
{
    const object *const o = &s->objects[number];
    const part *const p = o->of;
    char error[512] = "", more[256];
    scene_writer *const writer = scene_writer_begin(path, p->triangle_count, p->vertex_count,
                                                    p->triangles, NULL, false, error, sizeof error);
    bool good = writer != NULL;
    for (uint32_t frame = 0; frame < (o->moves ? r->frames : 1) && good; frame++) {
        for (uint32_t v = 0; v < p->vertex_count; v++)
            kinds[kind].place(s, number, frame, p->rest + 3 * (size_t)v, o->at[0] + 3 * (size_t)v);
        good = scene_writer_frame(writer, o->at[0], error, sizeof error) == 0;
    }
    if (writer && scene_writer_end(writer, good, more, sizeof more) != 0 && good) {
        tool_error("%s", more);
        return false;
    }
    if (!good) tool_error("%s", error);
    return good;
}

/* The list comes last, so that what was broken off is no scene. */
static bool export_scene(const run *r, size_t kind)
{
    scene *const s = (scene *)calloc(1, sizeof *s);
    const size_t room = strlen(r->folder) + strlen(kinds[kind].name) + 32;
    char *const path = (char *)malloc(room);
    FILE *list = NULL;
    bool good = s && path && kinds[kind].make(r, s);
    if (!good) tool_error("%s: out of memory", kinds[kind].name);
    if (good) {
        snprintf(path, room, "%s/%s", r->folder, kinds[kind].name);
        good = make_folder(r->folder) && make_folder(path);
    }
    for (uint32_t i = 0; i < (s ? s->count : 0) && good; i++) {
        snprintf(path, room, "%s/%s/%u", r->folder, kinds[kind].name, i);
        good = export_object(r, s, kind, i, path);
    }
    if (good) {
        snprintf(path, room, "%s/%s/objects.txt", r->folder, kinds[kind].name);
        list = fopen(path, "w");
        for (uint32_t i = 0; list && i < s->count; i++)
            fprintf(list, "%u %d\n", i, s->objects[i].itself);
        good = list && fclose(list) == 0;
        if (!good) tool_error("%s: cannot be written", path);
    }
    if (s) free_scene(s);
    free(s);
    free(path);
    return good;
}

/* ---- all that was asked for ---- */

static bool run_scenes(run *r)
{
    bool good = true, known = !r->scene;
    if (r->workers > 1 && !(r->pool = thread_pool_create(r->workers))) return false;
    if (r->csv && !r->folder) {
        r->csv_file = fopen(r->csv, "w");
        if (!r->csv_file) {
            tool_error("%s: cannot be written", r->csv);
            return false;
        }
        fprintf(r->csv_file, "scene,question,objects,workers,way,pairs,ms\n");
    }
    if (!r->folder)
        printf("%-8s %-6s %8s %8s %12s %10s %10s %10s %10s %8s %8s %8s\n", "scene", "asked",
               "objects", "workers", "pairs", "objects,ms", "cut,ms", "merged,ms", "alone,ms",
               "/ cut", "gain", "/ alone");
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds && good; kind++) {
        if (r->scene && strcmp(r->scene, kinds[kind].name) != 0) continue;
        known = true;
        good = r->folder ? export_scene(r, kind) : time_scene(r, kind);
    }
    if (!known) tool_error("--scene: there is no scene '%s'; see sc-objects --help", r->scene);
    if (r->csv_file && fclose(r->csv_file) != 0) good = false;
    return good && known;
}

int main(int argc, char **argv)
{
    enum {
        OPTION_SCENE = 256,
        OPTION_SCALE,
        OPTION_FRAMES,
        OPTION_ROUNDS,
        OPTION_WORKERS,
        OPTION_OWN_ROOMS,
        OPTION_CSV,
        OPTION_EXPORT
    };
    static const struct option options[] = {{"scene", required_argument, NULL, OPTION_SCENE},
                                            {"scale", required_argument, NULL, OPTION_SCALE},
                                            {"frames", required_argument, NULL, OPTION_FRAMES},
                                            {"rounds", required_argument, NULL, OPTION_ROUNDS},
                                            {"workers", required_argument, NULL, OPTION_WORKERS},
                                            {"own-rooms", no_argument, NULL, OPTION_OWN_ROOMS},
                                            {"csv", required_argument, NULL, OPTION_CSV},
                                            {"export", required_argument, NULL, OPTION_EXPORT},
                                            {"help", no_argument, NULL, 'h'},
                                            {NULL, 0, NULL, 0}};
    run r;
    bool good = true;
    int option;
    tool_set_name("sc-objects");
    memset(&r, 0, sizeof r);
    r.scale = 1;
    r.frames = 8;
    r.rounds = 5;
    r.workers = 1;
    while (good && (option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        if (option == OPTION_SCENE)
            r.scene = optarg;
        else if (option == OPTION_SCALE)
            good = tool_parse_real("--scale", optarg, &r.scale);
        else if (option == OPTION_FRAMES)
            good = tool_parse_number("--frames", optarg, 1, 1000, &r.frames);
        else if (option == OPTION_ROUNDS)
            good = tool_parse_number("--rounds", optarg, 1, 1000, &r.rounds);
        else if (option == OPTION_WORKERS)
            good = tool_parse_number("--workers", optarg, 1, SC_WORKERS_MAX, &r.workers);
        else if (option == OPTION_OWN_ROOMS)
            r.own_rooms = true;
        else if (option == OPTION_CSV)
            r.csv = optarg;
        else if (option == OPTION_EXPORT)
            r.folder = optarg;
        else if (option == 'h') {
            fputs(usage, stdout);
            return tool_finish(0);
        } else
            good = false;
    }
    if (good && !(r.scale >= 0.001 && r.scale <= 16)) {
        tool_error("--scale must be from 0.001 to 16");
        good = false;
    }
    if (good) good = run_scenes(&r);
    thread_pool_free(r.pool);
    return tool_finish(!good ? 2 : r.differs ? 1 : 0);
}
