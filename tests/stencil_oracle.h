/*
 * The closest points of a vertex and a face or of two edges, in rational numbers: of each set of
 * vertices of both sides the closest points of the lines or planes through them, if these are
 * inside; of all these the closest. Knows nothing of regions, and shares no code with the library.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_STENCIL_ORACLE_H
#define SC_TESTS_STENCIL_ORACLE_H

#include <gmp.h>

#include "starcontour.h"

typedef struct stencil_oracle {
    mpq_t x[4][3];    /* the points */
    uint32_t feature; /* SC_FEATURE_... */
    uint32_t flags;
    mpq_t weights[4], vector[3], square; /* of the distance */
    mpq_t trial[4], offset[3], least;    /* within a search */
    int first_of_b;
} stencil_oracle;

void stencil_oracle_start(stencil_oracle *o);
void stencil_oracle_stop(stencil_oracle *o);

/* kind: SC_NEAR_VERTEX_FACE or SC_NEAR_EDGE_EDGE. Points as sc_stencil_find has them. */
void stencil_oracle_find(stencil_oracle *o, uint32_t kind, double points[4][3]);

/* NULL, or what of a stencil is not as starcontour.h promises. */
const char *stencil_oracle_compare(stencil_oracle *o, const sc_near_stencil *stencil);

#endif
