/*
 * Decides exactly whether an edge meets a triangle, and whether two triangles on an edge are folded
 * flat onto each other; for methods that compare with the library's but are not part of it.
 *
 * SPDX-License-Identifier: MIT
 *
 * Signs of determinants in double arithmetic carry error bounds (J. R. Shewchuk, "Adaptive
 * Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997, the bounds
 * called A). Where they leave a sign open, lines of separation in the three coordinate planes are
 * tried, and at last the library is asked about these two triangles alone, through its public
 * interface.
 *
 * Cost: some 50 ns; about 1 microsecond where the library is asked, that is in contact to within
 * rounding. Not for several threads at once.
 */
#ifndef BENCH_EDGE_TRIANGLE_H
#define BENCH_EDGE_TRIANGLE_H

#include "starcontour.h"

#include <stdbool.h>

/* Models of two triangles, and how often they were asked. All zero: not made. */
typedef struct edge_triangle {
    sc_model *edge_model, *fold_model;
    sc_workspace *edge_workspace, *fold_workspace;
    uint64_t asked;
} edge_triangle;

/* Makes ready; false if there is no memory, and *tests is then all zero. */
bool edge_triangle_open(edge_triangle *tests);

void edge_triangle_close(edge_triangle *tests);

/*
 * Whether edge p q and triangle a b c, which share no vertex, meet; with SC_CONTACT_PROPER, whether
 * they cross properly.
 */
bool edge_triangle_meet(edge_triangle *tests, const double *p, const double *q, const double *a,
                        const double *b, const double *c, uint32_t contact);

/* Whether triangles a b c and a b d have a common point off their common edge. */
bool edge_triangle_folded(edge_triangle *tests, const double *a, const double *b, const double *c,
                          const double *d);

#endif /* BENCH_EDGE_TRIANGLE_H */
