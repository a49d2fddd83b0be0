/*
 * Prints a measurement: as JSON Lines, as CSV (comma-separated values), or as a table to read.
 *
 * SPDX-License-Identifier: MIT
 *
 * JSON Lines: the first line describes the run: commit, compiler, flags, CPU, what was measured and
 * how, build time, sizes, and the physical floor. Then one object a frame and method. CSV: the
 * description stands in lines that begin with #; then the names of the columns, and a line a frame
 * and method. Both have the same names:
 *     ms, ms_min                       median and minimum of the repeats
 *     pairs, missed, extra             found; of the complete set not found; found but not in it
 *     candidates, candidates_ms        of steps: pairs left by culling, and the time of a query for
 *                                      these alone
 *     times_floor                      ms as a multiple of the physical floor (floor.h)
 *     update_boxes_ms ... primitives_contour_ms    the nine tasks, from a query that is not in ms
 *     cpu_share (first line)           processor time by wall time of timed queries, see measure.h
 *     nodes, nodes_oriented, nodes_culled, boxes, primitives, leaf_pairs, exact_fallbacks    counts
 *     contour_edges                    that contour tests looked at; of star contours, segments
 *     near_pairs                       with --near: of the pose, see near_pairs.h
 *     ms_max                           greatest of the repeats; ms_min where there is one only
 * What a method does not have is null, or empty in CSV.
 */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include "measure.h"

enum { REPORT_TEXT = 0, REPORT_JSON = 1, REPORT_CSV = 2 };

/* What the measurement itself does not know. */
typedef struct report_context {
    const char *scene, *partition, *mode, *pairs_kind, *contact;
    uint32_t triangle_count, vertex_count;
    const measure_options *options;
} report_context;

/* Prints to stdout; false if there is no memory. */
bool report_print(const measurement *m, const report_context *context, uint32_t format);

#endif /* BENCH_REPORT_H */
