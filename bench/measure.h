/*
 * Measures methods on a scene, frame by frame in turn, and checks that they agree.
 *
 * SPDX-License-Identifier: MIT
 *
 * First a pass over all frames that is not timed: it compares the pairs of every method with the
 * complete set, takes the statistics (which cost time) and enlarges the arrays for pairs. Then the
 * timed passes; in each frame every method has its turn before the next frame comes. A turn is
 *   MEASURE_ONCE  one query, as in a simulation: the other methods' work lies between it and the
 *                 method's last one. There are as many passes over the animation as repeats are
 *                 asked for, each beginning with a query of the first frame that does not count.
 *                 The hash, the slowest by far, has its turns in the first of them only.
 *   MEASURE_WARM  as many queries of the same pose as repeats are asked for, one after the other.
 * Before each turn the pose is written anew to where queries read it, as a simulation would.
 *
 * Where steps are asked about (METHOD_STEPS), a frame is the step from it to the next. Where it is
 * asked what is near (METHOD_NEAR), a step that does not move may find more: that is counted, and
 * no disagreement.
 *
 * With several threads, each has a workspace of its own for the same model, and they work on as
 * many frames at once. A frame's time is then that of all of them, divided by their number: a
 * measure of throughput. A single query always runs on one thread.
 */
#ifndef BENCH_MEASURE_H
#define BENCH_MEASURE_H

#include "methods.h"
#include "scene_folder.h"

enum { MEASURE_ONCE = 0, MEASURE_WARM = 1 };

typedef struct measure_options {
    method_question question;
    uint32_t mode, repeats, partition, threads; /* partition: BENCH_... of bench_model.h */
    uint32_t workers; /* threads of each query, which are those of query_threads.h; 1 with several
                         threads */
    bool count_near;  /* whether records are to have near */
    double edges;     /* of METHOD_NEAR: the distance, in median edges of the first frame. That of
                        question is not read */
} measure_options;

/* One method in one frame. */
typedef struct measure_record {
    double ms, ms_min, ms_max; /* median, least and greatest of the repeats */
    uint64_t pairs, missed, extra;
    double candidates_ms; /* of steps: median, candidates alone */
    uint64_t candidates;  /* of steps */
    uint64_t near;        /* of the pose: see near_pairs.h */
    sc_stats stats;       /* of the pass that is not timed */
} measure_record;

typedef struct measurement {
    const method_kind **methods; /* method_count; the caller's */
    size_t method_count;
    uint32_t frame_count;    /* of steps: the last frame is no start of one, and not counted */
    measure_record *records; /* frame_count * method_count, frame by frame */
    double build_ms;
    sc_model_info info;
    uint64_t hash_bytes; /* of the hash, if it is among the methods */
    double floor_ms;     /* median over frames of one pass, see floor.h */
    double cpu_share;    /* processor time of the timed passes, divided by wall time: less than the
                            number of threads at work where other programs were in the way */
    double distance;     /* of METHOD_NEAR: in units of the coordinates */
    bool disagrees;      /* a method that must not does */
} measurement;

/*
 * Runs everything. progress may be NULL; it gets a method's name and how much is done. On failure
 * false, with a message in error, and *m is all zero but for methods. Disagreement is no failure.
 */
bool measure_run(measurement *m, scene_folder *scene, const measure_options *options,
                 void (*progress)(const char *what, uint64_t done, uint64_t all), char *error,
                 size_t error_size);

void measure_free(measurement *m);

#endif /* BENCH_MEASURE_H */
