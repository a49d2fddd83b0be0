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

#include "query/state.h"

/* Copies the caller's filter to *filter and checks it, for one kind of pair; hooks may be NULL.
   Linear in the list of pairs to ignore. */
sc_status sc_filter_read(const sc_hooks *hooks, const sc_model *model, uint32_t kind,
                         const sc_filter *from, sc_filter *filter);

/* The same, and makes *filter the one of the query. */
sc_status sc_filter_begin(sc_query_state *state, const sc_hooks *hooks, const sc_model *model,
                          const sc_filter *from, sc_filter *filter);

/* Where state->sifts: takes from the candidates those whose groups leave nothing that is wanted. A
   few nanoseconds each. */
void sc_filter_sift(sc_query_state *state);

/*
 * Whether a pair that was found, in the caller's numbers, is wanted. Calls the caller's function
 * last, hence to be called once for a pair.
 */
int sc_filter_admits(sc_query_state *state, uint32_t a, uint32_t b);

#endif
