/*
 * The oracle: all pairs of a triangle soup by brute force in exact arithmetic.
 *
 * It shares nothing with the library but the public header, and goes another way: no signs of
 * tetrahedra and no case analysis of degenerate positions. Coordinates become integers of GMP (the
 * GNU multiple precision library), scaled by a common power of two. "Two convex hulls have a common
 * point" is the feasibility of a small linear program over barycentric coordinates, decided by the
 * simplex method with exact integer pivots and Bland's rule. "An edge crosses a triangle properly"
 * is "the same equations have exactly one solution and it is positive throughout". Any finite
 * doubles are allowed.
 *
 * Cost: about 10 microseconds for a pair of triangles whose boxes overlap, more where exponents
 * differ widely; a sweep over sorted boxes in front. Feasible to some thousand triangles.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_ORACLE_H
#define SC_TESTS_ORACLE_H

#include <stdint.h>

#include "starcontour.h"

/* Pairs sorted by a, then b. */
typedef struct oracle_list {
    sc_pair *pairs;
    uint64_t count;
    uint64_t capacity;
} oracle_list;

/* lists[SC_PAIRS_...][SC_CONTACT_...] */
typedef struct oracle_answer {
    oracle_list lists[2][2];
} oracle_answer;

/*
 * All four lists of a soup: positions holds 3 * vertex_count coordinates, triangles
 * 3 * triangle_count vertex numbers. weld[v] is the representative of vertex v, whose position v
 * takes; NULL: none are welded. Only positions of vertices that triangles use are read.
 */
void oracle_solve(const double *positions, uint32_t vertex_count, const uint32_t *triangles,
                  uint32_t triangle_count, const uint32_t *weld, oracle_answer *answer);
void oracle_free(oracle_answer *answer);

/*
 * weld[v] = the lowest number of a vertex that a triangle uses and that has the same position as v,
 * for used v (-0 equals 0); v itself for others.
 */
void oracle_weld(const double *rest, uint32_t vertex_count, const uint32_t *triangles,
                 uint32_t triangle_count, uint32_t *weld);

/* Whether the hulls of two lists of 0 to 3 points, x y z each, have a common point. */
int oracle_hulls_meet(const double *p, uint32_t p_count, const double *q, uint32_t q_count);

#endif /* SC_TESTS_ORACLE_H */
