/*
 * Measures methods on a scene; see measure.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "measure.h"

#include "bench_model.h"
#include "floor.h"
#include "lane_pool.h"
#include "near_pairs.h"
#include "tool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* A frame in the forms in which it is asked about, and what each method has to work with. A scene
   is measured on as many of these lanes at once as there are threads. */
typedef struct measure_lane {
    double *frame;   /* as the scene has it */
    double *next;    /* of steps: the frame after it, */
    void *end;       /* and what the library reads of that */
    double *doubles; /* what the hash reads */
    void *positions; /* what the library reads, of the mesh's type */
    method_runner *runners;
    const char *reason; /* of a failed query */
    double milliseconds;
    bool failed;
} measure_lane;

typedef struct measure_state {
    measurement *m;
    scene_folder *scene;
    const measure_options *options;
    method_question question; /* of the options, with the distance */
    sc_model *model;
    method_mesh mesh;
    method_runner reference; /* for the complete set, where no method gives it */
    size_t reference_index;  /* among the methods; method_count: the one above */
    floor_pass *floor;
    measure_lane *lanes; /* options->threads */
    double *times;       /* records * repeats */
    double *broad_times; /* the same, of steps: candidates alone */
    double *floor_times; /* frame_count * (passes or 1) */
    size_t floor_count;
    lane_pool *pool; /* NULL with one thread */
    void (*progress)(const char *what, uint64_t done, uint64_t all);
    uint64_t done, all;     /* turns */
    double wall, processor; /* milliseconds in timed queries */
    char *error;
    size_t error_size;
} measure_state;

/* What a lane is to do. */
typedef struct lane_task {
    measure_state *s;
    size_t method;
} lane_task;

static bool fail(measure_state *s, const char *what, const char *reason)
{
    snprintf(s->error, s->error_size, "%s: %s", what, reason);
    return false;
}

static bool asks_steps(const measure_state *s)
{
    return s->options->question.pairs == METHOD_STEPS;
}

static bool asks_near(const measure_state *s)
{
    return s->options->question.pairs == METHOD_NEAR;
}

