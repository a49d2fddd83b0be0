/*
 * What of traces is compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TRACE_KERNELS_H
#define SC_TRACE_KERNELS_H

/* Pairs are looked at so many at a time. */
enum { SC_CROSSING_LANES = 8 };

/* So many edges and triangles: where the two ends and the three corners are. */
typedef struct sc_crossing_lanes {
    const unsigned char *point[5][SC_CROSSING_LANES];
    int floats; /* not doubles */
} sc_crossing_lanes;

/* What is certain of them, bit i of pair i: they cross, in general position and with determinants
   that are known well; or they do not, however little vertices move. Of those that cross: the
   determinant that the way along the edge is in proportion to, and those of the weights. */
typedef struct sc_crossing_values {
    unsigned cross, apart;
    double along[SC_CROSSING_LANES], weights[3][SC_CROSSING_LANES];
} sc_crossing_values;

typedef struct sc_trace_kernels {
    void (*look)(const sc_crossing_lanes *lanes, sc_crossing_values *values);
} sc_trace_kernels;

#endif
