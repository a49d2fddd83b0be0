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

/* Copies the caller's filter to *filter and checks it, for one kind of pair; hooks may be NULL.
   Linear in the list of pairs to ignore. */
sc_status sc_filter_read(const sc_hooks *hooks, const sc_model *model, uint32_t kind,
                         const sc_filter *from, sc_filter *filter);

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

#endif
