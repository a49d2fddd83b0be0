/*
 * The caller's filter: which of the pairs that are found are not wanted.
 *
 * SPDX-License-Identifier: MIT
 *
 * Culling knows nothing of filters, and so loses nothing by them. What is cheap is asked before a
 * pair of triangles is tested, the rest only of pairs that were found.
 */
#ifndef SC_QUERY_FILTER_H
#define SC_QUERY_FILTER_H

#include "query/worker.h"

/* The kinds of pairs that filters are for: those of queries, SC_PAIRS_..., and those of steps. */
enum {
    SC_FILTER_TRIANGLES = SC_PAIRS_TRIANGLE,
    SC_FILTER_EDGES = SC_PAIRS_EDGE,
    SC_FILTER_VERTEX_FACE = 2,
    SC_FILTER_EDGE_EDGE = 3
};

/* Copies the caller's filter, which the header calls `of`, to *filter and checks it, for one kind
   of pair; hooks may be NULL. Linear in the list of pairs to ignore. */
sc_status sc_filter_read(const sc_hooks *hooks, const char *of, const sc_model *model,
                         uint32_t kind, const sc_filter *from, sc_filter *filter);

/* The same, and makes *filter the one of a question, of which the kind of pairs is known. */
sc_status sc_filter_begin(sc_question *question, const sc_hooks *hooks, const sc_model *model,
                          const sc_filter *from, sc_filter *filter);

/* Where the question sifts: of candidates, as lists have them, keeps those whose groups leave
   anything that is wanted, and returns how many. A few nanoseconds each. */
uint32_t sc_filter_sift(const sc_worker *w, sc_pair *pairs, uint32_t count);

/*
 * Whether a pair that was found, in the caller's numbers, is wanted. Calls the caller's function
 * last, hence to be called once for a pair.
 */
int sc_filter_admits(sc_worker *w, uint32_t a, uint32_t b);

/* ---- what filters are made of, for queries and steps ---- */

int sc_filter_groups_collide(sc_group a, sc_group b);

/* The group of some points together: all of their categories and masks. */
sc_group sc_filter_group_of(const sc_group *groups, const uint32_t *points, uint32_t count);

/* Whether a pair, in the caller's numbers, is in the list of those that are left out. */
int sc_filter_ignores(const sc_filter *filter, uint32_t a, uint32_t b);

/* One of two of which is asked how many edges they are apart: its points, and its number among
   those that a ball may be round, or SC_NONE. */
typedef struct sc_ball_side {
    const uint32_t *points;
    uint32_t count, number;
} sc_ball_side;

/*
 * Whether two are less than so many edges apart, 1 or more. kind: SC_FILTER_..., as which numbers
 * are meant. A ball is begun round the first, unless there is one round either: it serves all pairs
 * with that one which follow each other, as they mostly do, and grows until it reaches the other or
 * has all rings. Within a query the rings of a kind are always the same.
 */
int sc_filter_is_near(const sc_model *model, sc_ball *ball, const sc_ball_side sides[2],
                      uint32_t kind, uint32_t rings);

#endif
