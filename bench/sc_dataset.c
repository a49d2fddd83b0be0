/*
 * sc-dataset: many poses of one character, as in a dataset, several at a time.
 *
 * SPDX-License-Identifier: MIT
 *
 *     sc-dataset [options]
 *
 * Asks sc_query_batch for all pairs of triangles of each pose, touching, by one worker and by
 * several, in turns: a chunk of poses is made in memory, without a clock, then asked about by one
 * worker, then by all of them, or, every other chunk, the other way round. Every answer must be the
 * same by one worker and by several; every so many poses it must be that of sc_query alone, by the
 * default method and by boxes. If one is not, the exit status is 1. 2: something could not be done.
 *
 * Times are those of the calls alone: the sum over chunks, divided by the number of poses, and the
 * median over chunks, which other programs disturb less. Where poses have more pairs than there is
 * room for, the chunk is asked about again with more.
 */
#include "scene_folder.h"
#include "scenes/character.h"
#include "thread_pool.h"
#include "tool.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char usage[] =
    "Usage: sc-dataset [options]\n"
    "Times sc_query_batch on many poses of one character, by one worker and by several.\n"
    "\n"
    "  --poses N         how many (100000)\n"
    "  --triangles N     of the character, 2000 or more (25000)\n"
    "  --workers N       threads, with a query each (2)\n"
    "  --chunk N         poses of one call (256)\n"
    "  --check N         every N-th pose is asked about by sc_query as well; 0: none (100)\n"
    "  --grid N          round coordinates to multiples of 1/N, as packed datasets do; 0: not (0)\n"
    "  --csv FILE        a line for each number of workers as well\n"
    "  --export FOLDER   write the character at rest and these poses as frames of a scene, and\n"
    "                    measure nothing\n"
    "  -h, --help\n"
    "\n"
    "Exit status: 0, 1 where answers differ, 2 if something could not be done.\n";

/* How one worker, and how several did. */
enum { ONE = 0, SEVERAL = 1, WAYS = 2 };

typedef struct way {
    uint32_t workers;
    thread_pool *pool;
    sc_workspace **workspaces; /* workers */
    sc_result *results;        /* chunk; arrays are parts of pairs */
    sc_status *statuses;       /* chunk */
    sc_pair *pairs;            /* chunk * room */
    double ms, *chunk_ms;      /* of all calls, and a pose in each chunk */
    double busy;               /* milliseconds of processors in all calls */
    uint64_t colliding, pair_count;
} way;

typedef struct run {
    uint32_t poses, triangles, workers, chunk, check, grid;
    const char *csv, *folder;
    character body;
    sc_model *model;
    float *positions; /* of a chunk */
    sc_pose *at;      /* of each in a chunk */
    uint64_t room;    /* pairs of each */
    way ways[WAYS];
    uint32_t way_count; /* 1 if there is one worker */
    uint32_t chunks, checked;
    bool differs;
} run;

static sc_status build(run *r)
{
    sc_build_options options;
    sc_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = sizeof mesh;
    mesh.vertex_count = r->body.vertex_count;
    mesh.triangle_count = r->body.triangle_count;
    mesh.position_type = SC_FLOAT;
    mesh.positions = r->body.rest;
    mesh.indices = r->body.triangles;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.weld = SC_WELD_NONE;
    options.hooks = tool_hooks();
    return sc_build(&mesh, &options, &r->model);
}

/* Room for so many pairs of each pose. */
static bool make_room(run *r, uint64_t room)
{
    r->room = room;
    for (uint32_t i = 0; i < r->way_count; i++) {
        way *const w = &r->ways[i];
        free(w->pairs);
        w->pairs = (sc_pair *)malloc(sizeof(sc_pair) * r->chunk * room);
        if (!w->pairs) return false;
        for (uint32_t k = 0; k < r->chunk; k++) {
            memset(&w->results[k], 0, sizeof w->results[k]);
            w->results[k].struct_size = sizeof w->results[k];
            w->results[k].capacity = room;
            w->results[k].pairs = w->pairs + k * room;
        }
    }
    return true;
}