static int compare_times(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

static double median(double *times, size_t count)
{
    qsort(times, count, sizeof *times, compare_times);
    return 0.5 * (times[(count - 1) / 2] + times[count / 2]);
}

/* ------------------------------------------------------------------------------------------------
 * Making ready
 */

/* Whether it finds a few pairs more than there are. */
static bool is_loose(const method_kind *kind)
{
    return kind->near == NEAR_STILL;
}

static bool choose_distance(measure_state *s, const double *rest)
{
    double edge;
    s->question = s->options->question;
    if (!asks_near(s)) return true;
    if (!near_method_median_edge(s->scene->triangles, s->scene->triangle_count, rest, &edge))
        return fail(s, "--distance", "out of memory, or no triangle");
    s->question.distance = s->m->distance = s->options->edges * edge;
    return true;
}

static bool build(measure_state *s, const double *rest)
{
    const scene_folder *scene = s->scene;
    sc_build_options options;
    memset(&options, 0, sizeof options);
    for (size_t i = 0; i < s->m->method_count; i++)
        if (s->m->methods[i]->contour == SC_CONTOUR_STAR) options.rest = SC_REST_MARKED;
    const sc_status status =
        bench_model_build(scene, rest, s->options->partition, &options, &s->model, &s->m->build_ms);
    if (status != SC_OK) return fail(s, "the model cannot be built", sc_status_string(status));
    s->m->info.struct_size = sizeof s->m->info;
    sc_model_get_info(s->model, &s->m->info);
    s->mesh.model = s->model;
    s->mesh.triangles = scene->triangles;
    s->mesh.triangle_count = scene->triangle_count;
    s->mesh.vertex_count = scene->vertex_count;
    s->mesh.position_type = scene->single ? SC_FLOAT : SC_DOUBLE;
    return true;
}

static bool open_lane(measure_state *s, measure_lane *lane, const double *rest)
{
    const size_t count = 3 * (size_t)s->scene->vertex_count;
    lane->frame = (double *)malloc(count * sizeof(double));
    lane->doubles = (double *)malloc(count * sizeof(double));
    lane->positions = malloc(count * sizeof(double));
    lane->runners = (method_runner *)calloc(s->m->method_count, sizeof *lane->runners);
    lane->next = (double *)malloc(count * sizeof(double));
    lane->end = malloc(count * sizeof(double));
    if (!lane->frame || !lane->doubles || !lane->positions || !lane->runners || !lane->next ||
        !lane->end)
        return fail(s, "poses", "out of memory");
    for (size_t i = 0; i < s->m->method_count; i++) {
        const method_kind *kind = s->m->methods[i];
        const char *reason;
        if (!method_open(&lane->runners[i], kind, &s->mesh, rest, &reason))
            return fail(s, kind->name, reason);
    }
    return true;
}

/* How often a method is timed in a frame: the hash, which takes as long as all others, once only
   where others have a pass each. */
static uint32_t times_timed(const measure_state *s, size_t method)
{
    const bool once = s->options->mode == MEASURE_ONCE && s->m->methods[method]->is_hash;
    return once ? 1 : s->options->repeats;
}

static bool prepare(measure_state *s)
{
    measurement *m = s->m;
    const measure_options *options = s->options;
    const size_t records = (size_t)m->frame_count * m->method_count;
    const size_t passes = options->mode == MEASURE_ONCE ? options->repeats : 1;
    m->records = (measure_record *)calloc(records, sizeof *m->records);
    s->times = (double *)malloc(records * options->repeats * sizeof *s->times);
    s->broad_times = (double *)malloc(records * options->repeats * sizeof *s->times);
    s->floor_times = (double *)malloc(m->frame_count * passes * sizeof *s->floor_times);
    s->lanes = (measure_lane *)calloc(options->threads, sizeof *s->lanes);
    double *rest = (double *)malloc(3 * (size_t)s->scene->vertex_count * sizeof *rest);
    for (size_t i = 0; i < m->method_count; i++) {
        s->all += m->frame_count * (1 + (passes > 1 ? times_timed(s, i) : passes));
    }
    bool done = m->records && s->times && s->broad_times && s->floor_times && s->lanes && rest;
    if (!done) fail(s, "measuring", "out of memory");
    done = done && scene_folder_frame(s->scene, 0, rest, s->error, s->error_size) == 0 &&
           choose_distance(s, rest) && build(s, rest);
    for (uint32_t i = 0; i < options->threads && done; i++) {
        done = open_lane(s, &s->lanes[i], rest);
    }
    if (done) {
        s->floor = floor_create(&s->mesh);
        if (!s->floor) done = fail(s, "floor", "out of memory");
    }
    if (done && options->threads > 1) {
        s->pool = lane_pool_create(options->threads);
        if (!s->pool) done = fail(s, "threads", "they cannot be started");
    }
    s->reference_index = 0;
    while (s->reference_index < m->method_count &&
           (m->methods[s->reference_index]->unsound || is_loose(m->methods[s->reference_index])))
        s->reference_index++;
    if (done && s->reference_index == m->method_count) {
        const char *reason;
        const char *name = asks_steps(s) ? "step-two-boxes" : asks_near(s) ? "near-boxes" : "aabb";
        done = method_open(&s->reference, method_find(name), &s->mesh, rest, &reason);
        if (!done) fail(s, name, reason);
    }
    free(rest);
    return done;
}

static void close_all(measure_state *s)
{
    lane_pool_free(s->pool);
    for (uint32_t i = 0; s->lanes && i < s->options->threads; i++) {
        measure_lane *lane = &s->lanes[i];
        for (size_t k = 0; lane->runners && k < s->m->method_count; k++) {
            method_close(&lane->runners[k]);
        }
        free(lane->frame);
        free(lane->next);
        free(lane->end);
        free(lane->doubles);
        free(lane->positions);
        free(lane->runners);
    }
    method_close(&s->reference);
    floor_free(s->floor);
    sc_model_free(s->model);
    free(s->lanes);
    free(s->times);
    free(s->broad_times);
    free(s->floor_times);
}

/* ------------------------------------------------------------------------------------------------
 * Passes
 */

static bool load_frame(measure_state *s, measure_lane *lane, uint32_t frame)
{
    return scene_folder_frame(s->scene, frame, lane->frame, s->error, s->error_size) == 0 &&
           (!asks_steps(s) ||
            scene_folder_frame(s->scene, frame + 1, lane->next, s->error, s->error_size) == 0);
}

static void write_positions(const measure_state *s, const double *frame, void *to)
{
    const size_t count = 3 * (size_t)s->scene->vertex_count;
    if (s->scene->single) {
        float *positions = (float *)to;
        for (size_t i = 0; i < count; i++) positions[i] = (float)frame[i];
    } else {
        memcpy(to, frame, count * sizeof(double));
    }
}

/* Writes the pose to where a method reads it, as a simulation would just have done. */
static void write_pose(const measure_state *s, measure_lane *lane, const method_kind *kind)
{
    const size_t count = 3 * (size_t)s->scene->vertex_count;
    if (kind && kind->is_hash) {
        memcpy(lane->doubles, lane->frame, count * sizeof(double));
    } else {
        write_positions(s, lane->frame, lane->positions);
        if (asks_steps(s)) write_positions(s, lane->next, lane->end);
    }
}

static bool run_query(measure_state *s, measure_lane *lane, method_runner *runner, bool compared,
                      sc_stats *stats, double *milliseconds)
{
    const char *reason;
    const method_pose pose = {lane->positions, lane->end, lane->doubles};
    if (method_query(runner, &pose, &s->question, compared, stats, milliseconds, &reason))
        return true;
    lane->reason = reason;
    return false;
}

/* Counts what is in the first sorted list and not in the second. */
static uint64_t count_missing(const method_runner *from, const method_runner *in)
{
    uint64_t missing = 0, j = 0;
    for (uint64_t i = 0; i < from->count; i++) {
        const sc_pair *p = &from->pairs[i];
        while (j < in->count &&
               (in->pairs[j].a < p->a || (in->pairs[j].a == p->a && in->pairs[j].b < p->b)))
            j++;
        if (j == in->count || in->pairs[j].a != p->a || in->pairs[j].b != p->b) missing++;
    }
    return missing;
}

/* A query for pairs and statistics. At rest, where reports take tasks apart, these are of the
   fastest of several: the first touches new memory. */
static bool take_statistics(measure_state *s, measure_lane *lane, uint32_t frame, size_t method)
{
    method_runner *const runner = &lane->runners[method];
    measure_record *const record = &s->m->records[frame * s->m->method_count + method];
    const bool once = runner->kind->is_hash || runner->kind->is_step || runner->kind->near;
    const int queries = frame == 0 && !once ? 5 : 1;
    double least = HUGE_VAL;
    for (int q = 0; q < queries; q++) {
        sc_stats stats;
        double milliseconds;
        if (!run_query(s, lane, runner, true, &stats, &milliseconds)) return false;
        if (milliseconds < least) record->stats = stats;
        least = fmin(least, milliseconds);
    }
    record->pairs = runner->count;
    record->candidates = runner->step.candidates;
    return true;
}

/* The pass that is not timed. */
static bool check_frames(measure_state *s)
{
    measurement *m = s->m;
    measure_lane *lane = &s->lanes[0];
    const method_runner *complete =
        s->reference_index < m->method_count ? &lane->runners[s->reference_index] : &s->reference;
    for (uint32_t frame = 0; frame < m->frame_count; frame++) {
        double unused;
        if (!load_frame(s, lane, frame)) return false;
        write_pose(s, lane, NULL);
        if (complete == &s->reference && !run_query(s, lane, &s->reference, true, NULL, &unused))
            return fail(s, s->reference.kind->name, lane->reason);
        measure_record *records = &m->records[frame * m->method_count];
        uint64_t near = 0;
        if (s->options->count_near &&
            !near_pairs_count(s->mesh.triangles, s->mesh.triangle_count, lane->frame, &near))
            return fail(s, "near pairs", "out of memory");
        for (size_t i = 0; i < m->method_count; i++) {
            records[i].near = near;
            write_pose(s, lane, m->methods[i]);
            if (!take_statistics(s, lane, frame, i))
                return fail(s, m->methods[i]->name, lane->reason);
            if (s->progress) s->progress(m->methods[i]->name, ++s->done, s->all);
        }
        for (size_t i = 0; i < m->method_count; i++) {
            records[i].missed = count_missing(complete, &lane->runners[i]);
            records[i].extra = count_missing(&lane->runners[i], complete);
            if ((records[i].extra && !is_loose(m->methods[i])) ||
                (records[i].missed && !m->methods[i]->unsound))
                m->disagrees = true;
        }
    }
    return true;
}

/* Lets every lane have the room for pairs that the first one turned out to need. */
static bool reserve_pairs(measure_state *s)
{
    for (size_t i = 0; i < s->m->method_count; i++) {
        for (uint32_t lane = 1; lane < s->options->threads; lane++) {
            if (!method_reserve(&s->lanes[lane].runners[i], s->lanes[0].runners[i].room))
                return fail(s, "pairs", "out of memory");
        }
    }
    return true;
}

/* One query on a lane, from whichever thread. */
static void run_lane(void *user, uint32_t number)
{
    const lane_task *task = (const lane_task *)user;
    measure_lane *lane = &task->s->lanes[number];
    lane->failed =
        !run_query(task->s, lane, &lane->runners[task->method], false, NULL, &lane->milliseconds);
}

/* Milliseconds of processor time that this program has taken. */
static double processor_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* One query of a method in each of count lanes; *milliseconds is for one of them. */
static bool run_turn(measure_state *s, size_t method, uint32_t count, double *milliseconds)
{
    lane_task task = {s, method};
    const double wall = tool_clock(), processor = processor_clock();
    if (s->pool) {
        *milliseconds = lane_pool_run(s->pool, count, run_lane, &task) / count;
    } else {
        run_lane(&task, 0);
        *milliseconds = s->lanes[0].milliseconds;
    }
    s->wall += tool_clock() - wall;
    s->processor += processor_clock() - processor;
    for (uint32_t i = 0; i < count; i++) {
        if (s->lanes[i].failed) return fail(s, s->m->methods[method]->name, s->lanes[i].reason);
    }
    return true;
}

/* Frames first to first + count - 1: every method's turn, and the floor's. Every other pass goes
   through the methods backwards, as one finds in the caches what of the model the one before it has
   read. */
static bool run_frames(measure_state *s, uint32_t pass, uint32_t first, uint32_t count)
{
    const measurement *m = s->m;
    const uint32_t repeats = s->options->repeats;
    const uint32_t queries = s->options->mode == MEASURE_ONCE ? 1 : repeats;
    for (uint32_t i = 0; i < count; i++) {
        if (!load_frame(s, &s->lanes[i], first + i)) return false;
    }
    for (size_t turn = 0; turn < m->method_count; turn++) {
        const size_t method = pass % 2 == 0 ? turn : m->method_count - 1 - turn;
        if (pass >= times_timed(s, method)) continue;
        for (uint32_t i = 0; i < count; i++) write_pose(s, &s->lanes[i], m->methods[method]);
        for (uint32_t q = 0; q < queries; q++) {
            double milliseconds;
            if (!run_turn(s, method, count, &milliseconds)) return false;
            for (uint32_t i = 0; i < count; i++) {
                const size_t record = (size_t)(first + i) * m->method_count + method;
                s->times[record * repeats + pass + q] = milliseconds;
                s->broad_times[record * repeats + pass + q] =
                    s->lanes[i].runners[method].step.candidates_ms;
            }
        }
        s->done += count;
        if (s->progress) s->progress(m->methods[method]->name, s->done, s->all);
    }
    write_pose(s, &s->lanes[0], NULL);
    double least = floor_run(s->floor, s->lanes[0].positions);
    for (uint32_t q = 1; q < queries; q++) {
        const double again = floor_run(s->floor, s->lanes[0].positions);
        least = again < least ? again : least;
    }
    s->floor_times[s->floor_count++] = least;
    return true;
}

/* What a method does for the first time (touching new memory, say) is no part of a simulation's
   step. */
static bool start_pass(measure_state *s)
{
    for (size_t method = 0; method < s->m->method_count; method++) {
        for (uint32_t i = 0; i < s->options->threads; i++) {
            double unused;
            if (!load_frame(s, &s->lanes[i], 0)) return false;
            write_pose(s, &s->lanes[i], s->m->methods[method]);
            if (!run_query(s, &s->lanes[i], &s->lanes[i].runners[method], false, NULL, &unused))
                return fail(s, s->m->methods[method]->name, s->lanes[i].reason);
        }
    }
    return true;
}

static bool time_frames(measure_state *s)
{
    const measurement *m = s->m;
    const uint32_t threads = s->options->threads;
    const uint32_t passes = s->options->mode == MEASURE_ONCE ? s->options->repeats : 1;
    for (uint32_t pass = 0; pass < passes; pass++) {
        if (!start_pass(s)) return false;
        for (uint32_t frame = 0; frame < m->frame_count; frame += threads) {
            const uint32_t left = m->frame_count - frame;
            if (!run_frames(s, pass, frame, left < threads ? left : threads)) return false;
        }
    }
    s->m->cpu_share = s->wall > 0.0 ? s->processor / s->wall : 0.0;
    return true;
}

static void summarize(measure_state *s)
{
    measurement *m = s->m;
    const size_t repeats = s->options->repeats;
    for (size_t i = 0; i < (size_t)m->frame_count * m->method_count; i++) {
        const size_t timed = times_timed(s, i % m->method_count);
        m->records[i].ms = median(&s->times[i * repeats], timed);
        m->records[i].ms_min = s->times[i * repeats];
        m->records[i].ms_max = s->times[i * repeats + timed - 1];
        m->records[i].candidates_ms = median(&s->broad_times[i * repeats], timed);
    }
    m->floor_ms = median(s->floor_times, s->floor_count);
    for (size_t i = 0; i < m->method_count; i++) {
        const spatial_hash *hash = s->lanes[0].runners[i].hash;
        if (hash) m->hash_bytes = spatial_hash_bytes(hash);
    }
}

bool measure_run(measurement *m, scene_folder *scene, const measure_options *options,
                 void (*progress)(const char *what, uint64_t done, uint64_t all), char *error,
                 size_t error_size)
{
    measure_state s;
    memset(&s, 0, sizeof s);
    s.m = m;
    s.scene = scene;
    s.options = options;
    s.progress = progress;
    s.error = error;
    s.error_size = error_size;
    m->frame_count = scene->frame_count - (asks_steps(&s) && scene->frame_count > 0);
    bool done;
    if (m->frame_count == 0)
        done = fail(&s, "--pairs step", "a step takes two frames");
    else if (options->partition == BENCH_STRUCTURE && !scene->order)
        done = fail(&s, "--partition structure", "this scene comes without an order of its own");
    else
        done = prepare(&s) && check_frames(&s) && reserve_pairs(&s) && time_frames(&s);
    if (done) summarize(&s);
    close_all(&s);
    if (!done) measure_free(m);
    return done;
}

void measure_free(measurement *m)
{
    free(m->records);
    const method_kind **methods = m->methods;
    const size_t count = m->method_count;
    memset(m, 0, sizeof *m);
    m->methods = methods;
    m->method_count = count;
}
