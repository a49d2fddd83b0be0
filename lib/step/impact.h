/*
 * The narrow phase of continuous collision: when do a moving vertex and face, or two moving edges,
 * first come within a distance of each other? Never too late, and never without cause.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each coordinate at time t in [0, 1] is the real number (1 - t) start + t end. The distance at a
 * time is the Euclidean one of the closed sets: point and triangle, or segment and segment,
 * whatever these have shrunk to. All finite doubles are allowed, as are zero-area faces, edges of
 * no length, points that do not move, and motion within a plane or line.
 *
 *   - If the distance is <= separation at some time, the answer is 1, and *time is not after the
 *     first such time. (Separation 0: the sets touch.)
 *   - If the answer is 1, the distance at *time is <= separation + T.
 *     So a pair whose distance is always > separation + T is answered 0.
 *   - What is in between may be answered either way, but always the same: the answer and the bits
 *     of *time depend on nothing but the arguments, neither on compiler nor machine.
 *
 * T is the tolerance, but at least SC_IMPACT_FLOOR times the size of this pair: the largest
 * difference of one coordinate between a point of one and a point of the other, at start or end.
 * sc_impact_thickness gives separation + T for the largest pair there may be. Culling that drops
 * only pairs whose distance is always greater than that loses nothing that would be answered 1.
 *
 * Exchanging the edges, turning an edge or rotating the face may change answers in between and the
 * last bits of times. So the caller passes them in an order of the mesh's own: corners as the
 * triangle has them; edges from the lower of their names, each from its corner k to its corner k +
 * 1.
 *
 * Cost: nothing is allocated; less than 16 KB of stack; no recursion. A pair that stays apart takes
 * 10 to 200 ns, one that collides 0.5 to 3 us (Zen 4). Pairs that turn while they stay just outside
 * the tolerance take most: 30 us at worst where that is 2^-20 of their size, 1 to 8 ms at the
 * floor.
 */
#ifndef SC_STEP_IMPACT_H
#define SC_STEP_IMPACT_H

/* 2^-32: the least tolerance, relative to the size of a pair. See impact.c for what it has to
   cover. */
#define SC_IMPACT_FLOOR 0x1p-32

typedef struct sc_impact_limits {
    double separation; /* >= 0, finite, units of the coordinates */
    double tolerance;  /* >= 0, finite, the same units; 0: as little as SC_IMPACT_FLOOR allows */
    double latest;     /* 0 to 1: collisions after it count as none; other answers are the same */
} sc_impact_limits;

/* Points 0: the vertex, 1 to 3: the face. 1 if they collide, with the time; else 0, and *time is
   1. */
int sc_impact_vertex_face(const double start[4][3], const double end[4][3],
                          const sc_impact_limits *limits, double *time);

/* Points 0 and 1: an edge, 2 and 3: the other. 1 if they collide, with the time; else 0, and *time
   is 1. */
int sc_impact_edge_edge(const double start[4][3], const double end[4][3],
                        const sc_impact_limits *limits, double *time);

/*
 * The separation with which a pair is asked whether it comes nearer than it began: D - 2 T, but at
 * least 0 and at most the separation. D is the distance at the start, known to within - T / 16 and
 * 9 T / 16. So what is answered 1 with it, where it is above 0, comes nearer by T / 4 at least. 0
 * for pairs smaller than 2^-900.
 */
double sc_impact_nearer(int is_edges, const double start[4][3], const double end[4][3],
                        const sc_impact_limits *limits);

/*
 * A distance, rounded up, such that no pair that stays farther apart is answered 1. extent: the
 * largest difference of two coordinates on one axis, over all points that take part, at start and
 * end; it may be infinite, if the subtraction overflows.
 */
double sc_impact_thickness(const sc_impact_limits *limits, double extent);

#endif