static bool make_way(const run *r, way *w, uint32_t workers)
{
    w->workers = workers;
    if (workers > 1 && !(w->pool = thread_pool_create(workers))) return false;
    w->workspaces = (sc_workspace **)calloc(workers, sizeof(sc_workspace *));
    w->results = (sc_result *)calloc(r->chunk, sizeof *w->results);
    w->statuses = (sc_status *)calloc(r->chunk, sizeof *w->statuses);
    w->chunk_ms = (double *)calloc(r->chunks, sizeof *w->chunk_ms);
    if (!w->workspaces || !w->results || !w->statuses || !w->chunk_ms) return false;
    for (uint32_t i = 0; i < workers; i++)
        if (sc_workspace_create(r->model, NULL, &w->workspaces[i])) return false;
    return true;
}

static bool prepare(run *r)
{
    const size_t numbers = 3 * (size_t)r->body.vertex_count;
    r->chunks = (r->poses + r->chunk - 1) / r->chunk;
    r->way_count = r->workers > 1 ? WAYS : 1;
    r->positions = (float *)malloc(sizeof(float) * numbers * r->chunk);
    r->at = (sc_pose *)malloc(sizeof(sc_pose) * r->chunk);
    if (!r->positions || !r->at) return false;
    for (uint32_t k = 0; k < r->chunk; k++)
        r->at[k] = tool_pose(r->positions + k * numbers, SC_FLOAT, r->body.vertex_count);
    for (uint32_t i = 0; i < r->way_count; i++)
        if (!make_way(r, &r->ways[i], i == ONE ? 1 : r->workers)) return false;
    return make_room(r, 4096);
}

static void free_run(run *r)
{
    for (uint32_t i = 0; i < WAYS; i++) {
        way *const w = &r->ways[i];
        for (uint32_t k = 0; k < w->workers && w->workspaces; k++)
            sc_workspace_free(w->workspaces[k]);
        thread_pool_free(w->pool);
        free(w->workspaces);
        free(w->results);
        free(w->statuses);
        free(w->pairs);
        free(w->chunk_ms);
    }
    sc_model_free(r->model);
    free(r->positions);
    free(r->at);
    character_free(&r->body);
}

/* ---- asking ---- */

static sc_query_options query_options(const way *w)
{
    sc_query_options o;
    memset(&o, 0, sizeof o);
    o.struct_size = sizeof o;
    o.tasks = w ? thread_pool_tasks(w->pool) : NULL;
    return o;
}

/* Asks about the first count poses of the chunk; *ms is what the call took, *busy the time of all
   threads on processors. */
static sc_status ask(const run *r, const way *w, uint32_t count, double *ms, double *busy)
{
    const sc_query_options options = query_options(w);
    const clock_t before = clock();
    const double start = tool_clock();
    const sc_status status =
        sc_query_batch(r->model, w->workspaces, r->at, count, &options, w->results, w->statuses);
    *ms = tool_clock() - start;
    *busy = 1000.0 * (double)(clock() - before) / CLOCKS_PER_SEC;
    return status;
}

static bool same(const sc_result *a, const sc_result *b)
{
    return a->count == b->count && a->collides == b->collides &&
           memcmp(a->pairs, b->pairs, sizeof(sc_pair) * a->count) == 0;
}

/* Whether sc_query alone says the same of a pose of the chunk, by the default method and by
   boxes. */
static bool alone(run *r, uint32_t k)
{
    const uint32_t methods[] = {SC_METHOD_DEFAULT, SC_METHOD_AABB};
    sc_pair *const pairs = (sc_pair *)malloc(sizeof(sc_pair) * r->room);
    bool right = pairs != NULL;
    for (int m = 0; m < 2 && right; m++) {
        sc_query_options options = query_options(NULL);
        sc_result result = r->ways[ONE].results[k];
        options.method = methods[m];
        result.pairs = pairs;
        right =
            sc_query(r->model, r->ways[ONE].workspaces[0], &r->at[k], &options, &result) == SC_OK &&
            same(&result, &r->ways[ONE].results[k]);
    }
    free(pairs);
    r->checked++;
    return right;
}

static void compare(run *r, uint32_t first, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        const sc_result *const one = &r->ways[ONE].results[k];
        if (r->way_count > 1 && !same(one, &r->ways[SEVERAL].results[k])) {
            tool_error("pose %u: several workers find something else than one", first + k);
            r->differs = true;
        }
        if (r->check && (first + k) % r->check == 0 && !alone(r, k)) {
            tool_error("pose %u: sc_query finds something else than sc_query_batch", first + k);
            r->differs = true;
        }
    }
}

