/*
 * Filters of pairs of a vertex and a face, and of two edges: of what a step finds, and of what is
 * near in one pose.
 *
 * SPDX-License-Identifier: MIT
 *
 * Culling knows of rings alone, where both kinds have them (step/moving_contour.h). A last stage
 * asks twice, and where filters->sifts or ->asks says that there is nothing to ask, not at all:
 *
 *     sc_step_filter_admits     groups, the list of pairs to ignore, rings, the rest pose
 *     sc_step_filter_accepts    the caller's function, of a pair that was found and admitted
 *     sc_step_pairs_take
 *
 * A step asks the former before it decides a pair: where a thickness is more than the size of
 * cells, most pairs are left out, and their times of impact would take longer. A flat cloth of
 * 65,000 triangles with a thickness of two cells takes 610 ms in place of 830 with a rest pose, 575
 * in place of 990 with four rings; a folded one in motion about the same.
 *
 * Of several workers none asks the caller's function: sc_step_filter_ask does it at the end, in the
 * thread that called the library, of the sorted lists.
 */
#ifndef SC_STEP_FILTER_H
#define SC_STEP_FILTER_H

#include "step/step_worker.h"

/* Copies the caller's filters, each of which may be NULL, and checks them; hooks may be NULL. There
   is no rest pose then. Linear in the lists of pairs to ignore. */
sc_status sc_step_filter_read(const sc_hooks *hooks, const sc_model *model,
                              const sc_filter *vertex_face, const sc_filter *edge_edge,
                              sc_pair_filters *filters);

/*
 * Adds a rest pose, unless it is NULL, which was checked but for what this reports:
 * SC_ERROR_NOT_FINITE; and makes what filters need of each vertex, in room of vertex_count. The
 * pose costs about 1 ns a vertex, groups of triangles 3 ns a triangle, all else nothing.
 */
sc_status sc_step_filter_begin(const sc_model *model, const sc_pose *rest, uint64_t stride,
                               double rest_distance, const sc_tasks *tasks, sc_group *room,
                               sc_pair_filters *filters);

/*
 * Whether all but the caller's function leaves a pair. inner: the pair in the model's numbers,
 * either edge first, best the one that the next pairs have, too; point: its four points, as
 * sc_step_candidates_points gives them; name: the pair in the caller's numbers, the lower edge
 * first.
 */
int sc_step_filter_admits(sc_worker *w, int kind, sc_pair inner, const uint32_t point[4],
                          sc_pair name);

/* Whether the caller's function wants a pair that was found. To be called once for a pair. */
int sc_step_filter_accepts(const sc_worker *w, int kind, sc_pair name);

/* Whether several workers may find pairs: the caller's functions can be asked of them afterwards,
   and the earliest time is known from what they leave. */
int sc_step_filter_allows_workers(const sc_step_question *question);

/* After several workers found pairs, all of which are in the caller's sorted lists: keeps those
   that the caller's functions want, in what the first worker counted, too. */
void sc_step_filter_ask(sc_worker *w);

#endif