static void make_pose(const run *r, uint32_t number, float *positions)
{
    character_pose(&r->body, number, positions);
    for (size_t i = 0; r->grid && i < 3 * (size_t)r->body.vertex_count; i++)
        positions[i] = (float)(rint((double)positions[i] * r->grid) / r->grid);
}

/* Makes a chunk of poses and asks about it in both ways. */
static bool time_chunk(run *r, uint32_t chunk)
{
    const uint32_t first = chunk * r->chunk;
    const uint32_t count = r->poses - first < r->chunk ? r->poses - first : r->chunk;
    for (uint32_t k = 0; k < count; k++)
        make_pose(r, first + k, r->positions + (size_t)3 * r->body.vertex_count * k);
    for (uint32_t turn = 0; turn < r->way_count; turn++) {
        way *const w = &r->ways[(turn + chunk) % r->way_count];
        double ms, busy;
        sc_status status = ask(r, w, count, &ms, &busy);
        if (status == SC_ERROR_SHORT_BUFFER) {
            uint64_t most = 0;
            for (uint32_t k = 0; k < count; k++)
                if (w->results[k].count > most) most = w->results[k].count;
            if (!make_room(r, 2 * most)) {
                tool_error("out of memory");
                return false;
            }
            turn = UINT32_MAX; /* from the beginning, as all arrays are new */
            continue;
        }
        if (status) {
            tool_error("sc_query_batch: %s", tool_why(status));
            return false;
        }
        w->chunk_ms[chunk] = ms / count;
        w->busy += busy;
    }
    for (uint32_t i = 0; i < r->way_count; i++) {
        way *const w = &r->ways[i];
        w->ms += w->chunk_ms[chunk] * count;
        for (uint32_t k = 0; k < count; k++) {
            w->colliding += w->results[k].collides;
            w->pair_count += w->results[k].count;
        }
    }
    compare(r, first, count);
    return true;
}

/* ---- the report ---- */

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Milliseconds a pose, by workers: mean and median over chunks, which are sorted here; the mean for
   each core; the time of all threads on processors; and which part of the time all workers were on
   one, less than 1 where other programs were, too. */
static bool report(run *r)
{
    FILE *file = r->csv ? fopen(r->csv, "w") : NULL;
    double median[WAYS], mean[WAYS];
    if (r->csv && !file) {
        tool_error("%s: cannot be written", r->csv);
        return false;
    }
    if (file)
        fprintf(file, "triangles,poses,chunk,workers,ms,ms_median,cpu_share,colliding,pairs,"
                      "checked,differs\n");
    printf("%9s %9s %7s %10s %10s %10s %10s %9s %9s %12s\n", "triangles", "poses", "workers",
           "ms a pose", "median", "ms a core", "cpu, ms", "cpu share", "colliding", "pairs");
    for (uint32_t i = 0; i < r->way_count; i++) {
        way *const w = &r->ways[i];
        const double share = w->busy / (w->ms * w->workers);
        const unsigned long long colliding = w->colliding, pairs = w->pair_count;
        qsort(w->chunk_ms, r->chunks, sizeof *w->chunk_ms, compare_doubles);
        median[i] = w->chunk_ms[r->chunks / 2];
        mean[i] = w->ms / r->poses;
        printf("%9u %9u %7u %10.4f %10.4f %10.4f %10.4f %9.3f %9llu %12llu\n",
               r->body.triangle_count, r->poses, w->workers, mean[i], median[i],
               mean[i] * w->workers, w->busy / r->poses, share, colliding, pairs);
        if (file)
            fprintf(file, "%u,%u,%u,%u,%.5f,%.5f,%.4f,%llu,%llu,%u,%d\n", r->body.triangle_count,
                    r->poses, r->chunk, w->workers, mean[i], median[i], share, colliding, pairs,
                    r->checked, r->differs);
    }
    if (r->way_count > 1)
        printf("throughput of %u workers: %.3f times that of one; by medians %.3f\n", r->workers,
               mean[ONE] / mean[SEVERAL], median[ONE] / median[SEVERAL]);
    printf("%u poses also by sc_query; %s\n", r->checked,
           r->differs ? "ANSWERS DIFFER" : "all answers are the same");
    if (file && fclose(file) != 0) {
        tool_error("%s: cannot be written", r->csv);
        return false;
    }
    return true;
}

/* Writes the character at rest, and all poses. */
static bool export_poses(const run *r)
{
    const size_t numbers = 3 * (size_t)r->body.vertex_count;
    float *const floats = (float *)malloc(sizeof(float) * numbers);
    double *const doubles = (double *)malloc(sizeof(double) * numbers);
    char error[256] = "out of memory";
    scene_writer *writer = NULL;
    bool good = floats && doubles;
    if (good)
        writer = scene_writer_begin(r->folder, r->body.triangle_count, r->body.vertex_count,
                                    r->body.triangles, NULL, true, error, sizeof error);
    good = writer != NULL;
    for (uint32_t frame = 0; frame <= r->poses && good; frame++) {
        if (frame)
            make_pose(r, frame - 1, floats);
        else
            memcpy(floats, r->body.rest, sizeof(float) * numbers);
        for (size_t i = 0; i < numbers; i++) doubles[i] = (double)floats[i];
        good = scene_writer_frame(writer, doubles, error, sizeof error) == 0;
    }
    if (writer) {
        char more[256];
        const int ended = scene_writer_end(writer, good, more, sizeof more);
        if (good && ended) memcpy(error, more, sizeof error);
        good &= ended == 0;
    }
    if (!good) tool_error("%s", error);
    free(floats);
    free(doubles);
    return good;
}

static bool go(run *r)
{
    sc_status status;
    bool good = true;
    if (!character_make(&r->body, r->triangles)) {
        tool_error("out of memory");
        return false;
    }
    if (r->folder) return export_poses(r);
    status = build(r);
    if (status) {
        tool_error("the character: %s", tool_why(status));
        return false;
    }
    if (!prepare(r)) {
        tool_error("out of memory, or no threads");
        return false;
    }
    for (uint32_t chunk = 0; chunk < r->chunks && good; chunk++) good = time_chunk(r, chunk);
    return good && report(r);
}

int main(int argc, char **argv)
{
    enum {
        OPTION_POSES = 256,
        OPTION_TRIANGLES,
        OPTION_WORKERS,
        OPTION_CHUNK,
        OPTION_CHECK,
        OPTION_GRID,
        OPTION_CSV,
        OPTION_EXPORT
    };
    static const struct option options[] = {
        {"poses", required_argument, NULL, OPTION_POSES},
        {"triangles", required_argument, NULL, OPTION_TRIANGLES},
        {"workers", required_argument, NULL, OPTION_WORKERS},
        {"chunk", required_argument, NULL, OPTION_CHUNK},
        {"check", required_argument, NULL, OPTION_CHECK},
        {"grid", required_argument, NULL, OPTION_GRID},
        {"csv", required_argument, NULL, OPTION_CSV},
        {"export", required_argument, NULL, OPTION_EXPORT},
        {"help", no_argument, NULL, 'h'},
        {NULL, 0, NULL, 0}};
    run r;
    bool good = true;
    int option;
    tool_set_name("sc-dataset");
    memset(&r, 0, sizeof r);
    r.poses = 100000;
    r.triangles = 25000;
    r.workers = 2;
    r.chunk = 256;
    r.check = 100;
    while (good && (option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
        if (option == OPTION_POSES)
            good = tool_parse_number("--poses", optarg, 1, 100000000, &r.poses);
        else if (option == OPTION_TRIANGLES)
            good = tool_parse_number("--triangles", optarg, CHARACTER_TRIANGLES_MIN,
                                     CHARACTER_TRIANGLES_MAX, &r.triangles);
        else if (option == OPTION_WORKERS)
            good = tool_parse_number("--workers", optarg, 1, SC_WORKERS_MAX, &r.workers);
        else if (option == OPTION_CHUNK)
            good = tool_parse_number("--chunk", optarg, 1, 1000000, &r.chunk);
        else if (option == OPTION_CHECK)
            good = tool_parse_number("--check", optarg, 0, 100000000, &r.check);
        else if (option == OPTION_GRID)
            good = tool_parse_number("--grid", optarg, 0, 1u << 20, &r.grid);
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
    if (good && optind < argc) {
        tool_error("'%s' is no option", argv[optind]);
        good = false;
    }
    if (good) good = go(&r);
    free_run(&r);
    return tool_finish(!good ? 2 : r.differs ? 1 : 0);
}
